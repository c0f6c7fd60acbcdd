//! The analysis of a map: heights and gradients, its isotropic spectrum, Hurst exponents along both directions.

use asperity::scene::{HeightMap, PowerLaw, Spectrum, Surface, peak_to_valley};
use serde::Serialize;

use crate::cli;
use crate::terminal::LabelledLine;
use asperity_study::decimals::real;

/// Numbers of a map, in SI units; pairs are along x and along y.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct MapAnalysis {
    points: [usize; 2],
    steps: [f64; 2],
    /// The periods, if the map is periodic.
    lengths: [f64; 2],
    mean_height: f64,
    /// Slopes of the least squares plane.
    tilt: [f64; 2],
    /// Root mean square height about the mean.
    rms_height: f64,
    peak_to_valley: f64,
    /// Root mean square gradient of splines along all lines and columns.
    rms_gradient: f64,
    /// The power laws that the mean spectra of the lines and of the columns follow.
    laws: [Option<PowerLaw>; 2],
    /// q (rad/m) and C (m⁴) of the isotropic spectrum, ⟨h²⟩ = 2π ∫ q C dq.
    spectrum: Vec<[f64; 2]>,
}

impl MapAnalysis {
    /// Of the map that a surface is a line of, if it is.
    pub(super) fn of(surface: &Surface, command: &cli::Surface) -> Option<Self> {
        let (map, periodic) = (surface.map()?, surface.is_periodic());
        let turned = map.transposed();
        let law =
            |map: &HeightMap| PowerLaw::fit(&Spectrum::of_lines(map, periodic).bands(), command.wavelengths.as_ref());
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

    pub(super) fn rows(&self) -> Vec<LabelledLine> {
        let Self { points, steps, lengths, tilt, .. } = self;
        let hurst = |law: Option<PowerLaw>| {
            law.map_or_else(|| "none".to_owned(), |law| format!("{:.3} ± {:.3}", law.hurst, law.hurst_error))
        };
        let [along_x, along_y] = self.laws.map(hurst);
        let rows = [
            format!(
                "{} by {} points, {:.4e} m and {:.4e} m apart along x and y",
                points[0], points[1], steps[0], steps[1]
            ),
            format!("{:.6e} m by {:.6e} m", lengths[0], lengths[1]),
            format!("heights: rms {:.4e} m about the mean of {:.4e} m", self.rms_height, self.mean_height),
            format!("{:.4e} m peak to valley, tilts of {:.4e} and {:.4e}", self.peak_to_valley, tilt[0], tilt[1]),
            format!("gradient: rms {:.4}, of splines along lines and columns", self.rms_gradient),
            format!("Hurst exponent along x {along_x}, along y {along_y}"),
        ];
        rows.into_iter().enumerate().map(|(i, row)| (if i == 0 { "Map" } else { "" }, row)).collect()
    }

    /// The isotropic spectrum as a file of two columns.
    pub(super) fn spectrum(&self) -> &[[f64; 2]] {
        &self.spectrum
    }
}

/// A matrix of heights, each row a line along x.
pub(super) fn matrix(map: &HeightMap) -> String {
    let row = |j: usize| map.line(j).iter().map(|z| real(*z)).collect::<Vec<_>>().join(",") + "\n";
    (0..map.ny()).map(row).collect()
}
