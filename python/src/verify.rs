//! Whether an FMU is what this package packs.

use std::ffi::OsString;
use std::path::PathBuf;

use asperity_study::pack::{self, LibraryFile, NumberColumns};
use numpy::IntoPyArray as _;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::background::in_background;
use crate::errors::Raise as _;

/// Verifies an FMU; `libraries` are those of this package, as `asperity pack --library` takes them.
#[pyfunction]
pub(crate) fn verify(py: Python<'_>, fmu: PathBuf, libraries: Vec<OsString>) -> PyResult<Bound<'_, PyDict>> {
    let own: Vec<LibraryFile> = libraries.iter().map(|text| LibraryFile::named(text)).collect();
    let found = in_background(py, None, move |_| pack::verify(&fmu, &own))?.map_err(|error| error.raise())?;
    let facts: Vec<(String, String)> = found.facts.into_iter().map(|(label, text)| (label.into(), text)).collect();
    let dictionary = PyDict::new(py);
    dictionary.set_item("facts", facts)?;
    dictionary.set_item("problems", found.problems)?;
    dictionary.set_item("why_none", found.carried.as_ref().err())?;
    if let Ok(carried) = found.carried {
        dictionary.set_item("experiment", columns(py, carried.experiment)?)?;
        dictionary.set_item("result", columns(py, carried.result)?)?;
        dictionary.set_item("description", carried.description)?;
    }
    Ok(dictionary)
}

fn columns(py: Python<'_>, columns: NumberColumns) -> PyResult<Bound<'_, PyDict>> {
    let dictionary = PyDict::new(py);
    columns.into_iter().try_for_each(|(name, values)| dictionary.set_item(name, values.into_pyarray(py)))?;
    Ok(dictionary)
}
