//! `asperity describe`: summarises a scene or a patch.

use std::path::Path;
use std::sync::Arc;

use asperity::scene::{FoundationKind, LinkKind, Scene};
use asperity::simulation::{Simulation, SimulationError};
use asperity_fmi::FmuModel;
use asperity_study::decimals::rounded;
use asperity_study::runner::start;
use asperity_study::settings::Setting;
use asperity_study::summary::{
    DescribedScene, FineFrictionCurve, MIDDLE_PRESSURE, missing_backing, patch_rows, scene_rows, short_scene_rows,
};

use super::cli::Describe;
use super::figure::{Below, Curve, Figure as _, Panel, PanelRow, SideBySide, Stacked, Stroke};
use super::files::{FileError, check_outputs, load, load_patch, print, table_lines};
use super::terminal::{LabelledLine, is_verbose, labelled, lines, screen_lines, warn};

/// `asperity describe` failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum DescribeError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("--plot: the scene has no [material], so its links stand for no body to compare them with")]
    NothingToPlot,
    #[error("the run cannot start: {0}")]
    Start(#[from] SimulationError),
    #[error("cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

/// Prints the summary of a scene.
pub(crate) fn describe(command: &Describe, path: &Path) -> Result<(), DescribeError> {
    let scene = load(path, &command.set)?;
    if let Some(output) = &command.plot {
        let picture = stiffness_picture(&scene).ok_or(DescribeError::NothingToPlot)?;
        check_outputs([output], scene.sources(path))?;
        match friction_picture(&scene) {
            Some(friction) => Below(picture, friction).write(output)?,
            None => picture.write(output)?,
        }
    }
    let text = if command.json { json(&scene)? } else { text(&scene)? };
    Ok(print(&text)?)
}

/// Prints the summary of a patch.
pub(crate) fn describe_patch(path: &Path, set: &[Setting]) -> Result<(), FileError> {
    let patch = load_patch(path, set)?;
    missing_backing(&patch).iter().for_each(|warning| warn(warning));
    let title = ("Name", patch.name().to_owned());
    print(&screen_lines(&[vec![title], patch_rows(&patch)].concat()))
}

fn json(scene: &Scene) -> Result<String, DescribeError> {
    Ok(serde_json::to_string(&DescribedScene::new(scene))? + "\n")
}

fn text(scene: &Scene) -> Result<String, DescribeError> {
    // A scene that no run can start with is refused.
    Simulation::new(scene, &start(scene, 0.0))?;
    let title = scene.description.as_ref().map_or_else(|| scene.name.clone(), |text| format!("{}: {text}", scene.name));
    if !is_verbose() {
        return Ok(screen_lines(&[vec![("Scene", title)], short_scene_rows(scene), assumed(scene), more()].concat()));
    }
    let bytes = FmuModel::memory(&Arc::new(scene.clone()));
    let memory = ("Memory", format!("at most {} MiB an instance of the FMU", bytes.div_ceil(1 << 20)));
    Ok(lines(&[vec![("Scene", title)], scene_rows(scene), table_lines(scene), vec![memory]].concat()))
}

/// What was assumed of the tables that were read.
fn assumed(scene: &Scene) -> Vec<LabelledLine> {
    labelled("Tables", scene.notes.iter().filter(|read| read.assumed).map(|read| read.text.clone()))
}

fn more() -> Vec<LabelledLine> {
    vec![("More", "-v: links, their elements and what reduce replaces, outputs, tables, the bands' law, memory".into())]
}

/// The stiffness of the links over that of the body that they stand for, over wavelength; `None` in the direct form.
fn stiffness_picture(scene: &Scene) -> Option<Stacked> {
    let curve = |(look, (name, kind)): (usize, (&str, LinkKind))| {
        let points = scene.quality(kind)?.curve;
        Some(Curve { name: name.into(), look, stroke: Stroke::Line, points })
    };
    let kinds: &[(&str, LinkKind)] = match scene.layer.foundation {
        Some(FoundationKind::HalfSpace) => &[("along z and along x", LinkKind::Vertical)],
        _ => &[("along z", LinkKind::Vertical), ("along x", LinkKind::Horizontal)],
    };
    let mut curves: Vec<Curve> = kinds.iter().copied().enumerate().filter_map(curve).collect();
    let first = &curves.first()?.points;
    let exact = first.iter().map(|point| (point.0, 1.0)).collect();
    curves.push(Curve { name: "the body".into(), look: 6, stroke: Stroke::Dashed, points: exact });
    let panel = Panel { title: "stiffness of the links over the body's".into(), curves };
    Some(Stacked { title: scene.name.clone(), x_title: "wavelength in m".into(), panels: vec![panel] })
}

/// μ_h of a mass over speed; `None` without bands that rub.
fn friction_picture(scene: &Scene) -> Option<SideBySide> {
    let curve = |(look, FineFrictionCurve { temperature, points }): (usize, FineFrictionCurve)| {
        let name = temperature.map_or_else(|| "mu_h".into(), |kelvin| format!("{} K", rounded(kelvin, 6)));
        Curve { name, look, stroke: Stroke::Line, points }
    };
    let curves: Vec<Curve> = FineFrictionCurve::around(scene).into_iter().enumerate().map(curve).collect();
    if curves.is_empty() {
        return None;
    }
    let title = format!("friction below the profile, mu_h, under {} MPa", MIDDLE_PRESSURE / 1e6);
    let row = PanelRow { y_title: "friction coefficient".into(), panels: vec![Panel { title, curves }] };
    Some(SideBySide { title: String::new(), x_title: "speed in m/s".into(), rows: vec![row] })
}
