//! The FMU in a host written in C: its results, errors and leaks by valgrind, thousands of instances.

use std::path::PathBuf;
use std::process::Command;

use crate::common::{Table, drive, pack, python, root, run, scratch, simulate};
use asperity::outputs::variables;
use asperity::scene::Scene;

/// Sticks, slips and hits the profile.
const SCENE: &str = "tests/reference/rough-coulomb.toml";

/// A scene, packed, and its motion.
struct Packed {
    scene: PathBuf,
    fmu: PathBuf,
    motion: PathBuf,
}

fn packed(scene: &str, folder: &str) -> Packed {
    let (scene, folder) = (root().join(scene), scratch(folder));
    simulate(&scene, &folder, &[]);
    let motion = folder.join(scene.with_extension("csv").file_name().unwrap());
    Packed { fmu: pack(&scene, &folder), motion, scene }
}

impl Packed {
    fn result(&self) -> PathBuf {
        self.fmu.with_extension("host.csv")
    }

    /// The host, ready to run.
    fn host(&self, options: &[&str]) -> Command {
        let mut command = Command::new(python());
        command.arg(root().join("tests/host/run.py")).args([&self.fmu, &self.motion]).arg("-o").arg(self.result());
        command.args(options);
        command
    }

    /// The names of the columns that are the same in every run.
    fn columns(&self) -> Vec<String> {
        let variables = variables(&Scene::load(&self.scene).unwrap());
        variables.into_iter().map(|variable| variable.name).filter(|name| name != "solver.run_time").collect()
    }
}

fn the_host_gives_what_fmpy_gives(scene: &str, folder: &str) {
    let packed = packed(scene, folder);
    run(&mut packed.host(&[]));
    let (own, fmpy) = (Table::read(&packed.result()), drive(&packed.fmu, &packed.motion, &[]));
    for name in packed.columns() {
        assert!(own.column(&name) == fmpy.column(&name), "{name}");
    }
}

#[test]
fn driven_from_c_the_default_scene_gives_what_it_gives_in_fmpy() {
    the_host_gives_what_fmpy_gives("scenes/tread-block/tread-block.toml", "host-default");
}

#[test]
fn driven_from_c_stick_slip_and_impacts_are_those_of_fmpy() {
    the_host_gives_what_fmpy_gives(SCENE, "host-impacts");
}

/// The output of the host under valgrind, which must find nothing.
fn under_valgrind(folder: &str, options: &[&str]) -> String {
    const VALGRIND: &str =
        "valgrind --error-exitcode=99 --leak-check=full --errors-for-leak-kinds=definite,indirect,possible";
    let packed = packed(SCENE, folder);
    let output = packed.host(&[options, &["--under", VALGRIND]].concat()).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && text.contains("ERROR SUMMARY: 0 errors"), "{text}");
    text
}

#[test]
fn valgrind_finds_no_error_and_nothing_lost() {
    under_valgrind("host-valgrind", &["--points", "60", "--instances", "2"]);
}

/// In each, states are kept, restored and freed, one of them by fmi2FreeInstance.
#[test]
fn of_a_thousand_instances_nothing_is_lost() {
    let text = under_valgrind("host-thousand", &["--points", "3", "--instances", "1000"]);
    assert!(text.contains("host: 1000 instances"), "{text}");
}

/// Peak memory of the host, kB: after a tenth of the instances and at the end.
fn peaks(text: &str) -> Vec<u64> {
    let lines = text.lines().filter(|line| line.starts_with("host: ") && line.ends_with(" kB"));
    lines.map(|line| line.rsplit(' ').nth(1).unwrap().parse().unwrap()).collect()
}

#[test]
fn ten_thousand_instances_take_no_more_memory_than_a_thousand() {
    const SLACK: u64 = 256;
    let packed = packed(SCENE, "host-instances");
    let output = packed.host(&["--points", "4", "--instances", "10000"]).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
    let [early, late] = peaks(&text)[..] else { panic!("{text}") };
    assert!(late <= early + SLACK, "{early} kB, {late} kB");
}
