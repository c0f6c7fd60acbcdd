//! `asperity surface`: analyses a profile or a map.

use std::path::PathBuf;

use asperity::scene::{self, HeightMap, PowerLaw, RoughnessSpectrum};
use asperity_formats::Instruments;
use asperity_study::Error;
use asperity_study::surface::{
    CutOff, FinerWaves, MapAnalysis, ProfileReading, Removed, Roughness, SurfaceAnalysis, TreatedSurface,
};

use super::cli::Surface;
use super::files::{self, check_outputs, ends_in, load_without_run, name_of, named, print_beside};
use super::picture;
use super::terminal::{LabelledLine, labelled, lines, note, warn};

/// Reads the surface, prints the analysis, plots it and writes the profile.
pub(crate) fn surface(command: &Surface) -> Result<(), Error> {
    let (read, files) = read(command)?;
    check_outputs(command.output.iter().chain(&command.write).chain(&command.spectrum), files)?;
    let treated = TreatedSurface::new(read, &command.options, command.reading.line);
    let treated = treated.map_err(|error| error.context(command.file.display()))?;
    let TreatedSurface { surface, analysis, .. } = &treated;
    if command.spectrum.is_some() && treated.isotropic().is_none() {
        return Err(Error::value("`spectrum`: expected `split`, or a map, whose isotropic spectrum is written"));
    }
    let text = if command.json { serde_json::to_string(analysis)? + "\n" } else { summary(analysis) };
    if let Some(expected) = surface.map_error() {
        note(&format!("the line alone is analysed; a map would need {expected}"));
    }
    print_beside(&command.write, &text)?;
    if let Some(path) = &command.output {
        let hurst = analysis.law.map(|law| format!(", Hurst exponent {:.2}", law.hurst)).unwrap_or_default();
        let height = analysis.statistics.rms_height;
        let title = format!("{}: rms height {height:.3e} m{hurst}", name_of(&command.file));
        picture::write(&treated.picture().titled(title), path)?;
    }
    write_surface(&treated, command)?;
    write_spectrum(&treated, command)
}

/// Writes the profile; a map that was made periodic whole.
fn write_surface(treated: &TreatedSurface, command: &Surface) -> Result<(), Error> {
    let Some(path) = &command.write else { return Ok(()) };
    files::write(path, treated.file())?;
    let periodic = if treated.surface.is_periodic() { " with periodic = true" } else { "" };
    let held = match treated.mirrored_map().map(HeightMap::spacing) {
        Some([dx, dy]) => {
            format!("map in m, for path = of a scene's surface with spacing = [{dx:?}, {dy:?}] and periodic = true")
        }
        None => format!("profile in m, for path = of a scene's surface{periodic}"),
    };
    note(&format!("{} holds the {held}", named(path)));
    Ok(())
}

/// Writes the spectrum of the finer waves, or the isotropic one of a map.
fn write_spectrum(treated: &TreatedSurface, command: &Surface) -> Result<(), Error> {
    let (Some(path), Some(text)) = (&command.spectrum, treated.spectrum_file()) else { return Ok(()) };
    files::write(path, text)?;
    let held = match treated.finer.as_ref().map(RoughnessSpectrum::wavelengths) {
        Some([longest, shortest]) => {
            let name = name_of(path);
            format!(
                "their spectrum, for fine = {{ spectrum = \"{name}\", longest = {longest:.6e}, shortest = {shortest:.6e} }}"
            )
        }
        None => "the isotropic spectrum of the map".into(),
    };
    note(&format!("{} holds {held}", named(path)));
    Ok(())
}

/// The surface, and the files that it was read from.
fn read(command: &Surface) -> Result<(scene::Surface, Vec<PathBuf>), Error> {
    let path = &command.file;
    if ends_in(path, "toml") {
        if command.reading != ProfileReading::default() {
            let problem = "a scene defines how its surface is read; these options are for profiles only";
            return Err(Error::value(problem).context(path.display()));
        }
        let scene = load_without_run(path, &[], |_| false)?;
        let files = scene.sources(path);
        return Ok((scene.surface, files));
    }
    let loaded = scene::Surface::load(path, &command.reading.options(), &Instruments)?;
    loaded.warnings.iter().for_each(|warning| warn(warning));
    files::tell(loaded.notes.into_iter().map(|note| note.of(name_of(path).as_ref()).text));
    Ok((loaded.surface, vec![path.clone()]))
}

