//! One implicit stage: the kernel of every integrator.
//!
//! A stage at t_i with β = γh looks for v_i and so for e_i = e* + β ė_i, v_i = v* + β v̇_i, where the starred values
//! hold what the earlier stages give. The Maxwell elements add H + h Q_ii ė_i to a link's force (see `maxwell`), so a
//! link weighs
//!
//!   F = H + c e + D ė,   D = d + h Q_ii.
//!
//! What stays is one 2×2 block per mass in the velocities, block tridiagonal along the chain. A contact is the same
//! block seen through (1, s)ᵀ: its second row is the identity; for a sticking mass both are.

mod newton;
mod rate;
mod variation;

use super::rates::Rates;
use super::tolerance::{NEWTON_SHARE, Tolerance};
use crate::math::BlockTridiagonal;
use crate::model::{CarrierPoint, Forces, LinkKind, LinkMotion, Mode, Model, State};
use newton::{Column, Row, Slip, largest};
use rate::RateSlip;

/// Newton's iterations did not converge: a smaller step will.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoConvergence;

/// What the earlier stages give to a stage: the starred values and the forces of the Maxwell elements.
#[derive(Clone, Debug)]
pub(super) struct History {
    /// e*_x, m: as if the carrier stood where it was at the start of the step.
    pub elongation_x: Vec<f64>,
    /// e*_z, m.
    pub elongation_z: Vec<f64>,
    /// v*_x, m/s.
    pub velocity_x: Vec<f64>,
    /// v*_z, m/s.
    pub velocity_z: Vec<f64>,
    /// H by kind of link, N; empty where the links have no Maxwell elements.
    pub force: [Vec<f64>; 4],
}

/// When and how far the stage reaches.
#[derive(Clone, Copy, Debug)]
pub(super) struct StagePoint {
    /// β = γh, s.
    pub beta: f64,
    /// The carrier at the stage.
    pub carrier: CarrierPoint,
    /// How far the stage takes the carrier to have moved since the start of the step, along x and z, m.
    pub driven: (f64, f64),
    /// How far it has moved along x, m: what a sticking mass stays behind.
    pub moved: f64,
    /// u at the stage as a position on the profile, m.
    pub profile_position: f64,
    /// w at the stage, m.
    pub w: f64,
}

/// To what corrections of the velocities a stage is solved, m/s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Accuracy {
    /// Where Newton's iterations end.
    newton: f64,
    /// Where they may end if the corrections no longer fall, since roundings are left.
    roundings: f64,
}

impl Accuracy {
    /// For a stage with β = `beta` (s); `slack` times what the tolerance recommends.
    pub(super) fn new(tolerance: &Tolerance, beta: f64, slack: f64) -> Self {
        let newton = slack * tolerance.newton(beta);
        Self { newton: newton.min(tolerance.newton_of_rods(beta)), roundings: newton / NEWTON_SHARE }
    }
}

/// c and D of one kind of link.
#[derive(Clone, Copy, Debug, Default)]
struct StageLaw {
    stiffness: f64,
    damping: f64,
    /// βc + D: what the velocity of a free mass weighs.
    weight: f64,
}

/// Room to solve stages of one model.
#[derive(Clone, Debug)]
pub(super) struct StageSolver {
    /// To be set before a stage is solved.
    pub history: History,
    /// The state at the stage but for its Maxwell elements: at the velocities to start from before, the solution after.
    pub state: State,
    /// The forces at the stage.
    pub forces: Forces,
    laws: [StageLaw; 4],
    /// The masses in contact.
    contacts: Vec<usize>,
    /// Those of them that slip, and how; without any the equations are linear.
    slips: Vec<usize>,
    slip: Vec<Slip>,
    /// What of their friction depends on the speed; empty where nothing does.
    rate: Vec<RateSlip>,
    rows: Vec<Row>,
    columns: Vec<Column>,
    system: BlockTridiagonal,
    /// Newton's iterations so far.
    pub iterations: u64,
}

/// Iterations after which Newton's method is given up; converging takes one or two.
const MOST_ITERATIONS: usize = 10;

