//! Surfaces: read, smoothed, split, made periodic, analysed.

use std::path::PathBuf;
use std::sync::Arc;

use asperity_formats::Instruments;
use asperity_study::Error;
use asperity_study::surface::{ProfileReading, SurfaceOptions, TreatedSurface};
use numpy::{IntoPyArray as _, ToPyArray as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::background::in_background;
use crate::errors::Raise as _;
use crate::found::Picture;
use crate::options::Options;
use crate::scene::Scene;

/// The surface in a file.
#[pyfunction]
pub(crate) fn surface<'py>(
    py: Python<'py>,
    path: PathBuf,
    reading: Options<ProfileReading>,
    treatment: Options<SurfaceOptions>,
) -> PyResult<Bound<'py, PyDict>> {
    let (Options(reading), Options(treatment)) = (reading, treatment);
    let found = in_background(py, None, move |_| {
        treatment.check(reading.periodic)?;
        let read = asperity::scene::Surface::load(&path, &reading.options(), &Instruments)?;
        let treated = TreatedSurface::new(read.surface, &treatment, reading.line)?;
        Ok::<_, Error>((treated, read.warnings, read.notes.into_iter().map(|note| note.text).collect()))
    })?;
    let (treated, warnings, notes) = found.map_err(|error| error.raise())?;
    as_dictionary(py, &treated, (warnings, notes))
}

/// The surface of a scene.
#[pyfunction]
pub(crate) fn surface_of<'py>(
    py: Python<'py>,
    scene: &Scene,
    treatment: Options<SurfaceOptions>,
) -> PyResult<Bound<'py, PyDict>> {
    let scene = Arc::clone(&scene.scene);
    let found = in_background(py, None, move |_| TreatedSurface::new(scene.surface.clone(), &treatment.0, None))?;
    as_dictionary(py, &found.map_err(|error| error.raise())?, (Vec::new(), Vec::new()))
}

fn as_dictionary<'py>(
    py: Python<'py>,
    treated: &TreatedSurface,
    (warnings, notes): (Vec<String>, Vec<String>),
) -> PyResult<Bound<'py, PyDict>> {
    let TreatedSurface { surface, analysis, .. } = treated;
    let found = PyDict::new(py);
    found.set_item("x", surface.x().to_pyarray(py))?;
    found.set_item("z", surface.z().to_pyarray(py))?;
    found.set_item("picture", Picture(treated.picture()).into_pyobject(py)?)?;
    let json = serde_json::to_string(analysis).map_err(|error| PyValueError::new_err(error.to_string()))?;
    found.set_item("analysis", json)?;
    let bands: Vec<[f64; 2]> = analysis.spectrum.iter().map(|band| [band.wave_number, band.density]).collect();
    found.set_item("spectrum", pairs(py, &bands))?;
    found.set_item("isotropic", treated.isotropic().map(|points| pairs(py, points)))?;
    found.set_item("isotropic_text", treated.spectrum_file())?;
    found.set_item("text", treated.file())?;
    let map = surface.map().map(|map| (map.heights().to_pyarray(py), map.nx(), map.spacing()));
    found.set_item("map", map)?;
    found.set_item("notes", notes)?;
    found.set_item("warnings", warnings)?;
    Ok(found)
}

/// Two numbers each.
fn pairs<'py>(py: Python<'py>, points: &[[f64; 2]]) -> Bound<'py, numpy::PyArray1<f64>> {
    points.concat().into_pyarray(py)
}
