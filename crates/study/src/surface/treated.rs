//! A surface that is smoothed, split and made periodic; its analysis, its files as scenes read them, and its picture.

use std::f64::consts::PI;

use asperity::scene::{HeightMap, RoughnessSpectrum, Surface};
use asperity::table::{Column, Header, Table};

use super::analysis::{FinerWaves, Removed, SurfaceAnalysis};
use super::options::SurfaceOptions;
use crate::Error;
use crate::decimals::real;
use crate::picture::{Axis, Fill, Fit, Mark, Panel, Picture, Point, Shape, Stroke, Symbol, xs, ys};

/// A surface before and after, and its analysis.
#[derive(Debug)]
pub struct TreatedSurface {
    /// As it was read.
    pub read: Surface,
    /// As it is now.
    pub surface: Surface,
    /// The spectrum of the waves that were split off.
    pub finer: Option<RoughnessSpectrum>,
    /// Of the surface as it is now.
    pub analysis: SurfaceAnalysis,
    options: SurfaceOptions,
}

impl TreatedSurface {
    /// Smooths or splits a surface, makes it periodic and analyses it, each as asked for; of a `line` of a map that was
    /// chosen the map stays as it is.
    ///
    /// # Errors
    /// Where it is periodic already, or cannot be split at that wavelength.
    pub fn new(read: Surface, options: &SurfaceOptions, line: Option<u32>) -> Result<Self, Error> {
        options.check(read.is_periodic())?;
        let length = read.x()[read.x().len() - 1] - read.x()[0];
        if let Some(smooth) = options.smooth.filter(|smooth| *smooth > length) {
            return Err(Error::value(format!(
                "`smooth` {smooth:?}: expected at most {length:?} m, the length of the profile; lengths are in m"
            )));
        }
        let split =
            |at: f64| read.split(at).map_err(|expected| Error::value(format!("`split` {at:?}: expected {expected}")));
        let (smooth, finer) = match options.split.map(split).transpose()? {
            Some(parts) => (parts.profile, Some(parts.finer)),
            None => (options.smooth.map_or_else(|| read.clone(), |cut_off| read.smoothed(cut_off)), None),
        };
        let removed = options.smooth.or(options.split).map(|cut_off| Removed::of(&read, &smooth, cut_off));
        let surface = match (smooth.map().filter(|_| line.is_none()), options) {
            (Some(map), SurfaceOptions { mirror: true, .. }) => Surface::of_map(map.mirrored(), true),
            (None, SurfaceOptions { mirror: true, .. }) => mirrored(&smooth),
            (_, SurfaceOptions { taper: true, .. }) => tapered(&smooth),
            _ => smooth,
        };
        let waves = finer.as_ref().map(FinerWaves::of);
        let of_surface = SurfaceAnalysis::of(&surface, options.wavelengths);
        let analysis = SurfaceAnalysis { removed, finer: waves, ..of_surface };
        Ok(Self { read, surface, finer, analysis, options: options.clone() })
    }

    /// Wave numbers, rad/m, and densities, m⁴, of the waves that were split off, or else of the map; `None` of a profile
    /// that was not split.
    pub fn isotropic(&self) -> Option<&[[f64; 2]]> {
        let of_map = || self.analysis.map.as_ref().map(|map| &map.spectrum[..]);
        self.finer.as_ref().map(RoughnessSpectrum::points).or_else(of_map)
    }

    /// The map as it is now, where it was mirrored whole.
    pub fn mirrored_map(&self) -> Option<&HeightMap> {
        self.surface.map().filter(|_| self.options.mirror)
    }

    /// The file of the surface, in m: the profile, or the matrix of a map that was mirrored whole.
    pub fn file(&self) -> String {
        match self.mirrored_map() {
            Some(map) => matrix(map),
            None => columns(
                ["x", "z"].map(|name| Column::numbers(name, "m")),
                self.surface.x().iter().zip(self.surface.z()),
            ),
        }
    }

    /// The file of the [isotropic](Self::isotropic) spectrum.
    pub fn spectrum_file(&self) -> Option<String> {
        let points = self.isotropic()?;
        let named = [Column::numbers("q", "1/m"), Column::numbers("C", "m^4")];
        Some(columns(named, points.iter().map(|[q, density]| (q, density))))
    }

