//! The curves of a sweep beside measured friction.

use std::path::{Path, PathBuf};

use asperity::element::{Load, OperatingPoint, Quantity};
use asperity::tables::GivenColumns;
use clap::Args;
use serde::{Deserialize, Serialize};

use crate::Error;
use crate::calibration::{self, CurveGrid, Measured, Measurements, ModelCurves, in_words, left_out_in_words};
use crate::decimals::rounded;
use crate::files::ColumnOptions;
use crate::picture::{Picture, Stroke};
use crate::sweep::{SweepHeader, SweepTable, way_of};

// What a table is compared with. Not a doc comment: that would be the description of the command.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Args)]
pub struct CompareOptions {
    /// The measured friction, as for asperity calibrate.
    #[arg(long, value_name = "MEASURED.csv")]
    pub data: PathBuf,
    #[command(flatten)]
    #[serde(flatten)]
    pub columns: ColumnOptions,
}

/// Measurements and the friction of a table there.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// How the table of measurements was read.
    pub notes: Vec<String>,
    /// The measurements that the table reaches, and its friction there.
    pub within: Vec<(Measured, f64)>,
    /// The other ones, and why the table has no friction there.
    pub left_out: Vec<(Measured, NoFriction)>,
    /// The curves that the measurements make.
    pub grid: CurveGrid,
    /// Friction of the table along these curves, and at the measurements.
    pub swept: Vec<(OperatingPoint, f64)>,
}

/// Why a table has no friction at a point.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoFriction {
    /// It lies beyond its points.
    #[error("the table does not reach there")]
    Beyond,
    /// The measurement has another way than the table.
    #[error("the table is of another way, or of none")]
    OtherWay,
    /// A point beside it has no result, but this status.
    #[error("the table has no result beside it: {0}")]
    Failed(String),
}

/// Points of a curve.
const CURVE: u32 = 60;

impl Comparison {
    /// Of the `table` at `path` and what is measured.
    ///
    /// # Errors
    /// Where the table is over forces, or the measurements cannot be read.
    pub fn new(table: &SweepTable, path: &Path, options: &CompareOptions) -> Result<Self, Error> {
        let measurements = measured_beside(&table.header, path, &options.data, &options.columns.columns)?;
        let curves = SweptFriction { table };
        let (mut within, mut left_out) = (Vec::<(Measured, f64)>::new(), Vec::<(Measured, NoFriction)>::new());
        for &row in &measurements.rows {
            match curves.at(&row.point) {
                Ok(friction) => within.push((row, friction)),
                Err(why) => left_out.push((row, why)),
            }
        }
        let grid = CurveGrid::new(within.iter().map(|(row, _)| &row.point));
        let mut points = grid.points(CURVE);
        points.extend(within.iter().map(|(row, _)| row.point));
        let swept = points.into_iter().filter_map(|point| Some((point, curves.at(&point).ok()?))).collect();
        Ok(Self { notes: measurements.notes, within, left_out, grid, swept })
    }

    /// Refuses measurements, those in the file `data`, of which the table has none.
    ///
    /// # Errors
    /// Where it has none.
    pub fn check(&self, data: &Path) -> Result<(), Error> {
        if !self.within.is_empty() {
            return Ok(());
        }
        Err(Error::in_file(
            data,
            None,
            "expected measurements within the speeds, pressures and temperatures of the table, where its points have a \
             result; it has none",
        ))
    }

    /// Sum of the squared deviations of the table from the measurements.
    pub fn chi_square(&self) -> f64 {
        self.within.iter().map(|pair| deviation(pair).powi(2)).sum()
    }

    /// The measurements, and the curves of the table, which is of `scene`.
    pub fn picture(&self, scene: &str) -> Picture {
        let rows: Vec<Measured> = self.within.iter().map(|(row, _)| *row).collect();
        let swept = ModelCurves { name: "swept", stroke: Stroke::Solid, points: self.swept.clone() };
        calibration::picture(scene, &self.grid, &rows, &[swept])
    }

