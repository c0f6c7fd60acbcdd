//! Numbers of a scene from measured friction.

use std::ops::ControlFlow;
use std::sync::Arc;

use asperity_study::calibration::{
    Calibration, CalibrationOptions, FitCovariance, calibrate_scene, chi_square_per_degree,
};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use pythonize::pythonize;

use crate::background::in_background;
use crate::errors::Raise as _;
use crate::options::Options;
use crate::scene::Scene;

/// Fits numbers of the scene to the measured friction in a file.
#[pyfunction]
pub(crate) fn calibrate<'py>(
    py: Python<'py>,
    scene: &Scene,
    options: Options<CalibrationOptions>,
) -> PyResult<Bound<'py, PyDict>> {
    let options = options.0;
    let (data, text) = (Arc::clone(&scene.scene), scene.text());
    let found = in_background(py, None, move |task| {
        calibrate_scene((*data).clone(), text, &options, || {
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
    let measured = PyList::empty(py);
    for row in &calibration.measurements.rows {
        let (point, model) = (row.point, calibration.friction_at(&row.point));
        measured.append((point.speed, point.load, point.temperature, row.friction, row.sigma, model))?;
    }
    let found = PyDict::new(py);
    found.set_item("parameters", pythonize(py, &calibration.parameters())?)?;
    found.set_item("correlation", correlation)?;
    found.set_item("chi_square", chi_square_per_degree(statistics.chi_square, statistics.degrees))?;
    found.set_item("is_whole", calibration.is_whole())?;
    found.set_item("measured", measured)?;
    found.set_item("warnings", calibration.warnings())?;
    found.set_item("notes", &calibration.measurements.notes)?;
    found.set_item("text", text)?;
    Ok(found)
}
