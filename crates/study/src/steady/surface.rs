//! A periodic rigid surface on an even grid.

use std::f64::consts::TAU;

use rustfft::num_complex::Complex;

use super::resample::{self, transposed};
use super::transform::{Convolution, GridSize};
use asperity::math::sum;
use asperity::scene::{HeightMap, Spectrum, Surface};

/// Heights on an even grid over one period, without their mean.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceGrid {
    /// The numbers of points.
    pub size: GridSize,
    /// The period along the sliding, m.
    pub length: f64,
    /// The period across it, m; of ridges not used.
    pub width: f64,
    /// Heights, m: rows along x, one after the other along y.
    pub heights: Vec<f64>,
}

/// Points to the shortest wave of a profile.
const POINTS_PER_WAVE: f64 = 8.0;
/// Steps of a profile that differ by this part of them are even.
const EVEN: f64 = 1.0e-6;

impl SurfaceGrid {
    /// The fewest points along the sliding that a surface is solved on.
    pub const FEWEST: usize = 16;

    /// The surface with these heights (m), rows of `nx` along x over the periods `length` and `width` (m).
    pub fn new(size: GridSize, length: f64, width: f64, mut heights: Vec<f64>) -> Self {
        let mean = sum(&heights) / heights.len() as f64;
        heights.iter_mut().for_each(|height| *height -= mean);
        Self { size, length, width, heights }
    }

    /// Ridges: one period of a periodic profile at as many even `points` of its spline.
    pub fn of_profile(surface: &Surface, points: usize) -> Self {
        let (x, spline) = (surface.x(), surface.spline());
        let (first, length) = (x[0], x[x.len() - 1] - x[0]);
        let height = |i: usize| spline.evaluate(first + length * (i as f64 / points as f64)).0;
        Self::new(GridSize { nx: points, ny: 1 }, length, 0.0, (0..points).map(height).collect())
    }

    /// One period of a map of heights, which is periodic, at its own points.
    pub fn of_map(map: &HeightMap) -> Self {
        let (size, [dx, dy]) = (GridSize { nx: map.nx(), ny: map.ny() }, map.spacing());
        Self::new(size, dx * size.nx as f64, dy * size.ny as f64, map.heights().to_vec())
    }

    /// The same waves on another grid: those that it cannot hold are left out.
    pub fn resampled(&self, size: GridSize) -> Self {
        let along_x = resample::lines(&self.heights, self.size.nx, size.nx);
        let columns = resample::lines(&transposed(&along_x, size.nx), self.size.ny, size.ny);
        Self::new(size, self.length, self.width, transposed(&columns, size.ny))
    }

    /// As many points of a profile as it has itself, where they are even and enough for its shortest wave; else as many as
    /// that takes.
    pub fn points_of_profile(surface: &Surface) -> usize {
        let x = surface.x();
        let (own, length) = (x.len() - 1, x[x.len() - 1] - x[0]);
        let step = length / own as f64;
        let is_even = x.windows(2).all(|pair| (pair[1] - pair[0] - step).abs() <= EVEN * step);
        let needed = Spectrum::new(surface).shortest_wavelength().map_or(0.0, |shortest| {
            // Of a number that is whole but for rounding none is added.
            (POINTS_PER_WAVE * length / shortest * (1.0 - 1e-9)).ceil()
        }) as usize;
        let needed = needed.max(Self::FEWEST);
        if is_even && own >= needed { own } else { rounded_up(own.max(needed)) }
    }

    /// The area of the surface that a point stands for, as a share of the whole.
    pub fn share_of_point(&self) -> f64 {
        1.0 / self.size.points() as f64
    }

    /// q_x of a column of the spectrum, rad/m.
    pub fn wave_number(&self, column: usize) -> f64 {
        TAU / self.length * column as f64
    }

    /// |q| of a column and a row of the spectrum, rad/m.
    pub fn magnitude(&self, column: usize, row: usize) -> f64 {
        if self.size.ny == 1 {
            return self.wave_number(column);
        }
        self.wave_number(column).hypot(TAU / self.width * self.size.wave_along_y(row))
    }

    /// Root mean square height, m.
    pub fn rms_height(&self) -> f64 {
        (asperity::math::dot(&self.heights, &self.heights) * self.share_of_point()).sqrt()
    }

    /// Highest minus lowest, m.
    pub fn peak_to_valley(&self) -> f64 {
        asperity::scene::peak_to_valley(&self.heights)
    }

    /// ∂h/∂x of the waves, at the points; that of two points a wave is 0 there.
    pub fn slopes(&self, convolution: &mut Convolution) -> Vec<f64> {
        self.derivative(
            convolution,
            |column, _| {
                if self.size.is_shortest(column) { 0.0 } else { self.wave_number(column) }
            },
        )
    }

    /// ∂h/∂y of the waves alike; of ridges 0.
    pub fn slopes_across(&self, convolution: &mut Convolution) -> Vec<f64> {
        let ny = self.size.ny;
        if ny == 1 {
            return vec![0.0; self.size.points()];
        }
        self.derivative(
            convolution,
            |_, row| {
                if 2 * row == ny { 0.0 } else { TAU / self.width * self.size.wave_along_y(row) }
            },
        )
    }

    /// The derivative along the direction in which a wave of a column and a row has the `wave_number`.
    fn derivative(&self, convolution: &mut Convolution, wave_number: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let share = self.share_of_point();
        let factor = |(column, row)| Complex::new(0.0, wave_number(column, row) * share);
        let waves = (0..self.size.columns()).flat_map(|column| (0..self.size.ny).map(move |row| (column, row)));
        let kernel: Vec<_> = waves.map(factor).collect();
        let mut slopes = self.heights.clone();
        convolution.apply(&mut slopes, &kernel);
        slopes
    }

    /// Every other point along both directions, with its own mean; `None` where they are few or odd.
    pub(super) fn coarser(&self) -> Option<Self> {
        let GridSize { nx, ny } = self.size;
        let has_half = |n: usize| n.is_multiple_of(2) && n / 2 >= Self::FEWEST;
        if !has_half(nx) || (ny > 1 && !has_half(ny)) {
            return None;
        }
        let step_y = if ny > 1 { 2 } else { 1 };
        let size = GridSize { nx: nx / 2, ny: ny / step_y };
        let rows = self.heights.chunks_exact(nx).step_by(step_y);
        let heights = rows.flat_map(|row| row.iter().step_by(2).copied()).collect();
        Some(Self::new(size, self.length, self.width, heights))
    }
}

/// The next number of the form m 2^k with m from 8 to 15: fast to transform, and even many times.
fn rounded_up(count: usize) -> usize {
    let mut unit = 1;
    while count.div_ceil(unit) >= 16 {
        unit *= 2;
    }
    count.div_ceil(unit) * unit
}
