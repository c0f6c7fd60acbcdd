//! One implicit stage (docs/theory.md, sections 1 to 4).
//!
//! A stage at t_i with β = γh looks for v_i, and so for e_i = e* + β ė_i and v_i = v* + β v̇_i, where the starred
//! values hold the contributions of the earlier stages. The Maxwell elements add H + h Q_ii ė_i to a link's force (see
//! `maxwell`), so its force is
//!
//!   F = H + c e + D ė,   D = d + h Q_ii.
//!
//! This leaves one 2×2 block per mass in the velocities, block tridiagonal along the chain. A contact is the same block
//! projected onto (1, s)ᵀ: its second row is the identity; for a sticking mass both are. So a contact that stops or
//! breaks loose changes rows, not the shape of the system.

mod border;
mod motion;
mod newton;
mod slipping_mass;
mod spatial;

use std::ops::Range;

use nalgebra::Vector2;
use slipping_mass::{NeighbourWeights, RowShares, StageFriction, largest_of};

use super::heat::StageFlash;
use super::maxwell::MeasuredSquares;
use super::memory::StageMemory;
use super::scheme::ContactModes;
use super::stage_values::StageValues;
use super::tolerance::{NEWTON_SHARE, Tolerance};
use crate::math::{BlockTridiagonal, weighted_sum, with_widest_vectors};
use crate::model::{
    ByAxis, ByLink, CarrierPoint, ContactForces, Forces, FrictionPower, LinkKind, LinkLaw, Mode, Model, SlipHistory,
    State,
};

pub(super) use border::{BodyHistory, Border};
pub(super) use slipping_mass::{SlipVariation, SlippingMass};

/// Newton's iterations did not converge. They will for a shorter step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoConvergence;

/// Contributions of the earlier stages to a stage: the starred values and the known forces of the Maxwell elements.
#[derive(Clone, Debug)]
pub(super) struct MassHistory {
    /// e*_x, m: as if the carrier stood where it was at the start of the step.
    pub elongation_x: Vec<f64>,
    /// e*_z, m.
    pub elongation_z: Vec<f64>,
    /// v*_x, m/s.
    pub velocity_x: Vec<f64>,
    /// v*_z, m/s.
    pub velocity_z: Vec<f64>,
    /// H by kind of link, N; empty where the scene has no such link.
    pub force: ByLink<Vec<f64>>,
}

impl MassHistory {
    fn new(model: &Model) -> Self {
        let zero = vec![0.0; model.masses()];
        Self {
            elongation_x: zero.clone(),
            elongation_z: zero.clone(),
            velocity_x: zero.clone(),
            velocity_z: zero,
            force: Forces::zeros_by_link(model),
        }
    }

    /// Subtracts the forces of the frozen dashpots from H.
    fn subtract_frozen(&mut self, model: &Model) {
        for kind in LinkKind::ALL.into_iter().filter(|&kind| model.frozen_stiffness[kind] > 0.0) {
            let force = &mut self.force[kind];
            if model.rows_of(kind).next().is_none() {
                force.fill(0.0);
            }
            model.subtract_frozen(kind, force);
        }
    }
}

/// A stage's time step and the carrier at it.
#[derive(Clone, Copy, Debug)]
pub(super) struct StagePoint {
    /// β = γh, s.
    pub beta: f64,
    pub carrier: CarrierPoint,
    /// Displacement of the carrier since the start of the step along x and z by the method's quadrature of its rate, m.
    pub integrated: ByAxis<f64>,
    /// Its exact displacement along x, m, by which a sticking mass falls behind.
    pub moved: f64,
    /// u as a position on the profile and w at the start of the carrier's segment, m.
    pub segment_start: ByAxis<f64>,
}

impl StagePoint {
    /// u at the stage as a position on the profile, m.
    pub(in crate::integrator) fn profile_position(&self) -> f64 {
        self.segment_start.x + self.carrier.x.position
    }

    /// w at the stage, m.
    fn w(&self) -> f64 {
        self.segment_start.z + self.carrier.z.position
    }
}

