//! Steady sliding in the middle of the table's cells: where interpolation is worst.

use std::path::Path;

use asperity::element::{Element, Load, PointContact, Table};
use asperity::outputs::{Output, variable};
use asperity::scene::{MaterialParameter, Parameter, Scene, Value};
use asperity::simulation::Start;
use rayon::prelude::*;

use crate::program::error::ProgramError;
use crate::program::figure::{Ladder, LadderPanel, Ladders, Rung};
use crate::program::progress;
use crate::program::result_file::real;
use crate::program::sweep::{Sliding, sliding};
use crate::program::text::Row;

/// Standard error of the layer's friction coefficient, over it.
const ERROR: f64 = 0.01;
/// What is compared.
pub(super) const NAMES: [&str; 3] = ["F_x", "F_z", "P_diss"];
/// How far the element slides until it is looked at, m: its spring is at its limit long before.
const WAY: f64 = 1.0;

/// A point between those of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    /// m/s
    pub(super) speed: f64,
    /// Pressure, Pa, or force, N.
    load: f64,
    /// K
    pub(super) temperature: Option<f64>,
}

/// The layer and the element there.
#[derive(Debug)]
pub(super) struct Check {
    pub(super) cell: Cell,
    /// What is wrong in words where the layer was not steady.
    pub(super) layer: Result<Sliding, String>,
    /// |F_x|, F_z and P_diss of the element at the layer's w.
    element: Option<Result<[f64; 3], String>>,
}

/// Checks some `count` points, evenly picked.
pub(super) fn run(contact: &PointContact, scene: &Scene, count: usize) -> Vec<Check> {
    let table = contact.table();
    let cells = picked(cells(table), count);
    let bar = progress::bar(cells.len() as u64);
    let check = |&cell: &Cell| {
        let layer = sliding(scene, cell.speed, cell.load * table.nominal_area, cell.temperature, ERROR);
        let element = layer.as_ref().ok().map(|layer| at(contact, &cell, layer.w));
        bar.inc(1);
        Check { cell, layer, element }
    };
    let checks = cells.par_iter().with_max_len(1).map(check).collect();
    bar.finish_and_clear();
    checks
}

/// The middles of the cells; of an axis of one value, that.
fn cells(table: &Table) -> Vec<Cell> {
    let middles = |axis: &[f64], mean: fn(f64, f64) -> f64| match axis {
        [one] => vec![*one],
        _ => axis.windows(2).map(|ends| mean(ends[0], ends[1])).collect::<Vec<_>>(),
    };
    let geometric: fn(f64, f64) -> f64 = |a, b| (a * b).sqrt();
    let (speeds, loads) = (middles(&table.speeds, geometric), middles(&table.pressures, geometric));
    let temperatures: Vec<Option<f64>> = match table.temperatures.as_slice() {
        [] => vec![None],
        some => middles(some, f64::midpoint).into_iter().map(Some).collect(),
    };
    let mut cells = Vec::new();
    for temperature in temperatures {
        for &load in &loads {
            cells.extend(speeds.iter().map(|&speed| Cell { speed, load, temperature }));
        }
    }
    cells
}

fn picked(cells: Vec<Cell>, count: usize) -> Vec<Cell> {
    let (all, count) = (cells.len(), count.min(cells.len()));
    (0..count).map(|i| cells[(2 * i + 1) * all / (2 * count)]).collect()
}

/// The element at the temperature of a cell.
pub(super) fn element(contact: &PointContact, cell: &Cell, start: &Start) -> Result<Element, String> {
    let mut contact = contact.clone();
    if let (Some(kelvin), true) = (cell.temperature, contact.table().temperatures.len() > 1) {
        let parameter = Parameter::Material(MaterialParameter::Temperature);
        contact.set_parameter(parameter, Value::Real(kelvin)).map_err(|error| error.to_string())?;
    }
    Element::new(&contact, start).map_err(|error| error.to_string())
}

fn at(contact: &PointContact, cell: &Cell, w: f64) -> Result<[f64; 3], String> {
    let mut element = element(contact, cell, &Start { w, u_rate: cell.speed, ..Start::default() })?;
    element.advance(WAY / cell.speed, (cell.speed, 0.0)).map_err(|error| error.to_string())?;
    let variables: Vec<_> =
        [Output::ForceX, Output::ForceZ, Output::DissipatedPower].into_iter().filter_map(variable).collect();
    let mut values = [0.0; 3];
    element.evaluate(&variables, &mut values);
    let [x, z, power] = values;
    Ok([-x, z, power])
}

impl Check {
    /// Of the element, as shares of what the layer does; none where one of them has no values.
    pub(super) fn errors(&self) -> Option<[f64; 3]> {
        let (layer, element) = (self.values()?, self.element.as_ref()?.as_ref().ok()?);
        Some(std::array::from_fn(|i| element[i] / layer[i] - 1.0))
    }

