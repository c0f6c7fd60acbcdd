//! A backing in series with the contacts: what follows exactly from its definition, and derivatives.

use std::fmt::Write as _;
use std::fs;

use super::exact::{folder, go, run_at, value, wrench};
use asperity::patch::{Patch, PatchOutput, PatchRun};

const FLAT: &str = "shape = \"flat\"\nlength = 0.02\nwidth = 0.01\nnx = 5\nny = 3";
/// Stiffnesses of the backing per area, Pa/m: those of a tread block.
const NORMAL: f64 = 7.5e8;
const SHEAR: f64 = 2.5e8;

fn backing() -> String {
    format!("backing = {{ normal = {NORMAL:e}, shear = {SHEAR:e} }}")
}

/// A patch on a table of this folder's, or on a bed of springs of a stiffness (Pa/m) along z and along the plane.
fn parse(name: &str, table: &str, stiffness: Option<f64>, face: &str) -> Patch {
    let folder = folder(&format!("backing-{name}"));
    if let Some(stiffness) = stiffness {
        fs::write(folder.join(table), springs(stiffness)).unwrap();
    }
    let text = format!(
        "name = \"{name}\"\n[table]\npath = \"{table}\"\n[patch]\n{face}\n[fmu]\n\
         outputs = [\"forces\", \"contact\", \"energy\", \"tangent\", \"elements\"]\n"
    );
    Patch::parse(&text, &folder.join("patch.toml")).unwrap()
}

/// The table of a bed of springs, from 1 Pa on, with μ = 0.9 at all speeds.
fn springs(stiffness: f64) -> String {
    let mut text = "# asperity sweep = 1\n# nominal_area = 1 m2\n# rest_separation = 0 m\nspeed [m/s],pressure [Pa],\
                    temperature [K],status,friction [1],separation [m],tangential_stiffness [N/m]\n"
        .to_owned();
    for pressure in (0..=24).map(|i| 10.0_f64.powf(f64::from(i) / 4.0)) {
        for speed in ["1e-4", "50"] {
            let separation = -pressure / stiffness;
            writeln!(text, "{speed},{pressure:e},,steady,0.9,{separation:e},{stiffness:e}").unwrap();
        }
    }
    text
}

/// Pressed by Δ a flat face bears k_n Δ where the contact does not give way.
#[test]
fn a_flat_face_on_a_stiff_contact_bears_what_its_backing_does() {
    let blocks = [backing(), "backing = { height = 8.0e-3, modulus = 6.0e6 }".to_owned()];
    for (i, backing) in blocks.iter().enumerate() {
        let patch = parse(&format!("stiff-{i}"), "stiff.csv", Some(1e19), &format!("{FLAT}\n{backing}"));
        for depth in [1e-6, 4e-5, 9e-4] {
            let mut run = run_at(&patch, [0.0, 0.0, -depth, 0.0, 0.0, 0.0], [0.0; 6], 0.0);
            let normal = wrench(&mut run, &patch)[2];
            // The contact gives way by 1e-10 of it, its interpolant by a little more.
            assert!((normal / (2e-4 * NORMAL * depth) - 1.0).abs() < 1e-9, "{depth}: {normal}");
        }
    }
}

/// p and K at a separation s are those of the contact alone at s + p/k_n, K in series with k_t: below, between and above
/// the pressures of the table, at, between and below its speeds, and at all temperatures.
#[test]
fn a_contact_with_a_backing_is_that_contact_farther_away() {
    let bare = parse("bare", "block.table.csv", None, FLAT);
    let backed = parse("backed", "block.table.csv", None, &format!("{FLAT}\n{}", backing()));
    let at = |patch: &Patch, z: f64, speed: f64| {
        let rates = [speed, 0.0, 0.0, 0.0, 0.0, 0.0];
        let mut run = run_at(patch, [0.0, 0.0, z, 0.0, 0.0, 0.0], rates, 0.0);
        let pressure = value(&mut run, patch, PatchOutput::ElementPressure(0));
        // So short a way that all stick.
        let duration = 1e-12 / speed;
        go(&mut run, patch, duration, rates, 0.0);
        let stiffness = wrench(&mut run, patch)[0].abs() / 1e-12 / 2e-4;
        [pressure, stiffness, value(&mut run, patch, PatchOutput::RealArea)]
    };
    let mut regimes = [0; 3];
    for speed in [1e-5, 1e-3, 0.02, 0.251189, 3.3] {
        for i in 0..120 {
            let height = 1.6e-5 - 1e-6 * f64::from(i);
            let [pressure, stiffness, area] = at(&bare, height, speed);
            regimes[usize::from(pressure > 5e4) + usize::from(pressure > 4e5)] += usize::from(pressure > 0.0);
            let found = at(&backed, height - pressure / NORMAL, speed);
            let expected = [pressure, stiffness * SHEAR / (stiffness + SHEAR), area];
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() <= 1e-9 * expected, "{speed} {height}: {found} {expected}");
            }
        }
    }
    assert!(regimes.iter().all(|&count| count > 10), "{regimes:?}");
}

