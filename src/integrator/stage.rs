//! One implicit stage: the kernel of every integrator.
//!
//! A stage at t_i with β = γh looks for v_i and so for e_i = e* + β ė_i, v_i = v* + β v̇_i, a_i = a* + β ȧ_i, where the
//! starred values hold what the earlier stages give. A Maxwell element, ȧ = ė - a/τ, is then
//! a_i = g (a* + β ė_i) with g = τ/(τ + β), so it leaves the linear system: a link weighs
//!
//!   F = H + c e + D ė,   H = Σ_j c_j g_j a*_j,   D = d + β Σ_j c_j g_j.
//!
//! What stays is one 2×2 block per mass in the velocities, block tridiagonal along the chain. A contact is the same
//! block seen through (1, s)ᵀ: its second row is the identity; for a sticking mass both are.

use nalgebra::{Matrix2, Vector2};

use super::rates::Rates;
use super::tolerance::NEWTON_SHARE;
use crate::math::BlockTridiagonal;
use crate::model::{CarrierPoint, ContactForces, Forces, LinkKind, Mode, Model, State};

/// Newton's iterations did not converge: a smaller step will.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoConvergence;

/// What the stage knows of the earlier ones: the starred values.
#[derive(Clone, Debug, Default)]
pub(super) struct History {
    /// e*_x, m: carried along with the carrier to the stage's time.
    pub elongation_x: Vec<f64>,
    /// e*_z, m.
    pub elongation_z: Vec<f64>,
    /// v*_x, m/s.
    pub velocity_x: Vec<f64>,
    /// v*_z, m/s.
    pub velocity_z: Vec<f64>,
    /// a*, m.
    pub maxwell: Vec<f64>,
}

/// When and how far the stage reaches.
#[derive(Clone, Copy, Debug)]
pub(super) struct StagePoint {
    /// β = γh, s.
    pub beta: f64,
    /// The carrier at the stage.
    pub carrier: CarrierPoint,
    /// u at the stage as a place on the profile, m.
    pub place: f64,
    /// w at the stage, m.
    pub w: f64,
}

/// c and D of one kind of link.
#[derive(Clone, Copy, Debug, Default)]
struct StageLaw {
    stiffness: f64,
    damping: f64,
    /// βc + D: what the velocity of a free mass weighs.
    weight: f64,
}

/// How a slipping mass is carried up the profile when its ẋ changes.
#[derive(Clone, Copy, Debug, Default)]
struct Climb {
    /// ∂e_z/∂ẋ = βs.
    height: f64,
    /// ∂ż/∂ẋ = s + βκẋ.
    rate: f64,
}

/// Room to solve stages of one model.
#[derive(Clone, Debug)]
pub(super) struct StageSolver {
    /// The starred values, to be set before a stage is solved.
    pub history: History,
    /// The state at the stage: in the mode and at the velocities to start from before, the solution after.
    pub state: State,
    /// The forces at the stage.
    pub forces: Forces,
    history_force: [Vec<f64>; 4],
    laws: [StageLaw; 4],
    climb: Vec<Climb>,
    system: BlockTridiagonal,
    /// Newton's iterations so far.
    pub iterations: u64,
}

/// Iterations after which Newton's method is given up; converging takes two or three.
const MOST_ITERATIONS: usize = 10;

impl StageSolver {
    /// Room for stages of `model`.
    pub(super) fn new(model: &Model) -> Self {
        let k = model.masses();
        let zero = vec![0.0; k];
        let forces = Forces::new(model);
        Self {
            history: History {
                elongation_x: zero.clone(),
                elongation_z: zero.clone(),
                velocity_x: zero.clone(),
                velocity_z: zero,
                maxwell: vec![0.0; model.maxwell_variables()],
            },
            state: State::new(k, model.maxwell_variables()),
            history_force: forces.link.clone(),
            forces,
            laws: [StageLaw::default(); 4],
            climb: vec![Climb::default(); k],
            system: BlockTridiagonal::new(k),
            iterations: 0,
        }
    }

