//! How long the steps are: their bounds, the controller of their length, and the guard against chattering.

use serde::{Deserialize, Serialize};

use super::motion::SimulationError;
use crate::model::Model;

/// The longest event-driven step, as a multiple of the mean time between events: a longer one would be cut, after a
/// search through all of it.
///
/// Recommended 4 to 10: shorter ones end before there is an event, longer ones are less accurate where they are cut.
const OF_SPACING: f64 = 8.0;
/// The weight of the latest in the mean time between events.
const SPACING_GAIN: f64 = 0.3;
/// The least that this mean falls to, as a fraction of the step that the error allows: many events at one instant say
/// nothing of later ones.
const MIN_SPACING: f64 = 0.01;
/// What is left of the length of a step whose stages could not be solved.
const AFTER_FAILURE: f64 = 0.25;
/// The least and the most by which one step differs from the one before.
pub(super) const GROWTH: (f64, f64) = (0.2, 5.0);
/// Length of a step below which a cut is suspected of chattering, divided by the stiffest period over 2π.
const CHATTERING: f64 = 1e-9;
/// Number of such steps after which the shortest cut doubles. Simultaneous events of many masses also take many of
/// them, but modes change at those.
const MAX_CHATTERING: u32 = 100;

/// A good step of length `h` (s) that is to be accepted up to its `fraction`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TrialStep {
    pub h: f64,
    pub fraction: f64,
}

impl TrialStep {
    /// The end of a step from the time `s` of a motion of `duration`, s: exactly that of the motion where it is the
    /// last.
    pub(super) fn end(&self, s: f64, duration: f64) -> f64 {
        let is_last = self.fraction >= 1.0 && self.h >= duration - s;
        if is_last { duration } else { s + self.fraction * self.h }
    }
}

/// The work that one motion may take.
#[derive(Clone, Copy, Debug)]
pub(super) struct WorkLimit {
    /// Steps that were tried.
    pub tried: u64,
    max_steps: u64,
    /// What is left of it: steps times the masses that take them.
    pub mass_steps: u64,
}

/// What a step costs beside its masses, in masses.
const STEP: u64 = 10;

/// The work of a step that so many `masses` take.
pub(super) fn work_of_step(masses: usize) -> u64 {
    masses as u64 + STEP
}

impl WorkLimit {
    pub(super) fn new(max_steps: u64, max_mass_steps: u64) -> Self {
        Self { tried: 0, max_steps, mass_steps: max_mass_steps }
    }

    /// Counts a step that takes the work of so many `masses` and is tried at `time`, s.
    pub(super) fn count(&mut self, time: f64, masses: usize) -> Result<(), SimulationError> {
        if self.tried >= self.max_steps {
            return Err(SimulationError::TooManySteps { time, steps: self.max_steps });
        }
        let left = self.mass_steps.checked_sub(work_of_step(masses));
        self.mass_steps = left.ok_or(SimulationError::TooMuchWork { time, steps: self.tried })?;
        self.tried += 1;
        Ok(())
    }
}

/// Bounds of the next step's length, s.
#[derive(Clone, Copy, Debug)]
pub(super) struct LengthBounds {
    /// Where the clock's resolution ends.
    pub shortest: f64,
    /// By the carrier's period.
    pub longest: f64,
    /// What remains of the motion.
    pub remaining: f64,
}

impl LengthBounds {
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

/// Chooses the lengths of steps, s, by the error of those before and by the events.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Controller {
    /// The length of the next step to try, s.
    pub step_size: f64,
    /// The running mean of the time between events, s; the largest number where there was none.
    pub event_spacing: f64,
    /// Time since the last event, s.
    pub since_event: f64,
    /// The step that the error allowed right after the last event or kink, s; the largest number before the first.
    pub step_after_event: f64,
}

impl Controller {
    /// One that tries a step of the length `step_size` (s) first.
    pub(super) fn new(step_size: f64) -> Self {
        Self { step_size, event_spacing: f64::MAX, since_event: 0.0, step_after_event: f64::MAX }
    }

    /// The longest step, s, that is likely to end before many events come.
    pub(super) fn longest_between_events(&self) -> f64 {
        OF_SPACING * self.event_spacing
    }

    /// The next step is no longer than `length`, s.
    pub(super) fn limit(&mut self, length: f64) {
        self.step_size = self.step_size.min(length);
    }

    /// The length of the next step, s, after a good one of length `h`, by whose error it grows to `grown`. One that was
    /// cut short to `limit` by the end of the motion or by the events says nothing. It is at most `longest`.
    pub(super) fn propose(&self, (h, grown): (f64, f64), limit: f64, longest: f64) -> f64 {
        let next = if h < limit { grown } else { grown.max(self.step_size) };
        next.min(longest)
    }

    /// A step of length `h` was rejected: the next one is `ratio` times as long, and at most `longest` (s). No ratio
    /// where its stages could not be solved.
    pub(super) fn reject(&mut self, h: f64, ratio: Option<f64>, longest: f64) {
        self.step_size = ratio.map_or(AFTER_FAILURE * h, |ratio| (h * ratio).min(longest));
    }

    /// A step of length `h` (s), as far as it was accepted, ends without an event.
    pub(super) fn record_step(&mut self, h: f64) {
        self.since_event += h;
        self.event_spacing = self.event_spacing.max(self.since_event);
    }

    /// A step of length `h` (s), as far as it was accepted, ends at an event.
    pub(super) fn record_event(&mut self, h: f64) {
        self.since_event += h;
        // A mean from long ago counts no more than the latest.
        let mean = self.event_spacing.min(self.since_event / SPACING_GAIN);
        let latest = mean + SPACING_GAIN * (self.since_event - mean);
        self.event_spacing = latest.max(MIN_SPACING * self.step_size);
        self.since_event = 0.0;
    }
}

/// Ends chattering: steps that make no progress because rounding makes events.
///
/// Where a mass is so fast that the rounding of its velocity, divided by the length of a short step, is an inertia
/// force larger than the tolerance of events, an event is found at the start of each such step but is not due at its
/// end. The run would cut every step to the resolution of time. After some of these steps in a row, the shortest length
/// that a step is cut to therefore doubles with each, until a mode changes or no event is found.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ChatterGuard {
    /// Steps cut to this length, s, or less are suspected.
    length: f64,
    /// Number of steps cut so short after which no mode changed, less the number of other steps since.
    steps: u32,
    /// Number of mode changes before the last step, if it was cut so short.
    events_before: Option<u64>,
}

impl ChatterGuard {
    pub(super) fn new(model: &Model) -> Self {
        Self { length: CHATTERING / model.stiffest_frequency(), ..Self::default() }
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
        shortest * f64::from(self.steps.saturating_sub(MAX_CHATTERING)).exp2()
    }

    /// Records a step of length `h` (s) that is about to be accepted, and whether an event has cut it; `events` is the
    /// number of mode changes before it.
    pub(super) fn record_step(&mut self, h: f64, is_cut: bool, events: u64) {
        self.events_before = (is_cut && h <= self.length).then_some(events);
    }
}
