//! Whether friction and area depend on a scene's spacing, length or on chance.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use asperity_study::Error;
use asperity_study::converge::{ConvergenceOptions, ConvergenceStudy, Ended, Findings, picture};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::background::{Task, in_background};
use crate::errors::Raise as _;
use crate::found::{Picture, columns};
use crate::options::Options;
use crate::scene::Scene;

/// Makes all runs of a study; `None` where nobody waits for them any more.
fn find(study: &ConvergenceStudy, task: &Task) -> Result<Option<Findings>, Error> {
    let (done, all) = (AtomicUsize::new(0), AtomicUsize::new(1));
    let begun = |round: &asperity_study::converge::Round| all.store(round.all.max(1), Ordering::Relaxed);
    let found = study.run(Vec::new(), begun, |_| {
        let done = 1 + done.fetch_add(1, Ordering::Relaxed);
        // What one round tells of the next ones is a lower bound.
        task.report((done as f64 / all.load(Ordering::Relaxed) as f64).min(1.0));
        if task.is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    match found {
        Ok(findings) => Ok(Some(findings)),
        Err(Ended::Stopped(())) => Ok(None),
        Err(Ended::Refused(error)) => Err(error),
    }
}

/// The study of a scene.
#[pyfunction]
pub(crate) fn converge<'py>(
    py: Python<'py>,
    scene: &Scene,
    options: Options<ConvergenceOptions>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let options = options.0;
    let (data, file, name) = (Arc::clone(&scene.scene), scene.file.clone(), scene.scene.name.clone());
    let found = in_background(py, progress, move |task| {
        let study = ConvergenceStudy::new(&data, &file, options)?;
        Ok(find(&study, task)?.map(|findings| (study, findings)))
    })?;
    let found = found.map_err(|error: Error| error.raise())?;
    // It is only stopped where nobody waits.
    let (study, findings) = found.ok_or_else(|| PyValueError::new_err("stopped"))?;
    let found = as_dictionary(py, &study, &findings)?;
    found.set_item("picture", Picture(picture(&name, &findings.runs)).into_pyobject(py)?)?;
    Ok(found)
}

fn as_dictionary<'py>(py: Python<'py>, study: &ConvergenceStudy, findings: &Findings) -> PyResult<Bound<'py, PyDict>> {
    let verdict = &findings.verdict;
    let (found, open) = (PyDict::new(py), PyDict::new(py));
    for one in &verdict.open {
        open.set_item(one.source.name(), one.shares.map(|pair| (pair.friction, pair.area)))?;
    }
    let ladder = findings.ladder();
    let coarsest = verdict.coarsest.map(|halvings| Some(ladder.get(halvings?)?.dimensions.spacing));
    let table = study.table(findings);
    found.set_item("text", table.text())?;
    found.set_item("columns", columns(py, &table)?)?;
    found.set_item("parts", study.parts().name())?;
    found.set_item("is_converged", verdict.is_converged())?;
    found.set_item("verdict", verdict.sentence())?;
    found.set_item("open", open)?;
    found.set_item("coarsest", coarsest)?;
    found.set_item("warnings", study.warning().into_iter().collect::<Vec<_>>())?;
    Ok(found)
}