    /// Solves the stage to `tolerance` (m/s) and writes its rates.
    ///
    /// # Errors
    /// [`NoConvergence`] where Newton's iterations do not settle.
    pub(super) fn solve(
        &mut self,
        model: &Model,
        point: &StagePoint,
        tolerance: f64,
        rates: &mut Rates,
    ) -> Result<(), NoConvergence> {
        self.condense_maxwell(model, point.beta);
        let linear = !self.state.mode.iter().any(|mode| mode.slips());
        let mut last = f64::INFINITY;
        for iteration in 1..=MOST_ITERATIONS {
            self.place(model, point);
            self.forces(point);
            self.assemble(model, point.beta);
            self.system.solve();
            let change = self.correct();
            self.iterations += 1;
            if !change.is_finite() {
                return Err(NoConvergence);
            }
            // Newton's error falls with the square: what the next correction would be is known from the last two.
            let next = change * (change / last).min(1.0);
            let settled = change <= tolerance || (iteration > 1 && next <= tolerance);
            // Roundings alone are left when the corrections no longer fall and are below what the step may err by.
            let stalled = change >= 0.25 * last && change <= tolerance / NEWTON_SHARE;
            if linear || settled || stalled {
                self.finish(model, point, rates);
                return Ok(());
            }
            last = change;
        }
        Err(NoConvergence)
    }

    /// H and D of every link.
    fn condense_maxwell(&mut self, model: &Model, beta: f64) {
        for (law, link) in self.laws.iter_mut().zip(&model.links) {
            *law = StageLaw { stiffness: link.stiffness, damping: link.damping, weight: 0.0 };
        }
        for force in &mut self.history_force {
            force.fill(0.0);
        }
        for row in &model.rows {
            let weight = row.stiffness * row.relaxation_time / (row.relaxation_time + beta);
            self.laws[row.kind as usize].damping += beta * weight;
            let history = &self.history.maxwell[row.range.clone()];
            for (force, a) in self.history_force[row.kind as usize].iter_mut().zip(history) {
                *force += weight * a;
            }
        }
        for law in &mut self.laws {
            law.weight = beta * law.stiffness + law.damping;
        }
    }

    /// Positions from the velocities; the constraint put in.
    fn place(&mut self, model: &Model, point: &StagePoint) {
        let beta = point.beta;
        let (state, history) = (&mut self.state, &self.history);
        for i in 0..state.mode.len() {
            let mode = state.mode[i];
            state.elongation_x[i] = history.elongation_x[i] + beta * state.velocity_x[i];
            if mode == Mode::Free {
                state.elongation_z[i] = history.elongation_z[i] + beta * state.velocity_z[i];
                continue;
            }
            if mode.slips() {
                let ground = model.ground(model.rest_x[i] + (point.place + state.elongation_x[i]));
                let v = state.velocity_x[i];
                state.velocity_z[i] = ground.slope * v;
                self.climb[i] = Climb { height: beta * ground.slope, rate: ground.slope + beta * ground.curvature * v };
                state.ground[i] = ground;
            }
            state.elongation_z[i] = state.ground[i].height - model.rest_z[i] - point.w;
        }
    }

    /// Forces of the links and on the masses, by the stage's law.
    fn forces(&mut self, point: &StagePoint) {
        for kind in LinkKind::ALL {
            let law = &self.laws[kind as usize];
            let (place, velocity, carrier_rate) = match kind {
                LinkKind::Vertical | LinkKind::LateralZ => {
                    (&self.state.elongation_z, &self.state.velocity_z, point.carrier.w_rate)
                }
                LinkKind::Horizontal | LinkKind::LateralX => {
                    (&self.state.elongation_x, &self.state.velocity_x, point.carrier.u_rate)
                }
            };
            let history = &self.history_force[kind as usize];
            let force = &mut self.forces.link[kind as usize];
            if kind.is_lateral() {
                for (i, force) in force.iter_mut().enumerate() {
                    let rate = velocity[i + 1] - velocity[i];
                    *force = history[i] + law.stiffness * (place[i + 1] - place[i]) + law.damping * rate;
                }
            } else {
                for (i, force) in force.iter_mut().enumerate() {
                    *force = history[i] + law.stiffness * place[i] + law.damping * (velocity[i] - carrier_rate);
                }
            }
        }
        self.forces.sum_on_masses();
    }

