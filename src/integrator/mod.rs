//! The implicit Runge-Kutta methods: attempts and acceptance of single steps of the layer, their error tests, dense
//! outputs, energies and sensitivities.
//!
//! Three schemes share one implementation: [`ESDIRK3`] and [`ESDIRK5`] for event-driven runs, and [`SDIRK2`], of order
//! 2 with two implicit stages, for time-stepping. They differ in their numbers, and in what becomes of the
//! [`ContactModes`] within a step: the first two hold them, in the steps of the third contacts stop and break loose as
//! the forces at the stages say.

mod carrier_sums;
mod dense;
mod dense_weights;
mod energy;
mod error;
mod heat;
mod interpolation;
mod maxwell;
mod memory;
mod method;
mod parabolas;
mod polynomials;
mod scheme;
mod sensitivity;
mod stage;
mod stage_values;
mod sums;
mod tableau;
mod tolerance;

pub use dense::DenseOutput;
pub use dense_weights::DenseWorkspace;
pub use error::ErrorEstimate;
pub use interpolation::Interpolation;
pub use method::TimeSpan;
pub use parabolas::Parabolas;
pub use polynomials::Polynomials;
pub use scheme::{ContactModes, Scheme};
pub use stage::NoConvergence;
pub use stage_values::{LayerState, NO_LIMIT, StageValues};
pub use sums::LayerSums;
pub use sums::{InterpolatedLayer, LayerStep, Overlay};
pub use tableau::{ContinuousWeights, ESDIRK3, ESDIRK5, MAX_STAGES, SDIRK2, StageWeights, Tableau};
pub use tolerance::RunningMaxima;
pub use tolerance::Tolerance;

use crate::model::{Axis, Tangents};
use crate::model::{
    BodyInterpolant, BoundaryPowers, ByAxis, Carrier, CarrierPoint, ChannelEnergies, Forces, Model, State,
};
use error::ErrorWorkspace;
use method::{RungeKutta, Stages, StepAttempt};
use stage::{ConvergenceTest, StageSolver};
use tableau::{GAMMA, SDIRK2_ESTIMATE};

/// The error tolerance of Newton's iterations in a step of two stages, as a multiple of the one in an event-driven
/// step. Iterations are the cost of such a step, and the error that they leave is known to be smaller than this.
const NEWTON_SLACK: f64 = 2.0;
/// [`NEWTON_SLACK`] where friction depends on the speed. Corrections fall slowly there, and the estimate of the step's
/// error multiplies what they leave by [`SDIRK2_ESTIMATE`] over γ: the step length would follow it and not the motion.
const STEEP_SLACK: f64 = 0.1;

/// Attempts and accepts steps: the values at the stages of the last attempted step, and workspace.
#[derive(Clone, Debug)]
pub struct Integrator {
    /// By what becomes of the contact modes; on the heap, since threads of hosts may have small stacks.
    methods: [Box<RungeKutta>; 2],
    /// Which of them has attempted the last step.
    last: ContactModes,
    stages: Stages,
    sums: LayerSums,
    error_workspace: ErrorWorkspace,
}

/// The end of an attempted step, open to changes.
#[derive(Debug)]
pub struct OpenEnd<'a> {
    /// The state.
    pub state: &'a mut State,
    /// The forces in it.
    pub forces: &'a mut Forces,
    /// The rates in it.
    pub rates: &'a mut StageValues,
}

/// What the steps compute in addition to the state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tracked {
    /// The powers through the channels.
    pub energy: bool,
    /// The sensitivities of the forces and of the bodies' motion to the targets of the inputs.
    pub tangents: bool,
}

