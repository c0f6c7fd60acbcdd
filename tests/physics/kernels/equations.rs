//! The structured code against the dense equations of motion, and a solved stage against the explicit rates.

use asperity::internals::integrator::{MAX_STAGES, NO_LIMIT, StageValues};
use asperity::math::Jet;
use asperity::model::{CarrierPoint, Forces, LinkKind, Mode, Model, State};
use asperity::scene::{Path, RateShear};
use nalgebra::{DVector, Vector2};

use crate::common::largest;
use crate::common::random::Random;
use crate::physics::kernels::layer::{Layer, Stepper, link, points};
use crate::physics::kernels::matrices::Matrices;

/// A layer with every kind of link or some, each with its own number of Maxwell elements, over a curved profile.
pub fn random_layer(random: &mut Random, masses: usize) -> Layer {
    let mut link = || {
        let element = |random: &mut Random| (random.between(10.0, 300.0), 10.0_f64.powf(random.between(-3.0, 0.0)));
        let maxwell: Vec<_> = (0..random.below(4)).map(|_| element(random)).collect();
        let link = link(random.between(10.0, 300.0), random.between(0.0, 2.0), &maxwell);
        if random.below(6) == 0 { None } else { link }
    };
    let links = [link(), link(), link(), link()];
    let heights: Vec<f64> = (0..12).map(|_| random.between(-0.1, 0.1)).collect();
    let x: Vec<f64> = (0..12).map(|i| f64::from(i) * 0.5 - 1.0).collect();
    let friction = (random.below(4) > 0).then(|| (random.between(0.0, 1.0), random.between(0.0, 5.0)));
    let surface = points(&x, &heights, false);
    let rate_shear = (random.below(2) > 0).then(|| RateShear {
        force: Some(random.between(0.0, 5.0)),
        strength: None,
        reference_speed: 10.0_f64.powf(random.between(-4.0, 1.0)),
        sharpness: random.between(0.0, 1.0),
        creep_speed: None,
    });
    Layer { masses, mass: 0.3, spacing: 0.37, clearance: 0.2, links, surface, friction, rate_shear, ..Layer::default() }
}

/// Where the carrier stands and how it moves: (u, w), (u̇, ẇ).
type CarrierMotion = (Vector2<f64>, Vector2<f64>);

/// A state with random modes, on the profile where it is in contact.
pub fn random_state(random: &mut Random, model: &Model, position: &Vector2<f64>) -> State {
    let mut state = State::new(model);
    state.maxwell.fill_with(|| random.between(-0.05, 0.05));
    for i in 0..model.masses() {
        state.elongation_x[i] = random.between(-0.1, 0.1);
        state.elongation_z[i] = random.between(0.0, 0.1);
        (state.velocity_x[i], state.velocity_z[i]) = (random.between(-2.0, 2.0), random.between(-2.0, 2.0));
        let contact =
            if model.friction.present { [Mode::Forward, Mode::Backward, Mode::Stick] } else { [Mode::Forward; 3] };
        if random.below(3) > 0 {
            put_on_profile(model, &mut state, i, contact[random.below(3)], position);
        }
    }
    state
}

fn put_on_profile(model: &Model, state: &mut State, i: usize, mode: Mode, position: &Vector2<f64>) {
    let surface = model.surface_at(model.rest_x[i] + (position.x + state.elongation_x[i]));
    let speed = state.velocity_x[i].abs();
    let v = if model.friction.present { mode.direction() * speed } else { state.velocity_x[i] };
    (state.mode[i], state.surface[i]) = (mode, surface);
    state.elongation_z[i] = surface.height - model.rest_z[i] - position.y;
    (state.velocity_x[i], state.velocity_z[i]) = (v, surface.slope * v);
}

/// The dense form of a state: q, q̇, y.
fn dense_state(
    matrices: &Matrices,
    state: &State,
    position: Vector2<f64>,
) -> (DVector<f64>, DVector<f64>, DVector<f64>) {
    let xi = state.elongation_x.iter().map(|e| e + position.x);
    let zeta = state.elongation_z.iter().map(|e| e + position.y);
    let k = matrices.masses;
    let q = DVector::from_iterator(2 * k, xi.chain(zeta));
    let v = DVector::from_iterator(2 * k, state.velocity_x.iter().chain(&state.velocity_z).copied());
    // a = e - y.
    let y = matrices.elongations(&q, position) - DVector::from_column_slice(&state.maxwell);
    (q, v, y)
}

