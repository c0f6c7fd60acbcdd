//! What the benchmarks share: scenes of any size, and times of several works side by side.

use std::hint::black_box;
use std::path::Path as FilePath;
use std::process::Command;
use std::time::{Duration, Instant};

use asperity::outputs::{Snapshot, variables};
use asperity::scene::{Path, Scene};
use asperity::simulation::{Motion, Simulation, Start};
use criterion::Criterion;

/// Criterion with short runs: the machine's noise is larger than what longer ones would add in digits.
pub fn criterion() -> Criterion {
    let criterion = Criterion::default().warm_up_time(Duration::from_millis(200));
    criterion.measurement_time(Duration::from_secs(1)).sample_size(20).without_plots().configure_from_args()
}

/// Whether the tables are asked for: by `cargo bench` with nothing to choose or to list.
pub fn prints_tables() -> bool {
    std::env::args().skip(1).eq(["--bench".to_owned()])
}

/// Times of works side by side.
#[derive(Clone, Copy)]
pub struct Times<const N: usize> {
    /// The shortest time of a call of each, s: a disturbance only ever adds.
    pub shortest: [f64; N],
    /// The first over the last: the middle one of the ratios of all turns.
    pub ratio: f64,
}

/// Times of a call of each of `works`. They take turns, so that what disturbs the machine disturbs all alike.
pub fn side_by_side<const N: usize>(mut works: [&mut dyn FnMut(); N], budget: Duration) -> Times<N> {
    let calls = works.each_mut().map(|work| calls_of_a_turn(*work));
    let (mut shortest, mut ratios) = ([f64::INFINITY; N], Vec::new());
    let start = Instant::now();
    while start.elapsed() < budget {
        let mut turn = [0.0; N];
        for i in 0..N {
            turn[i] = seconds(|| (0..calls[i]).for_each(|_| works[i]())) / f64::from(calls[i]);
            shortest[i] = shortest[i].min(turn[i]);
        }
        ratios.push(turn[0] / turn[N - 1]);
    }
    ratios.sort_by(f64::total_cmp);
    Times { shortest, ratio: ratios[ratios.len() / 2] }
}

/// As many calls as take a millisecond.
fn calls_of_a_turn(work: &mut dyn FnMut()) -> u32 {
    work();
    let mut calls = 1;
    while seconds(|| (0..calls).for_each(|_| work())) < 1e-3 {
        calls *= 2;
    }
    calls
}

/// The arguments of valgrind that make it count instructions into the file `counts`.
pub fn callgrind(counts: &FilePath) -> Vec<String> {
    let output = format!("--callgrind-out-file={}", counts.display());
    vec!["--tool=callgrind".into(), "--quiet".into(), output]
}

/// The instructions in a file of callgrind's.
pub fn instructions(counts: &FilePath) -> f64 {
    let text = std::fs::read_to_string(counts).unwrap();
    let totals = text.lines().find_map(|line| line.strip_prefix("totals: ")).unwrap();
    totals.trim().parse().unwrap()
}

/// Whether valgrind is there; says so where it is not.
pub fn has_valgrind() -> bool {
    let version = Command::new("valgrind").arg("--version").output();
    if let Err(error) = &version {
        println!("instructions are left out: there is no valgrind ({error})");
    }
    version.is_ok()
}

/// How long `work` takes, s.
pub fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

/// A scene from its text.
pub fn parse(text: &str) -> Scene {
    Scene::parse(text, FilePath::new("bench.toml")).unwrap()
}

/// `masses` masses with `elements` Maxwell elements on each of the four links, `clearance` (m) above a wave. The
/// relaxation times are spread evenly over the decades from 1 µs to 10 ms.
pub fn layer(masses: usize, elements: usize, clearance: f64) -> String {
    let link = |name: &str, stiffness: f64| {
        let element = |j: usize| {
            let relaxation_time = 10_f64.powf(-6.0 + 4.0 * (j as f64 + 0.5) / elements as f64);
            format!("{{ stiffness = {:?}, relaxation_time = {relaxation_time:?} }}", stiffness / elements as f64)
        };
        let maxwell = (0..elements).map(element).collect::<Vec<_>>().join(", ");
        format!("{name} = {{ stiffness = {stiffness:?}, damping = {:?}, maxwell = [{maxwell}] }}\n", 4e-6 * stiffness)
    };
    let links = [("vertical", 2e3), ("horizontal", 1e3), ("lateral_x", 5e2), ("lateral_z", 3e2)];
    let links: String = links.map(|(name, stiffness)| link(name, stiffness)).concat();
    format!(
        "name = 'layer'\n[layer]\nmasses = {masses}\nspacing = 1e-4\nclearance = {clearance:?}\nmass = 1e-6\n{links}\
         [surface]\nkind = 'sinusoid'\namplitude = 1e-5\nwavelength = 9.3e-4\n"
    )
}

/// The carrier slides and swings.
pub fn slide(duration: f64) -> Motion {
    let w = Path { amplitude: 2e-6, frequency: 3000.0, ..Path::default() };
    Motion { duration, u: Path { rate: 0.5, ..Path::default() }, w, ..Motion::default() }
}

/// A run of `scene` whose carrier stands at `w` (m).
pub fn pressed(scene: &Scene, w: f64) -> Simulation {
    let start = Start { w, u_rate: 0.5, ..Start::default() };
    Simulation::new(scene, &start).unwrap()
}

/// The value of the output `name` of `simulation`, a run of `scene`.
pub fn output(scene: &Scene, snapshot: &Snapshot<'_>, name: &str) -> f64 {
    let variables: Vec<_> = variables(scene).into_iter().filter(|variable| variable.name == name).collect();
    let mut value = [f64::NAN];
    snapshot.evaluate(&variables, &mut value);
    black_box(value[0])
}