    /// Newton's equations for the corrections of the velocities.
    fn assemble(&mut self, model: &Model, beta: f64) {
        let k = self.state.mode.len();
        let [vertical, horizontal, lateral_x, lateral_z] = self.laws;
        for i in 0..k {
            let neighbours = f64::from(u8::from(i > 0) + u8::from(i + 1 < k));
            let weight_x = horizontal.weight + neighbours * lateral_x.weight;
            let weight_z = vertical.weight + neighbours * lateral_z.weight;
            let row = match self.state.mode[i] {
                Mode::Free => self.free_row(model, beta, i, (weight_x, weight_z)),
                Mode::Stick => Row::identity(),
                Mode::Forward | Mode::Backward => {
                    let stiffness = vertical.stiffness + neighbours * lateral_z.stiffness;
                    let damping = vertical.damping + neighbours * lateral_z.damping;
                    let climb = self.climb[i];
                    self.slip_row(model, beta, i, (weight_x, stiffness * climb.height + damping * climb.rate))
                }
            };
            self.system.diagonal[i] = row.diagonal;
            self.system.right[i] = row.right;
            if i > 0 {
                self.system.lower[i] = row.coupling(&self.column(i - 1));
            }
            if i + 1 < k {
                self.system.upper[i] = row.coupling(&self.column(i + 1));
            }
        }
    }

    /// m (v - v*)/β - f = 0 along x and z.
    fn free_row(&self, model: &Model, beta: f64, i: usize, (weight_x, weight_z): (f64, f64)) -> Row {
        let inertia = model.mass / beta;
        let right_x = self.forces.on_mass_x[i] - inertia * (self.state.velocity_x[i] - self.history.velocity_x[i]);
        let right_z = self.forces.on_mass_z[i] - inertia * (self.state.velocity_z[i] - self.history.velocity_z[i]);
        Row {
            along_x: Vector2::new(1.0, 0.0),
            along_z: Vector2::new(0.0, 1.0),
            diagonal: Matrix2::new(inertia + weight_x, 0.0, 0.0, inertia + weight_z),
            right: Vector2::new(right_x, right_z),
        }
    }

    /// m q² ẍ + m s κ ẋ² - f_x - s f_z + F_T q = 0 with F_T = σ (μ F_N + A τ_0) put in, from (6)-(9):
    ///
    ///   m q² ẍ + m κ ẋ² (s + σμ) - (1 - σμs) f_x - (s + σμ) f_z + σ A τ_0 q = 0
    fn slip_row(&self, model: &Model, beta: f64, i: usize, (weight_x, weight_z): (f64, f64)) -> Row {
        let m = model.mass;
        let ground = &self.state.ground[i];
        let (s, kappa, third) = (ground.slope, ground.curvature, ground.third);
        let v = self.state.velocity_x[i];
        let (f_x, f_z) = (self.forces.on_mass_x[i], self.forces.on_mass_z[i]);
        let sigma = self.state.mode[i].direction();
        let sigma_mu = sigma * model.friction_coefficient;
        let sigma_shear = sigma * model.shear_force;
        let (share_x, share_z) = (1.0 - sigma_mu * s, s + sigma_mu);
        let q2 = 1.0 + s * s;
        let q = q2.sqrt();
        let acceleration = (v - self.history.velocity_x[i]) / beta;
        let residual =
            m * (q2 * acceleration + kappa * v * v * share_z) - share_x * f_x - share_z * f_z + sigma_shear * q;
        // With v the place moves by β, so s by ds = βκ and κ by βz'''.
        let ds = beta * kappa;
        let inertia = q2 / beta
            + 2.0 * s * ds * acceleration
            + v * (beta * third * v * share_z + 2.0 * kappa * share_z + kappa * v * ds);
        let derivative = m * inertia
            + share_x * weight_x
            + share_z * weight_z
            + ds * (sigma_mu * f_x - f_z)
            + sigma_shear * s * ds / q;
        Row {
            along_x: Vector2::new(share_x, 0.0),
            along_z: Vector2::new(share_z, 0.0),
            diagonal: Matrix2::new(derivative, 0.0, 0.0, 1.0),
            right: Vector2::new(-residual, 0.0),
        }
    }

    /// How the lateral forces on a neighbour follow mass `j`'s unknowns: ∂f_x and ∂f_z of the neighbour.
    fn column(&self, j: usize) -> Column {
        let [_, _, lateral_x, lateral_z] = &self.laws;
        match self.state.mode[j] {
            Mode::Free => Column { x: Vector2::new(lateral_x.weight, 0.0), z: Vector2::new(0.0, lateral_z.weight) },
            Mode::Stick => Column { x: Vector2::zeros(), z: Vector2::zeros() },
            Mode::Forward | Mode::Backward => {
                let climb = &self.climb[j];
                let z = lateral_z.stiffness * climb.height + lateral_z.damping * climb.rate;
                Column { x: Vector2::new(lateral_x.weight, 0.0), z: Vector2::new(z, 0.0) }
            }
        }
    }

