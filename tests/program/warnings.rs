//! What would be wrong in silence is told: links that are no rubber, points without a result, friction that no rubber has,
//! columns and cards that are not taken.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::{Table, asperity, assert_names, ended, scratch};

fn told(arguments: &[&str], folder: &Path) -> (i32, String, String) {
    ended(asperity().current_dir(folder).args(arguments))
}

/// A seal of 3 mm on waves of 0.2 mm, which the rubber touches all over.
fn seal(folder: &Path, friction: &str) -> PathBuf {
    let path = folder.join("seal.toml");
    let scene = format!(
        "name = 'seal'\nlayer = {{ masses = 100, spacing = '20 µm', thickness = '3 mm', width = '5 mm' }}\n\
         material = {{ density = 1200, poisson_ratio = 0.5, equilibrium_modulus = '6 MPa', \
         prony = [{{ modulus = '20 MPa', relaxation_time = '1 ms' }}] }}\n\
         surface = {{ kind = 'sinusoid', amplitude = '1 µm', wavelength = '200 µm' }}\nfriction = {{ {friction} }}\n\
         [[excitation]]\nduration = '2 ms'\nw_rate = '-10 mm/s'\n[[excitation]]\nduration = 2e-4\nu_rate = 0.05\n"
    );
    fs::write(&path, scene).unwrap();
    path
}

/// Springs are 46 and 137 times as stiff as the layer that a thickness means; in full contact friction is that of Coulomb
/// on their slopes (r + (r - 1)/μ², r = 1.00002) and what they lose, and a result.
#[test]
fn a_thickness_means_a_layer_and_springs_are_told() {
    let folder = scratch("warnings-springs");
    seal(&folder, "coulomb = 0.2");
    let sweep = ["sweep", "seal.toml", "--speeds", "1mm/s,1m/s", "--pressures", "1MPa", "-o", "t.csv"];
    let (status, said, warned) = told(&sweep, &folder);
    assert!(status == 0 && said.contains("+ full contact") && !warned.contains("springs"), "{said}{warned}");
    let table = Table::read(&folder.join("t.csv"));
    assert!((table.number(1, "friction") - 0.2003).abs() < 1e-4 && table.text(1, "status") == "full contact");
    for command in [&["describe", "seal.toml"][..], &["simulate", "seal.toml", "-o", "r.csv"]] {
        let (_, _, warned) = told(&[command, &["--set", "layer.foundation=springs"]].concat(), &folder);
        assert_names(warned, "45.610 | along z | 136.787 | along x");
    }
    // An element needs a stiffness.
    let swept = told(&["sweep", "seal.toml", "--speeds", "1", "--pressures", "1e6,2e6", "-o", "e.csv"], &folder);
    let packed = told(&["pack", "--table", "e.csv", "-o", "e.fmu"], &folder);
    assert_names(packed.2, "full contact | no stiffness");
    assert_eq!(swept.0, 0);
}

/// At 0.3 Pa, meant as MPa, a single point touches, which is no contact.
#[test]
fn points_without_a_result_are_counted_and_named() {
    let folder = scratch("warnings-points");
    seal(&folder, "coulomb = 0.2");
    let data = |name: &str, rows: &str| fs::write(folder.join(name), format!("speed [m/s],pressure [Pa],mu\n{rows}"));
    data("none.csv", "0.1,1e-4,0.2\n1,1e-4,0.21\n").unwrap();
    data("some.csv", "0.1,1e-4,0.2\n0.1,1e6,0.2\n1,1e6,0.21\n").unwrap();
    let free = ["--free", "friction.coulomb=0.05..0.5"];
    let calibrate = |data: &str| told(&[&["calibrate", "seal.toml", "--data", data][..], &free].concat(), &folder);
    let none = calibrate("none.csv");
    assert_names(none.2, "2 of 2 measurements | line 2 (0.1 m/s, 0.0001 Pa): no stiffness | single point");
    let some = calibrate("some.csv");
    assert_names(some.2, "1 of 3 measurements | line 2 (0.1 m/s, 0.0001 Pa): no stiffness");
    assert_names(some.1, "0.20365");
    assert_eq!((none.0, some.0), (1, 0));
    let loads = ["--speeds", "0.1,1", "--pressures", "1e-4,1e6", "-o", "t.csv"];
    assert_eq!(told(&[&["sweep", "seal.toml"][..], &loads].concat(), &folder).0, 1);
    let compared = told(&["compare", "t.csv", "--data", "some.csv"], &folder);
    assert_names(compared.2, "1 of 3 measurements | line 2 (0.1 m/s, 0.0001 Pa): | no result");
    assert_eq!(compared.0, 0);
}

/// Shear on a profile that counts as smooth between its points.
#[test]
fn friction_that_no_rubber_has_is_told_with_the_key_that_is_missing() {
    let folder = scratch("warnings-friction");
    seal(&folder, "shear_strength = 5e6");
    fs::write(folder.join("mu.csv"), "speed [m/s],pressure [Pa],mu\n0.1,1e6,0.2\n1,1e6,0.21\n").unwrap();
    for command in [
        &["sweep", "seal.toml", "--speeds", "0.1", "--pressures", "1e6", "-o", "t.csv"][..],
        &["contact", "seal.toml", "--speed", "0.1", "--pressure", "1e6", "-o", "c.svg"],
        &["simulate", "seal.toml", "-o", "r.csv"],
        &["calibrate", "seal.toml", "--data", "mu.csv", "--free", "friction.shear_strength=4e6..1e7"],
    ] {
        // The run presses so hard that shear is little of the load.
        let why = if command[0] == "simulate" { "whole nominal area" } else { "friction is " };
        assert_names(told(command, &folder).2, &format!("{why} | surface.fine"));
    }
}

/// The excitation begins under a load that presses; the FMU's input of it starts at 0, where the constant part pulls, and a
/// carrier on nothing is nowhere at rest.
#[test]
fn start_values_from_which_no_run_begins_are_told() {
    let folder = scratch("warnings-start");
    let scene = |load: &str| {
        format!(
            "name = 'hung'\nlayer = {{ masses = 4, spacing = 1e-4, mass = 1e-7, initial = 'relaxed', \
             vertical = {{ stiffness = 2e3, damping = 8e-3 }}, horizontal = {{ stiffness = 1e3, damping = 8e-3 }} }}\n\
             surface = {{ kind = 'flat' }}\nfriction = {{ coulomb = 0.3 }}\n\
             carrier = {{ z = {{ mass = 1e-4, load = {load}, initial = 'equilibrium' }} }}\n\
             [[excitation]]\nduration = 1e-3\nload = 0.05\nu_rate = 0.05\n"
        )
    };
    let told_of = |load: &str| {
        fs::write(folder.join("hung.toml"), scene(load)).unwrap();
        let (status, _, warned) = told(&["pack", "hung.toml", "-o", "hung.fmu", "--library", "hung.toml"], &folder);
        assert_eq!(status, 0, "{warned}");
        warned
    };
    assert_names(told_of("-0.02"), "not initialise | carrier.z.initial = \"equilibrium\" | -0.02 N");
    assert!(!told_of("0.02").contains("initialise"));
}
