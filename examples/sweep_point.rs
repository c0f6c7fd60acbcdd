//! One point of a friction curve: a layer under a constant load is slid at one speed until it is steady; the means of the
//! forces over a whole wave of its surface are the friction coefficient. `asperity sweep` does this over grids of
//! speeds, pressures and temperatures, finds how long to slide, and says how sure each mean is.
//!
//! `cargo run --release --example sweep_point`

#![allow(clippy::print_stdout, reason = "prints its results")]

use std::error::Error;

use asperity::outputs::variables;
use asperity::scene::Path;
use asperity::simulation::Start;
use asperity::{Motion, Scene, Simulation};

/// The carrier is a body of 1 g that a load of 0.6 N presses: it finds its own height, as on a friction tester.
const SCENE: &str = "
    name = 'point'
    [layer]
    masses = 20
    spacing = 5e-5
    mass = 1e-7
    vertical = { stiffness = 2e3, damping = 8e-3, maxwell = [{ stiffness = 4e3, relaxation_time = 1e-3 }] }
    horizontal = { stiffness = 4e3, damping = 8e-3 }
    [surface]
    kind = 'sinusoid'
    amplitude = 1e-5
    wavelength = 1e-3
    [friction]
    coulomb = 0.3
    [carrier.z]
    mass = 1e-3
    damping = 2.0
    load = 0.6
    initial = 'equilibrium'
    [solver]
    method = 'step'
    relative_tolerance = 1e-4
";
const SPEED: f64 = 0.1;
const WAVELENGTH: f64 = 1e-3;

fn main() -> Result<(), Box<dyn Error>> {
    let scene = Scene::parse(SCENE, "point.toml".as_ref())?;
    let mut simulation = Simulation::new(&scene, &Start { u_rate: SPEED, ..Start::default() })?;
    let slide = |waves: f64| Motion {
        duration: waves * WAVELENGTH / SPEED,
        u: Path { rate: SPEED, ..Path::default() },
        ..Motion::default()
    };
    simulation.advance(&slide(5.0))?;

    let variables = variables(&scene);
    let mut values = vec![0.0; variables.len()];
    let (mut tangential, mut normal) = (0.0, 0.0);
    let wave = slide(1.0);
    let times: Vec<f64> = (0..200).map(|i| wave.duration * f64::from(i) / 200.0).collect();
    simulation.advance_observed(&wave, None, &times, |_, snapshot| {
        snapshot.evaluate(&variables, &mut values);
        // The group `forces` begins with F_x and F_z.
        tangential -= values[0];
        normal += values[1];
    })?;
    println!("at {SPEED} m/s: friction coefficient {:.4}", tangential / normal);
    println!("of which Coulomb's 0.3; the rest is hysteresis of the rubber over the waves");
    Ok(())
}
