//! Friction over speed, load and temperature.

use std::ffi::OsString;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use asperity::element::{OperatingPoint, PointContact, Table};
use asperity_study::sweep::{Loads, SlidingOptions, SweepError, SweepMethod, SweepOptions, SweepPlan, SweepTable};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::background::{Task, in_background};
use crate::errors::Raise as _;
use crate::pack::{FmuOptions, pack};
use crate::scene::Scene;

/// How steady sliding is found, as Python has it.
pub(crate) fn sliding(
    method: Option<&str>,
    way: Option<f64>,
    points: Option<u32>,
    error: Option<f64>,
    distance: Option<f64>,
) -> PyResult<SlidingOptions> {
    let method = match method {
        None => None,
        Some("steady") => Some(SweepMethod::Steady),
        Some("layer") => Some(SweepMethod::Layer),
        Some(other) => {
            return Err(PyValueError::new_err(format!("method = {other:?}: expected \"steady\" or \"layer\"")));
        }
    };
    Ok(SlidingOptions { method, way, points, error, distance })
}

/// All points of a sweep; `None` where nobody waits for them any more.
fn find(plan: &SweepPlan, task: &Task) -> Option<SweepTable> {
    let points: Vec<OperatingPoint> = plan.header().grid.points().collect();
    let (rows, done) = (Mutex::new(Vec::new()), AtomicUsize::new(0));
    let _: ControlFlow<()> = plan.find(&points, &task.stop(), |row| {
        rows.lock().unwrap_or_else(PoisonError::into_inner).push(row);
        task.report((1 + done.fetch_add(1, Ordering::Relaxed)) as f64 / points.len() as f64);
        ControlFlow::Continue(())
    });
    let rows = rows.into_inner().unwrap_or_else(PoisonError::into_inner);
    (!task.is_stopped()).then(|| SweepTable::new(plan.header().clone(), rows))
}

/// The text of the table of a sweep, and the warnings.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub(crate) fn sweep(
    py: Python<'_>,
    scene: &Scene,
    speeds: Vec<f64>,
    pressures: Option<Vec<f64>>,
    forces: Option<Vec<f64>>,
    temperatures: Option<Vec<f64>>,
    method: Option<&str>,
    way: Option<f64>,
    points: Option<u32>,
    error: Option<f64>,
    distance: Option<f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, Vec<String>)> {
    let loads = match (pressures, forces) {
        (Some(pressures), None) => Loads::Pressures(pressures),
        (None, Some(forces)) => Loads::Forces(forces),
        _ => return Err(PyValueError::new_err("expected pressures or forces, the loads to sweep over")),
    };
    let options = SweepOptions { speeds, loads, temperatures, sliding: sliding(method, way, points, error, distance)? };
    let scene = Arc::clone(&scene.scene);
    let found = in_background(py, progress, move |task| {
        let plan = SweepPlan::new((*scene).clone(), &options, None)?;
        Ok(find(&plan, task).map(|table| {
            let found = plan.warnings(table.rows.iter().map(|stored| &stored.row));
            let warnings = plan.warning().map(str::to_owned).into_iter().chain(found).collect();
            (table.text(), warnings)
        }))
    })?;
    let found = found.map_err(|error: SweepError| error.raise())?;
    // It is only stopped where nobody waits.
    found.ok_or_else(|| PyValueError::new_err("stopped"))
}

/// Packs the table of a sweep as an FMU, a point-contact element.
#[pyfunction]
pub(crate) fn pack_table(
    table: PathBuf,
    output: PathBuf,
    libraries: Vec<OsString>,
    options: FmuOptions,
) -> PyResult<Option<String>> {
    let read = Table::load(&table).map_err(|error| PyValueError::new_err(error.to_string()))?;
    pack(&PointContact::new(read).into(), &table, &libraries, (&output, options))
}
