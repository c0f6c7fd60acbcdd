//! The material form through the FMU: its complex modulus as measured, and its temperature as a parameter.

use std::fs;

use crate::common::scenes::SceneText;
use crate::fmu::fmi_interface::master::*;

/// Two masses over the wave.
fn rubber() -> SceneText {
    SceneText::rubber(2, 1.0e-4, 1.0e-3, 1.0e-2)
        .with("material.equilibrium_modulus = 2e6\nmaterial.viscosity = 10.0")
        .prony(&[(5.0e6, 1.0e-4)])
        .with("surface = { kind = 'file', path = 'profile.csv', periodic = true }")
        .with("friction = { coulomb = 0.3, shear_strength = 1e4 }")
        .outputs(&["forces", "dissipation", "contact", "elements"])
}

fn scene(temperature: f64) -> String {
    rubber().wlf([7.52, 119.75, 293.15], temperature).text()
}

/// Presses and slides for some steps and returns all outputs after each.
fn slide(fmu: &Fmu) -> Vec<Vec<u64>> {
    const H: f64 = 2e-5;
    let step = |i: u32| {
        let (w, u) = (-1e-7 * f64::from(i), 2e-6 * f64::from(i));
        assert_eq!((fmu.set_real("w", w), fmu.set_real("u", u)), (OK, OK));
        assert_eq!((fmu.set_rate("w", -5e-3), fmu.set_rate("u", 0.1)), (OK, OK));
        assert_eq!(fmu.step(H * f64::from(i), H), OK, "{:?}", fmu.messages());
        fmu.bits()
    };
    (0..20).map(step).collect()
}

#[test]
fn a_temperature_set_is_the_same_as_one_in_the_scene() {
    let given = slide(&Fmu::running_with(&scene(330.0)));
    let fmu = Fmu::initialising_with(&scene(293.15));
    let cold = fmu.real("material.wlf.temperature");
    assert_eq!((fmu.set_real("material.wlf.temperature", 330.0), fmu.exit()), (OK, OK));
    assert_eq!((cold, fmu.real("material.wlf.temperature")), (293.15, 330.0));
    assert_eq!(slide(&fmu), given);
    assert_ne!(slide(&Fmu::running_with(&scene(293.15))), given);
    assert_eq!(fmu.set_real("material.wlf.temperature", 300.0), ERROR);
    // The run saved is that of the temperature set, in an instance that starts from the scene's.
    let other = Fmu::initialising_with(&scene(293.15));
    other.thaw(&fmu.frozen());
    assert_eq!((other.bits(), other.real("material.wlf.temperature")), (fmu.bits(), 330.0));
}

#[test]
fn a_temperature_without_a_shift_is_an_error_at_the_end_of_the_initialisation() {
    let fmu = Fmu::initialising_with(&scene(293.15));
    // Of its springs.
    assert!(fmu.message().starts_with("foundation = \"springs\": "));
    assert_eq!(fmu.set_real("material.wlf.temperature", 170.0), OK);
    assert_eq!(fmu.exit(), ERROR);
    let message = fmu.message();
    let expected = "fmi2ExitInitializationMode: material.wlf.temperature = 170.0: expected more than ";
    assert!(message.starts_with(expected), "{message}");
    assert_eq!((fmu.reset(), fmu.setup(0.0), fmu.enter()), (OK, OK, OK));
    // In between anything goes: only what is left in the end counts.
    assert_eq!(fmu.set_real("material.wlf.temperature", 170.0), OK);
    assert_eq!(fmu.set_real("material.wlf.reference_temperature", 200.0), OK);
    assert_eq!(fmu.exit(), OK);
    assert_eq!(fmu.set_real("material.wlf.c2", -1.0), ERROR);
}

#[test]
fn the_links_of_a_material_are_no_parameters() {
    let fmu = Fmu::of(&scene(293.15), false);
    let names: Vec<String> = fmu.variables.entries().map(|(_, entry)| entry.name.clone()).collect();
    let is_there = |name: &str| names.iter().any(|other| other == name);
    assert!(["layer.mass", "layer.vertical.stiffness", "friction.shear_force"].iter().all(|name| !is_there(name)));
    assert!(["material.prony[1].modulus", "friction.shear_strength", "contact.area"].iter().all(|name| is_there(name)));
}

#[test]
fn another_compound_beside_the_scene_is_another_fmu() {
    let text = rubber().wlf([7.52, 119.75, 293.15], 293.15).set("material.prony", "compound.csv").text();
    let folder = Folder::with_scene("compound", &text);
    let guid = |compound: &str| {
        let series = format!("relaxation_time [s],modulus [Pa]\n{compound}\n");
        fs::write(folder.path().join("compound.csv"), series).unwrap();
        folder.description().0
    };
    assert_ne!(guid("1e-4,5e6"), guid("1e-4,5.1e6"));
}
