//! The inverse of the normal distribution.

use std::f64::consts::{SQRT_2, TAU};

/// The number below which a standard normal one is with this probability, from 0 to 1: to rounding.
///
/// P. J. Acklam's rational approximation (2003), of a relative error of 1.2e-9, and one step of Halley's method.
pub fn inverse_normal(probability: f64) -> f64 {
    if probability > 0.5 {
        // The lower tail has all digits.
        return -inverse_normal(1.0 - probability);
    }
    let x = acklam(probability);
    if !x.is_finite() {
        return x;
    }
    let error = 0.5 * libm::erfc(-x / SQRT_2) - probability;
    let step = error * TAU.sqrt() * (0.5 * x * x).exp();
    x - step / (1.0 + 0.5 * x * step)
}

/// Below this probability another approximation is used.
const TAIL: f64 = 0.02425;
const A: [f64; 6] = [
    -3.969_683_028_665_376e1,
    2.209_460_984_245_205e2,
    -2.759_285_104_469_687e2,
    1.383_577_518_672_69e2,
    -3.066_479_806_614_716e1,
    2.506_628_277_459_239,
];
const B: [f64; 6] = [
    -5.447_609_879_822_406e1,
    1.615_858_368_580_409e2,
    -1.556_989_798_598_866e2,
    6.680_131_188_771_972e1,
    -1.328_068_155_288_572e1,
    1.0,
];
const C: [f64; 6] = [
    -7.784_894_002_430_293e-3,
    -3.223_964_580_411_365e-1,
    -2.400_758_277_161_838,
    -2.549_732_539_343_734,
    4.374_664_141_464_968,
    2.938_163_982_698_783,
];
const D: [f64; 5] =
    [7.784_695_709_041_462e-3, 3.224_671_290_700_398e-1, 2.445_134_137_142_996, 3.754_408_661_907_416, 1.0];

/// For probabilities up to a half.
fn acklam(probability: f64) -> f64 {
    let polynomial = |coefficients: &[f64], x: f64| coefficients.iter().fold(0.0, |sum, c| sum * x + c);
    if probability < TAIL {
        let q = (-2.0 * probability.ln()).sqrt();
        return polynomial(&C, q) / polynomial(&D, q);
    }
    let q = probability - 0.5;
    polynomial(&A, q * q) * q / polynomial(&B, q * q)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::in_tests::assert_within;

    /// Quantiles from tables with 16 digits.
    #[test]
    fn quantiles_are_those_of_tables() {
        for (probability, x) in [
            (0.5, 0.0),
            (0.75, 0.674_489_750_196_081_7),
            (0.95, 1.644_853_626_951_472_7),
            (0.975, 1.959_963_984_540_054),
            (0.01, -2.326_347_874_040_841),
            (1e-8, -5.612_001_244_174_789),
        ] {
            assert_within(inverse_normal(probability), x, 1e-14 * x.abs().max(1.0));
        }
    }

    #[test]
    fn it_is_the_inverse_everywhere() {
        for i in -60..=60 {
            let x = 0.1 * f64::from(i);
            let lower = -x.abs();
            let probability = 0.5 * libm::erfc(-lower / SQRT_2);
            assert_within(inverse_normal(probability), lower, 1e-14 * lower.abs().max(1.0));
        }
    }
}
