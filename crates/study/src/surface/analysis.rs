//! The analysis of a surface: heights and slopes of a profile, heights, gradients and the isotropic spectrum of a map, power
//! laws and Hurst exponents, and what smoothing and splitting take away.

use std::f64::consts::TAU;

use asperity::scene::{HeightMap, PowerLaw, RoughnessSpectrum, Spectrum, SpectrumBand, Surface, peak_to_valley};
use serde::Serialize;

use super::options::Wavelengths;
use super::roughness::Roughness;

/// Heights and slopes of a profile, in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ProfileStatistics {
    /// How many points it has.
    pub points: usize,
    /// Distance from the first point to the last: the period, if the profile is periodic.
    pub length: f64,
    /// Shortest and longest step between points.
    pub steps: [f64; 2],
    /// Whether it is periodic.
    pub periodic: bool,
    /// The mean height.
    pub mean_height: f64,
    /// Slope of the least squares line.
    pub tilt: f64,
    /// Root mean square height about the mean.
    pub rms_height: f64,
    /// Root mean square height about the least squares line.
    pub rms_height_without_tilt: f64,
    /// From the lowest point to the highest.
    pub peak_to_valley: f64,
    /// Root mean square slope of the spline, including the tilt.
    pub rms_slope: f64,
    /// Largest absolute slope of the spline.
    pub largest_slope: f64,
}

/// Relative difference below which steps count as even: positions are rounded.
const EVEN: f64 = 0.02;

impl ProfileStatistics {
    /// Of a profile.
    pub fn of(surface: &Surface) -> Self {
        let (x, z) = (surface.x(), surface.z());
        let line = surface.line();
        let length = x[x.len() - 1] - x[0];
        let mean_square = |height: &dyn Fn(usize) -> f64| trapezoid(x, |i| height(i).powi(2)) / length;
        let steps = x.windows(2).map(|ends| ends[1] - ends[0]);
        let (highest, lowest) = z.iter().fold((f64::MIN, f64::MAX), |(high, low), &z| (z.max(high), z.min(low)));
        Self {
            points: x.len(),
            length,
            steps: steps.fold([f64::MAX, 0.0], |[low, high], step| [step.min(low), step.max(high)]),
            periodic: surface.is_periodic(),
            mean_height: line.z,
            tilt: line.slope,
            rms_height: mean_square(&|i| z[i] - line.z).sqrt(),
            rms_height_without_tilt: mean_square(&|i| z[i] - line.at(x[i])).sqrt(),
            peak_to_valley: highest - lowest,
            rms_slope: surface.rms_slope(),
            largest_slope: surface.spline().bounds().slope_max_abs,
        }
    }

    /// Whether the points are evenly spaced but for rounding.
    pub fn is_even(&self) -> bool {
        let [shortest, longest] = self.steps;
        longest - shortest <= EVEN * longest
    }
}

/// The integral over x by the trapezoidal rule, which is spectrally accurate over a whole period at even points.
fn trapezoid(x: &[f64], value: impl Fn(usize) -> f64) -> f64 {
    (1..x.len()).map(|i| 0.5 * (x[i] - x[i - 1]) * (value(i) + value(i - 1))).sum()
}

/// Numbers of a map, in SI units; pairs are along x and along y.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapAnalysis {
    /// How many points there are.
    pub points: [usize; 2],
    /// Their distances.
    pub steps: [f64; 2],
    /// The periods, if the map is periodic.
    pub lengths: [f64; 2],
    /// The mean height.
    pub mean_height: f64,
    /// Slopes of the least squares plane.
    pub tilt: [f64; 2],
    /// Root mean square height about the mean.
    pub rms_height: f64,
    /// From the lowest point to the highest.
    pub peak_to_valley: f64,
    /// Root mean square gradient of splines along all lines and columns.
    pub rms_gradient: f64,
    /// The power laws that the mean spectra of the lines and of the columns follow.
    pub laws: [Option<PowerLaw>; 2],
    /// q (rad/m) and C (m⁴) of the isotropic spectrum, ⟨h²⟩ = 2π ∫ q C dq.
    pub spectrum: Vec<[f64; 2]>,
}

