//! What the tests of the program and of the FMU share: the commands, the environment of Python, result files.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use asperity::outputs::variables;
use asperity::scene::{self, Scene};
use asperity::simulation::{Motion, Simulation, Start};

/// The repository.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
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

/// Where cargo builds: the parent of the tests' scratch folder.
pub fn target() -> &'static Path {
    Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap()
}

/// A Python with the packages of tests/python/requirements.txt, the same that build-fmu.sh uses.
pub fn python() -> &'static Path {
    static PYTHON: OnceLock<PathBuf> = OnceLock::new();
    PYTHON.get_or_init(|| environment("venv", "requirements.txt"))
}

/// A Python with the packages of tests/python/masters.txt.
pub fn masters_python() -> &'static Path {
    static PYTHON: OnceLock<PathBuf> = OnceLock::new();
    PYTHON.get_or_init(|| environment("venv-masters", "masters.txt"))
}

/// A Python with the packages of scenes/coupled/requirements.txt.
pub fn coupled_python() -> &'static Path {
    static PYTHON: OnceLock<PathBuf> = OnceLock::new();
    let packages = root().join("scenes/coupled/requirements.txt");
    PYTHON.get_or_init(|| environment("venv-coupled", packages.to_str().unwrap()))
}

/// A Python with the packages of scenes/patch-mujoco/requirements.txt.
pub fn mujoco_python() -> &'static Path {
    static PYTHON: OnceLock<PathBuf> = OnceLock::new();
    let packages = root().join("scenes/patch-mujoco/requirements.txt");
    PYTHON.get_or_init(|| environment("venv-mujoco", packages.to_str().unwrap()))
}

/// A Python with the packages of scenes/sweep/requirements.txt.
pub fn sweep_python() -> &'static Path {
    static PYTHON: OnceLock<PathBuf> = OnceLock::new();
    let packages = root().join("scenes/sweep/requirements.txt");
    PYTHON.get_or_init(|| environment("venv-sweep", packages.to_str().unwrap()))
}

fn environment(folder: &str, packages: &str) -> PathBuf {
    let script = root().join("tests/python/environment.sh");
    run(Command::new("bash").arg(script).arg(target().join(folder)).arg(packages)).trim().into()
}

/// Runs fmpy from its command line.
pub fn fmpy(arguments: &[&str]) -> String {
    run(Command::new(python()).args(["-m", "fmpy"]).args(arguments))
}

/// The shared library of the FMU, built as build-fmu.sh builds it.
pub fn library() -> &'static Path {
    static LIBRARY: OnceLock<PathBuf> = OnceLock::new();
    LIBRARY.get_or_init(|| {
        let folder = target().join("fmu");
        let mut cargo = Command::new(env!("CARGO"));
        cargo.current_dir(root()).args(["rustc", "--release", "--lib", "--no-default-features"]);
        run(cargo.args(["--crate-type", "cdylib", "--target-dir"]).arg(&folder));
        let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
        folder.join(format!("release/{prefix}asperity{suffix}"))
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
    let output = fmu.with_extension("driven.csv");
    let mut command = Command::new(python());
    command.arg(root().join("tests/python/drive.py")).args([fmu, motion]).arg("-o").arg(&output);
    run(command.args(parameters.iter().flat_map(|parameter| ["--set", parameter])));
    Table::read(&output)
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

/// What the library gives along the rows of `motion`, straight from one to the next.
pub fn library_along(scene: &Scene, motion: &Table) -> Table {
    let [time, u, w] = ["time", "u", "w"].map(|name| motion.column(name));
    let rate = |values: &[f64], i: usize| (values[i + 1] - values[i]) / (time[i + 1] - time[i]);
    let start = Start { u_rate: rate(&u, 0), w_rate: rate(&w, 0), ..Start::default() };
    let mut simulation = Simulation::new(scene, &start).unwrap();
    let variables = variables(scene);
    let mut rows = vec![vec![0.0; variables.len()]];
    simulation.evaluate(&variables, &mut rows[0]);
    for i in 0..time.len() - 1 {
        let path = |values: &[f64]| scene::Path { rate: rate(values, i), ..scene::Path::default() };
        simulation
            .advance(&Motion { duration: time[i + 1] - time[i], u: path(&u), w: path(&w), ..Motion::default() })
            .unwrap();
        let mut row = vec![0.0; variables.len()];
        simulation.evaluate(&variables, &mut row);
        rows.push(row);
    }
    Table { names: variables.into_iter().map(|variable| variable.name).collect(), rows }
}

/// A result file.
#[derive(Debug)]
pub struct Table {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    /// Reads a file that has a line of names and then numbers.
    pub fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let mut lines = text.lines();
        let names = lines.next().unwrap().split(',').map(|name| name.trim_matches('"').to_owned()).collect();
        let rows = lines.map(|line| line.split(',').map(|field| field.parse().unwrap()).collect()).collect();
        Self { names, rows }
    }

    /// The table with these rows.
    pub fn new(names: &[&str], rows: Vec<Vec<f64>>) -> Self {
        Self { names: names.iter().map(|&name| name.to_owned()).collect(), rows }
    }

    /// Writes it as a file, zero as 0.0: some readers take 0 for a column of integers.
    pub fn write(&self, path: &Path) {
        let line = |row: &Vec<f64>| row.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(",");
        let lines: Vec<String> = [self.names.join(",")].into_iter().chain(self.rows.iter().map(line)).collect();
        fs::write(path, lines.join("\n") + "\n").unwrap();
    }

    /// The names of the columns.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The values of a column; `None` where there is no such column.
    pub fn get(&self, name: &str) -> Option<Vec<f64>> {
        let index = self.names.iter().position(|other| other == name)?;
        Some(self.rows.iter().map(|row| row[index]).collect())
    }

    /// The values of a column that has to be there.
    pub fn column(&self, name: &str) -> Vec<f64> {
        self.get(name).unwrap_or_else(|| panic!("no column {name} in {:?}", self.names))
    }

    /// Every `step`th row.
    pub fn every(mut self, step: usize) -> Self {
        self.rows = self.rows.into_iter().step_by(step).collect();
        self
    }
}

/// What lies at `time` on the straight lines between `values` at `times`.
pub fn interpolate(times: &[f64], values: &[f64], time: f64) -> f64 {
    let after = times.partition_point(|&other| other < time).clamp(1, times.len() - 1);
    let part = (time - times[after - 1]) / (times[after] - times[after - 1]);
    values[after - 1] + part * (values[after] - values[after - 1])
}

/// The largest absolute value.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| largest.max(value.abs()))
}

/// The largest difference; NaN counts as infinite.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len(), "as many rows");
    let distance = |(a, b): (&f64, &f64)| if (a - b).is_nan() { f64::INFINITY } else { (a - b).abs() };
    a.iter().zip(b).map(distance).fold(0.0, f64::max)
}
