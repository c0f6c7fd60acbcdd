//! The calibrated scene: the file that was read, its comments kept and its numbers replaced.

use asperity::scene::Setting;

use super::calibrated::Calibration;
use super::free_scene::FreeScene;
use super::parameter::FreeParameter;
use crate::decimals::{plain, short};
use crate::files::name_of;
use crate::settings::edited;

/// What the lines of the header begin with; those of a calibration before are replaced.
const MARK: &str = "# asperity calibrate: ";

/// The text of the scene.
pub fn calibrated_text(free: &FreeScene<'_>, calibration: &Calibration) -> String {
    let values = calibration.values();
    let setting = |(parameter, value): (&FreeParameter, &f64)| Setting::parse(&parameter.key, &plain(*value));
    let settings: Vec<Setting> = free.parameters.iter().zip(&values).map(setting).collect();
    let edited = edited(&free.text, &settings);
    let kept = edited.trim_start_matches('\u{feff}').lines().skip_while(|line| line.starts_with(MARK));
    let body: String = kept.map(|line| format!("{line}\n")).collect();
    let header: String = header(free, calibration).iter().map(|line| format!("{MARK}{line}\n")).collect();
    header + &body
}

fn header(free: &FreeScene<'_>, calibration: &Calibration) -> Vec<String> {
    let statistics = &calibration.statistics;
    let data = name_of(&free.options.data);
    let rows = match calibration.measurements.rows.len() - calibration.problem.rows.len() {
        0 => format!("{} measurements", calibration.problem.rows.len()),
        left_out => {
            format!("{} of {} measurements", calibration.problem.rows.len(), left_out + calibration.problem.rows.len())
        }
    };
    let mut lines = vec![format!("fitted to {rows} of {data}")];
    if !calibration.fitted.has_converged {
        lines.push("NOT CONVERGED: the numbers below are where the fit was given up".to_owned());
    }
    if !statistics.tell_all() {
        lines.push("NOT IDENTIFIABLE: the data do not tell all of the numbers below".to_owned());
    }
    lines.extend(free.parameters.iter().zip(calibration.values()).enumerate().map(|(index, (parameter, value))| {
        let range = match (statistics.intervals[index], statistics.at_bound[index]) {
            _ if !statistics.is_identifiable(index) => "not identifiable".to_owned(),
            (Some((low, high)), _) => {
                format!("95 % interval {} to {}", short(low, 3), short(high, 3))
            }
            (None, _) => "at its bound".to_owned(),
        };
        format!("{} = {}, {range}", parameter.key, plain(value))
    }));
    lines
}
