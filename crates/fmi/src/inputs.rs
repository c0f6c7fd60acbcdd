//! The inputs as a master sets them, and where they go in a communication step.

use serde::{Deserialize, Serialize};

use super::error::InputOutOfRange;
use super::history::{Cadence, History};
use asperity::scene::{Extrapolation, InputRule, is_possible};

/// The number of slots for inputs: a patch has the most.
pub(super) const MAX_INPUTS: usize = 8;

/// The communication steps whose sizes are kept.
const LAST_STEPS: usize = 8;

/// The inputs of a model, each in a slot of its own; slots without an input stay 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Inputs {
    signals: [Signal; MAX_INPUTS],
    /// The sizes of the last communication steps, s, the last one first; 0 before the first.
    steps: [f64; LAST_STEPS],
    /// How long ago the values came that the inputs are at, s, where they follow them late.
    delay: f64,
}

/// One input: its value and what the next step follows from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Signal {
    /// The input's value, SI units.
    value: f64,
    /// Its first derivative, if the master gave it for the next step.
    rate: Option<f64>,
    /// The values before.
    history: History,
    /// How often new values come.
    cadence: Cadence,
    /// Its value at the end of the step, where that is known.
    #[serde(skip)]
    end: Option<f64>,
}

/// A communication step that is to be done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommunicationStep {
    /// The time at its start, s.
    pub time: f64,
    /// Its size, s.
    pub h: f64,
    /// How inputs go on where the master gives no derivatives.
    pub rule: InputRule,
}

/// When a value that came is the one that an input went to, but for rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputScales {
    /// What each slot is measured by.
    kinds: [InputKind; MAX_INPUTS],
    /// The least of lengths, m: the spacing of the masses.
    spacing: f64,
}

/// What an input is measured by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InputKind {
    /// A length, by the largest of all lengths.
    Length,
    /// By its own size.
    Other,
    /// Held over a step at its value, which is no prediction; or no input at all.
    Held,
}

impl InputScales {
    /// The scales of the inputs in these slots, those of lengths with a least one, m.
    pub(super) fn new(slots: impl IntoIterator<Item = (usize, InputKind)>, spacing: f64) -> Self {
        let mut kinds = [InputKind::Held; MAX_INPUTS];
        slots.into_iter().for_each(|(slot, kind)| kinds[slot] = kind);
        Self { kinds, spacing }
    }

    /// Whether the slot has an input that moves within a step.
    fn moves(&self, slot: usize) -> bool {
        self.kinds[slot] != InputKind::Held
    }
}

/// A communication step in which an input without a derivative went to an extrapolated value: it is done again where
/// another value comes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProvisionalStep {
    /// The inputs at its start, as they were set.
    inputs: Inputs,
    /// The time at its start, s.
    time: f64,
    /// Its size, s.
    h: f64,
    /// Whether the inputs were held instead, for what was extrapolated could not be done.
    is_held: bool,
}

/// The part of its scale by which a value may be off that an input went to.
const SAME: f64 = 1e-12;

/// How much the time may be off, as a part of it, at which a master takes values.
const TIME_ROUNDING: f64 = 8.0 * f64::EPSILON;

impl ProvisionalStep {
    /// The step if it is provisional.
    pub fn new(inputs: &Inputs, step: &CommunicationStep, scales: &InputScales) -> Option<Self> {
        let own = Self { inputs: *inputs, time: step.time, h: step.h, is_held: false };
        (step.rule.extrapolates() && own.slots(scales).next().is_some()).then_some(own)
    }

    /// The step itself.
    pub fn step(&self) -> CommunicationStep {
        let extrapolation = if self.is_held { Extrapolation::Hold } else { Extrapolation::Linear };
        CommunicationStep { time: self.time, h: self.h, rule: InputRule { extrapolation, interval: 0.0 } }
    }

    /// The step with its inputs held at their values; `None` where they went to no others.
    pub(super) fn held(self, scales: &InputScales) -> Option<Self> {
        let moves = |slot: usize| self.target(slot) != self.inputs.value(slot);
        self.slots(scales).any(moves).then_some(Self { is_held: true, ..self })
    }

