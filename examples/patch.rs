//! A contact patch: the tread of a wheel that is pressed down, rolls, and slips more and more.
//!
//! `cargo run --release --example patch`

#![allow(clippy::print_stdout, reason = "prints its results")]

use std::error::Error;
use std::path::Path;

use asperity::patch::{PatchMotion, PatchStart, Pose};
use asperity::{Patch, PatchRun};

/// m/s
const SPEED: f64 = 10.0;
/// Radius of the tread, m: the height of the wheel's axis where it just touches.
const RADIUS: f64 = 0.3;

fn main() -> Result<(), Box<dyn Error>> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/patch-mujoco/tread.toml");
    let patch = Patch::load(&file)?;
    let temperature = patch.temperature();
    let rolling = [SPEED, 0.0, 0.0, 0.0, 0.0, 0.0];
    let pose = Pose { place: [0.0, 0.0, RADIUS], angles: [0.0; 3] };
    let start = PatchStart { pose, rates: rolling, transport_speed: SPEED, temperature, ..PatchStart::default() };
    let mut run = PatchRun::new(&patch, &start)?;
    let shown = ["force.x", "force.z", "moment.y", "P_diss", "contact.area"];
    let variables: Vec<_> =
        patch.variables().into_iter().filter(|variable| shown.contains(&variable.name.as_str())).collect();
    let mut values = vec![0.0; variables.len()];

    // Down by 2 mm in 10 ms, then on at that height.
    let down = [SPEED, 0.0, -0.2, 0.0, 0.0, 0.0];
    run.advance(&PatchMotion { duration: 0.01, rates: down, transport_speed: SPEED, temperature })?;
    println!("{:>6}{}", "slip", variables.iter().map(|variable| format!("{:>13}", variable.name)).collect::<String>());
    for slip in [0.0, 0.01, 0.02, 0.05, 0.1, 0.3] {
        // Long enough for the tread to run through the contact several times.
        let transport_speed = SPEED * (1.0 - slip);
        run.advance(&PatchMotion { duration: 0.05, rates: rolling, transport_speed, temperature })?;
        run.evaluate(&variables, &mut values);
        println!("{slip:6.2}{}", values.iter().map(|value| format!("{value:13.4e}")).collect::<String>());
    }
    Ok(())
}
