//! `asperity surface`: analyses a profile or a map.

mod map;
mod periodic;

use std::path::{Path, PathBuf};

use asperity::scene::{self, Band, PowerLaw, RoughnessSpectrum, Spectrum, SplitError};
use asperity_formats::Instruments;
use serde::Serialize;

use super::cli::{Reading, Surface};
use super::figure::{Figure as _, ProfileCurves, ProfilePicture};
use super::files::{self, FileError, check_outputs, ends_in, load_without_run, name_of, named, print_beside};
use super::terminal::{lines, note, warn};
use asperity_study::decimals::real;
use map::MapAnalysis;

/// `asperity surface` failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SurfaceError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}: a scene defines how its surface is read; these options are for profiles only", .path.display())]
    SceneHasOptions { path: PathBuf },
    #[error("{}: --mirror and --taper make a profile periodic, and it is", .path.display())]
    AlreadyPeriodic { path: PathBuf },
    #[error("--spectrum: expected --split, or a map, whose isotropic spectrum is written")]
    NoSpectrum,
    #[error("--split {split:?}: expected {expected}")]
    Split { split: f64, expected: SplitError },
    #[error("cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

/// Reads the surface, prints the analysis, plots it and writes the profile.
pub(crate) fn surface(command: &Surface) -> Result<(), SurfaceError> {
    let (read, files) = read(command)?;
    check_outputs(command.output.iter().chain(&command.write).chain(&command.spectrum), files)?;
    if (command.mirror || command.taper) && read.is_periodic() {
        return Err(SurfaceError::AlreadyPeriodic { path: command.file.clone() });
    }
    let refused = |expected| SurfaceError::Split { split: command.split.unwrap_or_default(), expected };
    let (smooth, finer) = match command.split.map(|split| read.split(split)).transpose().map_err(refused)? {
        Some(parts) => (parts.profile, Some(parts.finer)),
        None => (command.smooth.map_or_else(|| read.clone(), |cut_off| read.smoothed(cut_off)), None),
    };
    let removed = command.smooth.or(command.split).map(|cut_off| Removed::of(&read, &smooth, cut_off));
    let surface = match (command.mirror, command.taper) {
        (true, _) => mirrored(&smooth, command),
        (_, true) => periodic::tapered(&smooth),
        _ => smooth,
    };
    let finer_waves = finer.as_ref().map(FinerWaves::of);
    let analysis = Analysis { removed, finer: finer_waves, ..Analysis::of(&surface, command) };
    if command.spectrum.is_some() && finer.is_none() && analysis.map.is_none() {
        return Err(SurfaceError::NoSpectrum);
    }
    let text = if command.json { serde_json::to_string(&analysis)? + "\n" } else { analysis.text() };
    if let Some(expected) = surface.map_error() {
        note(&format!("the line alone is analysed; a map would need {expected}"));
    }
    print_beside(&command.write, &text)?;
    if let Some(path) = &command.output {
        let unsmoothed = removed.is_some().then(|| Analysis::of(&read, command));
        let read = unsmoothed.map(|unsmoothed| curves(&read, &unsmoothed));
        picture(read, curves(&surface, &analysis), &analysis, &command.file).write(path)?;
    }
    write_surface(&surface, command)?;
    write_spectrum(finer.as_ref(), analysis.map.as_ref(), command)
}

/// The mirror image behind the map, or behind the profile, or the line of a map that was chosen.
fn mirrored(surface: &scene::Surface, command: &Surface) -> scene::Surface {
    match surface.map().filter(|_| command.reading.line.is_none()) {
        Some(map) => scene::Surface::of_map(map.mirrored(), true),
        None => periodic::mirrored(surface),
    }
}

/// Writes the profile; a map that was made periodic whole.
fn write_surface(surface: &scene::Surface, command: &Surface) -> Result<(), SurfaceError> {
    let Some(path) = &command.write else { return Ok(()) };
    let periodic = if surface.is_periodic() { " with periodic = true" } else { "" };
    if let Some(map) = surface.map().filter(|_| command.mirror) {
        files::write(path, map::matrix(map))?;
        let [dx, dy] = map.spacing();
        let keys = format!("with spacing = [{dx:?}, {dy:?}] and periodic = true");
        note(&format!("{} holds the map in m, for path = of a scene's surface {keys}", named(path)));
    } else {
        files::write(path, columns(surface))?;
        note(&format!("{} holds the profile in m, for path = of a scene's surface{periodic}", named(path)));
    }
    Ok(())
}

/// Writes the spectrum of the finer waves, or the isotropic one of a map.
fn write_spectrum(
    finer: Option<&RoughnessSpectrum>,
    map: Option<&MapAnalysis>,
    command: &Surface,
) -> Result<(), SurfaceError> {
    let Some(path) = &command.spectrum else { return Ok(()) };
    if let Some(finer) = finer {
        files::write(path, spectrum_columns(finer.points()))?;
        let [longest, shortest] = finer.wavelengths();
        note(&format!(
            "{} holds their spectrum, for fine = {{ spectrum = \"{}\", longest = {longest:.6e}, shortest = {shortest:.6e} }}",
            named(path),
            name_of(path)
        ));
    } else if let Some(map) = map {
        files::write(path, spectrum_columns(map.spectrum()))?;
        note(&format!("{} holds the isotropic spectrum of the map", named(path)));
    }
    Ok(())
}

