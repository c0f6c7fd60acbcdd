//! Rows of a result file: wherever they fall, the run goes on.

use std::fs;

use crate::common::{scratch, simulate};

/// Rubber pressed on steep slopes, whose friction at creep speeds is steep too: of a step to a row the stages cannot be
/// solved here and there, though those of the longer step are that it was cut from.
const STEEP: &str = "name = 'steep'
layer = { masses = 30, spacing = 1e-4, thickness = 2e-3, width = 1e-2 }
[material]
density = 1100.0
poisson_ratio = 0.49
equilibrium_modulus = 3e6
prony = [
    { modulus = 8e6, relaxation_time = 1e-5 },
    { modulus = 5e6, relaxation_time = 1e-4 },
    { modulus = 3e6, relaxation_time = 1e-3 },
]
[surface]
kind = 'self_affine'
length = 2e-3
points = 400
hurst = 0.8
rms = 5e-5
roll_off_wavelength = 1e-3
cut_off_wavelength = 2e-5
seed = 5
[friction]
coulomb = 0.2
shear_strength = 5e3
rate_shear = { strength = 5e4, reference_speed = 6e-3, sharpness = 0.1 }
[fmu]
outputs = ['forces']
[[excitation]]
duration = 4e-3
w_rate = -1e-2
[[excitation]]
duration = 2e-3
u_rate = 0.1
";

/// 200 rows a phase: with them this run ended at 3.554 ms, without them it did not.
#[test]
fn a_row_ends_no_run() {
    let folder = scratch("program-steep");
    let scene = folder.join("steep.toml");
    fs::write(&scene, STEEP).unwrap();
    let run = |points: &str| {
        let options = ["--rows", points, "--set", "solver.relative_tolerance=1e-4"];
        let table = simulate(&scene, &folder, &options);
        (table.column("time").len(), *table.column("time").last().unwrap())
    };
    assert_eq!(run("200"), (401, 6e-3));
    assert_eq!(run("1"), (3, 6e-3));
}