/// The convergence test of Newton's iterations of a stage, in terms of corrections of the velocities, m/s.
#[derive(Clone, Copy, Debug)]
pub(super) struct ConvergenceTest {
    /// The iterations end when the next correction would be below this.
    converged: f64,
    /// They may end below this if the corrections no longer fall, since only rounding errors remain.
    stalled: f64,
}

impl ConvergenceTest {
    /// For stages with β = `beta` (s), at `slack` times the recommended tolerance.
    pub(super) fn new(tolerance: &Tolerance, beta: f64, slack: f64) -> Self {
        let newton = slack * tolerance.newton(beta);
        Self { converged: newton.min(tolerance.newton_of_rods(beta)), stalled: newton / NEWTON_SHARE }
    }
}

/// Which slipping stages the factors of the Jacobian serve. It changes little through a step, so that those of one
/// stage nearly always do for the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Factors {
    /// None: they are of another step.
    Outdated,
    /// The further stages of the step, too.
    Held,
    /// One iteration: a stage of the step did not converge at once with those of another.
    Single,
}

/// Solver of the stages of one model.
#[derive(Clone, Debug)]
pub(super) struct StageSolver {
    /// To be set before a stage is solved.
    pub history: MassHistory,
    /// The state at the stage without its Maxwell elements. Its velocities are the initial guess before the solution.
    pub state: State,
    /// The forces at the stage.
    pub forces: Forces,
    /// The power of friction at the solved stage.
    pub friction_power: FrictionPower,
    /// σ v_t of the slipping masses at the solved stage, 0 of the others, m/s.
    slip_speed: Vec<f64>,
    /// What becomes of the contact modes through the step.
    modes: ContactModes,
    /// The links' laws with D in place of the damping d.
    pub laws: ByLink<LinkLaw>,
    /// -∂F/∂v of a link to a free mass: βc + D.
    weights: ByLink<f64>,
    /// The modes of which the following are lists.
    listed: Vec<Mode>,
    /// The masses in contact, in their order.
    contacts: Vec<usize>,
    /// Those of them that slip, in their order; without any the equations are linear.
    slips: Vec<usize>,
    /// Those of them that stick.
    sticks: Vec<usize>,
    /// The slipping ones as runs of masses that follow one another.
    slip_runs: Vec<Range<usize>>,
    /// The friction of the slipping ones under a law that is not linear; empty under one that is.
    friction: Vec<StageFriction>,
    /// Their flash temperatures at the stage.
    pub flash: StageFlash,
    /// The speeds that the masses remember at the stage.
    pub memory: StageMemory,
    /// The Maxwell elements of links in spatial measure; to be set before a stage is solved.
    pub measured: Option<Box<MeasuredSquares>>,
    rows: Vec<RowShares>,
    columns: Vec<NeighbourWeights>,
    pub system: BlockTridiagonal,
    /// The bodies of the carrier; `None` where there are none.
    pub border: Option<Box<Border>>,
    /// Which stages the factors of the system serve.
    factors: Factors,
    /// Newton iterations since the start of the run.
    pub iterations: u64,
}

/// Iterations after which Newton's method has failed; one or two are usual.
const MAX_ITERATIONS: usize = 10;
/// [`MAX_ITERATIONS`] where modes change between the iterations, some masses at a time. They may also change to and
/// fro: then a shorter step decides, in which the momentum of the masses does.
const MAX_WITH_CHANGES: usize = 30;

/// With the factors of another stage the error falls by a constant ratio, so that the next correction bounds it only
/// where that is small.
const HELD_FALL: f64 = 0.25;

