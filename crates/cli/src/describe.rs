//! `asperity describe`: summarises a scene or a patch.

use std::path::Path;

use asperity::scene::{FoundationKind, LinkKind, Scene, Setting};
use asperity_study::decimals::rounded;
use asperity_study::summary::{
    DescribedScene, FineFrictionCurve, MIDDLE_PRESSURE, described, described_patch, described_shortly, missing_backing,
};
use asperity_study::{Context as _, Error};

use super::cli::Describe;
use super::figure::{Below, Curve, Figure as _, Panel, PanelRow, SideBySide, Stacked, Stroke};
use super::files::{check_outputs, load, load_patch, print};
use super::simulate::NOT_STARTED;
use super::terminal::{LabelledLine, is_verbose, lines, screen_lines, warn};

/// Prints the summary of a scene.
pub(crate) fn describe(command: &Describe, path: &Path) -> Result<(), Error> {
    let scene = load(path, &command.set)?;
    if let Some(output) = &command.plot {
        let picture = stiffness_picture(&scene).ok_or_else(nothing_to_plot)?;
        check_outputs([output], scene.sources(path))?;
        match friction_picture(&scene) {
            Some(friction) => Below(picture, friction).write(output)?,
            None => picture.write(output)?,
        }
    }
    let text = if command.json { json(&scene)? } else { text(&scene)? };
    print(&text)
}

fn nothing_to_plot() -> Error {
    Error::scene("--plot: the scene has no [material], so its links stand for no body to compare them with")
}

/// Prints the summary of a patch.
pub(crate) fn describe_patch(path: &Path, set: &[Setting]) -> Result<(), Error> {
    let patch = load_patch(path, set)?;
    missing_backing(&patch).iter().for_each(|warning| warn(warning));
    print(&screen_lines(&described_patch(&patch)))
}

fn json(scene: &Scene) -> Result<String, Error> {
    Ok(serde_json::to_string(&DescribedScene::new(scene))? + "\n")
}

fn text(scene: &Scene) -> Result<String, Error> {
    if is_verbose() {
        return Ok(lines(&described(scene).context(NOT_STARTED)?));
    }
    Ok(screen_lines(&[described_shortly(scene).context(NOT_STARTED)?, more()].concat()))
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
