//! What is done to measured heights: gaps filled, tilt removed.

use super::{Line, Raw};
use crate::scene::Surface;

/// Puts points without a height on the straight line between their neighbours, and leaves those at the ends out.
pub(super) fn fill(raw: &mut Raw) {
    let is_there = |z: &f64| !z.is_nan();
    let first = raw.z.iter().position(is_there).unwrap_or(raw.z.len());
    let end = raw.z.iter().rposition(is_there).map_or(first, |last| last + 1);
    raw.x = raw.x[first..end].to_vec();
    raw.z = raw.z[first..end].to_vec();
    if !raw.lines.is_empty() {
        raw.lines = raw.lines[first..end].to_vec();
    }
    let mut before = 0;
    for i in 0..raw.z.len() {
        if raw.z[i].is_nan() {
            continue;
        }
        bridge(&raw.x, &mut raw.z, before, i);
        before = i;
    }
}

/// The straight line from point `from` to point `to`, for the points between them.
fn bridge(x: &[f64], z: &mut [f64], from: usize, to: usize) {
    for i in from + 1..to {
        let share = (x[i] - x[from]) / (x[to] - x[from]);
        z[i] = z[from] + share * (z[to] - z[from]);
    }
}

/// Subtracts the least squares line.
pub(super) fn remove_tilt(x: &[f64], z: &mut [f64]) {
    let line = Line::through(x, z);
    z.iter_mut().zip(x).for_each(|(z, x)| *z = (*z - line.z) - line.slope * (x - line.x));
}

impl Line {
    /// The line through points; about their means, so that it is exact wherever they lie.
    fn through(x: &[f64], z: &[f64]) -> Self {
        let step = |i: usize| x[i + 1] - x[i];
        let weight = |i: usize| if i == 0 { 0.0 } else { step(i - 1) } + if i + 1 < x.len() { step(i) } else { 0.0 };
        let sum = |term: &dyn Fn(usize) -> f64| (0..x.len()).map(|i| weight(i) * term(i)).sum::<f64>();
        let whole = sum(&|_| 1.0);
        let (x_mean, z_mean) = (sum(&|i| x[i]) / whole, sum(&|i| z[i]) / whole);
        let covariance = sum(&|i| (x[i] - x_mean) * (z[i] - z_mean));
        let variance = sum(&|i| (x[i] - x_mean) * (x[i] - x_mean));
        Self { x: x_mean, z: z_mean, slope: covariance / variance }
    }

    /// The line's height at `x`, m.
    pub fn at(&self, x: f64) -> f64 {
        self.z + self.slope * (x - self.x)
    }
}

impl Surface {
    /// The least squares line through the profile's data points.
    pub fn line(&self) -> Line {
        Line::through(&self.x, &self.z)
    }
}
