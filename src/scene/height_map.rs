//! Heights over an even grid: areal measurements and random surfaces in two dimensions.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;
use serde::Serialize;

use super::values::{LARGEST, SMALLEST};
use crate::math::{FourierDirection, fourier_2d};
use crate::tables::ContentError;

/// The largest slope of a profile: a step of a metre from one atom to the next has less, and its square times that of
/// the largest speed does not overflow.
pub(super) const STEEPEST: f64 = 1e12;

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
    pub fn without_repetition(self) -> Self {
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
    ///
    /// # Errors
    /// [`MapError`] with what is wrong.
    pub fn check(&self) -> Result<(), MapError> {
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
        fourier_2d(&mut sums, nx, FourierDirection::Forward);
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

/// Highest minus lowest, m; 0 for no heights.
pub fn peak_to_valley(heights: &[f64]) -> f64 {
    let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
    (highest - lowest).max(0.0)
}

/// A seam whose differences are, in the root mean square, more than so many times those inside is worth a word.
const ROUGH_SEAM: f64 = 2.5;
/// A seam with a difference of more than so many times the largest inside is none of a periodic surface.
const STEEPEST_SEAM: f64 = 10.0;
/// What makes a period of a surface whose ends do not meet.
const WAYS: &str =
    "asperity surface --mirror makes a period of a surface that ends; tilt = \"remove\" takes out the tilt of a map";
/// Differences that are rounding beside the heights: this part of what lies between the highest and the lowest.
const SEAM_ROUNDING: f64 = 1e-9;

/// What the ends of a surface along one axis are, taken as neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seam {
    axis: &'static str,
    /// The largest difference over the seam, and the largest inside: slopes of a profile, heights of a map.
    largest: [f64; 2],
}

/// Differences of neighbours: how many, their squares, the largest.
#[derive(Clone, Copy, Debug, Default)]
struct Differences {
    count: usize,
    squares: f64,
    largest: f64,
}

impl Differences {
    fn of(differences: impl Iterator<Item = f64>) -> Self {
        differences.fold(Self::default(), |sum, difference| Self {
            count: sum.count + 1,
            squares: sum.squares + difference * difference,
            largest: sum.largest.max(difference.abs()),
        })
    }

    fn rms(&self) -> f64 {
        (self.squares / self.count.max(1) as f64).sqrt()
    }
}

impl Seam {
    /// The seams of a map, along x and along y, that are rougher than what lies inside.
    pub(super) fn of_map(map: &HeightMap) -> Vec<Self> {
        let along_x = Self::of_lines("x", map);
        along_x.into_iter().chain(Self::of_lines("y", &map.transposed())).collect()
    }

    fn of_lines(axis: &'static str, map: &HeightMap) -> Option<Self> {
        let rounding = SEAM_ROUNDING * peak_to_valley(map.heights());
        let lines = || (0..map.ny()).map(|j| map.line(j));
        let over = || lines().map(|line| line[0] - line[line.len() - 1]);
        let inside = || lines().flat_map(|line| line.windows(2).map(|pair| pair[1] - pair[0]));
        Self::found(axis, over, inside, rounding)
    }

    /// The seam of a profile whose last point is the first one again, where it is rougher than what lies inside: slopes,
    /// since its points need not be even.
    pub(super) fn of_profile(x: &[f64], z: &[f64]) -> Option<Self> {
        let slope = |i: usize| (z[i + 1] - z[i]) / (x[i + 1] - x[i]);
        let last = x.len().checked_sub(2)?;
        let rounding = SEAM_ROUNDING * peak_to_valley(z) / (x[last + 1] - x[0]);
        Self::found("x", || std::iter::once(slope(last)), || (0..last).map(slope), rounding)
    }

    /// Differences as large are common within a surface of steps, whose edges may lie at its ends.
    fn found<S: Iterator<Item = f64>, I: Iterator<Item = f64>>(
        axis: &'static str,
        over: impl Fn() -> S,
        inside: impl Fn() -> I,
        rounding: f64,
    ) -> Option<Self> {
        let [seam, within] = [Differences::of(over()), Differences::of(inside())];
        let rms = seam.rms();
        let as_large = inside().filter(|difference| difference.abs() >= rms).count();
        let is_rough = rms > ROUGH_SEAM * within.rms() && 2 * as_large < seam.count && seam.largest > rounding;
        (is_rough && within.count > 1).then_some(Self { axis, largest: [seam.largest, within.largest] })
    }

    /// Warnings of seams, unless one is too large for any surface that is periodic.
    ///
    /// # Errors
    /// What is expected in place of `periodic = true`.
    pub(super) fn check(seams: &[Self]) -> Result<Vec<String>, String> {
        match seams.iter().find(|seam| seam.is_too_large()) {
            Some(seam) => Err(format!("false, for {}: {WAYS}", seam.text())),
            None => Ok(seams.iter().map(|seam| format!("{}; {WAYS}", seam.text())).collect()),
        }
    }

    fn is_too_large(&self) -> bool {
        self.largest[0] > STEEPEST_SEAM * self.largest[1]
    }

    /// What is wrong with it.
    fn text(&self) -> String {
        let [over, inside] = self.largest;
        let times = if inside > 0.0 { over / inside } else { f64::INFINITY };
        format!(
            "the ends do not meet along {}: taken as periodic, they differ by {times:.1} times the largest difference of \
             neighbours inside",
            self.axis
        )
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

    fn even_map(nx: usize, ny: usize, height: impl Fn(f64, f64) -> f64) -> HeightMap {
        HeightMap::new(nx, [1.0; 2], (0..nx * ny).map(|at| height((at % nx) as f64, (at / nx) as f64)).collect())
    }

    fn axes(map: &HeightMap) -> Vec<(&'static str, bool)> {
        Seam::of_map(map).iter().map(|seam| (seam.axis, seam.is_too_large())).collect()
    }

    /// Whole waves meet, also where the seam lies at the steepest place, and so do grooves whose edges are there.
    #[test]
    fn ends_of_whole_waves_and_of_steps_meet() {
        let wave = |phase: f64| std::f64::consts::TAU * phase;
        assert_eq!(axes(&even_map(32, 16, |x, y| wave(x / 32.0).sin() + wave(y / 8.0 + 0.1).sin())), []);
        assert_eq!(axes(&even_map(32, 16, |x, _| if x < 12.0 { 0.0 } else { 1.0 })), []);
        assert_eq!(axes(&even_map(32, 16, |_, _| 3.0)), []);
    }

    #[test]
    fn ends_of_a_cut_out_and_of_a_tilt_do_not_meet() {
        let wave = |phase: f64| std::f64::consts::TAU * phase;
        let cut = |x: f64, y: f64| wave(x / 64.0).cos() * wave(y / 16.0).cos();
        assert_eq!(axes(&even_map(32, 16, cut)), [("x", true)]);
        assert_eq!(axes(&even_map(16, 32, |x, y| cut(y, x) + 0.1 * wave(x / 16.0 + 0.1).sin())), [("y", true)]);
        assert_eq!(axes(&even_map(8, 8, |x, y| 0.1 * x + wave(y / 8.0).sin())), [("x", false)]);
    }

    #[test]
    fn a_profile_is_judged_by_its_slopes() {
        let found = |x: &[f64], z: &[f64]| Seam::of_profile(x, z).map(|seam| seam.is_too_large());
        // A long last step is no jump; a ramp that falls back at once is.
        assert_eq!(found(&[0.0, 1.0, 2.0, 3.0, 13.0], &[0.0, 1.0, 2.0, 2.5, 0.0]), None);
        let x: Vec<f64> = (0..=20).map(f64::from).collect();
        let ramp: Vec<f64> = x.iter().map(|x| if *x < 20.0 { *x } else { 0.0 }).collect();
        assert_eq!((found(&x, &ramp), found(&x[..6], &[0.0, 1.0, 2.0, 3.0, 4.0, 0.0])), (Some(true), Some(false)));
    }
}
