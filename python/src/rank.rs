//! Scenes in the order of their friction.

use std::sync::atomic::{AtomicUsize, Ordering};

use asperity_study::Error;
use asperity_study::rank::{RankOptions, RankPlan, RankScene, measured_ranking};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::pythonize;

use crate::background::in_background;
use crate::errors::Raise as _;
use crate::options::Options;
use crate::scene::Scene;

/// Ranks scenes.
#[pyfunction]
pub(crate) fn rank<'py>(
    py: Python<'py>,
    scenes: Vec<PyRef<'py, Scene>>,
    options: Options<RankOptions>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let options = options.0;
    let scene = |scene: &PyRef<'_, Scene>| RankScene { scene: (*scene.scene).clone(), file: scene.file.clone() };
    let scenes: Vec<RankScene> = scenes.iter().map(scene).collect();
    let found = in_background(py, progress, move |task| -> Result<_, Error> {
        let plan = RankPlan::new(scenes, &options, &task.stop())?;
        let (all, done) = (plan.sweeps() as f64, AtomicUsize::new(0));
        let told = || task.report((1 + done.fetch_add(1, Ordering::Relaxed)) as f64 / all);
        let found = plan.find(&task.stop(), &told)?;
        let measured = options
            .data
            .as_deref()
            .map(|data| measured_ranking(&plan, &found, data, &options.columns.columns))
            .transpose()?;
        let warnings: Vec<String> = plan.warnings().into_iter().chain(found.ranking.warnings()).collect();
        Ok((found.ranking, measured, warnings))
    })?;
    let (ranking, measured, warnings) = found.map_err(|error| error.raise())?;
    let count = ranking.scenes.len();
    let above = |one: usize| (0..count).map(|other| ranking.above(one, other)).collect::<Vec<_>>();
    let found = pythonize(py, &ranking)?.cast_into::<PyDict>()?;
    found.set_item("above", (0..count).map(above).collect::<Vec<_>>())?;
    found.set_item("is_sure", ranking.is_sure())?;
    found.set_item("warnings", warnings)?;
    found.set_item("measured", pythonize(py, &measured)?)?;
    Ok(found)
}
