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
    /// The last communication step, and the one before it.
    past: [Option<Past>; 2],
    sampling: Sampling,
}

/// A communication step that is done.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Past {
    /// The input at its start.
    value: f64,
    /// h_{n-1}, s: its size.
    step: f64,
}

/// Whether values come from a source that samples on another grid than that of the communication points.
///
/// Their rate between two points then changes forth and back, singly or with alternating signs. Where a motion goes
/// faster or slower, its rate changes with one sign over several steps; where it starts or stops, once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Sampling {
    /// The last rate between communication points, per second.
    rate: Option<f64>,
    /// Its last changes, the latest first.
    changes: [f64; 2],
    /// How often it has changed forth and back.
    alternations: u8,
}

impl Sampling {
    /// Changes of a rate below this part of it are no pattern.
    const SIGNIFICANT: f64 = 0.01;
    /// So many are none by chance.
    const ENOUGH: u8 = 3;

    /// Includes the `rate` since the last communication point.
    fn include(&mut self, rate: f64) {
        let Some(before) = self.rate.replace(rate) else { return };
        let (change, [last, earlier]) = (rate - before, self.changes);
        let limit = Self::SIGNIFICANT * rate.abs().max(before.abs());
        let is_significant = |change: f64| change.abs() > limit;
        let reverses = is_significant(change) && is_significant(last) && change * last < 0.0;
        let is_gradual = is_significant(earlier) && earlier * last > 0.0;
        self.alternations = self.alternations.saturating_add((reverses && !is_gradual).into());
        self.changes = [change, last];
    }

    /// Whether rates between two points are not those of the motion.
    fn is_uneven(&self) -> bool {
        self.alternations >= Self::ENOUGH
    }
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

    /// Whether the values of an input come from a source on another grid than that of the communication points.
    pub(super) fn is_uneven(&self, slot: usize) -> bool {
        self.0[slot].sampling.is_uneven()
    }
}

/// Displacements whose relative difference is smaller are equal but for rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Signal {
    /// Whether the values of the past step are finite.
    fn is_valid(&self) -> bool {
        self.past.iter().flatten().all(|past| is_possible(past.value) && is_possible(past.step) && past.step > 0.0)
    }

    fn complete_step(&mut self, h: f64) {
        match (self.rate.take(), self.past[0]) {
            (None, Some(past)) => self.sampling.include((self.value - past.value) / past.step),
            _ => self.sampling.rate = None,
        }
        self.past = [Some(Past { value: self.value, step: h }), self.past[0]];
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
        match (self.rate, step.extrapolation, self.past) {
            (Some(rate), _, _) => self.value + step.h * rate,
            // Of points on another grid, the mean rate over two steps is that of the motion.
            (None, Extrapolation::Linear, [Some(past), Some(earlier)]) if self.sampling.is_uneven() => {
                self.value + (self.value - earlier.value) * (step.h / (past.step + earlier.step))
            }
            // At rest it stays exactly where it is, whatever the ratio of the steps.
            (None, Extrapolation::Linear, [Some(past), _]) if past.value != self.value => {
                self.value + (self.value - past.value) * (step.h / past.step)
            }
            (None, Extrapolation::Linear | Extrapolation::Hold, _) => self.value,
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

    /// Steps of 25 µs, a source every 10, 40 or 62.5 µs: a steady motion of 2 m/s is off by what it goes in the age of
    /// a value, and by a step at a mean rate over two that is a multiple of the source's.
    #[test]
    fn values_of_another_grid_are_followed_by_their_mean_rate() {
        let (h, speed) = (25.0, 2.0);
        let sources =
            [(10.0, 20.0, true), (40.0, 90.0, true), (62.5, 175.0, true), (25.0, 1e-6, false), (1e-3, 0.1, false)];
        for (grid, bound, is_found) in sources {
            let mut inputs = at(0.0);
            for k in 0..40 {
                inputs.set(0, speed * grid * (f64::from(k) * h / grid + 1e-9).floor());
                let target = inputs.target(0, "u", &step(h, Extrapolation::Linear)).unwrap();
                let lag = speed * f64::from(k + 1) * h - target;
                assert!(k < 20 || lag.abs() <= bound, "{grid}: {lag} at {k}");
                inputs.complete_step(h);
            }
            assert_eq!(inputs.is_uneven(0), is_found, "{grid}");
        }
    }

    /// Motions on an even grid are no such pattern: sines from eight points a period on, ramps, steps that begin and
    /// end.
    #[test]
    fn motions_on_an_even_grid_are_extrapolated_as_they_are() {
        let sine = |points: f64, phase: f64| move |k: f64| (std::f64::consts::TAU * k / points + phase).sin();
        let ramp = |k: f64| (k - 10.0).clamp(0.0, 12.0) - (k - 30.0).clamp(0.0, 12.0);
        for phase in 0..20 {
            let phase = 0.1 * f64::from(phase);
            for motion in [sine(8.0, phase), sine(13.3, phase), sine(50.0, phase)] {
                let mut inputs = at(motion(0.0));
                for k in 0..200 {
                    inputs.set(0, motion(f64::from(k)));
                    inputs.complete_step(0.1);
                }
                assert!(!inputs.is_uneven(0), "{phase}");
            }
        }
        let mut inputs = at(0.0);
        for k in 0..200 {
            inputs.set(0, ramp(f64::from(k % 50)));
            inputs.complete_step(0.1);
        }
        assert!(!inputs.is_uneven(0));
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
