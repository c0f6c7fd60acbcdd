//! Convolutions of periodic fields on a grid, by real fast Fourier transforms.

use std::fmt;
use std::ops::Mul;
use std::sync::Arc;

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

/// Columns that are transformed along y together: a cache line of the rows beside each other.
const COLUMNS: usize = 8;

/// The numbers of points of a grid: a field has rows of `nx` values along x, `ny` of them along y.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridSize {
    /// Points along the sliding.
    pub nx: usize,
    /// Points across it; 1: ridges.
    pub ny: usize,
}

impl GridSize {
    /// The number of points.
    pub fn points(self) -> usize {
        self.nx * self.ny
    }

    /// The number of waves along x with q_x ≥ 0.
    pub fn columns(self) -> usize {
        self.nx / 2 + 1
    }

    /// Whether this column of the spectrum is that of two points a wave, which has no phase.
    pub fn is_shortest(self, column: usize) -> bool {
        2 * column == self.nx
    }

    /// The number of waves along y of a row of the spectrum, counted from -ny/2 to ny/2.
    pub fn wave_along_y(self, row: usize) -> f64 {
        if 2 * row <= self.ny { row as f64 } else { row as f64 - self.ny as f64 }
    }
}

/// The transforms of one size of grid, with all that they need: convolutions allocate nothing.
///
/// A kernel has one factor for every wave with q_x ≥ 0, that of the column `i` along x and the row `j` along y at
/// `i ny + j`. Transforms have no factor 1/N: kernels do.
pub struct Convolution {
    size: GridSize,
    forward_x: Arc<dyn RealToComplex<f64>>,
    backward_x: Arc<dyn ComplexToReal<f64>>,
    /// Along y: forward and backward; none for ridges.
    along_y: Option<[Arc<dyn Fft<f64>>; 2]>,
    /// Row by row.
    spectrum: Vec<Complex<f64>>,
    columns: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
    /// How many pairs of transforms have been made.
    pairs: usize,
}

impl fmt::Debug for Convolution {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Convolution").field("size", &self.size).finish_non_exhaustive()
    }
}

impl Convolution {
    /// The transforms of fields of this size.
    pub fn new(size: GridSize) -> Self {
        let (mut real, mut complex) = (RealFftPlanner::new(), FftPlanner::new());
        let (forward_x, backward_x) = (real.plan_fft_forward(size.nx), real.plan_fft_inverse(size.nx));
        let along_y = (size.ny > 1).then(|| [complex.plan_fft_forward(size.ny), complex.plan_fft_inverse(size.ny)]);
        let of_y = along_y.iter().flatten().map(|fft| fft.get_inplace_scratch_len()).max().unwrap_or(0);
        let scratch = of_y.max(forward_x.get_scratch_len()).max(backward_x.get_scratch_len());
        let zeros = |count| vec![Complex::from(0.0); count];
        Self {
            size,
            forward_x,
            backward_x,
            along_y,
            spectrum: zeros(size.columns() * size.ny),
            columns: zeros(COLUMNS * size.ny),
            scratch: zeros(scratch),
            pairs: 0,
        }
    }

    /// The size of the fields.
    pub fn size(&self) -> GridSize {
        self.size
    }

    /// How many convolutions there have been, each a pair of transforms.
    pub fn pairs(&self) -> usize {
        self.pairs
    }

    /// Replaces `field` by its convolution with the `kernel`.
    pub fn apply<T: Copy>(&mut self, field: &mut [f64], kernel: &[T])
    where
        Complex<f64>: Mul<T, Output = Complex<f64>>,
    {
        self.pairs += 1;
        let (nx, columns) = (self.size.nx, self.size.columns());
        for (row, spectrum) in field.chunks_exact_mut(nx).zip(self.spectrum.chunks_exact_mut(columns)) {
            // The lengths are those of the plan.
            let _ = self.forward_x.process_with_scratch(row, spectrum, &mut self.scratch);
        }
        if self.along_y.is_some() {
            self.multiply_along_y(kernel);
        } else {
            self.spectrum.iter_mut().zip(kernel).for_each(|(wave, &factor)| *wave = *wave * factor);
        }
        for (row, spectrum) in field.chunks_exact_mut(nx).zip(self.spectrum.chunks_exact_mut(columns)) {
            // Roundings would be refused: the waves without a phase are real.
            spectrum[0].im = 0.0;
            if nx % 2 == 0 {
                spectrum[columns - 1].im = 0.0;
            }
            let _ = self.backward_x.process_with_scratch(spectrum, row, &mut self.scratch);
        }
    }

    /// Transforms some columns along y, multiplies them by the kernel and transforms them back, while they are in the
    /// cache.
    fn multiply_along_y<T: Copy>(&mut self, kernel: &[T])
    where
        Complex<f64>: Mul<T, Output = Complex<f64>>,
    {
        let Some([forward, backward]) = &self.along_y else { return };
        let (ny, all) = (self.size.ny, self.size.columns());
        for first in (0..all).step_by(COLUMNS) {
            let count = COLUMNS.min(all - first);
            let columns = &mut self.columns[..count * ny];
            for (j, row) in self.spectrum.chunks_exact(all).enumerate() {
                for (i, wave) in row[first..first + count].iter().enumerate() {
                    columns[i * ny + j] = *wave;
                }
            }
            forward.process_with_scratch(columns, &mut self.scratch);
            let kernel = &kernel[first * ny..(first + count) * ny];
            columns.iter_mut().zip(kernel).for_each(|(wave, &factor)| *wave = *wave * factor);
            backward.process_with_scratch(columns, &mut self.scratch);
            for (j, row) in self.spectrum.chunks_exact_mut(all).enumerate() {
                for (i, wave) in row[first..first + count].iter_mut().enumerate() {
                    *wave = columns[i * ny + j];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// Waves of even and odd numbers of points, shifted by the kernel e^(iq_x s) to where cosines say.
    #[test]
    fn a_kernel_acts_on_each_wave() {
        for (nx, ny) in [(8, 1), (9, 1), (30, 1), (12, 10), (9, 21), (16, 5)] {
            let size = GridSize { nx, ny };
            let (m, k) = (3.0, if ny == 1 { 0.0 } else { -2.0 });
            let wave = |i: usize, j: usize, shift: f64| {
                let phase = m * (i as f64 / nx as f64 + shift) + k * j as f64 / ny as f64;
                0.5 + (TAU * phase + 0.4).cos()
            };
            let field = |shift: f64| -> Vec<f64> {
                (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))).map(|(i, j)| wave(i, j, shift)).collect()
            };
            let share = 1.0 / size.points() as f64;
            let factor = |column: usize| Complex::from_polar(share, TAU * 0.1 * column as f64);
            let kernel: Vec<_> = (0..size.columns()).flat_map(|i| std::iter::repeat_n(factor(i), ny)).collect();
            let mut found = field(0.0);
            Convolution::new(size).apply(&mut found, &kernel);
            for (found, exact) in found.iter().zip(field(0.1)) {
                // Roundings of sums of some hundred terms.
                assert!((found - exact).abs() < 1e-14, "{nx} x {ny}: {found} for {exact}");
            }
        }
    }
}
