//! The summary of a scene.

use asperity::model::Model;
use asperity::outputs::variables;
use asperity::scene::{
    Extrapolation, Input, Link, LinkKind, Material, OutputGroup, Parameter, Scene, Surface, Wlf, peak_to_valley,
};

use super::friction::friction;
use super::motion::{carrier, excitation};
use super::reduction::reduction;
use super::words::{LEFT_OUT, each_once, number, or_left_out, word};
use super::{fine, foundation};
use crate::labelled::{LabelledLine, labelled};

/// The summary without the scene's name.
pub fn scene_rows(scene: &Scene) -> Vec<LabelledLine> {
    let mut rows = vec![("Layer", masses(scene)), ("Roughness", roughness(scene))];
    if let Some(material) = &scene.material {
        rows.extend(labelled("Material", [body(scene, material), series(material), temperature(material)]));
    }
    rows.extend(labelled(
        "Links",
        each_once(links(scene).map(|(name, link, count)| (name, vec![link_text(link, count)]))),
    ));
    rows.extend(labelled("Foundation", foundation::rows(scene)));
    rows.extend(labelled("Order", [paper_order(scene), order_as_coded(scene)]));
    rows.push(("Profile", profile(&scene.surface)));
    rows.extend(friction(scene, true));
    rows.extend(labelled("Fine", fine::rows(scene)));
    rows.extend(labelled("Outputs", OutputGroup::ALL.map(|group| outputs(scene, group))));
    rows.push(("Solver", solver(scene)));
    rows.extend(reduction(scene));
    rows.extend(carrier(scene));
    rows.push(("Input", input(scene)));
    rows.extend(excitation(scene));
    rows
}

pub(super) fn masses(scene: &Scene) -> String {
    let layer = &scene.layer;
    format!(
        "{} masses of {} kg, {} m apart from x = {} m, clearance {} m, {} at the start",
        layer.masses,
        number(scene.mass()),
        number(layer.spacing),
        number(layer.origin),
        number(layer.clearance),
        word(scene, Parameter::INITIAL)
    )
}

pub(super) fn roughness(scene: &Scene) -> String {
    let heights = &scene.layer.roughness;
    if heights.is_empty() { LEFT_OUT.into() } else { format!("{} m peak to valley", number(peak_to_valley(heights))) }
}

pub(super) fn body(scene: &Scene, material: &Material) -> String {
    let thickness =
        scene.layer.thickness.map_or_else(|| "a half-space".into(), |size| format!("{} m thick", number(size)));
    format!(
        "{thickness}, {} m wide, density {} kg/m³, Poisson's ratio {}",
        number(scene.layer.width.unwrap_or(0.0)),
        number(material.density),
        number(material.poisson_ratio)
    )
}

pub(super) fn series(material: &Material) -> String {
    let glassy: f64 = material.prony.iter().map(|term| term.modulus).sum();
    format!(
        "E_∞ {} Pa, viscosity {}, {} Prony terms, glassy modulus {:.4e} Pa",
        number(material.equilibrium_modulus),
        or_left_out(material.viscosity, " Pa s"),
        material.prony.len(),
        material.equilibrium_modulus + glassy
    )
}

pub(super) fn temperature(material: &Material) -> String {
    let shift = |wlf: Wlf| {
        format!(
            "{} K, times given at {} K: a_T = {:.4e} (C_1 {}, C_2 {} K)",
            number(wlf.temperature),
            number(wlf.reference_temperature),
            wlf.shift_factor(),
            number(wlf.c1),
            number(wlf.c2)
        )
    };
    material.wlf.map_or_else(|| "temperature left out: times as given".into(), shift)
}

/// Name, constants and number of the links of a kind.
type Links = (&'static str, Option<Link>, usize);

fn links(scene: &Scene) -> [Links; 4] {
    LinkKind::ALL.map(|kind| (kind.name(), scene.link(kind), kind.count(scene.layer.masses)))
}

fn link_text(link: Option<Link>, count: usize) -> String {
    let Some(link) = link else { return LEFT_OUT.into() };
    let stiffness = or_left_out(link.stiffness, " N/m");
    let damping = or_left_out(link.damping, " N s/m");
    format!("{count} of c {stiffness}, d {damping}, n = {}{}", link.maxwell.len(), elements(&link))
}

fn elements(link: &Link) -> String {
    let texts = link
        .maxwell
        .iter()
        .map(|element| format!("{} N/m at {} s", number(element.stiffness), number(element.relaxation_time)));
    let texts: Vec<_> = texts.collect();
    if texts.is_empty() { String::new() } else { format!(": {}", texts.join(", ")) }
}

/// Number of coordinates and internal variables of the free layer, as the paper counts them.
fn paper_order(scene: &Scene) -> String {
    let k = scene.layer.masses;
    let counts = links(scene).map(|(_, link, count)| (link.map_or(0, |link| link.maxwell.len()), count));
    let order = 2 * k + counts.iter().map(|(n, count)| n * count).sum::<usize>();
    let n = counts[0].0;
    if counts.iter().all(|(other, _)| *other == n) {
        format!("the paper's 2k + 4kn - 2n = {order} (k = {k}, n = {n}, every mass free)")
    } else {
        format!("the paper's 2k and the Maxwell variables = {order} (k = {k}, n differs from link to link)")
    }
}

fn order_as_coded(scene: &Scene) -> String {
    let maxwell = Model::new(scene).maxwell_variables();
    let order = 4 * scene.layer.masses + maxwell;
    format!("as coded {order}: two coordinates and two velocities a mass, {maxwell} Maxwell variables")
}

pub(super) fn profile(surface: &Surface) -> String {
    let length = surface.x()[surface.x().len() - 1] - surface.x()[0];
    let kind = if surface.is_periodic() { "periodic" } else { "natural" };
    format!(
        "{} points over {} m, {kind}, {:.3e} m peak to valley, steepest slope between points {:.3}",
        surface.x().len(),
        number(length),
        peak_to_valley(surface.z()),
        steepest_slope(surface)
    )
}

fn steepest_slope(surface: &Surface) -> f64 {
    let runs = surface.x().windows(2).map(|x| x[1] - x[0]);
    let rises = surface.z().windows(2).map(|z| (z[1] - z[0]).abs());
    rises.zip(runs).map(|(rise, run)| rise / run).fold(0.0, f64::max)
}

fn outputs(scene: &Scene, group: OutputGroup) -> String {
    let names = if !scene.outputs.contains(&group) {
        LEFT_OUT.into()
    } else if group == OutputGroup::Elements {
        format!("element[1..{}].x, .z, .F_N, .F_T, .mode", scene.layer.masses)
    } else {
        let own = variables(scene).into_iter().filter(|variable| variable.group == group);
        own.map(|variable| variable.name).collect::<Vec<_>>().join(", ")
    };
    format!("{:<13}{names}", group.word())
}

fn solver(scene: &Scene) -> String {
    format!(
        "method {}, relative_tolerance {}, absolute_tolerance {} m, max_steps {}",
        word(scene, Parameter::METHOD),
        number(scene.solver.relative_tolerance),
        number(scene.absolute_tolerance()),
        scene.solver.max_steps()
    )
}

pub(super) fn input(scene: &Scene) -> String {
    let names: Vec<_> = scene.inputs().into_iter().map(Input::name).collect();
    let rule = match scene.extrapolation {
        Extrapolation::Linear => {
            "values without rates continue at their last rate, until the next ones correct the step (linear)"
        }
        Extrapolation::Hold => "values without rates are reached at the end of the step (hold)",
    };
    format!("{}; {rule}", names.join(", "))
}
