//! GMRES, the generalised minimal residual method (Y. Saad, M. H. Schultz, SIAM J. Sci. Stat. Comput. 7, 1986), with a
//! preconditioner from the right that may be anything.

use asperity::math::{add_weighted_sum, dot};

/// Iterations before it begins anew with what it has.
const RESTART: usize = 40;

/// The method's memory.
#[derive(Debug, Default)]
pub(super) struct Gmres {
    /// The orthonormal directions of the residual, and what of the solution each is made of.
    basis: Vec<Vec<f64>>,
    directions: Vec<Vec<f64>>,
}

impl Gmres {
    /// Changes `x` until the norm of `residual`, b - A x, is at most `tolerance`, in at most so many iterations. `operator`
    /// writes the preconditioned direction of its first argument to the second, and A times that to the third.
    pub(super) fn solve(
        &mut self,
        x: &mut [f64],
        residual: &mut [f64],
        tolerance: f64,
        most: usize,
        mut operator: impl FnMut(&[f64], &mut [f64], &mut [f64]),
    ) {
        let mut left = most;
        while left > 0 {
            let made = self.cycle(x, residual, tolerance, left.min(RESTART), &mut operator);
            left -= made;
            if made < RESTART {
                return;
            }
        }
    }

    /// At most so many iterations, one after the other; returns how many there were.
    fn cycle(
        &mut self,
        x: &mut [f64],
        residual: &mut [f64],
        tolerance: f64,
        most: usize,
        operator: &mut impl FnMut(&[f64], &mut [f64], &mut [f64]),
    ) -> usize {
        let norm = dot(residual, residual).sqrt();
        if norm <= tolerance {
            return 0;
        }
        let mut least_squares = LeastSquares::new(norm);
        resize(&mut self.basis, 0, x.len());
        self.basis[0].iter_mut().zip(residual.iter()).for_each(|(value, residual)| *value = residual / norm);
        let mut count = 0;
        while count < most && least_squares.residual.abs() > tolerance {
            resize(&mut self.directions, count, x.len());
            resize(&mut self.basis, count + 1, x.len());
            let (known, new) = self.basis.split_at_mut(count + 1);
            let new = &mut new[0];
            operator(&known[count], &mut self.directions[count], new);
            // Gram and Schmidt's classical way, once: directions stay orthogonal enough for the three digits or so that a
            // call is asked for.
            let mut column = [0.0; RESTART + 1];
            column.iter_mut().zip(known.iter()).for_each(|(part, direction)| *part = dot(direction, new));
            add_weighted_sum(new, known.iter().zip(&column).map(|(direction, part)| (-part, direction.as_slice())));
            let norm = dot(new, new).sqrt();
            column[count + 1] = norm;
            least_squares.add(column);
            count += 1;
            if norm == 0.0 {
                break;
            }
            new.iter_mut().for_each(|value| *value /= norm);
        }
        let weights = least_squares.weights();
        let terms = self.directions.iter().zip(&weights).map(|(direction, &weight)| (weight, direction.as_slice()));
        add_weighted_sum(x, terms.take(count));
        let parts = least_squares.residual_parts();
        residual.fill(0.0);
        let terms = self.basis.iter().zip(&parts).map(|(direction, &part)| (part, direction.as_slice()));
        add_weighted_sum(residual, terms.take(count + 1));
        count
    }
}

/// The small least squares problem of GMRES, by Givens' rotations.
struct LeastSquares {
    /// The columns of the triangle.
    columns: Vec<[f64; RESTART + 1]>,
    /// Cosines and sines.
    rotations: Vec<[f64; 2]>,
    right: [f64; RESTART + 1],
    /// The last of the right side: the residual, with a sign.
    residual: f64,
}

impl LeastSquares {
    fn new(norm: f64) -> Self {
        let mut right = [0.0; RESTART + 1];
        right[0] = norm;
        Self { columns: Vec::with_capacity(RESTART), rotations: Vec::with_capacity(RESTART), right, residual: norm }
    }

    /// Adds a column of Hessenberg's matrix.
    fn add(&mut self, mut column: [f64; RESTART + 1]) {
        let last = self.rotations.len();
        for (i, [cosine, sine]) in self.rotations.iter().enumerate() {
            let (a, b) = (column[i], column[i + 1]);
            (column[i], column[i + 1]) = (cosine * a + sine * b, cosine * b - sine * a);
        }
        let length = column[last].hypot(column[last + 1]);
        let [cosine, sine] = if length > 0.0 { [column[last] / length, column[last + 1] / length] } else { [1.0, 0.0] };
        (column[last], column[last + 1]) = (length, 0.0);
        (self.right[last], self.right[last + 1]) = (cosine * self.right[last], -sine * self.right[last]);
        self.residual = self.right[last + 1];
        self.rotations.push([cosine, sine]);
        self.columns.push(column);
    }

    /// The weights of the directions.
    fn weights(&self) -> [f64; RESTART] {
        let mut weights = [0.0; RESTART];
        for i in (0..self.columns.len()).rev() {
            let known: f64 = (i + 1..self.columns.len()).map(|j| self.columns[j][i] * weights[j]).sum();
            let pivot = self.columns[i][i];
            weights[i] = if pivot > 0.0 { (self.right[i] - known) / pivot } else { 0.0 };
        }
        weights
    }

    /// The parts of the directions in what is left of the residual.
    fn residual_parts(&self) -> [f64; RESTART + 1] {
        let mut parts = [0.0; RESTART + 1];
        parts[self.rotations.len()] = self.residual;
        for (i, [cosine, sine]) in self.rotations.iter().enumerate().rev() {
            let (a, b) = (parts[i], parts[i + 1]);
            (parts[i], parts[i + 1]) = (cosine * a - sine * b, sine * a + cosine * b);
        }
        parts
    }
}

/// Makes the vector at `index`, the next or one that is there, so long.
fn resize(vectors: &mut Vec<Vec<f64>>, index: usize, length: usize) {
    if vectors.len() == index {
        vectors.push(Vec::with_capacity(length));
    }
    vectors[index].resize(length, 0.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix that is neither symmetric nor near its diagonal, by more iterations than one cycle has, with the residual that
    /// it says.
    #[test]
    fn a_linear_system_is_solved_to_the_residual_that_is_said() {
        let n = 120;
        let apply = |x: &[f64], y: &mut [f64]| {
            for i in 0..n {
                y[i] = (2.0 + 0.1 * i as f64) * x[i] - 1.5 * x[(i + 1) % n] + 0.3 * x[(i + 7) % n];
            }
        };
        let right: Vec<f64> = (0..n).map(|i| ((i * i) as f64).sin()).collect();
        let (mut x, mut residual) = (vec![0.0; n], right.clone());
        Gmres::default().solve(&mut x, &mut residual, 1e-10, 500, |from, direction, image| {
            direction.copy_from_slice(from);
            apply(direction, image);
        });
        let mut image = vec![0.0; n];
        apply(&x, &mut image);
        for i in 0..n {
            assert!((right[i] - image[i] - residual[i]).abs() < 1e-13 && residual[i].abs() <= 1e-10, "{i}");
        }
    }
}
