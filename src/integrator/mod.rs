//! The implicit Runge-Kutta methods: attempts and acceptance of single steps of the layer, their error tests, dense outputs,
//! energies and sensitivities.
//!
//! Three methods share one implementation: the pairs [`ESDIRK3`] and [`ESDIRK5`] for event-driven runs, and [`SDIRK2`],
//! of order 2 with two implicit stages, for time-stepping. The pairs hold the contact modes through a step; in the steps of
//! two stages contacts stop and break loose as the forces at the stages say.

mod carrier_sums;
mod dense;
mod energy;
mod error;
mod event_method;
mod interpolation;
mod largest;
mod maxwell;
mod method;
mod motions;
mod part;
mod rates;
mod sensitivity;
mod stage;
mod tableau;
mod two_stage_dense;
mod within;

pub use dense::{DenseOutput, DenseWorkspace, StepBoundary, StepSpan};
pub use error::{StepAttempt, Tolerance};
pub use event_method::Pair;
pub use interpolation::StageInterpolation;
pub use largest::Largest;
pub use motions::Motions;
pub use part::{PartSums, WholeLayer};
pub use rates::{LayerState, NO_LIMIT, Rates};
pub use stage::NoConvergence;
pub use tableau::{ContinuousWeights, ESDIRK3, ESDIRK5, SDIRK2, STAGES, TWO_STAGES, Tableau};
pub use two_stage_dense::TwoStageDense;
pub use within::{LayerWithin, Overlay};

use crate::model::{Axis, Tangents};
use crate::model::{
    BodyStep, BoundaryPowers, Carrier, CarrierPoint, ChannelEnergies, Forces, MaxwellRow, Model, State,
};
use carrier_sums::{CarrierSums, ContactHeights};
use energy::{MassesInStep, StepSums, SummedStep};
use error::ErrorWorkspace;
use event_method::EventMethod;
use maxwell::Maxwell;
use method::{InitialGuess, RungeKutta, Stages, StepInput};
use sensitivity::Tangent;
use stage::{ConvergenceTest, Friction, StageSolver};
use tableau::{GAMMA, SDIRK2_ESTIMATE};
use two_stage_dense::{piecewise_linear, two_stage_body_step};

/// The error tolerance of Newton's iterations in a step of two stages, as a multiple of the one in an event-driven step. Iterations are the cost of such a step, and the error that they leave is known to be smaller than this.
const NEWTON_SLACK: f64 = 2.0;
/// The same where friction depends on the speed. Corrections fall slowly there, and the estimate of the step's error
/// multiplies what they leave by [`SDIRK2_ESTIMATE`] over γ: the step length would follow it and not the motion.
const STEEP_SLACK: f64 = 0.1;

/// Attempts and accepts steps: the values at the stages of the last attempted step, and workspace.
#[derive(Clone, Debug)]
pub struct Integrator {
    pair: Pair,
    event_method: EventMethod,
    two_stages: RungeKutta<TWO_STAGES>,
    stages: Stages,
    /// Of the pair.
    interpolation: &'static StageInterpolation,
    carrier_sums: CarrierSums,
    energy_sums: StepSums,
    error_workspace: ErrorWorkspace,
}

/// The end of an attempted step, open to changes.
#[derive(Debug)]
pub struct StepEnd<'a> {
    /// The state.
    pub state: &'a mut State,
    /// The forces in it.
    pub forces: &'a mut Forces,
    /// The rates in it.
    pub rates: &'a mut Rates,
}

/// What the steps compute in addition to the state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tracked {
    /// The powers through the channels.
    pub energy: bool,
    /// The sensitivities of the forces and of the bodies' motion to the targets of the inputs.
    pub tangents: bool,
}

/// The methods for which an integrator has workspace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steps {
    /// A pair of event-driven steps alone.
    EventDriven(Pair),
    /// [`SDIRK2`] alone.
    TwoStages,
    /// Both.
    Both(Pair),
}