    /// The inputs with which it is done again, straight to the values that `came` at its end; `None` where it went there.
    /// A value that no step goes to does not count: the next step refuses it.
    pub fn corrected(&self, came: &Inputs, scales: &InputScales) -> Option<Inputs> {
        let size = |slot: usize| {
            let values = [self.inputs.value(slot), self.target(slot), came.value(slot)];
            values.into_iter().map(f64::abs).fold(0.0, f64::max)
        };
        let lengths = (0..MAX_INPUTS).filter(|&slot| scales.kinds[slot] == InputKind::Length);
        let length = lengths.map(size).fold(scales.spacing, f64::max);
        let differs = |slot: usize| {
            let scale = if scales.kinds[slot] == InputKind::Length { length } else { size(slot) };
            let (value, target) = (came.value(slot), self.target(slot));
            // At a constant rate the rounding of the time is one of the value.
            let rate = (target - self.inputs.value(slot)) / self.h;
            let rounding = TIME_ROUNDING * (self.time.abs() + self.h) * rate.abs();
            is_possible(value) && (value - target).abs() > SAME * scale + rounding
        };
        if !self.slots(scales).any(differs) {
            return None;
        }
        let mut corrected = self.inputs;
        for slot in self.slots(scales).filter(|&slot| is_possible(came.value(slot))) {
            corrected.signals[slot].end = Some(came.value(slot));
        }
        Some(corrected)
    }

    /// Where an input went.
    fn target(&self, slot: usize) -> f64 {
        self.inputs.signals[slot].target(&self.step())
    }

    /// The slots whose inputs were extrapolated.
    fn slots(&self, scales: &InputScales) -> impl Iterator<Item = usize> {
        let extrapolated = |slot: &usize| scales.moves(*slot) && self.inputs.signals[*slot].rate.is_none();
        (0..MAX_INPUTS).filter(extrapolated)
    }

    /// Whether it can be the last step of a run that has reached `end` (s), with these inputs.
    pub(super) fn is_valid(&self, inputs: &Inputs, end: f64) -> bool {
        let before = &self.inputs;
        let is_past = |slot: usize| {
            inputs.signals[slot].history.last() == Some((before.value(slot), self.h)) && is_possible(self.target(slot))
        };
        // A master's time may be off by less than half a step.
        let ends = (self.time + self.h - end).abs() <= self.h;
        ends && before.is_valid() && is_possible(self.time) && (0..MAX_INPUTS).all(is_past)
    }
}

/// A step that an event has cut off is shorter than this part of the longest of the last ones. Masters with uneven steps
/// are followed exactly.
const CUT_OFF: f64 = 0.2;

impl Inputs {
    /// The value of an input.
    pub fn value(&self, slot: usize) -> f64 {
        self.signals[slot].value
    }

    /// Sets an input.
    pub fn set(&mut self, slot: usize, value: f64) {
        self.signals[slot].value = value;
    }

    /// Sets the first derivative of an input for the next step.
    pub fn set_rate(&mut self, slot: usize, rate: f64) {
        self.signals[slot].rate = Some(rate);
    }

    /// The first derivative that the master gave for the next step; 0 where it gave none.
    pub(super) fn rate(&self, slot: usize) -> f64 {
        self.signals[slot].rate.unwrap_or_default()
    }

    /// The input called `name` at the end of a step.
    ///
    /// # Errors
    /// [`InputOutOfRange`], also where it is out of range at the start.
    pub(super) fn target(
        &self,
        slot: usize,
        name: &'static str,
        step: &CommunicationStep,
    ) -> Result<f64, InputOutOfRange> {
        let target = self.signals[slot].target(step);
        match [self.value(slot), target].into_iter().find(|value| !is_possible(*value)) {
            Some(value) => Err(InputOutOfRange { name, value, time: step.time }),
            None => Ok(target),
        }
    }

    /// The rate at which a displacement goes straight from `current`, where it is, to the target of the input called
    /// `name`. Rounding does not accumulate, since the next step starts from where this one ended.
    ///
    /// In a step far shorter than the last ones, which an event has cut off, a jump takes half the longest of these: a part
    /// of it is gone, and the next step goes on from there. Within a nanosecond it would be a loss in the dampers that
    /// stays.
    ///
    /// # Errors
    /// As for [`target`](Self::target).
    pub(super) fn rate_from(
        &self,
        current: f64,
        slot: usize,
        name: &'static str,
        step: &CommunicationStep,
    ) -> Result<f64, InputOutOfRange> {
        let target = self.target(slot, name, step)?;
        let signal = &self.signals[slot];
        if let Some(rate) = signal.given_rate(current) {
            return Ok(rate);
        }
        let longest = self.longest_step(step.h);
        if step.h >= CUT_OFF * longest {
            return Ok((target - current) / step.h);
        }
        let least = 0.5 * longest;
        // The motion so far goes on, and a jump is what differs from it.
        let rate = signal.rate.unwrap_or_else(|| signal.way(step.h, least) / step.h);
        Ok(rate + (target - current - rate * step.h) / least)
    }

