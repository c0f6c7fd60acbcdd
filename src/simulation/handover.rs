//! Method *auto*: from events to time-stepping where mode changes crowd, and back where they are few again.
//!
//! What decides is how many mode changes fall on one step of the time-stepping driver, in the mean of the last
//! [`MEMORY`] such steps. An event costs the event-driven one a step of six stages, which is cut there; a time step
//! costs two and takes any number of changes. So time-stepping is cheaper from a third of a change a step on.

use std::fmt;

use super::Simulation;
use super::stepping::Stride;
use crate::scene::Method;

/// Mode changes on one time step, in the mean, from which on the run is stepped: half as much again as would pay, so
/// that a few changes are still located.
const CROWDED: f64 = 0.5;
/// Below this many it is event-driven again: a third of what would pay, so that a run does not swing between the two.
const QUIET: f64 = 0.1;
/// Time steps over which the mean is taken.
const MEMORY: f64 = 8.0;

/// The run went over to the other driver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handover {
    /// When, s.
    pub time: f64,
    /// To time-stepping, or back to events.
    pub to_stepping: bool,
    /// Mode changes on one time step, in the mean, that decided it.
    pub crowding: f64,
}

impl fmt::Display for Handover {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { time, to_stepping, crowding } = self;
        let driver = if *to_stepping { "time-stepping from here on" } else { "events are located from here on" };
        write!(f, "t = {time} s: {driver}; mode changes on one time step: {crowding:.2}")
    }
}

impl Simulation {
    /// Goes to the end of a stride, at the time `end` of the piece, and changes the modes due there.
    pub(super) fn take_step(&mut self, stride: &Stride, end: f64) {
        let (before, auto) = (self.run.counters.events, self.settings.method == Method::Auto);
        let mut time_step = stride.h;
        if self.run.stepping {
            self.accept_time_step(stride.h, end);
        } else {
            if auto {
                time_step *= self.integrator.two_stage_share(stride.h, &self.settings.tolerance);
            }
            self.accept(stride, end);
        }
        if auto {
            self.run.crowding *= (-stride.share * stride.h / (MEMORY * time_step)).exp();
            self.run.crowding += (self.run.counters.events - before) as f64 / MEMORY;
            self.hand_over_if_due(time_step);
        }
    }

    fn hand_over_if_due(&mut self, time_step: f64) {
        let crowding = self.run.crowding;
        let due = if self.run.stepping { crowding < QUIET } else { crowding > CROWDED };
        if !due {
            return;
        }
        self.run.stepping = !self.run.stepping;
        if self.run.stepping {
            self.run.step_size = self.run.step_size.min(time_step);
        } else {
            // The event-driven steps begin with an explicit stage: its rates, and the modes that go with them.
            self.change_modes(self.settings.events.gap);
        }
        let handover = Handover { time: self.run.time(), to_stepping: self.run.stepping, crowding };
        if let Some(record) = &mut self.handovers {
            record.push(handover);
        }
    }

    /// Whether the time-stepping driver has the run now, or the event-driven one.
    pub fn is_stepping(&self) -> bool {
        self.run.stepping
    }

    /// Keeps a record of handovers from now on, or stops keeping it.
    pub fn record_handovers(&mut self, on: bool) {
        self.handovers = on.then(Vec::new);
    }

    /// The handovers recorded since the last call.
    pub fn take_handovers(&mut self) -> Vec<Handover> {
        self.handovers.as_mut().map(std::mem::take).unwrap_or_default()
    }
}