impl Steps {
    fn pair(self) -> Option<Pair> {
        match self {
            Self::EventDriven(pair) | Self::Both(pair) => Some(pair),
            Self::TwoStages => None,
        }
    }

    fn stages(self) -> usize {
        self.pair().map_or(TWO_STAGES, Pair::stages)
    }
}

impl Integrator {
    /// An integrator for `model` with workspace for `steps`.
    pub fn new(model: &Model, tracked: Tracked, steps: Steps) -> Self {
        let pair = steps.pair().unwrap_or(Pair::Fifth);
        let (has_pair, has_two_stages) = (steps.pair().is_some(), !matches!(steps, Steps::EventDriven(_)));
        let inputs = if tracked.tangents { model.inputs() } else { Vec::new() };
        Self {
            pair,
            event_method: EventMethod::new(pair, model, has_pair),
            two_stages: RungeKutta {
                tableau: &SDIRK2,
                continuous_weights: ContinuousWeights::sdirk2(),
                initial_guess: InitialGuess::Limited,
                maxwell: Maxwell::new(model, has_two_stages),
                friction: Friction::SetValued,
            },
            stages: Stages {
                rates: (0..steps.stages()).map(|_| Rates::new(model)).collect(),
                carrier: [CarrierPoint::default(); STAGES],
                exchange: [BoundaryPowers::default(); STAGES],
                link_forces: Vec::new(),
                solver: StageSolver::new(model),
                tracks_energy: tracked.energy,
                tangents: inputs.into_iter().map(|input| Tangent::new(model, input, steps.stages())).collect(),
            },
            interpolation: pair.interpolation(),
            carrier_sums: CarrierSums::new(model),
            energy_sums: StepSums::new(model),
            error_workspace: ErrorWorkspace::new(model),
        }
    }

    /// Newton iterations since the start.
    pub fn iterations(&self) -> u64 {
        self.stages.solver.iterations
    }

    /// Evaluates the rates and the powers at the start of a step from the `forces` in its state: needed at the start of
    /// a run, after an event and at a kink of the carrier's motion. The step starts at the time `s` of the carrier's piece and
    /// will have some length `h` (s).
    pub fn evaluate_start(
        &self,
        model: &Model,
        start: &mut LayerState,
        (carrier, s): (&Carrier, f64),
        forces: &Forces,
        h: f64,
    ) {
        start.rates.evaluate(model, &start.state, forces, self.event_method.gamma() * h);
        start.largest = start.largest.with(forces);
        if self.stages.tracks_energy {
            let point = carrier.at(s);
            start.exchange = BoundaryPowers::evaluate(model, &start.state, &point, forces);
            start.exchange.add_bodies(model, carrier, s, &point);
        }
    }

    /// Attempts an event-driven step from `start`.
    ///
    /// # Errors
    /// [`NoConvergence`] where Newton's iterations of a stage did not converge.
    pub fn attempt(
        &mut self,
        model: &Model,
        start: &LayerState,
        carrier: &Carrier,
        span: StepSpan,
        tolerance: &Tolerance,
    ) -> Result<StepAttempt, NoConvergence> {
        let step = StepInput { model, start, carrier, span, beta: self.event_method.gamma() * span.length };
        let convergence = ConvergenceTest::new(tolerance, step.beta, 1.0);
        self.invalidate_sums();
        self.event_method.attempt(&mut self.stages, &step, convergence)?;
        Ok(self.event_method.test(&self.stages, &step, tolerance, &mut self.error_workspace))
    }

