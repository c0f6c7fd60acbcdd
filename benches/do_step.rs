//! What fmi2DoStep costs more than the library alone: `cargo bench --bench do_step`.
//!
//! In time: the same steps of 1e-5 s by fmi2DoStep, called as a master calls it, and by the library.
//!
//! In instructions, where valgrind is there: the tread block takes the same steps twice under its callgrind: in the
//! FMU, driven by the C host of the tests, where what runs within fmi2DoStep is counted; and in this program, where
//! everything is. Two lengths of run are subtracted from one another, and with that loading, reading and initialisation
//! fall out. The compiler inlines other functions in the one than in the other, which moves the result by a percent or
//! two.

#![allow(missing_docs, clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "like a test")]

#[allow(dead_code, unreachable_pub, reason = "shared with the other benchmarks")]
#[path = "common/mod.rs"]
mod benches;
#[allow(dead_code, unreachable_pub, reason = "shared with the tests")]
#[path = "../tests/common/mod.rs"]
mod common;
#[allow(
    dead_code,
    unreachable_pub,
    unsafe_code,
    reason = "shared with the tests: a master calls through C's interface"
)]
#[path = "../tests/common/master.rs"]
mod master;

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use asperity::scene::{self, Phase, Scene};
use asperity::simulation::{Motion, Simulation, Start};
use benches::{callgrind, has_valgrind, instructions, layer, parse, pressed, prints_tables, side_by_side};
use common::{Table, pack, python, root, run, scratch};
use criterion::Criterion;
use master::{Fmu, OK};

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

/// Times and counts both.
fn compare() {
    let mut criterion = benches::criterion();
    let (mut fmu, mut library) = (SteppingFmu::new(), SteppingLibrary::new());
    time(&mut criterion, &mut fmu, &mut library);
    criterion.final_summary();
    if !prints_tables() {
        return;
    }
    let times = side_by_side([&mut || fmu.run(), &mut || library.run()], Duration::from_secs(4));
    let [in_fmu, alone] = times.shortest.map(|time| 1e6 * time / STEPS);
    let share = 100.0 * (times.ratio - 1.0);
    println!("\ntime of a step: fmi2DoStep {in_fmu:.2} µs, the library alone {alone:.2} µs: {share:+.1} %");
    if has_valgrind() {
        compare_instructions();
    }
}

/// Steps of a run, small ones of few masses: what the FMU adds to a step is the same for all.
const STEPS: f64 = 20.0;

fn time(criterion: &mut Criterion, fmu: &mut SteppingFmu, library: &mut SteppingLibrary) {
    let mut group = criterion.benchmark_group("20 steps of ten masses");
    group.bench_function("fmi2DoStep", |bencher| bencher.iter(|| fmu.run()));
    group.bench_function("Simulation::advance", |bencher| bencher.iter(|| library.run()));
    group.finish();
}

fn text() -> String {
    format!("{}[friction]\ncoulomb = 0.3\n", layer(10, 3, 0.0))
}

/// Where the carrier stands (m) and how it moves (m/s).
const W: f64 = -5e-6;
const U_RATE: f64 = 0.5;

/// An instance and the state that it goes back to before each run.
struct SteppingFmu {
    fmu: Fmu,
    start: asperity_fmi::bindings::fmi2FMUstate,
    u: u32,
}

impl SteppingFmu {
    fn new() -> Self {
        let fmu = Fmu::of(&text(), false);
        assert_eq!((fmu.setup(0.0), fmu.enter(), fmu.set_real("w", W), fmu.set_rate("u", U_RATE)), (OK, OK, OK, OK));
        assert_eq!(fmu.exit(), OK);
        Self { start: fmu.state(), u: fmu.reference("u"), fmu }
    }

    fn run(&mut self) {
        assert_eq!(self.fmu.set_state(self.start), OK);
        let mut u = 0.0;
        for i in 0..STEPS as u32 {
            assert_eq!((self.fmu.set_reals(&[self.u], &[u]), self.fmu.set_rates(&[self.u], &[1], &[U_RATE])), (OK, OK));
            assert_eq!(self.fmu.step(f64::from(i) * STEP, STEP), OK);
            u += U_RATE * STEP;
        }
    }
}

struct SteppingLibrary {
    start: Simulation,
}

impl SteppingLibrary {
    fn new() -> Self {
        Self { start: pressed(&parse(&text()), W) }
    }

    fn run(&mut self) {
        let mut simulation = self.start.clone();
        let u = scene::Path { rate: U_RATE, ..scene::Path::default() };
        for _ in 0..STEPS as u32 {
            simulation.advance(&Motion { duration: STEP, u, w: scene::Path::default(), ..Motion::default() }).unwrap();
        }
    }
}

/// Counts the instructions of both and compares them.
fn compare_instructions() {
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
        [u + phase.u.at(s).position, w + phase.w.at(s).position]
    })
}

fn instructions_in_fmu(fmu: &Path, motion: &Path) -> f64 {
    a_step(|points| {
        let counts = fmu.with_extension("callgrind");
        let under = format!("valgrind {} --toggle-collect=fmi2DoStep", callgrind(&counts).join(" "));
        let mut host = Command::new(python());
        host.arg(root().join("tests/host/run.py")).args([fmu, motion]).arg("-o").arg(fmu.with_extension("csv"));
        run(host.args(["--points", &points.to_string(), "--under", &under]));
        instructions(&counts)
    })
}

fn instructions_alone(motion: &Path) -> f64 {
    a_step(|points| {
        let counts = motion.with_extension("callgrind");
        let mut command = Command::new("valgrind");
        command.args(callgrind(&counts)).arg(std::env::current_exe().unwrap()).arg("library").arg(motion);
        run(command.arg(points.to_string()));
        instructions(&counts)
    })
}

/// The instructions of one step, of those that the longer run has more than the shorter one.
fn a_step(count: impl Fn(usize) -> f64) -> f64 {
    let [shorter, longer] = POINTS.map(count);
    (longer - shorter) / (POINTS[1] - POINTS[0]) as f64
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
        simulation
            .advance(&Motion { duration: time[i + 1] - time[i], u: path(&u), w: path(&w), ..Motion::default() })
            .unwrap();
    }
}
