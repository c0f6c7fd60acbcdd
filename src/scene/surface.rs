//! The rigid surface: the data points of its profile, what they must satisfy, the lines through them.

use std::f64::consts::{LN_2, PI, TAU};
use std::sync::Arc;

use serde::Serialize;

use super::height_map::{HeightMap, MapError, STEEPEST, peak_to_valley};
use super::self_affine::SelfAffine;
use super::values::{LARGEST, SMALLEST};
use crate::math::Spline;

/// Periodic ends may differ by rounding: by this part of the peak-to-valley height.
const ROUNDING: f64 = 1.0e-12;

/// The rigid profile: its data points and the spline through them, which copies share; and, where it is a line of a map,
/// that map.
#[derive(Clone, Debug, Serialize)]
pub struct Surface {
    x: Vec<f64>,
    z: Vec<f64>,
    periodic: bool,
    #[serde(skip)]
    self_affine: Option<SelfAffine>,
    #[serde(skip)]
    spline: Arc<Spline>,
    /// Or why there is none, though it is a line of heights over x and y.
    #[serde(skip)]
    map: Option<Arc<Result<HeightMap, MapError>>>,
}

/// Why no profile goes through points: what they should be, and are.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum UnfitPoints {
    #[error(
        "points with a spline of slopes up to {steepest:e} and curvatures up to {largest:e} 1/m",
        steepest = STEEPEST,
        largest = LARGEST
    )]
    /// The spline is too steep or too bent.
    TooSteep,
    #[error("points at least {least:e} m apart along x, not {0:e} m", least = SMALLEST)]
    /// Points are too close to each other.
    TooClose(f64),
}

/// As profiles: an FMU carries the line alone of a map.
impl PartialEq for Surface {
    fn eq(&self, other: &Self) -> bool {
        let parts = |surface: &Self| (surface.periodic, surface.self_affine);
        self.x == other.x && self.z == other.z && parts(self) == parts(other)
    }
}

impl Surface {
    /// The profile through the points (x, z), m: at least two, `x` strictly rising. A periodic one is repeated without
    /// end, and its last height equals the first; any other is continued along its end tangents.
    ///
    /// # Panics
    /// With fewer than two points.
    pub fn new(x: Vec<f64>, z: Vec<f64>, periodic: bool) -> Self {
        let spline = Arc::new(if periodic { Spline::periodic(&x, &z) } else { Spline::natural(&x, &z) });
        Self { x, z, periodic, self_affine: None, spline, map: None }
    }

    pub(super) fn flat() -> Self {
        Self::new(vec![0.0, 1.0], vec![0.0, 0.0], false)
    }

    /// One wavelength of a sine, by `points` intervals.
    pub(super) fn sinusoid(amplitude: f64, wavelength: f64, points: i64) -> Self {
        let phase = |i| i as f64 / points as f64;
        let x = (0..=points).map(|i| wavelength * phase(i)).collect();
        // The last point is the first one again: without the rounding of sin 2π.
        let z = (0..=points).map(|i| amplitude * (TAU * phase(i % points)).sin()).collect();
        Self::new(x, z, true)
    }

    /// Positions of the data points, m, strictly rising; at least two.
    pub fn x(&self) -> &[f64] {
        &self.x
    }

    /// Heights of the data points, m. Periodic: the last equals the first.
    pub fn z(&self) -> &[f64] {
        &self.z
    }

    /// Whether the profile is repeated without end, or else continued along its end tangents.
    pub fn is_periodic(&self) -> bool {
        self.periodic
    }

    /// Whether all its heights are the same.
    pub fn is_level(&self) -> bool {
        self.z.windows(2).all(|pair| pair[0] == pair[1])
    }

    /// The power law that it was made of; `None` for every other profile.
    pub fn self_affine(&self) -> Option<SelfAffine> {
        self.self_affine
    }

    pub(super) fn with_self_affine(self, law: SelfAffine) -> Self {
        Self { self_affine: Some(law), ..self }
    }

    /// The map of which the profile is a line along x, periodic along both axes where the profile is.
    pub fn map(&self) -> Option<&HeightMap> {
        self.map.as_deref()?.as_ref().ok()
    }

    /// Why there is no map, though the profile is a line of an areal measurement.
    pub fn map_error(&self) -> Option<&MapError> {
        self.map.as_deref()?.as_ref().err()
    }

    /// The profile as a line of a map, or of an areal measurement that is none for the reason given.
    pub fn with_map(self, map: Option<Result<HeightMap, MapError>>) -> Self {
        Self { map: map.map(Arc::new), ..self }
    }

    /// The map, its middle line as the profile.
    pub fn of_map(map: HeightMap, periodic: bool) -> Self {
        let line = map.ny().div_ceil(2) - 1;
        map.profile(line, periodic).with_map(Some(Ok(map)))
    }

    /// The cubic spline through the data points.
    pub fn spline(&self) -> &Arc<Spline> {
        &self.spline
    }

