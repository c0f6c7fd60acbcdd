//! The power spectrum of a profile and the power law that it follows: Hurst exponent, roll-off, cut-off.

use std::f64::consts::{PI, TAU};
use std::ops::RangeInclusive;

use nalgebra::Complex;
use serde::Serialize;

use super::{HeightMap, MeanLine, Surface};
use crate::math::{FourierDirection, fourier};

/// The one-sided power spectrum C(q), whose integral over q is the mean square height.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Spacing 2π/length of the wave numbers, rad/m.
    step: f64,
    /// C at 0, 1, 2, … steps, m³.
    density: Vec<f64>,
    /// Index of the first reliable value.
    first: usize,
}

/// The mean of a spectrum over a range of wave numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SpectrumBand {
    /// Geometric mean of the wave numbers, rad/m.
    pub wave_number: f64,
    /// Mean of C, m³.
    pub density: f64,
    /// Number of wave numbers.
    pub modes: usize,
}

/// Maximum number of even points: finer detail is neither drawn nor fitted.
const MAX_POINTS: usize = 1 << 20;
const BANDS: f64 = 12.0;

impl Spectrum {
    /// The spectrum of a profile at as many even points as it has intervals. A periodic profile needs no preparation.
    /// From any other the tilt is removed, and a Hann window is applied and its loss of power (3/8) corrected; the
    /// longest wavelength is then unreliable.
    pub fn new(surface: &Surface) -> Self {
        let x = surface.x();
        let (start, length) = (x[0], x[x.len() - 1] - x[0]);
        let n = (x.len() - 1).clamp(4, MAX_POINTS);
        let (spline, line) = (surface.spline(), surface.line());
        let position = |i: usize| start + length * (i as f64 / n as f64);
        let tilt = |x: f64| if surface.is_periodic() { line.z } else { line.at(x) };
        let heights = (0..n).map(|i| spline.evaluate(position(i)).0 - tilt(position(i))).collect();
        Self::from_heights(heights, length, surface.is_periodic())
    }

    /// The spectrum of the roughness of a layer of this length (m): heights at its masses, m, as of a profile that is
    /// not periodic.
    pub(super) fn from_roughness(heights: &[f64], length: f64) -> Self {
        let x: Vec<f64> = (0..heights.len()).map(|i| i as f64 * length / heights.len() as f64).collect();
        let line = MeanLine::through(&x, heights);
        let level = |(x, z): (&f64, &f64)| if heights.len() > 1 { z - line.at(*x) } else { 0.0 };
        Self::from_heights(x.iter().zip(heights).map(level).collect(), length, false)
    }

    /// The spectrum of heights without mean and tilt, m, at even points of a length, m.
    fn from_heights(heights: Vec<f64>, length: f64, periodic: bool) -> Self {
        let n = heights.len();
        let window = |i: usize| if periodic { 1.0 } else { (PI * i as f64 / n as f64).sin().powi(2) };
        let windowed: Vec<_> = (0..n).map(|i| Complex::from(window(i) * heights[i])).collect();
        let sums = fourier(&windowed, FourierDirection::Forward);
        let step = TAU / length;
        let scale = 2.0 / (n as f64).powi(2) / step / if periodic { 1.0 } else { 0.375 };
        let density = sums[..n / 2].iter().map(|sum| scale * sum.norm_sqr()).collect();
        Self { step, density, first: if periodic { 1 } else { 2 } }
    }

    /// The mean spectrum of the lines of a map along x, each prepared as a profile is.
    pub fn of_lines(map: &HeightMap, periodic: bool) -> Self {
        let length = map.spacing()[0] * map.nx() as f64;
        let x: Vec<f64> = (0..map.nx()).map(|i| map.spacing()[0] * i as f64).collect();
        let mean_height = map.mean();
        let of_line = |j: usize| {
            let line = MeanLine::through(&x, map.line(j));
            let tilt = |x: f64| if periodic { mean_height } else { line.at(x) };
            let heights = x.iter().zip(map.line(j)).map(|(x, z)| z - tilt(*x)).collect();
            Self::from_heights(heights, length, periodic)
        };
        let mut mean = of_line(0);
        for j in 1..map.ny() {
            mean.density.iter_mut().zip(of_line(j).density).for_each(|(sum, density)| *sum += density);
        }
        mean.density.iter_mut().for_each(|sum| *sum /= map.ny() as f64);
        mean
    }

