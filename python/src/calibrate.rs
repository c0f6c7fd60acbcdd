//! Numbers of a scene from measured friction.

use std::ops::ControlFlow;
use std::path::PathBuf;

use asperity_study::calibration::{
    Calibration, CalibrationOptions, FitCovariance, FreeParameter, calibrate_scene, chi_square_per_degree,
};
use asperity_study::files::ColumnOptions;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::background::in_background;
use crate::errors::Raise as _;
use crate::scene::{Scene, parsed};
use crate::sweep::sliding;

/// Fits numbers of the scene to the measured friction in a file.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub(crate) fn calibrate<'py>(
    py: Python<'py>,
    scene: &Scene,
    data: PathBuf,
    columns: Vec<(String, String)>,
    free: Vec<(String, f64, f64)>,
    method: Option<&str>,
    way: Option<f64>,
    points: Option<u32>,
    error: Option<f64>,
    distance: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let parameter = |(key, low, high): (String, f64, f64)| {
        let refused = format!("{key}: expected bounds (low, high), low below high, found ({low}, {high})");
        FreeParameter::new(key, low, high).ok_or_else(|| PyValueError::new_err(refused))
    };
    let options = CalibrationOptions {
        scene: scene.file.clone(),
        set: parsed(&scene.settings),
        free: free.into_iter().map(parameter).collect::<PyResult<_>>()?,
        data,
        columns: ColumnOptions { columns },
        sliding: sliding(method, way, points, error, distance)?,
    };
    let text = scene.text.clone();
    let found = in_background(py, None, move |task| {
        calibrate_scene(&text, &options, || {
            if task.is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
    })?;
    let (calibration, text, covariance) = found.map_err(|error| error.raise())?;
    let found = as_dictionary(py, &calibration, text)?;
    add_covariance(&found, &covariance)?;
    Ok(found)
}

/// The text of a scene which names the table of a covariance of `keys`, without their spreads.
#[pyfunction]
pub(crate) fn with_covariance(text: &str, file: &str, keys: Vec<String>) -> String {
    let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
    asperity_study::calibration::with_covariance(text, file, &keys)
}

fn add_covariance(found: &Bound<'_, PyDict>, covariance: &FitCovariance) -> PyResult<()> {
    let keys: Vec<&str> = covariance.numbers.iter().map(|number| number.key.as_str()).collect();
    found.set_item("covariance_keys", keys)?;
    found.set_item("covariance", &covariance.entries)?;
    found.set_item("covariance_text", covariance.text())
}

fn as_dictionary<'py>(py: Python<'py>, calibration: &Calibration, text: String) -> PyResult<Bound<'py, PyDict>> {
    let statistics = &calibration.statistics;
    let correlation: Vec<Vec<f64>> =
        statistics.correlation.row_iter().map(|row| row.iter().copied().collect()).collect();
    let rows = PyList::empty(py);
    for one in calibration.parameters() {
        let row = PyDict::new(py);
        row.set_item("key", one.key)?;
        row.set_item("before", one.before)?;
        row.set_item("value", one.value)?;
        row.set_item("standard_error", one.standard_error)?;
        row.set_item("interval", one.interval)?;
        row.set_item("is_identifiable", one.is_identifiable)?;
        rows.append(row)?;
    }
    let measured = PyList::empty(py);
    for row in &calibration.measurements.rows {
        let (point, model) = (row.point, calibration.friction_at(&row.point));
        measured.append((point.speed, point.load, point.temperature, row.friction, row.sigma, model))?;
    }
    let found = PyDict::new(py);
    found.set_item("parameters", rows)?;
    found.set_item("correlation", correlation)?;
    found.set_item("chi_square", chi_square_per_degree(statistics.chi_square, statistics.degrees))?;
    found.set_item("is_whole", calibration.is_whole())?;
    found.set_item("measured", measured)?;
    found.set_item("warnings", calibration.warnings())?;
    found.set_item("notes", &calibration.measurements.notes)?;
    found.set_item("text", text)?;
    Ok(found)
}
