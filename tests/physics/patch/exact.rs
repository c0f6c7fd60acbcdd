//! Exact results: full slip, springs at rest (discs that spin and a rolling brush are on the validation page); and what must hold for every patch.

use std::f64::consts::PI;
use std::fs;
use std::path::PathBuf;

use crate::common::{root, scratch};
use asperity::element::{Element, FrictionTable, PointContact, variables as element_variables};
use asperity::patch::{Patch, PatchMotion, PatchOutput, PatchRun, PatchStart, Pose};
use asperity::simulation::Start;

/// A bed of springs: p = 5e9 Pa/m of approach, μ = 0.9, κ = 1.5e9 N/m³, the same at all speeds. From 2e3 Pa.
const WINKLER: &str = "winkler.table.csv";
const SLOPE: f64 = 5e9;
const FRICTION: f64 = 0.9;
/// N/m³.
const STIFFNESS: f64 = 1.5e9;
/// A pressure of the table, Pa: what lies between is interpolated.
const PRESSURE: f64 = 199_648.95;

const GROUPS: &str =
    "[fmu]\noutputs = [\"forces\", \"dissipation\", \"contact\", \"friction\", \"energy\", \"tangent\"]\n";

pub(super) fn folder(name: &str) -> PathBuf {
    let folder = scratch(&format!("patch-{name}"));
    for table in [WINKLER, "block.table.csv"] {
        fs::copy(root().join("tests/reference/patch").join(table), folder.join(table)).unwrap();
    }
    folder
}

fn parse(name: &str, table: &str, face: &str) -> Patch {
    let text = format!("name = \"{name}\"\n[table]\npath = \"{table}\"\n[patch]\n{face}\n{GROUPS}");
    Patch::parse(&text, &folder(name).join("patch.toml")).unwrap()
}

/// A patch of points: x, y, z and area.
fn points(name: &str, table: &str, points: &[[f64; 4]]) -> Patch {
    let lines: Vec<String> = points.iter().map(|[x, y, z, a]| format!("{x:e},{y:e},{z:e},{a:e}")).collect();
    let folder = folder(name);
    fs::write(folder.join("points.csv"), format!("x,y,z,area\n{}\n", lines.join("\n"))).unwrap();
    let face = "shape = \"points\"\npath = \"points.csv\"";
    let text = format!("name = \"{name}\"\n[table]\npath = \"{table}\"\n[patch]\n{face}\n{GROUPS}");
    Patch::parse(&text, &folder.join("patch.toml")).unwrap()
}

pub(super) fn run_at(patch: &Patch, pose: [f64; 6], rates: [f64; 6], transport_speed: f64) -> PatchRun {
    let start = PatchStart {
        time: 0.0,
        pose: Pose::from_coordinates(pose),
        rates,
        transport_speed,
        temperature: patch.temperature(),
    };
    PatchRun::new(patch, &start).unwrap()
}

pub(super) fn go(run: &mut PatchRun, patch: &Patch, duration: f64, rates: [f64; 6], transport_speed: f64) {
    run.advance(&PatchMotion { duration, rates, transport_speed, temperature: patch.temperature() }).unwrap();
}

pub(super) fn value(run: &mut PatchRun, patch: &Patch, output: PatchOutput) -> f64 {
    let variables: Vec<_> = patch.variables().into_iter().filter(|variable| variable.output == output).collect();
    let mut values = [f64::NAN];
    run.evaluate(&variables, &mut values);
    values[0]
}

pub(super) fn wrench(run: &mut PatchRun, patch: &Patch) -> [f64; 6] {
    std::array::from_fn(|i| value(run, patch, if i < 3 { PatchOutput::Force(i) } else { PatchOutput::Moment(i - 3) }))
}

/// Separation at a pressure.
fn separation(pressure: f64) -> f64 {
    -pressure / SLOPE
}

