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
mod modes;
mod newton;

use std::hint::select_unpredictable;
use std::ops::Range;

use nalgebra::Vector2;

use super::heat::StageFlash;
use super::scheme::ContactModes;
use super::stage_values::{NO_LIMIT, StageValues};
use super::tolerance::{NEWTON_SHARE, Tolerance};
use crate::math::{BLOCK, BlockTridiagonal, Spline, weighted_sum, with_widest_vectors};
use crate::model::{
    ByAxis, ByLink, CarrierPoint, ContactForces, Forces, FrictionPower, LinkKind, LinkLaw, LinkMotion, Mode, Model,
    State, SurfacePoint,
};
use newton::{NeighbourWeights, RowShares, StageFriction, largest_of};

pub(super) use border::{BodyHistory, Border};
pub(super) use newton::SlippingMass;

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
    fn profile_position(&self) -> f64 {
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
            rows: vec![RowShares::default(); k],
            columns: vec![NeighbourWeights::default(); k],
            system: BlockTridiagonal::new(k),
            border: Border::new(model),
            factors: Factors::Outdated,
            iterations: 0,
        }
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
        if self.slips.is_empty() {
            self.system.factor_uncoupled();
            self.factor_border(model, beta);
        }
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
        if self.slips.is_empty() {
            self.solve_linear(model, point)?;
        }
        if !self.slips.is_empty() || self.change_modes(model, point) {
            self.iterate(model, point, test)?;
        }
        self.write_rates(model, point, rates);
        if self.slips_continuously() { Ok(()) } else { Err(NoConvergence) }
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
        self.assemble_slips(model, beta);
        self.system.factor();
        self.factor_border(model, beta);
        if self.factors == Factors::Outdated && model.friction.is_linear() {
            self.factors = Factors::Held;
        }
    }

    /// Computes the positions and the forces from the velocities.
    fn evaluate(&mut self, model: &Model, point: &StagePoint) {
        with_widest_vectors(
            #[inline(always)]
            || {
                self.set_positions(model, point);
                self.set_forces(point);
            },
        );
    }

    /// Computes the positions from the velocities and puts the contact constraint in.
    #[inline(always)]
    fn set_positions(&mut self, model: &Model, point: &StagePoint) {
        let (beta, profile_position, w) = (point.beta, point.profile_position(), point.w());
        let (state, history) = (&mut self.state, &self.history);
        set_elongations(&mut state.elongation_x, &history.elongation_x, beta, &state.velocity_x, point.integrated.x);
        set_elongations(&mut state.elongation_z, &history.elongation_z, beta, &state.velocity_z, point.integrated.z);
        for &i in &self.sticks {
            state.elongation_x[i] = history.elongation_x[i] - point.moved;
            state.elongation_z[i] = state.surface[i].height - model.rest_z[i] - w;
        }
        for slips in &self.slip_runs {
            let (surface, e_z) = (&mut state.surface[slips.clone()], &mut state.elongation_z[slips.clone()]);
            let (e_x, v_x) = (&state.elongation_x[slips.clone()], &state.velocity_x[slips.clone()]);
            let (rest_x, rest_z) = (&model.rest_x[slips.clone()], &model.rest_z[slips.clone()]);
            set_surface(surface, &model.profile, rest_x, e_x, profile_position);
            set_on_surface(&mut state.velocity_z[slips.clone()], e_z, surface, v_x, rest_z, w);
        }
    }

    /// Computes the forces of the links and on the masses by the stage's law.
    #[inline(always)]
    fn set_forces(&mut self, point: &StagePoint) {
        let motion = LinkMotion::new(&self.state, &point.carrier);
        self.forces.evaluate_with(&self.laws, &motion, &self.history.force);
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

    /// Writes the rates of the solved stage.
    fn write_rates(&mut self, model: &Model, point: &StagePoint, rates: &mut StageValues) {
        with_widest_vectors(
            #[inline(always)]
            || {
                self.set_rates(point, rates);
                if model.friction.is_linear() {
                    let StageValues { acceleration_x, acceleration_z, normal, margin, .. } = rates;
                    set_contact_motion(acceleration_z, normal, acceleration_x, model, &self.state, &self.forces);
                    set_slips(&mut self.slip_speed, margin, model, &self.state);
                }
            },
        );
        if model.friction.is_linear() {
            self.set_stick_rates(model, rates);
            self.friction_power = FrictionPower::from_linear_law(&model.friction, &self.slip_speed, &rates.normal);
        } else {
            self.set_contact_rates(model, rates);
        }
    }

    #[inline(always)]
    fn set_rates(&self, point: &StagePoint, rates: &mut StageValues) {
        let per_beta = 1.0 / point.beta;
        let (state, history) = (&self.state, &self.history);
        rates.velocity_x.copy_from_slice(&state.velocity_x);
        rates.velocity_z.copy_from_slice(&state.velocity_z);
        rate_of_change(&mut rates.acceleration_x, &state.velocity_x, &history.velocity_x, per_beta);
        rate_of_change(&mut rates.acceleration_z, &state.velocity_z, &history.velocity_z, per_beta);
        let motion = LinkMotion::new(state, &point.carrier);
        for (kind, rate) in LinkKind::ALL.into_iter().zip(&mut rates.elongation_rate) {
            motion.elongation_rates(kind, rate);
        }
    }

    /// Sets what differs of sticking masses from slipping ones.
    fn set_stick_rates(&self, model: &Model, rates: &mut StageValues) {
        for &i in &self.sticks {
            let surface = &self.state.surface[i];
            let contact = self.forces.contact(model, i, 0.0, surface);
            (rates.acceleration_x[i], rates.acceleration_z[i]) = (0.0, 0.0);
            rates.margin[i] = contact.limit - contact.tangential.abs();
        }
    }

    /// Sets the rates of the masses in contact, and the power of friction.
    fn set_contact_rates(&mut self, model: &Model, rates: &mut StageValues) {
        let mut friction_power = FrictionPower::default();
        rates.clear_contacts();
        let state = &self.state;
        let k = state.mode.len();
        let (modes, velocities, surfaces) = (&state.mode[..k], &state.velocity_x[..k], &state.surface[..k]);
        let (f_x, f_z) = (&self.forces.on_mass_x[..k], &self.forces.on_mass_z[..k]);
        let mut slips = self.friction.iter();
        for &i in &self.contacts {
            let (mode, v, surface, forces) = (modes[i], velocities[i], &surfaces[i], (f_x[i], f_z[i]));
            let slip = if mode.slips() { slips.next() } else { None };
            let Some(StageFriction { friction, .. }) = slip else {
                rates.acceleration_x[i] = 0.0;
                rates.set_contact(model, i, mode, v, surface, &ContactForces::new(model, forces, v, surface));
                continue;
            };
            let contact = ContactForces::without_limit(model.mass, forces, v, surface);
            rates.set_contact(model, i, mode, v, surface, &contact);
            friction_power.add(&model.friction, mode, v, &contact, friction);
            if let Some(flux) = rates.heat_flux.get_mut(i) {
                *flux = self.flash.heat_flux(friction.force(), v * contact.q);
            }
        }
        self.friction_power = friction_power;
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

/// e = e* + β v less the carrier's displacement.
#[inline(always)]
fn set_elongations(elongation: &mut [f64], star: &[f64], beta: f64, velocity: &[f64], moved: f64) {
    for (elongation, (star, velocity)) in elongation.iter_mut().zip(star.iter().zip(velocity)) {
        *elongation = star + beta * velocity - moved;
    }
}

/// rate = (now - before) / β.
#[inline(always)]
fn rate_of_change(rate: &mut [f64], now: &[f64], before: &[f64], per_beta: f64) {
    for (rate, (now, before)) in rate.iter_mut().zip(now.iter().zip(before)) {
        *rate = (now - before) * per_beta;
    }
}

// The slices that the following functions write are arguments of their own. By that the compiler knows that they do not
// overlap what is read, and makes vector instructions of the loops.

/// A run of slipping masses that is shorter is put on the profile one by one.
const SHORT_RUN: usize = 6;

/// Sets the profile under slipping masses that follow one another.
#[inline(always)]
fn set_surface(surface: &mut [SurfacePoint], profile: &Spline, rest_x: &[f64], e_x: &[f64], profile_position: f64) {
    let place = |rest: &f64, e: &f64| rest + (profile_position + e);
    if surface.len() < SHORT_RUN {
        for (surface, (rest, e)) in surface.iter_mut().zip(rest_x.iter().zip(e_x)) {
            *surface = SurfacePoint::on(profile, place(rest, e));
        }
        return;
    }
    let mut places = [0.0; BLOCK];
    for (surface, (rest_x, e_x)) in surface.chunks_mut(BLOCK).zip(rest_x.chunks(BLOCK).zip(e_x.chunks(BLOCK))) {
        let places = &mut places[..surface.len()];
        for (at, (rest, e)) in places.iter_mut().zip(rest_x.iter().zip(e_x)) {
            *at = place(rest, e);
        }
        profile.evaluate_block(places, surface);
    }
}

/// Sets ż and e_z of slipping masses that follow one another, on the `surface`, under the carrier at `w` (m).
#[inline(always)]
fn set_on_surface(v_z: &mut [f64], e_z: &mut [f64], surface: &[SurfacePoint], v_x: &[f64], rest_z: &[f64], w: f64) {
    let masses = v_z.iter_mut().zip(e_z).zip(v_x.iter().zip(rest_z));
    for (((v_z, e_z), (v_x, rest_z)), surface) in masses.zip(surface) {
        *v_z = surface.slope * v_x;
        *e_z = surface.height - rest_z - w;
    }
}

/// Sets z̈ and F_N of the masses in contact, of sticking ones as of slipping ones, and F_N of free ones.
#[inline(always)]
fn set_contact_motion(
    acceleration_z: &mut [f64],
    normal: &mut [f64],
    acceleration_x: &[f64],
    model: &Model,
    state: &State,
    forces: &Forces,
) {
    // Slices of one length, so that an index into one of them is one into all.
    let k = normal.len();
    let (a_z, a_x) = (&mut acceleration_z[..k], &acceleration_x[..k]);
    let (mode, surface, v_x) = (&state.mode[..k], &state.surface[..k], &state.velocity_x[..k]);
    let (f_x, f_z) = (&forces.on_mass_x[..k], &forces.on_mass_z[..k]);
    let mass = model.mass;
    for i in 0..k {
        let (v, is_free) = (v_x[i], mode[i] == Mode::Free);
        let of_contact = ContactForces::without_limit(mass, (f_x[i], f_z[i]), v, &surface[i]).normal;
        let along_surface = surface[i].slope * a_x[i] + surface[i].curvature * v * v;
        a_z[i] = select_unpredictable(is_free, a_z[i], along_surface);
        normal[i] = select_unpredictable(is_free, NO_LIMIT, of_contact);
    }
}

/// Sets the speeds of slip, and the margins of the slipping masses as those of the others, under a linear law of
/// friction.
#[inline(always)]
fn set_slips(slip_speed: &mut [f64], margin: &mut [f64], model: &Model, state: &State) {
    // Slices of one length, so that an index into one of them is one into all.
    let k = slip_speed.len();
    let (margin, mode) = (&mut margin[..k], &state.mode[..k]);
    let (surface, v_x) = (&state.surface[..k], &state.velocity_x[..k]);
    let has_friction = model.friction.present;
    for i in 0..k {
        let (sigma, s) = (mode[i].direction(), surface[i].slope);
        let along_x = sigma * v_x[i];
        let speed = along_x * (1.0 + s * s).sqrt();
        margin[i] = select_unpredictable(sigma != 0.0 && has_friction, along_x, NO_LIMIT);
        slip_speed[i] = select_unpredictable(sigma != 0.0, speed, 0.0);
    }
}
