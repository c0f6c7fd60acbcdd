//! Heights and slopes of a profile.

use asperity::scene::Surface;
use serde::Serialize;

/// Numbers on a profile, SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Statistics {
    /// Data points.
    pub(super) points: usize,
    /// From the first point to the last; the period of a periodic profile.
    pub(super) length: f64,
    /// The shortest and the longest step from point to point.
    pub(super) steps: [f64; 2],
    pub(super) periodic: bool,
    pub(super) mean_height: f64,
    /// Slope of the least squares line.
    pub(super) tilt: f64,
    /// Root mean square height about the mean.
    pub(super) rms_height: f64,
    /// The same about the least squares line.
    pub(super) rms_height_without_tilt: f64,
    pub(super) peak_to_valley: f64,
    /// Root mean square slope of the spline, with the tilt.
    pub(super) rms_slope: f64,
    /// The spline's largest slope.
    pub(super) largest_slope: f64,
}

/// Gauss and Legendre's places and weights on 0 to 1: exact for the square of a cubic's slope.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// Steps that differ by less than this part of themselves are even: places have their roundings.
const EVEN: f64 = 0.02;

impl Statistics {
    pub(super) fn of(surface: &Surface) -> Self {
        let (x, z) = (&surface.x, &surface.z);
        let spline = surface.spline();
        let line = surface.line();
        let length = x[x.len() - 1] - x[0];
        let mean_square = |height: &dyn Fn(usize) -> f64| trapezoid(x, |i| height(i).powi(2)) / length;
        let squares = x.windows(2).map(|ends| {
            let step = ends[1] - ends[0];
            step * GAUSS.iter().map(|(at, weight)| weight * spline.evaluate(ends[0] + at * step).1.powi(2)).sum::<f64>()
        });
        let steps = x.windows(2).map(|ends| ends[1] - ends[0]);
        let (highest, lowest) = z.iter().fold((f64::MIN, f64::MAX), |(high, low), &z| (z.max(high), z.min(low)));
        Self {
            points: x.len(),
            length,
            steps: steps.fold([f64::MAX, 0.0], |[low, high], step| [step.min(low), step.max(high)]),
            periodic: surface.periodic,
            mean_height: line.z,
            tilt: line.slope,
            rms_height: mean_square(&|i| z[i] - line.z).sqrt(),
            rms_height_without_tilt: mean_square(&|i| z[i] - line.at(x[i])).sqrt(),
            peak_to_valley: highest - lowest,
            rms_slope: (squares.sum::<f64>() / length).sqrt(),
            largest_slope: spline.bounds().slope_max_abs,
        }
    }

    pub(super) fn is_even(&self) -> bool {
        let [shortest, longest] = self.steps;
        longest - shortest <= EVEN * longest
    }
}

/// The integral over x by straight lines between the points: over a whole period at even points as exact as can be.
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
        let numbers = Statistics::of(&Surface { x, z, periodic: true });
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
        let numbers = Statistics::of(&Surface { x, z, periodic: false });
        assert!((numbers.tilt - 0.25).abs() < 1e-15 && (numbers.rms_slope - 0.25).abs() < 1e-15);
        assert!(numbers.rms_height_without_tilt < 1e-15 && !numbers.is_even());
    }
}
