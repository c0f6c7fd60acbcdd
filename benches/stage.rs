//! One implicit stage against the number of masses k and of Maxwell elements n, and against its floor; and what the
//! roughness below the profile costs in it: `cargo bench --bench stage`.

#![allow(missing_docs, clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "like a test")]

#[allow(dead_code, unreachable_pub, reason = "shared with the other benchmarks")]
mod common;
#[allow(unreachable_pub, reason = "a benchmark's own")]
#[path = "common/floor.rs"]
mod floor;

use std::time::Duration;

use asperity::internals::integrator::{
    ContactModes, Integrator, LayerState, MAX_STAGES, Scheme, TimeSpan, Tolerance, Tracked,
};
use asperity::model::{ByAxis, Carrier, Forces, Mode, Model, State};
use common::{layer, parse, prints_tables, side_by_side};
use criterion::{BenchmarkId, Criterion, Throughput};
use floor::Floor;

/// Length of the step, s.
const STEP: f64 = 1e-6;
/// The implicit stages of a step: a benchmark takes them all, so that the earlier ones are there to be summed.
const IMPLICIT: usize = MAX_STAGES - 1;

fn main() {
    let mut criterion = common::criterion();
    against_masses(&mut criterion);
    against_elements(&mut criterion);
    criterion.final_summary();
    if prints_tables() {
        print_ratios();
        print_fine();
    }
}

/// A layer and an integrator that attempts steps of it.
struct SteppedLayer {
    model: Model,
    start: LayerState,
    carrier: Carrier,
    integrator: Integrator,
    tolerance: Tolerance,
}

impl SteppedLayer {
    /// A free layer, or one that slips.
    fn new(masses: usize, elements: usize, mode: Mode) -> Self {
        Self::of(&layer(masses, elements, 1e-2), mode, 0.0)
    }

    /// Those of the scene of this text, the carrier at the displacement `w` (m).
    fn of(scene: &str, mode: Mode, w: f64) -> Self {
        let model = Model::new(&parse(scene));
        let masses = model.masses();
        let mut state = State::new(&model);
        let noise = |i: usize| ((i * 7919) % 1000) as f64 * 1e-3;
        for i in 0..masses {
            (state.elongation_x[i], state.velocity_x[i]) = (1e-7 * noise(i), 1e-2 * (1.0 + noise(i + 1)));
            (state.elongation_z[i], state.velocity_z[i]) = (1e-7 * noise(i + 2), 1e-2 * noise(i + 3));
            if mode.slips() {
                let surface = model.surface_at(model.rest_x[i] + state.elongation_x[i]);
                state.elongation_z[i] = surface.height - model.rest_z[i];
                state.velocity_z[i] = surface.slope * state.velocity_x[i];
                (state.mode[i], state.surface[i]) = (mode, surface);
            }
        }
        let carrier = Carrier::new(0.0, ByAxis { x: 0.0, z: w }, ByAxis::default(), &model.profile);
        let mut forces = Forces::new(&model);
        forces.evaluate(&model, &state, &carrier.at(0.0));
        let integrator = Integrator::new(&model, Tracked::default(), &[Scheme::Esdirk5]);
        let mut start = LayerState { state, ..LayerState::new(&model) };
        integrator.evaluate_start(&model, &mut start, (&carrier, 0.0), &forces, 1e-6);
        let tolerance = Tolerance::new(&model, 1e-6, 1e-11);
        Self { model, start, carrier, integrator, tolerance }
    }

    /// All stages of a step, and its error estimate.
    fn run(&mut self) {
        let Self { model, start, carrier, integrator, tolerance } = self;
        let span = TimeSpan { start: 0.0, length: STEP };
        let attempt = integrator.attempt(ContactModes::Held, (&*model, &*start, &*carrier), span, tolerance);
        std::hint::black_box(attempt.unwrap());
    }
}

fn against_masses(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("stage against k, n = 3");
    for masses in [100, 1000, 10_000, 100_000] {
        group.throughput(Throughput::Elements((masses * IMPLICIT) as u64));
        for (name, mode) in [("free", Mode::Free), ("slipping", Mode::Forward)] {
            let mut stages = SteppedLayer::new(masses, 3, mode);
            group.bench_function(BenchmarkId::new(name, masses), |bencher| bencher.iter(|| stages.run()));
        }
    }
    group.finish();
}

