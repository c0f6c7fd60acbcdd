//! The cases of tests/reference: the program and the FMU against an independent solution.

use std::fs;
use std::path::PathBuf;

use crate::common::{Table, difference, drive, largest, pack, root, scratch, simulate};
use asperity::scene::Scene;
use asperity::simulation::{Motion, Simulation, Start};

/// How far a run may be from the reference, over the largest value.
#[derive(Clone, Copy, Debug)]
struct SplineBounds {
    forces: f64,
    losses: f64,
    energies: f64,
}

const FINE: &str = "solver.relative_tolerance=1e-9";
const DEFAULT: &str = "solver.relative_tolerance=1e-6";

const AT_FINE: SplineBounds = SplineBounds { forces: 1e-6, losses: 1e-6, energies: 1e-6 };
/// The reference of this case itself is only that good: thirty-three impacts follow from one another.
const AT_FINE_RATTLE: SplineBounds = SplineBounds { forces: 2e-5, losses: 1e-5, energies: 1e-5 };
const AT_DEFAULT: SplineBounds = SplineBounds { forces: 1e-3, losses: 1e-3, energies: 1e-3 };

const FORCES: [&str; 2] = ["F_x", "F_z"];
const LOSSES: [&str; 5] =
    ["E_diss", "dissipation.E_damper", "dissipation.E_maxwell", "dissipation.E_friction", "dissipation.E_impact"];
const ENERGIES: [&str; 3] = ["energy.input", "energy.kinetic", "energy.elastic"];
const COUNTS: [&str; 2] = ["contact.count", "contact.sticking"];

/// A case: its files, and where its runs go.
struct Case {
    name: &'static str,
    scene: PathBuf,
    reference: Table,
    folder: PathBuf,
}

impl Case {
    fn new(name: &'static str, run: &str) -> Self {
        let file = |extension: &str| root().join(format!("tests/reference/{name}.{extension}"));
        let reference = Table::read(&file("csv"));
        Self { name, scene: file("toml"), reference, folder: scratch(&format!("reference-{name}-{run}")) }
    }

    fn motion(&self) -> PathBuf {
        self.scene.with_extension("csv")
    }

    /// Holds a run against the reference.
    fn compare(&self, found: &Table, tolerance: &str, bounds: SplineBounds) {
        let wanted = |column: &str| self.reference.column(column);
        let loss = largest(&wanted("E_diss"));
        for column in FORCES {
            self.compare_column(found, column, bounds.forces, largest(&wanted(column)));
        }
        for column in LOSSES {
            self.compare_column(found, column, bounds.losses, loss);
        }
        for column in ENERGIES {
            self.compare_column(found, column, bounds.energies, loss.max(largest(&wanted(column))));
        }
        for column in COUNTS {
            self.compare_counts(found, column, tolerance);
        }
    }

    /// A channel that the scene cannot have is no column, and 0 in the reference.
    fn compare_column(&self, found: &Table, column: &str, bound: f64, scale: f64) {
        let wanted = self.reference.column(column);
        let found = found.get(column).unwrap_or_else(|| vec![0.0; wanted.len()]);
        let error = difference(&found, &wanted);
        assert!(error <= bound * scale, "{}: {column} differs by {:e}, allowed {bound:e}", self.name, error / scale);
    }

    /// The largest error of a column over its largest value.
    fn relative_error(&self, found: &Table, column: &str) -> f64 {
        let wanted = self.reference.column(column);
        difference(&found.column(column), &wanted) / largest(&wanted)
    }

    /// Counts are equal, apart from rows that an event is nearer to than a millionth of the run.
    fn compare_counts(&self, found: &Table, column: &str, tolerance: &str) {
        let (wanted, found) = (self.reference.column(column), found.column(column));
        assert_eq!(wanted.len(), found.len(), "as many rows");
        let differing: Vec<usize> = (0..wanted.len()).filter(|&row| wanted[row] != found[row]).collect();
        if differing.is_empty() {
            return;
        }
        let times = self.reference.column("time");
        let near = 1e-6 * times[times.len() - 1];
        let events = self.event_times(tolerance);
        for row in differing {
            let excused = events.iter().any(|event| (event - times[row]).abs() < near);
            assert!(excused, "{}: {column} at t = {} is {}, not {}", self.name, times[row], found[row], wanted[row]);
        }
    }

    /// The instants at which masses change their modes.
    fn event_times(&self, tolerance: &str) -> Vec<f64> {
        let mut scene = Scene::load(&self.scene).unwrap();
        let (key, value) = tolerance.split_once('=').unwrap();
        scene.set_by_name(key, value).unwrap();
        let first = &scene.excitation[0];
        let start = Start { u_rate: first.u.at(0.0).speed, w_rate: first.w.at(0.0).speed, ..Start::default() };
        let mut simulation = Simulation::new(&scene, &start).unwrap();
        simulation.record_mode_changes(true);
        for phase in &scene.excitation {
            simulation
                .advance(&Motion { duration: phase.duration, u: phase.u, w: phase.w, ..Motion::default() })
                .unwrap();
        }
        simulation.take_mode_changes().iter().map(|change| change.time).collect()
    }
}

