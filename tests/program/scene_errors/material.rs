//! Refusals of the material form, and of what mixes the two forms.

use std::fs;

use asperity::scene::Scene;

use crate::program::scene_errors::{Folder, PATH, assert_refusals};

/// A scene without fault in the material form; each case replaces one of its lines.
const BASE: [&str; 22] = [
    r#"name = "base""#,
    "[layer]",
    "masses = 4",
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

/// The files that a scene names.
fn names(scene: &Scene) -> Vec<String> {
    scene.files.iter().map(|file| file.path.display().to_string()).collect()
}

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
        ("1e-5,5e6\n-1,1\n", format!("compound.csv:2: column 1 (relaxation_time) = \"-1\": {POSITIVE}")),
        ("tau,E\n1,x\n", format!("compound.csv:2: column 2 (E) = \"x\": {NOT_NEGATIVE}")),
        (
            "tau,E\n",
            "compound.csv:1: rows = 0: expected at least one row of numbers: a relaxation time and a modulus: \
             relaxation_time [s], modulus [Pa]; tau_i, E_i, G_i, or relative to E_0: g_i, rel_mod"
                .into(),
        ),
    ] {
        folder.write("compound.csv", table);
        assert_eq!(folder.refusal(&text), format!("{message} {named}"), "{table}");
    }
    let above = folder.refusal(&text.replace("'compound.csv'", "'../compound.csv'"));
    assert_eq!(above, format!("scene.toml:12: material.prony = '../compound.csv': expected {PATH}"));
    folder.write("compound.csv", "1e-5,5e6\n1,1e6");
    fs::write(folder.0.join("scene.toml"), text).unwrap();
    let scene = Scene::load(&folder.0.join("scene.toml")).unwrap();
    assert_eq!(names(&scene), ["compound.csv"]);
    assert_eq!(scene.material.map(|material| material.prony[1].modulus), Some(1e6));
}

#[test]
fn foundations() {
    assert_refusals("foundations", &BASE);
}

#[test]
fn fine_roughness() {
    for section in ["fine roughness", "fine roughness: its forms", "fine roughness: its numbers"] {
        assert_refusals(section, &BASE);
    }
    assert_refusals("fine roughness: the rest of the scene", &BASE);
    // Without friction nothing rubs but by hysteresis.
    let frictionless = |fine: &str| {
        let mut lines = BASE.to_vec();
        lines.splice(14..18, [r#"kind = "flat""#, fine]);
        Folder::new("fine-frictionless").refusal(&lines.join("\n"))
    };
    let expected = "expected hysteresis, or friction with coulomb, shear_strength or rate_shear: else nothing rubs";
    let area = "hurst = 0.8, rms_slope = 1.0, longest = 1e-3, shortest = 1e-5, hysteresis = false";
    let refusal = frictionless(&format!("fine = {{ {area} }}"));
    assert_eq!(refusal, format!("scene.toml:16: surface.fine.hysteresis = false: {expected}"));
    let refusal = frictionless("fine = { rms_slope = 1.0, modulus = 1e7 }");
    assert_eq!(refusal, format!("scene.toml:16: surface.fine = {{ rms_slope = 1.0, modulus = 1e7 }}: {expected}"));
}

#[test]
fn files_of_fine_roughness() {
    let folder = Folder::new("fine-files");
    let scene = |fine: &str| {
        let mut lines = BASE.to_vec();
        let surface = format!("kind = \"flat\"\nfine = {{ {fine} }}");
        lines[14] = &surface;
        lines.join("\n")
    };
    let table = "spectrum = 'psd.csv', longest = 1e-3, shortest = 1e-5";
    let refusal = folder.refusal(&scene(table));
    assert!(refusal.starts_with("scene.toml:16: surface.fine.spectrum = 'psd.csv': cannot be read: "), "{refusal}");
    folder.write("psd.csv", "q [1/mm],C [m^4]\n1,1e-18\n0.5,1e-25\n");
    assert_eq!(
        folder.refusal(&scene(table)),
        "psd.csv:3: column 1 (q [1/mm]) = 500.0 1/m: expected more than 1000.0 1/m, that of the row before: they must rise \
         (file named by surface.fine.spectrum, scene.toml:16)"
    );
    // 2π/q from 6.28 mm to 62.8 µm.
    folder.write("psd.csv", "q [1/mm],C [m^4]\n1,1e-18\n100,1e-25\n");
    let covered = "expected wavelengths that the spectrum covers, 0.006283185307179587 m to 6.283185307179586e-5 m";
    assert_eq!(folder.refusal(&scene(table)), format!("scene.toml:16: surface.fine.shortest = 1e-5: {covered}"));
    let long = "spectrum = 'psd.csv', longest = 7e-3, shortest = 1e-4";
    assert_eq!(folder.refusal(&scene(long)), format!("scene.toml:16: surface.fine.longest = 7e-3: {covered}"));
    folder.write("strain.csv", "strain,storage,loss\n0.001,1,1\n0.1,1.5,1\n");
    let softened = "hurst = 0.8, rms_slope = 1.0, longest = 1e-3, shortest = 1e-5, softening = 'strain.csv'";
    assert_eq!(
        folder.refusal(&scene(softened)),
        "strain.csv:3: column 2 (storage) = \"1.5\": expected a number from 1e-30 to 1.0 \
         (file named by surface.fine.softening, scene.toml:16)"
    );
    folder.write("strain.csv", "strain,storage,loss\n0.001,1,1\n0.1,.5,1\n");
    let good = "spectrum = 'psd.csv', longest = 6e-3, shortest = 7e-5, softening = 'strain.csv'";
    folder.write("scene.toml", &scene(good));
    let found = Scene::load(&folder.0.join("scene.toml")).unwrap();
    assert_eq!(names(&found), ["psd.csv", "strain.csv"]);
    // Of lines of 100 points over 1 mm.
    let line: String = (0..=100).map(|i| format!("{i}e-5,{}e-6\n", i % 7)).collect();
    folder.write("line.csv", &format!("x [m],z [m]\n{line}"));
    let split = |split: &str| {
        let mut lines = BASE.to_vec();
        let surface = format!("kind = 'file'\npath = 'line.csv'\nfine = {{ split = {split}, shortest = 1e-6 }}");
        lines[14] = &surface;
        folder.refusal(&lines.join("\n"))
    };
    let refusal =
        |given: &str, expected: &str| format!("scene.toml:17: surface.fine.split = {given}: expected {expected}");
    assert_eq!(split("2.6e-4"), refusal("2.6e-4", "at most 0.00025 m, a quarter of the line"));
    assert_eq!(split("3.9e-5"), refusal("3.9e-5", "at least 4e-5 m, four steps of the line"));
}
