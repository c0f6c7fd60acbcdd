//! The time-stepping method: steps of two stages, in which contacts stop and break loose; any number of touches and
//! lifts is corrected at the end of each.

use super::context::RunContext;
use super::controller::{GROWTH, TrialStep, WorkLimit};
use super::motion::SimulationError;
use super::stepper::{StepMethod, StepTest};
use crate::contact::{EndCorrection, FixedModeStep, longest_weakening};
use crate::integrator::{ContactModes, ErrorEstimate, Parabolas};
use crate::model::{ByAxis, ChannelEnergies, Model};
use crate::scene::Axis;

/// A new step is this fraction of what the error allows. Mode changes come unforeseen, so it is less than in smooth
/// motion.
const SAFETY: f64 = 0.8;
/// The most that mode changes not yet corrected may change F_z where a row is shown within a step, as a multiple of the
/// relative tolerance. That bounds all of them together at the step's end; a row shows what touches change, so its
/// error is a small part of that.
const MAX_UNCORRECTED: f64 = 3.0;

/// The time steps of a layer.
#[derive(Clone, Debug)]
pub(super) struct TimeStepping {
    end_correction: EndCorrection,
}

impl TimeStepping {
    /// The steps of a layer of `model`, if they are used.
    pub(super) fn new(model: &Model, is_used: bool) -> Self {
        Self { end_correction: EndCorrection::new(model, is_used) }
    }

    /// Accepts a step, which ends at the time `end` of the motion, with its mode changes corrected.
    pub(super) fn accept(&mut self, context: &mut RunContext, step: &TrialStep, end: f64) {
        // The energies of the step without its mode changes.
        let h = step.h;
        let RunContext { model, settings, state, integrator, .. } = context;
        let start = &state.layer.state;
        let gain = settings.accounts.energy.then(|| {
            let missed = integrator.friction_between_stages(model, start, h);
            let shown = integrator.energies((&**model, &state.carrier, start), state.span(h), 1.0);
            ChannelEnergies { friction: shown.friction + missed, ..shown }
        });
        // The mode changes, corrected in the state at its end.
        context.interpolated_at = None;
        context.modes_before.copy_from_slice(&start.mode);
        let span = state.span(h);
        let (step_end, first) = integrator.end_mut();
        let fixed = FixedModeStep { model, carrier: &state.carrier, span, start, first };
        let corrected = self.end_correction.apply(fixed, step_end);
        // What they change of the energies and of the carrier.
        if let Some(gain) = gain {
            let energies = &mut state.energies;
            energies.channels.add(&gain);
            energies.channels.add(&corrected.map_or_else(ChannelEnergies::default, |corrected| corrected.channels));
            energies.impact += corrected.map_or(0.0, |corrected| corrected.impact);
        }
        let mut point = integrator.end_carrier();
        if let Some(corrected) = &corrected {
            state.carrier.push(&mut point, model, corrected.impulse);
        }
        // The end of the step becomes the start of the next.
        state.carrier.take_step(end, &point);
        integrator.accept(&mut state.layer);
        state.counters.steps += 1;
        state.s = end;
        if context.modes_before != state.layer.state.mode {
            integrator.refresh_tangents(model, &state.layer, (&state.carrier, end), None);
            context.record_mode_changes();
        }
        context.record_largest_energy();
    }

    /// Tries a step of length `h`; `None` where it is rejected: the controller's step size is then a better length.
    fn try_step(&mut self, context: &mut RunContext, h: f64, test: StepTest) -> Option<ErrorEstimate> {
        context.interpolated_at = None;
        let RunContext { model, settings, state, integrator, .. } = context;
        let (start, span) = ((&**model, &state.layer, &state.carrier), state.span(h));
        let attempt = integrator.attempt(ContactModes::SetValued, start, span, &settings.tolerance).ok();
        context.trace_bodies(h);
        let attempt = attempt.map(|attempt| self.with_event_time_error(context, h, attempt));
        let error = attempt.map_or(f64::NAN, |attempt| attempt.error);
        if error <= 1.0 || (test == StepTest::Solved && error.is_finite()) {
            return attempt;
        }
        context.state.counters.rejected += 1;
        let ratio = error.is_finite().then(|| growth(error).min(SAFETY));
        context.state.controller.reject(h, ratio, f64::MAX);
        None
    }

    /// The attempt of length `h` with the error that the late instants of its mode changes add.
    fn with_event_time_error(&mut self, context: &RunContext, h: f64, attempt: ErrorEstimate) -> ErrorEstimate {
        let late = self.end_correction.detect(&parabolas(context, h), &context.settings.tolerance);
        ErrorEstimate { error: attempt.error.hypot(late), ..attempt }
    }
}

impl StepMethod for TimeStepping {
    /// The shortest step is accepted whatever its error: its mode changes are corrected as those of any other.
    fn next_step(
        &mut self,
        context: &mut RunContext,
        duration: f64,
        work: &mut WorkLimit,
    ) -> Result<TrialStep, SimulationError> {
        let bounds = context.length_bounds(duration)?;
        let mut h = bounds.fit(context.state.controller.step_size.min(bounds.longest));
        loop {
            work.count(context.state.time(), context.model.work_of_step())?;
            let test = if h <= bounds.shortest { StepTest::Solved } else { StepTest::Full };
            if let Some(attempt) = self.try_step(context, h, test) {
                let RunContext { model, state: run, integrator, .. } = context;
                // The next one resolves the instability of contacts whose friction falls with the speed that they have
                // now.
                let longest = longest_weakening(model, integrator.end(), integrator.end_forces());
                let grown = h * growth(attempt.error);
                run.controller.step_size = run.controller.propose((h, grown), bounds.remaining, longest);
                return Ok(TrialStep { h, fraction: 1.0 });
            }
            if h <= bounds.shortest {
                return Err(context.step_too_small(h));
            }
            h = context.state.controller.step_size.max(bounds.shortest);
        }
    }

    fn try_shorter(&mut self, context: &mut RunContext, h: f64, test: StepTest) -> bool {
        self.try_step(context, h, test).is_some()
    }

    fn on_carrier(&mut self, context: &mut RunContext, h: f64, theta: f64) -> ByAxis<f64> {
        let without_touches = context.on_carrier_within(h, theta);
        without_touches + self.end_correction.forces_of_touches(&parabolas(context, h), theta)
    }

    fn dissipated_power(&mut self, context: &mut RunContext, h: f64, theta: f64) -> Option<f64> {
        context.settings.accounts.energy.then(|| context.dissipated_power_within(h, theta))
    }

    /// Touches and lifts are corrected at the end of a step, and its dense output is not: it is shown before them, and
    /// where they change F_z little.
    fn can_show(&self, context: &RunContext, h: f64, theta: f64) -> bool {
        let (correction, relative) = (&self.end_correction, context.settings.tolerance.relative);
        let allowed = MAX_UNCORRECTED * relative * context.integrator.end_forces().on_carrier(Axis::Z).abs();
        correction.uncorrected_force() < allowed || correction.comes_after(&parabolas(context, h), theta)
    }
}

/// The motions of the masses through the step of length `h` (s) tried last.
fn parabolas(context: &RunContext, h: f64) -> Parabolas<'_> {
    context.dense_output(h).parabolas()
}

/// The ratio of the next step to one with this error over the tolerance.
fn growth(error: f64) -> f64 {
    (SAFETY / error.sqrt()).clamp(GROWTH.0, GROWTH.1)
}