    /// The root mean square slope of the spline, including the tilt, 1.
    pub fn rms_slope(&self) -> f64 {
        /// Gauss-Legendre nodes and weights on 0 to 1: exact for the square of a cubic's slope.
        const GAUSS: [(f64, f64); 3] =
            [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
        let slope = |x: f64| self.spline.evaluate(x).1;
        let squares = self.x.windows(2).map(|ends| {
            let step = ends[1] - ends[0];
            step * GAUSS.iter().map(|(at, weight)| weight * slope(ends[0] + at * step).powi(2)).sum::<f64>()
        });
        (squares.sum::<f64>() / (self.x[self.x.len() - 1] - self.x[0])).sqrt()
    }

    /// Checks that slopes and curvatures of the spline are numbers that can be worked with.
    ///
    /// # Errors
    /// What they should be.
    pub fn check_slopes(&self) -> Result<(), UnfitPoints> {
        let bounds = self.spline.bounds();
        let closest = self.x.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        let possible = bounds.slope_max_abs <= STEEPEST && bounds.curvature_max_abs <= LARGEST;
        if !(self.spline.is_finite() && possible) {
            return Err(UnfitPoints::TooSteep);
        }
        if closest < SMALLEST {
            return Err(UnfitPoints::TooClose(closest));
        }
        Ok(())
    }

    /// The least squares line through the profile's data points.
    pub fn line(&self) -> MeanLine {
        MeanLine::through(&self.x, &self.z)
    }

    /// Without waves that are short against `cut_off` (m), by the Gaussian filter of ISO 16610-21, which halves a wave
    /// of that length; near the ends of a natural profile over the points that there are.
    pub fn smoothed(&self, cut_off: f64) -> Self {
        let (x, z) = self.repeated_by(cut_off);
        let width = |i: usize| x[(i + 1).min(x.len() - 1)] - x[i.saturating_sub(1)];
        let weight = |i: usize, at: f64| width(i) * (-(PI * (x[i] - at) / cut_off).powi(2) / LN_2).exp();
        let height = |&at: &f64| {
            // A cut-off away the weight is down to 7e-7.
            let near = x.partition_point(|&x| x < at - cut_off)..x.partition_point(|&x| x <= at + cut_off);
            let (sum, weights) =
                near.fold((0.0, 0.0), |sums, i| (sums.0 + weight(i, at) * z[i], sums.1 + weight(i, at)));
            sum / weights
        };
        let mut heights: Vec<f64> = self.x.iter().map(height).collect();
        if self.periodic {
            heights[self.x.len() - 1] = heights[0];
        }
        let is_of_map = self.map.is_some();
        let no_map = is_of_map.then_some(Err(MapError::Smoothed));
        Self::new(self.x.clone(), heights, self.periodic).with_map(no_map)
    }

    /// The data points, and those of as many periods beside them as reach over `margin`, m.
    fn repeated_by(&self, margin: f64) -> (Vec<f64>, Vec<f64>) {
        if !self.periodic {
            return (self.x.clone(), self.z.clone());
        }
        let last = self.x.len() - 1;
        let period = self.x[last] - self.x[0];
        let beside = (margin / period).ceil() as i64;
        let shifts = (-beside..=beside).map(|shift| shift as f64 * period);
        shifts.flat_map(|shift| (0..last).map(move |i| (self.x[i] + shift, self.z[i]))).unzip()
    }
}

impl SelfAffine {
    /// The profile; of a map line `line`, from 1, or the middle one.
    pub(super) fn surface(&self, line: Option<usize>) -> Surface {
        if let Some(size_y) = self.size_y {
            let map = self.map(size_y);
            let line = line.unwrap_or(map.ny().div_ceil(2)) - 1;
            return map.profile(line, true).with_map(Some(Ok(map))).with_self_affine(*self);
        }
        let share = |i| i as f64 / self.points as f64;
        let x = (0..=self.points).map(|i| self.length * share(i)).collect();
        let mut z = self.heights();
        z.push(z[0]);
        Surface::new(x, z, true).with_self_affine(*self)
    }
}

impl HeightMap {
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
        let x = (0..z.len()).map(|i| self.spacing()[0] * i as f64).collect();
        Surface::new(x, z, periodic)
    }
}

/// The least squares line of a profile as a curve: the weight of a point is the width of the intervals beside it, so
/// that uneven spacing does not matter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanLine {
    /// The middle of the profile, m.
    pub x: f64,
    /// The mean height, m.
    pub z: f64,
    /// The tilt, 1.
    pub slope: f64,
}

