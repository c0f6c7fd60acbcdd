//! A run allocates nothing: all memory is allocated by `Simulation::new`.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic, reason = "tests may fail")]

#[allow(dead_code, unreachable_pub, unsafe_code, reason = "shared with the tests of the FMU")]
#[path = "common/master.rs"]
mod master;
#[allow(dead_code, unreachable_pub, reason = "shared with the tests of physics and the benchmark")]
#[path = "physics/leaving_out/pairs.rs"]
mod pairs;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::path::Path as FilePath;

use asperity::element::{FrictionTable, PointContact};
use asperity::outputs::{Snapshot, Variable, variables};
use asperity::patch::{Patch, PatchMotion, PatchRun, PatchStart, Pose};
use asperity::scene::{Force, Path, Scene};
use asperity::simulation::{Motion, Simulation, Start};
use asperity_fmi::{Definition, Inputs};
use pairs::{pairs, reduced, started};

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
    /// Bytes that are allocated, and the most that were.
    static BYTES: Cell<(usize, usize)> = const { Cell::new((0, 0)) };
}

/// The system's allocator, counting allocations per thread.
struct Counting;

#[global_allocator]
static COUNTING: Counting = Counting;

/// Counts an allocation of `size` bytes in the place of one of `before`.
fn count(before: usize, size: usize) {
    ALLOCATIONS.set(ALLOCATIONS.get() + 1);
    resize(before, size);
}

fn resize(before: usize, size: usize) {
    let (now, most) = BYTES.get();
    let now = now.saturating_sub(before) + size;
    BYTES.set((now, most.max(now)));
}