    /// The rate at which an input called `name` goes from its value to its target: it may jump before.
    ///
    /// # Errors
    /// As for [`target`](Self::target).
    pub(super) fn rate_from_value(
        &self,
        slot: usize,
        name: &'static str,
        step: &CommunicationStep,
    ) -> Result<f64, InputOutOfRange> {
        let target = self.target(slot, name, step)?;
        Ok(self.signals[slot].rate.unwrap_or((target - self.value(slot)) / step.h))
    }

    /// The longest of the last steps and one of `h`, s.
    fn longest_step(&self, h: f64) -> f64 {
        self.steps.iter().copied().fold(h, f64::max)
    }

    /// Whether a run can have reached these inputs: the values of past steps are finite. Values and rates of the next
    /// step may be anything.
    pub(super) fn is_valid(&self) -> bool {
        let is_time = |time: &f64| is_possible(*time) && *time >= 0.0;
        self.signals.iter().all(|signal| signal.history.is_valid())
            && self.steps.iter().chain([&self.delay]).all(is_time)
    }

    /// Completes a step: its derivatives apply to no other.
    pub fn complete_step(&mut self, step: &CommunicationStep) {
        self.delay = self.delay_after(step);
        self.signals.iter_mut().for_each(|signal| signal.complete_step(step));
        self.steps.rotate_right(1);
        self.steps[0] = step.h;
    }

    /// The input whose new values came in every m-th step alone, three times running, and how far apart, s: the master
    /// has values for it more seldom than it steps.
    pub(super) fn slow_input(&self, scales: &InputScales) -> Option<(usize, f64)> {
        (0..MAX_INPUTS).filter(|&slot| scales.moves(slot)).find_map(|slot| {
            let count = self.signals[slot].cadence.regular()?;
            let steps = self.steps.get(..count).map(|steps| steps.iter().sum());
            Some((slot, steps.unwrap_or(count as f64 * self.steps[0])))
        })
    }

    /// How far behind their values the inputs are after a step in which they follow them late, s.
    ///
    /// With an interval it is that. Else it is the longest step, so that a value is gone to over the time in which it
    /// came, however uneven steps are; where all that follow are far shorter, that is caught up with at twice the speed.
    fn delay_after(&self, step: &CommunicationStep) -> f64 {
        let CommunicationStep { h, rule, .. } = *step;
        if rule.interval > 0.0 {
            return rule.interval;
        }
        let longest = self.longest_step(h);
        let delay = if self.delay > 2.0 * longest { (self.delay - h).max(longest) } else { self.delay.max(h) };
        // No farther than the values that are kept.
        delay.min(self.steps[1..].iter().sum::<f64>() + h)
    }

    /// The parts of a step, in each of which the inputs go straight: one, but where they follow their values late.
    pub fn parts(&self, step: &CommunicationStep, scales: &InputScales) -> Parts {
        let mut inputs = *self;
        if step.rule.extrapolates() {
            return Parts { inputs, step: *step, scales: *scales, start: 0.0, end: 0.0, done: 0.0 };
        }
        // Ways are as long as they are to be.
        inputs.steps = Default::default();
        inputs.signals.iter_mut().for_each(|signal| signal.history.push(signal.value, step.rule.interval));
        let start = if step.rule.interval > 0.0 { step.rule.interval } else { self.delay };
        Parts { inputs, step: *step, scales: *scales, start, end: self.delay_after(step) - step.h, done: 0.0 }
    }
}

/// The parts of a communication step, with the inputs of each.
#[derive(Debug)]
pub struct Parts {
    /// The inputs with their values at the start of the step in their histories.
    inputs: Inputs,
    step: CommunicationStep,
    scales: InputScales,
    /// How long before the start of the step the values came that the inputs are at when it starts and when it ends, s;
    /// neither where inputs are extrapolated.
    start: f64,
    end: f64,
    /// How much of the step is done, s.
    done: f64,
}

