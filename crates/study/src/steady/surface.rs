//! A periodic rigid surface on an even grid.

use std::f64::consts::TAU;

use asperity::math::sum;
use asperity::scene::{HeightMap, Spectrum, Surface};
use realfft::RealFftPlanner;
use rustfft::num_complex::Complex;

use super::transform::{Convolution, GridSize};

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
        let along_x = resampled_lines(&self.heights, self.size.nx, size.nx);
        let columns = resampled_lines(&transposed(&along_x, size.nx), self.size.ny, size.ny);
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

    /// How far points are apart along the sliding and across it, m.
    pub fn spacing(&self) -> [f64; 2] {
        [self.length / self.size.nx as f64, self.width / self.size.ny as f64]
    }

    /// The area of the surface that a point stands for, as a share of the whole.
    pub fn share_of_point(&self) -> f64 {
        1.0 / self.size.points() as f64
    }

    /// q_x of a column of the spectrum, rad/m.
    pub fn wave_number(&self, column: usize) -> f64 {
        TAU / self.length * column as f64
    }

    /// q of a column and a row of the spectrum, rad/m; 0 in a direction in which there are two points a wave, which have no
    /// phase.
    pub fn wave_vector(&self, column: usize, row: usize) -> [f64; 2] {
        let ny = self.size.ny;
        let along = if self.size.is_shortest(column) { 0.0 } else { self.wave_number(column) };
        let has_phase = ny > 1 && 2 * row != ny;
        [along, if has_phase { TAU / self.width * self.size.wave_along_y(row) } else { 0.0 }]
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
        self.derivative(convolution, 0)
    }

    /// ∂h/∂y of the waves alike; of ridges 0.
    pub fn slopes_across(&self, convolution: &mut Convolution) -> Vec<f64> {
        if self.size.ny == 1 {
            return vec![0.0; self.size.points()];
        }
        self.derivative(convolution, 1)
    }

    /// The derivative along x (0) or y (1).
    fn derivative(&self, convolution: &mut Convolution, axis: usize) -> Vec<f64> {
        let share = self.share_of_point();
        let factor = |(column, row)| Complex::new(0.0, self.wave_vector(column, row)[axis] * share);
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

/// Lines of `from` even points over a period at `to` points: waves are added that are 0, or the shortest are left out.
///
/// The wave of two points stands for a pair of opposite ones, of half its size each.
fn resampled_lines(values: &[f64], from: usize, to: usize) -> Vec<f64> {
    if from == to {
        return values.to_vec();
    }
    let mut planner = RealFftPlanner::new();
    let (forward, backward) = (planner.plan_fft_forward(from), planner.plan_fft_inverse(to));
    let mut spectrum = vec![Complex::from(0.0); from.max(to) / 2 + 1];
    let (mut line, mut resampled) = (vec![0.0; from], vec![0.0; values.len() / from * to]);
    let shortest = from.min(to);
    for (values, resampled) in values.chunks_exact(from).zip(resampled.chunks_exact_mut(to)) {
        line.copy_from_slice(values);
        spectrum.fill(Complex::from(0.0));
        // The lengths are those of the plans.
        let _ = forward.process(&mut line, &mut spectrum[..from / 2 + 1]);
        spectrum[shortest / 2 + 1..].fill(Complex::from(0.0));
        if shortest.is_multiple_of(2) {
            let wave = &mut spectrum[shortest / 2];
            *wave = Complex::from(wave.re * if to > from { 0.5 } else { 2.0 });
        }
        let _ = backward.process(&mut spectrum[..to / 2 + 1], resampled);
        resampled.iter_mut().for_each(|value| *value /= from as f64);
    }
    resampled
}

/// Lines of `nx` values as lines of the others.
fn transposed(values: &[f64], nx: usize) -> Vec<f64> {
    (0..nx).flat_map(|i| values.iter().skip(i).step_by(nx).copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Waves that both grids hold are the same function at other places, of even and odd numbers of points; a shorter one
    /// is left out, and the one of two points is a cosine.
    #[test]
    fn waves_stay_where_they_are() {
        let line = |count: usize, shortest: f64| -> Vec<f64> {
            let phase = |i: usize, m: f64| TAU * m * i as f64 / count as f64;
            (0..count).map(|i| 0.3 + (phase(i, 2.0) + 0.4).cos() + shortest * phase(i, 6.0).cos()).collect()
        };
        for (from, to, before, after) in
            [(12, 30, 0.7, 0.7), (13, 15, 0.7, 0.7), (30, 12, 0.7, 0.7), (30, 11, 0.7, 0.0), (14, 14, 0.7, 0.7)]
        {
            let found = resampled_lines(&line(from, before).repeat(2), from, to);
            for (found, exact) in found.iter().zip(line(to, after).repeat(2)) {
                // Roundings of a sum of some ten terms.
                assert!((found - exact).abs() < 1e-14, "{from} to {to}: {found} for {exact}");
            }
        }
    }
}
