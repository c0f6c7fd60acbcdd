//! What a feature costs that a scene does not need: pairs of scenes, one without a feature, one with it at zero, side
//! by side: `cargo bench --bench leaving_out`. That their results are alike is tested in `tests/physics/leaving_out`.

#![allow(missing_docs, clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "like a test")]

#[allow(dead_code, unreachable_pub, reason = "shared with the other benchmarks")]
mod common;
#[allow(dead_code, unreachable_pub, reason = "shared with the test")]
#[path = "../tests/physics/leaving_out/pairs.rs"]
mod pairs;

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use asperity::outputs::variables;
use asperity::scene::Scene;
use common::{callgrind, has_valgrind, instructions, prints_tables, side_by_side};
use criterion::{BenchmarkId, Criterion};
use pairs::{PIECES, Pair, pairs, piece, reduced, started};

const MASSES: usize = 50;

fn main() {
    let arguments: Vec<_> = std::env::args().collect();
    if let [pair, side, pieces] = &arguments[1..] {
        count(pair.parse().unwrap(), side == "with", pieces.parse().unwrap());
        return;
    }
    let mut criterion = common::criterion();
    run_pairs(&mut criterion);
    criterion.final_summary();
    if prints_tables() {
        print_ratios();
    }
}

/// The pairs, and one whose Maxwell elements are replaced.
fn all() -> Vec<Pair> {
    pairs(MASSES).into_iter().chain([reduced(MASSES)]).collect()
}

/// A run of so many pieces, and what it gives after each.
fn run(scene: &Scene, pieces: usize) -> impl FnMut() {
    let start = started(scene);
    let variables = variables(scene);
    let mut values = vec![0.0; variables.len()];
    move || {
        let mut simulation = start.clone();
        for _ in 0..pieces {
            simulation.advance(&piece()).unwrap();
            simulation.evaluate(&variables, &mut values);
        }
    }
}

fn run_pairs(criterion: &mut Criterion) {
    for pair in all() {
        let mut group = criterion.benchmark_group(pair.feature);
        group.sample_size(10);
        for (name, scene) in [("without", &pair.without), ("at zero", &pair.with)] {
            group.bench_function(BenchmarkId::from_parameter(name), |bencher| bencher.iter(run(scene, PIECES)));
        }
        group.finish();
    }
}

/// Both of a pair in turns, and their instructions, which no other program disturbs.
fn print_ratios() {
    let counts = has_valgrind();
    println!("\na run without a feature over one with it at zero, {MASSES} masses");
    println!("{:<32} {:>8} {:>8} {:>6} {:>12}", "", "ms", "ms", "ratio", "instructions");
    for (i, pair) in all().iter().enumerate() {
        let (mut without, mut with) = (run(&pair.without, PIECES), run(&pair.with, PIECES));
        let times = side_by_side([&mut without, &mut with], Duration::from_secs(2));
        let [a, b] = times.shortest.map(|time| 1e3 * time);
        let counted = if counts { format!("{:.4}", counted_ratio(i)) } else { "-".into() };
        println!("{:<32} {a:>8.3} {b:>8.3} {:>6.3} {counted:>12}", pair.feature, times.ratio);
    }
}

/// Instructions of a run without a feature over those with it at zero.
fn counted_ratio(pair: usize) -> f64 {
    let of = |side: &str, pieces: usize| {
        let counts = Path::new(env!("CARGO_TARGET_TMPDIR")).join("leaving-out.callgrind");
        let mut command = Command::new("valgrind");
        command.args(callgrind(&counts)).arg(std::env::current_exe().unwrap());
        assert!(command.arg(pair.to_string()).arg(side).arg(pieces.to_string()).status().unwrap().success());
        instructions(&counts)
    };
    // What comes before the run falls out.
    let [without, with] = ["without", "with"].map(|side| of(side, COUNTED_PIECES) - of(side, 0));
    without / with
}

/// Pieces of a run whose instructions are counted: under valgrind it takes some fifty times as long.
const COUNTED_PIECES: usize = 4;

/// The run whose instructions are counted.
fn count(pair: usize, with: bool, pieces: usize) {
    let pair = &all()[pair];
    run(if with { &pair.with } else { &pair.without }, pieces)();
}
