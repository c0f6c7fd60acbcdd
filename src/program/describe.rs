//! `asperity describe`: summarises a scene.

use std::ops::Range;
use std::sync::Arc;

use crate::fmi::FmuModel;
use crate::model::{Flash, FrictionLaw, Model, Reduction, Replaced, Replacement};
use crate::outputs::variables;
use crate::scene::{
    Axis, CarrierBody, CarrierInitial, Extrapolation, Force, Friction, Initial, Input, Layer, Link, LinkKind, Material,
    OutputGroup, Parameter, Path, Phase, RateShear, Scene, Surface, Value, Wlf, peak_to_valley,
};
use crate::simulation::{Simulation, SimulationError};
use serde::Serialize;

use super::cli::Describe;
use super::figure::{Below, Figure as _};
use super::files::{FileError, check_outputs, load, print, table_lines};
use super::runner::start;
use super::terminal::{LabelledLine, decimal, labelled, lines, rounded};
use super::{fine, foundation};

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

/// Stands for what the scene does not give.
const LEFT_OUT: &str = "left out";

pub(crate) fn describe(command: &Describe, path: &std::path::Path) -> Result<(), DescribeError> {
    let scene = load(path, &command.set)?;
    if let Some(output) = &command.plot {
        let picture = foundation::picture(&scene).ok_or(DescribeError::NothingToPlot)?;
        check_outputs([output], scene.sources(path))?;
        match fine::picture(&scene) {
            Some(fine) => Below(picture, fine).write(output)?,
            None => picture.write(output)?,
        }
    }
    let text = if command.json { json(&scene)? } else { text(&scene)? };
    Ok(print(&text)?)
}

fn json(scene: &Scene) -> Result<String, DescribeError> {
    Ok(serde_json::to_string(&JsonScene::new(scene))? + "\n")
}

fn text(scene: &Scene) -> Result<String, DescribeError> {
    // A scene that no run can start with is refused.
    Simulation::new(scene, &start(scene, 0.0))?;
    let title = scene.description.as_ref().map_or_else(|| scene.name.clone(), |text| format!("{}: {text}", scene.name));
    let bytes = FmuModel::memory(&Arc::new(scene.clone()));
    let memory = ("Memory", format!("at most {} MiB an instance of the FMU", bytes.div_ceil(1 << 20)));
    Ok(lines(&[vec![("Scene", title)], rows(scene), table_lines(scene), vec![memory]].concat()))
}

/// The summary without the scene's name.
pub(super) fn rows(scene: &Scene) -> Vec<LabelledLine> {
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
    rows.extend(friction(scene));
    rows.extend(labelled("Fine", fine::rows(scene)));
    rows.extend(labelled("Outputs", OutputGroup::ALL.map(|group| outputs(scene, group))));
    rows.push(("Solver", solver(scene)));
    rows.extend(reduction(scene));
    rows.extend(carrier(scene));
    rows.push(("Input", input(scene)));
    rows.extend(excitation(scene));
    rows
}

/// A number for reading: five digits, as of 293.15 K.
fn number(value: f64) -> String {
    decimal(rounded(value, 5), 1e-3..1e6)
}

fn or_left_out(value: Option<f64>, unit: &str) -> String {
    value.map_or_else(|| LEFT_OUT.into(), |value| format!("{}{unit}", number(value)))
}

