//! A run: the tread block along the motion that its scene gives, with ten rows a phase.
//!
//! `cargo run --release --example run`

#![allow(clippy::print_stdout, reason = "prints its results")]

use std::error::Error;
use std::path::Path;

use asperity::outputs::variables;
use asperity::scene::Scene;
use asperity::simulation::{Motion, Simulation, Start};

const ROWS: u32 = 10;

fn main() -> Result<(), Box<dyn Error>> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/tread-block/tread-block.toml");
    let scene = Scene::load(&file)?;
    // The carrier starts as fast as its first phase begins.
    let Some(first) = scene.excitation.first() else { return Err("the scene has no excitation".into()) };
    let start = Start { u_rate: first.u.at(0.0).speed, w_rate: first.w.at(0.0).speed, ..Start::default() };
    let mut simulation = Simulation::new(&scene, &start)?;

    let shown = ["F_x", "F_z", "P_diss", "E_diss", "contact.ratio"];
    let variables: Vec<_> =
        variables(&scene).into_iter().filter(|variable| shown.contains(&variable.name.as_str())).collect();
    println!("{:>14}{}", "time", variables.iter().map(|variable| format!("{:>15}", variable.name)).collect::<String>());
    let mut values = vec![0.0; variables.len()];
    for phase in &scene.excitation {
        let motion = Motion { duration: phase.duration, u: phase.u, w: phase.w, ..Motion::default() };
        let times: Vec<f64> = (1..=ROWS).map(|i| phase.duration * f64::from(i) / f64::from(ROWS)).collect();
        let phase_start = simulation.time();
        simulation.advance_observed(&motion, None, &times, |time, snapshot| {
            snapshot.evaluate(&variables, &mut values);
            let row: String = values.iter().map(|value| format!("{value:15.6e}")).collect();
            println!("{:14.6e}{row}", phase_start + time);
        })?;
    }
    Ok(())
}
