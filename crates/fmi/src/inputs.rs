//! The inputs as a master sets them, and where they go in a communication step.

use serde::{Deserialize, Serialize};

use super::error::InputOutOfRange;
use asperity::scene::{Extrapolation, is_possible};

/// The number of slots for inputs: a patch has the most.
pub(super) const MAX_INPUTS: usize = 8;

/// The inputs of a model, each in a slot of its own; slots without an input stay 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Inputs([Signal; MAX_INPUTS]);

/// One input: its value and what the next step follows from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Signal {
    /// The input's value, SI units.
    value: f64,
    /// Its first derivative, if the master gave it for the next step.
    rate: Option<f64>,
    /// The last communication step.
    past: Option<Past>,
    /// Its value at the end of the step, where that came before the step is done again.
    #[serde(skip)]
    end: Option<f64>,
}

/// A communication step that is done.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Past {
    /// The input at its start.
    value: f64,
    /// h_{n-1}, s: its size.
    step: f64,
}

/// A communication step that is to be done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommunicationStep {
    /// The time at its start, s.
    pub time: f64,
    /// Its size, s.
    pub h: f64,
    /// How inputs go on where the master gives no derivatives.
    pub extrapolation: Extrapolation,
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
}

/// The part of its scale by which a value may be off that an input went to.
const SAME: f64 = 1e-12;

impl ProvisionalStep {
    /// The step if it is provisional.
    pub fn new(inputs: &Inputs, step: &CommunicationStep, scales: &InputScales) -> Option<Self> {
        let own = Self { inputs: *inputs, time: step.time, h: step.h };
        (step.extrapolation == Extrapolation::Linear && own.slots(scales).next().is_some()).then_some(own)
    }

    /// The step itself.
    pub fn step(&self) -> CommunicationStep {
        CommunicationStep { time: self.time, h: self.h, extrapolation: Extrapolation::Linear }
    }

    /// The inputs with which it is done again, straight to the values that `came` at its end; `None` where it went there.
    /// A value that no step goes to does not count: the next step refuses it.
    pub fn corrected(&self, came: &Inputs, scales: &InputScales) -> Option<Inputs> {
        let step = self.step();
        let size = |slot: usize| {
            let values = [self.inputs.value(slot), self.inputs.0[slot].target(&step), came.value(slot)];
            values.into_iter().map(f64::abs).fold(0.0, f64::max)
        };
        let lengths = (0..MAX_INPUTS).filter(|&slot| scales.kinds[slot] == InputKind::Length);
        let length = lengths.map(size).fold(scales.spacing, f64::max);
        let differs = |slot: usize| {
            let scale = if scales.kinds[slot] == InputKind::Length { length } else { size(slot) };
            let value = came.value(slot);
            is_possible(value) && (value - self.inputs.0[slot].target(&step)).abs() > SAME * scale
        };
        if !self.slots(scales).any(differs) {
            return None;
        }
        let mut corrected = self.inputs;
        for slot in self.slots(scales).filter(|&slot| is_possible(came.value(slot))) {
            corrected.0[slot].end = Some(came.value(slot));
        }
        Some(corrected)
    }

    /// The slots whose inputs were extrapolated.
    fn slots(&self, scales: &InputScales) -> impl Iterator<Item = usize> {
        let extrapolated = |slot: &usize| scales.kinds[*slot] != InputKind::Held && self.inputs.0[*slot].rate.is_none();
        (0..MAX_INPUTS).filter(extrapolated)
    }

    /// Whether it can be the last step of a run that has reached `end` (s), with these inputs.
    pub(super) fn is_valid(&self, inputs: &Inputs, end: f64) -> bool {
        let (before, h) = (&self.inputs, self.h);
        let step = self.step();
        let is_past = |(signal, before): (&Signal, &Signal)| {
            signal.past == Some(Past { value: before.value, step: h }) && is_possible(before.target(&step))
        };
        // A master's time may be off by less than half a step.
        let ends = (self.time + h - end).abs() <= h;
        ends && before.is_valid() && is_possible(self.time) && inputs.0.iter().zip(&before.0).all(is_past)
    }
}

impl Inputs {
    /// The value of an input.
    pub fn value(&self, slot: usize) -> f64 {
        self.0[slot].value
    }

    /// Sets an input.
    pub fn set(&mut self, slot: usize, value: f64) {
        self.0[slot].value = value;
    }

    /// Sets the first derivative of an input for the next step.
    pub fn set_rate(&mut self, slot: usize, rate: f64) {
        self.0[slot].rate = Some(rate);
    }

    /// The first derivative that the master gave for the next step; 0 where it gave none.
    pub(super) fn rate(&self, slot: usize) -> f64 {
        self.0[slot].rate.unwrap_or_default()
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
        let target = self.0[slot].target(step);
        match [self.value(slot), target].into_iter().find(|value| !is_possible(*value)) {
            Some(value) => Err(InputOutOfRange { name, value, time: step.time }),
            None => Ok(target),
        }
    }

    /// The rate at which a displacement goes straight from `current`, where it is, to the target of the input called
    /// `name`. Rounding does not accumulate, since the next step starts from where this one ended.
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
        Ok(self.0[slot].given_rate(current).unwrap_or((target - current) / step.h))
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
        Ok(self.0[slot].rate.unwrap_or((target - self.value(slot)) / step.h))
    }

    /// Whether a run can have reached these inputs: the values of past steps are finite. Values and rates of the next
    /// step may be anything.
    pub(super) fn is_valid(&self) -> bool {
        self.0.iter().all(Signal::is_valid)
    }

    /// Completes a step of `h` (s): its derivatives apply to no other.
    pub fn complete_step(&mut self, h: f64) {
        self.0.iter_mut().for_each(|signal| signal.complete_step(h));
    }
}

/// Displacements whose relative difference is smaller are equal but for rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Signal {
    /// Whether the values of the past step are finite.
    fn is_valid(&self) -> bool {
        self.past.iter().all(|past| is_possible(past.value) && is_possible(past.step) && past.step > 0.0)
    }

    fn complete_step(&mut self, h: f64) {
        self.rate = None;
        self.past = Some(Past { value: self.value, step: h });
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
        match (self.rate, self.end, step.extrapolation, self.past) {
            (Some(rate), ..) => self.value + step.h * rate,
            (None, Some(end), ..) => end,
            // At rest it stays exactly where it is, whatever the ratio of the steps.
            (None, None, Extrapolation::Linear, Some(past)) if past.value != self.value => {
                self.value + (self.value - past.value) * (step.h / past.step)
            }
            (None, None, Extrapolation::Linear | Extrapolation::Hold, _) => self.value,
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
        CommunicationStep { time: 0.0, h, extrapolation }
    }

    /// Does a step from 0 in the first two slots and returns where it ends.
    fn ends(inputs: &mut Inputs, h: f64, extrapolation: Extrapolation) -> [f64; 2] {
        let ends = [0, 1].map(|slot| inputs.rate_from(0.0, slot, "u", &step(h, extrapolation)).unwrap() * h);
        inputs.complete_step(h);
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
        inputs.complete_step(0.25);
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
