//! Scenes in the order of their friction.

use std::sync::atomic::{AtomicUsize, Ordering};

use asperity_study::Error;
use asperity_study::rank::{MeasuredRanking, RankOptions, RankPlan, RankScene, Ranking, measured_ranking};
use pyo3::prelude::*;
use pyo3::types::PyDict;

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
        let plan = RankPlan::new(scenes, &options)?;
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
    let found = as_dictionary(py, &ranking)?;
    found.set_item("warnings", warnings)?;
    found.set_item("measured", measured.map(|measured| as_measured(py, measured)).transpose()?)?;
    Ok(found)
}

fn as_dictionary<'py>(py: Python<'py>, ranking: &Ranking) -> PyResult<Bound<'py, PyDict>> {
    let (scenes, found) = (&ranking.scenes, PyDict::new(py));
    let count = scenes.len();
    let above = |one: usize| (0..count).map(|other| ranking.above(one, other)).collect::<Vec<_>>();
    let ties: Vec<(usize, usize, f64)> =
        ranking.pairs.iter().map(|pair| (pair.scenes[0], pair.scenes[1], pair.ties)).collect();
    let point = |ranked: &asperity_study::rank::RankedPoint| {
        let at = ranked.point;
        (at.speed, at.load, at.temperature, ranked.weight)
    };
    found.set_item("scenes", scenes.iter().map(|scene| scene.label.as_str()).collect::<Vec<_>>())?;
    found.set_item("order", &ranking.order)?;
    found.set_item("friction", scenes.iter().map(|scene| scene.friction).collect::<Vec<_>>())?;
    found.set_item("friction_bands", scenes.iter().map(|scene| scene.friction_band).collect::<Vec<_>>())?;
    found.set_item("index", scenes.iter().map(|scene| scene.index).collect::<Vec<_>>())?;
    found.set_item("index_bands", scenes.iter().map(|scene| scene.index_band).collect::<Vec<_>>())?;
    found.set_item("largest", scenes.iter().map(|scene| scene.largest).collect::<Vec<_>>())?;
    found.set_item("above", (0..count).map(above).collect::<Vec<_>>())?;
    found.set_item("ties", ties)?;
    found.set_item("points", ranking.points.iter().map(point).collect::<Vec<_>>())?;
    found.set_item("point_friction", ranking.points.iter().map(|at| at.friction.clone()).collect::<Vec<_>>())?;
    found.set_item("point_largest", ranking.points.iter().map(|at| at.largest.clone()).collect::<Vec<_>>())?;
    found.set_item("point_bands", ranking.points.iter().map(|at| at.bands.clone()).collect::<Vec<_>>())?;
    found.set_item("samples", ranking.samples)?;
    found.set_item("failed", ranking.failed)?;
    found.set_item("redrawn", ranking.redrawn)?;
    found.set_item("is_sure", ranking.is_sure())?;
    Ok(found)
}

fn as_measured(py: Python<'_>, measured: MeasuredRanking) -> PyResult<Bound<'_, PyDict>> {
    let found = PyDict::new(py);
    let scenes: Vec<_> =
        measured.scenes.into_iter().map(|scene| (scene.label, scene.measured, scene.computed)).collect();
    found.set_item("scenes", scenes)?;
    found.set_item("points", measured.points)?;
    found.set_item("tau", measured.tau)?;
    found.set_item("notes", measured.notes)?;
    Ok(found)
}
