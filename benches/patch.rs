//! The time of a step of a patch by element and part, beside the bare loops of its arithmetic in C.
//!
//! The patch turns, rolls and slides so that every element bears, its law is looked up at both ends of each step, and
//! most slip: what `common/patch_cost.c` does. That is compiled with the C compiler `cc` where there is one, with the
//! instructions that this processor has, and run side by side; the least of several runs counts. On a table of several
//! temperatures the same patch runs with heat and without. A wheel's tread, locked and rolling, with heat and without,
//! makes the table of docs/patch.md.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout, reason = "a bench may fail and prints")]

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::Command;
use std::time::Instant;
use std::{env, fs};

use asperity::patch::{Patch, PatchMotion, PatchRun, PatchStart, Pose};
use cpu_time::ProcessTime;

const RUNS: usize = 7;
const STEPS: u32 = 60;
const H: f64 = 1e-3;

/// 24 speeds from 0.1 mm/s to 10 m/s, 8 pressures from 50 kPa to 1.6 MPa, and these temperatures (K), where there are.
fn table(temperatures: &[f64]) -> String {
    let mut text = "# asperity sweep = 1\n# scene = bench\n# nominal_area = 1 m2\n# rest_separation = 0 m\n\
                    speed [m/s],pressure [Pa],temperature [K],status,friction [1],separation [m],\
                    tangential_stiffness [N/m]\n"
        .to_owned();
    let columns: Vec<(String, f64)> = match temperatures {
        [] => vec![(String::new(), 1.0)],
        _ => temperatures.iter().map(|kelvin| (kelvin.to_string(), (-5e-3 * (kelvin - 293.0)).exp())).collect(),
    };
    for (kelvin, softer) in columns {
        rows(&mut text, &kelvin, softer);
    }
    text
}

/// The points at a temperature, of friction multiplied with a factor.
fn rows(text: &mut String, kelvin: &str, softer: f64) {
    for j in 0..24 {
        let x = 1e-4_f64.ln() + f64::from(j) * 1e5_f64.ln() / 23.0;
        for i in 0..8 {
            let h = f64::from(i) * 32_f64.ln() / 7.0;
            let approach = 6e-6 * h * (1.0 - 0.03 * h) - 1e-7 * x - 4e-9 * x * x;
            let friction = softer * (0.8 + 0.2 * (0.5 * x).sin() - 0.02 * f64::from(i));
            let (speed, pressure, stiffness) = (x.exp(), 5e4 * h.exp(), 5e8 * (0.7 * h).exp());
            writeln!(text, "{speed:e},{pressure:e},{kelvin},steady,{friction:e},{:e},{stiffness:e}", -approach)
                .unwrap();
        }
    }
}