/// Compares `rates` in `state` with the dense equations: accelerations, ė of all links with Maxwell elements, F_N and
/// the margins of the modes.
/// Differences count over the largest number that takes part; the largest of them.
fn difference(
    matrices: &Matrices,
    model: &Model,
    state: &State,
    rates: &StageValues,
    (position, rate): CarrierMotion,
) -> f64 {
    let k = matrices.masses;
    let (q, v, y) = dense_state(matrices, state, position);
    let f = matrices.forces((&q, &v), &y, (position, rate));
    let (accelerations, contacts) = matrices.accelerations(&f, &v, &state.mode, &state.surface);
    let found = DVector::from_iterator(2 * k, rates.acceleration_x.iter().chain(&rates.acceleration_z).copied());
    let mut worst = (found - &accelerations).amax() / accelerations.amax().max(1.0);
    let elongation_rates = matrices.elongations(&v, rate);
    let of_rows = model.rows.iter().flat_map(|row| &rates.elongation_rate[row.kind]).copied();
    let found = DVector::from_iterator(elongation_rates.len(), of_rows);
    if !found.is_empty() {
        worst = worst.max((found - &elongation_rates).amax() / elongation_rates.amax());
    }
    let (mu, _) = matrices.friction.unwrap_or_default();
    for (i, (normal, tangential)) in contacts.into_iter().enumerate().filter(|&(i, _)| state.mode[i].in_contact()) {
        let margin = match state.mode[i] {
            Mode::Stick => mu * normal + matrices.shear(0.0) - tangential.abs(),
            mode if model.friction.present => mode.direction() * state.velocity_x[i],
            _ => NO_LIMIT,
        };
        let misses = [rates.normal[i] - normal, rates.margin[i] - margin];
        worst = worst.max(largest(&misses) / f.amax().max(normal.abs()).max(1.0));
    }
    worst
}

fn random_motion(random: &mut Random) -> CarrierMotion {
    (
        Vector2::new(random.between(-0.5, 0.5), random.between(-0.3, 0.1)),
        Vector2::new(random.between(-2.0, 2.0), random.between(-1.0, 1.0)),
    )
}

/// For random layers of 1 to 5 masses in random modes, `Forces` and `StageValues` give the accelerations, ė, normal
/// forces and margins of the dense equations (10)-(15).
#[test]
fn rates_agree_with_the_dense_matrices() {
    let mut random = Random::new(1);
    let mut modes = [0; 4];
    for case in 0..2000 {
        let layer = random_layer(&mut random, 1 + case % 5);
        let (model, matrices) = (layer.model(), Matrices::new(&layer));
        let motion = random_motion(&mut random);
        let state = random_state(&mut random, &model, &motion.0);
        let moving = |speed| Jet { speed, ..Jet::default() };
        let carrier = CarrierPoint { x: moving(motion.1.x), z: moving(motion.1.y), ..CarrierPoint::default() };
        let (mut forces, mut rates) = (Forces::new(&model), StageValues::new(&model));
        forces.evaluate(&model, &state, &carrier);
        rates.evaluate(&model, &state, &forces, 0.0, 1e-12);
        state.mode.iter().for_each(|&mode| modes[(mode.number() + 1) as usize] += 1);
        // Some twenty terms are added in another order, and the dense system has condition numbers of some 10.
        let worst = difference(&matrices, &model, &state, &rates, motion);
        assert!(worst < 3e-13, "case {case}: {worst:e} in {layer:?}");
    }
    assert!(modes.iter().all(|&count| count > 500), "every mode takes part: {modes:?}");
}

/// The rows of Maxwell elements stand in the order that the dense assembly has.
#[test]
fn the_layout_is_the_paper_s_count() {
    let link = |n: usize| link(1.0, 1.0, &vec![(1.0, 1.0); n]);
    let layer = Layer { masses: 5, links: [link(3), link(3), link(3), link(3)], ..Layer::default() };
    let model = layer.model();
    // 4kn - 2n.
    assert_eq!(model.maxwell_variables(), 4 * 5 * 3 - 2 * 3);
    let kinds: Vec<LinkKind> = model.rows.iter().map(|row| row.kind).collect();
    assert_eq!(kinds, LinkKind::ALL.map(|kind| [kind; 3]).concat());
    assert_eq!(Matrices::new(&layer).relaxation_times.len(), model.maxwell_variables());
}

/// The end of a step is its last stage: there the accelerations (v - v*)/β that Newton's iterations found are those
/// that the explicit rates, and the dense equations, give in the stage's state.
#[test]
fn a_solved_stage_satisfies_the_equations_of_motion() {
    let mut random = Random::new(2);
    for case in 0..500 {
        let layer = random_layer(&mut random, 1 + case % 5);
        let (model, matrices) = (layer.model(), Matrices::new(&layer));
        let (_, rate) = random_motion(&mut random);
        let state = random_state(&mut random, &model, &Vector2::zeros());
        let path = |rate| Path { rate, amplitude: 0.01, frequency: 3.0 };
        let mut stepper = Stepper::new(model, (path(rate.x), path(rate.y)), state, 1e-15);
        let h = 10.0_f64.powf(random.between(-6.0, -2.5));
        stepper.attempt(h);
        let carrier = stepper.carrier.at(h);
        let (end, last) = (stepper.integrator.end(), &stepper.integrator.stages()[MAX_STAGES - 1]);
        let motion =
            (Vector2::new(carrier.x.position, carrier.z.position), Vector2::new(carrier.x.speed, carrier.z.speed));
        let worst = difference(&matrices, &stepper.model, end, last, motion);
        // (v - v*)/β loses the digits that v and v* share, ε v/β; Newton's iterations end far below.
        let tolerance = 3e-13 + 5e-15 / h;
        assert!(worst < tolerance, "case {case}, h {h:e}: {worst:e} over {tolerance:e}");
    }
}
