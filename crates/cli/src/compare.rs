//! `asperity compare`: the curves of a sweep beside measured friction.

use std::path::{Path, PathBuf};

use asperity::element::{Load, OperatingPoint, PointStatus, Quantity};
use asperity_study::calibration::{Measured, chi_square_per_degree};
use asperity_study::steady::SlideProblem;

use super::cli::Compare;
use super::figure::{Figure as _, Stroke};
use super::files::{FileError, check_outputs, name_of, named, print_beside};
use super::measured_friction::{self, CurveGrid, MeasuredFrictionError, ModelCurves, describe, off};
use super::terminal::{labelled, lines, note, warn};
use asperity_study::decimals::rounded;
use asperity_study::sweep::{SweepTable, SweepTableError};

/// `asperity compare` failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CompareError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Table(#[from] SweepTableError),
    #[error(transparent)]
    Measured(#[from] MeasuredFrictionError),
    #[error("{}: a table over forces: expected one over pressures, as `asperity sweep --pressures` makes", .0.display())]
    OverForces(PathBuf),
    #[error("{}: expected measurements within the speeds, pressures and temperatures of the table; it has none", .0.display())]
    NoneWithin(PathBuf),
}

/// Measurements that are off the most are named up to this many.
const WORST: usize = 5;

/// Draws the curves and the points, and says how far these are off.
pub(crate) fn compare(command: &Compare) -> Result<(), CompareError> {
    let picture = command.output.clone().unwrap_or_else(|| command.table.with_extension("compare.svg"));
    check_outputs([&picture], vec![command.table.clone(), command.data.clone()])?;
    let table = SweepTable::read(&command.table)?;
    let Load::Pressure { area } = table.header.load else {
        return Err(CompareError::OverForces(command.table.clone()));
    };
    let mut measurements = measured_friction::read(&command.data, area)?;
    measurements.notes.iter().for_each(|text| note(text));
    if let [only] = table.header.grid.temperatures[..] {
        measurements.rows.iter_mut().for_each(|row| {
            let _ = row.point.temperature.get_or_insert(only);
        });
    }
    let curves = SweptFriction::new(&table);
    let (mut within, mut beyond): (Vec<(Measured, f64)>, Vec<Measured>) = (Vec::new(), Vec::new());
    for &row in &measurements.rows {
        match curves.at(&row.point) {
            Some(friction) => within.push((row, friction)),
            None => beyond.push(row),
        }
    }
    beyond.iter().for_each(|row| {
        warn(&format!("left out: line {} ({}): the table does not reach there", row.line, describe(&row.point)));
    });
    if within.is_empty() {
        return Err(CompareError::NoneWithin(command.data.clone()));
    }
    let rows: Vec<Measured> = within.iter().map(|(row, _)| *row).collect();
    let grid = CurveGrid::new(rows.iter().map(|row| &row.point));
    let mut points = grid.points(CURVE);
    points.extend(rows.iter().map(|row| row.point));
    let points = points.into_iter().filter_map(|point| Some((point, curves.at(&point)?))).collect();
    let swept = ModelCurves { name: "swept", stroke: Stroke::Line, points };
    measured_friction::picture(&table.header.scene, &grid, &rows, &[swept]).write(&picture)?;
    Ok(print_beside([&picture], &summary(command, &within, &picture))?)
}

/// Points of a curve.
const CURVE: u32 = 60;