    /// What is used over what was read, where that is something else, with the power law.
    pub fn picture(&self) -> Picture {
        let before = self.analysis.removed.is_some().then(|| SurfaceAnalysis::of(&self.read, self.options.wavelengths));
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

/// Share of the length over which the end of a tapered profile goes over into its beginning.
const TAPER: f64 = 0.1;

/// The profile followed by its mirror image, without the point that both have: its heights are those of before, and
/// where it turns, its slope changes its sign.
fn mirrored(surface: &Surface) -> Surface {
    let (x, z) = (surface.x(), surface.z());
    let end = x[x.len() - 1];
    let back = || (0..x.len() - 1).rev();
    let mirrored_x = x.iter().copied().chain(back().map(|i| 2.0 * end - x[i])).collect();
    let mirrored_z = z.iter().copied().chain(back().map(|i| z[i])).collect();
    Surface::new(mirrored_x, mirrored_z, true)
}

/// The profile without the last tenth of its length, which goes over into the first tenth by a cosine: at x = 0 it goes
/// on from where the period ends, with the same slope.
fn tapered(surface: &Surface) -> Surface {
    let (x, z, spline) = (surface.x(), surface.z(), surface.spline());
    let length = x[x.len() - 1] - x[0];
    // A point of the profile, so that no height between points is needed where they are even.
    let last = x.partition_point(|x_i| *x_i < x[0] + (1.0 - TAPER) * length * (1.0 - ROUNDING));
    let period = x[last] - x[0];
    let blended = |i: usize| {
        let share = ((x[i] - x[0]) / (length - period)).min(1.0);
        let weight = 0.5 * (1.0 - (PI * share).cos());
        if weight < 1.0 { weight * z[i] + (1.0 - weight) * spline.evaluate(x[i] + period).0 } else { z[i] }
    };
    let mut heights: Vec<f64> = (0..last).map(blended).collect();
    heights.push(heights[0]);
    Surface::new(x[..=last].to_vec(), heights, true)
}

/// A position that differs by this share of the length is the same but for rounding.
const ROUNDING: f64 = 1e-9;

/// A map: a matrix of heights, m, each row a line along x.
fn matrix(map: &HeightMap) -> String {
    let row = |j: usize| map.line(j).iter().map(|z| real(*z)).collect::<Vec<_>>().join(",") + "\n";
    (0..map.ny()).map(row).collect()
}

/// The text of two columns of numbers.
fn columns<'a>(columns: [Column; 2], rows: impl Iterator<Item = (&'a f64, &'a f64)>) -> String {
    let mut table = Table::new(Header::default(), columns);
    rows.for_each(|(first, second)| table.push([(*first).into(), (*second).into()]));
    table.text()
}

/// The colour of what was read.
const READ: usize = 4;

fn heights(surface: &Surface) -> Vec<Point> {
    surface.x().iter().zip(surface.z()).map(|(&x, &z)| [x, z]).collect()
}

/// Beyond a cut-off there are rounding errors alone, which are not drawn.
fn spectrum(analysis: &SurfaceAnalysis) -> Vec<Point> {
    let largest = analysis.spectrum.iter().map(|band| band.density).fold(0.0, f64::max);
    let seen = analysis.spectrum.iter().filter(|band| band.density > 1e-16 * largest);
    seen.map(|band| [band.wave_number, band.density]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp_and_waves() -> Surface {
        let x: Vec<f64> = (0..=1000).map(|i| 1e-6 * f64::from(i)).collect();
        let z = x.iter().map(|x| 1e-6 * (9e4 * x).sin() + 5e-3 * x).collect();
        Surface::new(x, z, false)
    }

    #[test]
    fn a_mirrored_profile_has_the_heights_of_before_twice() {
        let profile = Surface::new(vec![1.0, 2.0, 4.0], vec![0.0, 3.0, 5.0], false);
        let periodic = mirrored(&profile);
        assert_eq!(periodic.x(), [1.0, 2.0, 4.0, 6.0, 7.0]);
        assert_eq!(periodic.z(), [0.0, 3.0, 5.0, 3.0, 0.0]);
        assert!(periodic.is_periodic());
    }

    /// A ramp of 5 µm, which a window would cut off, or a mirror turn round.
    #[test]
    fn a_tapered_profile_goes_on_smoothly_and_is_the_one_of_before_elsewhere() {
        let profile = ramp_and_waves();
        let periodic = tapered(&profile);
        let (x, z) = (periodic.x(), periodic.z());
        assert!((x[x.len() - 1] / 0.9e-3 - 1.0).abs() < 1e-9 && z[0] == z[z.len() - 1]);
        assert!((z[0] - profile.z()[900]).abs() < 1e-15);
        assert!((101..900).all(|i| z[i] == profile.z()[i]));
        // Of the waves 0.09, of the ramp 0.005; a ramp of 4.5 µm back over 0.1 mm by a cosine adds at most π/2 of
        // 0.045.
        let steepest = periodic.spline().bounds().slope_max_abs;
        assert!(steepest < 0.095 + 0.5 * PI * 0.045 * 1.5, "{steepest}");
        // The second difference over the seam is like that of the waves, 1 µm (0.09)².
        let seam = z[1] - 2.0 * z[0] + z[z.len() - 2];
        assert!(seam.abs() < 2.0 * 1e-6 * 0.09 * 0.09, "{seam}");
    }
}
