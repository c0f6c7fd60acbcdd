//! The cases of tests/reference/load, whose carrier is a body: the program and the FMU against an independent solution.

use std::path::PathBuf;

use crate::common::{Table, difference, drive_with_jumps, largest, pack, root, scratch, simulate};

/// At 1e-9 the program's own errors are some 1e-9, the reference's 1e-9 of the largest force.
const FINE: f64 = 1e-6;

struct Case {
    name: &'static str,
    /// Jumps of the load within the run, for the FMU.
    jumps: &'static [&'static str],
}

const CASES: [Case; 3] = [
    Case { name: "load-pressed", jumps: &["4e-3:load=0.1"] },
    Case { name: "driven-spring", jumps: &[] },
    Case { name: "bouncing-load", jumps: &["5e-4:load=-0.06", "8e-4:load=0.0"] },
];

impl Case {
    fn scene(&self) -> PathBuf {
        root().join(format!("tests/reference/load/{}.toml", self.name))
    }

    /// The columns by what they are measured by: forces by the largest force, energies by the largest energy, what the
    /// carrier does by itself.
    fn compare(&self, found: &Table, bound: f64) {
        let wanted = Table::read(&self.scene().with_extension("csv"));
        let largest_of =
            |columns: &[&str]| columns.iter().map(|name| largest(&wanted.column(name))).fold(0.0, f64::max);
        let (force, energy) = (largest_of(&["F_x", "F_z"]), largest_of(&["energy.input", "energy.elastic"]));
        for name in wanted.names() {
            let scale = match name.as_str() {
                "time" | "u" | "w" | "load" | "pull" | "P_diss" => continue,
                "contact.count" | "contact.sticking" => 0.0,
                name if name.starts_with("F_") || name.starts_with("friction") || name == "contact.F_z" => force,
                name if name.starts_with("energy") || name.contains("E_") => energy,
                name => largest(&wanted.column(name)),
            };
            // A quantity that the scene cannot have is no column, and a carrier's that is prescribed is none either.
            let Some(column) = found.get(name) else {
                assert!(name.contains('.'), "{}: no column {name}", self.name);
                continue;
            };
            let error = difference(&column, &wanted.column(name));
            assert!(error <= bound * scale, "{}: {name} differs by {:e} of {scale:e}", self.name, error / scale);
        }
    }
}

#[test]
fn by_the_program() {
    for case in CASES {
        let folder = scratch(&format!("load-{}", case.name));
        let found = simulate(&case.scene(), &folder, &["--set", "solver.relative_tolerance=1e-9"]);
        case.compare(&found, FINE);
        let residual = largest(&found.column("energy.residual")) / largest(&found.column("energy.input"));
        assert!(residual < 1e-9, "{}: the energy balance misses {residual:e}", case.name);
    }
}

/// Masters give values and rates; a jump lies between two of their steps.
#[test]
fn as_an_fmu() {
    for case in CASES {
        let folder = scratch(&format!("load-fmu-{}", case.name));
        let fmu = pack(&case.scene(), &folder);
        let motion = case.scene().with_extension("csv");
        case.compare(&drive_with_jumps(&fmu, &motion, &["solver.relative_tolerance=1e-9"], case.jumps), FINE);
    }
}

/// By steps of two stages the errors are those of the tolerance: at most ten times it.
#[test]
fn by_the_other_methods() {
    for (method, tolerance) in [("step", 1e-2), ("step", 1e-4), ("auto", 1e-4)] {
        for case in CASES {
            let folder = scratch(&format!("load-{method}-{}", case.name));
            let settings = [format!("solver.method={method}"), format!("solver.relative_tolerance={tolerance}")];
            let found = simulate(&case.scene(), &folder, &["--set", &settings[0], "--set", &settings[1]]);
            let wanted = Table::read(&case.scene().with_extension("csv"));
            for name in ["F_x", "F_z"] {
                let error = difference(&found.column(name), &wanted.column(name)) / largest(&wanted.column(name));
                assert!(error <= 10.0 * tolerance, "{}, {method}, {tolerance}: {name} {error:e}", case.name);
            }
        }
    }
}

/// M Δẇ = ∫(F_z - N + R_z) dt, also where masses that settle at the ends of time steps pass impulses on.
#[test]
fn momentum_is_kept() {
    let case = &CASES[2];
    for (method, tolerance) in [("event", "1e-6"), ("step", "1e-3")] {
        let folder = scratch(&format!("load-momentum-{method}"));
        let settings = [format!("solver.method={method}"), format!("solver.relative_tolerance={tolerance}")];
        let options = ["--set", &settings[0], "--set", &settings[1], "--rows", "4000"];
        let found = simulate(&case.scene(), &folder, &options);
        let [time, force, drive, rate, load] =
            ["time", "F_z", "carrier.drive_z", "carrier.w_rate", "load"].map(|name| found.column(name));
        let (mut impulse, mut worst) = (0.0, 0.0_f64);
        for i in 1..time.len() {
            // A row at a jump holds the load before it.
            let load = 0.02 + load[i];
            let mean = 0.5 * (force[i - 1] + force[i] + drive[i - 1] + drive[i]) - load;
            impulse += (time[i] - time[i - 1]) * mean;
            worst = worst.max((2e-4 * (rate[i] - rate[0]) - impulse).abs());
        }
        // Forces jump at impacts, within intervals of 1e-6 s at most: 1e-3 of the momentum.
        let momentum = 2e-4 * largest(&rate);
        assert!(worst < 2e-3 * momentum, "{method}: {worst:e} of {momentum:e}");
    }
}