impl Integrator {
    /// An integrator for `model` with workspace for steps by these schemes: at most one for event-driven steps, and the
    /// one for time-stepping.
    pub fn new(model: &Model, tracked: Tracked, schemes: &[Scheme]) -> Self {
        let holds_modes = |scheme: &Scheme| scheme.contact_modes() == ContactModes::Held;
        let event_driven = schemes.iter().copied().find(holds_modes).unwrap_or(Scheme::Esdirk5);
        let inputs = if tracked.tangents { model.inputs() } else { Vec::new() };
        let stages = schemes.iter().map(|scheme| scheme.tableau().stages).max().unwrap_or(0);
        Self {
            methods: [event_driven, Scheme::Sdirk2]
                .map(|scheme| Box::new(RungeKutta::new(scheme, model, schemes.contains(&scheme)))),
            last: schemes.first().map_or(ContactModes::Held, |scheme| scheme.contact_modes()),
            stages: Stages::new(model, stages, tracked.energy, inputs),
            sums: LayerSums::new(model, 0),
            error_workspace: ErrorWorkspace::new(model),
        }
    }

    /// Newton iterations since the start.
    pub fn iterations(&self) -> u64 {
        self.stages.solver.iterations
    }

    /// Evaluates the rates and the powers at the start of a step from the `forces` in its state: needed at the start of
    /// a run, after an event and at a kink of the carrier's motion. The step starts at the time `s` of the carrier's
    /// segment and will have some length `h` (s).
    pub fn evaluate_start(
        &self,
        model: &Model,
        start: &mut LayerState,
        (carrier, s): (&Carrier, f64),
        forces: &Forces,
        h: f64,
    ) {
        let (at, beta) = (carrier.position(s).profile_position, self.event_driven().tableau().gamma() * h);
        start.rates.evaluate(model, &start.state, forces, at, beta);
        start.largest = start.largest.with(forces);
        if self.stages.tracks_energy {
            let point = carrier.at(s);
            start.exchange = BoundaryPowers::evaluate(model, &start.state, &point, forces);
            start.exchange.add_bodies(model, carrier, s, &point);
        }
    }

    /// Attempts a step from `start` through which the contact modes are held or not: event-driven or of time-stepping.
    ///
    /// # Errors
    /// [`NoConvergence`] where Newton's iterations of a stage did not converge.
    pub fn attempt(
        &mut self,
        modes: ContactModes,
        (model, start, carrier): (&Model, &LayerState, &Carrier),
        span: TimeSpan,
        tolerance: &Tolerance,
    ) -> Result<ErrorEstimate, NoConvergence> {
        self.last = modes;
        let Self { methods, stages, sums, error_workspace, .. } = self;
        let method = &mut methods[modes as usize];
        let step = StepAttempt { model, start, carrier, span, beta: method.coefficients.tableau.gamma() * span.length };
        let slack = match modes {
            ContactModes::Held => 1.0,
            ContactModes::SetValued if model.friction.depends_on_speed() => STEEP_SLACK,
            ContactModes::SetValued => NEWTON_SLACK,
        };
        let solved = method.attempt(stages, &step, ConvergenceTest::new(tolerance, step.beta, slack));
        sums.begin(&stages.exchange);
        solved?;
        let attempt = method.test(stages, &step, tolerance, error_workspace);
        Ok(match modes {
            ContactModes::Held => attempt,
            // Touches are looked for at the end of the step alone, so the carrier's motion must be resolved over all
            // masses.
            ContactModes::SetValued => ErrorEstimate { error: attempt.error.hypot(attempt.carrier_error), ..attempt },
        })
    }

    /// The method that has attempted the last step.
    fn method(&self) -> &RungeKutta {
        &self.methods[self.last as usize]
    }

    /// The index of the last stage of that step.
    fn last_stage(&self) -> usize {
        self.method().coefficients.tableau.last()
    }

