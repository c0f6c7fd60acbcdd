//! The example scenes/patch-mujoco: a wheel in MuJoCo that brakes on a contact patch alone, which slip warms.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use crate::common::{Table, asperity, library, mujoco_python, root, run, scratch};

/// N: of 300 kg.
const LOAD: f64 = 300.0 * 9.81;
/// K, of the road.
const TEMPERATURE: f64 = 293.15;
/// W²s/(m⁴ K²): conductivity, density and capacity of tread.toml; and its share.
const KRC: f64 = 0.25 * 1150.0 * 1700.0;
const SHARE: f64 = 0.05;
/// Stops, the finer step.
const LOCKED: [&str; 2] = ["locked-warm-0.5ms.csv", "locked-cold-0.5ms.csv"];
const SLIPPING: [&str; 2] = ["slip-warm-0.5ms.csv", "slip-cold-0.5ms.csv"];

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

/// The distances of the stops in the order of braking.csv: slipping and locked, with heat and without, both steps.
fn distances() -> Vec<f64> {
    table("braking.csv").column("distance")
}

/// The loads are held over a step: 1 mm in 2 m.
#[test]
fn the_distance_is_that_of_half_the_step() {
    for pair in distances().chunks(2) {
        assert!((pair[0] / pair[1] - 1.0).abs() < 2e-3, "{pair:?}");
    }
}

/// The tread of a locked wheel stays and warms; that of one that slips leaves.
#[test]
fn heat_lengthens_the_way_of_a_locked_wheel() {
    let [_, slip_warm, _, slip_cold, _, locked_warm, _, locked_cold] = distances()[..] else { panic!() };
    assert!((1.02..1.06).contains(&(locked_warm / locked_cold)), "{locked_warm} {locked_cold}");
    assert!((1.0..1.003).contains(&(slip_warm / slip_cold)), "{slip_warm} {slip_cold}");
    let friction = |name: &str| {
        let rows = between(name, 0.5, 0.6, ["force.x", "force.z"]);
        rows.iter().map(|[x, z]| -x / z).sum::<f64>() / rows.len() as f64
    };
    let [warm, cold] = LOCKED.map(friction);
    assert!(warm < 0.97 * cold, "{warm} {cold}");
    for row in between("locked-warm-0.5ms.csv", 0.3, 0.5, ["contact.temperature_mean", "contact.temperature_largest"]) {
        assert!(TEMPERATURE + 13.0 < row[0] && row[0] < row[1] && row[1] < TEMPERATURE + 30.0, "{row:?}");
    }
    for [warmest] in between("slip-warm-0.5ms.csv", 0.0, 1.0, ["contact.temperature_largest"]) {
        assert!(warmest < TEMPERATURE + 1.5, "{warmest}");
    }
}

/// All cells of a locked wheel have been in contact since it locked: their mean warms by what the patch has lost on the
/// area, ∫ χq/√(πkρc(t - t')) dt'.
#[test]
fn a_locked_tread_warms_by_what_it_loses() {
    let (end, columns) = (0.5, ["time", "E_diss", "contact.nominal_area", "contact.temperature_mean"]);
    let rows = between("locked-warm-0.5ms.csv", 0.06, end, columns);
    let last = rows[rows.len() - 1];
    let rise = |pair: &[[f64; 4]]| {
        let ([from, before, ..], [to, after, area, _]) = (pair[0], pair[1]);
        let roots = (last[0] - from).max(0.0).sqrt() - (last[0] - to).max(0.0).sqrt();
        2.0 * SHARE * (after - before) / (to - from) / area * roots / (PI * KRC).sqrt()
    };
    let expected: f64 = rows.windows(2).map(rise).sum();
    // The kernel's 1 %; cells that came and went while the wheel was locking.
    assert!(((last[3] - TEMPERATURE) / expected - 1.0).abs() < 2e-2, "{} {expected}", last[3] - TEMPERATURE);
}

/// Cold, a locked wheel has the friction that the table has at its speed; at 10 % of slip that at a tenth of it, but
/// for the cells that do not slip yet.
#[test]
fn a_cold_wheel_has_the_friction_of_the_table() {
    let table = Table::read(&root().join("scenes/patch-mujoco/tread.table.csv"));
    let [speeds, pressures, temperatures, friction] =
        ["speed [m/s]", "pressure [Pa]", "temperature [K]", "friction [1]"].map(|name| table.column(name));
    let rows =
        || (0..speeds.len()).filter(|&row| temperatures[row] == TEMPERATURE && (1e5..3e5).contains(&pressures[row]));
    // The least and the largest at the speeds around one, for the pressures in the contact.
    let range = |speed: f64| {
        let near = rows().filter(|&row| (speeds[row] / speed).ln().abs() < 0.8).map(|row| friction[row]);
        near.fold((f64::INFINITY, 0.0_f64), |(low, high), mu| (low.min(mu), high.max(mu)))
    };
    for (names, share, slack) in [(LOCKED, 1.0, 2e-3), (SLIPPING, 0.1, 2e-2)] {
        for [x, z, speed] in between(names[1], 0.2, 0.6, ["force.x", "force.z", "speed"]) {
            let (low, high) = range(share * speed);
            let found = -x / z;
            assert!(low - slack < found && found < high + slack, "{share} {speed}: {found}, {low} to {high}");
            assert!((z / LOAD - 1.0).abs() < 1e-2, "{z}");
        }
    }
}

/// What the wheel had is lost in the patch, the brake and the damper; forces held over a step err by first order.
#[test]
fn the_energy_goes_into_patch_and_brake() {
    let defect = |name: &str| {
        let stop = table(name);
        let ends = |column: &str| stop.column(column)[stop.column(column).len() - 1];
        let given = stop.column("E_kinetic")[0] - ends("E_kinetic");
        assert!(ends("E_diss") > 0.05 * given && ends("E_brake") > 0.05 * given);
        (1.0 - (ends("E_diss") + ends("E_brake") + ends("E_damper")) / given).abs()
    };
    for [coarse, fine] in [["locked-warm-2ms.csv", LOCKED[0]], ["slip-warm-2ms.csv", SLIPPING[0]]] {
        let (coarse, fine) = (defect(coarse), defect(fine));
        assert!(coarse < 5e-3 && fine < 0.5 * coarse, "{coarse} {fine}");
    }
}
