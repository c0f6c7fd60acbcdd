//! Block tridiagonal systems with 2×2 blocks, the shape that a chain of masses gives.

use nalgebra::{Matrix2, Vector2};

/// Lower_i δ_{i-1} + Diagonal_i δ_i + Upper_i δ_{i+1} = Right_i, i = 0 … n-1, with the workspace to solve it.
///
/// Blocks are eliminated from both ends towards the middle, and back: two chains of operations that do not wait for
/// each other. All that does not need the right sides is done once, by [`factor`](Self::factor).
#[derive(Clone, Debug, Default)]
pub struct BlockTridiagonal {
    /// Blocks left of the diagonal; the first is not read.
    pub lower: Vec<Matrix2<f64>>,
    /// Diagonal blocks.
    pub diagonal: Vec<Matrix2<f64>>,
    /// Blocks right of the diagonal; the last is not read.
    pub upper: Vec<Matrix2<f64>>,
    /// Right sides; [`solve`](Self::solve) puts the solution here.
    pub right: Vec<Vector2<f64>>,
    /// The inverses of the blocks left on the diagonal once the rows outside are taken out.
    inverse: Vec<Matrix2<f64>>,
    /// How much of the row outside is taken out of each row; of the middle row, of the one before it.
    share: Vec<Matrix2<f64>>,
    /// How much of the row behind the middle one is taken out of that.
    share_behind: Matrix2<f64>,
    /// How much of the solution of the row inside is taken out of that of each row.
    back: Vec<Matrix2<f64>>,
}

impl BlockTridiagonal {
    /// A system of `n` ≥ 1 block rows, all zero.
    pub fn new(n: usize) -> Self {
        let zero = vec![Matrix2::zeros(); n];
        Self {
            lower: zero.clone(),
            diagonal: zero.clone(),
            upper: zero.clone(),
            right: vec![Vector2::zeros(); n],
            inverse: zero.clone(),
            share: zero.clone(),
            share_behind: Matrix2::zeros(),
            back: zero,
        }
    }

    /// Factors the blocks, so that [`solve`](Self::solve) can take any number of right sides. A singular block leaves
    /// values that are not finite.
    pub fn factor(&mut self) {
        self.factor_by(|a, b| a * b, inverse_of);
    }

    /// Factors blocks that are all diagonal, for [`solve_uncoupled`](Self::solve_uncoupled).
    pub fn factor_uncoupled(&mut self) {
        let diagonal = |x: f64, z: f64| Matrix2::new(x, 0.0, 0.0, z);
        self.factor_by(|a, b| diagonal(a.m11 * b.m11, a.m22 * b.m22), |m| diagonal(1.0 / m.m11, 1.0 / m.m22));
    }

    #[inline(always)]
    fn factor_by(
        &mut self,
        times: impl Fn(&Matrix2<f64>, &Matrix2<f64>) -> Matrix2<f64>,
        inverse_of: impl Fn(&Matrix2<f64>) -> Matrix2<f64>,
    ) {
        let (middle, mirrored) = self.halves();
        let last = middle + mirrored;
        let Self { lower, diagonal, upper, inverse, share, back, .. } = self;
        // Both ends at once, towards the middle: two chains of operations that do not wait for each other.
        let mut first_end = inverse_of(&diagonal[0]);
        let mut second_end = inverse_of(&diagonal[last]);
        for step in 0..middle.max(mirrored) {
            if step < middle {
                let into = step + 1;
                inverse[step] = first_end;
                back[step] = times(&first_end, &upper[step]);
                share[into] = times(&lower[into], &first_end);
                // The middle row is reached from both sides.
                if into < middle {
                    first_end = inverse_of(&(diagonal[into] - times(&share[into], &upper[step])));
                }
            }
            if step < mirrored {
                let (from, into) = (last - step, last - step - 1);
                inverse[from] = second_end;
                back[from] = times(&second_end, &lower[from]);
                if into > middle {
                    share[into] = times(&upper[into], &second_end);
                    second_end = inverse_of(&(diagonal[into] - times(&share[into], &lower[from])));
                }
            }
        }
        // The middle row, from which both neighbours are eliminated.
        let mut center = diagonal[middle];
        if middle > 0 {
            center -= times(&share[middle], &upper[middle - 1]);
        }
        if mirrored > 0 {
            self.share_behind = times(&upper[middle], &inverse[middle + 1]);
            center -= times(&self.share_behind, &lower[middle + 1]);
        }
        inverse[middle] = inverse_of(&center);
    }

    /// The solution for the right sides in `right`, in their place, once the blocks are factored.
    pub fn solve(&mut self) {
        let mut right = std::mem::take(&mut self.right);
        self.solve_for(&mut right);
        self.right = right;
    }

    /// The solution for other right sides, one for each row, in their place.
    pub fn solve_for(&self, right: &mut [Vector2<f64>]) {
        self.solve_by(right, |block, vector| block * vector);
    }

    /// The solution where all blocks are diagonal, in place of the right sides.
    pub fn solve_uncoupled(&mut self) {
        let mut right = std::mem::take(&mut self.right);
        self.solve_uncoupled_for(&mut right);
        self.right = right;
    }

