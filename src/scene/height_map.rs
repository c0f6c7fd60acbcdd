//! Heights over an even grid: areal measurements and random surfaces in two dimensions.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;
use serde::Serialize;

use super::surface::{STEEPEST, peak_to_valley};
use super::values::{LARGEST, SMALLEST};
use super::{RoughnessSpectrum, Surface};
use crate::math::{Direction, fourier_2d};
use crate::tables::ContentError;

/// The most heights of a map.
pub const MOST_HEIGHTS: usize = 1 << 24;

/// Periodic edges may differ by rounding: by this part of the peak-to-valley height.
const ROUNDING: f64 = 1e-12;

/// Heights at even points along x and y, of which x is the direction of sliding.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeightMap {
    nx: usize,
    spacing: [f64; 2],
    heights: Vec<f64>,
}

/// Why there is no map of a line of an areal measurement: what one takes, and was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// Steps of the points are not even along an axis.
    #[error("even steps along {0}")]
    Uneven(&'static str),
    /// There are too many heights.
    #[error("a map of up to {most} heights, not {nx} by {ny}", most = MOST_HEIGHTS)]
    TooLarge {
        /// Along x.
        nx: usize,
        /// Along y.
        ny: usize,
    },
    /// The shortest step, m, is too short.
    #[error("points at least {least:e} m apart, not {0:e} m", least = SMALLEST)]
    TooClose(f64),
    /// Heights or slopes are too large.
    #[error("heights with slopes up to {steepest:e}", steepest = STEEPEST)]
    TooSteep,
    /// Heights are missing.
    #[error(
        "a height at each point, or missing = \"fill\": {count} are missing, the first in line {line}, point {point}"
    )]
    Missing {
        /// How many.
        count: usize,
        /// The line of the first, counted from 1.
        line: usize,
        /// Its point in the line, counted from 1.
        point: usize,
    },
    /// All heights are missing.
    #[error("heights, not gaps alone")]
    OnlyGaps,
    /// Numbers stand for no height.
    #[error(transparent)]
    Sentinels(#[from] ContentError),
    /// What a map takes in a format of files.
    #[error("{0}")]
    Format(String),
    /// The line was smoothed.
    #[error("a map as it is: smoothing and splitting are of one line")]
    Smoothed,
}

impl HeightMap {
    /// Lines along x of `nx` heights (m) each, one after the other along y, with these distances (m) of points along x
    /// and of lines along y. A periodic one goes on behind its last point and its last line with the first ones.
    pub fn new(nx: usize, spacing: [f64; 2], heights: Vec<f64>) -> Self {
        Self { nx, spacing, heights }
    }

    /// Points of a line along x.
    pub fn nx(&self) -> usize {
        self.nx
    }

    /// Lines along y.
    pub fn ny(&self) -> usize {
        self.heights.len() / self.nx
    }

    /// Distances of points along x and y, m.
    pub fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    /// Heights (m) as they were read, mean included: line by line along y, x runs fastest.
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// Line `j` along x, from 0.
    pub fn line(&self, j: usize) -> &[f64] {
        &self.heights[j * self.nx..(j + 1) * self.nx]
    }

    /// Column `i`, a line along y, from 0.
    pub fn column(&self, i: usize) -> Vec<f64> {
        self.heights.iter().skip(i).step_by(self.nx).copied().collect()
    }

    /// The map with x and y exchanged.
    pub fn transposed(&self) -> Self {
        let heights = (0..self.nx).flat_map(|i| self.column(i)).collect();
        Self::new(self.ny(), [self.spacing[1], self.spacing[0]], heights)
    }

    /// Mean height, m.
    pub fn mean(&self) -> f64 {
        self.heights.iter().sum::<f64>() / self.heights.len() as f64
    }

    /// Root mean square height about the mean, m.
    pub fn rms_height(&self) -> f64 {
        let mean = self.mean();
        (self.heights.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / self.heights.len() as f64).sqrt()
    }

    /// Root mean square gradient, of splines along all lines and columns.
    pub fn rms_gradient(&self, periodic: bool) -> f64 {
        (self.slope_square(periodic) + self.transposed().slope_square(periodic)).sqrt()
    }

    /// The mean square slope along x.
    fn slope_square(&self, periodic: bool) -> f64 {
        let square = |j| self.profile(j, periodic).rms_slope().powi(2);
        (0..self.ny()).map(square).sum::<f64>() / self.ny() as f64
    }

    /// Line `j` as a profile; that of a periodic map is closed by its first height.
    pub(super) fn profile(&self, j: usize, periodic: bool) -> Surface {
        let mut z = self.line(j).to_vec();
        if periodic {
            z.push(z[0]);
        }
        let x = (0..z.len()).map(|i| self.spacing[0] * i as f64).collect();
        Surface::new(x, z, periodic)
    }