impl MapAnalysis {
    /// Of the map that a surface is a line of, if it is.
    pub(super) fn of(surface: &Surface, wavelengths: Option<Wavelengths>) -> Option<Self> {
        let (map, periodic) = (surface.map()?, surface.is_periodic());
        let turned = map.transposed();
        let law = |map: &HeightMap| fitted(&Spectrum::of_lines(map, periodic).bands(), wavelengths);
        let (points, steps) = ([map.nx(), map.ny()], map.spacing());
        Some(Self {
            points,
            steps,
            lengths: [0, 1].map(|axis| (points[axis] - usize::from(!periodic)) as f64 * steps[axis]),
            mean_height: map.mean(),
            tilt: map.tilt(),
            rms_height: map.rms_height(),
            peak_to_valley: peak_to_valley(map.heights()),
            rms_gradient: map.rms_gradient(periodic),
            laws: [law(map), law(&turned)],
            spectrum: map.spectrum(periodic).map_or_else(Vec::new, |spectrum| spectrum.points().to_vec()),
        })
    }
}

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

/// The power law of a spectrum within some wavelengths, or where it follows one.
fn fitted(bands: &[SpectrumBand], wavelengths: Option<Wavelengths>) -> Option<PowerLaw> {
    PowerLaw::fit(bands, wavelengths.map(|[shortest, longest]| shortest..=longest).as_ref())
}

/// A relative difference of wave numbers that counts as rounding.
const ROUNDING: f64 = 1e-9;

/// The analysis of a profile, as JSON has it.
#[derive(Debug, Serialize)]
pub struct SurfaceAnalysis {
    /// Heights and slopes.
    #[serde(flatten)]
    pub statistics: ProfileStatistics,
    /// What drawings say; `None` where it is too short, or its points are too far apart.
    pub roughness: Option<Roughness>,
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
    pub fn of(surface: &Surface, wavelengths: Option<Wavelengths>) -> Self {
        let statistics = ProfileStatistics::of(surface);
        let bands = Spectrum::new(surface).bands();
        let law = fitted(&bands, wavelengths);
        let points = if statistics.is_even() { "" } else { "at even points of the spline, " };
        let window =
            if surface.is_periodic() { "over one period, as it is" } else { "without tilt, under a Hann window" };
        let map = MapAnalysis::of(surface, wavelengths);
        let (roughness, taken) = (Roughness::of(surface), format!("{points}{window}"));
        Self { statistics, roughness, removed: None, finer: None, map, law, taken, spectrum: bands }
    }

    /// Wave numbers (rad/m) and densities (m³) of the power law, at the bands of the spectrum down to its shortest wave;
    /// none without one.
    pub fn law_curve(&self) -> Vec<[f64; 2]> {
        let Some(law) = self.law else { return Vec::new() };
        let covered = self.spectrum.iter().map(|band| band.wave_number);
        covered.filter(|q| q * law.wavelengths[0] <= TAU * (1.0 + ROUNDING)).map(|q| [q, law.density(q)]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cosine_has_its_known_numbers() {
        let x: Vec<f64> = (0..=1000).map(|i| f64::from(i) * 1e-6).collect();
        let z: Vec<f64> = (0..=1000).map(|i| 2e-6 * (TAU * f64::from(i % 250) / 250.0).cos() + 1e-6).collect();
        let numbers = ProfileStatistics::of(&Surface::new(x, z, true));
        let slope = 2e-6 * TAU / 250e-6;
        // The spline through 250 points a wavelength is wrong by some 1e-8 of its slope.
        let near = |found: f64, exact: f64| assert!((found / exact - 1.0).abs() < 1e-7, "{found} {exact}");
        near(numbers.rms_height, 2e-6 / 2_f64.sqrt());
        near(numbers.peak_to_valley, 4e-6);
        near(numbers.rms_slope, slope / 2_f64.sqrt());
        near(numbers.largest_slope, slope);
        near(numbers.mean_height, 1e-6);
        assert!(numbers.is_even() && numbers.tilt.abs() < 1e-5);
    }

    #[test]
    fn a_ramp_is_all_tilt() {
        let x = vec![0.0, 1.0, 4.0, 5.0];
        let z = x.iter().map(|x| 0.25 * x).collect();
        let numbers = ProfileStatistics::of(&Surface::new(x, z, false));
        assert!((numbers.tilt - 0.25).abs() < 1e-15 && (numbers.rms_slope - 0.25).abs() < 1e-15);
        assert!(numbers.rms_height_without_tilt < 1e-15 && !numbers.is_even());
    }
}
