//! The picture of a profile: its heights above, its power spectrum below.

use std::ops::RangeInclusive;

use asperity::scene::Surface;

use super::{SurfaceAnalysis, TreatedSurface};
use crate::picture::{Axis, Fill, Fit, Mark, Panel, Picture, Point, Shape, Stroke, Symbol, xs, ys};

/// The colour of what was read.
const READ: usize = 4;

impl TreatedSurface {
    /// What is used over what was read, where that is something else, with the power law between `wavelengths`.
    pub fn picture(&self, wavelengths: Option<&RangeInclusive<f64>>) -> Picture {
        let before = self.analysis.removed.is_some().then(|| SurfaceAnalysis::of(&self.read, wavelengths));
        let marks = |used: Vec<Point>, read: Option<Vec<Point>>| {
            let name = if read.is_some() { "smoothed" } else { "profile" };
            let dots = |points| Shape::points(points, Symbol::Disc, Fill::Full, 1.5);
            let read = read.map(|points| Mark::new("as read", READ, dots(points)));
            read.into_iter().chain([Mark::line(name, 0, used)]).collect::<Vec<_>>()
        };
        let profile = marks(heights(&self.surface), before.as_ref().map(|_| heights(&self.read)));
        let mut spectra = marks(spectrum(&self.analysis), before.as_ref().map(spectrum));
        spectra.push(Mark::broken("power law", 1, self.analysis.law_curve(), Stroke::Dashed));
        let [x, z] =
            [Axis::linear(("x", "m"), xs(&profile), Fit::Tight), Axis::linear(("z", "m"), ys(&profile), Fit::Round)];
        let [q, density] = [
            Axis::logarithmic(("wave number", "rad/m"), xs(&spectra)),
            Axis::logarithmic(("power spectrum", "m³"), ys(&spectra)),
        ];
        let above = Panel::new(x, z, profile).sized(894.0, 210.0);
        Picture::of(vec![above.into(), Panel::new(q, density, spectra).sized(894.0, 410.0).into()])
    }
}

fn heights(surface: &Surface) -> Vec<Point> {
    surface.x().iter().zip(surface.z()).map(|(&x, &z)| [x, z]).collect()
}

/// Beyond a cut-off there are rounding errors alone, which are not drawn.
fn spectrum(analysis: &SurfaceAnalysis) -> Vec<Point> {
    let largest = analysis.spectrum.iter().map(|band| band.density).fold(0.0, f64::max);
    let seen = analysis.spectrum.iter().filter(|band| band.density > 1e-16 * largest);
    seen.map(|band| [band.wave_number, band.density]).collect()
}