    /// The slopes along x and y of the least squares plane.
    pub fn tilt(&self) -> [f64; 2] {
        // About the middle of an even grid neither depends on the other.
        let (mut products, mut squares) = ([0.0; 2], [0.0; 2]);
        for (at, z) in self.heights.iter().enumerate() {
            for (axis, distance) in self.offset_of(at).into_iter().enumerate() {
                products[axis] += distance * z;
                squares[axis] += distance * distance;
            }
        }
        [0, 1].map(|axis| if squares[axis] > 0.0 { products[axis] / squares[axis] } else { 0.0 })
    }

    /// Where height `at` is, from the middle of the grid, m.
    fn offset_of(&self, at: usize) -> [f64; 2] {
        let distance = |i: usize, count: usize, spacing: f64| spacing * (i as f64 - 0.5 * (count - 1) as f64);
        [distance(at % self.nx, self.nx, self.spacing[0]), distance(at / self.nx, self.ny(), self.spacing[1])]
    }

    /// The heights above the least squares plane.
    pub fn without_plane(&self) -> Self {
        let ([slope_x, slope_y], mean) = (self.tilt(), self.mean());
        let plane = |at: usize| {
            let [x, y] = self.offset_of(at);
            mean + slope_x * x + slope_y * y
        };
        let heights = self.heights.iter().enumerate().map(|(at, z)| z - plane(at)).collect();
        Self { heights, ..self.clone() }
    }

    /// The heights above the least squares plane, followed by their mirror images along x and y without the lines that
    /// both have: one period of a periodic map.
    pub fn mirrored(&self) -> Self {
        let once = |map: &Self| {
            let there_and_back = |j| {
                let line = map.line(j);
                line.iter().chain(line[1..line.len() - 1].iter().rev()).copied()
            };
            Self::new(2 * map.nx - 2, map.spacing, (0..map.ny()).flat_map(there_and_back).collect())
        };
        once(&once(&self.without_plane()).transposed()).transposed()
    }

    /// The map without its last line and its last column where they repeat the first ones, as the edges of a period do.
    pub(super) fn without_repetition(self) -> Self {
        let tolerance = ROUNDING * peak_to_valley(&self.heights);
        let same = |(a, b): (&f64, &f64)| (a - b).abs() <= tolerance;
        let open_along_x = |map: Self| {
            let repeats = map.nx > 2 && (0..map.ny()).all(|j| same((&map.line(j)[0], &map.line(j)[map.nx - 1])));
            if !repeats {
                return map;
            }
            let heights = (0..map.ny()).flat_map(|j| map.line(j)[..map.nx - 1].to_vec()).collect();
            Self { nx: map.nx - 1, heights, ..map }
        };
        open_along_x(open_along_x(self).transposed()).transposed()
    }

    /// Checks that heights and slopes are numbers that can be worked with.
    pub(super) fn check(&self) -> Result<(), MapError> {
        let [dx, dy] = self.spacing;
        if dx.min(dy) < SMALLEST {
            return Err(MapError::TooClose(dx.min(dy)));
        }
        let steps_x = (0..self.ny()).flat_map(|j| self.line(j).windows(2).map(|pair| (pair[1] - pair[0]) / dx));
        let steps_y = self.heights.iter().zip(self.heights.iter().skip(self.nx)).map(|(a, b)| (b - a) / dy);
        let possible = steps_x.chain(steps_y).all(|slope| slope.abs() <= STEEPEST)
            && self.heights.iter().all(|z| z.abs() <= LARGEST);
        if possible { Ok(()) } else { Err(MapError::TooSteep) }
    }

    /// The isotropic power spectrum: the mean of C over rings of wave numbers that are even in the logarithm; `None` where
    /// fewer than two have any power.
    pub fn spectrum(&self, periodic: bool) -> Option<RoughnessSpectrum> {
        /// Rings of a decade.
        const RINGS: f64 = 12.0;
        let extent = self.spacing[0] * self.nx as f64;
        let longest = extent.min(self.spacing[1] * self.ny() as f64);
        let nyquist = PI / self.spacing[0].max(self.spacing[1]);
        // Under a window the longest waves are not reliable.
        let first = TAU / longest * if periodic { 1.0 } else { 2.0 } * (1.0 - 1e-9);
        let count = ((nyquist / first).log10() * RINGS).ceil().max(0.0) as usize;
        // By ring: how many, Σ ln q, Σ C.
        let mut rings = vec![(0_usize, 0.0, 0.0); count + 1];
        for (at, density) in self.power_density(periodic).into_iter().enumerate() {
            let [q_x, q_y] = self.wave_numbers(at);
            let q = q_x.hypot(q_y);
            if (first..nyquist).contains(&q) {
                let (number, logarithms, sum) = &mut rings[((q / first).log10() * RINGS) as usize];
                (*number, *logarithms, *sum) = (*number + 1, *logarithms + q.ln(), *sum + density);
            }
        }
        let mean = |(number, logarithms, sum): (usize, f64, f64)| {
            let number = number as f64;
            [(logarithms / number).exp(), sum / number]
        };
        let largest = rings.iter().map(|ring| mean(*ring)[1]).fold(0.0, f64::max);
        // Beyond a cut-off there are rounding errors alone.
        let seen: Vec<_> = rings.into_iter().map(mean).filter(|[_, density]| *density > 1e-16 * largest).collect();
        (seen.len() > 1).then(|| RoughnessSpectrum::new(seen))
    }

