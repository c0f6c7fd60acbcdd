//! The linear problem of a contact whose points are known: pressures on them under which the surface moves as it must.
//!
//! Pressures p on a set of n of the N points move the surface by C p. With the separation d and the mean pressure P,
//!
//!   C p + d = r on the set,   mean p = P.
//!
//! Subtracting the mean over the set eliminates d. The part of p with zero sum is found by [GMRES](super::krylov),
//! preconditioned by M K restricted to the set, in about ten iterations on any grid. Keeping the phase of M K saves an
//! eighth of them over |M K|.

use rustfft::num_complex::Complex;

use super::compliance::Compliance;
use super::krylov::Gmres;
use super::transform::Convolution;
use asperity::math::sum;

/// The most iterations.
const MOST_ITERATIONS: usize = 400;

/// The solver of linear problems on one grid, with its memory.
#[derive(Debug)]
pub(super) struct LinearSolver {
    pub(super) convolution: Convolution,
    /// A field of the grid.
    field: Vec<f64>,
    gmres: Gmres,
}

impl LinearSolver {
    pub(super) fn new(convolution: Convolution) -> Self {
        let field = vec![0.0; convolution.size().points()];
        Self { convolution, field, gmres: Gmres::default() }
    }

    /// How the pressures `p` on the points of the set, 0 elsewhere, move the surface: C p at all points.
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
        let Self { convolution, field, gmres } = self;
        let mut convolve = |from: &[f64], kernel: &[Complex<f64>], to: &mut [f64]| {
            scatter(set, from, field);
            convolution.apply(field, kernel);
            gather(set, field, to);
            remove_mean(to);
        };
        remove_mean(residual);
        gmres.solve(p, residual, tolerance, MOST_ITERATIONS, |from, direction, image| {
            convolve(from, &compliance.stiffness, direction);
            convolve(direction, &compliance.compliance, image);
        });
    }
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

/// Subtracts the mean.
fn remove_mean(values: &mut [f64]) {
    let mean = sum(values) / values.len() as f64;
    values.iter_mut().for_each(|value| *value -= mean);
}
