//! The FMU in fmpy: its results, its simulation from the command line; its description there and in fmutool.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::{
    Table, asperity, difference, fmpy, interpolate, largest, library, masters_python, pack, python, root, run, scratch,
    simulate,
};
use asperity::scene::OutputGroup;

const DEFAULT_SCENE: &str = "scenes/tread-block/tread-block.toml";

/// Every scene in scenes/; patches lie there, too.
fn shipped_scenes() -> Vec<PathBuf> {
    let files = |folder: &Path| fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect::<Vec<_>>();
    let folders = files(&root().join("scenes")).into_iter().filter(|path| path.is_dir());
    let toml = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "toml");
    let is_scene = |path: &PathBuf| toml(path) && fs::read_to_string(path).unwrap().contains("[layer]");
    let scenes: Vec<_> = folders.flat_map(|folder| files(&folder)).filter(is_scene).collect();
    assert!(!scenes.is_empty());
    scenes
}

/// fmpy's check, of which the schema is part, and that of the FMU manipulation toolbox.
fn validate(fmu: &Path) {
    let fmpy = fmpy(&["validate", fmu.to_str().unwrap()]);
    assert_eq!(fmpy.trim(), "No problems found.", "{}", fmu.display());
    let mut fmutool = Command::new(masters_python());
    fmutool.args(["-m", "fmu_manipulation_toolbox.cli.fmutool", "-check", "-input"]).arg(fmu);
    let fmutool = run(&mut fmutool);
    let verdicts = ["This FMU seems to be compliant with FMI-2.0.", "No semantic error against the FMI-2 standard."];
    assert!(verdicts.iter().all(|verdict| fmutool.contains(verdict)), "{fmutool}");
    assert!(fmutool.lines().all(|line| line.starts_with("INFO ")), "{fmutool}");
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
fn no_fault_is_found_in_the_shipped_scenes() {
    let folder = scratch("fmpy-validate");
    shipped_scenes().iter().for_each(|scene| validate(&pack(scene, &folder)));
}

#[test]
fn no_fault_is_found_with_every_output_group_and_with_none() {
    let folder = scratch("fmpy-groups");
    let groups: Vec<_> = OutputGroup::ALL.into_iter().filter(|group| *group != OutputGroup::Carrier).collect();
    let groups: Vec<_> = groups.into_iter().map(OutputGroup::word).collect();
    validate(&pack(&scene_with_groups(&folder, &groups), &folder));
    validate(&pack(&scene_with_groups(&folder, &[]), &folder));
}

/// With every group, every input and every unit that a carrier's body brings.
#[test]
fn no_fault_is_found_with_bodies() {
    let folder = scratch("fmpy-bodies");
    let scene = fs::read_to_string(root().join("tests/reference/load/bouncing-load.toml")).unwrap();
    let all = OutputGroup::ALL.map(|group| format!("\"{}\"", group.word())).join(", ");
    let asked =
        "outputs = [\"forces\", \"carrier\", \"dissipation\", \"friction\", \"contact\", \"energy\", \"solver\"]";
    assert!(scene.contains(asked));
    let body = "[carrier.x]\nmass = 1e-4\nstiffness = 1e3\npull = 0.0\nstart = 0.0\nstart_rate = 0.0\n[carrier.z]";
    let scene = scene.replace(asked, &format!("outputs = [{all}]")).replace("[carrier.z]", body);
    let path = folder.join("bodies.toml");
    fs::write(&path, scene).unwrap();
    validate(&pack(&path, &folder));
}

#[test]
fn no_fault_is_found_in_patches() {
    let folder = scratch("fmpy-patches");
    let all =
        "outputs = [\"forces\", \"dissipation\", \"contact\", \"friction\", \"energy\", \"tangent\", \"elements\"]";
    for name in ["block", "ring", "wheel"] {
        let source = root().join("tests/reference/patch");
        for file in ["block.table.csv", "winkler.table.csv", "ring.points.csv"] {
            fs::copy(source.join(file), folder.join(file)).unwrap();
        }
        let text = fs::read_to_string(source.join(format!("{name}.toml"))).unwrap();
        let (before, _) = text.split_once("outputs = [").unwrap();
        let (patch, fmu) = (folder.join(format!("{name}.toml")), folder.join(format!("{name}.fmu")));
        fs::write(&patch, format!("{before}{all}\n")).unwrap();
        run(asperity().args(["pack", "--patch"]).arg(&patch).arg("-o").arg(&fmu).arg("--library").arg(library()));
        validate(&fmu);
    }
}

#[test]
fn no_fault_is_found_in_seals() {
    let folder = scratch("fmpy-seals");
    let source = root().join("tests/reference/film");
    for file in ["film-strokes.table.csv", "film-strokes.lip.csv"] {
        fs::copy(source.join(file), folder.join(file)).unwrap();
    }
    let all = "[fmu]\noutputs = [\"forces\", \"dissipation\", \"film\", \"contact\", \"tangent\", \"cells\"]\n";
    let text = fs::read_to_string(source.join("film-strokes.toml")).unwrap().replace("cells = 96", "cells = 8");
    let (seal, fmu) = (folder.join("seal.toml"), folder.join("seal.fmu"));
    fs::write(&seal, format!("{text}{all}")).unwrap();
    run(asperity().args(["pack", "--seal"]).arg(&seal).arg("-o").arg(&fmu).arg("--library").arg(library()));
    validate(&fmu);
}

#[test]
fn the_same_scene_gives_the_same_bytes() {
    let folder = scratch("fmpy-bytes");
    let pack = || fs::read(pack(&root().join(DEFAULT_SCENE), &folder)).unwrap();
    assert!(pack() == pack());
}

/// Names without structure, which the program says: what masters make of them is valid, and the run has the same bits.
#[test]
fn flat_names_change_nothing_but_the_names() {
    let folder = scratch("fmpy-flat");
    let source = root().join("tests/reference/patch");
    for file in ["wheel.toml", "winkler.table.csv"] {
        fs::copy(source.join(file), folder.join(file)).unwrap();
    }
    let packed = |name: &str, options: &[&str]| {
        let fmu = folder.join(name);
        let mut pack = asperity();
        pack.args(["pack", "--patch"]).arg(folder.join("wheel.toml")).arg("-o").arg(&fmu).args(options);
        (run(pack.arg("--library").arg(library())), fmu)
    };
    let (said, own) = packed("own.fmu", &[]);
    assert!(!said.contains("flat"), "{said}");
    let (said, flat) = packed("flat.fmu", &["--flat-names"]);
    assert!(
        said.contains("flat, such as transport_speed for transport.speed; messages keep transport.speed"),
        "{said}"
    );
    validate(&flat);
    let described = "import sys, fmpy; d = fmpy.read_model_description(sys.argv[1]); \
                     print(d.variableNamingConvention, *[v.name for v in d.modelVariables])";
    let names = |fmu: &Path| run(Command::new(python()).args(["-c", described]).arg(fmu));
    let (names, flat_names) = (names(&own), names(&flat));
    assert!(
        names.starts_with("structured ") && names.contains(" force.x ") && !flat_names.contains(['.', '[', ']', ','])
    );
    assert_eq!(names.replacen("structured", "flat", 1).replace('.', "_"), flat_names);
    // It comes down and rolls.
    let result = |fmu: &Path, speed: &str| {
        let (motion, result) = (folder.join("motion.csv"), fmu.with_extension("csv"));
        let z = |time: f64| 0.3 - 4e-5 * (time / 0.01).min(1.0);
        let row = |i: u32| [f64::from(i) * 1e-3, 0.02 * f64::from(i), z(f64::from(i) * 1e-3), 0.05 * f64::from(i)];
        Table::new(["time", "x", "z", speed], (0..=30).map(|i| row(i).to_vec())).write(&motion);
        let [fmu, motion, output] = [fmu, &motion, &result].map(|path| path.to_str().unwrap());
        fmpy(&["simulate", fmu, "--input-file", motion, "--output-file", output, "--output-interval", "1e-3"]);
        fs::read_to_string(output).unwrap()
    };
    let (found, right) = (result(&flat, "transport_speed"), result(&own, "transport.speed"));
    let rows = |text: &str| text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(rows(&found), rows(&right));
    let last = Table::read(&own.with_extension("csv"));
    assert!(last.column("force.z").last().is_some_and(|force| *force > 0.0));
    assert!(found.starts_with(&right.lines().next().unwrap().replace('.', "_")), "{}", found.lines().next().unwrap());
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
    assert!(text.contains("nowhere/libasperity.so") && text.contains("cargo build"), "{text}");
}

/// `fmpy simulate` gives values alone, so that the FMU starts at rest and goes on as the motion came: of every kink it
/// learns one step late. The forces jump there; the energy lost, which does not, comes closer as the step gets shorter.
#[test]
fn from_the_command_line_fmpy_comes_as_close_as_its_step_is_short() {
    let folder = scratch("fmpy-command-line");
    let scene = root().join(DEFAULT_SCENE);
    let own = simulate(&scene, &folder, &["--rows", "400"]);
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