impl Parts {
    /// Parts of a step below this share of it are rounding.
    const ROUNDING: f64 = 1e-9;

    /// How many seconds of the values' course are followed in a second.
    fn speed(&self) -> f64 {
        (self.start - self.end) / self.step.h
    }

    /// How long before the start of the step the values came that the inputs are at, so long (s) after it; those that come
    /// later are not known.
    fn age_at(&self, after: f64) -> f64 {
        (self.start - self.speed() * after).max(0.0)
    }

    /// How much of the step is done when the next value is reached, s.
    fn next_end(&self) -> f64 {
        let CommunicationStep { h, rule, .. } = self.step;
        if rule.extrapolates() {
            return h;
        }
        let (start, speed, slack) = (self.start, self.speed(), Self::ROUNDING * h);
        let late = |slot: &usize| self.scales.moves(*slot) && self.inputs.signals[*slot].rate.is_none();
        let ages = (0..MAX_INPUTS).filter(late).flat_map(|slot| self.inputs.signals[slot].history.ages());
        let reached = ages.map(|age| (start - age) / speed);
        reached.filter(|&end| end > self.done + slack && end < h - slack).fold(h, f64::min)
    }

    /// Whether it is the step as a whole.
    pub(super) fn is_one(&self) -> bool {
        self.next_end() == self.step.h
    }
}

impl Iterator for Parts {
    type Item = (Inputs, CommunicationStep);

    fn next(&mut self) -> Option<Self::Item> {
        if self.done == self.step.h {
            return None;
        }
        let (begin, end) = (self.done, self.next_end());
        self.done = end;
        let mut inputs = self.inputs;
        if self.step.rule.extrapolates() {
            return Some((inputs, self.step));
        }
        for slot in (0..MAX_INPUTS).filter(|&slot| self.scales.moves(slot)) {
            let signal = &mut inputs.signals[slot];
            let of_rate = signal.rate.map(|rate| (signal.value + begin * rate, None));
            let at = |after: f64| signal.history.at(self.age_at(after)).unwrap_or(signal.value);
            (signal.value, signal.end) = of_rate.unwrap_or_else(|| (at(begin), Some(at(end))));
        }
        Some((inputs, CommunicationStep { time: self.step.time + begin, h: end - begin, ..self.step }))
    }
}

