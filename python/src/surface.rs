//! Surfaces: read, smoothed, split, made periodic, analysed.

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

use asperity::scene::{LoadedProfile, ProfileOptions, UnknownWord};
use asperity_formats::Instruments;
use asperity_study::surface::{
    MadePeriodic, SurfaceAnalysis, SurfaceError, SurfaceOptions, TreatedSurface, matrix, profile_columns,
    spectrum_columns,
};
use numpy::{IntoPyArray as _, ToPyArray as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::background::in_background;
use crate::errors::Raise as _;
use crate::scene::Scene;

/// How a file of a profile is read.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Reading {
    unit: Option<String>,
    x_unit: Option<String>,
    z_unit: Option<String>,
    missing: Option<String>,
    tilt: Option<String>,
    depth: Option<String>,
    third_column: Option<String>,
    columns: Vec<(String, String)>,
    spacing: Vec<f64>,
    line: Option<usize>,
    periodic: bool,
}

fn word<T: FromStr<Err = UnknownWord>>(name: &str, word: Option<&String>) -> PyResult<Option<T>> {
    let refused = |word: &str, error: UnknownWord| PyValueError::new_err(format!("{name} = {word:?}: {error}"));
    word.map(|word| word.parse().map_err(|error| refused(word, error))).transpose()
}

impl Reading {
    fn options(&self) -> PyResult<ProfileOptions> {
        Ok(ProfileOptions {
            x_unit: word("x_unit", self.x_unit.as_ref().or(self.unit.as_ref()))?,
            z_unit: word("z_unit", self.z_unit.as_ref().or(self.unit.as_ref()))?,
            missing: word("missing", self.missing.as_ref())?.unwrap_or_default(),
            tilt: word("tilt", self.tilt.as_ref())?.unwrap_or_default(),
            depth: word("depth", self.depth.as_ref())?,
            third_column: word("third_column", self.third_column.as_ref())?,
            columns: self.columns.clone(),
            spacing: self.spacing.clone(),
            line: self.line,
            periodic: self.periodic,
        })
    }
}

/// What is done with a surface: smoothed, split, mirrored, tapered, and the wavelengths of its power law.
type Treatment = (Option<f64>, Option<f64>, bool, bool, Option<(f64, f64)>);

fn options((smooth, split, mirror, taper, wavelengths): Treatment, line_alone: bool) -> SurfaceOptions {
    let periodic = match (mirror, taper) {
        (true, _) => Some(MadePeriodic::Mirrored),
        (_, true) => Some(MadePeriodic::Tapered),
        _ => None,
    };
    let wavelengths = wavelengths.map(|(shortest, longest)| shortest..=longest);
    SurfaceOptions { smooth, split, periodic, line_alone, wavelengths }
}

/// The surface in a file.
#[pyfunction]
pub(crate) fn surface<'py>(
    py: Python<'py>,
    path: PathBuf,
    reading: Reading,
    treatment: Treatment,
) -> PyResult<Bound<'py, PyDict>> {
    let (reading, treated) = (reading.options()?, options(treatment, reading.line.is_some()));
    let found = in_background(py, None, move |_| {
        let read = asperity::scene::Surface::load(Path::new(&path), &reading, &Instruments);
        read.map(|LoadedProfile { surface, warnings, notes }| {
            (TreatedSurface::new(surface, &treated), warnings, notes.into_iter().map(|note| note.text).collect())
        })
    })?;
    let (treated, warnings, notes): (_, Vec<String>, Vec<String>) = found.map_err(|error| error.raise())?;
    as_dictionary(py, treated, treatment.2, (warnings, notes))
}

/// The surface of a scene.
#[pyfunction]
pub(crate) fn surface_of<'py>(py: Python<'py>, scene: &Scene, treatment: Treatment) -> PyResult<Bound<'py, PyDict>> {
    let (scene, treated) = (Arc::clone(&scene.scene), options(treatment, false));
    let found = in_background(py, None, move |_| TreatedSurface::new(scene.surface.clone(), &treated))?;
    as_dictionary(py, found, treatment.2, (Vec::new(), Vec::new()))
}

fn as_dictionary<'py>(
    py: Python<'py>,
    treated: Result<TreatedSurface, SurfaceError>,
    mirrored: bool,
    (warnings, notes): (Vec<String>, Vec<String>),
) -> PyResult<Bound<'py, PyDict>> {
    let TreatedSurface { read, surface, finer, analysis } = treated.map_err(|error| error.raise())?;
    let found = PyDict::new(py);
    found.set_item("x", surface.x().to_pyarray(py))?;
    found.set_item("z", surface.z().to_pyarray(py))?;
    found.set_item("read", (read.x().to_pyarray(py), read.z().to_pyarray(py)))?;
    let json = serde_json::to_string(&analysis).map_err(|error| PyValueError::new_err(error.to_string()))?;
    found.set_item("analysis", json)?;
    found.set_item("law", pairs(py, &analysis.law_curve()))?;
    let spectrum = |analysis: &SurfaceAnalysis| {
        let bands = analysis.spectrum.iter().map(|band| [band.wave_number, band.density]);
        bands.collect::<Vec<_>>()
    };
    found.set_item("spectrum", pairs(py, &spectrum(&analysis)))?;
    let isotropic = finer.as_ref().map(|finer| finer.points()).or(analysis.map.as_ref().map(|map| &map.spectrum[..]));
    found.set_item("isotropic", isotropic.map(|points| pairs(py, points)))?;
    found.set_item("isotropic_text", isotropic.map(spectrum_columns))?;
    let whole = surface.map().filter(|_| mirrored);
    found.set_item("text", whole.map_or_else(|| profile_columns(&surface), matrix))?;
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