    /// The solution for other right sides where all blocks are diagonal, in their place.
    pub fn solve_uncoupled_for(&self, right: &mut [Vector2<f64>]) {
        self.solve_by(right, |block, vector| Vector2::new(block.m11 * vector.x, block.m22 * vector.y));
    }

    #[inline(always)]
    fn solve_by(&self, right: &mut [Vector2<f64>], times: impl Fn(&Matrix2<f64>, &Vector2<f64>) -> Vector2<f64>) {
        let (middle, mirrored) = self.halves();
        let Self { inverse, share, share_behind, back, .. } = self;
        let (left, behind) = right.split_at_mut(middle);
        let Some((center, behind)) = behind.split_first_mut() else { return };
        let eliminate = |carried: &mut Vector2<f64>, right: &mut Vector2<f64>, share, inverse| {
            *carried = *right - times(share, carried);
            *right = times(inverse, carried);
        };
        // Elimination from both ends towards the middle.
        let (mut first, mut second) = (Vector2::zeros(), Vector2::zeros());
        let mut rows = left.iter_mut().zip(&share[..middle]).zip(&inverse[..middle]);
        let mirror = behind.iter_mut().rev().zip(share[middle + 1..].iter().rev());
        let mirror = mirror.zip(inverse[middle + 1..].iter().rev());
        // The half before the middle may have one row more.
        if middle > mirrored
            && let Some(((right, share), inverse)) = rows.next()
        {
            eliminate(&mut first, right, share, inverse);
        }
        for (((right, share), inverse), ((mirror_right, mirror_share), mirror_inverse)) in rows.zip(mirror) {
            eliminate(&mut first, right, share, inverse);
            eliminate(&mut second, mirror_right, mirror_share, mirror_inverse);
        }
        // The middle row has what it needs; from it the solution goes back to both ends.
        let rest = *center - times(&share[middle], &first) - times(share_behind, &second);
        *center = times(&inverse[middle], &rest);
        let substitute = |found: &mut Vector2<f64>, right: &mut Vector2<f64>, back| {
            *found = *right - times(back, found);
            *right = *found;
        };
        let (mut first, mut second) = (*center, *center);
        let mut rows = left.iter_mut().rev().zip(back[..middle].iter().rev());
        for ((mirror_right, mirror_back), (right, back)) in behind.iter_mut().zip(&back[middle + 1..]).zip(&mut rows) {
            substitute(&mut second, mirror_right, mirror_back);
            substitute(&mut first, right, back);
        }
        if let Some((right, back)) = rows.next() {
            substitute(&mut first, right, back);
        }
    }

    /// The number of rows before the middle one, and behind it: as many, or one less.
    fn halves(&self) -> (usize, usize) {
        let n = self.diagonal.len();
        (n / 2, n - 1 - n / 2)
    }
}

/// The inverse of a 2×2 block, without a test for zero: a singular block must show in the result.
fn inverse_of(m: &Matrix2<f64>) -> Matrix2<f64> {
    let factor = 1.0 / (m.m11 * m.m22 - m.m12 * m.m21);
    Matrix2::new(m.m22 * factor, -m.m12 * factor, -m.m21 * factor, m.m11 * factor)
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    /// A fixed sequence of numbers in [-1, 1].
    fn noise(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    #[test]
    fn agrees_with_a_dense_solution() {
        for (n, coupled) in [1, 2, 3, 4, 7, 20].into_iter().flat_map(|n| [(n, true), (n, false)]) {
            let mut seed = n as u64;
            let coupling = if coupled { Matrix2::repeat(1.0) } else { Matrix2::identity() };
            let mut system = BlockTridiagonal::new(n);
            let mut dense = DMatrix::zeros(2 * n, 2 * n);
            for i in 0..n {
                let mut block = |strength: f64| {
                    Matrix2::from_fn(|_, _| noise(&mut seed)).component_mul(&coupling) + Matrix2::identity() * strength
                };
                (system.lower[i], system.diagonal[i], system.upper[i]) = (block(0.0), block(4.0), block(0.0));
                system.right[i] = Vector2::from_fn(|_, _| noise(&mut seed));
                dense.fixed_view_mut::<2, 2>(2 * i, 2 * i).copy_from(&system.diagonal[i]);
                if i > 0 {
                    dense.fixed_view_mut::<2, 2>(2 * i, 2 * i - 2).copy_from(&system.lower[i]);
                }
                if i + 1 < n {
                    dense.fixed_view_mut::<2, 2>(2 * i, 2 * i + 2).copy_from(&system.upper[i]);
                }
            }
            let right = DVector::from_fn(2 * n, |row, _| system.right[row / 2][row % 2]);
            let expected = dense.lu().solve(&right).unwrap();
            system.factor();
            if coupled {
                system.solve()
            } else {
                system.solve_uncoupled()
            }
            for row in 0..2 * n {
                // Diagonally dominant, so a few roundings of numbers of size 1.
                assert!((system.right[row / 2][row % 2] - expected[row]).abs() < 1e-14, "n = {n}, row {row}");
            }
        }
    }
}
