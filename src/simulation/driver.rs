//! The skeleton of both methods: try steps until one is good, cut it where a row or an event asks for it, accept it.
//!
//! Method *auto* goes from events to time-stepping where mode changes come fast, and back where they are few again. What
//! decides is the number of mode changes per time step, in the mean over the last [`MEMORY`] of them. An event costs the
//! event-driven method a step of three or six stages, which is cut there, or of a window; a time step costs two and takes any
//! number of changes. So time-stepping is cheaper from a third of a change per step on.

use super::motion::{MethodSwitch, SimulationError};
use super::run::Run;
use crate::scene::Method;

/// The longest step, as a share of the period of the carrier's sine: a longer one could alias the excitation, all
/// stages seeing the same and the error estimate nothing.
const OF_PERIOD: f64 = 0.25;
/// The least share of the length asked for at which a shorter step is given up.
const SHORTEST_CUT: f64 = 1e-12;
/// Mean number of mode changes per time step above which the run switches to time-stepping: 1.5 times the break-even of
/// 1/3, so that a few changes are still located.
const TO_TIME_STEPPING: f64 = 0.5;
/// The number below which it switches back to events: well below the break-even, so that it does not alternate.
const TO_EVENTS: f64 = 0.1;
/// Time steps over which the mean is taken.
const MEMORY: f64 = 8.0;

/// What is left of the length of a step whose stages could not be solved.
pub(super) const AFTER_FAILURE: f64 = 0.25;

/// A good step of length `h` (s) that is to be accepted up to its fraction `share`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TrialStep {
    pub h: f64,
    pub share: f64,
}

/// The steps that one motion may try.
#[derive(Clone, Copy, Debug)]
pub(super) struct WorkLimit {
    tried: u64,
    limit: u64,
}

impl WorkLimit {
    pub(super) fn new(limit: u64) -> Self {
        Self { tried: 0, limit }
    }

    pub(super) fn tried(&self) -> u64 {
        self.tried
    }
}

/// Bounds of the next step's length, s.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepBounds {
    /// Where the clock's resolution ends.
    pub shortest: f64,
    /// By the carrier's period.
    pub longest: f64,
    /// What remains of the motion.
    pub remaining: f64,
}

impl StepBounds {
    /// `step_size`, but so that no tiny step is left before the end of the motion.
    pub(super) fn fit(&self, step_size: f64) -> f64 {
        if step_size >= self.remaining {
            self.remaining
        } else if step_size > 0.5 * self.remaining {
            0.5 * self.remaining
        } else {
            step_size
        }
    }
}

impl Run {
    /// The next good step of a motion of `duration` (s), up to its first event where events are located.
    ///
    /// # Errors
    /// [`SimulationError::TooManySteps`], [`SimulationError::StepTooSmall`].
    pub(super) fn next_step(&mut self, duration: f64, work: &mut WorkLimit) -> Result<TrialStep, SimulationError> {
        let bounds = StepBounds {
            shortest: 4.0 * f64::EPSILON * (self.state.s + 1e-3 * duration),
            longest: OF_PERIOD * self.state.carrier.shortest_period(),
            remaining: duration - self.state.s,
        };
        if bounds.longest <= bounds.shortest {
            return Err(self.step_too_small(bounds.longest));
        }
        if self.state.time_stepping {
            self.next_time_step(&bounds, work)
        } else {
            self.next_event_driven_step(&bounds, work)
        }
    }

    /// Tries a step of length `h`. Returns whether it is good: where it is rejected, the run's step size is a better length.
    fn try_step(&mut self, h: f64, any_error: bool) -> bool {
        if self.state.time_stepping {
            self.try_time_step(h, any_error).is_some()
        } else {
            self.try_event_driven_step(h, any_error, true).is_some()
        }
    }

