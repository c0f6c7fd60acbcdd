//! The linear problem of a contact whose points are known: pressures on them under which the surface moves as it must.
//!
//! Pressures p on a set of n of the N points move the surface by C p. With the separation d and the mean pressure P,
//!
//!   C p + d = r on the set,   mean p = P.
//!
//! Without the mean over the set, d is gone; p without its part that is even over the set is looked for in the space of
//! sum 0. There GMRES (Y. Saad, M. H. Schultz, SIAM J. Sci. Stat. Comput. 7, 1986), preconditioned from the right by
//! M K on the set, needs some ten iterations whatever the grid. (With its phase M K takes an eighth less than |M K|.)

use super::compliance::Compliance;
use super::transform::Convolution;
use crate::math::{add_weighted_sum, dot, sum};

/// Iterations before GMRES begins anew with what it has.
const RESTART: usize = 40;
/// Iterations in all.
const MOST_ITERATIONS: usize = 400;

/// The solver of linear problems on one grid, with its memory.
#[derive(Debug)]
pub(super) struct LinearSolver {
    pub(super) convolution: Convolution,
    /// A field of the grid.
    field: Vec<f64>,
    /// The orthonormal directions of the residual, and what of the pressure each is made of.
    basis: Vec<Vec<f64>>,
    directions: Vec<Vec<f64>>,
}

impl LinearSolver {
    pub(super) fn new(convolution: Convolution) -> Self {
        let field = vec![0.0; convolution.size().points()];
        Self { convolution, field, basis: Vec::new(), directions: Vec::new() }
    }

    /// How a field of the whole grid moves the surface: C p of the pressures `p` on the points of the set, 0 elsewhere.
    pub(super) fn moved(&mut self, compliance: &Compliance, set: &[u32], p: &[f64]) -> &[f64] {
        scatter(set, p, &mut self.field);
        self.convolution.apply(&mut self.field, &compliance.compliance);
        &self.field
    }

    /// Changes the pressures `p` (Pa) on the points of the set, their sum held, until C p + d = r within `tolerance` (m, root
    /// mean square over the set), where `residual` is r - C p at first but for a constant, and that of the new p at last.
    pub(super) fn solve(
        &mut self,
        compliance: &Compliance,
        set: &[u32],
        p: &mut [f64],
        residual: &mut [f64],
        tolerance: f64,
    ) {
        let tolerance = tolerance * (set.len() as f64).sqrt();
        let mut left = MOST_ITERATIONS;
        loop {
            let made = self.cycle(compliance, set, p, residual, tolerance, left.min(RESTART));
            left -= made;
            if made < RESTART || left == 0 {
                return;
            }
        }
    }

    /// GMRES of at most so many iterations; returns how many there were.
    fn cycle(
        &mut self,
        compliance: &Compliance,
        set: &[u32],
        p: &mut [f64],
        residual: &mut [f64],
        tolerance: f64,
        most: usize,
    ) -> usize {
        remove_mean(residual);
        let norm = dot(residual, residual).sqrt();
        if norm <= tolerance || set.len() < 2 {
            return 0;
        }
        let mut least_squares = LeastSquares::new(norm);
        assign(&mut self.basis, 0, residual);
        self.basis[0].iter_mut().for_each(|value| *value /= norm);
        let mut count = 0;
        while count < most && least_squares.residual.abs() > tolerance {
            // The direction of the pressure, by the preconditioner; and what it moves.
            scatter(set, &self.basis[count], &mut self.field);
            self.convolution.apply(&mut self.field, &compliance.stiffness);
            resize(&mut self.directions, count, set.len());
            gather(set, &self.field, &mut self.directions[count]);
            remove_mean(&mut self.directions[count]);
            scatter(set, &self.directions[count], &mut self.field);
            self.convolution.apply(&mut self.field, &compliance.compliance);
            resize(&mut self.basis, count + 1, set.len());
            let (known, new) = self.basis.split_at_mut(count + 1);
            let new = &mut new[0];
            gather(set, &self.field, new);
            remove_mean(new);
            // Gram and Schmidt's classical way, twice: it is as stable as the modified one and reads less.
            let mut column = [0.0; RESTART + 1];
            for _ in 0..2 {
                let mut parts = [0.0; RESTART];
                parts.iter_mut().zip(known.iter()).for_each(|(part, direction)| *part = dot(direction, new));
                column.iter_mut().zip(&parts).for_each(|(sum, part)| *sum += part);
                add_weighted_sum(new, known.iter().zip(&parts).map(|(direction, part)| (-part, direction.as_slice())));
            }
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
        add_weighted_sum(p, terms.take(count));
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

fn assign(vectors: &mut Vec<Vec<f64>>, index: usize, values: &[f64]) {
    resize(vectors, index, values.len());
    vectors[index].copy_from_slice(values);
}

/// The values on the points of a set as a field that is 0 elsewhere.
pub(super) fn scatter(set: &[u32], values: &[f64], field: &mut [f64]) {
    field.fill(0.0);
    set.iter().zip(values).for_each(|(&point, value)| field[point as usize] = *value);
}

/// The values of a field on the points of a set.
pub(super) fn gather(set: &[u32], field: &[f64], values: &mut [f64]) {
    set.iter().zip(values).for_each(|(&point, value)| *value = field[point as usize]);
}

/// Subtracts the mean, and returns it.
pub(super) fn remove_mean(values: &mut [f64]) -> f64 {
    let mean = sum(values) / values.len() as f64;
    values.iter_mut().for_each(|value| *value -= mean);
    mean
}
