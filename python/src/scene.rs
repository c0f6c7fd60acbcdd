//! A scene: the text of a file, keys set in it, and what it says.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;

use asperity::scene::Setting;
use asperity_study::files::parse_scene;
use asperity_study::pack::FmuOptions;
use asperity_study::settings::edited;
use asperity_study::summary::{LabelledLine, described};
use numpy::{PyArray1, PyArrayMethods as _, ToPyArray as _};
use pyo3::IntoPyObjectExt as _;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use toml::Value;

use crate::errors::Raise as _;
use crate::options::Options;
use crate::pack::pack;

/// The text of a scene file with keys set, read and checked.
#[pyclass(frozen, module = "asperity._native")]
#[derive(Debug)]
pub(crate) struct Scene {
    text: String,
    pub(crate) file: PathBuf,
    settings: Vec<(String, String)>,
    pub(crate) scene: Arc<asperity::scene::Scene>,
}

/// Heights line by line, points of a line, distances along x and y.
type Map<'py> = (Bound<'py, PyArray1<f64>>, usize, [f64; 2]);

#[pymethods]
impl Scene {
    #[new]
    fn new(text: String, file: PathBuf, settings: Vec<(String, String)>) -> PyResult<Self> {
        let scene = parse_scene(&text, &file, &parsed(&settings)).map_err(|error| error.raise())?;
        Ok(Self { text, file, settings, scene: Arc::new(scene) })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.scene.name
    }

    #[getter]
    fn file(&self) -> PathBuf {
        self.file.clone()
    }

    #[getter]
    fn source(&self) -> &str {
        &self.text
    }

    #[getter]
    fn settings(&self) -> Vec<(String, String)> {
        self.settings.clone()
    }

    #[getter]
    fn duration(&self) -> f64 {
        self.scene.duration()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.scene.warnings.clone()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.scene.notes.iter().map(|note| note.text.clone()).collect()
    }

    /// The notes of what was assumed in the tables.
    #[getter]
    fn assumptions(&self) -> Vec<String> {
        self.scene.notes.iter().filter(|note| note.assumed).map(|note| note.text.clone()).collect()
    }

    /// The summary, in lines with labels.
    fn describe(&self) -> PyResult<Vec<LabelledLine>> {
        described(&self.scene).map_err(|error| error.raise())
    }

    /// The text with the keys set.
    pub(crate) fn text(&self) -> String {
        edited(&self.text, &parsed(&self.settings))
    }

    /// The files that the scene reads, as it names them.
    fn files(&self) -> Vec<PathBuf> {
        self.scene.files.iter().map(|file| file.path.clone()).collect()
    }

    /// What stands at a key of the text, tables as dictionaries.
    fn get<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyAny>> {
        let found = self.scene.values.get(key).ok_or_else(|| PyKeyError::new_err(key.to_owned()))?;
        to_python(py, found)
    }

    /// x and z of the data points of the profile.
    fn profile<'py>(&self, py: Python<'py>) -> (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>) {
        (self.scene.surface.x().to_pyarray(py), self.scene.surface.z().to_pyarray(py))
    }

    /// The map that the profile is a line of.
    fn map<'py>(&self, py: Python<'py>) -> Option<Map<'py>> {
        let map = self.scene.surface.map()?;
        Some((map.heights().to_pyarray(py), map.nx(), map.spacing()))
    }

    /// E' and E'' at angular frequencies; of the material alone.
    fn modulus<'py>(&self, py: Python<'py>, omega: &Bound<'py, PyArray1<f64>>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let missing = || PyKeyError::new_err("material");
        let material = self.scene.material.as_ref().ok_or_else(missing)?;
        let omega = omega.readonly();
        let values = omega.as_slice()?.iter().flat_map(|&omega| {
            let (storage, loss) = material.complex_modulus(omega);
            [storage, loss]
        });
        Ok(PyArray1::from_iter(py, values))
    }

    /// Writes an FMU. The file of the scene has to hold what the scene is.
    fn pack(&self, output: PathBuf, libraries: Vec<OsString>, options: Options<FmuOptions>) -> PyResult<Vec<String>> {
        let definition = (*self.scene).clone().into();
        pack(&definition, &self.file, &libraries, (&output, options))
    }

    /// Whether the scene is the same as another, whatever text and files it is read from.
    fn is_same(&self, other: &Self) -> bool {
        self.scene.is_same(&other.scene)
    }
}

/// The settings of `--set`.
fn parsed(settings: &[(String, String)]) -> Vec<Setting> {
    settings.iter().map(|(key, value)| Setting::parse(key, value)).collect()
}

fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    match value {
        Value::String(text) => text.into_bound_py_any(py),
        Value::Integer(whole) => whole.into_bound_py_any(py),
        Value::Float(number) => number.into_bound_py_any(py),
        Value::Boolean(flag) => flag.into_bound_py_any(py),
        Value::Datetime(time) => time.to_string().into_bound_py_any(py),
        Value::Array(values) => {
            let list = PyList::empty(py);
            for value in values {
                list.append(to_python(py, value)?)?;
            }
            Ok(list.into_any())
        }
        Value::Table(table) => {
            let dictionary = PyDict::new(py);
            for (key, value) in table {
                dictionary.set_item(key, to_python(py, value)?)?;
            }
            Ok(dictionary.into_any())
        }
    }
}
