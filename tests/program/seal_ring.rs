//! The example scenes/seal-ring: a ring of elements under a shaft that turns, moves to and fro and leans.

use std::fs;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use crate::common::{Table, asperity, difference, largest, root, run, scratch};

/// m: the ring is out of the shaft's centre by this much.
const OFFSET: f64 = 5e-4;
/// The row from which the shaft turns steadily, and the rows of two seconds, after which all is as it was.
const STEADY: usize = 100;
const PERIOD: usize = 400;

fn example() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| root().join("scenes/seal-ring"))
}

/// The example's result file.
fn ring() -> &'static Table {
    static RING: OnceLock<Table> = OnceLock::new();
    RING.get_or_init(|| {
        let folder = scratch("seal-ring");
        let (motion, output) = (folder.join("motion.csv"), folder.join("ring.csv"));
        fs::write(&motion, run(Command::new("python3").arg("-B").arg(example().join("ring.py")).arg("motion")))
            .unwrap();
        let mut simulate = asperity();
        simulate.args(["simulate", "--patch"]).arg(example().join("ring.toml")).arg("--motion").arg(motion);
        run(simulate.arg("-o").arg(&output));
        Table::read(&output)
    })
}

/// The values of a column over the steady motion.
fn steady(name: &str) -> Vec<f64> {
    ring().column(name).split_off(STEADY)
}

/// An element's radius from the shaft's axis (m), area (m²), and over the steady motion its pressure and traction (Pa).
struct Element {
    radius: f64,
    area: f64,
    pressure: Vec<f64>,
    traction: Vec<f64>,
}

fn elements() -> Vec<Element> {
    let points = Table::read(&example().join("ring.points.csv"));
    let [x, y, area] = ["x", "y", "area"].map(|name| points.column(name));
    let element = |i: usize| {
        let field = |name: &str| steady(&format!("element[{}].{name}", i + 1));
        let (along, across) = (field("traction.x"), field("traction.y"));
        let traction = along.iter().zip(across).map(|(x, y)| x.hypot(y)).collect();
        Element { radius: (x[i] + OFFSET).hypot(y[i]), area: area[i], pressure: field("pressure"), traction }
    };
    (0..x.len()).map(element).collect()
}

/// The sum over the elements of what `part` makes of each and its area, row by row.
fn sums(elements: &[Element], part: impl Fn(&Element, usize) -> f64) -> Vec<f64> {
    let sum = |row| elements.iter().map(|element| element.area * part(element, row)).sum();
    (0..elements[0].pressure.len()).map(sum).collect()
}

/// The table's friction coefficients at the speeds about 2π 20 mm/s.
fn friction() -> RangeInclusive<f64> {
    let table = Table::read(&example().join("seal.table.csv"));
    let rows = table.column("speed").into_iter().zip(table.column("friction"));
    let values: Vec<f64> = rows.filter(|(speed, _)| [0.1, 0.316228].contains(speed)).map(|(_, value)| value).collect();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    least..=largest(&values)
}

/// All slip, and slip is round the shaft's axis wherever the ring's middle is.
#[test]
fn the_torque_is_that_of_friction_at_the_radius_of_each_element() {
    let elements = elements();
    let (torque, normal) = (steady("moment.z"), steady("force.z"));
    let sum = sums(&elements, |element, row| -element.traction[row] * element.radius);
    // Rounding, and directions of slip that follow from the step before.
    assert!(difference(&torque, &sum) < 1e-8 * largest(&torque));
    let sum = sums(&elements, |element, row| element.pressure[row]);
    assert!(difference(&normal, &sum) < 1e-9 * largest(&normal));
    let even = sums(&elements, |element, row| element.pressure[row] * element.radius);
    let coefficients: Vec<f64> = torque.iter().zip(even).map(|(torque, even)| -torque / even).collect();
    let allowed = friction();
    assert!(coefficients.iter().all(|coefficient| allowed.contains(coefficient)), "{allowed:?}: {coefficients:?}");
}

/// Pressures of a place come back after two seconds, so over them springs and heights give back what they took.
#[test]
fn the_heat_is_the_work_of_the_torque() {
    let [turned, torque, heat] = ["yaw", "moment.z", "E_diss"].map(steady);
    for start in [0, PERIOD] {
        let end = start + PERIOD;
        let work: f64 = (start..end).map(|i| -0.5 * (torque[i] + torque[i + 1]) * (turned[i + 1] - turned[i])).sum();
        let heat = heat[end] - heat[start];
        // A step cuts the law's change with the pressure by second order.
        assert!((heat / work - 1.0).abs() < 2e-4, "{heat} J of {work} J");
    }
}

/// Leaning towards x the ring bears more at x > 0, where it moves along y; at the other side less.
#[test]
fn a_lean_pushes_the_shaft_to_the_side() {
    let mean = |name: &str| steady(name)[..PERIOD].iter().sum::<f64>() / PERIOD as f64;
    let [ahead, aside, normal, pitch] = ["force.x", "force.y", "force.z", "moment.y"].map(mean);
    assert!(pitch < -0.2 * normal * 0.02 && aside < -0.2 * normal, "{pitch} {aside}");
    // A bias of the pressure by p_1 cos α gives the moment N r p_1/2p and the side force μ N p_1/2p: μ = F/(M/r), with r from
    // 19.7 to 20.3 mm, the coefficient within 1 %.
    assert!((aside / pitch * 0.02 / 1.05 - 1.0).abs() < 0.03, "{}", aside / pitch * 0.02);
    assert!(ahead.abs() < 1e-3 * aside.abs(), "{ahead}");
    // The pressure of a place goes up and down by the lean and the shaft's motion; none is free, none beyond the table.
    let pressures = steady("element[1].pressure");
    let least = pressures.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(least > 1e4 && largest(&pressures) > 5.0 * least, "{least}");
    assert_eq!(largest(&steady("contact.beyond")), 0.0);
}
