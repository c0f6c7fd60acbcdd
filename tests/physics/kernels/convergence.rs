//! The order of convergence at fixed steps, against solutions that do not come from the integrator.

use asperity::model::{Mode, Model, State};
use asperity::scene::{Path, RateShear};
use nalgebra::{DMatrix, DVector, Vector2};

use crate::physics::kernels::layer::{Layer, Method, SEVEN_STAGES, Stepper, at_rate, last_order, link, points};
use crate::physics::kernels::matrices::Matrices;

/// Three masses far above the surface, a different number of Maxwell elements on every kind of link.
pub fn chain() -> Layer {
    let links = [
        link(30.0, 0.4, &[(20.0, 0.3), (10.0, 0.05)]),
        link(20.0, 0.2, &[(15.0, 0.1)]),
        link(25.0, 0.1, &[]),
        link(10.0, 0.3, &[(5.0, 1.0), (8.0, 0.2), (4.0, 0.02)]),
    ];
    Layer { masses: 3, mass: 0.5, clearance: 10.0, links, ..Layer::default() }
}

pub const PATHS: (Path, Path) =
    (Path { rate: 0.3, amplitude: 0.1, frequency: 0.7 }, Path { rate: -0.1, amplitude: 0.05, frequency: 1.1 });

/// A state away from rest.
pub fn displaced(model: &Model) -> State {
    let mut state = State::new(model);
    for i in 0..model.masses() {
        let phase = i as f64 + 1.0;
        (state.elongation_x[i], state.elongation_z[i]) = (0.1 * phase.sin(), 0.1 * phase.cos());
        (state.velocity_x[i], state.velocity_z[i]) = ((2.0 * phase).cos(), (3.0 * phase).sin());
    }
    (0..).zip(&mut state.maxwell).for_each(|(j, a)| *a = 0.05 * f64::from(j).cos());
    state
}

/// The free layer under a carrier on `PATHS` as one linear system ż = A z in z = (q, q̇, y, 1, t, sin and cos of u, and
/// of w).
pub struct Exact {
    matrices: Matrices,
    generator: DMatrix<f64>,
}

impl Exact {
    pub fn new(layer: &Layer) -> Self {
        let matrices = Matrices::new(layer);
        let (k2, n) = (2 * layer.masses, matrices.relaxation_times.len());
        let (position, rate) = (displacement(), rates());
        let size = 2 * k2 + n + 6;
        let mut a = DMatrix::zeros(size, size);
        a.view_mut((0, k2), (k2, k2)).fill_with_identity();
        let per_mass = 1.0 / layer.mass;
        a.view_mut((k2, 0), (k2, k2)).copy_from(&(-per_mass * &matrices.stiffness));
        a.view_mut((k2, k2), (k2, k2)).copy_from(&(-per_mass * &matrices.damping));
        a.view_mut((k2, 2 * k2), (k2, n)).copy_from(&(per_mass * &matrices.internal));
        let load = &matrices.carrier_position * &position + &matrices.carrier_rate * &rate;
        a.view_mut((k2, 2 * k2 + n), (k2, 6)).copy_from(&(per_mass * load));
        let per_tau = DMatrix::from_diagonal(&DVector::from_column_slice(&matrices.relaxation_times).map(f64::recip));
        a.view_mut((2 * k2, 0), (n, k2)).copy_from(&(&per_tau * &matrices.elongation));
        a.view_mut((2 * k2, 2 * k2), (n, n)).copy_from(&-&per_tau);
        a.view_mut((2 * k2, 2 * k2 + n), (n, 6)).copy_from(&(-&per_tau * &matrices.elongation_carrier * &position));
        a.view_mut((2 * k2 + n, 2 * k2 + n), (6, 6)).copy_from(&clockwork());
        Self { matrices, generator: a }
    }