    /// Attempts a step of two stages from `start`.
    ///
    /// # Errors
    /// [`NoConvergence`] where Newton's iterations of a stage did not converge.
    pub fn attempt_two_stages(
        &mut self,
        model: &Model,
        start: &LayerState,
        carrier: &Carrier,
        span: StepSpan,
        tolerance: &Tolerance,
    ) -> Result<StepAttempt, NoConvergence> {
        let step = StepInput { model, start, carrier, span, beta: self.two_stages.tableau.gamma() * span.length };
        let slack = if model.friction.depends_on_speed() { STEEP_SLACK } else { NEWTON_SLACK };
        let convergence = ConvergenceTest::new(tolerance, step.beta, slack);
        self.invalidate_sums();
        self.two_stages.attempt(&mut self.stages, &step, convergence)?;
        let attempt = self.two_stages.test(&self.stages, &step, tolerance, &mut self.error_workspace);
        // Touches are looked for at the end of the step alone, so the carrier's motion must be resolved over all masses.
        Ok(StepAttempt { error: attempt.error.hypot(attempt.carrier_error), ..attempt })
    }

    fn invalidate_sums(&mut self) {
        self.carrier_sums.forget();
        self.energy_sums.forget();
    }

    /// The ratio of the length of a two-stage step with an error of the tolerance to `h`, the length of the last
    /// attempted event-driven step, by the changes of velocities and accelerations over that step.
    pub fn two_stage_length_ratio(&self, h: f64, tolerance: &Tolerance) -> f64 {
        let (first, last, end) = (&self.stages.rates[0], &self.stages.rates[self.pair.stages() - 1], self.end());
        let carrier = &self.stages.carrier[self.pair.stages() - 1];
        let mut sum = 0.0;
        for i in 0..end.mode.len() {
            let change = |of: fn(&Rates) -> &[f64]| (SDIRK2_ESTIMATE * h * (of(last)[i] - of(first)[i])).powi(2);
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

    /// The motion of a body along `axis` through the last attempted step, of length `h` (s): event-driven, or of two stages
    /// where it is a `time_step`.
    pub fn body_step(&self, axis: Axis, h: f64, time_step: bool) -> BodyStep {
        let at = |stage: usize| self.stages.carrier[stage][axis];
        if time_step {
            two_stage_body_step(h, [at(0), at(1), at(TWO_STAGES - 1)])
        } else {
            BodyStep::Polynomial { length: h, speed: self.interpolation.polynomial(|stage| at(stage).speed) }
        }
    }

    /// The carrier at the end of the last attempted step: event-driven, or of two stages where it is a `time_step`.
    pub fn end_carrier(&self, time_step: bool) -> CarrierPoint {
        self.stages.carrier[if time_step { TWO_STAGES } else { self.pair.stages() } - 1]
    }

    /// The state at the end of the last attempted step.
    pub fn end(&self) -> &State {
        &self.stages.solver.state
    }

    /// The forces at the end of the last attempted step.
    pub fn end_forces(&self) -> &Forces {
        &self.stages.solver.forces
    }

    /// The pair of its event-driven steps.
    pub fn pair(&self) -> Pair {
        self.pair
    }

    /// The rates at the stages of the last attempted step.
    pub fn stages(&self) -> &[Rates] {
        &self.stages.rates
    }

    /// The end of the last attempted two-stage step, open to changes, and the rates at its first stage.
    pub fn end_mut(&mut self) -> (StepEnd<'_>, &Rates) {
        let (earlier, last) = self.stages.rates.split_at_mut(TWO_STAGES - 1);
        let StageSolver { state, forces, .. } = &mut self.stages.solver;
        (StepEnd { state, forces, rates: &mut last[0] }, &earlier[1])
    }

    /// The dense output of the last attempted event-driven step, from `start`.
    pub fn dense<'a>(
        &'a self,
        model: &'a Model,
        carrier: &'a Carrier,
        start: &'a State,
        span: StepSpan,
    ) -> DenseOutput<'a> {
        let carriers = &self.stages.carrier[..self.pair.stages()];
        DenseOutput {
            model,
            masses: 0..model.masses(),
            carrier,
            span,
            start: StepBoundary { state: start, carrier: carriers[0] },
            end: StepBoundary { state: self.end(), carrier: carriers[carriers.len() - 1] },
            stages: &self.stages()[..carriers.len()],
            carriers,
            interpolation: self.interpolation,
        }
    }