fn summary(analysis: &SurfaceAnalysis) -> String {
    let numbers = &analysis.statistics;
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
    rows.extend(roughness_rows(analysis.roughness.as_ref()));
    rows.extend(analysis.removed.map(|Removed { cut_off, rms_slope }| {
        ("Smoothed", format!("waves of {cut_off:.3e} m halved, shorter ones taken away: rms slope {rms_slope:.4}"))
    }));
    rows.extend(analysis.finer.map(|FinerWaves { wavelengths: [longest, shortest], rms_height, rms_gradient }| {
        let range = format!("from {longest:.3e} m to {shortest:.3e} m");
        ("Finer", format!("waves {range}: rms height {rms_height:.4e} m, rms gradient {rms_gradient:.4}"))
    }));
    rows.push(("Spectrum", format!("taken {}", analysis.taken)));
    rows.extend(law_rows(analysis.law.as_ref(), analysis.removed.as_ref()).into_iter().map(|row| ("", row)));
    rows.extend(analysis.map.iter().flat_map(map_rows));
    lines(&rows)
}

fn roughness_rows(roughness: Option<&Roughness>) -> Vec<LabelledLine> {
    let Some(found) = roughness else {
        let problem = "none by ISO 21920: λc of 0.08 mm, the shortest, takes a length of 0.4 mm, λc of 8 mm, the longest, \
                       points at most 1 mm apart";
        return vec![("Roughness", problem.to_owned())];
    };
    let chosen = match found.chosen {
        CutOff::Default => "the default for this Rz",
        CutOff::LongestThatFits => "the longest of which five fit; for this Rz the default is a longer one",
        CutOff::ShortestResolved => {
            "the shortest in which there are points enough; for this Rz the default is a shorter one"
        }
    };
    let unresolved = if found.shortest < 2.0 * found.spacing { ", below the points' shortest wave" } else { "" };
    let many = if found.evaluations == 1 { String::new() } else { format!(", mean of {}", found.evaluations) };
    let rows = [
        format!("Ra {:.4e} m, Rq {:.4e} m, Rz {:.4e} m, by ISO 21920", found.ra, found.rq, found.rz),
        format!("Rmr {:.1} % at c = Rz/4 = {:.3e} m below the height of 5 %", 100.0 * found.rmr, found.rmr_depth),
        format!("Gaussian filters: λc {:e} m, {chosen}", found.cut_off),
        format!("λs {:e} m{unresolved}; evaluation length {:.4e} m{many}", found.shortest, found.evaluation_length),
    ];
    labelled("Roughness", rows)
}

fn law_rows(law: Option<&PowerLaw>, removed: Option<&Removed>) -> Vec<String> {
    let Some(law) = law else { return vec!["no power law over half a decade of wavelengths".into()] };
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
    // A wave twice as long as the one halved keeps 84 % of its amplitude, 71 % of its power.
    let weakened = removed.map(|removed| 2.0 * removed.cut_off).filter(|below| shortest < *below);
    if let Some(below) = weakened {
        rows.push(format!(
            "the filter weakens waves below {below:.3e} m, which makes the exponent larger than the surface's"
        ));
    } else if !(0.0..=1.0).contains(&law.hurst) {
        rows.push("outside 0 to 1: the profile is not self-affine there, or was smoothed".into());
    }
    rows
}

fn map_rows(map: &MapAnalysis) -> Vec<LabelledLine> {
    let MapAnalysis { points, steps, lengths, tilt, .. } = map;
    let hurst = |law: Option<PowerLaw>| {
        law.map_or_else(|| "none".to_owned(), |law| format!("{:.3} ± {:.3}", law.hurst, law.hurst_error))
    };
    let [along_x, along_y] = map.laws.map(hurst);
    let rows = [
        format!("{} by {} points, {:.4e} m and {:.4e} m apart along x and y", points[0], points[1], steps[0], steps[1]),
        format!("{:.6e} m by {:.6e} m", lengths[0], lengths[1]),
        format!("heights: rms {:.4e} m about the mean of {:.4e} m", map.rms_height, map.mean_height),
        format!("{:.4e} m peak to valley, tilts of {:.4e} and {:.4e}", map.peak_to_valley, tilt[0], tilt[1]),
        format!("gradient: rms {:.4}, of splines along lines and columns", map.rms_gradient),
        format!("Hurst exponent along x {along_x}, along y {along_y}"),
    ];
    labelled("Map", rows)
}