    /// How many measurements are left out, which, and why; `None` where none is.
    pub fn left_out_in_words(&self) -> Option<String> {
        let left_out = self.left_out.iter().map(|(row, why)| (vec![row.line], row.point, why));
        left_out_in_words(left_out, self.within.len() + self.left_out.len())
    }

    /// Measurement, friction of the table and its deviation over the standard deviation, the worst first.
    pub fn worst_first(&self) -> Vec<(Measured, f64, f64)> {
        let mut all: Vec<(Measured, f64, f64)> =
            self.within.iter().map(|pair| (pair.0, pair.1, deviation(pair))).collect();
        all.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
        all
    }
}

/// A measurement that is off the friction of a model, by so many standard deviations, in a line.
pub fn off_in_words(measured: &Measured, model: f64, deviations: f64) -> String {
    format!(
        "line {}, {}: {} measured, {} found, off by {} standard deviations",
        measured.line,
        in_words(&measured.point),
        rounded(measured.friction, 4),
        rounded(model, 4),
        rounded(deviations, 2),
    )
}

/// The measurements in the file `data`, to be looked at beside the table at `path` with this header: at its temperature
/// where it has one and they have none.
///
/// # Errors
/// Where the table is over forces, or the measurements cannot be read, or say nothing of the temperature that they need.
pub fn measured_beside(
    header: &SweepHeader,
    path: &Path,
    data: &Path,
    columns: &GivenColumns,
) -> Result<Measurements, Error> {
    let Load::Pressure { area } = header.load else {
        return Err(Error::in_file(
            path,
            None,
            "a table over forces: expected one over pressures, as `asperity sweep --pressures` makes",
        ));
    };
    let mut measurements = Measurements::read(data, area, columns)?;
    let temperatures = &header.grid.temperatures;
    if temperatures.len() > 1 && !measurements.has_temperature() {
        return Err(Error::in_file(
            data,
            None,
            "no temperatures: expected a column temperature [°C], for the table has several; or a table of one temperature",
        ));
    }
    if temperatures.is_empty() && measurements.has_temperature() {
        measurements.notes.push(without_temperature(&measurements.rows));
    }
    if let [only] = temperatures[..] {
        measurements.rows.iter_mut().for_each(|row| {
            let _ = row.point.temperature.get_or_insert(only);
        });
    }
    Ok(measurements)
}

/// The note that a table without temperatures is compared with measurements that have some.
fn without_temperature(rows: &[Measured]) -> String {
    let kelvins = || rows.iter().filter_map(|row| row.point.temperature);
    let (low, high) = (kelvins().fold(f64::INFINITY, f64::min), kelvins().fold(0.0, f64::max));
    let range = if low == high { format!("{low} K") } else { format!("{low} to {high} K") };
    format!("the table has no temperatures, as its scene has no material.wlf: it is compared with those at {range}")
}

/// How far a table is off, over the standard deviation.
fn deviation((row, friction): &(Measured, f64)) -> f64 {
    (friction - row.friction) / row.sigma_or_assumed()
}

/// Friction of a table at a point: between its points linear in the logarithms of speed and pressure, and in the
/// temperature.
///
/// # Errors
/// Where it lies beyond the table, or beside a point of it without a result.
pub fn swept_friction(table: &SweepTable, point: &OperatingPoint) -> Result<f64, NoFriction> {
    SweptFriction { table }.at(point)
}

/// Friction of a table between its points: linear in the logarithms of speed and pressure, and in the temperature.
#[derive(Debug)]
struct SweptFriction<'a> {
    table: &'a SweepTable,
}

