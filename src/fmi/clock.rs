//! The FMU's time and what a master may ask of it.

use serde::{Deserialize, Serialize};

use crate::scene::{SMALLEST, is_possible};

use super::fault::Fault;

/// Times that differ by less than this part of the larger of time and step size differ by rounding.
const ROUNDING: f64 = 1e-10;

/// Where the FMU stands in time and how far it may go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Clock {
    /// The time reached, s: the last communication point.
    pub(super) time: f64,
    /// The stop time, s, if the master defined one.
    stop: Option<f64>,
}

impl Clock {
    /// A clock that stands at `start`.
    ///
    /// # Errors
    /// [`Fault`] where a time is no number or larger than [`LARGEST`](crate::scene::LARGEST), or the stop time lies
    /// before the start.
    pub(super) fn new(start: f64, stop: Option<f64>) -> Result<Self, Fault> {
        let check = |what, value| if is_possible(value) { Ok(()) } else { Err(Fault::OutOfRange { what, value }) };
        check("the start time", start)?;
        if let Some(stop) = stop {
            check("the stop time", stop)?;
            if stop < start {
                return Err(Fault::StopBeforeStart { start, stop });
            }
        }
        Ok(Self { time: start, stop })
    }

    /// Whether its times are numbers.
    pub(super) fn is_sound(&self) -> bool {
        is_possible(self.time) && self.stop.is_none_or(is_possible)
    }

    /// The clock after a step of `h` from `point`; `None` where the step is too short to change the time.
    ///
    /// # Errors
    /// [`Fault`] where the step size is no step size, the point is another one than the clock's, or the step goes
    /// beyond the stop time. Differences by rounding are none.
    pub(super) fn step(&self, point: f64, h: f64) -> Result<Option<Self>, Fault> {
        if !(is_possible(h) && h >= 0.0) {
            return Err(Fault::StepSize(h));
        }
        let slack = ROUNDING * self.time.abs().max(h);
        let difference = (point - self.time).abs();
        let changes = self.time + h != self.time;
        // A damper over such a step is no finite stiffness.
        if changes && h < SMALLEST {
            return Err(Fault::StepSize(h));
        }
        // Written so that a point that is not a number is refused.
        if !(difference <= slack && (difference < h / 2.0 || !changes)) {
            return Err(Fault::OtherPoint { given: point, own: self.time });
        }
        let end = point + h;
        match self.stop {
            Some(stop) if end > stop + slack => Err(Fault::BeyondStop { end, stop }),
            _ if !is_possible(end) => Err(Fault::OutOfRange { what: "the end of the step", value: end }),
            _ => Ok(changes.then_some(Self { time: end, ..*self })),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::scene::LARGEST;

    fn clock(time: f64) -> Clock {
        Clock::new(time, Some(10.0)).unwrap()
    }

    #[test]
    fn the_time_after_a_step_is_the_masters() {
        let point = 0.3 + f64::EPSILON;
        assert_eq!(clock(0.3).step(point, 0.1).unwrap().unwrap().time, point + 0.1);
    }

    #[test]
    fn a_step_that_does_not_change_the_time_is_none() {
        assert_eq!(clock(1.0).step(1.0, 0.0).unwrap(), None);
        assert_eq!(clock(1.0).step(1.0, 1e-30).unwrap(), None);
        assert!(clock(0.0).step(0.0, 1e-30).unwrap().is_some());
    }

    #[test]
    fn another_point_is_refused_and_named() {
        let fault = clock(1.0).step(1.1, 0.1).unwrap_err().to_string();
        assert!(fault.contains("1.1 s") && fault.contains("1 s"), "{fault}");
        assert!(clock(1.0).step(f64::NAN, 0.1).is_err());
        // Within 1e-10 of the time, but more than half of the step.
        assert!(clock(1.0).step(1.0 + 5e-11, 6e-11).is_err());
        assert!(clock(1.0).step(2.0, 0.0).is_err());
    }

    #[test]
    fn sizes_that_are_none_are_refused() {
        for h in [-1.0, f64::NAN, f64::INFINITY, 1e300, f64::MIN_POSITIVE] {
            assert!(matches!(clock(0.0).step(0.0, h), Err(Fault::StepSize(_))));
        }
    }

    #[test]
    fn the_stop_time_may_be_overshot_by_rounding_alone() {
        assert!(clock(9.9).step(9.9, 0.1 + 1e-12).is_ok());
        assert!(matches!(clock(9.9).step(9.9, 0.2), Err(Fault::BeyondStop { .. })));
        assert!(Clock::new(0.0, None).unwrap().step(0.0, 1e9).is_ok());
    }

    #[test]
    fn times_are_in_range_and_in_order() {
        assert!(Clock::new(f64::NAN, None).is_err());
        assert!(Clock::new(0.0, Some(f64::INFINITY)).is_err());
        assert!(Clock::new(1e300, None).is_err());
        let clock = Clock::new(LARGEST, None).unwrap();
        assert!(matches!(clock.step(LARGEST, LARGEST), Err(Fault::OutOfRange { .. })));
        assert!(Clock::new(1.0, Some(0.0)).is_err());
        assert!(Clock::new(-5.0, Some(-5.0)).is_ok());
    }
}