fn summary(command: &Compare, within: &[(Measured, f64)], picture: &Path) -> String {
    let deviations = |(row, friction): &(Measured, f64)| (friction - row.friction) / row.sigma_or_assumed();
    let chi_square: f64 = within.iter().map(|pair| deviations(pair).powi(2)).sum();
    let mut worst: Vec<&(Measured, f64)> = within.iter().collect();
    worst.sort_by(|a, b| deviations(b).abs().total_cmp(&deviations(a).abs()));
    let assumed = within.iter().any(|(row, _)| row.sigma.is_none());
    let note = if assumed { ", standard deviations assumed: 5 % and 0.01" } else { "" };
    let mut rows = vec![
        ("Table", name_of(&command.table)),
        ("Data", format!("{}: {} measurements{note}", name_of(&command.data), within.len())),
        (
            "Chi square",
            format!(
                "{}, {} per measurement",
                rounded(chi_square, 4),
                rounded(chi_square_per_degree(chi_square, within.len()), 4)
            ),
        ),
    ];
    rows.extend(labelled("Worst", worst.iter().take(WORST).map(|pair| off(&pair.0, pair.1, deviations(pair)))));
    rows.push(("Written", named(picture)));
    lines(&rows)
}

/// Friction of a table between its points: linear in the logarithms of speed and pressure, and in the temperature.
#[derive(Debug)]
struct SweptFriction<'a> {
    table: &'a SweepTable,
}

/// The values beside one on an axis, and how far it is between them; alone where it is on one. `None` beyond.
fn beside(axis: &[f64], value: f64, scale: fn(f64) -> f64) -> Option<Vec<(f64, f64)>> {
    /// What a number that was written and read with a unit may be off.
    const ROUNDING: f64 = 1e-9;
    if let Some(on) = axis.iter().find(|on| (*on - value).abs() <= ROUNDING * value.abs()) {
        return Some(vec![(*on, 1.0)]);
    }
    let above = axis.iter().position(|on| *on > value).filter(|above| *above > 0)?;
    let (low, high) = (axis[above - 1], axis[above]);
    let part = (scale(value) - scale(low)) / (scale(high) - scale(low));
    Some(vec![(low, 1.0 - part), (high, part)])
}

impl<'a> SweptFriction<'a> {
    fn new(table: &'a SweepTable) -> Self {
        Self { table }
    }

    /// Friction at a point; `None` beyond the table, or beside a point of it that is not steady.
    fn at(&self, point: &OperatingPoint) -> Option<f64> {
        let grid = &self.table.header.grid;
        let speeds = beside(&grid.speeds, point.speed, f64::ln)?;
        let loads = beside(&grid.loads, point.load, f64::ln)?;
        let temperatures: Vec<(Option<f64>, f64)> = match point.temperature {
            Some(kelvin) if !grid.temperatures.is_empty() => {
                let found = beside(&grid.temperatures, kelvin, |value| value)?;
                found.into_iter().map(|(kelvin, weight)| (Some(kelvin), weight)).collect()
            }
            None if grid.temperatures.is_empty() => vec![(None, 1.0)],
            _ => return None,
        };
        let mut friction = 0.0;
        for &(temperature, of_temperature) in &temperatures {
            for &(load, of_load) in &loads {
                for &(speed, of_speed) in &speeds {
                    let corner = OperatingPoint { speed, load, temperature };
                    friction += of_temperature * of_load * of_speed * self.on_grid(&corner)?;
                }
            }
        }
        Some(friction)
    }

    fn on_grid(&self, point: &OperatingPoint) -> Option<f64> {
        let found = self.table.rows.iter().find(|stored| stored.row.point == *point)?;
        let has_friction =
            found.row.is_steady() || found.row.status == PointStatus::new(Some(SlideProblem::FullContact));
        found.row.value(Quantity::Friction).filter(|_| has_friction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_two_values_the_nearer_counts_more() {
        assert_eq!(beside(&[1.0, 2.0], 2.0 * (1.0 + 1e-12), f64::ln), Some(vec![(2.0, 1.0)]));
        let found = beside(&[1.0, 100.0], 10.0, f64::ln).unwrap();
        assert!((found[0].1 - 0.5).abs() < 1e-12 && found[1].0 == 100.0);
        assert_eq!((beside(&[1.0, 2.0], 0.5, f64::ln), beside(&[1.0, 2.0], 3.0, f64::ln)), (None, None));
    }
}
