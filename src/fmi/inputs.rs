//! The inputs and the carrier's motion that follows from them: between communication points û is continuous and runs
//! straight to a target; a force runs straight, too, and may jump at a point.

use serde::{Deserialize, Serialize};

use crate::scene::{Extrapolation, Force, Path, is_possible};
use crate::simulation::{Motion, Start};

use super::definition::Input;
use super::error::InputOutOfRange;

/// The inputs as the master sets them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Inputs {
    signals: [Signal; Input::ALL.len()],
    /// Whether the temperature is one.
    has_temperature: bool,
}

/// One input: its value and what the next step follows from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Signal {
    /// u_n, m, or N_n, N: the input's value.
    value: f64,
    /// Its first derivative, if the master gave it for the next step.
    rate: Option<f64>,
    /// The communication step before.
    past: Option<Past>,
}

/// A communication step that is done.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Past {
    /// The input at its start.
    value: f64,
    /// h_{n-1}, s: its size.
    step: f64,
}

impl Inputs {
    /// Those of a layer whose temperature (K) is an input, or is none: the other inputs are 0.
    pub fn new(temperature: Option<f64>) -> Self {
        let mut inputs = Self { has_temperature: temperature.is_some(), ..Self::default() };
        inputs.set_input(Input::Temperature, temperature.unwrap_or(0.0));
        inputs
    }

    /// The temperature, K, if it is an input.
    fn temperature(&self) -> Option<f64> {
        self.has_temperature.then(|| self.input(Input::Temperature))
    }

    /// The value of an input.
    pub fn input(&self, input: Input) -> f64 {
        self.signals[input as usize].value
    }

    /// Sets an input.
    pub fn set_input(&mut self, input: Input, value: f64) {
        self.signals[input as usize].set(value);
    }

    /// Sets the first derivative of an input for the next step.
    pub fn set_rate(&mut self, input: Input, rate: f64) {
        self.signals[input as usize].set_rate(rate);
    }

    /// The carrier at the start: at the displacements given, with the derivatives given as its velocity, else at rest.
    /// The derivatives remain those of the first step unless the master sets others.
    pub fn start(&self, time: f64) -> Start {
        let [u, w, load, pull, _] = &self.signals;
        Start {
            time,
            u: u.value,
            w: w.value,
            u_rate: u.rate.unwrap_or_default(),
            w_rate: w.rate.unwrap_or_default(),
            load: load.value,
            pull: pull.value,
            temperature: self.temperature(),
        }
    }

    /// The motion over a step of `h` (s) from `time` (s): straight from û = `u` and ŵ = `w` (m) to their targets. Rounding
    /// does not accumulate, since the next motion starts from where this one ended. Forces start from the values given.
    ///
    /// # Errors
    /// [`InputOutOfRange`].
    pub fn motion(
        &self,
        (u, w): (f64, f64),
        time: f64,
        h: f64,
        rule: Extrapolation,
    ) -> Result<Motion, InputOutOfRange> {
        let path = |input: Input, from: f64| {
            let signal = &self.signals[input as usize];
            let target = signal.checked_target(input.name(), time, h, rule)?;
            let rate = signal.given_rate(from).unwrap_or((target - from) / h);
            Ok::<_, InputOutOfRange>(Path { rate, ..Path::default() })
        };
        let force = |input: Input| {
            let signal = &self.signals[input as usize];
            let target = signal.checked_target(input.name(), time, h, rule)?;
            let rate = signal.rate.unwrap_or((target - signal.value) / h);
            Ok::<_, InputOutOfRange>(Force { start: Some(signal.value), change: Path { rate, ..Path::default() } })
        };
        Ok(Motion {
            duration: h,
            u: path(Input::U, u)?,
            w: path(Input::W, w)?,
            load: force(Input::Load)?,
            pull: force(Input::Pull)?,
            temperature: self.temperature(),
        })
    }

    /// Whether a run can have reached these inputs: the values of past steps are finite. Values and rates of the next step
    /// may be anything.
    pub(super) fn is_valid(&self) -> bool {
        self.signals.iter().all(Signal::is_valid)
    }

