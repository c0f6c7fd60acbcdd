//! Friction over speed, load and temperature.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use asperity::element::{FrictionTable, PointContact};
use asperity_study::Error;
use asperity_study::pack::FmuOptions;
use asperity_study::sweep::{SweepOptions, SweepPlan, SweepTable, quantile_table};
use asperity_study::uncertainty::{SampleOptions, UncertainScene};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::background::{Task, in_background};
use crate::errors::Raise as _;
use crate::options::Options;
use crate::pack::pack;
use crate::scene::Scene;

/// All points of a sweep; `None` where nobody waits for them any more.
fn find(plan: &SweepPlan, task: &Task) -> Option<SweepTable> {
    let (points, done) = (plan.header().grid.count(), AtomicUsize::new(0));
    let table = plan.table(&task.stop(), || {
        task.report((1 + done.fetch_add(1, Ordering::Relaxed)) as f64 / points as f64);
    });
    (!task.is_stopped()).then_some(table)
}

/// The text of the table of a sweep, and the warnings; with samples what matters as a table, and what was drawn by names.
type Found = (String, Vec<String>, String, Vec<(String, Vec<f64>)>);

/// A sweep of a scene, with samples or without.
fn plan(scene: &Source, options: &SweepOptions, samples: Option<SampleOptions>) -> Result<SweepPlan, Error> {
    match samples {
        Some(samples) => SweepPlan::with_samples(&scene.uncertain()?, options, None, samples),
        None => SweepPlan::new((*scene.scene).clone(), options, None),
    }
}

/// What a scene was read from.
struct Source {
    scene: Arc<asperity::scene::Scene>,
}

impl Source {
    fn new(scene: &Scene) -> Self {
        Self { scene: Arc::clone(&scene.scene) }
    }

    fn uncertain(&self) -> Result<UncertainScene, Error> {
        UncertainScene::new((*self.scene).clone())
    }
}

/// The text of the table of a sweep, and what is said of it.
#[pyfunction]
pub(crate) fn sweep(
    py: Python<'_>,
    scene: &Scene,
    options: Options<SweepOptions>,
    samples: Option<usize>,
    seed: u64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Found> {
    let options = options.0;
    let (scene, samples) = (Source::new(scene), samples.map(|count| SampleOptions { count, seed }));
    let found = in_background(py, progress, move |task| {
        let plan = plan(&scene, &options, samples)?;
        Ok(find(&plan, task).map(|table| {
            let found = plan.warnings(&table.rows);
            let warnings = plan.warning().map(str::to_owned).into_iter().chain(found).collect();
            let matters = plan.matters(&table.rows).map(|matters| matters.table(table.header.load).text());
            let matters = matters.unwrap_or_default();
            (table.text(), warnings, matters, plan.drawn())
        }))
    })?;
    let found = found.map_err(|error: Error| error.raise())?;
    // It is only stopped where nobody waits.
    found.ok_or_else(|| PyValueError::new_err("stopped"))
}

/// The text of the table of the sample at a quantile of a table with samples of the `scene`.
#[pyfunction]
pub(crate) fn quantile(
    py: Python<'_>,
    scene: &Scene,
    table: String,
    probability: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let table = SweepTable::parse(&table, "table".as_ref()).map_err(|error| Error::from(error).raise())?;
    let scene = Source::new(scene);
    let found = in_background(py, progress, move |task| {
        quantile_table(&scene.uncertain()?, &table, probability, &task.stop()).map(|table| table.text())
    })?;
    found.map_err(|error: Error| error.raise())
}

/// Packs the table of a sweep as an FMU, a point-contact element.
#[pyfunction]
pub(crate) fn pack_table(
    table: PathBuf,
    output: PathBuf,
    libraries: Vec<OsString>,
    options: Options<FmuOptions>,
) -> PyResult<Option<String>> {
    let read = FrictionTable::load(&table).map_err(|error| PyValueError::new_err(error.to_string()))?;
    pack(&PointContact::new(read).into(), &table, &libraries, (&output, options))
}
