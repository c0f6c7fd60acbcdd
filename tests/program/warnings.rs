//! What would be wrong in silence is told: links that are no rubber, points without a result, friction that no rubber has,
//! columns and cards that are not taken.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use crate::common::{Table, asperity, scratch};

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn told(arguments: &[&str], folder: &Path) -> Output {
    asperity().current_dir(folder).args(arguments).output().unwrap()
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
    let done = told(&["sweep", "seal.toml", "--speeds", "1mm/s,1m/s", "--pressures", "1MPa", "-o", "t.csv"], &folder);
    let (said, warned) = (text(&done.stdout), text(&done.stderr));
    assert!(done.status.success() && said.contains("+ full contact") && !warned.contains("springs"), "{said}{warned}");
    let table = Table::read(&folder.join("t.csv"));
    assert!((table.number(1, "friction") - 0.2003).abs() < 1e-4 && table.text(1, "status") == "full contact");
    for command in [&["describe", "seal.toml"][..], &["simulate", "seal.toml", "-o", "r.csv"]] {
        let warned = text(&told(&[command, &["--set", "layer.foundation=springs"]].concat(), &folder).stderr);
        let expected = "the links are 45.610 times as stiff along z, and 136.787 times along x, as a layer of rubber";
        assert!(warned.contains(expected), "{command:?} {warned}");
    }
    // An element needs a stiffness.
    let swept = told(&["sweep", "seal.toml", "--speeds", "1", "--pressures", "1e6,2e6", "-o", "e.csv"], &folder);
    let packed = text(&told(&["pack", "--table", "e.csv", "-o", "e.fmu"], &folder).stderr);
    assert!(swept.status.success() && packed.contains("is in full contact, which has no stiffness"), "{packed}");
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
    let expected = "2 of 2 measurements are left out: line 2 (0.1 m/s, 0.0001 Pa): no stiffness: a single point";
    assert!(none.status.code() == Some(1) && text(&none.stderr).contains(expected), "{}", text(&none.stderr));
    let some = calibrate("some.csv");
    let expected = "1 of 3 measurements are left out: line 2 (0.1 m/s, 0.0001 Pa): no stiffness";
    assert!(some.status.success() && text(&some.stderr).contains(expected), "{}", text(&some.stderr));
    assert!(text(&some.stdout).contains("0.20365"), "{}", text(&some.stdout));
    let loads = ["--speeds", "0.1,1", "--pressures", "1e-4,1e6", "-o", "t.csv"];
    assert_eq!(told(&[&["sweep", "seal.toml"][..], &loads].concat(), &folder).status.code(), Some(1));
    let compared = told(&["compare", "t.csv", "--data", "some.csv"], &folder);
    let expected = "1 of 3 measurements are left out: line 2 (0.1 m/s, 0.0001 Pa): the table has no result beside it";
    assert!(compared.status.success() && text(&compared.stderr).contains(expected), "{}", text(&compared.stderr));
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
        let warned = text(&told(command, &folder).stderr);
        // The run presses so hard that shear is little of the load.
        let expected =
            if command[0] == "simulate" { "the whole nominal area touches over the run" } else { "friction is " };
        assert!(warned.contains(expected), "{command:?} {warned}");
        assert!(warned.contains("give surface.fine the waves that the profile lacks"), "{command:?} {warned}");
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
        let done = told(&["pack", "hung.toml", "-o", "hung.fmu", "--library", "hung.toml"], &folder);
        assert!(done.status.success(), "{}", text(&done.stderr));
        text(&done.stderr)
    };
    let warned = told_of("-0.02");
    let expected =
        "the FMU does not initialise at its start values: carrier.z.initial = \"equilibrium\" under a load of -0.02 N";
    assert!(warned.contains(expected) && warned.contains("set others before initialisation ends"), "{warned}");
    assert!(!told_of("0.02").contains("initialise"));
}
