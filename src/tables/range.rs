//! Ranges of numbers that columns and keys may hold.

use std::fmt;

/// The largest size of a number in SI units that a scene, a carrier or a master may give: m, s, N/m or any other.
///
/// Beyond all physics, and still so small that no product of the model overflows: c e², m κ ẋ² and the like have a
/// handful of factors, and 1e30 to the tenth power is a number.
pub const LARGEST: f64 = 1e30;

/// The smallest size of a number that is divided by, or whose square must not be rounded to 0.
pub const SMALLEST: f64 = 1e-30;

/// Numbers whose size lies between two bounds, both included; 0 and negative numbers where they are allowed.
#[derive(Clone, Copy, Debug)]
pub struct NumberRange {
    smallest: f64,
    largest: f64,
    zero: bool,
    negative: bool,
}

/// From [`SMALLEST`] to [`LARGEST`].
pub const POSITIVE: NumberRange = NumberRange { smallest: SMALLEST, largest: LARGEST, zero: false, negative: false };
/// 0, and from [`SMALLEST`] to [`LARGEST`].
pub const NOT_NEGATIVE: NumberRange = NumberRange { zero: true, ..POSITIVE };
/// Up to [`LARGEST`] in size.
pub const ANY: NumberRange = NumberRange { smallest: 0.0, negative: true, ..NOT_NEGATIVE };
/// All numbers that are finite.
pub const FINITE: NumberRange = ANY.up_to(f64::MAX);
/// All above 0 that are finite.
pub const ABOVE_ZERO: NumberRange = POSITIVE.down_to(0.0).up_to(f64::MAX);

impl NumberRange {
    /// These numbers up to another bound.
    pub const fn up_to(self, largest: f64) -> Self {
        Self { largest, ..self }
    }

    /// These numbers, and smaller ones down to another bound.
    pub const fn down_to(self, smallest: f64) -> Self {
        Self { smallest, ..self }
    }

    /// Whether `number` is one of them.
    pub fn holds(&self, number: f64) -> bool {
        let size = number.abs();
        let in_range = self.smallest <= size && size <= self.largest && (self.negative || number > 0.0);
        in_range || (self.zero && number == 0.0)
    }
}

impl fmt::Display for NumberRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.largest == f64::MAX, self.negative) {
            (true, true) => return f.write_str("a number"),
            (true, false) => return f.write_str("a number above 0"),
            (false, _) => (),
        }
        let low = if self.negative { -self.largest } else { self.smallest };
        let zero = if self.zero && !self.negative { "0 or " } else { "" };
        write!(f, "{zero}a number from {low:?} to {:?}", self.largest)
    }
}
