//! A table of a sweep beside measured friction.

use std::path::Path;

use asperity::element::OperatingPoint;
use asperity_study::comparison::{CompareOptions, Comparison};
use asperity_study::sweep::SweepTable;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::errors::Raise as _;
use crate::found::Picture;

/// Compares a table with what is measured.
pub(crate) fn compare<'py>(
    py: Python<'py>,
    swept: &SweepTable,
    options: &CompareOptions,
) -> PyResult<Bound<'py, PyDict>> {
    let comparison = Comparison::new(swept, Path::new("table"), options).map_err(|error| error.raise())?;
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
    found.set_item("refused", comparison.check(&options.data).err().map(|error| error.to_string()))?;
    found.set_item("scene", swept.header.scene())?;
    found.set_item("worst", worst)?;
    found.set_item("left_out", left_out)?;
    found.set_item("chi_square", comparison.chi_square())?;
    found.set_item("sigma_assumed", comparison.within.iter().any(|(row, _)| row.sigma.is_none()))?;
    found.set_item("picture", Picture(comparison.picture(swept.header.scene())).into_pyobject(py)?)?;
    found.set_item("warnings", comparison.left_out_in_words().into_iter().collect::<Vec<_>>())?;
    found.set_item("notes", &comparison.notes)?;
    Ok(found)
}