/// The surface, and the files that it was read from.
fn read(command: &Surface) -> Result<(scene::Surface, Vec<PathBuf>), SurfaceError> {
    let path = &command.file;
    if ends_in(path, "toml") {
        if command.reading != Reading::default() {
            return Err(SurfaceError::SceneHasOptions { path: path.clone() });
        }
        let scene = load_without_run(path, &[], |_| false)?;
        scene.notes.iter().filter(|read| !read.assumed).for_each(|read| note(&read.text));
        let files = scene.sources(path);
        return Ok((scene.surface, files));
    }
    let loaded = scene::Surface::load(path, &command.reading.options(), &Instruments).map_err(FileError::from)?;
    loaded.warnings.iter().for_each(|warning| warn(warning));
    loaded.notes.iter().for_each(|read| note(&read.text));
    Ok((loaded.surface, vec![path.clone()]))
}

/// Heights and slopes of a profile, in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Statistics {
    points: usize,
    /// Distance from the first point to the last: the period, if the profile is periodic.
    length: f64,
    /// Shortest and longest step between points.
    steps: [f64; 2],
    periodic: bool,
    mean_height: f64,
    /// Slope of the least squares line.
    tilt: f64,
    /// Root mean square height about the mean.
    rms_height: f64,
    /// Root mean square height about the least squares line.
    rms_height_without_tilt: f64,
    peak_to_valley: f64,
    /// Root mean square slope of the spline, including the tilt.
    rms_slope: f64,
    /// Largest absolute slope of the spline.
    largest_slope: f64,
}

/// Relative difference below which steps count as even: positions are rounded.
const EVEN: f64 = 0.02;

impl Statistics {
    fn of(surface: &scene::Surface) -> Self {
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

    fn is_even(&self) -> bool {
        let [shortest, longest] = self.steps;
        longest - shortest <= EVEN * longest
    }
}

/// The integral over x by the trapezoidal rule, which is spectrally accurate over a whole period at even points.
fn trapezoid(x: &[f64], value: impl Fn(usize) -> f64) -> f64 {
    (1..x.len()).map(|i| 0.5 * (x[i] - x[i - 1]) * (value(i) + value(i - 1))).sum()
}

/// What smoothing took away, in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Removed {
    /// The wavelength that the filter halves.
    cut_off: f64,
    /// Root mean square slope of the difference.
    rms_slope: f64,
}

impl Removed {
    fn of(read: &scene::Surface, smoothed: &scene::Surface, cut_off: f64) -> Self {
        let z = read.z().iter().zip(smoothed.z()).map(|(before, after)| before - after).collect();
        let difference = scene::Surface::new(smoothed.x().to_vec(), z, smoothed.is_periodic());
        Self { cut_off, rms_slope: Statistics::of(&difference).rms_slope }
    }
}

/// The waves that splitting took away, of an isotropic surface with such lines, in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct FinerWaves {
    /// The longest and the shortest of them.
    wavelengths: [f64; 2],
    rms_height: f64,
    /// Root mean square gradient.
    rms_gradient: f64,
}

impl FinerWaves {
    fn of(spectrum: &RoughnessSpectrum) -> Self {
        Self {
            wavelengths: spectrum.wavelengths(),
            rms_height: spectrum.rms_height(),
            rms_gradient: spectrum.rms_gradient(),
        }
    }
}

/// The analysis of a profile, as JSON has it.
#[derive(Debug, Serialize)]
struct Analysis {
    #[serde(flatten)]
    statistics: Statistics,
    removed: Option<Removed>,
    #[serde(skip_serializing_if = "Option::is_none")]
    finer: Option<FinerWaves>,
    #[serde(skip_serializing_if = "Option::is_none")]
    map: Option<MapAnalysis>,
    law: Option<PowerLaw>,
    /// How the spectrum was computed.
    taken: String,
    spectrum: Vec<Band>,
}

impl Analysis {
    fn of(surface: &scene::Surface, command: &Surface) -> Self {
        let statistics = Statistics::of(surface);
        let bands = Spectrum::new(surface).bands();
        let law = PowerLaw::fit(&bands, command.wavelengths.as_ref());
        let points = if statistics.is_even() { "" } else { "at even points of the spline, " };
        let window =
            if surface.is_periodic() { "over one period, as it is" } else { "without tilt, under a Hann window" };
        let map = MapAnalysis::of(surface, command);
        Self { statistics, removed: None, finer: None, map, law, taken: format!("{points}{window}"), spectrum: bands }
    }

