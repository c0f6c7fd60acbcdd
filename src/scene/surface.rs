//! The rigid surface: the data points of its profile, what they must satisfy, the lines through them; and random
//! surfaces with a given power spectrum.

use std::f64::consts::{LN_2, PI, SQRT_2, TAU};
use std::sync::Arc;

use nalgebra::Complex;
use serde::Serialize;

use super::values::{LARGEST, SMALLEST};
use crate::math::{Direction, Spline, SplitMix64, fourier};

/// The largest slope of a profile: a step of a metre from one atom to the next has less, and its square times that of
/// the largest speed does not overflow.
const STEEPEST: f64 = 1e12;

/// Periodic ends may differ by rounding: by this part of the peak-to-valley height.
const ROUNDING: f64 = 1.0e-12;

/// The rigid profile: its data points and the spline through them, which copies share.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Surface {
    x: Vec<f64>,
    z: Vec<f64>,
    periodic: bool,
    #[serde(skip)]
    self_affine: Option<SelfAffine>,
    #[serde(skip)]
    spline: Arc<Spline>,
}

impl Surface {
    /// The profile through the points (x, z), m: at least two, `x` strictly rising. A periodic one is repeated without
    /// end, and its last height equals the first; any other is continued along its end tangents.
    ///
    /// # Panics
    /// With fewer than two points.
    pub fn new(x: Vec<f64>, z: Vec<f64>, periodic: bool) -> Self {
        let spline = Arc::new(if periodic { Spline::periodic(&x, &z) } else { Spline::natural(&x, &z) });
        Self { x, z, periodic, self_affine: None, spline }
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

    /// The power law that it was made of; `None` for every other profile.
    pub fn self_affine(&self) -> Option<SelfAffine> {
        self.self_affine
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

    /// Checks that slopes and curvatures of the spline are numbers that can be worked with, or says what they must be.
    pub(super) fn check_slopes(&self) -> Result<(), String> {
        let bounds = self.spline.bounds();
        let closest = self.x.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        let possible = bounds.slope_max_abs <= STEEPEST && bounds.curvature_max_abs <= LARGEST;
        if !(self.spline.is_finite() && possible) {
            return Err(format!(
                "points with a spline of slopes up to {STEEPEST:e} and curvatures up to {LARGEST:e} 1/m"
            ));
        }
        if closest < SMALLEST {
            return Err(format!("points at least {SMALLEST:e} m apart along x, not {closest:e} m"));
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
        Self::new(self.x.clone(), heights, self.periodic)
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
pub(super) fn remove_tilt(x: &[f64], z: &mut [f64]) {
    let line = MeanLine::through(x, z);
    z.iter_mut().zip(x).for_each(|(z, x)| *z = (*z - line.z) - line.slope * (x - line.x));
}

/// Highest minus lowest, m; 0 for no heights.
pub fn peak_to_valley(heights: &[f64]) -> f64 {
    let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
    (highest - lowest).max(0.0)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coordinate {
    X,
    Z,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct PointsError {
    pub(super) coordinate: Coordinate,
    /// The wrong point, from 0; `None` where their number is wrong.
    pub(super) index: Option<usize>,
    pub(super) expected: String,
}

/// Checks that there are enough points, that x rises and that periodic ends meet, and makes these ends exactly equal.
pub(super) fn check_points(x: &[f64], z: &mut [f64], periodic: bool) -> Result<(), PointsError> {
    check_count(x.len(), periodic)?;
    check_order(x)?;
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

fn close(z: &mut [f64]) -> Result<(), PointsError> {
    let height = peak_to_valley(z);
    let [first, .., last] = z else { return Ok(()) };
    if (*last - *first).abs() > ROUNDING * height {
        let expected = format!("{first:?}, the first height, for a periodic profile ends at the height it starts from");
        return Err(PointsError { coordinate: Coordinate::Z, index: Some(z.len() - 1), expected });
    }
    *last = *first;
    Ok(())
}

/// A number of modes that is whole but for rounding is that number.
const WHOLE: f64 = 1.0e-9;

/// A periodic profile whose one-sided power spectrum is constant up to q_r = 2π/roll-off, falls as q^(-1-2H) up to
/// q_c = 2π/cut-off and is 0 beyond.
///
/// It is a sum over the modes m = 1, 2, … of the wave numbers q = 2πm/length,
///
/// z(x) = Σ a_m cos(q x + φ_m),   a_m² ∝ the spectrum at q,   φ_m = 2π · the m-th number of [`SplitMix64`] from the
/// seed,
///
/// at even points, scaled to the root mean square height. So every mode has exactly its share of the power, the same
/// seed gives the same bits everywhere, and more points the same profile with more points; a shorter cut-off adds modes
/// and leaves the phases of the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SelfAffine {
    /// Period, m.
    pub length: f64,
    /// Even intervals of a period.
    pub points: usize,
    /// Hurst exponent H, 1.
    pub hurst: f64,
    /// Root mean square height over one period, about a mean of 0, m.
    pub rms: f64,
    /// Wavelength above which the spectrum is constant, m.
    pub roll_off: f64,
    /// The shortest wavelength, m.
    pub cut_off: f64,
    /// Seed of the random phases.
    pub seed: u64,
}

impl SelfAffine {
    pub(super) fn surface(&self) -> Surface {
        let share = |i| i as f64 / self.points as f64;
        let x = (0..=self.points).map(|i| self.length * share(i)).collect();
        let mut z = self.heights();
        z.push(z[0]);
        Surface { self_affine: Some(*self), ..Surface::new(x, z, true) }
    }

    /// The heights at the points of one period, m.
    fn heights(&self) -> Vec<f64> {
        let sums = fourier(&self.coefficients(), Direction::Backward);
        let mean = sums.iter().map(|sum| sum.re).sum::<f64>() / self.points as f64;
        let mut z: Vec<f64> = sums.iter().map(|sum| sum.re - mean).collect();
        let scale = self.rms / (z.iter().map(|z| z * z).sum::<f64>() / self.points as f64).sqrt();
        z.iter_mut().for_each(|z| *z *= scale);
        z
    }

    /// The coefficients of e^(2πi nm/points), but for a common factor.
    fn coefficients(&self) -> Vec<Complex<f64>> {
        let mut coefficients = vec![Complex::from(0.0); self.points];
        let mut random = SplitMix64::new(self.seed);
        for m in 1..=self.modes() {
            let (sine, cosine) = libm::sincos(TAU * random.unit());
            let amplitude = self.power(m).sqrt();
            if 2 * m < self.points {
                coefficients[m] = Complex::new(amplitude * cosine, amplitude * sine);
                coefficients[self.points - m] = coefficients[m].conj();
            } else {
                // With two points a wavelength the phase is not resolved: the amplitude has the mean power of all
                // phases.
                coefficients[m] = Complex::from(SQRT_2 * amplitude.copysign(cosine));
            }
        }
        coefficients
    }

    /// The last mode below the cut-off.
    fn modes(&self) -> usize {
        let modes = self.length / self.cut_off * (1.0 + WHOLE);
        (modes as usize).min(self.points / 2)
    }

    /// The spectrum below the roll-off, m³.
    pub(super) fn plateau(&self) -> f64 {
        let powers: f64 = (1..=self.modes()).map(|m| self.power(m)).sum();
        self.rms * self.rms / powers / (TAU / self.length)
    }

    /// The power of mode m over that of a mode below the roll-off.
    fn power(&self, m: usize) -> f64 {
        let ratio = m as f64 * self.roll_off / self.length;
        if ratio > 1.0 { libm::pow(ratio, -1.0 - 2.0 * self.hurst) } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUGH: SelfAffine =
        SelfAffine { length: 0.1, points: 4000, hurst: 0.8, rms: 2e-5, roll_off: 5e-3, cut_off: 1e-4, seed: 7 };

    /// The mean square heights of the modes, from the heights at the points.
    fn powers(profile: &SelfAffine) -> Vec<f64> {
        let heights: Vec<_> = profile.heights().into_iter().map(Complex::from).collect();
        let n = profile.points as f64;
        let sums = fourier(&heights, Direction::Forward);
        let power = |m: usize| if 2 * m == profile.points { 1.0 } else { 2.0 } * (sums[m] / n).norm_sqr();
        (0..=profile.points / 2).map(power).collect()
    }

    fn rms(heights: &[f64]) -> f64 {
        (heights.iter().map(|z| z * z).sum::<f64>() / heights.len() as f64).sqrt()
    }

    /// Every mode has the power that the spectrum says: 20 modes on the plateau, then as q^(-2.6) to mode 1000, none
    /// beyond. A wave of the cut-off is halved, one of half of it is left with 2^-4, a line stays but near its ends:
    /// the filter's definition; 64 points a wave are exact to 1e-9 of it.
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

    #[test]
    fn the_spectrum_is_what_was_asked() {
        let powers = powers(&ROUGH);
        let formula = |m: usize| match m {
            0 => 0.0,
            1..=20 => 1.0,
            21..=1000 => (m as f64 / 20.0).powf(-2.6),
            _ => 0.0,
        };
        let whole: f64 = (0..=2000).map(formula).sum();
        for (m, power) in powers.iter().enumerate() {
            let asked = 2e-5_f64.powi(2) * formula(m) / whole;
            // Roundings of a transform of 4000 heights, whose power is 4e-10.
            assert!((power - asked).abs() < 1e-12 * asked + 1e-34, "{m}: {power:e} for {asked:e}");
        }
    }

    /// The periodogram in bands, as an instrument's software would take it: within the 2 % that were asked for.
    #[test]
    fn bands_of_the_spectrum_have_their_power() {
        let powers = powers(&SelfAffine { points: 1 << 14, ..ROUGH });
        let band = |from: usize, to: usize| powers[from..to].iter().sum::<f64>() / (to - from) as f64;
        let plateau = band(1, 21);
        for (from, to) in [(40, 44), (100, 110), (400, 440), (900, 990)] {
            let middle = ((from * (to - 1)) as f64).sqrt();
            let asked = plateau * (middle / 20.0).powf(-2.6);
            assert!((band(from, to) / asked - 1.0).abs() < 0.02, "{from} to {to}");
        }
    }

    #[test]
    fn the_heights_have_their_root_mean_square_about_0_and_the_ends_meet() {
        for points in [2000, 2001, 4096, 7919] {
            let surface = SelfAffine { points, ..ROUGH }.surface();
            assert_eq!((surface.x.len(), surface.x[0], surface.x[points]), (points + 1, 0.0, 0.1));
            assert!(surface.periodic && surface.z[0] == surface.z[points]);
            let heights = &surface.z[..points];
            // Roundings of sums of some thousand heights.
            assert!((rms(heights) / 2e-5 - 1.0).abs() < 1e-13, "{points}");
            assert!((heights.iter().sum::<f64>() / points as f64).abs() < 1e-18, "{points}");
        }
    }

    /// The slope of the spline through 10 points a shortest wavelength is that of the sum of cosines.
    #[test]
    fn the_slope_is_that_of_the_spectrum() {
        let profile = SelfAffine { points: 10_000, ..ROUGH };
        let (powers, q) = (powers(&profile), |m: usize| TAU * m as f64 / 0.1);
        let formula = powers.iter().enumerate().map(|(m, power)| power * q(m) * q(m)).sum::<f64>().sqrt();
        let surface = profile.surface();
        let spline = surface.spline();
        let slopes: Vec<f64> = (0..40_000).map(|i| spline.evaluate(0.1 * i as f64 / 40_000.0).1).collect();
        // A cubic spline is wrong by (q h)⁴/120, that is 1e-3, at the shortest wavelength.
        assert!((rms(&slopes) / formula - 1.0).abs() < 1e-3, "{} {formula}", rms(&slopes));
    }

    /// More points are the same profile; a seed is a profile.
    #[test]
    fn a_seed_is_one_profile() {
        let coarse = ROUGH.heights();
        let fine = SelfAffine { points: 12_000, ..ROUGH }.heights();
        let largest = coarse.iter().zip(fine.iter().step_by(3)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // Roundings of sums of 1000 cosines.
        assert!(largest < 1e-17, "{largest}");
        let other = SelfAffine { seed: 8, ..ROUGH }.heights();
        let alike: f64 = coarse.iter().zip(&other).map(|(a, b)| a * b).sum::<f64>() / (4000.0 * 4e-10);
        // Of two profiles with independent phases; with 20 modes of most power 0.2 would be usual.
        assert!(alike.abs() < 0.7, "{alike}");
    }

    /// Two points a wavelength are enough.
    #[test]
    fn the_cut_off_may_lie_where_two_points_see_it() {
        for points in [2000, 2001] {
            let profile = SelfAffine { points, ..ROUGH };
            assert_eq!(profile.modes(), 1000);
            let powers = powers(&profile);
            let asked = powers[500] * 2_f64.powf(-2.6);
            assert!((powers[1000] / asked - 1.0).abs() < 1e-10, "{points}");
        }
    }

    /// The bits of a few heights and of their sum, as they come out on every platform.
    ///
    /// The values are those of a program of its own in Python, which sums the cosines one by one with 40 digits: this
    /// one is right to its last digits, and the bits say that the next platform, compiler or change gives the same.
    #[test]
    fn a_seed_gives_the_same_bits_everywhere() {
        let profile = SelfAffine { points: 300, length: 0.03, roll_off: 1e-2, cut_off: 3e-4, ..ROUGH };
        let heights = profile.heights();
        for (i, value) in PYTHON {
            // Roundings of a transform of 300 values of size 2e-5.
            assert!((heights[i] - value).abs() < 3e-20, "{i}: {:e} for {value:e}", heights[i]);
        }
        let digest = heights.iter().fold(0_u64, |digest, z| digest.rotate_left(5) ^ z.to_bits());
        assert_eq!(digest, DIGEST, "{digest:#x}");
    }

    const PYTHON: [(usize, f64); 4] = [
        (0, -5.518007025855965e-07),
        (1, -1.9030598303507189e-06),
        (150, 6.461100995468687e-06),
        (299, 1.2072049374252627e-06),
    ];
    const DIGEST: u64 = 0x4ab4_bc22_f39d_1d48;
}
