//! The example scenes/patch-mujoco: a wheel in MuJoCo that brakes on a contact patch and nothing else.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use crate::common::{Table, asperity, library, mujoco_python, root, run, scratch};

/// N: of 300 kg.
const LOAD: f64 = 300.0 * 9.81;
const FRICTION: f64 = 0.9;

/// Where the example's tables lie.
fn tables() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let (folder, example) = (scratch("patch-mujoco"), root().join("scenes/patch-mujoco"));
        let mut pack = asperity();
        pack.args(["pack", "--patch"]).arg(example.join("tread.toml")).arg("--library").arg(library());
        run(pack.arg("-o").arg(folder.join("tread.fmu")));
        run(Command::new(mujoco_python()).arg("-B").arg(example.join("braking.py")).arg(&folder));
        folder
    })
}

fn table(name: &str) -> Table {
    Table::read(&tables().join(name))
}

/// The rows of a stop at which the time is within the bounds: columns by their names.
fn between<const N: usize>(name: &str, from: f64, to: f64, columns: [&str; N]) -> Vec<[f64; N]> {
    let table = table(name);
    let (time, values) = (table.column("time"), columns.map(|column| table.column(column)));
    let rows = (0..time.len()).filter(|&row| from < time[row] && time[row] < to);
    let rows: Vec<_> = rows.map(|row| std::array::from_fn(|i| values[i][row])).collect();
    assert!(rows.len() > 50, "{name}: rows from {from} to {to}");
    rows
}

/// The steps differ by their order, the brush model by its steady slip: it has no memory, and no load that swings.
#[test]
fn the_distance_is_that_of_half_the_step_and_of_the_brush_model() {
    let distances = table("braking.csv").column("distance");
    let [coarse, fine, brush] = distances[..] else { panic!("{distances:?}") };
    assert!((coarse / fine - 1.0).abs() < 2e-4, "{coarse} {fine}");
    assert!((fine / brush - 1.0).abs() < 2e-3, "{fine} {brush}");
}

/// While it rolls: cells of 2.5 mm and the low end of the table beside a parabola in closed form.
#[test]
fn a_slipping_wheel_has_the_force_of_the_brush_model() {
    for [force, brush, slip] in between("braking-0.5ms.csv", 0.5, 0.75, ["force.x", "brush", "slip"]) {
        assert!(slip > 0.03 && brush < 0.75 * FRICTION * LOAD, "{slip} {brush}");
        assert!((-force / brush - 1.0).abs() < 2.5e-2, "{force} {brush}");
    }
}

/// Every element slips: the force is the friction of the load.
#[test]
fn a_locked_wheel_slides() {
    for [force, normal, tread] in between("braking-0.5ms.csv", 1.1, 2.0, ["force.x", "force.z", "tread"]) {
        assert!(tread.abs() < 1e-3, "{tread}");
        assert!((-force / (FRICTION * normal) - 1.0).abs() < 1e-6, "{force} {normal}");
        assert!((normal / LOAD - 1.0).abs() < 1e-2, "{normal}");
    }
}

/// What the wheel had is lost in the patch, the brake and the damper; forces that are held over a step err by first order.
#[test]
fn the_energy_goes_into_patch_and_brake() {
    let defect = |name: &str| {
        let stop = table(name);
        let ends = |column: &str| stop.column(column)[stop.column(column).len() - 1];
        let given = stop.column("E_kinetic")[0] - ends("E_kinetic");
        assert!(ends("E_diss") > 0.4 * given && ends("E_brake") > 0.4 * given);
        (1.0 - (ends("E_diss") + ends("E_brake") + ends("E_damper")) / given).abs()
    };
    let (coarse, fine) = (defect("braking-2ms.csv"), defect("braking-0.5ms.csv"));
    assert!(coarse < 5e-3 && fine < 0.5 * coarse, "{coarse} {fine}");
}