fn program(name: &'static str, fine: SplineBounds) {
    let case = Case::new(name, "program");
    let runs = [(FINE, fine), (DEFAULT, AT_DEFAULT)].map(|(tolerance, bounds)| {
        let found = simulate(&case.scene, &case.folder, &["--set", tolerance]);
        case.compare(&found, tolerance, bounds);
        found
    });
    let [fine, default] = runs.map(|found| residual(&found));
    assert!(fine <= 1e-7, "{name}: the energy balance misses {fine:e} of the largest energy");
    assert!(fine <= default.max(1e-12), "{name}: the energy balance misses {fine:e}, {default:e} at the default");
}

/// What the energy balance misses over the largest energy.
fn residual(found: &Table) -> f64 {
    let energies = ["E_diss", "energy.input", "energy.kinetic", "energy.elastic"];
    let scale = energies.iter().map(|column| largest(&found.column(column))).fold(0.0, f64::max);
    largest(&found.column("energy.residual")) / scale
}

fn fmu(name: &'static str, fine: SplineBounds) {
    let case = Case::new(name, "fmu");
    let fmu = pack(&case.scene, &case.folder);
    for (tolerance, bounds) in [(FINE, fine), (DEFAULT, AT_DEFAULT)] {
        case.compare(&drive(&fmu, &case.motion(), &[tolerance]), tolerance, bounds);
    }
}

/// A sine as a row of straight pieces is only as good as its pieces are short: the rate is off by half its change over
/// one piece, and the damper forces with it.
fn fmu_with_sines(name: &'static str) {
    const STEPS: usize = 1000;
    let case = Case::new(name, "fmu");
    let fmu = pack(&case.scene, &case.folder);
    simulate(&case.scene, &case.folder, &["--rows", &(50 * STEPS).to_string()]);
    let motion = case.folder.join(format!("{name}.csv"));
    case.compare(&drive(&fmu, &motion, &[FINE]).every(STEPS), FINE, AT_DEFAULT);
}

/// The run's own estimates against its true errors: the reference's errors are far below both.
fn estimate(name: &'static str) {
    let case = Case::new(name, "estimate");
    for (method, tolerance) in [("event", 1e-3), ("event", 1e-4), ("event", 1e-5), ("step", 1e-2), ("step", 1e-3)] {
        let settings = [format!("solver.method={method}"), format!("solver.relative_tolerance={tolerance}")];
        let found = simulate(&case.scene, &case.folder, &["--set", &settings[0], "--set", &settings[1]]);
        for (estimate, columns) in [("solver.error", &FORCES[..]), ("solver.error_E_diss", &["E_diss"])] {
            let error = columns.iter().map(|column| case.relative_error(&found, column)).fold(0.0, f64::max);
            let ratio = found.column(estimate).last().unwrap() / error;
            let run = format!("{name}, {method}, {tolerance}");
            assert!((0.1..10.0).contains(&ratio), "{run}: {estimate} is {ratio} times the error, {error:e}");
        }
    }
}

macro_rules! cases {
    ($($test:ident: $name:literal, $bounds:expr;)*) => {
        mod by_the_program {
            use super::*;
            $(#[test] fn $test() { program($name, $bounds); })*

            #[test]
            fn free_chain() {
                program("free-chain", AT_FINE);
            }
        }

        mod by_its_own_estimate {
            use super::*;
            $(#[test] fn $test() { estimate($name); })*

            #[test]
            fn free_chain() {
                estimate("free-chain");
            }
        }

        mod as_an_fmu {
            use super::*;
            $(#[test] fn $test() { fmu($name, $bounds); })*

            #[test]
            fn free_chain() {
                fmu_with_sines("free-chain");
            }
        }
    };
}

cases! {
    sinusoid: "sinusoid", AT_FINE;
    rattle: "rattle", AT_FINE_RATTLE;
    stuck_pair: "stuck-pair", AT_FINE;
    rough_coulomb: "rough-coulomb", AT_FINE;
    rough_shear: "rough-shear", AT_FINE;
    figure_7_low: "figure-7-low", AT_FINE;
    figure_7_middle: "figure-7-middle", AT_FINE;
    figure_7_high: "figure-7-high", AT_FINE;
}

#[test]
fn every_case_is_tried() {
    let files = fs::read_dir(root().join("tests/reference")).unwrap().map(|entry| entry.unwrap().path());
    assert_eq!(files.filter(|path| path.extension().is_some_and(|extension| extension == "toml")).count(), 9);
}