#[allow(unsafe_code, reason = "an allocator cannot be written without; it hands every call on to the system's")]
// SAFETY: every call goes unchanged to `System`, which keeps the contract; counting neither allocates nor unwinds.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(0, layout.size());
        // SAFETY: the caller keeps the contract of `GlobalAlloc::alloc`, the same one.
        unsafe { System.alloc(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(layout.size(), size);
        // SAFETY: `pointer` came from `alloc` above, so from `System`.
        unsafe { System.realloc(pointer, layout, size) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        resize(layout.size(), 0);
        // SAFETY: `pointer` came from `alloc` above, so from `System`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

/// Number of allocations that `work` makes on this thread.
fn allocations(work: impl FnOnce()) -> usize {
    let before = ALLOCATIONS.get();
    work();
    ALLOCATIONS.get() - before
}

/// The most bytes that `work` has allocated on this thread at once.
fn peak<T>(work: impl FnOnce() -> T) -> usize {
    let (before, _) = BYTES.get();
    BYTES.set((before, before));
    drop(work());
    BYTES.get().1 - before
}

/// Bytes that what `work` makes holds on this thread.
fn held<T>(work: impl FnOnce() -> T) -> usize {
    let (before, _) = BYTES.get();
    let made = work();
    let (after, _) = BYTES.get();
    drop(made);
    after - before
}

/// Maxwell elements on every kind of link, stick and slip, impacts, all outputs.
const RATTLE: &str = r#"
name = "rattle"

[layer]
masses = 20
spacing = 1.3e-4
clearance = 1e-6
mass = 2e-7
vertical = { stiffness = 1000, damping = 0.002, maxwell = [{ stiffness = 500, relaxation_time = 1e-4 }] }
horizontal = { stiffness = 2000, damping = 0.008, maxwell = [{ stiffness = 300, relaxation_time = 1e-3 }] }
lateral_x = { stiffness = 300, damping = 0.001, maxwell = [{ stiffness = 100, relaxation_time = 1e-5 }] }
lateral_z = { stiffness = 200, damping = 0.001, maxwell = [{ stiffness = 50, relaxation_time = 1e-4 }] }

[surface]
kind = "sinusoid"
amplitude = 1e-5
wavelength = 5e-4

[friction]
coulomb = 0.2
shear_force = 1e-4
rate_shear = { force = 2e-4, reference_speed = 6e-3, sharpness = 0.1 }

[fmu]
outputs = ["forces", "dissipation", "friction", "contact", "energy", "solver", "elements"]
"#;

/// The carrier oscillates, so that masses stop, stick, break loose, lift and touch.
const SWING: Motion = Motion {
    duration: 1e-4,
    u: Path { rate: 1.0, amplitude: 2e-4, frequency: 5000.0 },
    w: Path { rate: 0.0, amplitude: 1e-6, frequency: 9000.0 },
    ..Motion::REST
};

/// A run of a scene, pressed on, which has not moved yet.
fn pressed(text: &str) -> (Scene, Simulation) {
    let scene = Scene::parse(text, FilePath::new("rattle.toml")).unwrap();
    let simulation = Simulation::new(&scene, &Start { w: -5e-6, ..Start::default() }).unwrap();
    (scene, simulation)
}

/// The allocations that so many `swings` make with all outputs evaluated at rows within them, and the outputs at their end.
fn swing(scene: &Scene, simulation: &mut Simulation, swings: usize) -> (usize, Vec<Variable>, Vec<f64>) {
    let variables = variables(scene);
    let mut values = vec![0.0; variables.len()];
    let times: [f64; 11] = std::array::from_fn(|i| 1e-5 * i as f64);
    let mut rows = 0;
    let count = allocations(|| {
        for _ in 0..swings {
            let row = |_: f64, now: &Snapshot<'_>| {
                now.evaluate(&variables, &mut values);
                rows += 1;
            };
            simulation.advance_observed(&SWING, None, &times, row).unwrap();
        }
    });
    assert_eq!(rows, 11 * swings);
    simulation.evaluate(&variables, &mut values);
    (count, variables, values)
}

fn value(variables: &[Variable], values: &[f64], name: &str) -> f64 {
    values[variables.iter().position(|variable| variable.name == name).unwrap()]
}

/// Hundreds of mode changes and impacts by each method and by a run that switches between them, with all outputs at rows
/// within the steps.
#[test]
fn a_run_allocates_nothing() {
    for (method, tolerance) in [("event", 1e-6), ("step", 1e-3), ("auto", 1e-3)] {
        let text = format!("{RATTLE}\n[solver]\nmethod = \"{method}\"\nrelative_tolerance = {tolerance:e}");
        let (scene, mut simulation) = pressed(&text);
        simulation.advance(&SWING).unwrap();
        let (count, variables, values) = swing(&scene, &mut simulation, 40);
        assert_eq!(count, 0, "{method}");
        let [events, lost] = ["solver.events", "dissipation.E_impact"].map(|name| value(&variables, &values, name));
        assert!(
            events > 200.0 && (method != "event" || lost > 0.0),
            "a lively run: {events} events, {lost} J lost in impacts"
        );
    }
}

/// The same of rubber on roughness below the profile, whose contacts friction warms.
fn warm() -> String {
    let (_, rest) = RATTLE.split_once("[surface]").unwrap();
    let (rest, _) = rest.split_once("coulomb = 0.2").unwrap();
    let head = "name = 'warm'
        layer = { masses = 20, spacing = 1.3e-4, clearance = 1e-6, foundation = 'half_space', width = 1e-2 }
        [material]
        density = 1100.0
        poisson_ratio = 0.49
        equilibrium_modulus = 2e6
        prony = [{ modulus = 3e6, relaxation_time = 1e-4 }]
        wlf = { c1 = 8.0, c2 = 100.0, reference_temperature = 300.0, temperature = 300.0 }
        heat = { conductivity = 0.25, capacity = 1700.0 }
        [surface]
        fine = { hurst = 0.8, rms_slope = 0.5, longest = 2e-5, shortest = 5e-6 }";
    let outputs = "outputs = ['forces', 'dissipation', 'friction', 'contact', 'energy', 'solver', 'elements']";
    format!("{head}{rest}shear_strength = 1e5\n[fmu]\n{outputs}")
}

/// Contacts on roughness below the profile, warmed by friction, by each method.
#[test]
fn heated_contacts_allocate_nothing() {
    let text = warm();
    for method in ["event", "step", "auto"] {
        let text = format!("{text}\n[solver]\nmethod = '{method}'\nrelative_tolerance = 1e-3");
        let (scene, mut simulation) = pressed(&text);
        simulation.advance(&SWING).unwrap();
        let (count, variables, values) = swing(&scene, &mut simulation, 4);
        assert_eq!(count, 0, "{method}");
        assert!(value(&variables, &values, "contact.flash_largest") > 0.0, "{method} warms");
    }
}

/// Nor does a carrier that is a body, on a drive along x and under a load that jumps along z.
#[test]
fn bodies_allocate_nothing() {
    for method in ["event", "step"] {
        let text = format!(
            "{RATTLE}
            [carrier.x]\nmass = 1e-5\nstiffness = 1e4\ndamping = 0.1
            [carrier.z]\nmass = 1e-5\ndamping = 0.1\nload = 0.02
            [solver]\nmethod = \"{method}\"\nrelative_tolerance = 1e-3"
        );
        let text = text.replace("\"solver\", ", "\"solver\", \"carrier\", \"tangent\", ");
        let (scene, mut simulation) = pressed(&text);
        let variables = variables(&scene);
        let mut values = vec![0.0; variables.len()];
        let mut push = |simulation: &mut Simulation, load: f64| {
            let load = Force { start: Some(load), ..Force::default() };
            simulation.advance(&Motion { load, ..SWING }).unwrap();
            simulation.evaluate(&variables, &mut values);
        };
        push(&mut simulation, 0.0);
        let count = allocations(|| (0..20).for_each(|i| push(&mut simulation, 0.01 * f64::from(i % 3))));
        assert_eq!(count, 0, "{method}");
        assert!(value(&variables, &values, "solver.events") > 50.0, "a lively run");
    }
}

/// What an instance of an FMU, and a state of it, reckons before it allocates is no less than it takes, and within a factor:
/// some scenes need less than the worst, whose figures are used.
fn assert_reckoned(model: &Definition, factor: usize, text: &str) {
    let inputs = Inputs::default();
    let taken = peak(|| (model.variables(), model.start(&inputs, 0.0).unwrap()));
    let reckoned = model.memory();
    let fits = |taken: usize, reckoned: usize| taken <= reckoned && reckoned / factor <= taken;
    assert!(fits(taken, reckoned), "{taken} of {reckoned} bytes: {text}");
    let run = model.start(&inputs, 0.0).unwrap();
    let (taken, reckoned) = (peak(|| run.save()), model.state_memory());
    assert!(fits(taken, reckoned), "{taken} of {reckoned} bytes for a state: {text}");
}

#[test]
fn memory_reckoned_is_memory_taken() {
    let few = RATTLE.replace("\"solver\", \"elements\"", "\"contact\"").replace("\"contact\", \"energy\", ", "");
    let plain = few.split("horizontal =").next().unwrap().to_owned() + "\n[surface]\nkind = \"flat\"";
    let tangents = RATTLE.replace("\"solver\"", "\"tangent\", \"solver\"");
    let (warm, warm_tangents) = (warm(), warm().replace("'solver'", "'tangent', 'solver'"));
    for text in [RATTLE, &few, &plain, &tangents, &warm, &warm_tangents] {
        let text = text.replace("masses = 20", "masses = 3000");
        for method in ["event", "step", "auto"] {
            let text = format!("{text}\n[solver]\nmethod = \"{method}\"\nrelative_tolerance = 1e-3");
            let model = Definition::from(Scene::parse(&text, FilePath::new("rattle.toml")).unwrap());
            assert_reckoned(&model, 8, &text);
        }
    }
}

#[test]
fn memory_reckoned_of_patches_and_elements_is_memory_taken() {
    let folder = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/patch");
    let heat = "heat = { conductivity = 0.25, capacity = 1700.0, density = 1100.0, share = 0.3 }";
    for (outputs, more) in [("forces", ""), ("elements", ""), ("tangent", ""), ("forces", heat), ("elements", heat)] {
        let text = format!(
            "name = 'pad'\ntable = {{ path = 'block.table.csv' }}\n[patch]\nshape = 'flat'\nlength = 0.01\nwidth = 0.01\n\
             nx = 200\nny = 200\n{more}\n[fmu]\noutputs = ['{outputs}']"
        );
        let model = Definition::from(Patch::parse(&text, &folder.join("patch.toml")).unwrap());
        assert_reckoned(&model, 8, outputs);
    }
    // A single element, of which next to all is fixed.
    let element = PointContact::new(FrictionTable::load(&folder.join("block.table.csv")).unwrap());
    assert_reckoned(&Definition::from(element), usize::MAX, "an element");
}

/// Steps of an FMU whose master gives values alone, each done again, with all outputs after each.
#[test]
fn steps_that_are_done_again_allocate_nothing() {
    let fmu = master::Fmu::running_with(master::EVERYTHING);
    let inputs = ["u", "w"].map(|name| fmu.reference(name));
    let (force, repeated) = (fmu.reference("F_x"), fmu.reference("solver.repeated"));
    let mut step = |k: i32| {
        let k = f64::from(k);
        let values = [1e-6 * (0.9 * k).sin(), -2e-6 - 1e-6 * (0.5 * k).cos()];
        assert_eq!(fmu.set_reals(&inputs, &values), master::OK);
        assert_eq!(fmu.step(1e-5 * k, 1e-5), master::OK);
        assert_eq!(fmu.get_reals(&[force], &mut [0.0]), master::OK);
    };
    (0..3).for_each(&mut step);
    assert_eq!(allocations(|| (3..40).for_each(&mut step)), 0);
    let mut count = [0];
    assert_eq!((fmu.get_integers(&[repeated], &mut count), count[0] > 30), (master::OK, true));
}

/// Checks the counter itself.
#[test]
fn an_allocation_is_counted() {
    assert_eq!(allocations(|| drop(std::hint::black_box(vec![1_u8]))), 1);
}

/// 200 masses, so that mode changes are taken in steps of the masses near them alone.
#[test]
fn steps_of_some_masses_allocate_nothing() {
    let text = RATTLE.replace("masses = 20", "masses = 200") + "\n[solver]\nrelative_tolerance = 2e-4";
    let (scene, mut simulation) = pressed(&text);
    let (count, variables, values) = swing(&scene, &mut simulation, 4);
    let [steps, events] = ["solver.steps", "solver.events"].map(|name| value(&variables, &values, name));
    assert_eq!(count, 0);
    assert!(events > 5.0 * steps, "{events} mode changes in {steps} steps");
}

#[test]
fn a_refused_motion_allocates_nothing() {
    let (_, mut simulation) = pressed(RATTLE);
    simulation.advance(&SWING).unwrap();
    let count = allocations(|| assert!(simulation.advance(&Motion { duration: f64::NAN, ..SWING }).is_err()));
    assert_eq!(count, 0);
}

/// Steps of a rolling patch that touches, lifts, slides and is warmed, and all outputs after each.
#[test]
fn a_patch_allocates_nothing() {
    let heat = "heat = { conductivity = 0.25, capacity = 1700.0, density = 1100.0, share = 0.3 }";
    for more in ["", &format!(", {heat}")] {
        patch_allocates_nothing(more);
    }
}

fn patch_allocates_nothing(more: &str) {
    let text = format!(
        r#"
name = "wheel"
table = {{ path = "block.table.csv" }}
patch = {{ shape = "cylinder", radius = 0.3, length = 0.0144, width = 0.01, nx = 24, ny = 4, transport = true{more} }}
fmu = {{ outputs = ["forces", "dissipation", "contact", "friction", "energy", "tangent", "elements"] }}
"#
    );
    let folder = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/patch");
    let patch = Patch::parse(&text, &folder.join("patch.toml")).unwrap();
    let pose = Pose { place: [0.0, 0.0, 0.29999], angles: [0.0; 3] };
    let start = PatchStart { pose, temperature: 290.0, ..PatchStart::default() };
    let mut run = PatchRun::new(&patch, &start).unwrap();
    let variables = patch.variables();
    let mut values = vec![0.0; variables.len()];
    let count = allocations(|| {
        for step in 0..40 {
            let t = 1e-3 * f64::from(step);
            let rates = [0.5 * (9.0 * t).sin(), 0.1, 4e-3 * (300.0 * t).cos(), 0.1, 0.0, 5.0 * t];
            let motion =
                PatchMotion { duration: 1e-3, rates, transport_speed: 0.4 * t, temperature: 290.0 + 100.0 * t };
            run.advance(&motion).unwrap();
            run.evaluate(&variables, &mut values);
        }
    });
    let mut saved = run.save();
    let states = allocations(|| {
        run.set_state(&saved).unwrap();
        run.save_into(&mut saved);
    });
    assert_eq!(states, 0, "a state is copied into the arrays that there are");
    let energy = variables.iter().position(|variable| variable.name == "E_diss").unwrap();
    assert!(values[energy] > 0.0 && count == 0, "{count} allocations, {} J lost", values[energy]);
}

#[test]
fn a_feature_left_out_takes_no_memory() {
    const MASSES: usize = 12;
    for pair in pairs(MASSES).into_iter().chain([reduced(MASSES)]) {
        let [without, with] = [&pair.without, &pair.with].map(|scene| held(|| started(scene)));
        assert!(without <= with, "{}: {without} bytes without it, {with} with it", pair.feature);
        if pair.feature.starts_with("link") || pair.feature.contains("Maxwell") || pair.feature.contains("reduce") {
            assert!(without < with, "{}: {without} bytes without it, {with} with it", pair.feature);
        }
    }
}
