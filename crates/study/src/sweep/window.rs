//! When the means of a run are steady: judged by its blocks.
//!
//! The run is divided into blocks of equal length, of which only the means of a quantity are used. The latter half of
//! the blocks, at least [`MIN_WINDOW`], is the window; those before are left to the transient. The window is steady
//! where
//!
//! - the standard error of its mean is at most the tolerance. Successive blocks may be correlated, which would make a
//!   mean seem better known than it is. So s/√n is multiplied by √((1+r)/(1-r)), r being the correlation of a block
//!   with the next; and neighbours are joined in pairs, and pairs again, as long as [`MIN_JOINED`] are left: the
//!   largest standard error of all these is taken (Flyvbjerg and Petersen, J. Chem. Phys. 91, 1989);
//! - it has no trend: the change along the straight line of least squares from the first block to the last is at most
//!   the tolerance, or no more than twice what scatter alone would make of it.
//!
//! On a periodic profile a block is a whole number of periods: in steady motion the means of all blocks are then the
//! same, and [`MIN_WINDOW`] blocks are enough.

/// The fewest blocks of a window.
pub(super) const MIN_WINDOW: usize = 3;
/// The fewest blocks, joined ones, whose scatter or correlation is used.
const MIN_JOINED: usize = 8;
/// The largest correlation of a block with the next that is used.
const CORRELATED: f64 = 0.95;

/// A quantity over the blocks of a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
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
    count - count.div_ceil(2).max(MIN_WINDOW).min(count)
}

impl Window {
    /// From the means of the blocks, at least two.
    pub(super) fn new(blocks: &[f64]) -> Self {
        let mean = mean(blocks);
        let (trend, trend_error) = trend(blocks, mean);
        Self { mean, error: standard_error(blocks), trend, trend_error }
    }

    /// Whether the mean is known to `tolerance` and has no trend.
    pub(super) fn is_steady(&self, tolerance: f64) -> bool {
        self.error <= tolerance && !self.has_trend(tolerance)
    }

