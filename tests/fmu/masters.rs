//! The default scene and a patch in other people's masters.
//!
//! Each master gives the FMU its inputs at even times, without rates. The carrier, or the body, then goes straight from value
//! to value, but for the last step, which goes on as it came: the first to u_0, the others to u_n + (u_n - u_{n-1}). The
//! library, moved along the same paths, gives the same.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::{
    Table, asperity, difference, fmpy, interpolate, largest, library, masters_python, pack, root, run, scratch,
    simulate, target,
};
use asperity::outputs::variables;
use asperity::patch::{COORDINATES, Patch, PatchMotion, PatchRun, PatchStart, Pose};
use asperity::scene::{self, Scene};
use asperity::simulation::{Motion, Simulation, Start};

/// The communication step, s, and how many there are.
const STEP: f64 = 1e-5;
const STEPS: usize = 550;
/// The difference allowed, over the largest value: the masters' times differ in the last digit, which the tolerance of the
/// steps, 1e-6, lets grow.
const TOLERANCE: f64 = 1e-8;

/// The default scene, packed, with u and w at even times as a file and as a table.
struct Case {
    folder: PathBuf,
    scene: Scene,
    fmu: PathBuf,
    motion: PathBuf,
    values: Table,
}

impl Case {
    fn new(name: &str) -> Self {
        let folder = scratch(name);
        let path = root().join("scenes/tread-block/tread-block.toml");
        let values = even_times(&simulate(&path, &folder, &[]));
        let motion = folder.join("motion.csv");
        values.write(&motion);
        Self { fmu: pack(&path, &folder), scene: Scene::load(&path).unwrap(), folder, motion, values }
    }

    /// Simulates an FMU by fmpy's own loop.
    fn simulate_in_fmpy(&self, fmu: &Path) -> Table {
        let result = self.folder.join("result.csv");
        let [fmu, motion, output] = [fmu, &self.motion, &result].map(|path| path.to_str().unwrap());
        let interval = STEP.to_string();
        fmpy(&["simulate", fmu, "--input-file", motion, "--output-file", output, "--output-interval", &interval]);
        Table::read(&result)
    }

    /// Compares the times and all outputs with what the library gives.
    fn compare(&self, found: &Table) {
        assert_close("time", &found.column("time"), &self.values.column("time"));
        self.compare_outputs(found, "", &self.scene);
    }

    /// Compares the outputs called `prefix` and their names with what the library gives for `scene`.
    fn compare_outputs(&self, found: &Table, prefix: &str, scene: &Scene) {
        let own = library_predicting(scene, &self.values);
        for name in own.names() {
            let theirs = format!("{prefix}{name}");
            assert_close(&theirs, &found.column(&theirs), &own.column(name));
        }
    }
}

/// The displacements at even times.
fn even_times(motion: &Table) -> Table {
    let [times, u, w] = ["time", "u", "w"].map(|name| motion.column(name));
    let row = |time| vec![time, interpolate(&times, &u, time), interpolate(&times, &w, time)];
    Table::new(["time", "u", "w"], (0..=STEPS).map(|i| row(i as f64 * STEP)))
}

/// What the library gives along the values, straight from one to the next, where at each the last step is one to the value
/// that is extrapolated there.
fn library_predicting(scene: &Scene, values: &Table) -> Table {
    let [time, u, w] = ["time", "u", "w"].map(|name| values.column(name));
    let mut simulation = Simulation::new(scene, &Start::default()).unwrap();
    let variables = variables(scene);
    let go = |simulation: &mut Simulation, i: usize, (to_u, to_w): (f64, f64)| {
        let (duration, (u, w)) = (time[i + 1] - time[i], simulation.carrier());
        let path = |from: f64, to: f64| scene::Path { rate: (to - from) / duration, ..scene::Path::default() };
        simulation.advance(&Motion { duration, u: path(u, to_u), w: path(w, to_w), ..Motion::default() }).unwrap();
    };
    let row = |simulation: &mut Simulation| {
        let mut row = vec![0.0; variables.len()];
        simulation.evaluate(&variables, &mut row);
        row
    };
    let mut rows = vec![row(&mut simulation)];
    for i in 0..time.len() - 1 {
        let mut last = simulation.clone();
        let to = (extrapolated(&u, i), extrapolated(&w, i));
        go(&mut last, i, to);
        rows.push(row(&mut last));
        // A value that the last step went to but for rounding is not gone to again.
        let scale = largest(&[u[i], u[i + 1], w[i], w[i + 1], scene.layer.spacing]);
        if largest(&[u[i + 1] - to.0, w[i + 1] - to.1]) > 1e-12 * scale {
            go(&mut simulation, i, (u[i + 1], w[i + 1]));
        } else {
            simulation = last;
        }
    }
    Table::new(variables.iter().map(|variable| variable.name.as_str()), rows)
}

