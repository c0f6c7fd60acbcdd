//! The layer, its order and the profile in a description.

use asperity::model::Model;
use asperity::scene::{Link, LinkKind, Parameter, Scene, Surface};

use super::{LEFT_OUT, Row, material, number, or_left_out, under, word};

/// A kind of link: its name, the links of that kind, their number.
type Links = (&'static str, Option<Link>, usize);

/// The rows on the layer and the surface.
pub(super) fn rows(scene: &Scene) -> Vec<Row> {
    let mut rows = vec![("Layer", masses(scene)), ("Roughness", roughness(scene))];
    rows.extend(material::rows(scene));
    rows.extend(under("Links", links(scene).map(link)));
    rows.extend(under("Order", [paper_order(scene), order_as_coded(scene)]));
    rows.push(("Profile", profile(&scene.surface)));
    rows
}

fn masses(scene: &Scene) -> String {
    let layer = &scene.layer;
    format!(
        "{} masses of {} kg, {} m apart from x = {} m, clearance {} m, {} at the start",
        layer.masses,
        number(scene.mass()),
        number(layer.spacing),
        number(layer.origin),
        number(layer.clearance),
        word(scene, Parameter::Initial)
    )
}

fn roughness(scene: &Scene) -> String {
    let heights = &scene.layer.roughness;
    if heights.is_empty() { LEFT_OUT.into() } else { format!("{} m peak to valley", number(peak_to_valley(heights))) }
}

fn links(scene: &Scene) -> [Links; 4] {
    LinkKind::ALL.map(|kind| (kind.name(), scene.link(kind), kind.count(scene.layer.masses)))
}

fn link((name, link, count): Links) -> String {
    let Some(link) = link else { return format!("{name:<12}{LEFT_OUT}") };
    let stiffness = or_left_out(link.stiffness, " N/m");
    let damping = or_left_out(link.damping, " N s/m");
    format!("{name:<12}{count} of c {stiffness}, d {damping}, n = {}{}", link.maxwell.len(), elements(&link))
}

fn elements(link: &Link) -> String {
    let texts = link
        .maxwell
        .iter()
        .map(|element| format!("{} N/m at {} s", number(element.stiffness), number(element.relaxation_time)));
    let texts: Vec<_> = texts.collect();
    if texts.is_empty() { String::new() } else { format!(": {}", texts.join(", ")) }
}

/// The same n on every link, or none.
fn common_n(scene: &Scene) -> Option<usize> {
    let counts = links(scene).map(|(_, link, _)| link.map_or(0, |link| link.maxwell.len()));
    counts.iter().all(|n| *n == counts[0]).then_some(counts[0])
}

fn maxwell_variables(scene: &Scene) -> usize {
    links(scene).iter().map(|(_, link, count)| count * link.as_ref().map_or(0, |link| link.maxwell.len())).sum()
}

/// Coordinates and internal variables of the free layer, as the paper counts them.
fn paper_order(scene: &Scene) -> String {
    let k = scene.layer.masses;
    let order = 2 * k + maxwell_variables(scene);
    match common_n(scene) {
        Some(n) => format!("the paper's 2k + 4kn - 2n = {order} (k = {k}, n = {n}, every mass free)"),
        None => format!("the paper's 2k and the Maxwell variables = {order} (k = {k}, n differs from link to link)"),
    }
}

fn order_as_coded(scene: &Scene) -> String {
    let maxwell = Model::new(scene).maxwell_variables();
    let order = 4 * scene.layer.masses + maxwell;
    format!("as coded {order}: two places and two velocities a mass, {maxwell} Maxwell variables")
}

fn profile(surface: &Surface) -> String {
    let length = surface.x[surface.x.len() - 1] - surface.x[0];
    let kind = if surface.periodic { "periodic" } else { "natural" };
    format!(
        "{} points over {} m, {kind}, {:.3e} m peak to valley, steepest slope between points {:.3}",
        surface.x.len(),
        number(length),
        peak_to_valley(&surface.z),
        steepest_slope(surface)
    )
}

fn peak_to_valley(heights: &[f64]) -> f64 {
    let highest = heights.iter().copied().fold(f64::MIN, f64::max);
    highest - heights.iter().copied().fold(f64::MAX, f64::min)
}

fn steepest_slope(surface: &Surface) -> f64 {
    let runs = surface.x.windows(2).map(|x| x[1] - x[0]);
    let rises = surface.z.windows(2).map(|z| (z[1] - z[0]).abs());
    rises.zip(runs).map(|(rise, run)| rise / run).fold(0.0, f64::max)
}
