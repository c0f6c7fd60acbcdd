//! The FMU in fmpy: its description, its results, its simulation from the command line.

#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests may fail")]

#[allow(dead_code, unreachable_pub, reason = "shared by several tests")]
mod common;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use asperity::outputs::variables;
use asperity::scene::{self, OutputGroup, Scene};
use asperity::simulation::{Motion, Simulation, Start};
use common::{Table, asperity, difference, drive, largest, library, pack, python, root, run, scratch, simulate};

const DEFAULT_SCENE: &str = "scenes/tread-block/tread-block.toml";

/// Every scene in scenes/.
fn shipped_scenes() -> Vec<PathBuf> {
    let files = |folder: &Path| fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect::<Vec<_>>();
    let folders = files(&root().join("scenes")).into_iter().filter(|path| path.is_dir());
    let toml = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "toml");
    let scenes: Vec<_> = folders.flat_map(|folder| files(&folder)).filter(toml).collect();
    assert!(scenes.len() >= 5, "{scenes:?}");
    scenes
}

fn fmpy(arguments: &[&str]) -> String {
    run(Command::new(python()).args(["-m", "fmpy"]).args(arguments))
}

fn validate(fmu: &Path) {
    let text = fmpy(&["validate", fmu.to_str().unwrap()]);
    assert_eq!(text.trim(), "No problems found.", "{}", fmu.display());
}

/// The scene in tests/reference with the output groups `groups`.
fn scene_with_groups(folder: &Path, groups: &[&str]) -> PathBuf {
    let text = fs::read_to_string(root().join("tests/reference/rough-coulomb.toml")).unwrap();
    let (before, after) = text.split_once("outputs = [").unwrap();
    let (_, after) = after.split_once(']').unwrap();
    let scene = folder.join("scene.toml");
    fs::write(&scene, format!("{before}outputs = {groups:?}{after}")).unwrap();
    let profile = "rough-coulomb.profile.csv";
    fs::copy(root().join("tests/reference").join(profile), folder.join(profile)).unwrap();
    scene
}

#[test]
fn fmpy_finds_no_fault_in_the_shipped_scenes() {
    let folder = scratch("fmpy-validate");
    shipped_scenes().iter().for_each(|scene| validate(&pack(scene, &folder)));
}

#[test]
fn fmpy_finds_no_fault_with_every_output_group_and_with_none() {
    let folder = scratch("fmpy-groups");
    validate(&pack(&scene_with_groups(&folder, &OutputGroup::ALL.map(OutputGroup::name)), &folder));
    validate(&pack(&scene_with_groups(&folder, &[]), &folder));
}

#[test]
fn the_same_scene_gives_the_same_bytes() {
    let folder = scratch("fmpy-bytes");
    let pack = || fs::read(pack(&root().join(DEFAULT_SCENE), &folder)).unwrap();
    assert!(pack() == pack());
}

/// Whatever is given as a library is packed as it is.
#[test]
fn an_fmu_has_the_libraries_of_all_platforms_named() {
    let folder = scratch("fmpy-platforms");
    let (scene, fmu, windows) = (root().join(DEFAULT_SCENE), folder.join("all.fmu"), folder.join("windows.dll"));
    fs::write(&windows, "a library for Windows").unwrap();
    let libraries =
        [("linux64", library()), ("win64", &windows)].map(|(name, path)| format!("{name}={}", path.display()));
    let mut command = asperity();
    command.arg("pack").arg(scene).arg("-o").arg(&fmu);
    run(command.args(libraries.iter().flat_map(|library| ["--library", library])));
    let platforms = "import sys, fmpy; print(*sorted(fmpy.supported_platforms(sys.argv[1])))";
    assert_eq!(run(Command::new(python()).args(["-c", platforms]).arg(&fmu)).trim(), "linux64 win64");
}

#[test]
fn a_missing_library_is_named_with_the_way_to_build_it() {
    let folder = scratch("fmpy-library");
    let output = asperity()
        .arg("pack")
        .arg(root().join(DEFAULT_SCENE))
        .arg("-o")
        .arg(folder.join("x.fmu"))
        .args(["--library", "nowhere/libasperity.so"])
        .output()
        .unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(text.contains("nowhere/libasperity.so") && text.contains("cargo rustc"), "{text}");
}

