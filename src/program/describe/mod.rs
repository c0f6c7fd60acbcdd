//! `asperity describe`: what is in a scene and what is left out.

mod layer;
mod material;
mod reduction;

use asperity::outputs::variables;
use asperity::scene::{Extrapolation, OutputGroup, Parameter, Path, Phase, RateShear, Scene, Value};
use asperity::simulation::{Simulation, Start};

use super::arguments::Describe;
use super::error::ProgramError;
use super::text::{Row, decimal, lines, print, rounded};

/// Stands where the scene names nothing.
const LEFT_OUT: &str = "left out";

/// Prints the description.
pub(crate) fn describe(command: &Describe) -> Result<(), ProgramError> {
    let scene = super::load(&command.scene)?;
    let text = if command.json { json(&scene)? } else { text(&scene)? };
    print(&text)
}

/// The scene as it was read, for other programs.
fn json(scene: &Scene) -> Result<String, ProgramError> {
    serde_json::to_string(&material::Described::new(scene)).map(|text| text + "\n").map_err(ProgramError::Json)
}

fn text(scene: &Scene) -> Result<String, ProgramError> {
    let simulation = Simulation::new(scene, &Start::default()).map_err(ProgramError::Start)?;
    let title = ("Scene", title(scene));
    let memory = ("Memory", format!("{} bytes a run", simulation.bytes()));
    Ok(lines(&[vec![title], rows(scene), vec![memory]].concat()))
}

/// What is in the scene and what is left out.
pub(super) fn rows(scene: &Scene) -> Vec<Row> {
    let mut rows = layer::rows(scene);
    rows.extend(friction(scene));
    rows.extend(outputs(scene));
    rows.push(("Solver", solver(scene)));
    rows.extend(reduction::rows(scene));
    rows.push(("Input", input(scene)));
    rows.extend(excitation(scene));
    rows
}

fn title(scene: &Scene) -> String {
    scene.description.as_ref().map_or_else(|| scene.name.clone(), |text| format!("{}: {text}", scene.name))
}

/// Names the first of `texts`, the others follow below it.
fn under(name: &'static str, texts: impl IntoIterator<Item = String>) -> Vec<Row> {
    texts.into_iter().enumerate().map(|(i, text)| (if i == 0 { name } else { "" }, text)).collect()
}

fn or_left_out(value: Option<f64>, unit: &str) -> String {
    value.map_or_else(|| LEFT_OUT.into(), |value| format!("{}{unit}", number(value)))
}

/// A number for reading: short, with an exponent where it is far from 1, without the roundings of what it follows from.
fn number(value: f64) -> String {
    decimal(rounded(value, 12), 1e-3..1e6)
}

fn friction(scene: &Scene) -> Vec<Row> {
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
    under("Friction", [coulomb, shear, format!("rate_shear   {rate_shear}")])
}

/// The law as the contacts have it: of a material at its temperature.
fn rate_shear_text(rate_shear: &RateShear) -> String {
    format!(
        "{} N a mass in contact at {} m/s, sharpness {}, held below {} m/s",
        number(rate_shear.force.unwrap_or(0.0)),
        number(rate_shear.reference_speed),
        number(rate_shear.sharpness),
        number(rate_shear.creep_speed())
    )
}

fn outputs(scene: &Scene) -> Vec<Row> {
    under(
        "Outputs",
        OutputGroup::ALL.into_iter().map(|group| format!("{:<13}{}", group.name(), group_text(scene, group))),
    )
}

fn group_text(scene: &Scene, group: OutputGroup) -> String {
    if !scene.outputs.contains(&group) {
        return LEFT_OUT.into();
    }
    if group == OutputGroup::Elements {
        return format!("element[1..{}].x, .z, .F_N, .F_T, .mode", scene.layer.masses);
    }
    let names = variables(scene).into_iter().filter(|variable| variable.group == group).map(|variable| variable.name);
    names.collect::<Vec<_>>().join(", ")
}

fn solver(scene: &Scene) -> String {
    format!(
        "method {}, relative_tolerance {}, absolute_tolerance {} m, max_steps {}",
        word(scene, Parameter::Method),
        number(scene.solver.relative_tolerance),
        number(scene.absolute_tolerance()),
        scene.solver.max_steps
    )
}

fn input(scene: &Scene) -> String {
    match scene.extrapolation {
        Extrapolation::Linear => "u, w; values without rates go on as they came (linear)".into(),
        Extrapolation::Hold => "u, w; values without rates are reached at the end of the step (hold)".into(),
    }
}

fn excitation(scene: &Scene) -> Vec<Row> {
    if scene.excitation.is_empty() {
        return vec![("Excitation", LEFT_OUT.into())];
    }
    under("Excitation", scene.excitation.iter().enumerate().map(|(i, phase)| phase_text(i + 1, phase)))
}

fn phase_text(index: usize, phase: &Phase) -> String {
    let motions = [("u", &phase.u), ("w", &phase.w)].map(|(name, path)| path_text(name, path));
    let motion = motions.concat();
    let motion = if motion.is_empty() { ", held".into() } else { motion };
    let end = match (phase.until_force, phase.until_pressure) {
        (Some(force), _) => format!(", until F_z = {} N", number(force)),
        (None, Some(pressure)) => format!(", until F_z = {} Pa times the layer's area", number(pressure)),
        (None, None) => String::new(),
    };
    format!("{index}  {} s{motion}{end}", number(phase.duration))
}

fn path_text(name: &str, path: &Path) -> String {
    let mut text = String::new();
    if path.rate != 0.0 {
        text += &format!(", {name} at {} m/s", number(path.rate));
    }
    if path.amplitude != 0.0 {
        text += &format!(", {name} by {} m at {} Hz", number(path.amplitude), number(path.frequency));
    }
    text
}

/// The word that the scene gives for `parameter`.
fn word(scene: &Scene, parameter: Parameter) -> String {
    match scene.parameter(parameter) {
        Value::Text(word) => word,
        other => other.to_string(),
    }
}