#[test]
fn in_full_slip_the_force_is_mu_n_against_the_motion() {
    let patch = parse("slip", WINKLER, "shape = \"flat\"\nlength = 0.02\nwidth = 0.01\nnx = 5\nny = 3");
    let rates = [0.3, -0.4, 0.0, 0.0, 0.0, 0.0];
    let mut run = run_at(&patch, [0.0, 0.0, separation(PRESSURE), 0.0, 0.0, 0.0], rates, 0.0);
    go(&mut run, &patch, 0.01, rates, 0.0);
    let [x, y, z, ..] = wrench(&mut run, &patch);
    assert!((z / (PRESSURE * 2e-4) - 1.0).abs() < 1e-9, "{z}");
    for (force, direction) in [(x, 0.6), (y, -0.8)] {
        assert!((force + FRICTION * z * direction).abs() < 1e-9 * z, "{x} {y} {z}");
    }
    assert!((value(&mut run, &patch, PatchOutput::Friction) - FRICTION).abs() < 1e-9);
}

/// Springs K = κA along the plane and kA across, and their moments of area about the pose's point.
#[test]
fn tangents_at_rest_are_those_of_springs() {
    let (length, width, nx, ny) = (0.02_f64, 0.01_f64, 5.0_f64, 4.0_f64);
    let patch = parse("rest", WINKLER, "shape = \"flat\"\nlength = 0.02\nwidth = 0.01\nnx = 5\nny = 4");
    let mut run = run_at(&patch, [0.0, 0.0, separation(PRESSURE), 0.0, 0.0, 0.0], [0.0; 6], 0.0);
    go(&mut run, &patch, 1.0, [0.0; 6], 0.0);
    let area = length * width;
    // Σ x² A over the middles of n cells.
    let second = |length: f64, n: f64| area * length * length / 12.0 * (1.0 - 1.0 / (n * n));
    let (about_y, about_x) = (second(length, nx), second(width, ny));
    let mut tangent = |row: usize, column: usize| value(&mut run, &patch, PatchOutput::Tangent(row, column));
    let slope = -tangent(2, 2) / area;
    // The slope of a monotone interpolant of few points.
    assert!((slope / SLOPE - 1.0).abs() < 1e-2, "{slope}");
    let cases = [
        ((0, 0), -STIFFNESS * area),
        ((1, 1), -STIFFNESS * area),
        ((3, 3), -slope * about_x),
        ((4, 4), -slope * about_y),
        ((5, 5), -STIFFNESS * (about_x + about_y)),
        ((0, 1), 0.0),
        ((2, 0), 0.0),
    ];
    // The face turns about a point in its own plane.
    for ((row, column), expected) in cases {
        let found = tangent(row, column);
        assert!((found - expected).abs() <= 1e-6 * expected.abs().max(1e-9), "{row} {column}: {found} {expected}");
    }
}

/// In steady rolling and sliding what the body and the tread put in is what is lost.
#[test]
fn the_power_of_body_and_tread_is_lost() {
    let face = "shape = \"cylinder\"\nradius = 0.3\nlength = 0.0144\nwidth = 0.01\nnx = 24\nny = 2\ntransport = true";
    let patch = parse("power", WINKLER, face);
    let (speed, rates) = (2.0, [2.05, 0.03, 0.0, 0.0, 0.0, 0.0]);
    let mut run = run_at(&patch, [0.0, 0.0, 0.29994, 0.0, 0.0, 0.0], rates, speed);
    // A whole number of cells a step, so that every step is as the last.
    let h = 3.0 * 0.0006 / speed;
    (0..30).for_each(|_| go(&mut run, &patch, h, rates, speed));
    let [x, y, ..] = wrench(&mut run, &patch);
    let tread = value(&mut run, &patch, PatchOutput::TransportForce);
    let power = x * rates[0] + y * rates[1] + tread * speed;
    let lost = value(&mut run, &patch, PatchOutput::Power);
    // Forces ripple as cells pass; P_diss is a mean.
    assert!((power + lost).abs() < 0.02 * lost && lost > 0.1, "{power} {lost}");
}

