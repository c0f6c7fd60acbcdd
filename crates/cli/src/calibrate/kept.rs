//! The table beside a calibration's output: the points that were found, so that nothing is found twice.

use std::path::{Path, PathBuf};

use asperity::element::{OperatingPoint, PointStatus};
use asperity::tables;
use asperity_study::calibration::{FreeParameter, FrictionParts, Outcome, Task};

use super::CalibrateError;
use crate::files::FileError;
use crate::resumable_table::ResumableTable;
use crate::terminal::warn;
use asperity_study::decimals::real;

/// The first line of a table; its number grows when readers have to know of a change.
const FORMAT: &str = "# asperity calibrate = 1";

/// A table to which points are added.
#[derive(Debug)]
pub(super) struct KeptPoints(ResumableTable);

impl KeptPoints {
    /// Begins a table or, unless it is to be replaced, continues the one that is there; and the points that it has.
    pub(super) fn open(
        path: &Path,
        fingerprint: &str,
        parameters: &[FreeParameter],
        replace: bool,
    ) -> Result<(Self, Vec<(Task, Outcome)>), CalibrateError> {
        let head = head(fingerprint, parameters);
        let read = |text: &str| read(text, path, &head, parameters.len());
        let (table, known) = ResumableTable::open(path, &head, replace, read, |(task, outcome)| line(task, outcome))?;
        Ok((Self(table), known))
    }

    /// Adds a point; it is in the file when this returns.
    pub(super) fn add(&self, task: &Task, outcome: &Outcome) -> Result<(), FileError> {
        self.0.add(&line(task, outcome))
    }
}

/// The lines before the rows.
fn head(fingerprint: &str, parameters: &[FreeParameter]) -> String {
    let keys = parameters.iter().map(|parameter| parameter.key.as_str());
    let others = ["speed [m/s]", "pressure [Pa]", "temperature [K]", "status", "profile [1]", "fine [1]", "shear [1]"];
    format!("{FORMAT}\n# fingerprint = {fingerprint}\n{}\n", keys.chain(others).collect::<Vec<_>>().join(","))
}

fn line(task: &Task, outcome: &Outcome) -> String {
    let values = task.parameters.iter().copied().map(real);
    let OperatingPoint { speed, load, temperature } = task.point;
    let point = [real(speed), real(load), temperature.map(real).unwrap_or_default()];
    let status = PointStatus::new(outcome.as_ref().err());
    let parts = outcome.as_ref().map_or([None; 3], |parts| [parts.profile, parts.fine, parts.shear].map(Some));
    let fields = values.chain(point).chain([tables::quoted(status.text())]);
    let parts = parts.map(|part| part.map(real).unwrap_or_default());
    fields.chain(parts).collect::<Vec<_>>().join(",") + "\n"
}

/// The points of the table at `path`, which is the `text`, without those that are damaged.
fn read(text: &str, path: &Path, head: &str, parameters: usize) -> Result<Vec<(Task, Outcome)>, CalibrateError> {
    let Some(rows) = text.strip_prefix(head) else {
        return Err(CalibrateError::OtherCalibration { path: PathBuf::from(path) });
    };
    let mut known = Vec::new();
    for (number, line) in (1 + head.lines().count()..).zip(rows.lines()) {
        match point(line, parameters) {
            Some(found) => known.push(found),
            None => warn(&format!("{}:{number}: the row is damaged; its point is found again", path.display())),
        }
    }
    Ok(known)
}

/// The point of a row, without its end; `None` where it is damaged.
fn point(line: &str, parameters: usize) -> Option<(Task, Outcome)> {
    let fields: Vec<String> = tables::fields(line, ',').map(std::borrow::Cow::into_owned).collect();
    if fields.len() != parameters + 7 {
        return None;
    }
    let number = |index: usize| fields.get(index)?.parse::<f64>().ok().filter(|number| number.is_finite());
    let values: Option<Vec<f64>> = (0..parameters).map(number).collect();
    let temperature = if fields[parameters + 2].is_empty() { None } else { Some(number(parameters + 2)?) };
    let point = OperatingPoint { speed: number(parameters)?, load: number(parameters + 1)?, temperature };
    let outcome = match PointStatus::read(&fields[parameters + 3]) {
        PointStatus::Steady => Ok(FrictionParts {
            profile: number(parameters + 4)?,
            fine: number(parameters + 5)?,
            shear: number(parameters + 6)?,
        }),
        PointStatus::Problem(why) => Err(why),
    };
    Some((Task { parameters: values?, point }, outcome))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_read_as_it_was_written() {
        let task = |temperature| Task {
            parameters: vec![1.0 / 3.0, 2e-7],
            point: OperatingPoint { speed: 0.1, load: 1e5, temperature },
        };
        let parts = FrictionParts { profile: 0.1 + 0.2, fine: 1e-9, shear: -0.5 };
        for (task, outcome) in [(task(Some(293.15)), Ok(parts)), (task(None), Err("no, \"never\" steady".to_owned()))] {
            let line = line(&task, &outcome);
            assert_eq!(point(line.trim_end(), 2), Some((task, outcome)));
            assert_eq!(point(&line[1 + line.find(',').unwrap_or_default()..], 2), None);
        }
    }
}
