//! The masses of a run: its animation, and its contact at a time.

use std::sync::Arc;

use asperity::scene::Scene as SceneData;
use asperity_study::masses::{ElementField, ElementHistory, Instant, Span, animation};
use numpy::{IntoPyArray as _, PyReadonlyArray1, ToPyArray as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::found::Picture;
use crate::scene::Scene;

/// Numbers of a row: time, u, w, F_x, F_z.
const OF_ROW: usize = 5;
/// Points of the profile along the layer.
const COLUMNS: u32 = 2000;

/// Row by row, and the fields of the masses.
pub(crate) fn recorded(history: ElementHistory) -> (Vec<f64>, Vec<ElementField>) {
    let (rows, fields) = history.into_rows_and_fields();
    (rows.iter().flat_map(|row| [row.time, row.u, row.w, row.force_x, row.force_z]).collect(), fields)
}

/// What was [`recorded`] of a run of the scene, the fields of a mass beside each other.
fn history(scene: &SceneData, rows: &[f64], masses: &[f64]) -> PyResult<ElementHistory> {
    let mut history = ElementHistory::new(scene);
    let of_row = scene.layer.masses * history.fields().fields().len();
    let (rows, left) = rows.as_chunks::<OF_ROW>();
    if !left.is_empty() || rows.len() * of_row != masses.len() {
        return Err(PyValueError::new_err("expected the masses of a run of this scene"));
    }
    for (&[time, u, w, force_x, force_z], masses) in rows.iter().zip(masses.chunks(of_row)) {
        history.add_values(Instant { time, u, w, force_x, force_z }, masses);
    }
    Ok(history)
}

/// The page of a run.
#[pyfunction]
pub(crate) fn animate(
    scene: &Scene,
    rows: PyReadonlyArray1<'_, f64>,
    masses: PyReadonlyArray1<'_, f64>,
) -> PyResult<String> {
    let history = history(&Arc::clone(&scene.scene), rows.as_slice()?, masses.as_slice()?)?;
    animation(&history).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// The masses at the row that is nearest to a time, and what is drawn around them.
#[pyfunction]
pub(crate) fn moment<'py>(
    py: Python<'py>,
    scene: &Scene,
    rows: PyReadonlyArray1<'_, f64>,
    masses: PyReadonlyArray1<'_, f64>,
    time: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let history = history(&scene.scene, rows.as_slice()?, masses.as_slice()?)?;
    let row = history.row_at(time).ok_or_else(|| PyValueError::new_err("the run has no rows"))?;
    let (instant, elements) = (history.rows()[row], history.elements(row).collect::<Vec<_>>());
    let found = PyDict::new(py);
    found.set_item("picture", Picture(history.picture(row)).into_pyobject(py)?)?;
    for (name, value) in [("time", instant.time), ("u", instant.u), ("w", instant.w), ("slides", history.slides(row))] {
        found.set_item(name, value)?;
    }
    let of_masses = |value: fn(&asperity_study::masses::Element) -> f64| {
        elements.iter().map(value).collect::<Vec<_>>().into_pyarray(py)
    };
    found.set_item("x", of_masses(|mass| mass.x))?;
    found.set_item("z", of_masses(|mass| mass.z))?;
    found.set_item("load", of_masses(|mass| mass.load))?;
    found.set_item("flash", history.has_flash().then(|| of_masses(|mass| mass.flash)))?;
    found.set_item("touch", elements.iter().map(|mass| mass.touch.name()).collect::<Vec<_>>())?;
    found.set_item("load_unit", history.load_unit())?;
    found.set_item("heights", Span::over(&history, &[row]).heights)?;
    found.set_item("spacing", history.spacing())?;
    let (left, right) = history.ends();
    let places = (0..=COLUMNS).map(|i| left + instant.u + (right - left) * f64::from(i) / f64::from(COLUMNS));
    let places: Vec<f64> = places.collect();
    let heights: Vec<f64> = places.iter().map(|x| history.surface().spline().evaluate(*x).0).collect();
    found.set_item("profile", (places.to_pyarray(py), heights.into_pyarray(py)))?;
    Ok(found)
}
