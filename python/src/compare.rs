//! A table of a sweep beside measured friction.

use std::path::PathBuf;

use asperity::element::OperatingPoint;
use asperity_study::comparison::Comparison;
use asperity_study::sweep::SweepTable;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::errors::Raise as _;

/// Compares a table with the measurements in a file.
#[pyfunction]
pub(crate) fn compare<'py>(
    py: Python<'py>,
    table: PathBuf,
    data: PathBuf,
    columns: Vec<(String, String)>,
) -> PyResult<Bound<'py, PyDict>> {
    let swept = SweepTable::read(&table).map_err(|error| error.raise())?;
    let comparison = Comparison::new(&swept, &table, &data, &columns).map_err(|error| error.raise())?;
    let place = |point: &OperatingPoint| (point.speed, point.load, point.temperature);
    let (worst, left_out) = (PyList::empty(py), PyList::empty(py));
    for (row, friction, deviations) in comparison.worst_first() {
        let (speed, pressure, temperature) = place(&row.point);
        let sigma = row.sigma_or_assumed();
        worst.append((row.line, speed, pressure, temperature, row.friction, sigma, friction, deviations))?;
    }
    for (row, why) in &comparison.left_out {
        let (speed, pressure, temperature) = place(&row.point);
        left_out.append((row.line, speed, pressure, temperature, row.friction, why.to_string()))?;
    }
    let found = PyDict::new(py);
    found.set_item("refused", comparison.check(&data).err().map(|error| error.to_string()))?;
    found.set_item("scene", swept.header.scene())?;
    found.set_item("worst", worst)?;
    found.set_item("left_out", left_out)?;
    found.set_item("chi_square", comparison.chi_square())?;
    found.set_item("sigma_assumed", comparison.within.iter().any(|(row, _)| row.sigma.is_none()))?;
    found.set_item("curves", curves(py, &comparison)?)?;
    found.set_item("warnings", comparison.left_out_in_words().into_iter().collect::<Vec<_>>())?;
    found.set_item("notes", &comparison.notes)?;
    Ok(found)
}

/// Of each curve its pressure and temperature, the table's points along it, and the lines of the measurements on it.
fn curves<'py>(py: Python<'py>, comparison: &Comparison) -> PyResult<Bound<'py, PyList>> {
    let curves = PyList::empty(py);
    for condition in &comparison.grid.conditions {
        for pressure in &comparison.grid.pressures {
            let is_on = |point: &OperatingPoint| comparison.grid.is_on(point, pressure, condition);
            let swept = comparison.swept.iter().filter(|(point, _)| is_on(point));
            let mut points: Vec<(f64, f64)> = swept.map(|(point, friction)| (point.speed, *friction)).collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let on = comparison.within.iter().filter(|(row, _)| is_on(&row.point));
            let lines: Vec<usize> = on.map(|(row, _)| row.line).collect();
            if !lines.is_empty() {
                let temperature = condition.temperature.map(|cluster| cluster.mean);
                curves.append((pressure.mean, temperature, points, lines))?;
            }
        }
    }
    Ok(curves)
}
