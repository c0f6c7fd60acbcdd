//! The picture of a table: friction over speed, its parts dashed.

use std::path::Path;

use super::grid::Values;
use super::table::{Line, Table};
use crate::program::error::ProgramError;
use crate::program::figure::{Curve, Figure as _, Panel, SideBySide, Stroke};

/// Draws friction over speed at `path`: a panel for each temperature, a colour for each load; with one load, one panel
/// and a colour for each temperature.
pub(super) fn draw(path: &Path, table: &Table) -> Result<(), ProgramError> {
    Ok(curves(table).write(path)?)
}

fn curves(table: &Table) -> SideBySide {
    let grid = &table.header.grid;
    let temperatures: Vec<Option<f64>> = match &grid.temperatures {
        Some(Values(values)) => values.iter().map(|&value| Some(value)).collect(),
        None => vec![None],
    };
    let loads = &grid.loads.0;
    let of = |load: f64, temperature: Option<f64>| {
        let same = move |line: &&Line| line.point.load == load && line.point.temperature == temperature;
        table.lines.iter().filter(same).filter(|line| line.is_steady()).collect::<Vec<_>>()
    };
    let kelvin = |temperature: Option<f64>| temperature.map(|kelvin| format!("{kelvin} K"));
    let load_name = |load: f64| handy(load, table.header.load.unit());
    let panels = if loads.len() == 1 {
        let colours = temperatures.iter().enumerate();
        let name = |&temperature: &Option<f64>| kelvin(temperature).unwrap_or_else(|| load_name(loads[0]));
        let lines =
            colours.flat_map(|(look, temperature)| lines(&name(temperature), look, &of(loads[0], *temperature)));
        let title = temperatures[0].map(|_| load_name(loads[0])).unwrap_or_default();
        vec![Panel { title, curves: lines.collect() }]
    } else {
        let panel = |&temperature: &Option<f64>| Panel {
            title: kelvin(temperature).unwrap_or_default(),
            curves: loads
                .iter()
                .enumerate()
                .flat_map(|(look, &load)| lines(&load_name(load), look, &of(load, temperature)))
                .collect(),
        };
        temperatures.iter().map(panel).collect()
    };
    SideBySide { x_title: "speed in m/s".into(), y_title: "friction coefficient".into(), panels }
}

/// The whole friction and its parts; of these only one that is there.
fn lines(name: &str, look: usize, points: &[&Line]) -> Vec<Curve> {
    let part = |i: usize| {
        let at = |line: &&Line| line.friction.map(|parts| (line.point.speed, parts[i]));
        points.iter().filter_map(at).collect::<Vec<_>>()
    };
    let curve = |name: String, stroke, points| Curve { name, look, stroke, points };
    let mut curves = vec![curve(name.to_owned(), Stroke::Line, part(0))];
    for (i, stroke, what) in [(1, Stroke::Dashed, "hysteresis"), (2, Stroke::Dotted, "adhesion")] {
        let points = part(i);
        if points.iter().any(|point| point.1 != 0.0) {
            curves.push(curve(what.to_owned(), stroke, points));
        }
    }
    curves
}

/// A quantity in a handy unit: `0.2 MPa`.
fn handy(value: f64, unit: &str) -> String {
    let (prefix, factor) = match value {
        value if value >= 1e5 => ("M", 1e6),
        value if value >= 1e3 => ("k", 1e3),
        value if value >= 0.1 => ("", 1.0),
        value if value >= 1e-4 => ("m", 1e-3),
        _ => ("µ", 1e-6),
    };
    let number = format!("{:.6}", value / factor);
    format!("{} {prefix}{unit}", number.trim_end_matches('0').trim_end_matches('.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_are_named_in_a_handy_unit() {
        let names = [2e5, 4e4, 20.0, 0.05].map(|value| handy(value, "Pa"));
        assert_eq!(names, ["0.2 MPa", "40 kPa", "20 Pa", "50 mPa"]);
    }
}