fn against_elements(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("stage against n, k = 1000");
    group.throughput(Throughput::Elements((1000 * IMPLICIT) as u64));
    for elements in [0, 1, 3, 7, 15] {
        let mut stages = SteppedLayer::new(1000, elements, Mode::Free);
        group.bench_function(BenchmarkId::new("free", elements), |bencher| bencher.iter(|| stages.run()));
    }
    group.finish();
}

/// Stage and floor in turns, ns a mass and stage.
fn print_ratios() {
    println!("\none stage of the free layer and its floor, ns a mass");
    println!("{:>8} {:>4} {:>8} {:>8} {:>6}", "k", "n", "stage", "floor", "ratio");
    for masses in [100, 1000, 10_000, 100_000] {
        for elements in [0, 3, 15] {
            let mut stages = SteppedLayer::new(masses, elements, Mode::Free);
            let mut floor = Floor::new(&stages.model, STEP);
            floor.stages();
            assert!(floor.residual() < 1e-12, "the floor solves its equations: {}", floor.residual());
            let times = side_by_side([&mut || stages.run(), &mut || floor.stages()], Duration::from_secs(2));
            let [stage, floor] = times.shortest.map(|time| 1e9 * time / (masses * IMPLICIT) as f64);
            println!("{masses:>8} {elements:>4} {stage:>8.1} {floor:>8.1} {:>6.2}", times.ratio);
        }
    }
}

/// A layer of a compound that slips on a rough profile, with a friction law, over waves that the profile lacks or not.
fn compound(masses: usize, keys: &str, fine: &str, shear: &str) -> String {
    let elements: String = (0..10).map(|i| format!("{{ modulus = 4e6, relaxation_time = 1e-{} }},", 1 + i)).collect();
    format!(
        "name = 'w'\nlayer = {{ masses = {masses}, spacing = 2e-4, width = 1e-2, foundation = 'half_space' }}\n\
         surface = {{ kind = 'self_affine', length = 0.2, points = 2000, hurst = 0.8, rms = 2e-5, seed = 1, \
         roll_off_wavelength = 1e-2, cut_off_wavelength = 2e-3{fine} }}\nfriction = {{ coulomb = 0.2, {shear} }}\n\
         [material]\ndensity = 1100.0\npoisson_ratio = 0.49\nequilibrium_modulus = 5e6\nprony = [{elements}]\n{keys}\n"
    )
}

/// Stages with the roughness below the profile, and with its heat, beside those without it, under a constant shear
/// strength and one that depends on the speed as the bands do, in turns: ns a mass and stage.
fn print_fine() {
    const W: f64 = -2e-4;
    const FINE: &str = ", fine = { hurst = 0.8, rms_slope = 1.2, longest = 2e-3, shortest = 5e-6 }";
    const HEAT: &str = "wlf = { c1 = 8.0, c2 = 120.0, reference_temperature = 293.15, temperature = 303.15 }\n\
        heat = { conductivity = 0.25, capacity = 1700.0 }";
    const SHEARS: [(&str, &str); 2] = [
        ("constant shear", "shear_strength = 5e5"),
        ("rate_shear", "rate_shear = { strength = 5e5, reference_speed = 1.0, sharpness = 0.1 }"),
    ];
    println!("\none stage of a slipping layer with the roughness below the profile over one without, ns a mass");
    println!("{:>8} {:<16} {:<16} {:>8} {:>8} {:>6}", "k", "", "over", "with", "without", "ratio");
    for masses in [100, 1000] {
        for (name, keys) in [("bands", ""), ("bands and heat", HEAT)] {
            for (shear_name, shear) in SHEARS {
                let mut with = SteppedLayer::of(&compound(masses, keys, FINE, shear), Mode::Forward, W);
                let mut without = SteppedLayer::of(&compound(masses, "", "", shear), Mode::Forward, W);
                let times = side_by_side([&mut || with.run(), &mut || without.run()], Duration::from_secs(2));
                let [with, without] = times.shortest.map(|time| 1e9 * time / (masses * IMPLICIT) as f64);
                println!("{masses:>8} {name:<16} {shear_name:<16} {with:>8.1} {without:>8.1} {:>6.2}", times.ratio);
            }
        }
    }
}