    /// The wave numbers (rad/m) of the reliable modes below half the points, and their mean square heights, m².
    pub fn modes(&self) -> impl Iterator<Item = (f64, f64)> {
        let reliable = self.density.iter().enumerate().skip(self.first);
        reliable.map(|(m, density)| (m as f64 * self.step, density * self.step))
    }

    /// The mean square slope of the waves, 1.
    pub fn slope_square(&self) -> f64 {
        self.modes().map(|(q, square)| q * q * square).sum()
    }

    /// The wavelength (m) below which there is 1 % of the mean square slope; `None` of a line without slopes.
    pub fn shortest_wavelength(&self) -> Option<f64> {
        /// Of the mean square slope.
        const NEGLIGIBLE: f64 = 0.01;
        let mut left = self.slope_square() * (1.0 - NEGLIGIBLE);
        let reached = self.modes().find(|(q, square)| {
            left -= q * q * square;
            left < 0.0
        });
        reached.map(|(q, _)| TAU / q)
    }

    /// The means over bands that are even in the logarithm; a band without a wave number is omitted.
    pub fn bands(&self) -> Vec<SpectrumBand> {
        let mut bands = Vec::new();
        let mut start = self.first;
        for i in 1.. {
            let end = (self.first as f64 * 10_f64.powf(f64::from(i) / BANDS)).round() as usize;
            let end = end.min(self.density.len());
            if end > start {
                bands.push(self.band(start, end));
                start = end;
            }
            if end == self.density.len() {
                break;
            }
        }
        bands
    }

    fn band(&self, start: usize, end: usize) -> SpectrumBand {
        let modes = end - start;
        let logarithm = (start..end).map(|m| (m as f64).ln()).sum::<f64>() / modes as f64;
        let density = self.density[start..end].iter().sum::<f64>() / modes as f64;
        SpectrumBand { wave_number: self.step * logarithm.exp(), density, modes }
    }
}

/// A spectrum that is constant up to the roll-off and falls as q^(-1-2H) above it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PowerLaw {
    /// Hurst exponent H, 1.
    pub hurst: f64,
    /// Standard error of H, from the scatter of the bands.
    pub hurst_error: f64,
    /// Wavelength 2π/q above which the spectrum is constant, m; none without a roll-off.
    pub roll_off_wavelength: Option<f64>,
    /// Shortest and longest wavelength of the power law, m.
    pub wavelengths: [f64; 2],
    /// Whether shorter wavelengths exist but deviate from the law: a cut-off, a filter or noise.
    pub ends: bool,
    /// ln of the constant part, or of C at the longest wavelength (m³).
    level: f64,
}

/// Minimum number of bands of a power law, and its minimum length in ln q: half a decade.
const MIN_BANDS: usize = 4;
const SHORTEST_SPAN: f64 = 1.15;
/// The exponent must exceed this many of its standard errors.
const SIGNIFICANT: f64 = 3.0;
/// Variance of ln C that remains for any number of modes.
const VARIANCE: f64 = 0.01;
/// Penalty of a band that the law does not cover: a band is excluded where it deviates by more than three errors.
const EXCLUDED_BAND: f64 = 9.0;
/// Penalty of a roll-off, which must explain more than chance does.
const ROLL_OFF: f64 = 6.0;
/// Candidate positions of the roll-off between two bands.
const FINE: usize = 8;

/// A band in logarithms.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// ln q
    x: f64,
    /// ln C
    y: f64,
    /// 1 over the variance.
    weight: f64,
}

/// A law fitted to the bands up to one of them.
struct LawFit {
    level: f64,
    exponent: f64,
    /// Standard error of the exponent.
    error: f64,
    /// Weighted sum of the squared residuals.
    cost: f64,
}