    /// The dense output of the last attempted two-stage step, from `start`.
    pub fn two_stage_dense<'a>(
        &'a self,
        model: &'a Model,
        carrier: &'a Carrier,
        start: &'a State,
        span: StepSpan,
    ) -> TwoStageDense<'a> {
        let stages = self.stages();
        TwoStageDense::new(model, carrier, span, start, &stages[1], self.end(), &stages[TWO_STAGES - 1])
    }

    /// The Maxwell elements' elongations at the fraction `theta` of the last attempted two-stage step from `start`, into
    /// `a`, m: linear from the start to the first stage and from there to the end, see [`TwoStageDense`].
    pub fn two_stage_maxwell(&self, model: &Model, start: &State, theta: f64, a: &mut [f64]) {
        let ends = (&start.maxwell[..], &self.end().maxwell[..]);
        self.two_stages.maxwell.between(model, 1, piecewise_linear(theta), ends, &self.stages.rates, a);
    }

    /// F_x and F_z at the fraction `theta` of the last attempted event-driven step, from `start`, N.
    pub fn on_carrier(
        &mut self,
        model: &Model,
        carrier: &Carrier,
        start: &State,
        span: StepSpan,
        theta: f64,
        workspace: &mut DenseWorkspace,
    ) -> (f64, f64) {
        let (stages, end) = (&self.stages.rates[..self.pair.stages()], &self.stages.solver.state);
        let heights = self.pair.contact_heights();
        self.carrier_sums.collect(model, &(0..model.masses()), (start, end), stages, heights);
        let motion = self.dense(model, carrier, start, span).summed_motion(theta, &self.carrier_sums, workspace);
        let point = carrier.at(span.at(theta));
        self.carrier_sums.forces(model, &motion, &point, |row| workspace.of_elements(row))
    }

    /// The same of the last attempted two-stage step.
    pub fn two_stage_on_carrier(
        &mut self,
        model: &Model,
        carrier: &Carrier,
        start: &State,
        span: StepSpan,
        theta: f64,
    ) -> (f64, f64) {
        let (stages, end) = (&self.stages.rates[..TWO_STAGES], &self.stages.solver.state);
        self.carrier_sums.collect(model, &(0..model.masses()), (start, end), stages, ContactHeights::Interpolated);
        let motion = self.two_stage_dense(model, carrier, start, span).summed_motion(theta, &self.carrier_sums);
        let (point, weights) = (carrier.at(span.at(theta)), piecewise_linear(theta));
        let of_elements = |row: &MaxwellRow| self.two_stages.maxwell.weights_between(row, 1, weights);
        self.carrier_sums.forces(model, &motion, &point, of_elements)
    }

    /// P_diss at the fraction `theta` of the last attempted event-driven step, of length `h` from `start`, by its powers at
    /// the stages, W: of order 2 by the pair of order 3, of order 3 by that of order 5. Only where energies are tracked.
    pub fn dissipated_power(&mut self, model: &Model, start: &State, h: f64, theta: f64) -> f64 {
        let weights = self.interpolation.values(theta);
        let Self { event_method, stages, energy_sums, .. } = self;
        event_method.dissipated_power(summed(stages, energy_sums, model, start, h), theta, &weights)
    }

    /// The same of the last attempted two-stage step.
    pub fn two_stage_dissipated_power(&mut self, model: &Model, start: &State, h: f64, theta: f64) -> f64 {
        let Self { two_stages, stages, energy_sums, .. } = self;
        two_stages.dissipated_power(summed(stages, energy_sums, model, start, h), theta, &piecewise_linear(theta))
    }

    /// Energies through the channels over the last attempted event-driven step, of length `h` from `start`, up to its
    /// fraction `theta`, J.
    pub fn energies(&mut self, model: &Model, start: &State, h: f64, theta: f64) -> ChannelEnergies {
        let Self { event_method, stages, energy_sums, .. } = self;
        event_method.energies(summed(stages, energy_sums, model, start, h), theta)
    }

    /// Energies through the channels over the last attempted two-stage step, of length `h` from `start`, up to its
    /// fraction `theta`, J.
    pub fn two_stage_energies(&mut self, model: &Model, start: &State, h: f64, theta: f64) -> ChannelEnergies {
        let Self { two_stages, stages, energy_sums, .. } = self;
        two_stages.energies(summed(stages, energy_sums, model, start, h), theta)
    }

    /// The energy of friction, J, that the powers at the stages of the last attempted two-stage step, of length `h` from
    /// `start`, miss as contacts stop or break loose within it: what these lose of their kinetic energy and the stages do
    /// not show.
    pub fn friction_between_stages(&self, model: &Model, start: &State, h: f64) -> f64 {
        let end = self.end();
        let kinetic =
            |state: &State, i: usize| 0.5 * model.mass * (state.velocity_x[i].powi(2) + state.velocity_z[i].powi(2));
        let gain = |stage: &Rates, i: usize| {
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

    /// Accepts the last attempted event-driven step: its end becomes the `start` of the next one.
    pub fn accept(&mut self, start: &mut LayerState) {
        self.stages.accept(start, self.pair.stages() - 1);
    }

    /// Accepts the last attempted two-stage step: its end becomes the `start` of the next one.
    pub fn accept_two_stages(&mut self, start: &mut LayerState) {
        self.stages.accept(start, TWO_STAGES - 1);
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

    /// Recomputes the tangents' rates at the start of a step, with the forces there, `s` seconds after the start of the
    /// carrier's motion.
    pub fn refresh_tangents(&mut self, model: &Model, start: &LayerState, forces: &Forces, s: f64) {
        for tangent in &mut self.stages.tangents {
            tangent.evaluate_rates(model, &start.state, forces, &start.rates.acceleration_x, s);
        }
    }

    /// The same after a contact correction at the end of a step just accepted.
    pub fn refresh_tangents_after(&mut self, model: &Model, start: &LayerState, s: f64) {
        let Stages { tangents, solver, .. } = &mut self.stages;
        for tangent in tangents {
            tangent.evaluate_rates(model, &start.state, &solver.forces, &start.rates.acceleration_x, s);
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
            self.stages.link_forces = std::iter::repeat_with(links).take(self.pair.stages() - 2).collect();
        }
    }

    /// Bytes that the stages hold, those of a copy to go back to included.
    pub fn bytes(&self) -> usize {
        let rates = &self.stages.rates[0];
        let masses = rates.velocity_x.len();
        let links: usize = rates.elongation_rate.iter().map(Vec::len).sum();
        // With those at the start of the next step, in the state and in the one to go back to.
        let stages = self.stages.rates.len() + 2;
        // Per mass: rates and starred values; six blocks and a right side; row shares and neighbour weights; errors; whether
        // it is free; the speed of its slip.
        let by_mass = stages * 6 + 4 + (6 * 4 + 2) + (3 + 3) + 5 + 1 + 1;
        let elements = 2 * (self.event_method.floats() + self.two_stages.maxwell.floats());
        let tangents: usize = self.stages.tangents.iter().map(Tangent::floats).sum();
        (by_mass * masses + stages * links + elements + tangents) * size_of::<f64>()
    }
}

/// The last attempted step of all masses, of length `h` (s) from `start`, with its `sums`.
fn summed<'a>(
    stages: &'a Stages,
    sums: &'a mut StepSums,
    model: &'a Model,
    start: &'a State,
    h: f64,
) -> SummedStep<'a> {
    let of = MassesInStep { model, masses: 0..model.masses(), start, stages: &stages.rates, h };
    SummedStep { of, sums, exchange: &stages.exchange }
}