impl MeanLine {
    /// The line through points; about their means, so that no digits are lost far from x = 0.
    pub(super) fn through(x: &[f64], z: &[f64]) -> Self {
        let step = |i: usize| x[i + 1] - x[i];
        let weight = |i: usize| if i == 0 { 0.0 } else { step(i - 1) } + if i + 1 < x.len() { step(i) } else { 0.0 };
        let sum = |term: &dyn Fn(usize) -> f64| (0..x.len()).map(|i| weight(i) * term(i)).sum::<f64>();
        let whole = sum(&|_| 1.0);
        let (x_mean, z_mean) = (sum(&|i| x[i]) / whole, sum(&|i| z[i]) / whole);
        let covariance = sum(&|i| (x[i] - x_mean) * (z[i] - z_mean));
        let variance = sum(&|i| (x[i] - x_mean) * (x[i] - x_mean));
        Self { x: x_mean, z: z_mean, slope: covariance / variance }
    }

    /// The line's height at `x`, m.
    pub fn at(&self, x: f64) -> f64 {
        self.z + self.slope * (x - self.x)
    }
}

/// Subtracts the least squares line from the heights.
pub fn remove_tilt(x: &[f64], z: &mut [f64]) {
    let line = MeanLine::through(x, z);
    z.iter_mut().zip(x).for_each(|(z, x)| *z = (*z - line.z) - line.slope * (x - line.x));
}

/// A coordinate of a point of a profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinate {
    /// Its position.
    X,
    /// Its height.
    Z,
}

/// Points that make no profile.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PointsError {
    /// What is wrong of the point.
    pub coordinate: Coordinate,
    /// The wrong point, from 0; `None` where their number is wrong.
    pub index: Option<usize>,
    /// What is allowed.
    pub expected: String,
}

/// Checks that there are enough points, that x rises and that periodic ends meet, and makes these ends exactly equal.
///
/// # Errors
/// [`PointsError`] with the first point that is wrong.
pub fn check_points(x: &[f64], z: &mut [f64], periodic: bool) -> Result<(), PointsError> {
    check_count(x.len(), periodic)?;
    check_order(x)?;
    check_steps(x)?;
    if periodic { close(z) } else { Ok(()) }
}

fn check_count(count: usize, periodic: bool) -> Result<(), PointsError> {
    let (least, what) = if periodic { (3, "a periodic profile") } else { (2, "a profile") };
    let expected = format!("at least {least} points for {what}");
    if count >= least { Ok(()) } else { Err(PointsError { coordinate: Coordinate::X, index: None, expected }) }
}

fn check_order(x: &[f64]) -> Result<(), PointsError> {
    let Some(before) = x.windows(2).position(|pair| pair[1] <= pair[0]) else { return Ok(()) };
    let (previous, here) = (x[before], x[before + 1]);
    let expected = if previous == here {
        format!("each x once, but the point before has x = {previous:?} too")
    } else {
        format!("a number > {previous:?}, the x of the point before, for x must rise")
    };
    Err(PointsError { coordinate: Coordinate::X, index: Some(before + 1), expected })
}

/// A step that is lost in the rounding of positions and heights beside the longest one has no slope.
fn check_steps(x: &[f64]) -> Result<(), PointsError> {
    /// Of the longest step: two instruments in one file are some 1e6 apart.
    const SHORTEST: f64 = 1e-12;
    let steps = || x.windows(2).map(|pair| pair[1] - pair[0]);
    let longest = steps().fold(0.0, f64::max);
    let Some(before) = steps().position(|step| step < SHORTEST * longest) else { return Ok(()) };
    let expected = format!(
        "steps along x of at least {SHORTEST:e} of the longest one, {longest:e}; that to this point is {:e}",
        x[before + 1] - x[before]
    );
    Err(PointsError { coordinate: Coordinate::X, index: Some(before + 1), expected })
}

fn close(z: &mut [f64]) -> Result<(), PointsError> {
    let height = peak_to_valley(z);
    let [first, .., last] = z else { return Ok(()) };
    if (*last - *first).abs() > ROUNDING * height {
        let expected = format!(
            "{first:?}, the first height, for a periodic profile ends at the height it starts from; \
             asperity surface --mirror makes a period of one that ends"
        );
        return Err(PointsError { coordinate: Coordinate::Z, index: Some(z.len() - 1), expected });
    }
    *last = *first;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wave of the cut-off is halved, one of half of it is left with 2^-4, a line stays but near its ends: the filter's
    /// definition; 64 points a wave are exact to 1e-9 of it.
    #[test]
    fn smoothing_halves_the_wave_of_the_cut_off() {
        let wave = |factor: i64, smoothed: f64| {
            let surface = Surface::sinusoid(1.0, 1.0, 64);
            let found = surface.smoothed(factor as f64);
            let off = surface.z.iter().zip(&found.z).map(|(before, after)| (after - smoothed * before).abs());
            assert!(off.fold(0.0, f64::max) < 1e-6, "{factor}");
            assert_eq!(found.z[0], found.z[64]);
        };
        wave(1, 0.5);
        wave(2, 0.0625);
        let x: Vec<f64> = (0..=100).map(f64::from).collect();
        let line = Surface::new(x.clone(), x, false);
        let found = line.smoothed(20.0);
        assert!((21..=79).all(|i| (found.z[i] - line.z[i]).abs() < 1e-12) && found.z[0] > 0.5);
    }
}
