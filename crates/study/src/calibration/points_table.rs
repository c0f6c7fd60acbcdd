//! The table beside a calibration's output: the points that were found, so that nothing is found twice.

use asperity::element::{OperatingPoint, PointStatus};
use asperity::tables;

use super::error::NoSliding;
use super::model::{FrictionParts, Outcome, Task};
use super::parameter::FreeParameter;
use crate::decimals::real;

/// The first line of a table; its number grows when readers have to know of a change.
const FORMAT: &str = "# asperity calibrate = 3";

/// The lines before the rows.
pub fn head(fingerprint: &str, parameters: &[FreeParameter]) -> String {
    let keys = parameters.iter().map(|parameter| parameter.key.as_str());
    let point = ["speed [m/s]", "pressure [Pa]", "temperature [K]", "way [m]", "status"];
    let others = point.into_iter().chain(["profile [1]", "fine [1]", "shear [1]", "area [1]"]);
    format!("{FORMAT}\n# fingerprint = {fingerprint}\n{}\n", keys.chain(others).collect::<Vec<_>>().join(","))
}

/// The line of a point.
pub fn line(task: &Task, outcome: &Outcome) -> String {
    let values = task.parameters.iter().copied().map(real);
    let OperatingPoint { speed, load, temperature, way } = task.point;
    let [temperature, way] = [temperature, way].map(|value| value.map(real).unwrap_or_default());
    let point = [real(speed), real(load), temperature, way];
    let status = PointStatus::new(outcome.as_ref().err());
    let parts =
        outcome.as_ref().map_or([None; 4], |parts| [parts.profile, parts.fine, parts.shear, parts.area].map(Some));
    let fields = values.chain(point).chain([tables::quoted(status.text())]);
    let parts = parts.map(|part| part.map(real).unwrap_or_default());
    fields.chain(parts).collect::<Vec<_>>().join(",") + "\n"
}

/// The points of a table that begins with a [`head`]: of each line that is damaged its number; `None` of another
/// calibration's table.
pub fn read(text: &str, head: &str, parameters: usize) -> Option<Vec<Result<(Task, Outcome), DamagedLine>>> {
    let rows = text.strip_prefix(head)?;
    let lines = (1 + head.lines().count()..).zip(rows.lines());
    Some(lines.map(|(number, line)| point(line, parameters).ok_or(DamagedLine(number))).collect())
}

/// The number of a line that is damaged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DamagedLine(pub usize);

/// The point of a row, without its end; `None` where it is damaged.
fn point(line: &str, parameters: usize) -> Option<(Task, Outcome)> {
    let fields: Vec<String> = tables::fields(line, ',').map(std::borrow::Cow::into_owned).collect();
    if fields.len() != parameters + 9 {
        return None;
    }
    let number = |index: usize| fields.get(index)?.parse::<f64>().ok().filter(|number| number.is_finite());
    let values: Option<Vec<f64>> = (0..parameters).map(number).collect();
    let optional = |index: usize| if fields[index].is_empty() { Some(None) } else { number(index).map(Some) };
    let (temperature, way) = (optional(parameters + 2)?, optional(parameters + 3)?);
    let point = OperatingPoint { speed: number(parameters)?, load: number(parameters + 1)?, temperature, way };
    let outcome = match PointStatus::read(&fields[parameters + 4]) {
        PointStatus::Steady | PointStatus::FullContact => Ok(FrictionParts {
            profile: number(parameters + 5)?,
            fine: number(parameters + 6)?,
            shear: number(parameters + 7)?,
            area: number(parameters + 8)?,
        }),
        PointStatus::Problem(why) => Err(NoSliding::new(why)),
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
            point: OperatingPoint { speed: 0.1, load: 1e5, temperature, way: temperature.map(|_| 0.02) },
        };
        let parts = FrictionParts { profile: 0.1 + 0.2, fine: 1e-9, shear: -0.5, area: 0.1 };
        for (task, outcome) in
            [(task(Some(293.15)), Ok(parts)), (task(None), Err(NoSliding::new("no, \"never\" steady")))]
        {
            let line = line(&task, &outcome);
            assert_eq!(point(line.trim_end(), 2), Some((task, outcome)));
            assert_eq!(point(&line[1 + line.find(',').unwrap_or_default()..], 2), None);
        }
    }
}