/// The word that the scene file has for `parameter`.
fn word(scene: &Scene, parameter: Parameter) -> String {
    match scene.parameter(parameter) {
        Value::Text(word) => word,
        other => other.to_string(),
    }
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

/// Lines that begin with a name each; the name of an earlier one in place of lines that are the same.
fn each_once(parts: impl IntoIterator<Item = (&'static str, Vec<String>)>) -> Vec<String> {
    let mut said: Vec<(&'static str, Vec<String>)> = Vec::new();
    let mut rows = Vec::new();
    for (name, lines) in parts {
        match said.iter().find(|(_, earlier)| *earlier == lines && lines != [LEFT_OUT]) {
            Some((earlier, _)) if !lines.is_empty() => rows.push(format!("{name:<12}as {earlier}")),
            _ => {
                let heads = std::iter::once(name).chain(std::iter::repeat(""));
                rows.extend(heads.zip(&lines).map(|(head, line)| format!("{head:<12}{line}")));
                said.push((name, lines));
            }
        }
    }
    rows
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

fn friction(scene: &Scene) -> Vec<LabelledLine> {
    let Some(friction) = &scene.friction else { return vec![("Friction", LEFT_OUT.into())] };
    let coulomb = format!("coulomb      {}", or_left_out(friction.coulomb, ""));
    let shear = match friction.shear_strength {
        Some(strength) => format!(
            "shear        {} Pa: {} N a mass in contact",
            number(strength),
            number(scene.shear_force().unwrap_or(0.0))
        ),
        None => format!("shear_force  {}", or_left_out(friction.shear_force, " N a mass in contact")),
    };
    let rate_shear = scene.rate_shear().map_or_else(|| LEFT_OUT.into(), |law| rate_shear_text(&law));
    let mut rows = vec![coulomb, shear, format!("rate_shear   {rate_shear}")];
    rows.extend(falling_friction(scene));
    labelled("Friction", rows)
}

/// Where friction falls over the speed, at which the masses of a layer may stick and slip one by one; nothing where it
/// does not.
fn falling_friction(scene: &Scene) -> Option<String> {
    /// Speeds are 10^(i/PER_DECADE) m/s.
    const PER_DECADE: i32 = 10;
    const EXPONENTS: Range<i32> = -6 * PER_DECADE..2 * PER_DECADE;
    /// A smaller fall over a decade is damped away.
    const LEAST_FALL: f64 = 0.01;

    let law = FrictionLaw::new(scene);
    let normal = scene.layer.element_area().map_or(0.0, |area| fine::MIDDLE * area);
    let speed = |exponent: i32| 10.0_f64.powf(f64::from(exponent) / f64::from(PER_DECADE));
    let friction = |exponent: i32| law.slip(normal, speed(exponent), Flash::held(0.0)).force();
    let fall = |at: i32| f64::from(PER_DECADE) * (1.0 - friction(at + 1) / friction(at));
    let falls: Vec<(i32, f64)> = EXPONENTS.map(|at| (at, fall(at))).filter(|&(_, fall)| fall > LEAST_FALL).collect();
    let steepest = falls.iter().map(|&(_, fall)| fall).fold(0.0, f64::max);
    let (&(first, _), &(last, _)) = (falls.first()?, falls.last()?);
    let to = if last + 1 == EXPONENTS.end { String::new() } else { format!(" to {:.1e} m/s", speed(last + 1)) };
    Some(format!(
        "falls over the speed from {:.1e} m/s{to}, by up to {:.0} % a decade: masses may stick and slip one by one there, in \
         many steps",
        speed(first),
        100.0 * steepest
    ))
}

/// The law of the contacts, for a material at its temperature.
fn rate_shear_text(rate_shear: &RateShear) -> String {
    format!(
        "{} N a mass in contact at {} m/s, sharpness {}, constant below {} m/s",
        number(rate_shear.force.unwrap_or(0.0)),
        number(rate_shear.reference_speed),
        number(rate_shear.sharpness),
        number(rate_shear.creep_speed())
    )
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

/// The Maxwell elements that `solver.reduce` replaces, why, and the bounds on the error.
fn reduction(scene: &Scene) -> Vec<LabelledLine> {
    let Some(reduction) = Reduction::new(scene) else { return vec![("Reduce", LEFT_OUT.into())] };
    let meaning = format!(
        "{}: the largest relative change of a link's force by the elements left out",
        number(scene.solver.reduce)
    );
    let links = each_once(LinkKind::ALL.map(|kind| (kind.name(), reduced_link(scene, &reduction, kind))));
    labelled("Reduce", [meaning, long_times(&reduction), short_times(scene, &reduction)].into_iter().chain(links))
}

fn long_times(reduction: &Reduction) -> String {
    if reduction.run.is_finite() {
        format!(
            "elements with relaxation times much longer than the run of {:.4e} s become springs; for a longer run the bound grows in proportion",
            reduction.run
        )
    } else {
        "no [[excitation]], so the duration of the run is not known: no element becomes a spring".into()
    }
}

fn short_times(scene: &Scene, reduction: &Reduction) -> String {
    if scene.layer.initial == Initial::Undeformed {
        return "undeformed at the start, where no damper is equivalent to an element: no element becomes a damper"
            .into();
    }
    let period = if reduction.run.is_finite() {
        "the shortest period of carrier, profile and layer"
    } else {
        "the layer's own shortest period (the carrier's motion is not known),"
    };
    format!(
        "elements with relaxation times much shorter than {period} 2π/ω, ω = {:.4e} rad/s, become dampers; a jump of the elongation rate ė adds an error of d |Δė| for about τ",
        reduction.frequency
    )
}

fn reduced_link(scene: &Scene, reduction: &Reduction, kind: LinkKind) -> Vec<String> {
    let Some(link) = scene.link(kind).filter(|link| !link.maxwell.is_empty()) else { return Vec::new() };
    let stiffness = reduction.stiffness[kind];
    let replaced: Vec<_> = reduction.replaced.iter().filter(|one| one.kind == kind).collect();
    let left = link.maxwell.len() - replaced.len();
    let head = format!("{left} of {} elements stay, K' = {stiffness:.4e} N/m", link.maxwell.len());
    [head].into_iter().chain(replaced.iter().map(|one| replaced_element(one, stiffness))).collect()
}

fn replaced_element(one: &Replaced, stiffness: f64) -> String {
    let (replacement, why) = match one.by {
        Replacement::Spring => ("spring", "long"),
        Replacement::Damper => ("damper", "short"),
    };
    let share = if one.bound > 0.0 { one.bound / stiffness } else { 0.0 };
    format!(
        "[{}] {} N/m at {} s is {why}: a {replacement}, bound {share:.2e}",
        one.index + 1,
        number(one.element.stiffness),
        number(one.element.relaxation_time)
    )
}

fn input(scene: &Scene) -> String {
    let names: Vec<_> = scene.inputs().into_iter().map(Input::name).collect();
    let rule = match scene.extrapolation {
        Extrapolation::Linear => "values without rates continue at their last rate (linear)",
        Extrapolation::Hold => "values without rates are reached at the end of the step (hold)",
    };
    format!("{}; {rule}", names.join(", "))
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

/// A scene as JSON has it: as read, plus, in the material form, the constants that the direct form would give.
#[derive(Debug, Serialize)]
struct JsonScene {
    #[serde(flatten)]
    scene: Scene,
    /// a_T, 1; null in the direct form.
    shift_factor: Option<f64>,
}

impl JsonScene {
    fn new(given: &Scene) -> Self {
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