    fn text(&self) -> String {
        let numbers = &self.statistics;
        let kind = if numbers.periodic { "periodic" } else { "natural" };
        let [shortest, longest] = numbers.steps;
        let steps = if numbers.is_even() {
            format!("even steps of {:.4e} m", numbers.length / (numbers.points - 1) as f64)
        } else {
            format!("steps from {shortest:.4e} m to {longest:.4e} m")
        };
        let mut rows = vec![
            ("Points", format!("{}, {steps}", numbers.points)),
            ("Length", format!("{:.6e} m, {kind}", numbers.length)),
            ("Heights", format!("rms {:.4e} m about the mean of {:.4e} m", numbers.rms_height, numbers.mean_height)),
            ("", format!("rms {:.4e} m without the tilt of {:.4e}", numbers.rms_height_without_tilt, numbers.tilt)),
            ("", format!("{:.4e} m peak to valley", numbers.peak_to_valley)),
            ("Slopes", format!("rms {:.4}, largest {:.4}, of the spline", numbers.rms_slope, numbers.largest_slope)),
        ];
        rows.extend(self.removed.map(|Removed { cut_off, rms_slope }| {
            ("Smoothed", format!("waves of {cut_off:.3e} m halved, shorter ones taken away: rms slope {rms_slope:.4}"))
        }));
        rows.extend(self.finer.map(|FinerWaves { wavelengths: [longest, shortest], rms_height, rms_gradient }| {
            let range = format!("from {longest:.3e} m to {shortest:.3e} m");
            ("Finer", format!("waves {range}: rms height {rms_height:.4e} m, rms gradient {rms_gradient:.4}"))
        }));
        rows.push(("Spectrum", format!("taken {}", self.taken)));
        rows.extend(self.law_rows().into_iter().map(|row| ("", row)));
        rows.extend(self.map.iter().flat_map(MapAnalysis::rows));
        lines(&rows)
    }

    fn law_rows(&self) -> Vec<String> {
        let Some(law) = &self.law else { return vec!["no power law over half a decade of wavelengths".into()] };
        let [shortest, longest] = law.wavelengths;
        let mut rows = vec![format!(
            "Hurst exponent {:.3} ± {:.3}, from wavelengths of {shortest:.3e} m to {longest:.3e} m",
            law.hurst, law.hurst_error
        )];
        rows.push(law.roll_off_wavelength.map_or_else(
            || "no roll-off".into(),
            |wavelength| format!("roll-off at a wavelength of {wavelength:.3e} m, constant above"),
        ));
        if law.ends {
            rows.push("shorter wavelengths deviate from the law: a cut-off, a filter or noise".into());
        }
        if !(0.0..=1.0).contains(&law.hurst) {
            rows.push("outside 0 to 1: the profile is not self-affine there".into());
        }
        rows
    }
}

fn curves(surface: &scene::Surface, analysis: &Analysis) -> ProfileCurves {
    ProfileCurves {
        heights: surface.x().iter().copied().zip(surface.z().iter().copied()).collect(),
        spectrum: analysis.spectrum.iter().map(|band| (band.wave_number, band.density)).collect(),
    }
}

fn picture(read: Option<ProfileCurves>, used: ProfileCurves, analysis: &Analysis, file: &Path) -> ProfilePicture {
    let law = analysis.law.as_ref().map_or_else(Vec::new, |law| {
        let shortest = law.wavelengths[0];
        let shown = analysis.spectrum.iter().map(|band| band.wave_number);
        let covered = shown.filter(|q| q * shortest <= std::f64::consts::TAU * (1.0 + 1e-9));
        covered.map(|q| (q, law.density(q))).collect()
    });
    let hurst = analysis.law.map(|law| format!(", Hurst exponent {:.2}", law.hurst)).unwrap_or_default();
    ProfilePicture {
        title: format!("{}: rms height {:.3e} m{hurst}", name_of(file), analysis.statistics.rms_height),
        read,
        used,
        law,
    }
}

fn spectrum_columns(points: &[[f64; 2]]) -> String {
    let rows: String = points.iter().map(|[q, density]| format!("{},{}\n", real(*q), real(*density))).collect();
    format!("q [1/m],C [m^4]\n{rows}")
}

fn columns(surface: &scene::Surface) -> String {
    let row = |(x, z): (&f64, &f64)| format!("{},{}\n", real(*x), real(*z));
    let rows: String = surface.x().iter().zip(surface.z()).map(row).collect();
    format!("x [m],z [m]\n{rows}")
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn a_cosine_has_its_known_numbers() {
        let x: Vec<f64> = (0..=1000).map(|i| f64::from(i) * 1e-6).collect();
        let z: Vec<f64> = (0..=1000).map(|i| 2e-6 * (TAU * f64::from(i % 250) / 250.0).cos() + 1e-6).collect();
        let numbers = Statistics::of(&scene::Surface::new(x, z, true));
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
        let numbers = Statistics::of(&scene::Surface::new(x, z, false));
        assert!((numbers.tilt - 0.25).abs() < 1e-15 && (numbers.rms_slope - 0.25).abs() < 1e-15);
        assert!(numbers.rms_height_without_tilt < 1e-15 && !numbers.is_even());
    }
}
