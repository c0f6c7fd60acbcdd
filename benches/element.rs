//! A communication step of a point-contact element against one of the layer that it stands for: `cargo bench --bench
//! element`.

#![allow(missing_docs, clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "like a test")]

#[allow(dead_code, unreachable_pub, reason = "shared with the other benchmarks")]
mod common;
#[allow(dead_code, unreachable_pub, reason = "shared with the tests")]
#[path = "../tests/common/sweeps.rs"]
mod sweeps;

use std::path::Path;
use std::time::Duration;

use asperity::element::{Element, FrictionTable, PointContact};
use asperity::scene::{self, Scene};
use asperity::simulation::{Motion, Simulation, Start};
use common::{prints_tables, side_by_side};
use criterion::Criterion;
use sweeps::{Grid, REST, WARM, separation};

/// The communication step, s.
const STEP: f64 = 1e-4;
/// The carrier's speed, m/s.
const SPEED: f64 = 0.5;
/// Steps of the element on one of the layer, where both are timed side by side.
const STEPS: u32 = 10_000;

fn main() {
    let mut criterion = common::criterion();
    steps(&mut criterion);
    criterion.final_summary();
    if prints_tables() {
        print_ratio();
    }
}

/// The tread block, pressed and slid until it slides steadily.
fn layer() -> Simulation {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("scenes/tread-block/tread-block.toml");
    let scene = Scene::load(&path).unwrap();
    let start = Start { w: -2.5e-5, u_rate: SPEED, ..Start::default() };
    let mut simulation = Simulation::new(&scene, &start).unwrap();
    (0..10).for_each(|_| simulation.advance(&slide()).unwrap());
    simulation
}

/// One communication step of the layer.
fn slide() -> Motion {
    let u = scene::Path { rate: SPEED, ..scene::Path::default() };
    Motion { duration: STEP, u, w: scene::Path::default(), ..Motion::default() }
}

/// The cost of an element depends only on the number of pressures in its table: 4.
fn element() -> Element {
    let table = FrictionTable::parse(&Grid::plain().text(), Path::new("table.csv")).unwrap();
    let w = separation(SPEED, 2e5, WARM) - REST;
    Element::new(&PointContact::new(table), &Start { w, u_rate: SPEED, ..Start::default() }).unwrap()
}

/// Speed and height change in each step, so that the law is evaluated anew.
fn step_element(element: &mut Element, i: u32) {
    let sign = f64::from(i % 2) - 0.5;
    element.advance(STEP, SPEED + 0.01 * sign, 1e-3 * sign).unwrap();
}

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("communication step of 0.1 ms");
    let (start, mut own) = (layer(), element());
    group.bench_function("layer", |bencher| {
        bencher.iter_batched_ref(|| start.clone(), |layer| layer.advance(&slide()), criterion::BatchSize::LargeInput);
    });
    let mut i = 0;
    group.bench_function("element", |bencher| {
        bencher.iter(|| {
            i += 1;
            step_element(&mut own, i);
        });
    });
    group.finish();
}

fn print_ratio() {
    let (start, mut own) = (layer(), element());
    let mut of_layer = || drop(start.clone().advance(&slide()));
    let mut of_element = || (0..STEPS).for_each(|i| step_element(&mut own, i));
    let [layer, element] = side_by_side([&mut of_layer, &mut of_element], Duration::from_secs(5)).shortest;
    let each = element / f64::from(STEPS);
    println!("\na step of {STEP} s: the tread block {:.3} ms, an element {:.3} µs", 1e3 * layer, 1e6 * each);
    println!("an element is {:.0} times faster", layer / each);
}