/// Where a step from the value `i` on goes.
fn extrapolated(values: &[f64], i: usize) -> f64 {
    if i == 0 { values[0] } else { 2.0 * values[i] - values[i - 1] }
}

/// Runs a script of tests/python on an FMU and a motion; its result lies beside the motion.
fn run_script(script: &str, fmu: &Path, motion: &Path) -> Table {
    let result = motion.with_file_name("result.csv");
    let mut python = Command::new(masters_python());
    python.arg(root().join("tests/python").join(script)).args([fmu, motion]).arg("-o").arg(&result);
    run(&mut python);
    Table::read(&result)
}

/// A wheel, packed, that comes down, rolls, slips and turns, and the wrench and contacts that the library gives.
struct Rolling {
    fmu: PathBuf,
    motion: PathBuf,
    own: Table,
}

/// Its communication step, s, and how many there are.
const ROLLING_STEP: f64 = 1e-3;
const ROLLING_STEPS: usize = 60;

impl Rolling {
    fn new(name: &str) -> Self {
        let (folder, source) = (scratch(name), root().join("tests/reference/patch"));
        for file in ["wheel.toml", "winkler.table.csv"] {
            fs::copy(source.join(file), folder.join(file)).unwrap();
        }
        let (file, fmu) = (folder.join("wheel.toml"), folder.join("wheel.fmu"));
        run(asperity().args(["pack", "--patch"]).arg(&file).arg("-o").arg(&fmu).arg("--library").arg(library()));
        let patch = Patch::load(&file).unwrap();
        let inputs: Vec<_> = (0..=ROLLING_STEPS).map(|i| inputs_at(&patch, i as f64 * ROLLING_STEP)).collect();
        let own = wheel_along(&patch, &inputs);
        let names: Vec<_> = ["time"].into_iter().chain(COORDINATES).chain(["transport.speed"]).collect();
        let time = |i: usize| i as f64 * ROLLING_STEP;
        let rows = inputs.iter().enumerate().map(|(i, inputs)| [&[time(i)], &inputs[..]].concat());
        let motion = folder.join("motion.csv");
        Table::new(names, rows).write(&motion);
        Self { fmu, motion, own }
    }

    fn compare(&self, script: &str) {
        let found = run_script(script, &self.fmu, &self.motion);
        // An element at its limit sticks or slips by a rounding, and the masters' steps differ by one.
        for name in self.own.names().iter().filter(|name| *name != "contact.sticking") {
            assert_close(name, &found.column(name), &self.own.column(name));
        }
    }
}

/// The pose and the speed of the tread, from the start values of the FMU on.
fn inputs_at(patch: &Patch, time: f64) -> [f64; 7] {
    let z = patch.clear_height() - 6e-5 * (time / 0.01).min(1.0);
    [time, 0.02 * time, z, 1e-4 * (50.0 * time).sin(), 0.0, 0.2 * time, 1.1 * (time / 0.02).min(1.0)]
}

