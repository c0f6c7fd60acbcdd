//! What `describe` says of a scene: its summary, and that on a screen, without what follows from that; as JSON with all
//! constants that follow from it; and its picture.

use std::sync::Arc;

use asperity::model::Model;
use asperity::outputs::variables;
use asperity::scene::{
    Axis, CarrierBody, CarrierInitial, Extrapolation, Force, FoundationKind, Friction, Input, Layer, Link, LinkKind,
    Material, OutputGroup, Parameter, Path, Phase, Scene, Surface, Wlf, peak_to_valley,
};
use asperity::simulation::{Simulation, SimulationError};
use asperity_fmi::FmuModel;
use serde::Serialize;

use super::foundation::{foundation, foundation_in_brief, reduction};
use super::friction::{FineFrictionCurve, MIDDLE, fine, fine_in_brief, friction};
use super::words::{DRY, LEFT_OUT, LabelledLine, each_once, labelled, number, or_left_out, word};
use crate::decimals::rounded;
use crate::picture::{Mark, Picture, Stroke};
use crate::runner::start;

/// The summary of a scene, with how its tables were read and the memory of its FMU.
///
/// # Errors
/// Where no run can start with it.
pub fn described(scene: &Scene) -> Result<Vec<LabelledLine>, SimulationError> {
    Simulation::new(scene, &start(scene, 0.0))?;
    let bytes = FmuModel::memory(&Arc::new(scene.clone()));
    let memory = ("Memory", format!("at most {} MiB an instance of the FMU", bytes.div_ceil(1 << 20)));
    let tables = labelled("Tables", scene.notes.iter().map(|read| read.text.clone()));
    Ok([vec![title(scene)], scene_rows(scene), tables, vec![memory]].concat())
}

/// The same on one screen: what it is, what is computed and left out, and what was assumed of its tables.
///
/// # Errors
/// As for [`described`].
pub fn described_shortly(scene: &Scene) -> Result<Vec<LabelledLine>, SimulationError> {
    Simulation::new(scene, &start(scene, 0.0))?;
    let assumed = scene.notes.iter().filter(|read| read.assumed).map(|read| read.text.clone());
    Ok([vec![title(scene)], short_scene_rows(scene), labelled("Tables", assumed)].concat())
}

fn title(scene: &Scene) -> LabelledLine {
    let text = scene.description.as_ref().map_or_else(|| scene.name.clone(), |text| format!("{}: {text}", scene.name));
    ("Scene", text)
}

/// A scene as JSON has it: as read, plus, in the material form, the constants that the direct form would give.
#[derive(Debug, Serialize)]
pub struct DescribedScene {
    #[serde(flatten)]
    scene: Scene,
    /// a_T, 1; null in the direct form.
    shift_factor: Option<f64>,
}

impl DescribedScene {
    /// Of the scene as given.
    pub fn new(given: &Scene) -> Self {
        let direct = given.direct_form();
        let (thickness, width) = (given.layer.thickness, given.layer.width);
        let shear_strength = given.friction.as_ref().and_then(|friction| friction.shear_strength);
        let phases = direct.excitation.into_iter().zip(&given.excitation);
        let scene = Scene {
            material: given.material.clone(),
            foundation: given.foundation.clone(),
            layer: Layer { thickness, width, foundation: given.layer.foundation, ..direct.layer },
            friction: direct.friction.map(|friction| Friction { shear_strength, ..friction }),
            excitation: phases.map(|(phase, given)| Phase { until_pressure: given.until_pressure, ..phase }).collect(),
            ..direct
        };
        Self { scene, shift_factor: given.material.as_ref().map(Material::shift_factor) }
    }
}

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
    rows.extend(labelled("Foundation", foundation(scene)));
    rows.extend(labelled("Order", [paper_order(scene), order_as_coded(scene)]));
    rows.push(("Profile", profile(&scene.surface)));
    rows.extend(friction(scene, true));
    rows.extend(labelled("Fine", fine(scene)));
    rows.push(("Fluid", DRY.to_owned()));
    rows.extend(labelled("Outputs", OutputGroup::ALL.map(|group| outputs(scene, group))));
    rows.push(("Solver", solver(scene)));
    rows.extend(reduction(scene));
    rows.extend(carrier(scene));
    rows.push(("Input", input(scene)));
    rows.extend(excitation(scene));
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
        word(scene, Parameter::INITIAL)
    )
}