impl PowerLaw {
    /// The law that fits the bands best, over as many of them as possible; where `wavelengths` (m) are given, over
    /// exactly these and without a roll-off. `None` where no part follows a power law.
    pub fn fit(bands: &[SpectrumBand], wavelengths: Option<&RangeInclusive<f64>>) -> Option<Self> {
        let inside = |band: &&SpectrumBand| wavelengths.is_none_or(|range| range.contains(&(TAU / band.wave_number)));
        let seen = bands.iter().filter(inside).filter(|band| band.density > 0.0);
        let bands: Vec<Point> = seen.map(Point::new).collect();
        let mut best: Option<(f64, Self)> = None;
        let ends = if wavelengths.is_some() { bands.len().max(MIN_BANDS) } else { MIN_BANDS }..=bands.len();
        for end in ends {
            for knee in 0..if wavelengths.is_some() { 1 } else { FINE * end } {
                let Some(fit) = LawFit::new(&bands[..end], knee) else { continue };
                let penalty = EXCLUDED_BAND * (bands.len() - end) as f64 + if knee > 0 { ROLL_OFF } else { 0.0 };
                if best.as_ref().is_none_or(|(cost, _)| fit.cost + penalty < *cost) {
                    best = Some((fit.cost + penalty, fit.law(&bands, end, knee)));
                }
            }
        }
        best.map(|(_, law)| law)
    }

    /// C of the law at `wave_number` (rad/m), m³.
    pub fn density(&self, wave_number: f64) -> f64 {
        let longest = self.roll_off_wavelength.unwrap_or(self.wavelengths[1]);
        let fallen = (wave_number * longest / TAU).ln().max(0.0);
        (self.level - (1.0 + 2.0 * self.hurst) * fallen).exp()
    }
}

impl Point {
    fn new(band: &SpectrumBand) -> Self {
        let weight = 1.0 / (1.0 / band.modes as f64 + VARIANCE);
        Self { x: band.wave_number.ln(), y: band.density.ln(), weight }
    }
}

impl LawFit {
    /// ln C = level - exponent · max(0, ln q - ln q_r) by weighted least squares, with the roll-off at position `knee`.
    fn new(bands: &[Point], knee: usize) -> Option<Self> {
        let start = knee_at(bands, knee)?;
        let fallen = |band: &Point| (band.x - start).max(0.0);
        let falling = bands.iter().filter(|band| fallen(band) > 0.0).count();
        if falling + usize::from(knee == 0) < MIN_BANDS || fallen(bands.last()?) < SHORTEST_SPAN {
            return None;
        }
        let sum = |value: &dyn Fn(&Point) -> f64| bands.iter().map(|band| band.weight * value(band)).sum::<f64>();
        let whole = sum(&|_| 1.0);
        let (x, y) = (sum(&fallen) / whole, sum(&|band| band.y) / whole);
        let variance = sum(&|band| (fallen(band) - x).powi(2));
        let exponent = -sum(&|band| (fallen(band) - x) * (band.y - y)) / variance;
        let level = y + exponent * x;
        let cost = sum(&|band| (band.y - level + exponent * fallen(band)).powi(2));
        let error = variance.sqrt().recip();
        (exponent > SIGNIFICANT * error).then_some(Self { level, exponent, error, cost })
    }

    fn law(&self, bands: &[Point], end: usize, knee: usize) -> PowerLaw {
        let start = knee_at(bands, knee).unwrap_or_default().exp();
        PowerLaw {
            hurst: (self.exponent - 1.0) / 2.0,
            hurst_error: self.error / 2.0,
            roll_off_wavelength: (knee > 0).then_some(TAU / start),
            wavelengths: [TAU / bands[end - 1].x.exp(), TAU / start],
            ends: end < bands.len(),
            level: self.level,
        }
    }
}

