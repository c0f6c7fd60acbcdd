//! Numbers for a fuzzer: often extreme ones, and often ones that a run can continue with.

use arbitrary::Arbitrary;

/// A number in a few bytes.
#[derive(Clone, Copy, Debug, Arbitrary)]
pub enum Number {
    /// One of [`STRANGE`].
    Strange(u8),
    /// In tenths of a micrometre: a displacement of the size of the scenes' profiles.
    Small(i8),
    /// mantissa · 10^exponent
    Decimal(i8, i8),
    /// Any bits.
    Any(f64),
}

const STRANGE: [f64; 24] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN,
    f64::MIN_POSITIVE,
    f64::EPSILON,
    5e-324,
    -5e-324,
    1e300,
    -1e300,
    1e-300,
    1e154,
    1e-154,
    1e30,
    -1e30,
    1e-30,
    1e15,
    -1e15,
    1e-15,
];

impl Number {
    pub fn value(self) -> f64 {
        match self {
            Self::Strange(i) => STRANGE[usize::from(i) % STRANGE.len()],
            Self::Small(tenths) => f64::from(tenths) * 1e-7,
            Self::Decimal(mantissa, exponent) => f64::from(mantissa) * 10_f64.powi(exponent.into()),
            Self::Any(number) => number,
        }
    }
}
