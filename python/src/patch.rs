//! Contact patches: many point-contact elements on a rigid face.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use asperity::patch::{PatchMotion, PatchStart, PatchVariable, Pose};
use asperity_study::Error;
use asperity_study::pack::FmuOptions;
use asperity_study::summary::{LabelledLine, described_patch, missing_backing};
use asperity_study::tyre::{self, SlipOptions};
use numpy::{IntoPyArray as _, PyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::background::in_background;
use crate::errors::{Raise as _, check_dt, no_output};
use crate::found::{FoundColumn, Picture, columns};
use crate::options::Options;
use crate::pack::pack;
use crate::state::state_class;

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
        let patch = asperity_study::files::load_patch(&file, &[]).map_err(|error| error.raise())?;
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

    /// The summary, in lines with labels.
    fn describe(&self) -> Vec<LabelledLine> {
        described_patch(&self.patch)
    }

    /// What is probably not meant.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        missing_backing(&self.patch).into_iter().collect()
    }

    /// The files that it reads, as it names them.
    fn files(&self) -> Vec<PathBuf> {
        self.patch.files().to_vec()
    }

    fn __len__(&self) -> usize {
        self.patch.count()
    }

    /// Writes an FMU.
    fn pack(&self, output: PathBuf, libraries: Vec<OsString>, options: Options<FmuOptions>) -> PyResult<Vec<String>> {
        pack(&self.patch.clone().into(), &self.file, &libraries, (&output, options))
    }

    /// Forces over slip and slip angle.
    fn slip(&self, py: Python<'_>, options: Options<SlipOptions>, progress: Option<Py<PyAny>>) -> PyResult<SlipCurves> {
        let (patch, Options(options)) = (self.patch.clone(), options);
        let found = in_background(py, progress, move |task| {
            let (parts, done) = (options.parts(&patch) as f64, AtomicUsize::new(0));
            let tell = || task.report((1 + done.fetch_add(1, Ordering::Relaxed)) as f64 / parts);
            tyre::SlipCurves::new(&patch, &options, (&task.stop(), &tell))
        })?;
        let curves = found.map_err(|error: Error| error.raise())?;
        Ok(SlipCurves { warnings: curves.warnings(&self.patch), curves })
    }
}

/// Slip curves of a patch.
#[pyclass(frozen, module = "asperity._native")]
#[derive(Debug)]
pub(crate) struct SlipCurves {
    curves: tyre::SlipCurves,
    #[pyo3(get)]
    warnings: Vec<String>,
}

/// The Magic Formula, fitted to them.
#[pyclass(frozen, module = "asperity._native")]
#[derive(Debug)]
pub(crate) struct MagicFormula(tyre::MagicFormula);

#[pymethods]
impl SlipCurves {
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Vec<FoundColumn<'py>>> {
        columns(py, &self.curves.table())
    }

    /// The table as the program writes it.
    fn text(&self) -> String {
        self.curves.table().text()
    }

    fn picture(&self, fit: Option<&MagicFormula>) -> Picture {
        Picture(self.curves.picture(fit.map(|fit| &fit.0)))
    }

    fn magic_formula(&self, nominal: Option<f64>) -> PyResult<MagicFormula> {
        tyre::MagicFormula::new(&self.curves, nominal).map(MagicFormula).map_err(|error| error.raise())
    }
}

#[pymethods]
impl MagicFormula {
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Vec<FoundColumn<'py>>> {
        columns(py, &self.0.table())
    }

    /// The table as the program writes it.
    fn text(&self) -> String {
        self.0.table().text()
    }
}

state_class!(PatchState, asperity::patch::PatchState, "a patch");

/// A patch that is moved step by step.
#[pyclass(frozen, module = "asperity._native")]
#[derive(Debug)]
pub(crate) struct PatchRun {
    run: Mutex<asperity::patch::PatchRun>,
    variables: Vec<PatchVariable>,
    has_tread: bool,
}

/// Refuses a speed (m/s) of a tread that the patch does not have.
fn check_tread(has_tread: bool, speed: f64) -> PyResult<()> {
    if has_tread || speed == 0.0 {
        return Ok(());
    }
    Err(PyValueError::new_err(format!("transport_speed = {speed}: expected 0, since the patch has no tread")))
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
        check_tread(patch.patch.has_tread(), transport_speed)?;
        let temperature = temperature.unwrap_or(patch.patch.temperature());
        let start = PatchStart { time: 0.0, pose: Pose::from_coordinates(pose), rates, transport_speed, temperature };
        let run = asperity::patch::PatchRun::new(&patch.patch, &start).map_err(|error| error.raise())?;
        Ok(Self { run: Mutex::new(run), variables: patch.patch.variables(), has_tread: patch.patch.has_tread() })
    }

    /// A run that goes on from a state.
    #[staticmethod]
    fn restore(patch: &Patch, state: &PatchState) -> PyResult<Self> {
        let run = asperity::patch::PatchRun::restore(&patch.patch, &state.0).map_err(|error| error.raise())?;
        Ok(Self { run: Mutex::new(run), variables: patch.patch.variables(), has_tread: patch.patch.has_tread() })
    }

    /// Moves the body for `dt` to a pose or at rates of its coordinates; else it rests. What is not given stays.
    #[pyo3(signature = (dt, pose=None, *, rates=None, transport_speed=None, temperature=None))]
    fn advance(
        &self,
        py: Python<'_>,
        dt: f64,
        pose: Option<[f64; 6]>,
        rates: Option<[f64; 6]>,
        transport_speed: Option<f64>,
        temperature: Option<f64>,
    ) -> PyResult<()> {
        check_dt(dt)?;
        check_tread(self.has_tread, transport_speed.unwrap_or(0.0))?;
        if pose.is_some() && rates.is_some() {
            return Err(PyValueError::new_err("pose and rates: expected one of them"));
        }
        let moved = py.detach(|| {
            let mut run = self.run();
            let here = run.pose().coordinates();
            let there = pose.map(|there| std::array::from_fn(|i| (there[i] - here[i]) / dt));
            let motion = PatchMotion {
                duration: dt,
                rates: there.or(rates).unwrap_or_default(),
                transport_speed: transport_speed.unwrap_or(run.transport_speed()),
                temperature: temperature.unwrap_or(run.temperature()),
            };
            run.advance(&motion)
        });
        moved.map_err(|error| error.raise())
    }

    fn state(&self) -> PatchState {
        PatchState(self.run().save())
    }

    fn set_state(&self, state: &PatchState) -> PyResult<()> {
        self.run().set_state(&state.0).map_err(|error| error.raise())
    }

    /// A run that goes on as this one.
    fn copy(&self) -> Self {
        Self { run: Mutex::new(self.run().clone()), variables: self.variables.clone(), has_tread: self.has_tread }
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
