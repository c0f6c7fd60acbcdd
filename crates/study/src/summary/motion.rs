//! The carrier and its excitation in the summary of a scene.

use asperity::scene::{Axis, CarrierBody, CarrierInitial, Force, Path, Phase, Scene};

use super::words::{LEFT_OUT, number};
use crate::labelled::{LabelledLine, labelled};

/// The axes along which the carrier is a body.
pub(super) fn carrier(scene: &Scene) -> Vec<LabelledLine> {
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

pub(super) fn excitation(scene: &Scene) -> Vec<LabelledLine> {
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
