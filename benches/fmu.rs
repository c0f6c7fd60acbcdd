//! Instantiation, and saving and restoring, by the library and by the FMU: `cargo bench --bench fmu`.

#![allow(missing_docs, clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "like a test")]

#[allow(dead_code, unreachable_pub, reason = "shared with the other benchmarks")]
mod common;
#[allow(
    dead_code,
    unreachable_pub,
    unsafe_code,
    reason = "shared with the tests: a master calls through C's interface"
)]
#[path = "../tests/common/master.rs"]
mod master;

use std::hint::black_box;
use std::ptr;

use asperity::scene::Scene;
use asperity::simulation::Simulation;
use asperity_fmi::bindings::fmi2Type_fmi2CoSimulation;
use common::{layer, parse, pressed, slide};
use criterion::{BenchmarkId, Criterion};
use master::{Fmu, Folder, Messages, OK, Request, callbacks};

const MASSES: [usize; 3] = [10, 100, 1000];

fn main() {
    let mut criterion = common::criterion();
    instantiate(&mut criterion);
    save_and_restore(&mut criterion);
    save_and_restore_fmu(&mut criterion);
    criterion.final_summary();
}

fn text(masses: usize) -> String {
    format!("{}[friction]\ncoulomb = 0.3\n", layer(masses, 3, 0.0))
}

/// From the scene's text to a layer that stands under its carrier.
fn instantiate(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("instantiate");
    for masses in MASSES {
        let text = text(masses);
        let scene = parse(&text);
        group.bench_function(BenchmarkId::new("Scene::parse", masses), |bencher| bencher.iter(|| parse(&text)));
        group.bench_function(BenchmarkId::new("Simulation::new", masses), |bencher| {
            bencher.iter(|| pressed(&scene, -5e-6));
        });
        group.bench_function(BenchmarkId::new("fmi2Instantiate", masses), |bencher| {
            let folder = Folder::with_scene("", &text);
            let messages = Messages::default();
            let functions = callbacks(&messages);
            let request = Request {
                name: Some("bench".into()),
                kind: fmi2Type_fmi2CoSimulation,
                guid: Some(folder.description().0),
                location: Some(format!("file://{}", folder.text())),
                functions: &functions,
                logging: false,
            };
            bencher.iter(|| free(request.send()));
        });
    }
    group.finish();
}

#[allow(unsafe_code, reason = "C's interface")]
fn free(instance: asperity_fmi::bindings::fmi2Component) {
    assert!(!instance.is_null());
    // SAFETY: from fmi2Instantiate, and freed once.
    unsafe { asperity_fmi::fmi2FreeInstance(instance) }
}

/// A run in contact, kept and gone back to: as a clone, and as what is written to a file.
fn save_and_restore(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("save and restore, library");
    for masses in MASSES {
        let scene: Scene = parse(&text(masses));
        let mut simulation = pressed(&scene, -5e-6);
        simulation.advance(&slide(1e-6)).unwrap();
        let saved = simulation.state();
        let mut run = |name: &str, work: &mut dyn FnMut()| {
            group.bench_function(BenchmarkId::new(name, masses), |bencher| bencher.iter(&mut *work));
        };
        run("clone", &mut || drop(black_box(simulation.clone())));
        run("save", &mut || drop(black_box(simulation.state())));
        run("restore", &mut || drop(black_box(Simulation::restore(&scene, &saved).unwrap())));
    }
    group.finish();
}

/// The same by the FMU's functions.
fn save_and_restore_fmu(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("save and restore, FMU");
    for masses in MASSES {
        let fmu = Fmu::of(&text(masses), false);
        assert_eq!((fmu.setup(0.0), fmu.enter(), fmu.set_real("w", -5e-6), fmu.exit()), (OK, OK, OK, OK));
        assert_eq!((fmu.set_rate("u", 0.5), fmu.step(0.0, 1e-6)), (OK, OK));
        let mut state = fmu.state();
        let mut bytes = fmu.serialised(state);
        let frozen = bytes.clone();
        let mut run = |name: &str, work: &mut dyn FnMut()| {
            group.bench_function(BenchmarkId::new(name, masses), |bencher| bencher.iter(&mut *work));
        };
        run("fmi2GetFMUstate", &mut || assert_eq!(fmu.get_state(&mut state), OK));
        run("fmi2SetFMUstate", &mut || assert_eq!(fmu.set_state(state), OK));
        run("fmi2SerializeFMUstate", &mut || assert_eq!(fmu.serialise(state, &mut bytes), OK));
        run("fmi2DeSerializeFMUstate", &mut || {
            let mut state = ptr::null_mut();
            assert_eq!((fmu.deserialise(&frozen, &mut state), fmu.free_state(&mut state)), (OK, OK));
        });
        assert_eq!(fmu.free_state(&mut state), OK);
    }
    group.finish();
}
