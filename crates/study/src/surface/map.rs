//! The analysis of a map: heights and gradients, its isotropic spectrum, Hurst exponents along both directions.

use std::ops::RangeInclusive;

use asperity::scene::{HeightMap, PowerLaw, Spectrum, Surface, peak_to_valley};
use serde::Serialize;

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
    pub(super) fn of(surface: &Surface, wavelengths: Option<&RangeInclusive<f64>>) -> Option<Self> {
        let (map, periodic) = (surface.map()?, surface.is_periodic());
        let turned = map.transposed();
        let law = |map: &HeightMap| PowerLaw::fit(&Spectrum::of_lines(map, periodic).bands(), wavelengths);
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