/// What the library gives along the rows of `motion`, straight from one to the next.
fn library_along(scene: &Scene, motion: &Table) -> Vec<Vec<f64>> {
    let [time, u, w] = ["time", "u", "w"].map(|name| motion.column(name));
    let rate = |values: &[f64], i: usize| (values[i + 1] - values[i]) / (time[i + 1] - time[i]);
    let start = Start { u_rate: rate(&u, 0), w_rate: rate(&w, 0), ..Start::default() };
    let mut simulation = Simulation::new(scene, &start).unwrap();
    let variables = variables(scene);
    let mut rows = vec![vec![0.0; variables.len()]];
    simulation.evaluate(&variables, &mut rows[0]);
    for i in 0..time.len() - 1 {
        let path = |values: &[f64]| scene::Path { rate: rate(values, i), ..scene::Path::default() };
        simulation.advance(&Motion { duration: time[i + 1] - time[i], u: path(&u), w: path(&w) }).unwrap();
        let mut row = vec![0.0; variables.len()];
        simulation.evaluate(&variables, &mut row);
        rows.push(row);
    }
    rows
}

/// The library's own results, to rounding: both take the same steps.
#[test]
fn driven_along_its_excitation_the_fmu_gives_what_the_library_gives() {
    const TOLERANCE: f64 = 1e-9;
    let folder = scratch("fmpy-library-along");
    let path = root().join(DEFAULT_SCENE);
    let motion = simulate(&path, &folder, &[]);
    let driven = drive(&pack(&path, &folder), &folder.join("tread-block.csv"), &[]);
    let scene = Scene::load(&path).unwrap();
    let rows = library_along(&scene, &motion);
    for (i, variable) in variables(&scene).iter().enumerate() {
        let own: Vec<f64> = rows.iter().map(|row| row[i]).collect();
        let error = difference(&driven.column(&variable.name), &own);
        assert!(error <= TOLERANCE * largest(&own), "{}: {error:e} of {:e}", variable.name, largest(&own));
    }
}

/// `fmpy simulate` gives values alone, so that the FMU starts at rest and goes on as the motion came: of every kink it
/// learns one step late. The forces jump there; the energy lost, which does not, comes closer as the step gets shorter.
#[test]
fn from_the_command_line_fmpy_comes_as_close_as_its_step_is_short() {
    let folder = scratch("fmpy-command-line");
    let scene = root().join(DEFAULT_SCENE);
    let own = simulate(&scene, &folder, &["--points", "400"]);
    let fmu = pack(&scene, &folder);
    let errors = [1e-5, 2.5e-6].map(|step| command_line_error(&fmu, &folder.join("tread-block.csv"), &own, step));
    assert!(errors[0] < 0.05 && errors[1] < 0.5 * errors[0], "{errors:?}");
}

/// The largest error of E_diss over its largest value, at communication steps of `step`.
fn command_line_error(fmu: &Path, motion: &Path, own: &Table, step: f64) -> f64 {
    let output = motion.with_extension(format!("{step:e}.csv"));
    let interval = step.to_string();
    let paths = [fmu, motion, &output].map(|path| path.to_str().unwrap());
    fmpy(&["simulate", paths[0], "--input-file", paths[1], "--output-file", paths[2], "--output-interval", &interval]);
    let found = Table::read(&output);
    let (times, losses) = (own.column("time"), own.column("E_diss"));
    let wanted: Vec<f64> = found.column("time").iter().map(|&time| interpolate(&times, &losses, time)).collect();
    difference(&found.column("E_diss"), &wanted) / largest(&wanted)
}

fn interpolate(times: &[f64], values: &[f64], time: f64) -> f64 {
    let after = times.partition_point(|&other| other < time).clamp(1, times.len() - 1);
    let part = (time - times[after - 1]) / (times[after] - times[after - 1]);
    values[after - 1] + part * (values[after] - values[after - 1])
}

#[test]
fn the_library_is_where_the_script_looks_for_it() {
    assert!(library().is_file());
}
