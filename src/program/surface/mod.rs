//! `asperity surface`: what a profile is like.

mod law;
mod spectrum;
mod statistics;

use std::fs;
use std::path::{Path, PathBuf};

use asperity::scene;
use serde::Serialize;

use super::arguments::{Reading, Surface};
use super::error::ProgramError;
use super::plot::ProfilePicture;
use super::{check_output, ends_in, load, note, result_file, sources, text, warn};
use law::Law;
use spectrum::{Band, Spectrum};
use statistics::Statistics;

/// All that is told of a profile.
#[derive(Debug, Serialize)]
struct Findings {
    #[serde(flatten)]
    statistics: Statistics,
    law: Option<Law>,
    /// How the spectrum was taken.
    taken: String,
    spectrum: Vec<Band>,
}

/// Reads, tells, draws, writes.
pub(crate) fn surface(command: &Surface) -> Result<(), ProgramError> {
    let (surface, files) = read(command)?;
    let outputs: Vec<&PathBuf> = command.output.iter().chain(&command.write).collect();
    outputs.iter().try_for_each(|output| check_output(output, &files))?;
    if let [first, second] = outputs[..] {
        check_output(second, std::slice::from_ref(first))?;
    }
    let findings = Findings::of(&surface, command);
    let text = if command.json { findings.json()? } else { findings.text() };
    text::print(&text)?;
    if let Some(path) = &command.output {
        picture(&surface, &findings, &command.file).write(path)?;
    }
    if let Some(path) = &command.write {
        fs::write(path, columns(&surface)).map_err(ProgramError::file("write", path))?;
        note(&format!("{} holds the profile in m, for path = of a scene's surface", path.display()));
    }
    Ok(())
}

/// The surface, and the files that it was read from.
fn read(command: &Surface) -> Result<(scene::Surface, Vec<PathBuf>), ProgramError> {
    let path = &command.file;
    if ends_in(path, "toml") {
        if command.reading != Reading::default() {
            return Err(ProgramError::SceneHasOptions { path: path.clone() });
        }
        let scene = load(path)?;
        let files = sources(path, &scene);
        return Ok((scene.surface, files));
    }
    let (surface, warnings) = scene::Surface::load(path, &command.reading.options())?;
    warnings.iter().for_each(|warning| warn(warning));
    Ok((surface, vec![path.clone()]))
}

impl Findings {
    fn of(surface: &scene::Surface, command: &Surface) -> Self {
        let statistics = Statistics::of(surface);
        let bands = Spectrum::of(surface).bands();
        let law = Law::of(&bands, command.wavelengths.as_ref());
        let points = if statistics.is_even() { "" } else { "at even points of the spline, " };
        let window = if surface.periodic { "over one period, as it is" } else { "without tilt, under a Hann window" };
        Self { statistics, law, taken: format!("{points}{window}"), spectrum: bands }
    }

    fn json(&self) -> Result<String, ProgramError> {
        serde_json::to_string(self).map(|text| text + "\n").map_err(ProgramError::Json)
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
        rows.push(("Spectrum", format!("taken {}", self.taken)));
        rows.extend(self.law_rows().into_iter().map(|row| ("", row)));
        text::lines(&rows)
    }

    fn law_rows(&self) -> Vec<String> {
        let Some(law) = &self.law else { return vec!["no power law over half a decade of wavelengths".into()] };
        let [shortest, longest] = law.wavelengths;
        let mut rows = vec![format!(
            "Hurst exponent {:.3} ± {:.3}, from wavelengths of {shortest:.3e} m to {longest:.3e} m",
            law.hurst, law.hurst_error
        )];
        rows.push(law.roll_off_wavelength.map_or_else(
            || "no roll-off seen".into(),
            |wavelength| format!("roll-off at a wavelength of {wavelength:.3e} m, constant above"),
        ));
        if law.ends {
            rows.push("the law ends there: a cut-off, a filter or noise below".into());
        }
        if !(0.0..=1.0).contains(&law.hurst) {
            rows.push("outside 0 to 1: the profile is not self-affine there".into());
        }
        rows
    }
}

fn picture(surface: &scene::Surface, findings: &Findings, file: &Path) -> ProfilePicture {
    let name = file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let law = findings.law.as_ref().map_or_else(Vec::new, |law| {
        let shortest = law.wavelengths[0];
        let shown = findings.spectrum.iter().map(|band| band.wave_number);
        let reached = shown.filter(|q| q * shortest <= std::f64::consts::TAU * (1.0 + 1e-9));
        reached.map(|q| (q, law.density(q))).collect()
    });
    let hurst = findings.law.map(|law| format!(", Hurst exponent {:.2}", law.hurst)).unwrap_or_default();
    ProfilePicture {
        title: format!("{name}: rms height {:.3e} m{hurst}", findings.statistics.rms_height),
        heights: surface.x.iter().copied().zip(surface.z.iter().copied()).collect(),
        spectrum: findings.spectrum.iter().map(|band| (band.wave_number, band.density)).collect(),
        law,
    }
}

/// Two columns in m.
fn columns(surface: &scene::Surface) -> String {
    let row = |(x, z): (&f64, &f64)| format!("{},{}\n", result_file::real(*x), result_file::real(*z));
    let rows: String = surface.x.iter().zip(&surface.z).map(row).collect();
    format!("x [m],z [m]\n{rows}")
}
