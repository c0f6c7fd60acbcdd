//! Sobol' points, scrambled by a seed after A. B. Owen: sample i is the same whatever the count, the thread, the scene.

use asperity::math::SplitMix64;
use sobol_burley::{NUM_DIMENSIONS, sample};

use super::error::UncertaintyError;
use super::normal::inverse_normal;

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
    pub fn new(mut names: Vec<String>, options: SampleOptions) -> Result<Self, UncertaintyError> {
        names.sort();
        names.dedup();
        if !(2..=MOST_SAMPLES).contains(&options.count) {
            return Err(UncertaintyError::Count { most: MOST_SAMPLES, found: options.count });
        }
        if names.len() > MOST_DIMENSIONS {
            return Err(UncertaintyError::Dimensions { most: MOST_DIMENSIONS, found: names.len() });
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

#[cfg(test)]
mod tests {
    use super::*;

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
        assert!(matches!(new(257, 64), Err(UncertaintyError::Dimensions { found: 257, .. })));
        assert!(matches!(new(1, 1), Err(UncertaintyError::Count { found: 1, .. })));
        assert!(matches!(new(1, (1 << 16) + 1), Err(UncertaintyError::Count { .. })));
    }
}