    /// The ratio of the length of a two-stage step with an error of the tolerance to `h`, the length of the last
    /// attempted event-driven step, by the changes of velocities and accelerations over that step.
    pub fn two_stage_length_ratio(&self, h: f64, tolerance: &Tolerance) -> f64 {
        let (first, last, end) = (&self.stages.rates[0], &self.stages.rates[self.last_stage()], self.end());
        let carrier = &self.end_carrier();
        let mut sum = 0.0;
        for i in 0..end.mode.len() {
            let change = |of: fn(&StageValues) -> &[f64]| (SDIRK2_ESTIMATE * h * (of(last)[i] - of(first)[i])).powi(2);
            sum += change(|rates| &rates.velocity_x) / tolerance.position_tolerance_sq(end.elongation_x[i])
                + change(|rates| &rates.velocity_z) / tolerance.position_tolerance_sq(end.elongation_z[i])
                + change(|rates| &rates.acceleration_x)
                    / tolerance.velocity_tolerance_sq(end.velocity_x[i] - carrier.x.speed)
                + change(|rates| &rates.acceleration_z)
                    / tolerance.velocity_tolerance_sq(end.velocity_z[i] - carrier.z.speed);
        }
        let error = (sum / end.mode.len() as f64).sqrt();
        // The two stages lie 1 - γ of a step apart, and the error grows with the square of the step length.
        1.0 / (error * (1.0 - GAMMA)).sqrt()
    }

    /// The motion of a body along `axis` through the last attempted step, of length `h` (s).
    pub fn body_interpolant(&self, axis: Axis, h: f64) -> BodyInterpolant {
        self.method().coefficients.interpolation.body_interpolant(h, |stage| self.stages.carrier[stage][axis])
    }

    /// The carrier at the end of the last attempted step.
    pub fn end_carrier(&self) -> CarrierPoint {
        self.stages.carrier[self.last_stage()]
    }

    /// The state at the end of the last attempted step.
    pub fn end(&self) -> &State {
        &self.stages.solver.state
    }

    /// The forces at the end of the last attempted step.
    pub fn end_forces(&self) -> &Forces {
        &self.stages.solver.forces
    }

    /// The scheme of its event-driven steps.
    pub fn event_driven(&self) -> Scheme {
        self.methods[ContactModes::Held as usize].scheme
    }

    /// The rates at the stages of the last attempted step.
    pub fn stages(&self) -> &[StageValues] {
        &self.stages.rates[..=self.last_stage()]
    }

    /// The end of the last attempted step, of time-stepping, open to changes, and the rates at its first implicit
    /// stage.
    pub fn end_mut(&mut self) -> (OpenEnd<'_>, &StageValues) {
        let last_stage = self.last_stage();
        let (earlier, last) = self.stages.rates.split_at_mut(last_stage);
        let StageSolver { state, forces, .. } = &mut self.stages.solver;
        (OpenEnd { state, forces, rates: &mut last[0] }, &earlier[1])
    }

