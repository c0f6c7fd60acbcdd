//! A run: the tread block along the motion that its scene gives, with ten rows a phase.
//!
//! `cargo run --release --example run`

#![allow(clippy::print_stdout, reason = "prints its results")]

use std::error::Error;
use std::path::Path;

use asperity::Scene;

fn main() -> Result<(), Box<dyn Error>> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/tread-block/tread-block.toml");
    let rows = asperity::run(&Scene::load(&file)?)?.per_phase(10);
    let names = rows.variables().iter().map(|variable| variable.name.clone());
    let shown: Vec<(usize, String)> = names.enumerate().filter(|(_, name)| SHOWN.contains(&name.as_str())).collect();
    println!("{:>14}{}", "time", shown.iter().map(|(_, name)| format!("{name:>15}")).collect::<String>());
    for row in rows {
        let row = row?;
        let values: String = shown.iter().map(|(i, _)| format!("{:15.6e}", row.values[*i])).collect();
        println!("{:14.6e}{values}", row.time);
    }
    Ok(())
}

const SHOWN: [&str; 5] = ["F_x", "F_z", "P_diss", "E_diss", "contact.ratio"];