/// All outputs after every step of a wheel of which the last step goes on as it came.
fn wheel_along(patch: &Patch, inputs: &[[f64; 7]]) -> Table {
    let extrapolated = |i: usize| -> [f64; 7] {
        if i == 0 { inputs[0] } else { std::array::from_fn(|k| 2.0 * inputs[i][k] - inputs[i - 1][k]) }
    };
    let pose = |inputs: [f64; 7]| -> [f64; 6] { std::array::from_fn(|k| inputs[k]) };
    let mut wheel =
        PatchRun::new(patch, &PatchStart { pose: Pose::from_coordinates(pose(inputs[0])), ..PatchStart::default() })
            .unwrap();
    let go = |wheel: &mut PatchRun, to: [f64; 7]| {
        let from = wheel.pose().coordinates();
        let rates = std::array::from_fn(|k| (to[k] - from[k]) / ROLLING_STEP);
        let motion = PatchMotion { duration: ROLLING_STEP, rates, transport_speed: to[6], temperature: 0.0 };
        wheel.advance(&motion).unwrap();
    };
    let variables = patch.variables();
    let row = |i: usize| {
        let mut last = wheel.clone();
        go(&mut last, extrapolated(i));
        let mut values = vec![0.0; variables.len()];
        last.evaluate(&variables, &mut values);
        go(&mut wheel, inputs[i + 1]);
        values
    };
    let rows = (0..inputs.len() - 1).map(row);
    let names: Vec<_> = variables.iter().map(|variable| variable.name.as_str()).collect();
    Table::new(names, rows)
}

#[test]
fn libcosim_gives_for_a_patch_what_the_library_gives() {
    Rolling::new("masters-patch-libcosim").compare("in_libcosim.py");
}

#[test]
fn ecos_gives_for_a_patch_what_the_library_gives() {
    Rolling::new("masters-patch-ecos").compare("in_ecos.py");
}

/// Some masters do not show the values at the start.
fn assert_close(name: &str, found: &[f64], own: &[f64]) {
    assert!(found.len() == own.len() || found.len() == own.len() - 1, "{name}: {} rows", found.len());
    let (error, largest) = (difference(found, &own[own.len() - found.len()..]), largest(own));
    assert!(error <= TOLERANCE * largest, "{name}: {error:e} of {largest:e}");
}

#[test]
fn fmpy_gives_what_the_library_gives() {
    let case = Case::new("masters-fmpy");
    case.compare(&case.simulate_in_fmpy(&case.fmu));
}

#[test]
fn libcosim_gives_what_the_library_gives() {
    let case = Case::new("masters-libcosim");
    case.compare(&run_script("in_libcosim.py", &case.fmu, &case.motion));
}

#[test]
fn ecos_gives_what_the_library_gives() {
    let case = Case::new("masters-ecos");
    case.compare(&run_script("in_ecos.py", &case.fmu, &case.motion));
}

/// Two of the FMU, the second with more friction, packed into one by fmu-manipulation-toolbox and simulated by fmpy.
#[test]
fn a_container_of_two_gives_what_the_library_gives_for_each() {
    let case = Case::new("masters-container");
    fs::copy(root().join("tests/python/pair.json"), case.folder.join("pair.json")).unwrap();
    let mut command = Command::new(masters_python());
    command.args(["-m", "fmu_manipulation_toolbox.cli.fmucontainer", "-container", "pair.json", "-fmu-directory"]);
    run(command.arg(&case.folder));
    let found = case.simulate_in_fmpy(&case.folder.join("pair.fmu"));
    case.compare(&found);
    let mut second = case.scene.clone();
    second.set_by_name("friction.coulomb", "0.5").unwrap();
    case.compare_outputs(&found, "second.", &second);
}

/// By hand, for it first builds fmi-sim, which needs libclang: `cargo test --test suites fmu:: -- --ignored`.
#[test]
#[ignore = "builds fmi-sim, which takes minutes"]
fn fmi_sim_gives_what_the_library_gives() {
    let case = Case::new("masters-fmi-sim");
    let (root, result) = (target().join("fmi-sim"), case.folder.join("result.csv"));
    let install = ["install", "fmi-sim", "--version", "0.7.0", "--locked", "--root"];
    run(Command::new(env!("CARGO")).args(install).arg(&root));
    let mut command = Command::new(root.join("bin/fmi-sim"));
    command.arg("--model").arg(&case.fmu).arg("--input-file").arg(&case.motion).arg("--output-file").arg(&result);
    run(command.args(["co-simulation", "--output-interval", &STEP.to_string()]));
    case.compare(&Table::read(&result));
}