    /// The dense output of the last attempted step, from `start`.
    pub fn dense<'a>(
        &'a self,
        model: &'a Model,
        carrier: &'a Carrier,
        start: &'a State,
        span: TimeSpan,
    ) -> DenseOutput<'a> {
        let masses = 0..model.masses();
        DenseOutput { model, masses, carrier, span, start, method: self.method(), values: &self.stages }
    }

    /// The dense output of the last attempted step, and the sums over the layer in it.
    fn dense_and_sums<'a>(
        &'a mut self,
        (model, carrier, start): (&'a Model, &'a Carrier, &'a State),
        span: TimeSpan,
    ) -> (DenseOutput<'a>, &'a mut LayerSums) {
        let (masses, method) = (0..model.masses(), &self.methods[self.last as usize]);
        (DenseOutput { model, masses, carrier, span, start, method, values: &self.stages }, &mut self.sums)
    }

    /// F_x and F_z at the fraction `theta` of the last attempted step, from `start`, N.
    pub fn on_carrier(
        &mut self,
        (model, carrier, start): (&Model, &Carrier, &State),
        span: TimeSpan,
        theta: f64,
        workspace: &mut DenseWorkspace,
    ) -> ByAxis<f64> {
        let (dense, sums) = self.dense_and_sums((model, carrier, start), span);
        sums.on_carrier(&mut LayerStep { dense, workspace }, model, theta)
    }

    /// P_diss at the fraction `theta` of the last attempted step, from `start`, by its powers at the stages, W: of
    /// order 2 by [`ESDIRK3`] and [`SDIRK2`], of order 3 by [`ESDIRK5`]. Only where energies are tracked.
    pub fn dissipated_power(
        &mut self,
        (model, carrier, start): (&Model, &Carrier, &State),
        span: TimeSpan,
        theta: f64,
    ) -> f64 {
        let (dense, sums) = self.dense_and_sums((model, carrier, start), span);
        sums.dissipated_power(&dense, theta)
    }

    /// Energies through the channels over the last attempted step, from `start`, up to its fraction `theta`, J.
    pub fn energies(
        &mut self,
        (model, carrier, start): (&Model, &Carrier, &State),
        span: TimeSpan,
        theta: f64,
    ) -> ChannelEnergies {
        let (dense, sums) = self.dense_and_sums((model, carrier, start), span);
        sums.energies(&dense, theta)
    }

    /// The energy of friction, J, that the powers at the stages of the last attempted step, of time-stepping and of
    /// length `h` from `start`, miss as contacts stop or break loose within it: what these lose of their kinetic energy
    /// and the stages do not show.
    pub fn friction_between_stages(&self, model: &Model, start: &State, h: f64) -> f64 {
        let end = self.end();
        let kinetic =
            |state: &State, i: usize| 0.5 * model.mass * (state.velocity_x[i].powi(2) + state.velocity_z[i].powi(2));
        let gain = |stage: &StageValues, i: usize| {
            model.mass * (stage.acceleration_x[i] * stage.velocity_x[i] + stage.acceleration_z[i] * stage.velocity_z[i])
        };
        let shown = |i: usize| {
            let stages = self.stages().iter().zip(SDIRK2.weights());
            h * stages.map(|(stage, weight)| weight * gain(stage, i)).sum::<f64>()
        };
        let contacts = self.stages.solver.contacts().iter().copied();
        let changed = contacts.filter(|&i| start.mode[i] != end.mode[i] || self.stages()[1].velocity_x[i] == 0.0);
        changed.map(|i| kinetic(start, i) - kinetic(end, i) + shown(i)).sum()
    }

    /// Accepts the last attempted step: its end becomes the `start` of the next one.
    pub fn accept(&mut self, start: &mut LayerState) {
        let last_stage = self.last_stage();
        self.stages.accept(start, last_stage);
    }

    /// Whether tangents are computed.
    pub fn has_tangents(&self) -> bool {
        !self.stages.tangents.is_empty()
    }

    /// Begins the tangents of a motion of the carrier of `duration` (s).
    pub fn begin_tangents(&mut self, duration: f64) {
        for tangent in &mut self.stages.tangents {
            tangent.begin(duration);
        }
    }

    /// Recomputes the tangents' rates at the start of a step, `s` seconds after the start of the carrier's motion, with
    /// the `forces` there: `None` where these are those at the end of the step just accepted, as a contact correction
    /// left them.
    pub fn refresh_tangents(
        &mut self,
        model: &Model,
        start: &LayerState,
        (carrier, s): (&Carrier, f64),
        forces: Option<&Forces>,
    ) {
        let Stages { tangents, solver, .. } = &mut self.stages;
        let forces = forces.unwrap_or(&solver.forces);
        let at = (s, carrier.position(s).profile_position);
        for tangent in tangents {
            tangent.evaluate_rates(model, &start.state, forces, &start.rates.acceleration_x, at);
        }
    }

    /// The derivatives by the targets of the motion, `s` seconds after its start.
    pub fn tangents(&mut self, model: &Model, s: f64) -> Tangents {
        let mut tangents = Tangents::default();
        for tangent in &mut self.stages.tangents {
            tangents.set(tangent.input(), tangent.tangents(model, s));
        }
        tangents
    }

    /// Keeps what the energies of parts of the layer need of a step.
    pub fn keep_link_forces(&mut self, model: &Model) {
        if self.stages.tracks_energy {
            let links = || {
                let [vertical, horizontal, ..] = Forces::zeros_by_link(model).0;
                [horizontal, vertical]
            };
            self.stages.link_forces =
                std::iter::repeat_with(links).take(self.event_driven().tableau().stages - 2).collect();
        }
    }
}