    /// The power spectrum C (m⁴) at the wave numbers of the transform: |h_q|² over the area of one of them in the plane
    /// of wave numbers, so that ⟨h²⟩ = ∫ C d²q; in the order of the transform. From a map that is not periodic the plane
    /// is taken and a Hann window along both axes applied, its loss of power corrected.
    pub(super) fn power_density(&self, periodic: bool) -> Vec<f64> {
        let (nx, ny) = (self.nx, self.ny());
        let level = if periodic { self.clone() } else { self.without_plane() };
        let mean = level.mean();
        let hann = |i: usize, count: usize| (PI * i as f64 / count as f64).sin().powi(2);
        let window = |at: usize| if periodic { 1.0 } else { hann(at % nx, nx) * hann(at / nx, ny) };
        let heights = level.heights.iter().enumerate().map(|(at, z)| Complex::from(window(at) * (z - mean)));
        let mut sums: Vec<_> = heights.collect();
        fourier_2d(&mut sums, nx, Direction::Forward);
        let count = (nx * ny) as f64;
        let cell = TAU.powi(2) / (self.spacing[0] * self.spacing[1] * count);
        let kept = if periodic { 1.0 } else { 0.375 * 0.375 };
        sums.iter().map(|sum| sum.norm_sqr() / (count * count * cell * kept)).collect()
    }

    /// Wave numbers q_x, q_y (rad/m) of place `at` of a transform.
    pub(super) fn wave_numbers(&self, at: usize) -> [f64; 2] {
        let number = |i: usize, count: usize, spacing: f64| {
            let signed = if 2 * i > count { i as f64 - count as f64 } else { i as f64 };
            TAU * signed / (count as f64 * spacing)
        };
        [number(at % self.nx, self.nx, self.spacing[0]), number(at / self.nx, self.ny(), self.spacing[1])]
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn map(nx: usize, ny: usize, height: impl Fn(f64, f64) -> f64) -> HeightMap {
        let at = |at: usize| height((at % nx) as f64, (at / nx) as f64);
        HeightMap::new(nx, [2.0, 3.0], (0..nx * ny).map(at).collect())
    }

    #[test]
    fn lines_run_along_x_and_follow_along_y() {
        let map = map(3, 2, |x, y| x + 10.0 * y);
        assert_eq!((map.nx(), map.ny(), map.line(1), map.column(2)), (3, 2, &[10.0, 11.0, 12.0][..], vec![2.0, 12.0]));
        let turned = map.transposed();
        assert_eq!((turned.nx(), turned.spacing(), turned.line(2)), (2, [3.0, 2.0], &[2.0, 12.0][..]));
        assert_eq!(turned.transposed(), map);
    }

    #[test]
    fn a_plane_is_taken_out_whole() {
        let plane = map(7, 5, |x, y| 4.0 + 0.5 * x - 1.5 * y);
        let [slope_x, slope_y] = plane.tilt();
        assert!((slope_x - 0.25).abs() < 1e-14 && (slope_y + 0.5).abs() < 1e-14);
        assert!(plane.without_plane().heights().iter().all(|z| z.abs() < 1e-13));
    }

    /// A bump that is even about both middles keeps its least squares plane level.
    #[test]
    fn a_mirrored_map_goes_there_and_back() {
        let bump = map(4, 3, |x, y| (x - 1.5).abs() + (y - 1.0).abs());
        let periodic = bump.mirrored();
        assert_eq!((periodic.nx(), periodic.ny()), (6, 4));
        let level = bump.without_plane();
        for j in 0..4 {
            let there = [0, 1, 2, 1][j];
            for (i, from) in [0, 1, 2, 3, 2, 1].into_iter().enumerate() {
                assert_eq!(periodic.line(j)[i], level.line(there)[from]);
            }
        }
    }

    #[test]
    fn edges_that_repeat_the_first_ones_are_left_out() {
        let wave = |nx, ny| map(nx, ny, |x, y| (x % 4.0) * (1.0 + y % 3.0));
        assert_eq!(wave(5, 4).without_repetition(), wave(4, 3));
        assert_eq!(wave(4, 3).without_repetition(), wave(4, 3));
    }

    /// ∫ C d²q is the mean square height, of a periodic map to rounding.
    #[test]
    fn the_spectrum_holds_all_of_the_power() {
        let map = map(6, 10, |x, y| (2.0 * x).sin() + (0.7 * x * y).cos());
        let cell = TAU.powi(2) / (6.0 * 2.0 * 10.0 * 3.0);
        let power: f64 = map.power_density(true).iter().map(|density| density * cell).sum();
        assert!((power / map.rms_height().powi(2) - 1.0).abs() < 1e-12);
    }
}