impl StageSolver {
    pub(super) fn new(model: &Model) -> Self {
        let k = model.masses();
        Self {
            history: MassHistory::new(model),
            state: State::new(model),
            forces: Forces::new(model),
            friction_power: FrictionPower::default(),
            slip_speed: vec![0.0; k],
            modes: ContactModes::Held,
            laws: ByLink::default(),
            weights: ByLink::default(),
            listed: vec![Mode::Free; k],
            contacts: Vec::with_capacity(k),
            slips: Vec::with_capacity(k),
            sticks: Vec::with_capacity(k),
            slip_runs: Vec::with_capacity(k.div_ceil(2)),
            friction: Vec::with_capacity(if model.friction.is_linear() { 0 } else { k }),
            flash: StageFlash::new(model),
            memory: StageMemory::new(model),
            measured: model.spatial.map(|_| Box::new(MeasuredSquares::new(model))),
            rows: vec![RowShares::default(); k],
            columns: vec![NeighbourWeights::default(); k],
            system: BlockTridiagonal::new(k),
            border: Border::new(model),
            factors: Factors::Outdated,
            iterations: 0,
        }
    }

    /// What is known of the past of mass `i` at the stage.
    #[inline]
    pub(super) fn slip_history(&self, i: usize) -> SlipHistory {
        SlipHistory { flash: self.flash.of_mass(i), memory: self.memory.of_mass(i) }
    }

    /// Prepares the stages of a step from `state`, through which its `modes` are held or not.
    pub(super) fn begin(&mut self, model: &Model, state: &State, beta: f64, modes: ContactModes) {
        self.modes = modes;
        self.state.mode.copy_from_slice(&state.mode);
        self.state.surface.copy_from_slice(&state.surface);
        self.set_laws(model, beta);
        self.hold_modes(model, beta);
    }

    /// Assembles what is constant while these modes are held.
    fn hold_modes(&mut self, model: &Model, beta: f64) {
        if self.listed != self.state.mode {
            self.list_contacts(model);
        }
        self.assemble_constant_rows(model, beta);
        self.factors = Factors::Outdated;
        if self.is_linear() {
            self.system.factor_uncoupled();
            self.factor_border(model, beta);
        }
    }

    /// Whether the stages' equations are linear: no mass slips, and no link is measured by the present spacing.
    fn is_linear(&self) -> bool {
        self.slips.is_empty() && self.measured.is_none()
    }

    /// Lists the masses in contact, and those of them that slip.
    fn list_contacts(&mut self, model: &Model) {
        let modes = &self.state.mode;
        self.listed.copy_from_slice(modes);
        self.contacts.clear();
        self.contacts.extend((0..modes.len()).filter(|&i| modes[i].in_contact()));
        self.slips.clear();
        self.slips.extend(self.contacts.iter().filter(|&&i| modes[i].slips()));
        self.sticks.clear();
        self.sticks.extend(self.contacts.iter().filter(|&&i| modes[i] == Mode::Stick));
        self.slip_runs.clear();
        let runs = self.slips.chunk_by(|&i, &next| i + 1 == next);
        self.slip_runs.extend(runs.map(|run| run[0]..run[0] + run.len()));
        if !model.friction.is_linear() {
            self.friction.resize(self.slips.len(), StageFriction::default());
        }
    }

    /// Sets c and D = d + Σ_j c_j β τ_j/(τ_j + β) of every kind of link.
    fn set_laws(&mut self, model: &Model, beta: f64) {
        self.laws = model.links;
        for row in &model.rows {
            let tau = row.relaxation_time;
            self.laws[row.kind].damping += row.stiffness * beta * tau / (tau + beta);
        }
        self.weights = self.laws.map(|law| law.by_velocity(beta));
    }

    /// The masses in contact, in their order.
    pub(super) fn contacts(&self) -> &[usize] {
        &self.contacts
    }

    /// Those of them that stick.
    pub(super) fn sticks(&self) -> &[usize] {
        &self.sticks
    }

