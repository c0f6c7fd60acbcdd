//! A scene made in code: what is the same in every run is text, what is computed are fields.
//!
//! `cargo run --release --example scene_in_code`

#![allow(clippy::print_stdout, reason = "prints its results")]

use std::error::Error;

use asperity::outputs::variables;
use asperity::scene::{Link, LinkKind, MaxwellElement, Path, Surface};
use asperity::simulation::Start;
use asperity::{Motion, Scene, Simulation};

const BASE: &str = "
    name = 'in-code'
    layer = { masses = 40, spacing = 5e-5, mass = 1e-7 }
    surface = { kind = 'flat' }
    friction = { coulomb = 0.4 }
    fmu = { outputs = ['forces', 'contact'] }
";

/// A spring, a damper that keeps a mass from ringing, and `elements` Maxwell elements, one a decade.
fn link(stiffness: f64, elements: i32) -> Link {
    let element = |i| MaxwellElement { stiffness: 0.5 * stiffness, relaxation_time: 10_f64.powi(-5 + i) };
    Link { stiffness: Some(stiffness), damping: Some(4e-6 * stiffness), maxwell: (0..elements).map(element).collect() }
}

/// Two waves one upon the other, m.
fn height(x: f64) -> f64 {
    let wave = |amplitude: f64, length: f64| amplitude * (std::f64::consts::TAU * x / length).sin();
    wave(4e-6, 2e-3) + wave(1e-6, 2e-4)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut scene = Scene::parse(BASE, "in-code.toml".as_ref())?;
    scene.layer.links[LinkKind::Vertical] = Some(link(2e3, 4));
    scene.layer.links[LinkKind::Horizontal] = Some(link(1e3, 4));
    let x: Vec<f64> = (0..=400).map(|i| f64::from(i) * 5e-6).collect();
    let mut z: Vec<f64> = x.iter().map(|&x| height(x)).collect();
    // A periodic profile ends at the height at which it begins, to the last digit.
    z[400] = z[0];
    scene.surface = Surface::new(x, z, true);

    let variables = variables(&scene);
    let mut values = vec![0.0; variables.len()];
    for rate in [-0.002, -0.005, -0.01] {
        let mut simulation = Simulation::new(&scene, &Start { w_rate: rate, ..Start::default() })?;
        let press = Motion { duration: 1e-3, w: Path { rate, ..Path::default() }, ..Motion::default() };
        simulation.advance(&press)?;
        simulation.evaluate(&variables, &mut values);
        println!("pressed by {:4.1} µm:", -1e3 * rate);
        for (variable, value) in variables.iter().zip(&values) {
            println!("    {:<20} {value:12.5e} {}", variable.name, variable.unit.name());
        }
    }
    Ok(())
}