/// Displacements whose relative difference is smaller are equal but for rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Signal {
    fn complete_step(&mut self, step: &CommunicationStep) {
        // A master's rounding is no new value.
        let is_same = |last: f64| (last - self.value).abs() <= ROUNDING * last.abs().max(self.value.abs());
        let is_new = self.history.last().is_some_and(|(last, _)| !is_same(last));
        if self.rate.is_some() {
            self.cadence = Cadence::default()
        } else {
            self.cadence.step(is_new)
        }
        self.rate = None;
        self.history.push(self.value, step.rule.interval);
        self.history.pass(step.h);
    }

    /// The rate that the master gave, if û = `current` equals its value but for rounding. It is then used as it is: if
    /// it were computed from the difference to the target, that rounding over h would be a kink at every communication
    /// point of a steady motion.
    fn given_rate(&self, current: f64) -> Option<f64> {
        let same = (current - self.value).abs() <= ROUNDING * current.abs().max(self.value.abs());
        self.rate.filter(|_| same)
    }

    /// The input at the end of a step.
    fn target(&self, step: &CommunicationStep) -> f64 {
        match (self.rate, self.end, step.rule.extrapolation) {
            (Some(rate), ..) => self.value + step.h * rate,
            (None, Some(end), _) => end,
            // A step before may have ended early, at an event: what jumped there is no speed.
            (None, None, Extrapolation::Linear) => self.value + self.way(step.h, 0.5 * step.h),
            (None, None, Extrapolation::Hold) => self.value,
        }
    }

    /// How far it goes within h (s) at its mean rate over the last `span` (s) or a little more.
    fn way(&self, h: f64, span: f64) -> f64 {
        match self.history.before(span) {
            // At rest it stays exactly where it is, whatever the ratio of the steps.
            Some((past, age)) if past != self.value => (self.value - past) * (h / age),
            _ => 0.0,
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn at(value: f64) -> Inputs {
        let mut inputs = Inputs::default();
        inputs.set(0, value);
        inputs
    }

    fn step(h: f64, extrapolation: Extrapolation) -> CommunicationStep {
        CommunicationStep { time: 0.0, h, rule: InputRule { extrapolation, interval: 0.0 } }
    }

    /// Does a step from 0 in the first two slots and returns where it ends.
    fn ends(inputs: &mut Inputs, h: f64, extrapolation: Extrapolation) -> [f64; 2] {
        let ends = [0, 1].map(|slot| inputs.target(slot, "u", &step(h, extrapolation)).unwrap());
        inputs.complete_step(&step(h, extrapolation));
        ends
    }

    #[test]
    fn the_first_step_without_rates_goes_to_the_value_given() {
        assert_eq!(ends(&mut at(3.0), 0.5, Extrapolation::Linear), [3.0, 0.0]);
    }

    #[test]
    fn linear_extrapolation_follows_a_steady_motion_from_the_second_step_on() {
        let mut inputs = at(0.0);
        ends(&mut inputs, 1.0, Extrapolation::Linear);
        for (value, h, target) in [(2.0, 0.5, 3.0), (3.0, 0.5, 4.0), (4.0, 0.25, 4.5)] {
            inputs.set(0, value);
            assert_eq!(ends(&mut inputs, h, Extrapolation::Linear), [target, 0.0]);
        }
    }

    /// From the value given, by its derivative, by the values before, or held.
    #[test]
    fn a_force_starts_from_its_value_and_may_jump() {
        let rate = |inputs: &Inputs, rule| inputs.rate_from_value(0, "load", &step(0.5, rule)).unwrap();
        let mut inputs = at(3.0);
        assert_eq!(rate(&inputs, Extrapolation::Linear), 0.0);
        inputs.complete_step(&step(0.25, Extrapolation::Linear));
        inputs.set(0, 5.0);
        assert_eq!(rate(&inputs, Extrapolation::Linear), 8.0);
        assert_eq!(rate(&inputs, Extrapolation::Hold), 0.0);
        inputs.set_rate(0, -1.0);
        assert_eq!(rate(&inputs, Extrapolation::Hold), -1.0);
    }

    #[test]
    fn hold_lags_by_one_step_and_never_overshoots() {
        let mut inputs = at(0.0);
        for value in [1.0, 2.0, 2.0] {
            inputs.set(0, value);
            assert_eq!(ends(&mut inputs, 1.0, Extrapolation::Hold), [value, 0.0]);
        }
    }

    #[test]
    fn a_rate_counts_for_one_step_and_its_own_input() {
        let mut inputs = at(0.0);
        inputs.set_rate(0, 2.0);
        assert_eq!(ends(&mut inputs, 0.5, Extrapolation::Linear), [1.0, 0.0]);
        inputs.set(0, 1.0);
        // 1 + (1 - 0)·0.25/0.5
        assert_eq!(ends(&mut inputs, 0.25, Extrapolation::Linear), [1.5, 0.0]);
    }

    #[test]
    fn rates_before_the_start_are_those_of_the_first_step() {
        let mut inputs = Inputs::default();
        inputs.set_rate(1, -0.5);
        assert_eq!([inputs.rate(0), inputs.rate(1)], [0.0, -0.5]);
        assert_eq!(ends(&mut inputs, 0.5, Extrapolation::Linear), [0.0, -0.25]);
        assert_eq!(ends(&mut inputs, 0.5, Extrapolation::Hold), [0.0, 0.0]);
    }

    #[test]
    fn a_displacement_goes_straight_from_where_it_is() {
        let rate = at(3.0).rate_from(1.0, 0, "u", &step(0.25, Extrapolation::Hold));
        assert_eq!(rate, Ok(8.0));
    }

    /// A carrier at 1e6 m, where the last digit is 1e-10 m: what its rounding would be over 1e-6 s is far from the
    /// rate.
    #[test]
    fn a_rate_given_at_the_carriers_position_is_used_as_it_is() {
        let value: f64 = 1e6 + 0.1;
        let rate = |current: f64| {
            let mut inputs = at(value);
            inputs.set_rate(0, 0.3);
            inputs.rate_from(current, 0, "u", &step(1e-6, Extrapolation::Linear)).unwrap()
        };
        for current in [value, value.next_up(), value.next_down()] {
            assert_eq!(rate(current), 0.3);
        }
        // A micrometre is no rounding: û goes where the target is.
        assert!((rate(value - 1e-6) - 1.3).abs() < 1e-3);
        assert!((rate(value + 1e-6) + 0.7).abs() < 1e-3);
    }

    /// The way of one input through steps of these sizes with these values, by parts.
    fn course(rule: InputRule, steps: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let scales = InputScales::new([(0, InputKind::Length)], 1.0);
        let (mut inputs, mut time, mut current) = (Inputs::default(), 0.0, steps[0].1);
        let mut course = vec![(time, current)];
        for &(h, value) in steps {
            inputs.set(0, value);
            let step = CommunicationStep { time, h, rule };
            for (inputs, part) in inputs.parts(&step, &scales) {
                current += inputs.rate_from(current, 0, "u", &part).unwrap() * part.h;
                course.push((part.time + part.h, current));
            }
            inputs.complete_step(&step);
            time += h;
        }
        course
    }

    /// What moves at 2 a second, in steps of 1, 3 and 2 s, is followed 3 s late, and goes at 2 a second once it moves.
    #[test]
    fn held_values_are_gone_to_over_the_time_in_which_they_came() {
        let hold = InputRule { extrapolation: Extrapolation::Hold, interval: 0.0 };
        let mut time = 0.0;
        let steps = [3.0, 3.0, 1.0, 2.0, 1.0, 3.0, 2.0].map(|h: f64| {
            time += h;
            (h, 2.0 * (time - h))
        });
        for (time, value) in course(hold, &steps) {
            assert!((value - 2.0 * (time - 3.0).max(0.0)).abs() < 1e-12, "{value} at {time} s");
        }
    }

    /// New values every 1 s in steps of 0.25 s: straight, 1 s late, as good as in steps of 0.4 s that do not divide it.
    #[test]
    fn values_with_an_interval_are_gone_to_over_it() {
        let rule = InputRule { interval: 1.0, ..InputRule::default() };
        for h in [0.25, 0.4] {
            let steps: Vec<_> = (0..40).map(|i| (h, (f64::from(i) * h + 1e-9).floor())).collect();
            for (time, value) in course(rule, &steps).into_iter().filter(|(time, _)| *time > 2.0) {
                // A value that comes between two steps is seen at the next.
                assert!((value - (time - 1.0)).abs() < if h == 0.25 { 1e-12 } else { 0.41 }, "{value} at {time} s");
            }
        }
    }

    /// An event ends a step early, and there the input jumps: no speed comes of that, and what is left goes on.
    #[test]
    fn a_jump_at_an_event_is_no_speed() {
        let rule = InputRule::default();
        let step = |h| CommunicationStep { time: 0.0, h, rule };
        let mut inputs = at(0.0);
        [1.0, 1.0].into_iter().for_each(|h| inputs.complete_step(&step(h)));
        // The way to 5 in a step of a nanosecond, done again: half a step at least.
        inputs.signals[0].end = Some(5.0);
        let rate = inputs.rate_from(0.0, 0, "u", &step(1e-9)).unwrap();
        assert_eq!(rate, 10.0);
        inputs.signals[0].end = None;
        inputs.complete_step(&step(1e-9));
        // The next prediction goes as far again as the jump, over a whole step and no farther.
        inputs.set(0, 5.0);
        let target = inputs.target(0, "u", &step(1.0)).unwrap();
        assert!((target - 10.0).abs() < 1e-6, "{target}");
        // A motion that goes on is no jump, however short the step.
        let mut inputs = at(0.0);
        for value in [0.0, 1.0, 2.0] {
            inputs.set(0, value);
            inputs.complete_step(&step(1.0));
        }
        inputs.set(0, 3.0);
        inputs.signals[0].end = Some(3.0 + 1e-3);
        assert!((inputs.rate_from(3.0, 0, "u", &step(1e-3)).unwrap() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn values_and_rates_that_are_not_finite_stop_the_step() {
        let target = |inputs: &Inputs| inputs.target(0, "u", &step(1.0, Extrapolation::Linear));
        assert!(target(&at(f64::NAN)).is_err());
        let mut inputs = at(0.0);
        inputs.set_rate(0, f64::INFINITY);
        let fault = target(&inputs).unwrap_err();
        assert_eq!(fault.to_string(), "the input u is inf at t = 0 s, which is out of range; the step was not done");
    }
}