    /// The state after `time` (s) from `start` at the carrier's start.
    pub fn at(&self, start: &State, time: f64) -> State {
        let (k, n) = (self.matrices.masses, start.maxwell.len());
        let q = DVector::from_iterator(2 * k, start.elongation_x.iter().chain(&start.elongation_z).copied());
        let e = self.matrices.elongations(&q, Vector2::zeros());
        let y = e.iter().zip(&start.maxwell).map(|(e, a)| e - a);
        let v = start.velocity_x.iter().chain(&start.velocity_z).copied();
        let clock = [1.0, 0.0, 0.0, 1.0, 0.0, 1.0];
        let numbers = q.iter().copied().chain(v).chain(y).chain(clock);
        let z = (&self.generator * time).exp() * DVector::from_iterator(4 * k + n + 6, numbers);
        let carrier = displacement() * z.rows(4 * k + n, 6);
        let q = z.rows(0, 2 * k).into_owned();
        let a = self.matrices.elongations(&q, Vector2::new(carrier[0], carrier[1])) - z.rows(4 * k, n);
        let mut state = start.clone();
        for i in 0..k {
            (state.elongation_x[i], state.elongation_z[i]) = (q[i] - carrier[0], q[k + i] - carrier[1]);
            (state.velocity_x[i], state.velocity_z[i]) = (z[2 * k + i], z[3 * k + i]);
        }
        state.maxwell.copy_from_slice(a.as_slice());
        state
    }
}

fn omegas() -> (f64, f64) {
    (std::f64::consts::TAU * PATHS.0.frequency, std::f64::consts::TAU * PATHS.1.frequency)
}

/// (u, w) by (1, t, sin, cos, sin, cos).
fn displacement() -> DMatrix<f64> {
    let (u, w) = PATHS;
    DMatrix::from_row_slice(2, 6, &[0.0, u.rate, u.amplitude, 0.0, 0.0, 0.0, 0.0, w.rate, 0.0, 0.0, w.amplitude, 0.0])
}

fn rates() -> DMatrix<f64> {
    displacement() * clockwork()
}

/// The derivative of (1, t, sin, cos, sin, cos) by themselves.
fn clockwork() -> DMatrix<f64> {
    let (u, w) = omegas();
    let mut matrix = DMatrix::zeros(6, 6);
    matrix[(1, 0)] = 1.0;
    (matrix[(2, 3)], matrix[(3, 2)]) = (u, -u);
    (matrix[(4, 5)], matrix[(5, 4)]) = (w, -w);
    matrix
}

/// The largest differences of two states: of positions, velocities and Maxwell elongations.
pub fn differences(a: &State, b: &State) -> [f64; 3] {
    let worst = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    [
        worst(&a.elongation_x, &b.elongation_x).max(worst(&a.elongation_z, &b.elongation_z)),
        worst(&a.velocity_x, &b.velocity_x).max(worst(&a.velocity_z, &b.velocity_z)),
        worst(&a.maxwell, &b.maxwell),
    ]
}

/// The errors of positions, velocities and Maxwell elongations of a free chain under a carrier that oscillates, after
/// 20, 40 and 80 steps, against the matrix exponential.
fn free_errors(method: Method) -> [[f64; 3]; 3] {
    let layer = chain();
    let start = displaced(&layer.model());
    let expected = Exact::new(&layer).at(&start, 1.0);
    [20, 40, 80].map(|steps| {
        let mut stepper = method(Stepper::new(layer.model(), PATHS, start.clone(), 1e-12));
        stepper.run(1.0, steps);
        differences(&stepper.start.state, &expected)
    })
}

#[test]
fn a_free_chain_converges_with_order_five() {
    let errors = free_errors(SEVEN_STAGES);
    for part in 0..3 {
        let order = last_order(&errors.map(|error| error[part]));
        // Not yet at its limit at steps of a few tenths of the shortest time of the layer, 0.02 s.
        assert!((4.7..5.5).contains(&order), "part {part}: {order} from {errors:?}");
        assert!(errors[2][part] < 1e-7, "part {part}: {errors:?}");
    }
}

