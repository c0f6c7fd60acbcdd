//! What the suites share: the commands, the environment of Python, and the kit in the files beside this one.

pub mod near;
pub mod random;
pub mod runs;
pub mod scenes;
pub mod sweeps;
pub mod table;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

pub use table::Table;

/// The repository.
pub fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// An empty folder of the test's own.
pub fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// The program.
pub fn asperity() -> Command {
    Command::new(env!("CARGO_BIN_EXE_asperity"))
}

/// Runs a command that has to succeed and returns what it wrote to standard output.
pub fn run(command: &mut Command) -> String {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(output.status.success(), "{command:?}: {}\n{}", text(&output.stdout), text(&output.stderr));
    text(&output.stdout)
}

/// How a command ends: its status, and what it writes to standard output and standard error.
pub fn ended(command: &mut Command) -> (i32, String, String) {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

/// Asserts that a message names each of these: keys, numbers, places, options, parted by bars.
#[track_caller]
pub fn assert_names(message: impl AsRef<str>, parts: &str) {
    let message = message.as_ref();
    let missing: Vec<&str> = parts.split('|').map(str::trim).filter(|part| !message.contains(part)).collect();
    assert!(missing.is_empty(), "no {missing:?} in {message}");
}

/// Where cargo builds: the parent of the tests' scratch folder.
pub fn target() -> &'static Path {
    Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap()
}

/// Pythons with the packages of a list, made once.
macro_rules! pythons {
    ($($(#[$doc:meta])* $name:ident: $folder:literal, $packages:literal;)*) => { $(
        $(#[$doc])*
        pub fn $name() -> &'static Path {
            static PYTHON: OnceLock<PathBuf> = OnceLock::new();
            PYTHON.get_or_init(|| environment($folder, root().join($packages).to_str().unwrap()))
        }
    )* };
}
pythons! {
    /// The one that build-fmu.sh uses.
    python: "venv", "tests/python/requirements.txt";
    masters_python: "venv-masters", "tests/python/masters.txt";
    coupled_python: "venv-coupled", "scenes/coupled/requirements.txt";
    mujoco_python: "venv-mujoco", "scenes/patch-mujoco/requirements.txt";
    sweep_python: "venv-sweep", "scenes/sweep/requirements.txt";
}

fn environment(folder: &str, packages: &str) -> PathBuf {
    let script = root().join("tests/python/environment.sh");
    run(Command::new("bash").arg(script).arg(target().join(folder)).arg(packages)).trim().into()
}

/// A browser without a window: Debian's chromium-headless-shell, or another Chromium.
pub fn browser() -> &'static str {
    const NAMES: [&str; 5] =
        ["chromium-headless-shell", "chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
    let is_there = |name: &&str| Command::new(name).arg("--version").output().is_ok();
    NAMES.into_iter().find(is_there).unwrap_or_else(|| panic!("no browser; one of {NAMES:?} is needed"))
}

/// Runs fmpy from its command line.
pub fn fmpy(arguments: &[&str]) -> String {
    run(Command::new(python()).args(["-m", "fmpy"]).args(arguments))
}

/// The shared library of the FMU, built of what the tests are built of.
pub fn library() -> &'static Path {
    static LIBRARY: OnceLock<PathBuf> = OnceLock::new();
    LIBRARY.get_or_init(|| {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.current_dir(root()).args(["build", "--locked", "-p", "asperity-fmu", "--target-dir"]);
        run(cargo.arg(target()));
        let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
        target().join(format!("debug/{prefix}asperity_fmu{suffix}"))
    })
}

/// Packs a scene into `folder`.
pub fn pack(scene: &Path, folder: &Path) -> PathBuf {
    let fmu = folder.join(scene.with_extension("fmu").file_name().unwrap());
    run(asperity().arg("pack").arg(scene).arg("-o").arg(&fmu).arg("--library").arg(library()));
    fmu
}

/// Runs a scene by the program; `options` as on its command line.
pub fn simulate(scene: &Path, folder: &Path, options: &[&str]) -> Table {
    let output = folder.join(scene.with_extension("csv").file_name().unwrap());
    run(asperity().arg("simulate").arg(scene).arg("-o").arg(&output).args(options));
    Table::read(&output)
}

/// Drives an FMU in fmpy along the columns time, u and w of `motion`, rates given; `parameters` as NAME=VALUE.
pub fn drive(fmu: &Path, motion: &Path, parameters: &[&str]) -> Table {
    drive_with_jumps(fmu, motion, parameters, &[])
}

/// As [`drive`], with inputs that jump: each as `TIME:NAME=VALUE`.
pub fn drive_with_jumps(fmu: &Path, motion: &Path, parameters: &[&str], jumps: &[&str]) -> Table {
    let output = fmu.with_extension("driven.csv");
    let mut command = Command::new(python());
    command.arg(root().join("tests/python/drive.py")).args([fmu, motion]).arg("-o").arg(&output);
    let jumps = jumps.iter().flat_map(|jump| ["--jump", jump]);
    run(command.args(parameters.iter().flat_map(|parameter| ["--set", parameter])).args(jumps));
    Table::read(&output)
}

/// What lies at `time` on the straight lines between `values` at `times`.
pub fn interpolate(times: &[f64], values: &[f64], time: f64) -> f64 {
    let after = times.partition_point(|&other| other < time).clamp(1, times.len() - 1);
    let part = (time - times[after - 1]) / (times[after] - times[after - 1]);
    values[after - 1] + part * (values[after] - values[after - 1])
}

/// The largest absolute value; NaN counts as infinite.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| if value.is_nan() { f64::INFINITY } else { largest.max(value.abs()) })
}

/// The largest difference; NaN counts as infinite.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len(), "as many rows");
    largest(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>())
}