    /// A step up to the time `s` of the piece in place of a good one that goes beyond it, and its end: before that time
    /// where a step of that length is rejected.
    pub(super) fn cut_step_at(
        &mut self,
        s: f64,
        duration: f64,
        work: &mut WorkLimit,
    ) -> Result<(TrialStep, f64), SimulationError> {
        let h = s - self.state.s;
        let step = self.cut_step(h, work)?;
        Ok((step, if step.h == h { s } else { self.end_of(&step, duration) }))
    }

    /// A step of length `h` in place of a longer, good one: no worse, and without events, or with fewer. A shorter one
    /// where its stages cannot be solved, though those of the longer one could, or have another solution.
    pub(super) fn cut_step(&mut self, h: f64, work: &mut WorkLimit) -> Result<TrialStep, SimulationError> {
        let (mut length, any_error) = (h, self.shorter_is_no_worse());
        loop {
            if self.try_step(length, any_error) {
                if !self.state.time_stepping {
                    self.plan_windows(length, 0.0);
                }
                return Ok(TrialStep { h: length, share: 1.0 });
            }
            self.count_work(work)?;
            if length <= SHORTEST_CUT * h {
                return Err(self.step_too_small(length));
            }
            length = self.state.step_size;
        }
    }

    /// Whether a step shorter than a good one needs no error test. Where friction falls with the speed the stages may
    /// have several solutions, and the two need not find the same.
    pub(super) fn shorter_is_no_worse(&self) -> bool {
        !self.model.friction.depends_on_speed()
    }

    pub(super) fn count_work(&self, work: &mut WorkLimit) -> Result<(), SimulationError> {
        if work.tried >= work.limit {
            return Err(SimulationError::TooManySteps { time: self.state.time(), steps: work.limit });
        }
        work.tried += 1;
        Ok(())
    }

    pub(super) fn step_too_small(&self, step: f64) -> SimulationError {
        SimulationError::StepTooSmall { time: self.state.time(), step }
    }

    /// The end of a step, s after the start of the piece: exactly that of the motion where it is the last.
    pub(super) fn end_of(&self, step: &TrialStep, duration: f64) -> f64 {
        let whole = step.share >= 1.0 && step.h >= duration - self.state.s;
        if whole { duration } else { self.state.s + step.share * step.h }
    }

    /// Accepts a step, which ends at the time `end` of the piece, and makes the mode changes due there.
    pub(super) fn take_step(&mut self, step: &TrialStep, end: f64) {
        let before = self.state.counters.events - self.changes_in_windows();
        let auto = self.settings.method == Method::Auto;
        let mut time_step = step.h;
        if self.state.time_stepping {
            self.accept_time_step(step.h, end);
        } else {
            if auto {
                time_step *= self.workspace.integrator.two_stage_length_ratio(step.h, &self.settings.tolerance);
            }
            self.accept_event_driven_step(step, end);
        }
        let largest = &mut self.state.layer.largest;
        largest.energy = largest.energy.max(self.state.energies.largest());
        if auto {
            self.state.mode_changes_per_step *= (-step.share * step.h / (MEMORY * time_step)).exp();
            self.state.mode_changes_per_step += (self.state.counters.events - before) as f64 / MEMORY;
            self.switch_if_due(time_step);
        }
    }

    fn switch_if_due(&mut self, time_step: f64) {
        let mode_changes_per_step = self.state.mode_changes_per_step;
        let due = if self.state.time_stepping {
            mode_changes_per_step < TO_EVENTS
        } else {
            mode_changes_per_step > TO_TIME_STEPPING
        };
        if !due {
            return;
        }
        self.state.time_stepping = !self.state.time_stepping;
        if self.state.time_stepping {
            self.state.step_size = self.state.step_size.min(time_step);
        } else {
            // The event-driven steps begin with an explicit stage: its rates, and the modes that go with them.
            self.change_modes(self.settings.events.gap);
        }
        let to_time_stepping = self.state.time_stepping;
        let switch = MethodSwitch { time: self.state.time(), to_time_stepping, mode_changes_per_step };
        if let Some(record) = &mut self.method_switches {
            record.push(switch);
        }
    }
}