impl StageSolver {
    /// Room for stages of `model`.
    pub(super) fn new(model: &Model) -> Self {
        let k = model.masses();
        let zero = vec![0.0; k];
        let workspace = |kind: LinkKind| {
            if model.rows.iter().any(|row| row.kind == kind) { vec![0.0; kind.count(k)] } else { Vec::new() }
        };
        Self {
            history: History {
                elongation_x: zero.clone(),
                elongation_z: zero.clone(),
                velocity_x: zero.clone(),
                velocity_z: zero,
                force: LinkKind::ALL.map(workspace),
            },
            state: State::new(k, model.maxwell_variables()),
            forces: Forces::new(model),
            laws: [StageLaw::default(); 4],
            contacts: Vec::with_capacity(k),
            slips: Vec::with_capacity(k),
            slip: Vec::with_capacity(k),
            rate: Vec::with_capacity(if model.rate_shear.is_some() { k } else { 0 }),
            rows: vec![Row::default(); k],
            columns: vec![Column::default(); k],
            system: BlockTridiagonal::new(k),
            iterations: 0,
        }
    }

    /// Begins the stages of a step from `state`, whose modes hold through it.
    pub(super) fn begin(&mut self, model: &Model, state: &State, beta: f64) {
        self.state.mode.copy_from_slice(&state.mode);
        self.contacts.clear();
        self.contacts.extend((0..state.mode.len()).filter(|&i| state.mode[i].in_contact()));
        self.state.surface.copy_from_slice(&state.surface);
        self.slips.clear();
        self.slips.extend(self.contacts.iter().filter(|&&i| state.mode[i].slips()));
        self.slip.resize(self.slips.len(), Slip::default());
        if model.rate_shear.is_some() {
            self.rate.resize(self.slips.len(), RateSlip::default());
        }
        self.set_laws(model, beta);
        self.assemble_held(model, beta);
        if self.slips.is_empty() {
            self.system.factor();
        }
    }

    /// D = d + Σ_j c_j β τ_j/(τ_j + β) of every kind of link.
    fn set_laws(&mut self, model: &Model, beta: f64) {
        for (law, link) in self.laws.iter_mut().zip(&model.links) {
            *law = StageLaw { stiffness: link.stiffness, damping: link.damping, weight: 0.0 };
        }
        for row in &model.rows {
            let tau = row.relaxation_time;
            self.laws[row.kind as usize].damping += row.stiffness * beta * tau / (tau + beta);
        }
        for law in &mut self.laws {
            law.weight = beta * law.stiffness + law.damping;
        }
    }

    /// The masses in contact, in their order.
    pub(super) fn contacts(&self) -> &[usize] {
        &self.contacts
    }

    /// Solves the stage to `accuracy` and writes its rates.
    ///
    /// # Errors
    /// [`NoConvergence`] where Newton's iterations do not settle.
    pub(super) fn solve(
        &mut self,
        model: &Model,
        point: &StagePoint,
        accuracy: Accuracy,
        rates: &mut Rates,
    ) -> Result<(), NoConvergence> {
        self.set_positions(model, point);
        self.forces(model, point);
        if self.slips.is_empty() {
            self.solve_linear(model, point)?;
        } else {
            self.iterate(model, point, accuracy)?;
        }
        self.finish(model, point, rates);
        Ok(())
    }

    /// The equations without slip, which do not depend on where the masses are: one factorisation serves a whole step.
    fn solve_linear(&mut self, model: &Model, point: &StagePoint) -> Result<(), NoConvergence> {
        self.residuals(model, point.beta);
        self.system.solve();
        let change = self.correct();
        self.set_positions(model, point);
        self.forces(model, point);
        if change.is_finite() { Ok(()) } else { Err(NoConvergence) }
    }

    /// Newton's iterations. What is left after one is known in two ways, both from the residual at the new place: the
    /// inertia alone would turn it into a velocity at most so large; and as the residual fell, so will the correction.
    fn iterate(&mut self, model: &Model, point: &StagePoint, accuracy: Accuracy) -> Result<(), NoConvergence> {
        let mut residual = self.residuals(model, point.beta);
        let mut last = f64::INFINITY;
        for _ in 0..MOST_ITERATIONS {
            self.assemble_slips(model, point.beta);
            self.system.factor();
            self.system.solve();
            let steep = model.rate_shear.as_ref().map_or(0.0, |law| self.bend_corrections(law));
            let change = self.correct().max(steep);
            self.set_positions(model, point);
            self.forces(model, point);
            let left = self.residuals(model, point.beta);
            let next = change * (left / residual);
            let settled = left.min(next) <= accuracy.newton;
            // Roundings alone are left when the corrections no longer fall and are below what the step may err by.
            let stalled = change >= 0.25 * last && change <= accuracy.roundings;
            if !(change.is_finite() && left.is_finite()) {
                return Err(NoConvergence);
            }
            if settled || stalled || change == 0.0 {
                return Ok(());
            }
            (last, residual) = (change, left);
        }
        Err(NoConvergence)
    }

