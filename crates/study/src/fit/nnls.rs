//! Non-negative least squares: min ‖A x - b‖ over x ≥ 0, by the active set method of C. L. Lawson and R. J. Hanson,
//! *Solving Least Squares Problems* (1974), chapter 23.

use nalgebra::{DMatrix, DVector};

/// A column counts as dependent if its part orthogonal to the others is below this, relative to its length.
const INDEPENDENT: f64 = 1e-12;
/// Maximum number of unconstrained solutions, per unknown: Lawson and Hanson's bound.
const TRIES: usize = 3;

/// The x ≥ 0 that minimises ‖A x - b‖.
pub(super) fn non_negative_least_squares(a: &DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
    let lengths: Vec<f64> = a.column_iter().map(|column| column.norm()).collect();
    let mut scaled = compressed(a, b, &lengths);
    let b = scaled.column(a.ncols()).into_owned();
    scaled = scaled.remove_column(a.ncols());
    let mut x = ActiveSet::new(&scaled, &b).solve();
    x.iter_mut().zip(&lengths).for_each(|(x, length)| *x /= if *length > 0.0 { *length } else { 1.0 });
    x
}

/// [A b] with the columns of A scaled to length 1; if it is tall, its triangular factor, which has the same solution.
fn compressed(a: &DMatrix<f64>, b: &DVector<f64>, lengths: &[f64]) -> DMatrix<f64> {
    let mut both = a.clone().insert_column(a.ncols(), 0.0);
    both.set_column(a.ncols(), b);
    for (mut column, &length) in both.column_iter_mut().zip(lengths).filter(|(_, length)| **length > 0.0) {
        column /= length;
    }
    if both.nrows() > both.ncols() { both.qr().r() } else { both }
}

/// State of the search: free unknowns may be positive, all others are 0.
struct ActiveSet<'a> {
    a: &'a DMatrix<f64>,
    b: &'a DVector<f64>,
    x: DVector<f64>,
    /// Free unknowns, in the order of their release.
    free: Vec<usize>,
}

impl<'a> ActiveSet<'a> {
    fn new(a: &'a DMatrix<f64>, b: &'a DVector<f64>) -> Self {
        Self { a, b, x: DVector::zeros(a.ncols()), free: Vec::new() }
    }

    fn solve(mut self) -> DVector<f64> {
        let mut tries = TRIES * self.a.ncols();
        while tries > 0
            && let Some(solution) = self.release()
        {
            tries -= 1;
            let mut wanted = solution;
            while tries > 0 && !self.move_towards(&wanted) {
                tries -= 1;
                match self.free_solution() {
                    Some(solution) => wanted = solution,
                    None => break,
                }
            }
        }
        self.x
    }

    /// Releases the unknown along which the residual falls most steeply, if any falls and the unknown becomes positive.
    /// Returns the solution with it.
    fn release(&mut self) -> Option<DVector<f64>> {
        let gradient = self.a.tr_mul(&(self.b - self.a * &self.x));
        let threshold = 10.0 * self.a.nrows() as f64 * f64::EPSILON * self.b.norm();
        let mut candidates: Vec<usize> =
            (0..self.a.ncols()).filter(|&j| gradient[j] > threshold && !self.free.contains(&j)).collect();
        candidates.sort_by(|&i, &j| gradient[j].total_cmp(&gradient[i]));
        for j in candidates {
            self.free.push(j);
            match self.free_solution() {
                Some(solution) if solution[self.free.len() - 1] > 0.0 => return Some(solution),
                _ => self.free.pop(),
            };
        }
        None
    }

    /// The least squares solution for the free unknowns, of any sign; `None` if their columns are dependent.
    fn free_solution(&self) -> Option<DVector<f64>> {
        let qr = self.a.select_columns(&self.free).qr();
        let r = qr.r();
        if r.nrows() < self.free.len() || r.diagonal().iter().any(|pivot| pivot.abs() < INDEPENDENT) {
            return None;
        }
        let mut right = self.b.clone();
        qr.q_tr_mul(&mut right);
        r.solve_upper_triangular(&right.rows(0, self.free.len()))
    }

