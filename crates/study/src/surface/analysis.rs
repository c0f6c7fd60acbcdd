//! The analysis of a surface, and of what smoothing and splitting take away.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use asperity::scene::{PowerLaw, RoughnessSpectrum, Spectrum, SpectrumBand, Surface};
use serde::Serialize;

use super::map::MapAnalysis;
use super::profile::ProfileStatistics;

/// What smoothing took away, in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Removed {
    /// The wavelength that the filter halves.
    pub cut_off: f64,
    /// Root mean square slope of the difference.
    pub rms_slope: f64,
}

impl Removed {
    pub(super) fn of(read: &Surface, smoothed: &Surface, cut_off: f64) -> Self {
        let z = read.z().iter().zip(smoothed.z()).map(|(before, after)| before - after).collect();
        let difference = Surface::new(smoothed.x().to_vec(), z, smoothed.is_periodic());
        Self { cut_off, rms_slope: ProfileStatistics::of(&difference).rms_slope }
    }
}

/// The waves that splitting took away, of an isotropic surface with such lines, in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FinerWaves {
    /// The longest and the shortest of them.
    pub wavelengths: [f64; 2],
    /// Root mean square height.
    pub rms_height: f64,
    /// Root mean square gradient.
    pub rms_gradient: f64,
}

impl FinerWaves {
    pub(super) fn of(spectrum: &RoughnessSpectrum) -> Self {
        Self {
            wavelengths: spectrum.wavelengths(),
            rms_height: spectrum.rms_height(),
            rms_gradient: spectrum.rms_gradient(),
        }
    }
}

/// A relative difference of wave numbers that counts as rounding.
const ROUNDING: f64 = 1e-9;

/// The analysis of a profile, as JSON has it.
#[derive(Debug, Serialize)]
pub struct SurfaceAnalysis {
    /// Heights and slopes.
    #[serde(flatten)]
    pub statistics: ProfileStatistics,
    /// What smoothing or splitting took away.
    pub removed: Option<Removed>,
    /// The waves that splitting took away.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub finer: Option<FinerWaves>,
    /// The map that the profile is a line of.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map: Option<MapAnalysis>,
    /// The power law that the spectrum follows.
    pub law: Option<PowerLaw>,
    /// How the spectrum was computed.
    pub taken: String,
    /// The spectrum, by bands.
    pub spectrum: Vec<SpectrumBand>,
}

impl SurfaceAnalysis {
    /// Of a surface; the power law within `wavelengths` (m), or where the spectrum follows one.
    pub fn of(surface: &Surface, wavelengths: Option<&RangeInclusive<f64>>) -> Self {
        let statistics = ProfileStatistics::of(surface);
        let bands = Spectrum::new(surface).bands();
        let law = PowerLaw::fit(&bands, wavelengths);
        let points = if statistics.is_even() { "" } else { "at even points of the spline, " };
        let window =
            if surface.is_periodic() { "over one period, as it is" } else { "without tilt, under a Hann window" };
        let map = MapAnalysis::of(surface, wavelengths);
        Self { statistics, removed: None, finer: None, map, law, taken: format!("{points}{window}"), spectrum: bands }
    }

    /// Wave numbers (rad/m) and densities (m³) of the power law, at the bands of the spectrum down to its shortest wave;
    /// none without one.
    pub fn law_curve(&self) -> Vec<[f64; 2]> {
        let Some(law) = self.law else { return Vec::new() };
        let covered = self.spectrum.iter().map(|band| band.wave_number);
        covered.filter(|q| q * law.wavelengths[0] <= TAU * (1.0 + ROUNDING)).map(|q| [q, law.density(q)]).collect()
    }
}
