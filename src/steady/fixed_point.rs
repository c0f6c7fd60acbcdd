//! Fixed points of maps that are nearly contractions.

use crate::math::dot;

/// How many steps Anderson's method remembers.
const MEMORY: usize = 6;
/// The part of the last residual that is taken over: less damps.
const DAMPING: f64 = 0.7;
/// A pivot of the normal equations that is this part of its diagonal is a rounding.
const ROUNDING: f64 = 1.0e-12;

/// Anderson's acceleration (D. G. Anderson, J. ACM 12, 1965) of x → g(x): the next x is that of the smallest residual in
/// the plane through the last ones.
#[derive(Debug)]
pub(super) struct Anderson {
    x: Vec<f64>,
    residual: Vec<f64>,
    /// Differences of x and of the residual from one step to the next, the last in a ring.
    changes: Vec<[Vec<f64>; 2]>,
    steps: usize,
}

impl Anderson {
    pub(super) fn new(length: usize) -> Self {
        Self { x: vec![0.0; length], residual: vec![0.0; length], changes: Vec::with_capacity(MEMORY), steps: 0 }
    }

    /// Replaces `x`, whose image is `image`, by the next.
    pub(super) fn advance(&mut self, x: &mut [f64], image: &[f64]) {
        let residual = |i: usize, x: &[f64]| image[i] - x[i];
        if self.steps > 0 {
            let slot = (self.steps - 1) % MEMORY;
            if self.changes.len() == slot {
                self.changes.push([vec![0.0; x.len()], vec![0.0; x.len()]]);
            }
            let [by_x, by_residual] = &mut self.changes[slot];
            for i in 0..x.len() {
                by_x[i] = x[i] - self.x[i];
                by_residual[i] = residual(i, x) - self.residual[i];
            }
        }
        self.x.copy_from_slice(x);
        (0..x.len()).for_each(|i| self.residual[i] = residual(i, x));
        let weights = self.weights();
        for i in 0..x.len() {
            x[i] += DAMPING * self.residual[i];
        }
        for ([by_x, by_residual], weight) in self.changes.iter().zip(&weights) {
            for i in 0..x.len() {
                x[i] -= weight * (by_x[i] + DAMPING * by_residual[i]);
            }
        }
        self.steps += 1;
    }

    /// The least squares of the residual over its changes, by normal equations and Cholesky's factors.
    fn weights(&self) -> [f64; MEMORY] {
        let count = self.changes.len();
        let (mut matrix, mut weights) = ([[0.0; MEMORY]; MEMORY], [0.0; MEMORY]);
        for i in 0..count {
            weights[i] = dot(&self.changes[i][1], &self.residual);
            for j in 0..=i {
                matrix[i][j] = dot(&self.changes[i][1], &self.changes[j][1]);
            }
        }
        // L Lᵀ; what is a combination of the others takes no part.
        let mut used = [false; MEMORY];
        for i in 0..count {
            for j in 0..i {
                let known: f64 = (0..j).map(|k| matrix[i][k] * matrix[j][k]).sum();
                matrix[i][j] = if used[j] { (matrix[i][j] - known) / matrix[j][j] } else { 0.0 };
            }
            let pivot = matrix[i][i] - (0..i).map(|k| matrix[i][k] * matrix[i][k]).sum::<f64>();
            used[i] = pivot > ROUNDING * matrix[i][i];
            matrix[i][i] = if used[i] { pivot.sqrt() } else { 1.0 };
        }
        for i in 0..count {
            let known: f64 = (0..i).map(|k| matrix[i][k] * weights[k]).sum();
            weights[i] = if used[i] { (weights[i] - known) / matrix[i][i] } else { 0.0 };
        }
        for i in (0..count).rev() {
            let known: f64 = (i + 1..count).map(|k| matrix[k][i] * weights[k]).sum();
            weights[i] = if used[i] { (weights[i] - known) / matrix[i][i] } else { 0.0 };
        }
        weights
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_linear_map_is_at_its_fixed_point_in_as_many_steps_as_it_has_rates() {
        let rates = [0.9, 0.5, -0.8, 0.99];
        let (mut x, mut anderson) = ([0.0; 4], Anderson::new(4));
        for _ in 0..7 {
            let image = [0, 1, 2, 3].map(|i| rates[i] * x[i] + 1.0);
            anderson.advance(&mut x, &image);
        }
        for (x, rate) in x.iter().zip(&rates) {
            // Normal equations have half of the digits.
            assert!((x * (1.0 - rate) - 1.0).abs() < 1e-6, "{x} {rate}");
        }
    }
}
