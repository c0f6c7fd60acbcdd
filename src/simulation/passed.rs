//! Phases that a force ends which F_z has passed before they begin: a run leaves them at once.

use super::{Simulation, Start};
use crate::scene::{Phase, Scene};

/// The warnings of the phases of `scene` that end as they begin, as far as the start tells it and the forces at which the
/// phases before them end.
pub fn passed_phases(scene: &Scene) -> Vec<String> {
    let area = scene.layer.area();
    let ends = scene.excitation.iter().map_while(|phase| Some((phase, phase.end_force(area)?)));
    let mut ends = ends.enumerate().peekable();
    if ends.peek().is_none() {
        return Vec::new();
    }
    let Ok(mut simulation) = Simulation::new(scene, &Start::of(scene)) else { return Vec::new() };
    let (mut force, mut found) = (simulation.snapshot().on_carrier.z, Vec::new());
    for (before, (phase, end)) in ends {
        if force >= end {
            found.push(passed_phase(scene, phase, before, force));
        }
        force = force.max(end);
    }
    found
}

/// The warning that `phase` of `scene`, with so many `before` it, ends as it begins, F_z being `force` (N) already.
pub fn passed_phase(scene: &Scene, phase: &Phase, before: usize, force: f64) -> String {
    let end = match (phase.until_force, phase.until_pressure, scene.layer.area()) {
        (None, Some(pressure), Some(area)) => {
            format!("F_z over the layer's area is {:.3e} Pa, not below until_pressure = {pressure:?} Pa", force / area)
        }
        (until, ..) => format!("F_z is {force:.3e} N, not below until_force = {:?} N", until.unwrap_or_default()),
    };
    let cause = match scene.carrier.z {
        _ if before > 0 => format!("phase {before} leaves it there"),
        Some(_) => "the carrier starts there, by carrier.z.start or carrier.z.initial".to_owned(),
        None => format!(
            "layer.clearance = {:?} m puts the profile into the layer; more of it lets the run begin without contact",
            scene.layer.clearance
        ),
    };
    format!("phase {} of the excitation ends as it begins: {end}: {cause}", before + 1)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn warnings(layer: &str, ends: [f64; 2]) -> Vec<String> {
        let [first, second] = ends.map(|end| format!("{{ duration = 1e-3, w_rate = -0.01, until_force = {end} }}"));
        let text = format!(
            "name = 'p'\nlayer = {{ masses = 8, spacing = 1e-4, mass = 1e-7, vertical = {{ stiffness = 2e3 }}, {layer} }}\n\
             surface = {{ kind = 'sinusoid', amplitude = 2e-5, wavelength = 8e-4 }}\nexcitation = [{first}, {second}]"
        );
        passed_phases(&Scene::parse(&text, "p.toml".as_ref()).unwrap())
    }

    #[test]
    fn a_phase_whose_force_is_passed_as_it_begins_is_a_warning_with_the_key_that_causes_it() {
        assert_eq!(warnings("clearance = 2.1e-5", [1e-2, 2e-2]), [""; 0]);
        let pressed = warnings("clearance = 0", [1e-2, 10.0]);
        assert!(
            pressed.len() == 1 && pressed[0].starts_with("phase 1 of the excitation ends as it begins"),
            "{pressed:?}"
        );
        assert!(pressed[0].contains("until_force = 0.01 N: layer.clearance = 0.0 m"), "{pressed:?}");
        let twice = warnings("clearance = 2.1e-5", [2e-2, 1e-2]);
        assert!(twice.len() == 1 && twice[0].ends_with("phase 1 leaves it there"), "{twice:?}");
    }
}