    /// Guesses the velocities: of the slipping masses the starred ones and the sum of the accelerations at `earlier`
    /// stages, with their weights, s; of the others those of `start`.
    pub(super) fn guess<'a>(&mut self, start: &State, earlier: impl Iterator<Item = (f64, &'a StageValues)>) {
        let (guess, star) = (&mut self.state, &self.history.velocity_x);
        guess.velocity_z.copy_from_slice(&start.velocity_z);
        if self.slips.is_empty() {
            guess.velocity_x.copy_from_slice(&start.velocity_x);
            return;
        }
        let of_star = std::iter::once((1.0, &star[..]));
        let of_stages = earlier.map(|(weight, stage)| (weight, &stage.acceleration_x[..]));
        weighted_sum(&mut guess.velocity_x, of_star.chain(of_stages));
        if self.slips.len() == guess.mode.len() {
            return;
        }
        for ((velocity, start), mode) in guess.velocity_x.iter_mut().zip(&start.velocity_x).zip(&guess.mode) {
            *velocity = if mode.slips() { *velocity } else { *start };
        }
    }

    /// Guesses those slips that were to be faster than `most` times their speed at the start of the step to go on with
    /// the velocity there, m/s.
    pub(super) fn limit_guess(&mut self, start: &[f64], most: f64) {
        for &i in &self.slips {
            if self.state.velocity_x[i].abs() > most * start[i].abs() {
                self.state.velocity_x[i] = start[i];
            }
        }
    }

    /// Solves the stage, whose history is set, and writes its rates.
    ///
    /// # Errors
    /// [`NoConvergence`] where Newton's iterations do not converge.
    pub(super) fn solve(
        &mut self,
        model: &Model,
        point: &mut StagePoint,
        test: ConvergenceTest,
        rates: &mut StageValues,
    ) -> Result<(), NoConvergence> {
        self.history.subtract_frozen(model);
        self.move_bodies(Vector2::zeros(), point);
        self.start_sticks_from_rest();
        self.evaluate(model, point);
        if self.is_linear() {
            self.solve_linear(model, point)?;
        }
        if !self.is_linear() || self.change_modes(model, point) {
            self.iterate(model, point, test)?;
        }
        self.write_rates(model, point, rates);
        let is_borne = self.forces.spatial.as_ref().is_none_or(|measure| measure.is_borne());
        if is_borne && self.slips_continuously() { Ok(()) } else { Err(NoConvergence) }
    }

    /// Whether no contact heats itself so much that the step may have other solutions.
    fn slips_continuously(&self) -> bool {
        self.friction.iter().take(self.slips.len()).all(|slip| self.flash.is_continuous(slip.friction.feedback))
    }

    /// Solves the equations without slip, which are linear: their matrix is factored once per step.
    fn solve_linear(&mut self, model: &Model, point: &mut StagePoint) -> Result<(), NoConvergence> {
        self.set_residuals(model, point.beta);
        // Slips alone couple the motions along x and z.
        self.system.solve_uncoupled();
        let of_bodies = self.complete_border();
        let change = self.correct().max(of_bodies.amax());
        self.move_bodies(of_bodies, point);
        self.evaluate(model, point);
        if change.is_finite() { Ok(()) } else { Err(NoConvergence) }
    }

    /// Newton's iterations. The error after an iteration is bounded in two ways by the residual at the new velocities:
    /// by the velocity that it makes against the inertia alone, and by the correction times the ratio by which the
    /// residual fell.
    fn iterate(&mut self, model: &Model, point: &mut StagePoint, test: ConvergenceTest) -> Result<(), NoConvergence> {
        let mut residual = self.residuals(model, point.beta);
        let mut last = f64::INFINITY;
        let max_iterations = match self.modes {
            ContactModes::Held => MAX_ITERATIONS,
            ContactModes::SetValued => MAX_WITH_CHANGES,
        };
        for _ in 0..max_iterations {
            // The correction, by the factors of this stage or of another.
            let held = self.factors == Factors::Held;
            if !held {
                self.factor_slips(model, point.beta);
            }
            let of_bodies = self.solve_bordered();
            let steep = if model.friction.depends_on_speed() {
                self.correct_along_friction_curve(model, point.beta)
            } else {
                0.0
            };
            let change = self.correct().max(steep).max(of_bodies.amax());
            self.move_bodies(of_bodies, point);
            self.evaluate(model, point);
            // The error that is left.
            let left = self.residuals(model, point.beta);
            let next = change * (left / residual);
            let falls = !held || left <= HELD_FALL * residual;
            let converged = left <= test.converged || (falls && next <= test.converged);
            // Only rounding errors remain when the corrections no longer fall and are within the step's tolerance.
            let stalled = change >= 0.25 * last && change <= test.stalled;
            if !(change.is_finite() && left.is_finite()) {
                return Err(NoConvergence);
            }
            // Other modes are other equations: the iterations begin anew.
            if self.change_modes(model, point) {
                (last, residual) = (f64::INFINITY, self.residuals(model, point.beta));
                continue;
            }
            if converged || stalled || change == 0.0 {
                return Ok(());
            }
            self.factors = if held { Factors::Single } else { self.factors };
            (last, residual) = (change, left);
        }
        Err(NoConvergence)
    }

    /// Factors the Jacobian at the velocities of the last residuals. Friction that is not linear changes it too much
    /// for another stage.
    fn factor_slips(&mut self, model: &Model, beta: f64) {
        self.assemble(model, beta);
        self.system.factor();
        self.factor_border(model, beta);
        if self.factors == Factors::Outdated && model.friction.is_linear() {
            self.factors = Factors::Held;
        }
    }

    /// Adds the corrections to the velocities, which ends an iteration, and returns the largest, m/s.
    fn correct(&mut self) -> f64 {
        self.iterations += 1;
        let (State { velocity_x, velocity_z, .. }, corrections) = (&mut self.state, &self.system.right[..]);
        with_widest_vectors(
            #[inline(always)]
            || {
                add_corrections(velocity_x, velocity_z, corrections);
                largest_of(corrections)
            },
        )
    }
}

