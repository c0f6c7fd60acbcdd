//! Numbers of a profile: heights and slopes.

use asperity::scene::Surface;
use serde::Serialize;

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

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

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
