//! When the means of a run are steady: judged by its blocks.
//!
//! The run is cut into blocks of equal length, and the mean of a quantity over each is all that is looked at. The latter half of the
//! blocks, at least [`FEWEST`], is the window; what comes before is left to the transient. The window is steady where
//!
//! - its mean is known: the standard error is at most the tolerance. Blocks that follow each other may be alike, which would make a
//!   mean seem better known than it is; so neighbours are joined in pairs, and pairs again, as long as [`FEWEST_JOINED`] are left,
//!   and the largest standard error of all these is taken (Flyvbjerg and Petersen, J. Chem. Phys. 91, 1989);
//! - it has no trend: the change along the straight line of least squares from the first block to the last is at most the
//!   tolerance, or no more than twice what scatter alone would make of it.
//!
//! On a periodic profile a block is a whole number of periods: the means of a layer in steady motion are then the same in all of
//! them, and [`FEWEST`] blocks do.

/// The fewest blocks of a window.
pub(super) const FEWEST: usize = 3;
/// The fewest blocks, joined ones, whose scatter says anything of the mean of many.
const FEWEST_JOINED: usize = 8;

/// What the blocks of a window say of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    /// The mean.
    pub(super) mean: f64,
    /// Its standard error.
    pub(super) error: f64,
    /// The change from the first block to the last.
    pub(super) trend: f64,
    /// The standard error of that.
    trend_error: f64,
}

/// The first block of the window of `count` blocks.
pub(super) fn window(count: usize) -> usize {
    count - count.div_ceil(2).max(FEWEST).min(count)
}

impl Window {
    /// What the blocks of a window, at least two, say.
    pub(super) fn new(blocks: &[f64]) -> Self {
        let mean = mean(blocks);
        let (trend, trend_error) = trend(blocks, mean);
        Self { mean, error: standard_error(blocks), trend, trend_error }
    }

    /// Whether the mean is known to `tolerance` and has no trend.
    pub(super) fn is_steady(&self, tolerance: f64) -> bool {
        self.error <= tolerance && self.trend.abs() <= tolerance.max(2.0 * self.trend_error)
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The largest standard error of the mean that blocks joined in pairs, pairs of pairs and so on make likely.
fn standard_error(blocks: &[f64]) -> f64 {
    let mut joined = blocks.to_vec();
    let mut error = error_of_mean(&joined);
    while joined.len() / 2 >= FEWEST_JOINED {
        joined = joined.chunks_exact(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        error = error.max(error_of_mean(&joined));
    }
    error
}

/// s/√n of blocks that know nothing of each other.
fn error_of_mean(blocks: &[f64]) -> f64 {
    let n = blocks.len() as f64;
    let mean = mean(blocks);
    let squares: f64 = blocks.iter().map(|block| (block - mean).powi(2)).sum();
    (squares / (n * (n - 1.0).max(1.0))).sqrt()
}

/// The change along the line of least squares and its standard error from the scatter about the line.
fn trend(blocks: &[f64], mean: f64) -> (f64, f64) {
    let n = blocks.len() as f64;
    let place = |i: usize| i as f64 - 0.5 * (n - 1.0);
    let places = n * (n * n - 1.0) / 12.0;
    let slope = blocks.iter().enumerate().map(|(i, block)| place(i) * (block - mean)).sum::<f64>() / places;
    let rest = |(i, block): (usize, &f64)| (block - mean - slope * place(i)).powi(2);
    let scatter: f64 = blocks.iter().enumerate().map(rest).sum();
    let variance = scatter / (n - 2.0).max(1.0) / places;
    ((n - 1.0) * slope, (n - 1.0) * variance.sqrt())
}
