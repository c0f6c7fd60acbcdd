//! The time-stepping method: steps of two stages, in which contacts stop and break loose; any number of touches and lifts
//! is corrected at the end of each.

use super::driver::{AFTER_FAILURE, StepBounds, TrialStep, WorkLimit};
use super::motion::SimulationError;
use super::run::Run;
use crate::contact::{FixedModeStep, longest_weakening};
use crate::integrator::{ContactModes, ErrorEstimate};
use crate::model::ChannelEnergies;

/// A new step is this share of what the error allows. Mode changes come unforeseen, so it is less than in smooth
/// motion.
const SAFETY: f64 = 0.8;
/// The least and the most by which one step differs from the one before.
const GROWTH: (f64, f64) = (0.2, 5.0);

impl Run {
    /// Tries steps until one is good. The shortest is accepted whatever its error: its mode changes are corrected as
    /// those of any other.
    pub(super) fn next_time_step(
        &mut self,
        bounds: &StepBounds,
        work: &mut WorkLimit,
    ) -> Result<TrialStep, SimulationError> {
        let mut h = bounds.fit(self.state.step_size.min(bounds.longest));
        loop {
            self.count_work(work)?;
            if let Some(attempt) = self.try_time_step(h, h <= bounds.shortest) {
                let grown = h * growth(attempt.error);
                let next = if h < bounds.remaining { grown } else { grown.max(self.state.step_size) };
                self.state.step_size = next.min(self.longest_weakening());
                return Ok(TrialStep { h, share: 1.0 });
            }
            if h <= bounds.shortest {
                return Err(self.step_too_small(h));
            }
            h = self.state.step_size.max(bounds.shortest);
        }
    }

    /// The longest step, s, that resolves the instability of contacts whose friction falls with the speed that they
    /// have at the end of the step tried last.
    fn longest_weakening(&self) -> f64 {
        let integrator = &self.workspace.integrator;
        longest_weakening(&self.model, integrator.end(), integrator.end_forces())
    }

    /// Tries a step of length `h`; `None` where it is rejected: the run's step size is then a better length.
    pub(super) fn try_time_step(&mut self, h: f64, any_error: bool) -> Option<ErrorEstimate> {
        let Self { model, settings, state, workspace, .. } = self;
        workspace.interpolated_at = None;
        let (start, span) = ((&**model, &state.layer, &state.carrier), state.span(h));
        let attempt = workspace.integrator.attempt(ContactModes::SetValued, start, span, &settings.tolerance);
        self.trace_bodies(h);
        let attempt = attempt.ok().map(|attempt| self.with_lateness(h, attempt));
        let error = attempt.map_or(f64::NAN, |attempt| attempt.error);
        if error <= 1.0 || (any_error && error.is_finite()) {
            return attempt;
        }
        self.state.counters.rejected += 1;
        self.state.step_size = h * if error.is_finite() { growth(error).min(SAFETY) } else { AFTER_FAILURE };
        None
    }

    /// The attempt of length `h` with the error that the lateness of its mode changes adds.
    fn with_lateness(&mut self, h: f64, attempt: ErrorEstimate) -> ErrorEstimate {
        let Self { model, settings, state, workspace, .. } = self;
        let step = workspace.integrator.dense(model, &state.carrier, &state.layer.state, state.span(h));
        let late = workspace.end_correction.detect(&step.parabolas(), &settings.tolerance);
        ErrorEstimate { error: attempt.error.hypot(late), ..attempt }
    }

    /// Accepts the step of length `h` tried last, which ends at the time `end` of the piece, with its mode changes
    /// corrected.
    pub(super) fn accept_time_step(&mut self, h: f64, end: f64) {
        let Self { model, settings, state, workspace, .. } = self;
        let integrator = &mut workspace.integrator;
        let start = &state.layer.state;
        let gain = settings.accounts.energy.then(|| {
            let missed = integrator.friction_between_stages(model, start, h);
            let shown = integrator.energies((&**model, &state.carrier, start), state.span(h), 1.0);
            ChannelEnergies { friction: shown.friction + missed, ..shown }
        });
        workspace.interpolated_at = None;
        workspace.modes_before.copy_from_slice(&start.mode);
        let span = state.span(h);
        let (step_end, first) = integrator.end_mut();
        let step = FixedModeStep { model, carrier: &state.carrier, span, start, first };
        let corrected = workspace.end_correction.apply(step, step_end);
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
        state.carrier.take_step(end, &point);
        integrator.accept(&mut state.layer);
        state.counters.steps += 1;
        state.s = end;
        if workspace.modes_before != state.layer.state.mode {
            integrator.refresh_tangents(model, &state.layer, None, end);
            self.count_mode_changes();
        }
    }
}

/// The ratio of the next step to one with this error over the tolerance.
fn growth(error: f64) -> f64 {
    (SAFETY / error.sqrt()).clamp(GROWTH.0, GROWTH.1)
}