#[test]
fn a_free_chain_converges_with_order_three() {
    let errors = free_errors(Stepper::by_four_stages);
    for part in 0..3 {
        let order = last_order(&errors.map(|error| error[part]));
        assert!((2.6..3.6).contains(&order), "part {part}: {order} from {errors:?}");
        assert!(errors[2][part] < 2e-4, "part {part}: {errors:?}");
    }
}

/// One mass pressed onto one polynomial of a spline, so that nothing along its way is less than smooth.
pub fn slider() -> Layer {
    let links = [link(40.0, 0.5, &[(30.0, 0.2)]), link(20.0, 0.3, &[(10.0, 0.1), (5.0, 0.5)]), None, None];
    let surface = points(&[-4.0, -1.0, 3.0, 6.0], &[0.0, 0.5, -0.2, 0.6], false);
    Layer { mass: 0.5, clearance: 0.3, links, surface, friction: Some((0.4, 0.5)), ..Layer::default() }
}

/// The slider with a shear strength that rises or falls with its speed.
pub fn rate_slider(reference_speed: f64) -> Layer {
    let law = RateShear { force: Some(1.5), strength: None, reference_speed, sharpness: 2.0, creep_speed: None };
    Layer { rate_shear: Some(law), ..slider() }
}

/// The slider at a position and a speed, its dashpots relaxed, the carrier at `w`.
pub fn sliding(model: &Model, velocity: f64, w: f64) -> State {
    let mut state = State::new(model);
    let surface = model.surface_at(0.0);
    state.mode[0] = Mode::along(velocity);
    state.surface[0] = surface;
    state.elongation_z[0] = surface.height - model.rest_z[0] - w;
    (state.velocity_x[0], state.velocity_z[0]) = (velocity, surface.slope * velocity);
    state
}

