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

mod maxwell;
mod newton;
mod variation;

use super::add;
use super::rates::Rates;
use super::tolerance::NEWTON_SHARE;
use crate::math::BlockTridiagonal;
use crate::model::{CarrierPoint, ContactForces, Forces, LinkKind, LinkMotion, Mode, Model, State};

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
            self.system.factor();
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
        let motion = LinkMotion::of(&self.state, &point.carrier);
        for kind in LinkKind::ALL {
            let law = &self.laws[kind as usize];
            self.forces.spring_and_damper(kind, law.stiffness, law.damping, &motion);
            add(&mut self.forces.link[kind as usize], 1.0, &self.history_force[kind as usize]);
        }
        self.forces.sum_on_masses();
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
        self.update_maxwell(model, point.beta, rates);
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
}
