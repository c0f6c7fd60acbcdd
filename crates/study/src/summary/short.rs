//! A scene on a screen: what it is, what is computed and what is left out, without what follows from that.

use asperity::scene::{Axis, LinkKind, OutputGroup, Parameter, Scene};

use super::fine;
use super::foundation;
use super::friction::friction;
use super::motion::{carrier, excitation};
use super::scene::{body, input, masses, profile, roughness, series, temperature};
use super::words::{LEFT_OUT, number, word};
use crate::labelled::{LabelledLine, labelled};

/// The summary on a screen, without the scene's name.
pub(super) fn short_scene_rows(scene: &Scene) -> Vec<LabelledLine> {
    let mut rows = vec![("Layer", masses(scene))];
    if !scene.layer.roughness.is_empty() {
        rows.push(("Roughness", roughness(scene)));
    }
    if let Some(material) = &scene.material {
        rows.extend(labelled("Material", [body(scene, material), series(material), temperature(material)]));
    }
    rows.extend(labelled("Foundation", foundation::short_rows(scene)));
    rows.push(("Profile", profile(&scene.surface)));
    rows.extend(labelled(
        "Friction",
        friction(scene, false).into_iter().map(|(_, text)| text).filter(|text| !is_left_out(text)),
    ));
    rows.extend(labelled("Fine", fine::short_rows(scene)));
    rows.extend(carrier(scene));
    rows.push(("Input", input(scene)));
    rows.extend(phases(scene));
    rows.push(("Solver", solver(scene)));
    rows.push(("Outputs", groups(scene, true)));
    rows.push(("Left out", left_out(scene)));
    rows
}

fn is_left_out(text: &str) -> bool {
    text.ends_with(LEFT_OUT)
}

/// The first phases, and how many others there are.
fn phases(scene: &Scene) -> Vec<LabelledLine> {
    const MOST: usize = 4;
    let mut rows = excitation(scene);
    if rows.iter().any(|(_, text)| is_left_out(text)) {
        return Vec::new();
    }
    let more = rows.len().saturating_sub(MOST);
    if more > 0 {
        rows.truncate(MOST);
        rows.push(("", format!("and {more} more phases")));
    }
    rows
}

fn solver(scene: &Scene) -> String {
    let reduce = scene.solver.reduce;
    let reduced = if reduce > 0.0 { format!(", reduce {}", number(reduce)) } else { String::new() };
    let tolerance = number(scene.solver.relative_tolerance);
    format!("method {}, relative_tolerance {tolerance}{reduced}", word(scene, Parameter::METHOD))
}

/// The words of the groups of outputs that are written, or that are not.
fn groups(scene: &Scene, written: bool) -> String {
    let chosen = OutputGroup::ALL.into_iter().filter(|group| scene.outputs.contains(group) == written);
    let words: Vec<&str> = chosen.map(OutputGroup::word).collect();
    if words.is_empty() { "none".into() } else { words.join(", ") }
}

/// What a scene can have and this one has not.
fn left_out(scene: &Scene) -> String {
    let friction = scene.friction.as_ref();
    let material = scene.material.as_ref();
    let has_shear = friction.is_some_and(|law| law.shear_strength.is_some() || law.shear_force.is_some());
    let links = LinkKind::ALL.into_iter().filter(|kind| scene.link(*kind).is_none());
    let parts = [
        (scene.layer.roughness.is_empty(), "layer.roughness"),
        (material.is_some_and(|material| material.viscosity.is_none()), "material.viscosity"),
        (material.is_some_and(|material| material.wlf.is_none()), "material.wlf"),
        (material.is_some_and(|material| material.heat.is_none()), "material.heat"),
        (friction.is_none(), "friction"),
        (friction.is_some_and(|law| law.coulomb.is_none()), "friction.coulomb"),
        (friction.is_some() && !has_shear, "a constant shear strength or force"),
        (friction.is_some() && scene.rate_shear().is_none(), "friction.rate_shear"),
        (material.is_some() && scene.fine.is_none(), "surface.fine"),
        (Axis::ALL.into_iter().all(|axis| scene.carrier[axis].is_none()), "bodies of the carrier"),
        (scene.excitation.is_empty(), "excitation"),
    ];
    let names = parts.into_iter().filter(|(is_left_out, _)| *is_left_out).map(|(_, name)| name.to_owned());
    let links = links.map(|kind| format!("layer.{}", kind.name()));
    let all: Vec<String> = names.chain(links).collect();
    format!("{}; outputs: {}", all.join(", "), groups(scene, false))
}
