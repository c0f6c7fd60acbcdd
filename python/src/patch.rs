//! Contact patches: many point-contact elements on a rigid face.

use std::ffi::OsString;
use std::fs;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

use asperity::patch::{PatchMotion, PatchStart, PatchVariable, Pose};
use asperity::program::fmu;
use numpy::{IntoPyArray as _, PyArray1};
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;

use crate::errors::{Raise as _, no_output};

/// A contact patch, read from its file.
#[pyclass(frozen, module = "asperity._native")]
#[derive(Debug)]
pub(crate) struct Patch {
    patch: asperity::patch::Patch,
    file: PathBuf,
}

#[pymethods]
impl Patch {
    #[new]
    fn new(file: PathBuf) -> PyResult<Self> {
        let patch = asperity::patch::Patch::load(&file).map_err(|error| error.raise())?;
        Ok(Self { patch, file })
    }

    #[getter]
    fn name(&self) -> &str {
        self.patch.name()
    }

    #[getter]
    fn file(&self) -> PathBuf {
        self.file.clone()
    }

    #[getter]
    fn description(&self) -> String {
        self.patch.description()
    }

    /// The temperature where none is given, K; 0 where the table has none.
    #[getter]
    fn temperature(&self) -> f64 {
        self.patch.temperature()
    }

    fn __len__(&self) -> usize {
        self.patch.count()
    }

    /// Writes an FMU.
    fn pack(&self, output: PathBuf, libraries: Vec<OsString>) -> PyResult<()> {
        let bytes = fmu(&self.patch.clone().into(), &self.file, &libraries).map_err(|error| error.raise())?;
        fs::write(&output, bytes).map_err(|error| PyOSError::new_err(format!("{}: {error}", output.display())))
    }
}

/// A patch that is moved step by step.
#[pyclass(frozen, module = "asperity._native")]
#[derive(Debug)]
pub(crate) struct PatchRun {
    run: Mutex<asperity::patch::PatchRun>,
    variables: Vec<PatchVariable>,
}

impl PatchRun {
    fn run(&self) -> MutexGuard<'_, asperity::patch::PatchRun> {
        self.run.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl PatchRun {
    #[new]
    fn new(
        patch: &Patch,
        pose: [f64; 6],
        rates: [f64; 6],
        transport_speed: f64,
        temperature: Option<f64>,
    ) -> PyResult<Self> {
        let temperature = temperature.unwrap_or(patch.patch.temperature());
        let start = PatchStart { time: 0.0, pose: Pose::from_coordinates(pose), rates, transport_speed, temperature };
        let run = asperity::patch::PatchRun::new(&patch.patch, &start);
        let run = run.map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(Self { run: Mutex::new(run), variables: patch.patch.variables() })
    }

    /// Moves the body for `dt` at these rates of its coordinates.
    fn advance(
        &self,
        py: Python<'_>,
        dt: f64,
        rates: [f64; 6],
        transport_speed: Option<f64>,
        temperature: f64,
    ) -> PyResult<()> {
        let moved = py.detach(|| {
            let mut run = self.run();
            let transport_speed = transport_speed.unwrap_or(run.transport_speed());
            run.advance(&PatchMotion { duration: dt, rates, transport_speed, temperature })
        });
        moved.map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// The warnings since the last call.
    fn take_warnings(&self) -> Vec<String> {
        self.run().take_warnings()
    }

    #[getter]
    fn time(&self) -> f64 {
        self.run().time()
    }

    #[getter]
    fn pose(&self) -> [f64; 6] {
        self.run().pose().coordinates()
    }

    #[getter]
    fn names(&self) -> Vec<&str> {
        self.variables.iter().map(|variable| variable.name.as_str()).collect()
    }

    #[getter]
    fn units(&self) -> Vec<(&str, &'static str)> {
        self.variables.iter().map(|variable| (variable.name.as_str(), variable.unit.name())).collect()
    }

    fn value(&self, name: &str) -> PyResult<f64> {
        let found = self.variables.iter().find(|variable| variable.name == name);
        let variable = found.ok_or_else(|| no_output(name, self.names().into_iter()))?;
        let mut value = [0.0];
        self.run().evaluate(std::slice::from_ref(variable), &mut value);
        Ok(value[0])
    }

    fn values<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let mut values = vec![0.0; self.variables.len()];
        self.run().evaluate(&self.variables, &mut values);
        values.into_pyarray(py)
    }
}