    /// Adds the corrections to the velocities; the largest, m/s.
    fn correct(&mut self) -> f64 {
        let mut largest = 0.0_f64;
        let mut finite = true;
        for (i, correction) in self.system.right.iter().enumerate() {
            self.state.velocity_x[i] += correction.x;
            self.state.velocity_z[i] += correction.y;
            largest = largest.max(correction.x.abs()).max(correction.y.abs());
            finite &= correction.x.is_finite() && correction.y.is_finite();
        }
        if finite { largest } else { f64::NAN }
    }

    /// The solved stage's positions, forces, Maxwell elongations and rates.
    fn finish(&mut self, model: &Model, point: &StagePoint, rates: &mut Rates) {
        self.place(model, point);
        self.forces(point);
        self.update_maxwell(model, point, rates);
        let per_beta = 1.0 / point.beta;
        let (state, history) = (&self.state, &self.history);
        for i in 0..state.mode.len() {
            let v = state.velocity_x[i];
            rates.velocity_x[i] = v;
            rates.velocity_z[i] = state.velocity_z[i];
            rates.acceleration_x[i] = (v - history.velocity_x[i]) * per_beta;
            rates.acceleration_z[i] = (state.velocity_z[i] - history.velocity_z[i]) * per_beta;
            if state.mode[i].in_contact() {
                let ground = &state.ground[i];
                let on_mass = (self.forces.on_mass_x[i], self.forces.on_mass_z[i]);
                rates.contact(i, state.mode[i], v, ground, &ContactForces::new(model, on_mass, v, ground));
            }
        }
    }

    /// a = g (a* + β ė) and ȧ = ė - a/τ, the second by (a - a*)/β, which keeps its digits when τ is short.
    fn update_maxwell(&mut self, model: &Model, point: &StagePoint, rates: &mut Rates) {
        let beta = point.beta;
        rates.clear_maxwell_force();
        for row in &model.rows {
            let (velocity, carrier_rate) = match row.kind {
                LinkKind::Vertical | LinkKind::LateralZ => (&self.state.velocity_z, point.carrier.w_rate),
                LinkKind::Horizontal | LinkKind::LateralX => (&self.state.velocity_x, point.carrier.u_rate),
            };
            let tau = row.relaxation_time;
            let update = MaxwellUpdate { g: tau / (tau + beta), beta, per_beta: 1.0 / beta, stiffness: row.stiffness };
            let history = &self.history.maxwell[row.range.clone()];
            let a = &mut self.state.maxwell[row.range.clone()];
            let (rate, force_rate) = rates.maxwell_row(row);
            if row.kind.is_lateral() {
                let elongation_rate = |i: usize| velocity[i + 1] - velocity[i];
                update.apply(history, elongation_rate, a, rate, force_rate);
            } else {
                update.apply(history, |i: usize| velocity[i] - carrier_rate, a, rate, force_rate);
            }
        }
    }
}

/// The update of one row of Maxwell elements.
struct MaxwellUpdate {
    g: f64,
    beta: f64,
    per_beta: f64,
    stiffness: f64,
}

impl MaxwellUpdate {
    #[inline]
    fn apply(
        &self,
        history: &[f64],
        elongation_rate: impl Fn(usize) -> f64,
        a: &mut [f64],
        rate: &mut [f64],
        force_rate: &mut [f64],
    ) {
        let n = history.len();
        let (a, rate, force_rate) = (&mut a[..n], &mut rate[..n], &mut force_rate[..n]);
        for i in 0..n {
            a[i] = self.g * (history[i] + self.beta * elongation_rate(i));
            rate[i] = (a[i] - history[i]) * self.per_beta;
            force_rate[i] += self.stiffness * rate[i];
        }
    }
}

/// Newton's equations of one mass, and how the forces f_x, f_z on it enter them.
struct Row {
    along_x: Vector2<f64>,
    along_z: Vector2<f64>,
    diagonal: Matrix2<f64>,
    right: Vector2<f64>,
}

/// ∂f_x and ∂f_z on a neighbour by a mass's two unknowns.
struct Column {
    x: Vector2<f64>,
    z: Vector2<f64>,
}

impl Row {
    fn identity() -> Self {
        Self {
            along_x: Vector2::zeros(),
            along_z: Vector2::zeros(),
            diagonal: Matrix2::identity(),
            right: Vector2::zeros(),
        }
    }

    /// The block beside the diagonal: what the neighbour's unknowns do to this row.
    fn coupling(&self, column: &Column) -> Matrix2<f64> {
        -(self.along_x * column.x.transpose() + self.along_z * column.z.transpose())
    }
}