fn folder() -> PathBuf {
    let folder = env::temp_dir().join(format!("asperity-bench-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn pose(k: f64) -> [f64; 6] {
    let z = -1.2e-5 + 2e-6 * (0.05 * k).sin();
    [1e-3 * (0.03 * k).sin() / 0.03, 2e-4 * k, z, 5e-5 * (0.07 * k).sin(), 0.0, 0.01 * (0.02 * k).sin()]
}

/// What warms.
const HEAT: &str = ", heat = { conductivity = 0.25, capacity = 1700.0, density = 1100.0, share = 0.3 }";

/// What gives way behind the face.
const BACKING: &str = ", backing = { height = 5e-3, modulus = 6e6 }";
/// The lift (m) at which a face on it bears some 300 kPa as one without does at 0.
const BACKED_LIFT: f64 = -2.5e-4;

/// Seconds an element and step, of the processor and of the clock, of a patch raised by `lift` (m), on a table of
/// several temperatures or of none and with more keys of `[patch]`.
fn patch_times(side: usize, tread: bool, lift: f64, (temperatures, keys): (&[f64], &str)) -> [f64; 2] {
    let length = 1e-3 * side as f64;
    let patch = patch(
        temperatures,
        &format!(
            "shape = \"flat\", length = {length}, width = {length}, nx = {side}, ny = {side}, transport = {tread}{keys}"
        ),
    );
    let pose = |k: f64| {
        let [x, y, z, roll, pitch, yaw] = pose(k);
        [x, y, z + lift, roll, pitch, yaw]
    };
    let temperature = patch.temperature();
    let start = PatchStart { pose: Pose::from_coordinates(pose(0.0)), temperature, ..PatchStart::default() };
    let mut run = PatchRun::new(&patch, &start).unwrap();
    let motions = |k: u32| {
        let (from, to) = (pose(f64::from(k)), pose(f64::from(k + 1)));
        let rates = std::array::from_fn(|i| (to[i] - from[i]) / H);
        PatchMotion { duration: H, rates, transport_speed: 0.0, temperature }
    };
    // The law's intervals are computed as they are met.
    (0..STEPS).for_each(|k| run.advance(&motions(k)).unwrap());
    let (start, clock) = (ProcessTime::now(), Instant::now());
    (STEPS..2 * STEPS).for_each(|k| run.advance(&motions(k)).unwrap());
    [start.elapsed(), clock.elapsed()].map(|time| time.as_secs_f64() / f64::from(STEPS) / patch.count() as f64)
}

/// The patch of a file beside the table of the bench at these temperatures.
fn patch(temperatures: &[f64], shape: &str) -> Patch {
    let folder = folder();
    fs::write(folder.join("table.csv"), table(temperatures)).unwrap();
    let text = format!(
        "name = \"bench\"\ntable = {{ path = \"table.csv\" }}\npatch = {{ {shape} }}\n[fmu]\noutputs = [\"forces\", \
         \"dissipation\"]"
    );
    Patch::parse(&text, &folder.join("patch.toml")).unwrap()
}

/// Seconds of the processor that a cell of a tread of nx by ny takes in a step of 1 ms: of a wheel that rolls at a speed
/// (m/s) with a tenth of slip or, locked, with all of it, 4.2 mm deep on a soft backing; the least of several runs.
fn cell_time((nx, ny): (usize, usize), speed: f64, is_locked: bool, keys: &str) -> f64 {
    let patch = patch(
        TEMPERATURES,
        &format!(
            "shape = \"cylinder\", radius = 0.3, length = 0.13, width = 0.2, nx = {nx}, ny = {ny}, transport = true, \
             backing = {{ normal = 5e7, shear = 8e7 }}{keys}"
        ),
    );
    let (temperature, transport_speed) = (patch.temperature(), if is_locked { 0.0 } else { 0.9 * speed });
    let start = PatchStart {
        pose: Pose { place: [0.0, 0.0, 0.3 - 4.2e-3], angles: [0.0; 3] },
        transport_speed,
        temperature,
        ..PatchStart::default()
    };
    let mut run = PatchRun::new(&patch, &start).unwrap();
    let motion = PatchMotion { duration: H, rates: [speed, 0.0, 0.0, 0.0, 0.0, 0.0], transport_speed, temperature };
    let mut time = || {
        let start = ProcessTime::now();
        (0..STEPS).for_each(|_| run.advance(&motion).unwrap());
        start.elapsed().as_secs_f64() / f64::from(STEPS) / (nx * ny) as f64
    };
    // The law's intervals are computed as they are met.
    time();
    (0..RUNS).map(|_| time()).fold(f64::INFINITY, f64::min)
}

/// The cost of a cell and step of treads, over that of the second where it is locked and nothing warms.
fn print_treads() {
    let unit = cell_time((32, 10), 20.0, true, "");
    println!("cells   locked, heat  10 m/s, heat  20 m/s, heat: for each cell and step of 1 ms");
    for (nx, ny) in [(25, 2), (32, 10), (45, 20)] {
        print!("{:5}", nx * ny);
        for (speed, is_locked) in [(20.0, true), (10.0, false), (20.0, false)] {
            let [cold, warm] = ["", HEAT].map(|keys| cell_time((nx, ny), speed, is_locked, keys) / unit);
            print!("{cold:9.2} {warm:5.2}");
        }
        println!();
    }
}

fn patch_time(side: usize, tread: bool) -> f64 {
    patch_times(side, tread, 0.0, COLD)[0]
}

/// No temperatures, no heat.
const COLD: (&[f64], &str) = (&[], "");
const TEMPERATURES: &[f64] = &[273.0, 283.0, 293.0, 313.0, 333.0, 373.0];

/// The bare loops' seconds an element and step; `None` without a C compiler.
fn floor_time(side: usize) -> Option<f64> {
    let source = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("benches/common/patch_cost.c");
    let program = folder().join("patch_cost");
    let wide =
        cfg!(target_arch = "x86_64") && fs::read_to_string("/proc/cpuinfo").is_ok_and(|text| text.contains("avx2"));
    let mut cc = Command::new("cc");
    if wide {
        cc.arg("-march=x86-64-v3");
    }
    let fast = ["-fno-math-errno", "-fno-trapping-math", "-fassociative-math", "-fno-signed-zeros"];
    let built =
        cc.args(["-O3", "-ffp-contract=off"]).args(fast).arg(source).arg("-o").arg(&program).arg("-lm").status();
    if !built.is_ok_and(|status| status.success()) {
        return None;
    }
    let output = Command::new(program).arg((side * side).to_string()).arg(STEPS.to_string()).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    // The first two rows; the third has clocks inside.
    let times = text.lines().filter(|line| line.contains("ns an element")).take(2);
    times.filter_map(|line| line.split_whitespace().next()?.parse().ok()).reduce(f64::min).map(|ns: f64| 1e-9 * ns)
}

fn main() {
    let side = 96;
    let (mut own, mut own_tread, mut floor) = (f64::INFINITY, f64::INFINITY, f64::INFINITY);
    for _ in 0..RUNS {
        own = own.min(patch_time(side, false));
        own_tread = own_tread.min(patch_time(side, true));
        floor = floor.min(floor_time(side).unwrap_or(f64::INFINITY));
    }
    println!("{:.1} ns an element and part, {:.1} with a tread", 1e9 * own, 1e9 * own_tread);
    println!("{:.1} ns in the bare loops: {:.2} of them", 1e9 * floor, own / floor);
    println!("{:.1} ns where nothing touches", 1e9 * patch_times(side, false, 1e-3, COLD)[0]);
    let least = |keys: &str| {
        let times = (0..RUNS).map(|_| patch_times(side, false, 0.0, (TEMPERATURES, keys))[0]);
        times.fold(f64::INFINITY, f64::min)
    };
    let (cold, warm) = (least(""), least(HEAT));
    println!("{:.1} ns with heat: {:.2} of those without", 1e9 * warm, warm / cold);
    let backed =
        (0..RUNS).map(|_| patch_times(side, false, BACKED_LIFT, (&[], BACKING))[0]).fold(f64::INFINITY, f64::min);
    println!("{:.1} ns with a backing: {:.2} of those without", 1e9 * backed, backed / own);
    // Large enough for several threads.
    let [work, time] = patch_times(4 * side, false, 0.0, COLD);
    println!("{:.1} ns with {} times the elements: by the clock {:.2} of that", 1e9 * work, 16, time / work);
    print_treads();
    let _ = fs::remove_dir_all(folder());
}
