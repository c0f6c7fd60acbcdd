//! Method *auto*: from events to time-stepping where mode changes come fast, and back where they are few again.
//!
//! What decides is the number of mode changes per time step, in the mean over the last [`MEMORY`] of them. An event
//! costs the event-driven method a step of six stages, which is cut there; a time step costs two and takes any number of
//! changes. So time-stepping is cheaper from a third of a change per step on.

use super::driver::TrialStep;
use super::record::MethodSwitch;
use super::run::Run;
use crate::scene::Method;

/// Mode changes per time step, in the mean, from which on the run is time-stepped: half as much again as would pay, so
/// that a few changes are still located.
const MANY: f64 = 0.5;
/// Below this many the run is event-driven again: a third of what would pay, so that it does not alternate between the
/// two.
const FEW: f64 = 0.1;
/// Time steps over which the mean is taken.
const MEMORY: f64 = 8.0;

impl Run {
    /// Accepts a step, which ends at the time `end` of the piece, and makes the mode changes due there.
    pub(super) fn take_step(&mut self, step: &TrialStep, end: f64) {
        let (before, auto) = (self.state.counters.events, self.settings.method == Method::Auto);
        let mut time_step = step.h;
        if self.state.time_stepping {
            self.accept_time_step(step.h, end);
        } else {
            if auto {
                time_step *= self.workspace.integrator.two_stage_length_ratio(step.h, &self.settings.tolerance);
            }
            self.accept_event_driven_step(step, end);
        }
        if auto {
            self.state.mode_changes_per_step *= (-step.share * step.h / (MEMORY * time_step)).exp();
            self.state.mode_changes_per_step += (self.state.counters.events - before) as f64 / MEMORY;
            self.switch_if_due(time_step);
        }
    }

    fn switch_if_due(&mut self, time_step: f64) {
        let mode_changes_per_step = self.state.mode_changes_per_step;
        let due = if self.state.time_stepping { mode_changes_per_step < FEW } else { mode_changes_per_step > MANY };
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