    /// Moves x towards `wanted` as far as no unknown becomes negative; those that reach 0 are no longer free. Returns
    /// whether it arrived.
    fn move_towards(&mut self, wanted: &DVector<f64>) -> bool {
        let blocking = |(&j, &to): (&usize, &f64)| (to <= 0.0).then(|| self.x[j] / (self.x[j] - to));
        let share = self.free.iter().zip(wanted.iter()).filter_map(blocking).fold(1.0, f64::min);
        let arrived = self.free.iter().zip(wanted.iter()).all(|(_, &to)| to > 0.0);
        for (&j, &to) in self.free.iter().zip(wanted.iter()) {
            let reached = if arrived { to } else { self.x[j] + share * (to - self.x[j]) };
            // A blocking unknown is at 0 up to rounding.
            let blocks = to <= 0.0 && self.x[j] <= share * (self.x[j] - to) * (1.0 + 4.0 * f64::EPSILON);
            self.x[j] = if blocks { 0.0 } else { reached.max(0.0) };
        }
        let x = &self.x;
        self.free.retain(|&j| x[j] > 0.0);
        arrived
    }
}

#[cfg(test)]
mod tests {
    use asperity::math::SplitMix64;

    use super::*;

    /// The unconstrained minimum, at (1, -1), is not allowed: along x_2 = 0 it is at x_1 = (1·1 + 1·0 + 0·(-1))/2.
    #[test]
    fn an_unknown_that_would_be_negative_is_0() {
        let a = DMatrix::from_row_slice(3, 2, &[1.0, 0.0, 1.0, 1.0, 0.0, 1.0]);
        let b = DVector::from_row_slice(&[1.0, 0.0, -1.0]);
        let x = non_negative_least_squares(&a, &b);
        assert!((x[0] - 0.5).abs() < 1e-15 && x[1] == 0.0, "{x}");
    }

    #[test]
    fn a_solution_that_is_positive_anyway_is_the_free_one() {
        let a = DMatrix::from_row_slice(3, 2, &[2.0, 0.0, 0.0, 3.0, 1.0, 1.0]);
        let x = non_negative_least_squares(&a, &(&a * DVector::from_row_slice(&[0.5, 4.0])));
        // Rounding of a problem whose condition is of order 1.
        assert!((x[0] - 0.5).abs() < 1e-14 && (x[1] - 4.0).abs() < 1e-14, "{x}");
    }

    /// A duplicate column, a zero column, and fewer rows than columns.
    #[test]
    fn columns_that_add_nothing_are_left_out() {
        let a = DMatrix::from_row_slice(2, 4, &[1.0, 1.0, 0.0, 1.0, 2.0, 2.0, 0.0, 0.0]);
        let b = DVector::from_row_slice(&[3.0, 2.0]);
        let x = non_negative_least_squares(&a, &b);
        assert!((&a * &x - &b).norm() < 1e-14, "{x}");
        assert_eq!((x[0] * x[1], x[2]), (0.0, 0.0));
    }

    /// The Karush-Kuhn-Tucker conditions: x ≥ 0, Aᵀ(A x - b) ≥ 0, and one of the two 0 for each unknown.
    #[test]
    fn random_problems_fulfil_the_conditions_of_a_minimum() {
        let mut random = SplitMix64::new(1);
        for case in 0..200 {
            let (rows, columns) = (1 + case % 37, 1 + case % 23);
            let a = DMatrix::from_fn(rows, columns, |_, _| 2.0 * random.unit() - 1.0);
            let b = DVector::from_fn(rows, |_, _| 2.0 * random.unit() - 1.0);
            let x = non_negative_least_squares(&a, &b);
            let gradient = a.tr_mul(&(&a * &x - &b));
            // Rounding in sums of up to 37 products, times the condition of such a matrix.
            let tolerance = 1e-11 * b.norm() * a.norm().max(1.0);
            for (x, gradient) in x.iter().zip(gradient.iter()) {
                assert!(*x >= 0.0 && *gradient > -tolerance && x * gradient < tolerance * x.max(1.0), "case {case}");
            }
        }
    }
}