fn roughness(scene: &Scene) -> String {
    let heights = &scene.layer.roughness;
    if heights.is_empty() { LEFT_OUT.into() } else { format!("{} m peak to valley", number(peak_to_valley(heights))) }
}

fn body(scene: &Scene, material: &Material) -> String {
    let thickness =
        scene.layer.thickness.map_or_else(|| "a half-space".into(), |size| format!("{} m thick", number(size)));
    format!(
        "{thickness}, {} m wide, density {} kg/m³, Poisson's ratio {}",
        number(scene.layer.width.unwrap_or(0.0)),
        number(material.density),
        number(material.poisson_ratio)
    )
}

fn series(material: &Material) -> String {
    let glassy: f64 = material.prony.iter().map(|term| term.modulus).sum();
    format!(
        "E_∞ {} Pa, viscosity {}, {} Prony terms, glassy modulus {:.4e} Pa",
        number(material.equilibrium_modulus),
        or_left_out(material.viscosity, " Pa s"),
        material.prony.len(),
        material.equilibrium_modulus + glassy
    )
}

fn temperature(material: &Material) -> String {
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

fn profile(surface: &Surface) -> String {
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

fn input(scene: &Scene) -> String {
    let names: Vec<_> = scene.inputs().into_iter().map(Input::name).collect();
    let rule = match scene.input_rule.extrapolation {
        Extrapolation::Linear => {
            "values without rates continue at their last rate, until the next ones correct the step (linear)"
        }
        Extrapolation::Hold => "values without rates are reached at the end of the step (hold)",
    };
    format!("{}; {rule}", names.join(", "))
}

/// The summary on a screen, without the scene's name.
pub(super) fn short_scene_rows(scene: &Scene) -> Vec<LabelledLine> {
    let mut rows = vec![("Layer", masses(scene))];
    if !scene.layer.roughness.is_empty() {
        rows.push(("Roughness", roughness(scene)));
    }
    if let Some(material) = &scene.material {
        rows.extend(labelled("Material", [body(scene, material), series(material), temperature(material)]));
    }
    rows.extend(labelled("Foundation", foundation_in_brief(scene)));
    rows.push(("Profile", profile(&scene.surface)));
    rows.extend(labelled(
        "Friction",
        friction(scene, false).into_iter().map(|(_, text)| text).filter(|text| !is_left_out(text)),
    ));
    rows.extend(labelled("Fine", fine_in_brief(scene)));
    rows.extend(carrier(scene));
    rows.push(("Input", input(scene)));
    rows.extend(phases(scene));
    rows.push(("Solver", solver_in_brief(scene)));
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

fn solver_in_brief(scene: &Scene) -> String {
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
        (true, "a fluid (dry)"),
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

/// The axes along which the carrier is a body.
fn carrier(scene: &Scene) -> Vec<LabelledLine> {
    let bodies = Axis::ALL.into_iter().filter_map(|axis| Some((axis, scene.carrier[axis].as_ref()?)));
    labelled("Carrier", bodies.map(|(axis, body)| body_text(axis, body)))
}

fn body_text(axis: Axis, body: &CarrierBody) -> String {
    let mut text = format!("a body along {}: {} kg", axis.name(), number(body.mass));
    let parts = [
        (body.load, "load", "N"),
        (body.pull, "pull", "N"),
        (body.stiffness, "spring to the drive", "N/m"),
        (body.damping, "damper to the drive", "N s/m"),
        (body.start, "start", "m"),
        (body.start_rate, "start rate", "m/s"),
    ];
    for (value, name, unit) in parts {
        text += &value.map_or_else(String::new, |value| format!(", {name} {} {unit}", number(value)));
    }
    if body.initial == CarrierInitial::Equilibrium {
        text += ", from equilibrium";
    }
    text
}

fn excitation(scene: &Scene) -> Vec<LabelledLine> {
    if scene.excitation.is_empty() {
        return vec![("Excitation", LEFT_OUT.into())];
    }
    let same_file = |a: &Phase, b: &Phase| a.is_row && b.is_row;
    let parts = scene.excitation.chunk_by(same_file).enumerate();
    labelled("Excitation", parts.map(|(i, phases)| phases_text(i + 1, phases)))
}

/// A phase, or all those from row to row of a motion file.
fn phases_text(number_of: usize, phases: &[Phase]) -> String {
    match phases {
        [phase] => phase_text(number_of, phase),
        _ => {
            let duration: f64 = phases.iter().map(|phase| phase.duration).sum();
            let [u, w] = [|phase: &Phase| phase.u.rate, |phase: &Phase| phase.w.rate].map(|rate| {
                let changes = phases.iter().map(|phase| rate(phase) * phase.duration);
                let (mut at, mut range) = (0.0, (0.0_f64, 0.0_f64));
                for change in changes {
                    at += change;
                    range = (range.0.min(at), range.1.max(at));
                }
                format!("{} to {} m", number(range.0), number(range.1))
            });
            format!("{number_of}  {} s in {} rows from files, u {u}, w {w}", number(duration), phases.len())
        }
    }
}

fn phase_text(number_of: usize, phase: &Phase) -> String {
    let motion = path_text("u", "m", &phase.u) + &path_text("w", "m", &phase.w);
    let forces = phase.load.map_or_else(String::new, |load| force_text("load", "N", &load))
        + &phase.pull.map_or_else(String::new, |pull| force_text("pull", "N", &pull));
    let pressure = phase.pressure.map_or_else(String::new, |pressure| force_text("pressure", "Pa", &pressure));
    let temperature = phase.temperature.map_or_else(String::new, |kelvin| format!(", at {} K", number(kelvin)));
    let motion = motion + &forces + &pressure + &temperature;
    let motion = if motion.is_empty() { ", at rest".into() } else { motion };
    let end = match (phase.until_force, phase.until_pressure) {
        (Some(force), _) => format!(", until F_z = {} N", number(force)),
        (None, Some(pressure)) => format!(", until F_z = {} Pa times the layer's area", number(pressure)),
        (None, None) => String::new(),
    };
    format!("{number_of}  {} s{motion}{end}", number(phase.duration))
}

fn force_text(name: &str, unit: &str, force: &Force) -> String {
    let start = force.start.map_or_else(String::new, |start| format!(", {name} from {} {unit}", number(start)));
    start + &path_text(name, unit, &force.change)
}

fn path_text(name: &str, unit: &str, path: &Path) -> String {
    let mut text = String::new();
    if path.rate != 0.0 {
        text += &format!(", {name} at {} {unit}/s", number(path.rate));
    }
    if path.amplitude != 0.0 {
        text += &format!(", {name} by {} {unit} at {} Hz", number(path.amplitude), number(path.frequency));
    }
    text
}

/// The stiffness of the links over that of the body that they stand for, over wavelength, and μ_h of a mass over speed
/// where bands rub; `None` in the direct form.
pub fn picture(scene: &Scene) -> Option<Picture> {
    let curve = |(look, (name, kind)): (usize, (&str, LinkKind))| {
        let points = scene.quality(kind)?.curve.iter().map(|&(length, share)| [length, share]).collect();
        Some(Mark::line(name, look, points))
    };
    let kinds: &[(&str, LinkKind)] = match scene.layer.foundation {
        Some(FoundationKind::HalfSpace) => &[("along z and along x", LinkKind::Vertical)],
        _ => &[("along z", LinkKind::Vertical), ("along x", LinkKind::Horizontal)],
    };
    let mut curves: Vec<Mark> = kinds.iter().copied().enumerate().filter_map(curve).collect();
    let exact = curves.first()?.points().map(|[length, _]| [length, 1.0]).collect();
    curves.push(Mark::broken("the body", 6, exact, Stroke::Dashed));
    let panels = vec![(("stiffness of the links over the body's", ""), curves)];
    let mut picture = Picture::stacked(("wavelength", "m"), panels).titled(&scene.name);
    picture.rows.extend(friction_picture(scene).into_iter().flat_map(|friction| friction.rows));
    Some(picture)
}

fn friction_picture(scene: &Scene) -> Option<Picture> {
    let curve = |(look, FineFrictionCurve { temperature, points }): (usize, FineFrictionCurve)| {
        let name = temperature.map_or_else(|| "mu_h".into(), |kelvin| format!("{} K", rounded(kelvin, 6)));
        Mark::line(name, look, points.into_iter().map(|(speed, friction)| [speed, friction]).collect())
    };
    let curves: Vec<Mark> = FineFrictionCurve::around(scene).into_iter().enumerate().map(curve).collect();
    let title = format!("friction below the profile, mu_h, under {} MPa", MIDDLE / 1e6);
    let rows = vec![(("friction coefficient", ""), vec![(title, curves.clone())])];
    (!curves.is_empty()).then(|| Picture::side_by_side(("speed", "m/s"), rows))
}
