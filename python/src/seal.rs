//! Lips with a film.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use asperity::seal::{SealMotion, SealStart, SealVariable};
use asperity_study::Error;
use asperity_study::pack::FmuOptions;
use asperity_study::stribeck::{Stribeck, StribeckOptions};
use asperity_study::summary::{LabelledLine, described_seal};
use asperity_study::values::Values;
use numpy::{IntoPyArray as _, PyArray1};
use pyo3::prelude::*;

use crate::background::in_background;
use crate::errors::{Raise as _, check_dt, no_output};
use crate::found::{FoundColumn, Picture, columns};
use crate::options::Options;
use crate::pack::pack;
use crate::state::state_class;

/// A seal, read from its file.
#[pyclass(frozen, module = "asperity._native")]
#[derive(Debug)]
pub(crate) struct Seal {
    seal: asperity::seal::Seal,
    file: PathBuf,
}

#[pymethods]
impl Seal {
    #[new]
    fn new(file: PathBuf) -> PyResult<Self> {
        let seal = asperity_study::files::load_seal(&file, &[]).map_err(|error| error.raise())?;
        Ok(Self { seal, file })
    }

    #[getter]
    fn name(&self) -> &str {
        self.seal.name()
    }

    #[getter]
    fn file(&self) -> PathBuf {
        self.file.clone()
    }

    #[getter]
    fn width(&self) -> f64 {
        self.seal.width()
    }

    /// The summary, in lines with labels.
    fn describe(&self) -> Vec<LabelledLine> {
        described_seal(&self.seal)
    }

    /// The files that it reads, as it names them.
    fn files(&self) -> Vec<PathBuf> {
        self.seal.files().into_iter().cloned().collect()
    }

    fn __len__(&self) -> usize {
        self.seal.cells()
    }

    /// Friction, film and leak in steady motion: the columns of the table, and its picture.
    fn sweep<'py>(
        &self,
        py: Python<'py>,
        speeds: Option<Vec<f64>>,
        sealed: Option<Vec<f64>>,
        temperatures: Option<Vec<f64>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Vec<FoundColumn<'py>>, Picture)> {
        let seal = self.seal.clone();
        let [speeds, sealed, temperatures] = [speeds, sealed, temperatures].map(|values| values.map(Values::from));
        let found = in_background(py, progress, move |task| {
            let options = StribeckOptions { sealed };
            let (speeds, temperatures) = (speeds.as_ref(), temperatures.as_ref());
            let (points, done) = (Stribeck::count(&seal, speeds, temperatures, &options), AtomicUsize::new(0));
            let tell = || task.report((1 + done.fetch_add(1, Ordering::Relaxed)) as f64 / points as f64);
            Stribeck::new(&seal, speeds, temperatures, &options, (&task.stop(), &tell))
        })?;
        let found = found.map_err(|error: Error| error.raise())?;
        Ok((columns(py, &found.table())?, Picture(found.picture())))
    }

    /// Writes an FMU.
    fn pack(&self, output: PathBuf, libraries: Vec<OsString>, options: Options<FmuOptions>) -> PyResult<Vec<String>> {
        pack(&self.seal.clone().into(), &self.file, &libraries, (&output, options))
    }
}

state_class!(SealState, asperity::seal::SealState, "a seal");

/// A seal whose rod is moved step by step.
#[pyclass(frozen, module = "asperity._native")]
#[derive(Debug)]
pub(crate) struct SealRun {
    run: Mutex<asperity::seal::SealRun>,
    seal: asperity::seal::Seal,
    variables: Vec<SealVariable>,
}

impl SealRun {
    fn of(seal: &asperity::seal::Seal, run: asperity::seal::SealRun) -> Self {
        Self { run: Mutex::new(run), variables: seal.variables(), seal: seal.clone() }
    }

    fn run(&self) -> MutexGuard<'_, asperity::seal::SealRun> {
        self.run.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl SealRun {
    #[new]
    fn new(
        seal: &Seal,
        u: f64,
        w: f64,
        sealed_pressure: Option<f64>,
        temperature: Option<f64>,
        u_rate: f64,
    ) -> PyResult<Self> {
        let seal = &seal.seal;
        let sealed_pressure = sealed_pressure.unwrap_or_else(|| seal.sealed_pressure());
        let temperature = temperature.unwrap_or_else(|| seal.temperature());
        let start = SealStart { time: 0.0, u, w, sealed_pressure, temperature, u_rate };
        Ok(Self::of(seal, asperity::seal::SealRun::new(seal, &start).map_err(|error| error.raise())?))
    }

    /// A run that goes on from a state.
    #[staticmethod]
    fn restore(seal: &Seal, state: &SealState) -> PyResult<Self> {
        let run = asperity::seal::SealRun::restore(&seal.seal, &state.0).map_err(|error| error.raise())?;
        Ok(Self::of(&seal.seal, run))
    }

    /// Moves the inputs for `dt` straight to their targets. What is not given stays.
    #[pyo3(signature = (dt, u=None, *, w=None, sealed_pressure=None, temperature=None))]
    fn advance(
        &self,
        py: Python<'_>,
        dt: f64,
        u: Option<f64>,
        w: Option<f64>,
        sealed_pressure: Option<f64>,
        temperature: Option<f64>,
    ) -> PyResult<()> {
        check_dt(dt)?;
        let moved = py.detach(|| {
            let mut run = self.run();
            let here = run.inputs();
            let rate = |i: usize, target: Option<f64>| target.map_or(0.0, |target| (target - here[i]) / dt);
            let motion = SealMotion {
                duration: dt,
                u_rate: rate(0, u),
                w_rate: rate(1, w),
                pressure_rate: rate(2, sealed_pressure),
                temperature: temperature.unwrap_or(run.temperature()),
            };
            run.advance(&motion)
        });
        moved.map_err(|error| error.raise())
    }

    fn state(&self) -> SealState {
        SealState(self.run().save())
    }

    fn set_state(&self, state: &SealState) -> PyResult<()> {
        let restored = asperity::seal::SealRun::restore(&self.seal, &state.0).map_err(|error| error.raise())?;
        *self.run() = restored;
        Ok(())
    }

    /// A run that goes on as this one.
    fn copy(&self) -> Self {
        Self::of(&self.seal, self.run().clone())
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
    fn inputs(&self) -> [f64; 3] {
        self.run().inputs()
    }

    /// The contents of the cells, from the sealed side.
    fn contents<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.run().contents().to_vec().into_pyarray(py)
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
        Ok(self.run().value(variable.output))
    }

    fn values<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let mut values = vec![0.0; self.variables.len()];
        self.run().evaluate(&self.variables, &mut values);
        values.into_pyarray(py)
    }
}