/// The slider by the classical Runge-Kutta method on the dense equations of motion: its position ξ and ẋ at `time`.
pub fn reference(layer: &Layer, start: &State, u_rate: f64, time: f64, steps: u32) -> (f64, f64, DVector<f64>) {
    let (model, matrices) = (layer.model(), Matrices::new(layer));
    let n = matrices.relaxation_times.len();
    let derivative = |t: f64, z: &DVector<f64>| {
        let surface = model.surface_at(model.rest_x[0] + z[0]);
        let q = DVector::from_vec(vec![z[0], surface.height - model.rest_z[0]]);
        let v = DVector::from_vec(vec![z[1], surface.slope * z[1]]);
        let y = z.rows(2, n).into_owned();
        let carrier = (Vector2::new(u_rate * t, 0.0), Vector2::new(u_rate, 0.0));
        let f = matrices.forces((&q, &v), &y, carrier);
        let (acceleration, _) = matrices.accelerations(&f, &v, &start.mode, &[surface]);
        let internal = matrices.internal_rates(&q, &y, carrier.0);
        DVector::from_iterator(2 + n, [z[1], acceleration[0]].into_iter().chain(internal.iter().copied()))
    };
    let e = [start.elongation_z[0], start.elongation_x[0], start.elongation_x[0]];
    let mut z = DVector::from_iterator(2 + n, [0.0, start.velocity_x[0]].into_iter().chain(e));
    let h = time / f64::from(steps);
    for i in 0..steps {
        let t = f64::from(i) * h;
        let k1 = derivative(t, &z);
        let k2 = derivative(t + 0.5 * h, &(&z + 0.5 * h * &k1));
        let k3 = derivative(t + 0.5 * h, &(&z + 0.5 * h * &k2));
        let k4 = derivative(t + h, &(&z + h * &k3));
        z += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    let q = DVector::from_vec(vec![z[0], model.surface_at(model.rest_x[0] + z[0]).height - model.rest_z[0]]);
    let a = matrices.elongations(&q, Vector2::new(u_rate * time, 0.0)) - z.rows(2, n);
    (z[0], z[1], a)
}

/// A mass slipping over a curved profile with friction, centripetal terms and Maxwell elements, either way: the layers
/// and the errors of position, velocity and Maxwell elongations after so many steps, against an explicit method on the
/// dense equations.
pub fn slipping_errors<const N: usize>(
    steps: [u32; N],
    tolerance: f64,
    method: Method,
) -> impl Iterator<Item = (Layer, [[f64; 3]; N])> {
    let layers = |velocity: f64| [slider(), rate_slider(4.0), rate_slider(0.7)].map(|layer| (velocity, layer));
    [2.0, -1.2].into_iter().flat_map(layers).map(move |(velocity, layer)| {
        let start = sliding(&layer.model(), velocity, 0.0);
        let (position, speed, maxwell) = reference(&layer, &start, 1.5 * velocity, 0.4, 4000);
        let errors = steps.map(|steps| {
            let paths = (at_rate(1.5 * velocity), at_rate(0.0));
            let mut stepper = method(Stepper::new(layer.model(), paths, start.clone(), tolerance));
            stepper.run(0.4, steps);
            let state = &stepper.start.state;
            let xi = 1.5 * velocity * 0.4 + state.elongation_x[0];
            let a = DVector::from_column_slice(&state.maxwell);
            [(xi - position).abs(), (state.velocity_x[0] - speed).abs(), (a - &maxwell).amax()]
        });
        (layer, errors)
    })
}

/// Order 5, though the problem is one of constrained motion.
#[test]
fn a_slipping_mass_converges_with_order_five() {
    for (layer, errors) in slipping_errors([4, 8, 16, 32], 1e-14, SEVEN_STAGES) {
        for part in 0..3 {
            let last = last_order(&errors.map(|error| error[part]));
            // With a shear strength errors of positions pass through 0 on their way: over all three halvings they fall
            // as they should.
            let (order, highest) = if layer.rate_shear.is_some() {
                (last.max((errors[0][part] / errors[3][part]).log2() / 3.0), 6.4)
            } else {
                (last, 5.6)
            };
            assert!((4.5..highest).contains(&order), "part {part}: {order} from {errors:?}");
        }
    }
}

/// Order 3 in four stages, without the shear strength.
#[test]
fn a_slipping_mass_converges_with_order_three() {
    let errors = slipping_errors([4, 8, 16, 32], 1e-14, Stepper::by_four_stages);
    for (layer, errors) in errors.into_iter().filter(|(layer, _)| layer.rate_shear.is_none()) {
        for part in 0..3 {
            let order = (errors[0][part] / errors[3][part]).log2() / 3.0;
            assert!((2.4..4.0).contains(&order), "part {part}: {order} from {errors:?} of {:?}", layer.friction);
        }
    }
}

/// The estimate b - b̂ of one step falls with h⁵: it is that of a method of order 4.
#[test]
fn the_error_estimate_falls_with_the_fifth_power() {
    let layer = chain();
    let start = displaced(&layer.model());
    let slider = slider();
    let sliding = sliding(&slider.model(), 2.0, 0.0);
    for (layer, start) in [(layer, start), (slider, sliding.clone()), (rate_slider(4.0), sliding)] {
        let mut stepper = Stepper::new(layer.model(), PATHS, start, 1e-12);
        // The norm divides by absolute + relative · size, nearly a constant for sizes far below 1.
        let tolerance = &mut stepper.tolerance;
        (tolerance.relative, tolerance.position, tolerance.velocity) = (1e-12, 1e-12, 1e-12);
        let attempts = [4e-3, 2e-3, 1e-3].map(|h| stepper.attempt(h));
        let order = last_order(&attempts.map(|attempt| attempt.error));
        assert!((4.7..5.3).contains(&order), "{order} from {attempts:?}");
    }
}