/// Adds to each velocity its correction.
#[inline(always)]
fn add_corrections(v_x: &mut [f64], v_z: &mut [f64], corrections: &[Vector2<f64>]) {
    for ((v_x, v_z), correction) in v_x.iter_mut().zip(v_z).zip(corrections) {
        *v_x += correction.x;
        *v_z += correction.y;
    }
}

impl StageSolver {
    /// Stops the slips that have reversed and breaks the sticks that hold more than T(0), by the velocities and forces
    /// evaluated last. Returns whether a mode has changed.
    fn change_modes(&mut self, model: &Model, point: &StagePoint) -> bool {
        if self.modes == ContactModes::Held || !model.friction.present {
            return false;
        }
        let mut changed = false;
        for contact in 0..self.contacts.len() {
            let i = self.contacts[contact];
            let mode = self.mode_by_residual(model, i, point.beta);
            if mode == self.state.mode[i] {
                continue;
            }
            changed = true;
            self.state.mode[i] = mode;
            if mode == Mode::Stick {
                self.stop(model, i, point);
            }
        }
        if changed {
            self.hold_modes(model, point.beta);
            self.evaluate(model, point);
        }
        changed
    }

    /// Puts mass `i` where the stages before have brought it, at rest.
    fn stop(&mut self, model: &Model, i: usize, point: &StagePoint) {
        (self.state.velocity_x[i], self.state.velocity_z[i]) = (0.0, 0.0);
        let elongation = self.history.elongation_x[i] - point.moved;
        self.state.surface[i] = model.surface_at(model.rest_x[i] + (point.profile_position() + elongation));
    }

    /// The mode in which the residual of contact `i` can vanish: a slip goes on in its direction, and a mass at rest
    /// may need at most T(0) to be held, its momentum m v*/β included.
    fn mode_by_residual(&self, model: &Model, i: usize, beta: f64) -> Mode {
        let (mode, v) = (self.state.mode[i], self.state.velocity_x[i]);
        if mode.slips() {
            return if mode.direction() * v < 0.0 { Mode::Stick } else { mode };
        }
        let (surface, history) = (&self.state.surface[i], self.slip_history(i));
        let contact = ContactForces::new(model, self.forces.on_mass(i), 0.0, surface, &history);
        let held = contact.tangential + model.mass * contact.q * self.history.velocity_x[i] / beta;
        if held.abs() > contact.limit.max(0.0) { Mode::along(held) } else { Mode::Stick }
    }

    /// A mass that stuck at the stage before goes on from rest: friction has taken up its momentum.
    fn start_sticks_from_rest(&mut self) {
        for &i in &self.sticks {
            self.history.velocity_x[i] = 0.0;
        }
    }
}
