//! A scene with everything, and what the tests of the conductor share.

use std::path::Path as FilePath;

use super::{Motion, Simulation, Start};
use crate::outputs::variables;
use crate::scene::{Path, Scene};

/// Six masses over a wave, Maxwell elements on all links, both parts of friction, all outputs.
pub(super) const TEXT: &str = include_str!("../../tests/common/everything.toml");

/// Six hardly damped masses that stick and slip: what they do after a few slips depends on every error before.
pub(super) const STICK_SLIP: &str = include_str!("../../tests/common/stick-slip.toml");

/// A motion after which masses are free, slip and stick.
pub(super) const WAVE: Motion = Motion {
    duration: 1.3e-4,
    u: Path { rate: 0.02, amplitude: 1e-6, frequency: 2000.0 },
    w: Path { rate: -0.002, amplitude: 1e-7, frequency: 5000.0 },
    ..Motion::REST
};

pub(super) fn scene() -> Scene {
    Scene::parse(TEXT, FilePath::new("everything.toml")).unwrap()
}

/// The scene with everything, and with a shear strength that depends on the speed.
pub(super) fn scene_with_rate_shear() -> Scene {
    let law = "shear_force = 5e-5\nrate_shear = { force = 2e-4, reference_speed = 3e-3, sharpness = 0.1 }";
    Scene::parse(&TEXT.replace("shear_force = 5e-5", law), FilePath::new("rate-shear.toml")).unwrap()
}

/// The same whose contacts remember the speed.
pub(super) fn scene_with_memory() -> Scene {
    let law =
        "shear_force = 5e-5\nmemory = 1e-6\nrate_shear = { force = 2e-4, reference_speed = 3e-3, sharpness = 0.1 }";
    Scene::parse(&TEXT.replace("shear_force = 5e-5", law), FilePath::new("memory.toml")).unwrap()
}

/// The same with links along z in spatial measure.
pub(super) fn scene_in_spatial_measure() -> Scene {
    let text = TEXT.replace("[layer]", "[layer]\nkinematics = 'spatial'");
    Scene::parse(&text, FilePath::new("spatial.toml")).unwrap()
}

/// Six masses of a material whose contacts touch on a part of their area.
pub(super) fn scene_with_real_area() -> Scene {
    Scene::parse(&text_with_real_area(), FilePath::new("real-area.toml")).unwrap()
}

/// What is left of the balance are the errors of some hundred steps at a tolerance of 1e-11.
#[test]
fn energy_balances_in_spatial_measure() {
    let bodies = "[carrier]\nx = { mass = 1e-4, stiffness = 800.0, damping = 0.02 }\n\
                  z = { mass = 2e-4, stiffness = 300.0, damping = 0.2, load = 0.05 }\n[surface]";
    let text = TEXT.replace("[layer]", "[layer]\nkinematics = 'spatial'");
    for text in [text.replace("[surface]", bodies), text] {
        let scene = Scene::parse(&text, FilePath::new("spatial.toml")).unwrap();
        let start = Start { w: -2e-6, u_rate: 0.1, ..Start::default() };
        let mut simulation = Simulation::new(&scene, &start).unwrap();
        for _ in 0..3 {
            simulation.advance(&WAVE).unwrap();
        }
        let values = variables_of(&scene, &mut simulation);
        let of = |name: &str| values.iter().find(|(found, _)| found == name).unwrap().1;
        let lost: f64 =
            ["E_damper", "E_maxwell", "E_friction"].map(|name| of(&format!("dissipation.{name}"))).iter().sum();
        let missed = of("energy.residual");
        assert!(lost > 0.0 && missed.abs() < 1e-8 * lost, "{missed:e} J of {lost:e} J");
    }
}

fn text_with_real_area() -> String {
    let (_, rest) = TEXT.split_once("[surface]").unwrap();
    let layer = "name = 'area'\nlayer = { masses = 6, spacing = 1.1e-4, foundation = 'half_space', width = 1e-2 }\n\
                 material = { density = 1100, poisson_ratio = 0.49, equilibrium_modulus = 2e6, viscosity = 10.0, \
                 prony = [{ modulus = 3e6, relaxation_time = 1e-4 }] }\n[surface]\n\
                 fine = { hurst = 0.8, rms_slope = 0.5, longest = 2e-5, shortest = 5e-6 }";
    layer.to_owned() + &rest.replace("shear_force = 5e-5", "shear_strength = 2e5")
}

/// The same where friction heats the contacts.
pub(super) fn scene_with_heat() -> Scene {
    let material = "density = 1100, wlf = { c1 = 8.0, c2 = 100.0, reference_temperature = 300.0, temperature = 300.0 }, \
                    heat = { conductivity = 0.25, capacity = 1700.0 }, ";
    let text = text_with_real_area().replace("density = 1100, ", material);
    Scene::parse(&text, FilePath::new("heat.toml")).unwrap()
}

/// All variables but the processor time, by name.
pub(super) fn variables_of(scene: &Scene, simulation: &mut Simulation) -> Vec<(String, f64)> {
    let variables = variables(scene);
    let mut values = vec![0.0; variables.len()];
    simulation.evaluate(&variables, &mut values);
    let named = variables.into_iter().map(|variable| variable.name).zip(values);
    named.filter(|(name, _)| name != "solver.run_time").collect()
}