    /// Positions from the velocities; the constraint put in.
    fn set_positions(&mut self, model: &Model, point: &StagePoint) {
        let beta = point.beta;
        let (state, history) = (&mut self.state, &self.history);
        carry(&mut state.elongation_x, &history.elongation_x, (beta, &state.velocity_x), point.driven.0);
        carry(&mut state.elongation_z, &history.elongation_z, (beta, &state.velocity_z), point.driven.1);
        for &i in &self.contacts {
            if state.mode[i] == Mode::Stick {
                state.elongation_x[i] = history.elongation_x[i] - point.moved;
            } else {
                let surface = model.surface_at(model.rest_x[i] + (point.profile_position + state.elongation_x[i]));
                state.velocity_z[i] = surface.slope * state.velocity_x[i];
                state.surface[i] = surface;
            }
            state.elongation_z[i] = state.surface[i].height - model.rest_z[i] - point.w;
        }
    }

    /// Forces of the links and on the masses, by the stage's law.
    fn forces(&mut self, model: &Model, point: &StagePoint) {
        let motion = LinkMotion::of(&self.state, &point.carrier);
        for kind in LinkKind::ALL {
            let law = &self.laws[kind as usize];
            let known = &self.history.force[kind as usize];
            self.forces.spring_and_damper(kind, (law.stiffness, law.damping), &motion, known);
            model.subtract_frozen(kind, &mut self.forces.link[kind as usize]);
        }
        self.forces.sum_on_masses();
    }

    /// Adds the corrections to the velocities, which is one iteration; the largest, m/s.
    fn correct(&mut self) -> f64 {
        self.iterations += 1;
        let velocities = self.state.velocity_x.iter_mut().zip(&mut self.state.velocity_z);
        for ((v_x, v_z), correction) in velocities.zip(&self.system.right) {
            *v_x += correction.x;
            *v_z += correction.y;
        }
        largest(&self.system.right)
    }

    /// The rates of the solved stage.
    fn finish(&mut self, model: &Model, point: &StagePoint, rates: &mut Rates) {
        let per_beta = 1.0 / point.beta;
        let (state, history) = (&self.state, &self.history);
        rates.velocity_x.copy_from_slice(&state.velocity_x);
        rates.velocity_z.copy_from_slice(&state.velocity_z);
        rate_of_change(&mut rates.acceleration_x, &state.velocity_x, &history.velocity_x, per_beta);
        rate_of_change(&mut rates.acceleration_z, &state.velocity_z, &history.velocity_z, per_beta);
        std::mem::swap(&mut rates.elongation_rate, &mut self.forces.rate);
        rates.clear_contacts();
        for &i in &self.contacts {
            let (mode, v, surface) = (state.mode[i], state.velocity_x[i], &state.surface[i]);
            if mode == Mode::Stick {
                rates.acceleration_x[i] = 0.0;
            }
            let contact = self.forces.contact(model, i, v, surface);
            rates.contact(model, i, (mode, v), surface, &contact);
        }
    }
}

/// e = e* + β v less what the carrier has moved.
fn carry(elongation: &mut [f64], star: &[f64], (beta, velocity): (f64, &[f64]), moved: f64) {
    for (elongation, (star, velocity)) in elongation.iter_mut().zip(star.iter().zip(velocity)) {
        *elongation = star + beta * velocity - moved;
    }
}

/// rate = (now - before) / β.
fn rate_of_change(rate: &mut [f64], now: &[f64], before: &[f64], per_beta: f64) {
    for (rate, (now, before)) in rate.iter_mut().zip(now.iter().zip(before)) {
        *rate = (now - before) * per_beta;
    }
}
