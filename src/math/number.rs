//! Numbers that a formula can be evaluated with: plain ones, and ones that carry their derivatives along.
//!
//! Code that is generic over [`Number`] gives with [`Dual`] the exact derivatives of what it computes with `f64`, in
//! the same order of operations: values are the same to the last bit. It compares values alone, so that both take the
//! same branches.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number with the operations that formulas need.
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A number without derivatives.
    fn constant(value: f64) -> Self;
    /// The number itself.
    fn value(self) -> f64;
    /// The square root of a number above 0.
    fn sqrt(self) -> Self;
    /// eˣ; x is limited to what has an exponential above 0 and below infinity.
    fn exp(self) -> Self;
    /// The natural logarithm of a normal number above 0.
    fn ln(self) -> Self;
    /// The sine and the cosine of an angle, rad.
    fn sin_cos(self) -> (Self, Self);

    /// `self` times a number without derivatives.
    #[inline(always)]
    fn times(self, factor: f64) -> Self {
        self * Self::constant(factor)
    }

    /// `self` where `condition`, else `other`.
    #[inline(always)]
    fn or(self, condition: bool, other: Self) -> Self {
        if condition { self } else { other }
    }

    /// The larger of both.
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.or(self.value() > other.value(), other)
    }

    /// The smaller of both.
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        self.or(self.value() < other.value(), other)
    }
}

impl Number for f64 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn exp(self) -> Self {
        exp(self)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        ln(self)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        self.sin_cos()
    }
}

/// A number and its derivatives with respect to `N` variables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize> {
    /// The number.
    pub value: f64,
    /// Its derivatives.
    pub slopes: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// The variable `i` at a value.
    pub fn variable(value: f64, i: usize) -> Self {
        let mut slopes = [0.0; N];
        slopes[i] = 1.0;
        Self { value, slopes }
    }

    /// f of the number, where f' there is `slope`.
    fn chain(self, value: f64, slope: f64) -> Self {
        Self { value, slopes: self.slopes.map(|d| d * slope) }
    }

    /// A function of two numbers, and its derivatives by the one and by the other.
    fn joined(self, other: Self, value: f64, (by_self, by_other): (f64, f64)) -> Self {
        Self { value, slopes: std::array::from_fn(|i| by_self * self.slopes[i] + by_other * other.slopes[i]) }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.joined(other, self.value + other.value, (1.0, 1.0))
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.joined(other, self.value - other.value, (1.0, -1.0))
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        self.joined(other, self.value * other.value, (other.value, self.value))
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let slope = |i: usize| slope_of_quotient(self.slopes[i], value, other.slopes[i], other.value);
        Self { value, slopes: std::array::from_fn(slope) }
    }
}

/// Divided last: 1 over a denominator that only keeps a quotient finite is infinite.
fn slope_of_quotient(above: f64, quotient: f64, below: f64, denominator: f64) -> f64 {
    (above - quotient * below) / denominator
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;

    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl<const N: usize> Number for Dual<N> {
    fn constant(value: f64) -> Self {
        Self { value, slopes: [0.0; N] }
    }

    fn value(self) -> f64 {
        self.value
    }

    /// Of 0 too, where formulas take the size of a vector that vanishes: without derivatives there.
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }

    fn exp(self) -> Self {
        let value = exp(self.value);
        self.chain(value, value)
    }

    fn ln(self) -> Self {
        self.chain(ln(self.value), 1.0 / self.value)
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }
}

/// Adding and subtracting it rounds a number of a size below 2⁵¹ to a whole one.
const ROUNDER: f64 = 6_755_399_441_055_744.0;
/// ln 2 in two parts, the first of few digits.
const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];
/// Exponents beyond have no normal number.
const MAX_EXPONENT: f64 = 708.0;
/// The exponent of a double that stands for 2⁰.
const BIAS: u64 = 1023;
const MANTISSA_BITS: u32 = 52;

/// eˣ to 1e-15 of it, of arithmetic alone, so that loops over it can be vectorised.
///
/// 2ᵏ times the series of the exponential of the rest, which lies within ln 2/2.
#[inline(always)]
#[allow(clippy::cast_possible_truncation, reason = "bits of a whole number below 2⁵¹")]
fn exp(x: f64) -> f64 {
    const FACTORIALS: [f64; 14] = [
        1.0 / 6_227_020_800.0,
        1.0 / 479_001_600.0,
        1.0 / 39_916_800.0,
        1.0 / 3_628_800.0,
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5_040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ];
    let x = x.clamp(-MAX_EXPONENT, MAX_EXPONENT);
    let shifted = x * std::f64::consts::LOG2_E + ROUNDER;
    let whole = shifted - ROUNDER;
    let rest = (x - whole * LN_2[0]) - whole * LN_2[1];
    let series = FACTORIALS.iter().skip(1).fold(FACTORIALS[0], |sum, term| sum * rest + term);
    series * f64::from_bits(shifted.to_bits().wrapping_add(BIAS) << MANTISSA_BITS)
}

/// ln x to 1e-15, of arithmetic alone: x = 2ᵏ m with m about 1, and the series of artanh for ln m.
#[inline(always)]
fn ln(x: f64) -> f64 {
    /// 2⁵², whose last bits hold a whole number that is added to it.
    const WHOLE: f64 = 4_503_599_627_370_496.0;
    const MANTISSA: u64 = (1 << MANTISSA_BITS) - 1;
    let bits = x.to_bits();
    let exponent = f64::from_bits((bits >> MANTISSA_BITS) | WHOLE.to_bits()) - WHOLE - BIAS as f64;
    let mantissa = f64::from_bits((bits & MANTISSA) | 1.0_f64.to_bits());
    let large = mantissa > std::f64::consts::SQRT_2;
    let (m, k) = if large { (0.5 * mantissa, exponent + 1.0) } else { (mantissa, exponent) };
    let s = (m - 1.0) / (m + 1.0);
    let z = s * s;
    let terms = [19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0_f64];
    let series = terms.iter().skip(1).fold(2.0 / terms[0], |sum, n| sum * z + 2.0 / n);
    k * LN_2[0] + (k * LN_2[1] + s * series)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponential_and_logarithm_are_those_of_the_library() {
        for i in -7000..=7000 {
            let x = 0.1 * f64::from(i);
            assert!((exp(x) / x.exp() - 1.0).abs() < 1e-15, "{x}");
            let y = x.exp();
            assert!((ln(y) - y.ln()).abs() <= 1e-15 * y.ln().abs().max(1.0), "{y}");
        }
        assert!(exp(1e4).is_finite() && exp(-1e4) > 0.0);
    }

    /// A formula with every operation, against difference quotients.
    #[test]
    fn duals_carry_derivatives() {
        fn f<T: Number>(x: T, y: T) -> T {
            let (sin, cos) = (x * y).sin_cos();
            (sin / (x + T::constant(3.0)) - cos.exp() * y.sqrt()).larger(x - T::constant(9.0)) + (-y).or(false, y.ln())
        }
        let (x, y, h) = (0.7, 1.3, 1e-5);
        let found = f(Dual::<2>::variable(x, 0), Dual::variable(y, 1));
        assert_eq!(found.value, f(x, y));
        let quotients = [f(x + h, y) - f(x - h, y), f(x, y + h) - f(x, y - h)].map(|d| d / (2.0 * h));
        for (slope, quotient) in found.slopes.iter().zip(quotients) {
            // h² times a third derivative, and rounding over h.
            assert!((slope - quotient).abs() < 1e-8, "{slope} {quotient}");
        }
        assert_eq!(Dual::<1>::variable(0.0, 0).sqrt().slopes, [0.0]);
    }
}
