//! A run against the number of masses k: `cargo bench --bench run`.
//!
//! The free layer takes the same steps whatever k, so its time grows as k. In contact the mode changes are located one
//! by one, and their number grows with k, too.

#![allow(missing_docs, clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "like a test")]

#[allow(dead_code, unreachable_pub, reason = "shared with the other benchmarks")]
mod common;

use std::time::Duration;

use asperity::scene::Scene;
use asperity::simulation::Simulation;
use common::{layer, output, parse, pressed, prints_tables, side_by_side, slide};
use criterion::{BatchSize, BenchmarkId, Criterion, Throughput};

/// Length of the run, s.
const DURATION: f64 = 1e-4;
/// What the carrier stands at, m: the wave's crests are at 1e-5.
const FREE: f64 = 2e-2;
const PRESSED: f64 = -5e-6;
const FREE_MASSES: [usize; 4] = [10, 100, 1000, 10_000];
const PRESSED_MASSES: [usize; 3] = [10, 50, 250];

fn main() {
    let mut criterion = common::criterion();
    against_masses(&mut criterion, "free run against k", &FREE_MASSES, FREE);
    against_masses(&mut criterion, "run in contact against k", &PRESSED_MASSES, PRESSED);
    criterion.final_summary();
    if prints_tables() {
        print_table("free", &FREE_MASSES, FREE);
        print_table("in contact", &PRESSED_MASSES, PRESSED);
    }
}

fn scene(masses: usize) -> Scene {
    let outputs = "['forces', 'dissipation', 'solver']";
    parse(&format!("{}[friction]\ncoulomb = 0.3\n[fmu]\noutputs = {outputs}\n", layer(masses, 3, 0.0)))
}

fn go(mut simulation: Simulation) -> Simulation {
    simulation.advance(&slide(DURATION)).unwrap();
    simulation
}

fn against_masses(criterion: &mut Criterion, name: &str, masses: &[usize], w: f64) {
    let mut group = criterion.benchmark_group(name);
    for &masses in masses {
        let start = pressed(&scene(masses), w);
        group.throughput(Throughput::Elements(masses as u64));
        group.bench_function(BenchmarkId::from_parameter(masses), |bencher| {
            bencher.iter_batched(|| start.clone(), go, BatchSize::LargeInput);
        });
    }
    group.finish();
}

/// The steps and mode changes that the time goes into.
fn print_table(name: &str, masses: &[usize], w: f64) {
    println!("\nrun {name}, {DURATION} s");
    println!("{:>8} {:>10} {:>8} {:>8} {:>18}", "k", "time, ms", "steps", "events", "µs a mass and step");
    for &masses in masses {
        let scene = scene(masses);
        let start = pressed(&scene, w);
        let [time] = side_by_side([&mut || drop(go(start.clone()))], Duration::from_millis(500)).shortest;
        let mut end = go(start);
        let [steps, events] = ["solver.steps", "solver.events"].map(|name| output(&scene, &end.snapshot(), name));
        let each = 1e6 * time / (steps * masses as f64);
        println!("{masses:>8} {:>10.3} {steps:>8} {events:>8} {each:>18.3}", 1e3 * time);
    }
}
