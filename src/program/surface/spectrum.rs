//! The power spectrum of a profile.

use std::f64::consts::{PI, TAU};

use asperity::math::{Direction, fourier};
use asperity::scene::Surface;
use nalgebra::Complex;
use serde::Serialize;

/// The one-sided power spectrum C(q): its integral over q is the mean square height.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Spectrum {
    /// The distance 2π/length of the wave numbers, 1/m.
    step: f64,
    /// C at 0, 1, 2, … steps, m³.
    density: Vec<f64>,
    /// The first that can be trusted.
    first: usize,
}

/// The mean of a spectrum over some wave numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Band {
    /// The geometric mean of its wave numbers, rad/m.
    pub(super) wave_number: f64,
    /// The mean of C, m³.
    pub(super) density: f64,
    /// How many there are.
    pub(super) modes: usize,
}

/// Even points at most: more are a finer profile than is drawn or judged.
const MOST_POINTS: usize = 1 << 20;
/// Bands of a power of ten.
const BANDS: f64 = 12.0;

impl Spectrum {
    /// The spectrum of a profile at as many even points as it has intervals. A periodic profile is taken as it is. Of
    /// another one the tilt is removed, and its ends fade out under a Hann window, whose loss of power (3/8) is made up
    /// for; the longest wavelength is then lost.
    pub(super) fn of(surface: &Surface) -> Self {
        let x = &surface.x;
        let (start, length) = (x[0], x[x.len() - 1] - x[0]);
        let n = (x.len() - 1).clamp(4, MOST_POINTS);
        let (spline, line) = (surface.spline(), surface.line());
        let place = |i: usize| start + length * (i as f64 / n as f64);
        let window = |i: usize| if surface.periodic { 1.0 } else { (PI * i as f64 / n as f64).sin().powi(2) };
        let tilt = |x: f64| if surface.periodic { line.z } else { line.at(x) };
        let heights = (0..n).map(|i| Complex::from(window(i) * (spline.evaluate(place(i)).0 - tilt(place(i)))));
        let sums = fourier(&heights.collect::<Vec<_>>(), Direction::Forward);
        let step = TAU / length;
        let scale = 2.0 / (n as f64).powi(2) / step / if surface.periodic { 1.0 } else { 0.375 };
        let density = sums[..n / 2].iter().map(|sum| scale * sum.norm_sqr()).collect();
        Self { step, density, first: if surface.periodic { 1 } else { 2 } }
    }

    /// The bands, even in the logarithm; none without a wave number.
    pub(super) fn bands(&self) -> Vec<Band> {
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

    fn band(&self, start: usize, end: usize) -> Band {
        let modes = end - start;
        let logarithm = (start..end).map(|m| (m as f64).ln()).sum::<f64>() / modes as f64;
        let density = self.density[start..end].iter().sum::<f64>() / modes as f64;
        Band { wave_number: self.step * logarithm.exp(), density, modes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cosine(periodic: bool, amplitude: f64) -> Surface {
        let x = (0..=1000).map(|i| f64::from(i) * 1e-6).collect();
        let z = (0..=1000).map(|i| amplitude * (TAU * f64::from(i % 25) / 25.0).cos()).collect();
        Surface { x, z, periodic }
    }

    /// The integral of the spectrum is the mean square height, with a window or without one.
    #[test]
    fn the_power_is_the_mean_square_height() {
        for (periodic, tolerance) in [(true, 1e-12), (false, 2e-3)] {
            let spectrum = Spectrum::of(&cosine(periodic, 2e-6));
            let power: f64 = spectrum.density.iter().sum::<f64>() * spectrum.step;
            assert!((power / 2e-12 - 1.0).abs() < tolerance, "{periodic} {power:e}");
            let peak = (0..500).max_by(|&a, &b| spectrum.density[a].total_cmp(&spectrum.density[b]));
            assert_eq!(peak, Some(40));
        }
    }

    #[test]
    fn bands_hold_every_mode_once() {
        let spectrum = Spectrum { step: 1.0, density: vec![1.0; 500], first: 2 };
        let bands = spectrum.bands();
        assert_eq!(bands.iter().map(|band| band.modes).sum::<usize>(), 498);
        assert!(bands.iter().all(|band| (band.density - 1.0).abs() < 1e-12));
        assert!(bands.windows(2).all(|pair| pair[0].wave_number < pair[1].wave_number));
    }
}