/// The values beside one on an axis, and how far it is between them; alone where it is on one. `None` beyond.
fn beside(axis: &[f64], value: f64, scale: fn(f64) -> f64) -> Option<Vec<(f64, f64)>> {
    /// What a number that was written and read with a unit may be off; of one beyond an end, what was rounded before.
    const ROUNDING: f64 = 1e-9;
    const ROUNDING_OF_END: f64 = 1e-6;
    let (first, last) = (*axis.first()?, *axis.last()?);
    let is_beyond = |end: &&f64| (**end == first && value < first) || (**end == last && value > last);
    let ends = [first, last];
    if let Some(end) = ends.iter().filter(is_beyond).find(|end| (value - **end).abs() <= ROUNDING_OF_END * end.abs()) {
        return Some(vec![(*end, 1.0)]);
    }
    if let Some(on) = axis.iter().find(|on| (*on - value).abs() <= ROUNDING * value.abs()) {
        return Some(vec![(*on, 1.0)]);
    }
    let above = axis.iter().position(|on| *on > value).filter(|above| *above > 0)?;
    let (low, high) = (axis[above - 1], axis[above]);
    let part = (scale(value) - scale(low)) / (scale(high) - scale(low));
    Some(vec![(low, 1.0 - part), (high, part)])
}

impl SweptFriction<'_> {
    /// Friction at a point, unless it is beyond the table or beside a point of it without a result.
    fn at(&self, point: &OperatingPoint) -> Result<f64, NoFriction> {
        let header = &self.table.header;
        if point.way.is_some() && point.way != way_of(&header.keys) {
            return Err(NoFriction::OtherWay);
        }
        let grid = &header.grid;
        let speeds = beside(&grid.speeds, point.speed, f64::ln).ok_or(NoFriction::Beyond)?;
        let loads = beside(&grid.loads, point.load, f64::ln).ok_or(NoFriction::Beyond)?;
        let temperatures: Vec<(Option<f64>, f64)> = match point.temperature {
            Some(kelvin) if !grid.temperatures.is_empty() => {
                let found = beside(&grid.temperatures, kelvin, |value| value).ok_or(NoFriction::Beyond)?;
                found.into_iter().map(|(kelvin, weight)| (Some(kelvin), weight)).collect()
            }
            // One without temperatures holds at all of them.
            _ if grid.temperatures.is_empty() => vec![(None, 1.0)],
            _ => return Err(NoFriction::Beyond),
        };
        let mut friction = 0.0;
        for &(temperature, of_temperature) in &temperatures {
            for &(load, of_load) in &loads {
                for &(speed, of_speed) in &speeds {
                    let corner = OperatingPoint { speed, load, temperature, way: None };
                    friction += of_temperature * of_load * of_speed * self.on_grid(&corner)?;
                }
            }
        }
        Ok(friction)
    }

    fn on_grid(&self, point: &OperatingPoint) -> Result<f64, NoFriction> {
        let found = self.table.rows.iter().find(|row| row.point == *point).ok_or(NoFriction::Beyond)?;
        let friction = found.value(Quantity::Friction).filter(|_| found.is_result());
        friction.ok_or_else(|| NoFriction::Failed(found.status.text().to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_two_values_the_nearer_counts_more() {
        assert_eq!(beside(&[1.0, 2.0], 2.0 * (1.0 + 1e-12), f64::ln), Some(vec![(2.0, 1.0)]));
        for (value, end) in [(1.0 - 0.9e-6, 1.0), (2.0 + 1.8e-6, 2.0)] {
            assert_eq!(beside(&[1.0, 2.0], value, f64::ln), Some(vec![(end, 1.0)]));
        }
        assert_eq!(beside(&[1.0, 2.0], 2.0 + 2.2e-6, f64::ln), None);
        let found = beside(&[1.0, 100.0], 10.0, f64::ln).unwrap();
        assert!((found[0].1 - 0.5).abs() < 1e-12 && found[1].0 == 100.0);
        assert_eq!((beside(&[1.0, 2.0], 0.5, f64::ln), beside(&[1.0, 2.0], 3.0, f64::ln)), (None, None));
    }
}