    /// Completes a step of `h`: its derivatives apply to no other.
    pub fn complete_step(&mut self, h: f64) {
        self.signals.iter_mut().for_each(|signal| signal.complete_step(h));
    }
}

/// Displacements whose relative difference is smaller are equal but for rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl Signal {
    pub(super) fn value(&self) -> f64 {
        self.value
    }

    pub(super) fn set(&mut self, value: f64) {
        self.value = value;
    }

    /// The first derivative, if the master gave it for the next step.
    pub(super) fn rate(&self) -> Option<f64> {
        self.rate
    }

    pub(super) fn set_rate(&mut self, rate: f64) {
        self.rate = Some(rate);
    }

    /// Completes a step of `h` (s).
    pub(super) fn complete_step(&mut self, h: f64) {
        self.rate = None;
        self.past = Some(Past { value: self.value, step: h });
    }

    /// Whether the values of the past step are finite.
    pub(super) fn is_valid(&self) -> bool {
        self.past.is_none_or(|past| is_possible(past.value) && is_possible(past.step) && past.step > 0.0)
    }

    /// The rate that the master gave, if û = `current` equals its value but for rounding. It is then used as it is: if it
    /// were computed from the difference to the target, that rounding over h would be a kink at every communication point
    /// of a steady motion.
    pub(super) fn given_rate(&self, current: f64) -> Option<f64> {
        let same = (current - self.value).abs() <= ROUNDING * current.abs().max(self.value.abs());
        self.rate.filter(|_| same)
    }

    /// û, or the force, at the end of a step of `h`.
    fn target(&self, h: f64, rule: Extrapolation) -> f64 {
        match (self.rate, rule, self.past) {
            (Some(rate), _, _) => self.value + h * rate,
            // At rest it stays exactly where it is, whatever the ratio of the steps.
            (None, Extrapolation::Linear, Some(past)) if past.value != self.value => {
                self.value + (self.value - past.value) * (h / past.step)
            }
            (None, Extrapolation::Linear | Extrapolation::Hold, _) => self.value,
        }
    }

    /// [`target`](Self::target), checked to be in range.
    pub(super) fn checked_target(
        &self,
        name: &'static str,
        time: f64,
        h: f64,
        rule: Extrapolation,
    ) -> Result<f64, InputOutOfRange> {
        let target = self.target(h, rule);
        match [self.value, target].into_iter().find(|value| !is_possible(*value)) {
            Some(value) => Err(InputOutOfRange { name, value, time }),
            None => Ok(target),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn at(value: f64) -> Inputs {
        let mut inputs = Inputs::default();
        inputs.set_input(Input::U, value);
        inputs
    }

    /// Does a step from û = ŵ = 0 and returns where it ends.
    fn step(inputs: &mut Inputs, h: f64, rule: Extrapolation) -> [f64; 2] {
        let motion = inputs.motion((0.0, 0.0), 0.0, h, rule).unwrap();
        inputs.complete_step(h);
        [motion.u.rate * h, motion.w.rate * h]
    }

    #[test]
    fn the_first_step_without_rates_goes_to_the_value_given() {
        assert_eq!(step(&mut at(3.0), 0.5, Extrapolation::Linear), [3.0, 0.0]);
    }

    #[test]
    fn linear_extrapolation_follows_a_steady_motion_from_the_second_step_on() {
        let mut inputs = at(0.0);
        step(&mut inputs, 1.0, Extrapolation::Linear);
        for (value, h, target) in [(2.0, 0.5, 3.0), (3.0, 0.5, 4.0), (4.0, 0.25, 4.5)] {
            inputs.set_input(Input::U, value);
            assert_eq!(step(&mut inputs, h, Extrapolation::Linear), [target, 0.0]);
        }
    }

    /// From the value given, by its derivative, by the values before, or held.
    #[test]
    fn a_force_starts_from_its_value_and_may_jump() {
        let force = |inputs: &Inputs, rule| {
            let load = inputs.motion((0.0, 0.0), 0.0, 0.5, rule).unwrap().load;
            (load.start, load.change.rate)
        };
        let mut inputs = Inputs::default();
        inputs.set_input(Input::Load, 3.0);
        assert_eq!(force(&inputs, Extrapolation::Linear), (Some(3.0), 0.0));
        inputs.complete_step(0.25);
        inputs.set_input(Input::Load, 5.0);
        assert_eq!(force(&inputs, Extrapolation::Linear), (Some(5.0), 8.0));
        assert_eq!(force(&inputs, Extrapolation::Hold), (Some(5.0), 0.0));
        inputs.set_rate(Input::Load, -1.0);
        assert_eq!(force(&inputs, Extrapolation::Hold), (Some(5.0), -1.0));
    }

    #[test]
    fn hold_lags_by_one_step_and_never_overshoots() {
        let mut inputs = at(0.0);
        for value in [1.0, 2.0, 2.0] {
            inputs.set_input(Input::U, value);
            assert_eq!(step(&mut inputs, 1.0, Extrapolation::Hold), [value, 0.0]);
        }
    }

    #[test]
    fn a_rate_counts_for_one_step_and_its_own_input() {
        let mut inputs = at(0.0);
        inputs.set_rate(Input::U, 2.0);
        assert_eq!(step(&mut inputs, 0.5, Extrapolation::Linear), [1.0, 0.0]);
        inputs.set_input(Input::U, 1.0);
        // 1 + (1 - 0)·0.25/0.5
        assert_eq!(step(&mut inputs, 0.25, Extrapolation::Linear), [1.5, 0.0]);
    }

    #[test]
    fn rates_before_the_start_are_the_starting_velocity_and_those_of_the_first_step() {
        let mut inputs = Inputs::default();
        inputs.set_rate(Input::W, -0.5);
        assert_eq!(inputs.start(2.0), Start { time: 2.0, w_rate: -0.5, ..Start::default() });
        assert_eq!(step(&mut inputs, 0.5, Extrapolation::Linear), [0.0, -0.25]);
        assert_eq!(step(&mut inputs, 0.5, Extrapolation::Hold), [0.0, 0.0]);
    }

    #[test]
    fn the_carrier_moves_straight_from_its_position() {
        let motion = at(3.0).motion((1.0, 0.5), 0.0, 0.25, Extrapolation::Hold).unwrap();
        assert_eq!((motion.duration, motion.u.rate, motion.w.rate), (0.25, 8.0, -2.0));
    }

    /// A carrier at 1e6 m, where the last digit is 1e-10 m: what its rounding would be over 1e-6 s is far from the
    /// rate.
    #[test]
    fn a_rate_given_at_the_carriers_position_is_used_as_it_is() {
        let rate = |current: f64| {
            let mut inputs = at(1e6 + 0.1);
            inputs.set_rate(Input::U, 0.3);
            inputs.motion((current, 0.0), 0.0, 1e-6, Extrapolation::Linear).unwrap().u.rate
        };
        let value: f64 = 1e6 + 0.1;
        for current in [value, value.next_up(), value.next_down()] {
            assert_eq!(rate(current), 0.3);
        }
        // A micrometre is no rounding: û goes where the target is.
        assert!((rate(value - 1e-6) - 1.3).abs() < 1e-3);
        assert!((rate(value + 1e-6) + 0.7).abs() < 1e-3);
    }

    #[test]
    fn values_and_rates_that_are_not_finite_stop_the_step() {
        let mut inputs = at(f64::NAN);
        assert!(inputs.motion((0.0, 0.0), 0.0, 1.0, Extrapolation::Linear).is_err());
        inputs.set_input(Input::U, 0.0);
        inputs.set_rate(Input::U, f64::INFINITY);
        let fault = inputs.motion((0.0, 0.0), 0.0, 1.0, Extrapolation::Linear).unwrap_err();
        assert_eq!(fault.to_string(), "the input u is inf at t = 0 s, which is out of range; the step was not done");
    }
}
