//! Refusals of the material form, and of what mixes the two forms.

use std::fs;

use asperity::scene::Scene;

use crate::scene_errors::{Folder, PATH, assert_refusals};

/// A scene without fault in the material form; each case replaces one of its lines.
const BASE: [&str; 22] = [
    r#"name = "base""#,
    "[layer]",
    "masses = 3",
    "spacing = 1.0e-4",
    "thickness = 5.0e-3",
    "width = 1.0e-2",
    "[material]",
    "density = 1100.0",
    "poisson_ratio = 0.49",
    "equilibrium_modulus = 2.0e6",
    "viscosity = 10.0",
    "prony = [ { modulus = 5.0e6, relaxation_time = 1.0e-5 } ]",
    "wlf = { c1 = 7.52, c2 = 119.75, reference_temperature = 293.15, temperature = 313.15 }",
    "[surface]",
    r#"kind = "flat""#,
    "[friction]",
    "coulomb = 0.3",
    "shear_strength = 1.0e5",
    "[[excitation]]",
    "duration = 1.0e-3",
    "w_rate = -0.1",
    "until_pressure = 2.0e5",
];

const POSITIVE: &str = "expected a number from 1e-30 to 1e30";
const NOT_NEGATIVE: &str = "expected 0 or a number from 1e-30 to 1e30";

#[test]
fn the_base_is_a_scene() {
    let scene = Scene::parse(&BASE.join("\n"), "base.toml".as_ref()).unwrap();
    assert_eq!((scene.layer.thickness, scene.layer.width, scene.layer.mass), (Some(5e-3), Some(1e-2), None));
    assert_eq!(scene.material.map(|material| material.prony.len()), Some(1));
}

#[test]
fn keys_of_the_direct_form_beside_a_material() {
    assert_refusals("keys of the direct form beside a material", &BASE);
}

#[test]
fn keys_of_the_material_form_without_a_material() {
    assert_refusals("keys of a material without one", &super::BASE);
}

#[test]
fn keys_unknown_or_missing() {
    assert_refusals("keys of a material unknown or missing", &BASE);
}

#[test]
fn values_out_of_range() {
    assert_refusals("values of a material out of range", &BASE);
}

#[test]
fn values_that_do_not_go_together() {
    assert_refusals("values that do not go together", &BASE);
}

#[test]
fn files_of_a_prony_series() {
    let folder = Folder::new("material-file");
    let mut lines = BASE;
    lines[11] = "prony = 'compound.csv'";
    let text = lines.join("\n");
    let named = "(file named by material.prony, scene.toml:12)";
    let refusal = folder.refusal(&text);
    assert!(refusal.starts_with("scene.toml:12: material.prony = 'compound.csv': cannot be read: "), "{refusal}");
    for (table, message) in [
        ("1e-5,5e6\n-1,1\n", format!("compound.csv:2: relaxation_time = \"-1\": {POSITIVE}")),
        ("tau,E\n1,x\n", format!("compound.csv:2: modulus = \"x\": {NOT_NEGATIVE}")),
        ("tau,E\n", "compound.csv:1: terms = 0: expected at least one term".into()),
    ] {
        folder.write("compound.csv", table);
        assert_eq!(folder.refusal(&text), format!("{message} {named}"), "{table}");
    }
    let above = folder.refusal(&text.replace("'compound.csv'", "'../compound.csv'"));
    assert_eq!(above, format!("scene.toml:12: material.prony = '../compound.csv': expected {PATH}"));
    folder.write("compound.csv", "1e-5,5e6\n1,1e6");
    fs::write(folder.0.join("scene.toml"), text).unwrap();
    let scene = Scene::load(&folder.0.join("scene.toml")).unwrap();
    assert_eq!(scene.files, [std::path::PathBuf::from("compound.csv")]);
    assert_eq!(scene.material.map(|material| material.prony[1].modulus), Some(1e6));
}

#[test]
fn foundations() {
    assert_refusals("foundations", &BASE);
}

#[test]
fn fine_roughness() {
    assert_refusals("fine roughness", &BASE);
}
