//! Sobol' points, scrambled by a seed after A. B. Owen: sample i is the same whatever the count, the thread, the scene.

use std::f64::consts::{SQRT_2, TAU};

use asperity::math::SplitMix64;
use sobol_burley::{NUM_DIMENSIONS, sample};

use crate::error::Error;

/// How many samples are drawn, and which.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleOptions {
    /// The number of samples.
    pub count: usize,
    /// What scrambles the points.
    pub seed: u64,
}

/// What the points are there for.
pub(super) const MOST_SAMPLES: usize = 1 << 16;
pub(super) const MOST_DIMENSIONS: usize = NUM_DIMENSIONS as usize;

/// Points in the unit cube, whose axes have names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sampler {
    /// Rising.
    names: Vec<String>,
    options: SampleOptions,
}

impl Sampler {
    /// The points with axes of these names, each of which counts once, in whatever order.
    ///
    /// # Errors
    /// Where these are too many, or too many points or too few are asked for.
    pub fn new(mut names: Vec<String>, options: SampleOptions) -> Result<Self, Error> {
        names.sort();
        names.dedup();
        if !(2..=MOST_SAMPLES).contains(&options.count) {
            let expected = format!("a number from 2 to {MOST_SAMPLES}");
            return Err(Error::scene(format!("`samples`: expected {expected}, found {}", options.count)));
        }
        if names.len() > MOST_DIMENSIONS {
            return Err(Error::scene(format!(
                "[uncertainty] has {} dimensions, expected up to {MOST_DIMENSIONS}: leave keys out, or give the whole \
                 spectrum one factor",
                names.len()
            )));
        }
        Ok(Self { names, options })
    }

    /// How many samples there are, and which.
    pub fn options(&self) -> SampleOptions {
        self.options
    }

    /// A number above 0 and below 1: of a sample, drawn for the `attempt`th time (from 0), along an axis; the middle along
    /// one that there is not.
    pub fn unit(&self, index: usize, attempt: u32, axis: &str) -> f64 {
        /// Half of the distance of the numbers of a point.
        const HALF: f64 = 1.0 / (1_u64 << 25) as f64;
        let Ok(dimension) = self.names.binary_search_by(|name| name.as_str().cmp(axis)) else { return 0.5 };
        let seed = (self.of_attempt(attempt) >> 32) as u32;
        f64::from(sample((index % MOST_SAMPLES) as u32, dimension as u32, seed)) + HALF
    }

    /// The number as that of a standard normal distribution.
    pub fn normal(&self, index: usize, attempt: u32, axis: &str) -> f64 {
        inverse_normal(self.unit(index, attempt, axis))
    }

    /// The seed of a surface.
    pub fn surface_seed(&self, index: usize, attempt: u32) -> u32 {
        (SplitMix64::at(self.of_attempt(attempt), index as u64).next() >> 32) as u32
    }

    /// The seed of the points that are drawn for the `attempt`th time.
    fn of_attempt(&self, attempt: u32) -> u64 {
        SplitMix64::at(self.options.seed, u64::from(attempt)).next()
    }
}

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

    fn sampler(names: &[&str], count: usize, seed: u64) -> Sampler {
        Sampler::new(names.iter().map(|name| name.to_string()).collect(), SampleOptions { count, seed }).unwrap()
    }

    /// In every part of every axis, and in every box of two, as many points as its size says.
    #[test]
    fn points_fill_the_cube() {
        let points = sampler(&["a", "b", "c"], 64, 1);
        for (first, other) in [("a", "b"), ("b", "c"), ("a", "c")] {
            let mut boxes = [[0; 4]; 4];
            for i in 0..64 {
                let at = |axis: &str| (4.0 * points.unit(i, 0, axis)) as usize;
                boxes[at(first)][at(other)] += 1;
            }
            // The first axes of Sobol' are a net of quality 0 or 1.
            assert!(boxes.iter().flatten().all(|count| (2..=6).contains(count)), "{boxes:?}");
            let mut parts = [0; 64];
            (0..64).for_each(|i| parts[(64.0 * points.unit(i, 0, first)) as usize] += 1);
            assert_eq!(parts, [1; 64]);
        }
    }

    #[test]
    fn a_point_depends_on_its_number_its_axis_and_the_seed_alone() {
        let (few, many) = (sampler(&["b", "a", "b"], 64, 7), sampler(&["a", "b"], 1024, 7));
        for i in 0..64 {
            assert_eq!(few.unit(i, 0, "b"), many.unit(i, 0, "b"));
        }
        let other = sampler(&["a", "b"], 64, 8);
        assert!((0..64).all(|i| few.unit(i, 0, "a") != other.unit(i, 0, "a")));
        assert!((0..64).all(|i| few.unit(i, 0, "a") != few.unit(i, 1, "a")));
        assert_ne!(few.surface_seed(3, 0), few.surface_seed(4, 0));
    }

    #[test]
    fn what_the_points_cannot_do_is_refused() {
        let new = |names: usize, count| {
            Sampler::new((0..names).map(|i| i.to_string()).collect(), SampleOptions { count, seed: 1 }).map(|_| ())
        };
        assert!(new(256, 1 << 16).is_ok());
        for (names, count) in [(257, 64), (1, 1), (1, (1 << 16) + 1)] {
            assert!(new(names, count).is_err());
        }
    }

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