/// ln q at a position that counts parts of 1/[`FINE`] of a band from the first band on.
fn knee_at(bands: &[Point], knee: usize) -> Option<f64> {
    let at = |i: usize| bands.get(i).map(|band| band.x);
    let (low, part) = (at(knee / FINE)?, (knee % FINE) as f64 / FINE as f64);
    if part == 0.0 { Some(low) } else { Some(low + part * (at(knee / FINE + 1)? - low)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::SplitMix64;

    fn cosine(periodic: bool, amplitude: f64) -> Surface {
        let x = (0..=1000).map(|i| f64::from(i) * 1e-6).collect();
        let z = (0..=1000).map(|i| amplitude * (TAU * f64::from(i % 25) / 25.0).cos()).collect();
        Surface::new(x, z, periodic)
    }

    /// The integral of the spectrum is the mean square height, with a window or without one.
    #[test]
    fn the_power_is_the_mean_square_height() {
        for (periodic, tolerance) in [(true, 1e-12), (false, 2e-3)] {
            let spectrum = Spectrum::new(&cosine(periodic, 2e-6));
            let power: f64 = spectrum.density.iter().sum::<f64>() * spectrum.step;
            assert!((power / 2e-12 - 1.0).abs() < tolerance, "{periodic} {power:e}");
            let peak = (0..500).max_by(|&a, &b| spectrum.density[a].total_cmp(&spectrum.density[b]));
            assert_eq!(peak, Some(40));
        }
    }

    /// The power of the lines of a periodic map about its mean is that of its heights, but for waves that are constant
    /// along x. A mean taken anew for each height made half a minute of this map.
    #[test]
    fn the_lines_of_a_large_map_hold_its_power() {
        let heights = (0..512 * 512).map(|at| 3.0 + (TAU * f64::from(at % 512 + 2 * (at / 512)) / 64.0).sin());
        let map = HeightMap::new(512, [1e-3, 1e-3], heights.collect());
        let power: f64 = Spectrum::of_lines(&map, true).modes().map(|(_, square)| square).sum();
        assert!((power / 0.5 - 1.0).abs() < 1e-12, "{power}");
    }

    #[test]
    fn bands_hold_every_mode_once() {
        let spectrum = Spectrum { step: 1.0, density: vec![1.0; 500], first: 2 };
        let bands = spectrum.bands();
        assert_eq!(bands.iter().map(|band| band.modes).sum::<usize>(), 498);
        assert!(bands.iter().all(|band| (band.density - 1.0).abs() < 1e-12));
        assert!(bands.windows(2).all(|pair| pair[0].wave_number < pair[1].wave_number));
    }

    /// 12 bands per decade from 10 rad/m: constant up to `q_r`, falling with H up to `q_c`, negligible beyond.
    fn bands(hurst: f64, q_r: f64, q_c: f64, noise: f64) -> Vec<SpectrumBand> {
        let mut random = SplitMix64::new(1);
        let band = |i: u32| {
            let wave_number = 10_f64.powf(1.0 + f64::from(i) / 12.0);
            let modes = (wave_number / 60.0).ceil() as usize;
            let scatter = noise * (random.unit() - 0.5) / (modes as f64).sqrt();
            let law = (wave_number / q_r).max(1.0).powf(-1.0 - 2.0 * hurst);
            let density = 1e-12 * law * scatter.exp() * if wave_number > q_c { 1e-9 } else { 1.0 };
            SpectrumBand { wave_number, density, modes }
        };
        (0..48).map(band).collect()
    }

    #[test]
    fn the_exponent_and_its_range_are_found() {
        for hurst in [0.3, 0.8, 1.0] {
            let law = PowerLaw::fit(&bands(hurst, 200.0, 3e4, 0.0), None).unwrap();
            assert!((law.hurst - hurst).abs() < 0.005, "{law:?}");
            assert!((law.roll_off_wavelength.unwrap() / (TAU / 200.0) - 1.0).abs() < 0.05, "{law:?}");
            assert!(law.ends && (law.wavelengths[0] / (TAU / 3e4) - 1.0).abs() < 0.25, "{law:?}");
            assert!((law.density(100.0) / 1e-12 - 1.0).abs() < 0.02, "{law:?}");
        }
        let law = PowerLaw::fit(&bands(0.6, 1.0, 1e9, 0.0), None).unwrap();
        assert!(law.roll_off_wavelength.is_none() && !law.ends, "{law:?}");
        assert!((law.hurst - 0.6).abs() < 0.001, "{law:?}");
    }

    #[test]
    fn scatter_moves_it_by_its_error() {
        let law = PowerLaw::fit(&bands(0.8, 200.0, 1e9, 1.0), None).unwrap();
        assert!((law.hurst - 0.8).abs() < 3.0 * law.hurst_error && law.hurst_error < 0.03, "{law:?}");
    }

    #[test]
    fn a_range_can_be_given_and_a_constant_is_no_law() {
        let asked = 5e-4..=5e-3;
        let law = PowerLaw::fit(&bands(0.8, 200.0, 3e4, 0.0), Some(&asked)).unwrap();
        assert!((law.hurst - 0.8).abs() < 0.005 && law.wavelengths.iter().all(|length| asked.contains(length)));
        assert!(PowerLaw::fit(&bands(0.8, 1e9, 1e9, 0.0), None).is_none());
        assert!(PowerLaw::fit(&[], None).is_none());
    }
}
