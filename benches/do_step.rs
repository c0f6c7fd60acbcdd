//! How many instructions fmi2DoStep costs more than the library alone: `cargo bench --bench do_step`.
//!
//! The tread block takes the same steps of 1e-5 s twice under valgrind's callgrind: in the FMU, driven by the C host of
//! the tests, where what runs within fmi2DoStep is counted; and in this program, where everything is. Two lengths of
//! run are subtracted from one another, and with that loading, reading and initialisation fall out. The compiler
//! inlines other functions in the one than in the other, which moves the result by a percent or two.

#![allow(missing_docs, clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "like a test")]

#[allow(dead_code, unreachable_pub, reason = "shared with the tests")]
#[path = "../tests/common/mod.rs"]
mod common;

use std::fs;
use std::path::Path;
use std::process::Command;

use asperity::scene::{self, Phase, Scene};
use asperity::simulation::{Motion, Simulation, Start};
use common::{Table, pack, python, root, run, scratch};

const SCENE: &str = "scenes/tread-block/tread-block.toml";
/// Communication step, s.
const STEP: f64 = 1e-5;
/// Communication points of the shorter run and of the longer one.
const POINTS: [usize; 2] = [51, 551];
/// The largest share that fmi2DoStep may cost more.
const ALLOWED: f64 = 0.03;

fn main() {
    let arguments: Vec<_> = std::env::args().collect();
    match &arguments[1..] {
        [mode, motion, points] if mode == "library" => library(Path::new(motion), points.parse().unwrap()),
        _ => compare(),
    }
}

/// Counts both and compares them.
fn compare() {
    let folder = scratch("do-step");
    let motion = folder.join("motion.csv");
    fs::write(&motion, motion_text(&Scene::load(&root().join(SCENE)).unwrap())).unwrap();
    let fmu = pack(&root().join(SCENE), &folder);
    let [in_fmu, alone] = [instructions_in_fmu(&fmu, &motion), instructions_alone(&motion)];
    let share = in_fmu / alone - 1.0;
    println!("instructions a step: fmi2DoStep {in_fmu:.0}, the library alone {alone:.0}: {:+.3} %", 100.0 * share);
    assert!(share <= ALLOWED, "more than {} %", 100.0 * ALLOWED);
}

/// The excitation at even times.
fn motion_text(scene: &Scene) -> String {
    let rows = (0..POINTS[1]).map(|i| {
        let time = i as f64 * STEP;
        let [u, w] = place(&scene.excitation, time);
        format!("{time:?},{u:?},{w:?}\n")
    });
    "time,u,w\n".to_owned() + &rows.collect::<String>()
}

/// Where the carrier is at `time`.
fn place(phases: &[Phase], time: f64) -> [f64; 2] {
    let mut start = 0.0;
    phases.iter().fold([0.0; 2], |[u, w], phase| {
        let s = (time - start).clamp(0.0, phase.duration);
        start += phase.duration;
        [u + phase.u.at(s), w + phase.w.at(s)]
    })
}

fn instructions_in_fmu(fmu: &Path, motion: &Path) -> f64 {
    a_step(|points| {
        let counts = fmu.with_extension("callgrind");
        let under = format!("{} --toggle-collect=fmi2DoStep", callgrind(&counts).join(" "));
        let mut host = Command::new(python());
        host.arg(root().join("tests/host/run.py")).args([fmu, motion]).arg("-o").arg(fmu.with_extension("csv"));
        run(host.args(["--points", &points.to_string(), "--under", &under]));
        total(&counts)
    })
}

fn instructions_alone(motion: &Path) -> f64 {
    a_step(|points| {
        let counts = motion.with_extension("callgrind");
        let [valgrind, options @ ..] = &callgrind(&counts)[..] else { unreachable!() };
        let mut command = Command::new(valgrind);
        command.args(options).arg(std::env::current_exe().unwrap()).arg("library").arg(motion);
        run(command.arg(points.to_string()));
        total(&counts)
    })
}

/// The instructions of one step, of those that the longer run has more than the shorter one.
fn a_step(instructions: impl Fn(usize) -> f64) -> f64 {
    let [shorter, longer] = POINTS.map(instructions);
    (longer - shorter) / (POINTS[1] - POINTS[0]) as f64
}

fn callgrind(counts: &Path) -> Vec<String> {
    let output = format!("--callgrind-out-file={}", counts.display());
    vec!["valgrind".into(), "--tool=callgrind".into(), "--quiet".into(), output]
}

/// The instructions in a file of callgrind's.
fn total(counts: &Path) -> f64 {
    let text = fs::read_to_string(counts).unwrap();
    let totals = text.lines().find_map(|line| line.strip_prefix("totals: ")).unwrap();
    totals.trim().parse().unwrap()
}

/// The library alone takes the steps to the communication point number `points`, at the rates that the host gives.
fn library(motion: &Path, points: usize) {
    let motion = Table::read(motion);
    let [time, u, w] = ["time", "u", "w"].map(|name| motion.column(name));
    let rate = |values: &[f64], i: usize| (values[i + 1] - values[i]) / (time[i + 1] - time[i]);
    let start = Start { u_rate: rate(&u, 0), w_rate: rate(&w, 0), ..Start::default() };
    let mut simulation = Simulation::new(&Scene::load(&root().join(SCENE)).unwrap(), &start).unwrap();
    for i in 0..points - 1 {
        let path = |values: &[f64]| scene::Path { rate: rate(values, i), ..scene::Path::default() };
        simulation.advance(&Motion { duration: time[i + 1] - time[i], u: path(&u), w: path(&w) }).unwrap();
    }
}
