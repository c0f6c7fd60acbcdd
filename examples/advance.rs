//! Many short motions of a small layer, and the processor time that they take, in s: what `python/benches/bench.py` compares the module's with.
//!
//! `cargo run --release --example advance`

#![allow(clippy::print_stdout, reason = "prints its results")]

use std::error::Error;
use std::path::Path;

use asperity::scene::Path as Displacement;
use asperity::simulation::Start;
use asperity::{Motion, Scene, Simulation};
use cpu_time::ThreadTime;

const CALLS: u32 = 10_000;
const DURATION: f64 = 1e-6;
const REPETITIONS: u32 = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("python/benches/small.toml");
    let scene = Scene::load(&file)?;
    let rate = |rate: f64| Displacement { rate, ..Displacement::default() };
    let mut best = f64::INFINITY;
    for _ in 0..REPETITIONS {
        let mut simulation = Simulation::new(&scene, &Start::default())?;
        simulation.advance(&Motion { duration: 1e-3, w: rate(-0.02), ..Motion::default() })?;
        let start = ThreadTime::now();
        for _ in 0..CALLS {
            simulation.advance(&Motion { duration: DURATION, u: rate(0.1), ..Motion::default() })?;
        }
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!("{best}");
    Ok(())
}