/// A straight path at constant height, in one step and in many uneven ones.
#[test]
fn a_straight_path_may_be_cut_anyhow() {
    let patch = parse("split", "block.table.csv", "shape = \"flat\"\nlength = 0.02\nwidth = 0.01\nnx = 6\nny = 4");
    let rates = [0.02, 0.013, 0.0, 0.0, 0.0, 0.0];
    let run = |first: [f64; 6], steps: &[f64]| {
        let mut run = run_at(&patch, [0.0, 0.0, 8e-6, 2e-3, 0.0, 0.3], first, 0.0);
        go(&mut run, &patch, 3e-4, first, 0.0);
        steps.iter().for_each(|&h| go(&mut run, &patch, h, rates, 0.0));
        (wrench(&mut run, &patch), value(&mut run, &patch, PatchOutput::Energy))
    };
    // Loaded across first, so that the springs turn into the motion.
    for first in [[0.0; 6], [-0.02, 0.013, 0.0, 0.0, 0.0, 0.0]] {
        for total in [2e-4, 1e-3, 4e-3] {
            let (whole, lost) = run(first, &[total]);
            let (cut, lost_in_cuts) = run(first, &[0.1 * total, 0.37 * total, 0.03 * total, 0.5 * total]);
            for i in 0..6 {
                assert!((whole[i] - cut[i]).abs() < 1e-10 * whole[2], "{whole:?} {cut:?}");
            }
            assert!((lost - lost_in_cuts).abs() < 1e-10 * lost.max(1e-6), "{lost} {lost_in_cuts}");
        }
    }
}

/// F_x, F_z and E_diss of one element of a patch and of the point-contact element, moved along x and z at `rates` (m/s) for
/// the times beside them (s), after every motion.
fn one_element_and_the_other(height: f64, motions: &[([f64; 2], f64)]) -> Vec<[[f64; 2]; 3]> {
    let path = root().join("tests/reference/patch/block.table.csv");
    let table = FrictionTable::load(&path).unwrap();
    let (area, rest) = (table.load.area(), table.rest_separation);
    let patch = points("one", "block.table.csv", &[[0.0, 0.0, 0.0, area]]);
    let rates = |[x, z]: [f64; 2]| [x, 0.0, z, 0.0, 0.0, 0.0];
    let first = motions[0].0;
    let mut run = run_at(&patch, [0.0, 0.0, height, 0.0, 0.0, 0.0], rates(first), 0.0);
    let start = Start { w: height - rest, u_rate: first[0], ..Start::default() };
    let mut element = Element::new(&PointContact::new(table.clone()), &start).unwrap();
    let variables = element_variables(&table);
    let mut after = |&([x, z], duration): &([f64; 2], f64)| {
        element.advance(duration, x, z).unwrap();
        go(&mut run, &patch, duration, rates([x, z]), 0.0);
        let mut values = vec![0.0; variables.len()];
        element.evaluate(&variables, &mut values);
        let of = |name: &str| values[variables.iter().position(|variable| variable.name == name).unwrap()];
        let [f_x, _, f_z, ..] = wrench(&mut run, &patch);
        let lost = value(&mut run, &patch, PatchOutput::Energy);
        [[f_x, of("F_x")], [f_z, of("F_z")], [lost, of("E_diss")]]
    };
    motions.iter().map(&mut after).collect()
}

/// One element of a patch, moved along x at constant height, is the point-contact element.
#[test]
fn one_element_is_the_point_contact_element() {
    let speeds = [(0.05, 1e-4), (0.05, 3e-3), (-0.02, 2e-4), (-0.02, 5e-3), (0.0, 1e-3), (0.7, 1e-2)];
    for height in [3e-6, 8e-6, 1.5e-5] {
        for pairs in one_element_and_the_other(height, &speeds.map(|(x, time)| ([x, 0.0], time))) {
            for [found, expected] in pairs {
                // The law, precomputed, is met to 1e-9 and better.
                assert!((found - expected).abs() <= 1e-9 * expected.abs().max(1e-6), "{height}: {found} {expected}");
            }
        }
    }
}

/// Where its height changes too, to second order: pressed and lifted while it slides to and fro, past touch and lift.
#[test]
fn one_element_is_the_point_contact_element_closely_where_its_height_changes() {
    let motions: Vec<_> = (0..160)
        .map(|i| {
            let phase = f64::from(i) * PI / 40.0;
            ([0.02 * phase.cos(), -2e-3 * (2.0 * phase).sin() - 4e-4], 5e-4)
        })
        .collect();
    let pairs = one_element_and_the_other(2.5e-5, &motions);
    for i in 0..3 {
        let largest = pairs.iter().map(|pairs| pairs[i][1].abs()).fold(0.0, f64::max);
        assert!(largest > 0.0);
        for pairs in &pairs {
            let [found, expected] = pairs[i];
            // A part of a step is of second order in its change of the law.
            assert!((found - expected).abs() <= 5e-4 * largest, "{i}: {found} {expected} of {largest}");
        }
    }
}
