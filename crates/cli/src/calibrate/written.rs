//! The calibrated scene: the file that was read, its comments kept and its numbers replaced.

use std::path::{Path, PathBuf};

use asperity::scene::Scene;
use asperity_study::calibration::Measurements;

use super::{CalibrateError, Calibrated, FreeScene};
use crate::cli::Calibrate;
use crate::files::{is_standard_output, name_of};
use asperity_study::decimals::{decimal, rounded};
use asperity_study::settings::overridden;

/// What the lines of the header begin with; those of a calibration before are replaced.
const MARK: &str = "# asperity calibrate: ";

/// Refuses an output from whose folder the files that the scene names could not be found.
pub(super) fn check_folder(output: &Path, command: &Calibrate, scene: &Scene) -> Result<(), CalibrateError> {
    let named = scene.files.iter().chain(scene.extracts.iter().map(|extract| &extract.source));
    let Some(file) = named.into_iter().find(|file| file.is_relative()) else { return Ok(()) };
    let folder = |path: &Path| {
        let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
        folder.canonicalize().ok()
    };
    if is_standard_output(output) || folder(output) == folder(&command.scene) {
        return Ok(());
    }
    Err(CalibrateError::OtherFolder { output: output.to_owned(), file: PathBuf::from(file) })
}

/// The text of the scene.
pub(super) fn text(
    free: &FreeScene<'_>,
    calibrated: &Calibrated,
    measurements: &Measurements,
) -> Result<String, CalibrateError> {
    let values = calibrated.values();
    let settings: Vec<(String, String)> =
        free.parameters.iter().zip(&values).map(|(parameter, value)| (parameter.key.clone(), number(*value))).collect();
    let edited = overridden(&free.text, &settings)?.text;
    let kept = edited.trim_start_matches('\u{feff}').lines().skip_while(|line| line.starts_with(MARK));
    let body: String = kept.map(|line| format!("{line}\n")).collect();
    let header: String = header(free, calibrated, measurements).iter().map(|line| format!("{MARK}{line}\n")).collect();
    Ok(header + &body)
}

fn number(value: f64) -> String {
    decimal(value, 1e-3..1e5)
}

fn header(free: &FreeScene<'_>, calibrated: &Calibrated, measurements: &Measurements) -> Vec<String> {
    let statistics = &calibrated.statistics;
    let data = name_of(&free.options.data);
    let rows = match measurements.rows.len() - calibrated.problem.rows.len() {
        0 => format!("{} measurements", calibrated.problem.rows.len()),
        left_out => {
            format!("{} of {} measurements", calibrated.problem.rows.len(), left_out + calibrated.problem.rows.len())
        }
    };
    let mut lines = vec![format!("fitted to {rows} of {data}")];
    if !calibrated.fitted.has_converged {
        lines.push("NOT CONVERGED: the numbers below are where the fit was given up".to_owned());
    }
    if !statistics.tell_all() {
        lines.push("NOT IDENTIFIABLE: the data do not tell all of the numbers below".to_owned());
    }
    lines.extend(free.parameters.iter().zip(calibrated.values()).enumerate().map(|(index, (parameter, value))| {
        let range = match (statistics.intervals[index], statistics.at_bound[index]) {
            _ if !statistics.is_identifiable(index) => "not identifiable".to_owned(),
            (Some((low, high)), _) => {
                format!("95 % interval {} to {}", number(rounded(low, 3)), number(rounded(high, 3)))
            }
            (None, _) => "at its bound".to_owned(),
        };
        format!("{} = {}, {range}", parameter.key, number(value))
    }));
    lines
}