/// A tread that runs through without slip is sheared by σ times the way since it entered: k_t σ a²/2 per width.
#[test]
fn the_creep_stiffness_of_a_tread_is_that_of_its_backing() {
    let (length, width, creep, speed) = (0.1, 0.2, 1e-4, 10.0);
    let face = format!(
        "shape = \"flat\"\nlength = {length}\nwidth = {width}\nnx = 200\nny = 1\ntransport = true\n{}",
        backing()
    );
    let patch = parse("creep", "stiff.csv", Some(1e15), &face);
    let rates = [speed * (1.0 + creep), 0.0, 0.0, 0.0, 0.0, 0.0];
    let mut run = run_at(&patch, [0.0, 0.0, -4e-4, 0.0, 0.0, 0.0], rates, speed);
    // All cells of the start have left.
    (0..60).for_each(|_| go(&mut run, &patch, 2e-4, rates, speed));
    let force = -wrench(&mut run, &patch)[0];
    let expected = SHEAR * creep * length * length / 2.0 * width;
    assert!((force / expected - 1.0).abs() < 1e-3, "{force} {expected}");
}

/// Directional derivatives and tangents of a tilted face that rests, slides and turns, against difference quotients.
#[test]
fn derivatives_are_difference_quotients() {
    let patch = parse("derivatives", "block.table.csv", None, &format!("{FLAT}\n{}", backing()));
    let pose = [0.0, 0.0, 2e-6, 1e-3, 5e-4, 0.3];
    let rates = [0.02, -0.01, -1e-3, 0.02, -0.01, 0.5];
    let start = || {
        let mut run = run_at(&patch, pose, [0.0; 6], 0.0);
        go(&mut run, &patch, 1e-3, [1e-2, 2e-2, 0.0, 0.0, 0.0, 0.0], 0.0);
        run
    };
    let (duration, steps) = (1e-3, [1e-9, 1e-9, 1e-9, 1e-7, 1e-7, 1e-7]);
    let ends = |shift: [f64; 6]| {
        let mut run = start();
        let rates = std::array::from_fn(|i| rates[i] + shift[i] / duration);
        go(&mut run, &patch, duration, rates, 0.0);
        wrench(&mut run, &patch)
    };
    let mut run = start();
    go(&mut run, &patch, duration, rates, 0.0);
    let largest = |row: usize| if row < 3 { 1e6_f64 } else { 1e4 };
    for column in 0..6 {
        let shift = |sign: f64| std::array::from_fn(|i| if i == column { sign * steps[i] } else { 0.0 });
        let (after, before) = (ends(shift(1.0)), ends(shift(-1.0)));
        for row in 0..6 {
            let quotient = (after[row] - before[row]) / (2.0 * steps[column]);
            let tangent = value(&mut run, &patch, PatchOutput::Tangent(row, column));
            let size = if column < 3 { largest(row) } else { 1e-2 * largest(row) };
            assert!(
                (tangent - quotient).abs() < 1e-5 * size.max(quotient.abs()),
                "{row} {column}: {tangent} {quotient}"
            );
        }
    }
    // Normal forces and moments follow a start elsewhere; the springs do not.
    let variables: Vec<_> = patch.variables().into_iter().filter(|v| v.output == PatchOutput::Force(2)).collect();
    for column in 2..5 {
        let at = |sign: f64| {
            let mut pose = pose;
            pose[column] += sign * steps[column];
            wrench(&mut run_at(&patch, pose, [0.0; 6], 0.0), &patch)[2]
        };
        let direction = std::array::from_fn(|i| f64::from(u8::from(i == column)));
        let mut found = [f64::NAN];
        run_at(&patch, pose, [0.0; 6], 0.0).directional_derivative(&variables, direction, &mut found);
        let quotient = (at(1.0) - at(-1.0)) / (2.0 * steps[column]);
        assert!((found[0] - quotient).abs() < 1e-5 * quotient.abs().max(1.0), "{column}: {found:?} {quotient}");
    }
}

/// A run that is restored goes on as it would have.
#[test]
fn a_state_holds_with_a_backing() {
    let patch = parse("state", "block.table.csv", None, &format!("{FLAT}\n{}", backing()));
    let rates = [0.02, -0.01, -1e-3, 0.0, 0.0, 0.5];
    let mut run = run_at(&patch, [0.0, 0.0, 2e-6, 0.0, 0.0, 0.0], [0.0; 6], 0.0);
    go(&mut run, &patch, 1e-3, rates, 0.0);
    let saved = run.save();
    let mut restored = PatchRun::restore(&patch, &saved).unwrap();
    go(&mut run, &patch, 1e-3, rates, 0.0);
    go(&mut restored, &patch, 1e-3, rates, 0.0);
    assert_eq!(wrench(&mut restored, &patch), wrench(&mut run, &patch));
}