    fn values(&self) -> Option<[f64; 3]> {
        self.layer.as_ref().ok().map(|layer| [layer.drag, layer.force_z, layer.power])
    }

    fn status(&self) -> String {
        match (&self.layer, &self.element) {
            (Err(status), _) => format!("layer {status}"),
            (_, Some(Err(status))) => format!("element: {status}"),
            _ => "compared".into(),
        }
    }
}

/// The largest and the root mean square errors, and what could not be compared.
pub(super) fn rows(checks: &[Check]) -> Vec<Row> {
    let errors: Vec<[f64; 3]> = checks.iter().filter_map(Check::errors).collect();
    let mut texts = vec![format!("{} of {} points between the table's, in steady sliding", errors.len(), checks.len())];
    for (i, name) in NAMES.iter().enumerate().filter(|_| !errors.is_empty()) {
        let largest = errors.iter().fold(0.0_f64, |largest, error| largest.max(error[i].abs()));
        let square = errors.iter().map(|error| error[i] * error[i]).sum::<f64>() / errors.len() as f64;
        texts.push(format!(
            "{name}: off by at most {:.2} %, in root mean square {:.2} %",
            100.0 * largest,
            100.0 * square.sqrt()
        ));
    }
    let failed = checks.iter().filter(|check| check.errors().is_none());
    texts.extend(
        failed.map(|check| format!("{:.3e} m/s, {:.3e}: {}", check.cell.speed, check.cell.load, check.status())),
    );
    texts.into_iter().enumerate().map(|(i, text)| (if i == 0 { "Checked" } else { "" }, text)).collect()
}

/// Writes a row for each point.
pub(super) fn write(path: &Path, load: Load, checks: &[Check]) -> Result<(), ProgramError> {
    let failed = |error: csv::Error| ProgramError::file("write", path)(error.into());
    let mut writer = csv::Writer::from_path(path).map_err(failed)?;
    let mut head = vec!["speed [m/s]".to_owned(), format!("{} [{}]", load.name(), load.unit())];
    head.extend(["temperature [K]", "status", "w [m]"].map(String::from));
    head.extend(NAMES.iter().flat_map(|name| ["layer", "element", "error"].map(|of| format!("{name} {of}"))));
    writer.write_record(head).map_err(failed)?;
    for check in checks {
        writer.write_record(record(check)).map_err(failed)?;
    }
    writer.flush().map_err(ProgramError::file("write", path))
}

fn record(check: &Check) -> Vec<String> {
    let text = |value: Option<f64>| value.map(real).unwrap_or_default();
    let cell = check.cell;
    let mut fields = vec![real(cell.speed), real(cell.load), text(cell.temperature), check.status()];
    fields.push(text(check.layer.as_ref().ok().map(|layer| layer.w)));
    let element = check.element.as_ref().and_then(|element| element.as_ref().ok());
    for i in 0..NAMES.len() {
        fields.push(text(check.values().map(|values| values[i])));
        fields.push(text(element.map(|values| values[i])));
        fields.push(text(check.errors().map(|errors| errors[i])));
    }
    fields
}

/// Errors over speed, one line a load.
pub(super) fn picture(checks: &[Check], load: Load) -> Ladders {
    let mut loads: Vec<f64> = checks.iter().map(|check| check.cell.load).collect();
    loads.sort_by(f64::total_cmp);
    loads.dedup();
    let ladder = |(look, &of): (usize, &f64), i: usize| {
        let own = checks.iter().filter(|check| check.cell.load == of);
        let rung =
            |check: &Check| Some(Rung { x: check.cell.speed, y: check.errors()?[i].abs(), label: String::new() });
        let name = format!("{:.3e} {}", of, load.unit());
        Ladder { name, dashed: false, look, rungs: own.filter_map(rung).collect() }
    };
    let panel = |(i, name): (usize, &&str)| LadderPanel {
        title: format!("error of {name}, as a share of it"),
        floor: None,
        ladders: loads.iter().enumerate().map(|of| ladder(of, i)).collect(),
    };
    Ladders { x_title: "speed in m/s".into(), panels: NAMES.iter().enumerate().map(panel).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_picked_evenly_and_each_once() {
        let cell = |speed: f64| Cell { speed, load: 1.0, temperature: None };
        let cells: Vec<Cell> = (0..10).map(|i| cell(f64::from(i))).collect();
        let speeds = |count| picked(cells.clone(), count).iter().map(|cell| cell.speed).collect::<Vec<_>>();
        assert_eq!(speeds(2), [2.0, 7.0]);
        assert_eq!(speeds(99), (0..10).map(f64::from).collect::<Vec<_>>());
    }
}