    /// Whether the change from the first block to the last is above `tolerance` and twice what scatter makes of it.
    pub(super) fn has_trend(&self, tolerance: f64) -> bool {
        self.trend.abs() > tolerance.max(2.0 * self.trend_error)
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The largest standard error of the mean of the blocks, of pairs of them, of pairs of pairs and so on.
fn standard_error(blocks: &[f64]) -> f64 {
    let mut joined = blocks.to_vec();
    let r = correlation(blocks);
    let mut error = error_of_mean(&joined) * ((1.0 + r) / (1.0 - r)).sqrt();
    while joined.len() / 2 >= MIN_JOINED {
        joined = joined.chunks_exact(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        error = error.max(error_of_mean(&joined));
    }
    error
}

/// s/√n, the standard error of independent blocks.
fn error_of_mean(blocks: &[f64]) -> f64 {
    let n = blocks.len() as f64;
    let mean = mean(blocks);
    let squares: f64 = blocks.iter().map(|block| (block - mean).powi(2)).sum();
    (squares / (n * (n - 1.0).max(1.0))).sqrt()
}

/// Correlation of a block with the next, 0 where it is not distinct from scatter. Few blocks make it seem smaller than
/// it is, by (1 + 3r)/n.
fn correlation(blocks: &[f64]) -> f64 {
    let n = blocks.len() as f64;
    let mean = mean(blocks);
    let squares: f64 = blocks.iter().map(|block| (block - mean).powi(2)).sum();
    if blocks.len() < MIN_JOINED || squares <= 0.0 {
        return 0.0;
    }
    let products: f64 = blocks.windows(2).map(|pair| (pair[0] - mean) * (pair[1] - mean)).sum();
    let r = products / squares;
    let corrected = if r > n.sqrt().recip() { r + (1.0 + 3.0 * r) / n } else { r };
    corrected.clamp(0.0, CORRELATED)
}

/// The change along the line of least squares and its standard error from the scatter about the line.
fn trend(blocks: &[f64], mean: f64) -> (f64, f64) {
    let n = blocks.len() as f64;
    let position = |i: usize| i as f64 - 0.5 * (n - 1.0);
    let squares = n * (n * n - 1.0) / 12.0;
    let slope = blocks.iter().enumerate().map(|(i, block)| position(i) * (block - mean)).sum::<f64>() / squares;
    let rest = |(i, block): (usize, &f64)| (block - mean - slope * position(i)).powi(2);
    let scatter: f64 = blocks.iter().enumerate().map(rest).sum();
    let variance = scatter / (n - 2.0).max(1.0) / squares;
    ((n - 1.0) * slope, (n - 1.0) * variance.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Even numbers between 0 and 1 (Knuth's generator).
    fn even(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((*state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// A series x = φ x + ε with mean 0 and the variance of ε 1; and the true standard error of its mean.
    fn series(phi: f64, count: usize, state: &mut u64) -> (Vec<f64>, f64) {
        let mut normal = || (-2.0 * even(state).ln()).sqrt() * (std::f64::consts::TAU * even(state)).cos();
        let variance = 1.0 / (1.0 - phi * phi);
        let mut x = normal() * variance.sqrt();
        let blocks = (0..count).map(|_| {
            x = phi * x + normal();
            x
        });
        let blocks = blocks.collect();
        let n = count as f64;
        let lags: f64 = (1..count).map(|lag| (1.0 - lag as f64 / n) * phi.powi(lag as i32)).sum();
        (blocks, (variance / n * (1.0 + 2.0 * lags)).sqrt())
    }

    /// The standard error of correlated noise is right within a quarter on average, and the true mean lies within two
    /// of it nearly as often as it should (95 % where the error itself is known well).
    #[test]
    fn the_error_of_correlated_noise_is_right() {
        const SERIES: usize = 400;
        let mut state = 7;
        for (phi, count, least) in
            [(0.0, 16, 0.92), (0.0, 512, 0.94), (0.5, 64, 0.9), (0.5, 512, 0.93), (0.8, 64, 0.82), (0.8, 512, 0.92)]
        {
            let (mut sum, mut inside) = (0.0, 0);
            for _ in 0..SERIES {
                let (blocks, truth) = series(phi, count, &mut state);
                let window = Window::new(&blocks);
                sum += window.error / truth;
                inside += usize::from(window.mean.abs() <= 2.0 * window.error);
            }
            let (ratio, share) = (sum / SERIES as f64, inside as f64 / SERIES as f64);
            assert!((0.85..1.25).contains(&ratio), "φ = {phi}, {count} blocks: error over the true one {ratio}");
            assert!(share >= least, "φ = {phi}, {count} blocks: mean within two errors in {share}");
        }
    }

    #[test]
    fn a_trend_is_not_steady_and_what_follows_it_is() {
        let line: Vec<f64> = (0..10).map(|i| 1.0 + 0.01 * f64::from(i)).collect();
        let window = Window::new(&line);
        // The line rises by 0.09, and nothing scatters about it.
        assert!((window.trend - 0.09).abs() < 1e-12 && !window.is_steady(0.05) && window.is_steady(0.1));
        // A transient that dies away: steady once the window, the latter half, begins at the fifth block, e^(-8) <
        // 1e-3.
        let decay: Vec<f64> = (0..12).map(|i| 1.0 + (-2.0 * f64::from(i)).exp()).collect();
        let steady = |count: usize| Window::new(&decay[super::window(count)..count]).is_steady(1e-3);
        assert_eq!((3..=12).find(|&count| steady(count)), Some(8));
    }

    #[test]
    fn the_window_is_the_latter_half_and_at_least_three_blocks() {
        assert_eq!([2, 3, 4, 6, 7, 20].map(window), [0, 0, 1, 3, 3, 10]);
    }

    /// Whole periods of steady motion: all alike, and known at once.
    #[test]
    fn equal_blocks_are_steady() {
        let window = Window::new(&[0.3; MIN_WINDOW]);
        assert_eq!((window.mean, window.error, window.is_steady(1e-12)), (0.3, 0.0, true));
    }
}
