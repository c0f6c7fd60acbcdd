//! Events made by rounding: how a run leaves a place where they would stop it.

use crate::model::Model;

/// Length of a step below which a cut is suspected of a [`Stall`], divided by the stiffest period over 2π.
const STALLED: f64 = 1e-9;
/// Number of such steps after which the shortest cut doubles. Simultaneous events of many masses also take many of them,
/// but modes change at those.
const MOST_STALLED: u32 = 100;

/// Steps that make no progress because rounding makes events.
///
/// Where a mass is so fast that the rounding of its velocity, divided by the length of a short step, is an inertia force
/// larger than the tolerance of events, an event is found at the start of each such step but is not due at its end. The
/// run would cut every step to the resolution of time. After some of these steps in a row, the shortest length that a
/// step is cut to therefore doubles with each, until a mode changes or no event is found.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stall {
    /// Steps cut to this length, s, or less are suspected.
    length: f64,
    /// Number of steps cut so short after which no mode changed, less the number of other steps since.
    steps: u32,
    /// Number of mode changes before the last step, if it was cut so short.
    events_before: Option<u64>,
}

impl Stall {
    pub(super) fn new(model: &Model) -> Self {
        Self { length: STALLED / model.stiffest_frequency(), ..Self::default() }
    }

    pub(super) fn reset(&mut self) {
        (self.steps, self.events_before) = (0, None);
    }

    /// The shortest length, s, that the next step may be cut to; `shortest` (s) is the resolution of time, `events` the
    /// number of mode changes so far.
    pub(super) fn shortest_cut(&mut self, shortest: f64, events: u64) -> f64 {
        if self.events_before.take() == Some(events) {
            self.steps += 1;
        } else {
            self.steps = self.steps.saturating_sub(1);
        }
        shortest * f64::from(self.steps.saturating_sub(MOST_STALLED)).exp2()
    }

    /// Records a step of length `h` (s) that is about to be accepted, and whether an event has cut it; `events` is the
    /// number of mode changes before it.
    pub(super) fn note_step(&mut self, h: f64, cut: bool, events: u64) {
        self.events_before = (cut && h <= self.length).then_some(events);
    }
}
