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

/// Each case: the line replaced, what stands there instead, the line refused, the rest of the message.
fn assert_refused(name: &str, cases: &[(usize, &str, usize, &str)]) {
    let folder = Folder::new(name);
    for &(line, replacement, refused_line, message) in cases {
        let mut lines = BASE;
        lines[line - 1] = replacement;
        let refusal = folder.refusal(&lines.join("\n"));
        assert_eq!(refusal, format!("scene.toml:{refused_line}: {message}"), "{replacement}");
    }
}

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
    let layer = "expected no such key beside [material]; instead: thickness, width, foundation";
    assert_refused(
        "material-mixed",
        &[
            (4, "spacing = 1.0e-4\nmass = 1.0e-7", 5, &format!("layer.mass = 1.0e-7: {layer}")),
            (7, "[layer.lateral_x]\n[material]", 7, &format!("layer.lateral_x = [layer.lateral_x]: {layer}")),
            (
                17,
                "shear_force = 1.0",
                17,
                "friction.shear_force = 1.0: expected no such key beside [material]; instead: real_area, shear_strength",
            ),
            (
                17,
                "rate_shear = { force = 1.0, reference_speed = 1.0, sharpness = 1.0 }",
                17,
                "friction.rate_shear.force = 1.0: expected no such key beside [material]; instead: strength",
            ),
            (
                21,
                "until_force = 1.0",
                21,
                "excitation[1].until_force = 1.0: expected no such key beside [material]; instead: pressure, pressure_rate, pressure_sine, temperature, until_pressure",
            ),
        ],
    );
}

#[test]
fn keys_of_the_material_form_without_a_material() {
    let layer = "expected no such key without [material]; instead: mass, vertical, horizontal, lateral_x, lateral_z";
    assert_refusals(
        "direct-mixed",
        &[
            (7, "thickness = 1.0", 7, &format!("layer.thickness = 1.0: {layer}")),
            (7, "width = 1.0", 7, &format!("layer.width = 1.0: {layer}")),
            (
                18,
                "shear_strength = 1e5",
                18,
                "friction.shear_strength = 1e5: expected no such key without [material]; instead: shear_force",
            ),
            (
                18,
                "rate_shear = { strength = 1e6, reference_speed = 1, sharpness = 1 }",
                18,
                "friction.rate_shear.strength = 1e6: expected no such key without [material]; instead: force",
            ),
            (
                31,
                "until_pressure = 2e5",
                31,
                "excitation[1].until_pressure = 2e5: expected no such key without [material]; instead: until_force",
            ),
        ],
    );
}

#[test]
fn keys_unknown_or_missing() {
    let keys = "density, poisson_ratio, equilibrium_modulus, viscosity, prony, wlf";
    let wlf = "c1, c2, reference_temperature, temperature";
    assert_refused(
        "material-keys",
        &[
            (5, "", 2, &format!("layer.thickness: missing; {POSITIVE}")),
            (6, "", 2, &format!("layer.width: missing; {POSITIVE}")),
            (8, "", 7, &format!("material.density: missing; {POSITIVE}")),
            (9, "", 7, "material.poisson_ratio: missing; expected 0 or a number from 1e-30 to 0.5"),
            (10, "", 7, &format!("material.equilibrium_modulus: missing; {NOT_NEGATIVE}")),
            (
                12,
                "",
                7,
                "material.prony: missing; expected an array of tables, or the path of a CSV file beside the scene with \
                 relaxation_time (s) and modulus (Pa)",
            ),
            (11, "eta = 1", 11, &format!("material.eta: unknown; allowed: {keys}")),
            (
                12,
                "prony = [{ modulus = 1.0, tau = 1.0 }]",
                12,
                "material.prony[1].tau: unknown; allowed: modulus, relaxation_time",
            ),
            (13, "wlf = { c1 = 7.0, c3 = 1.0 }", 13, &format!("material.wlf.c3: unknown; allowed: {wlf}")),
            (
                13,
                "wlf = { c1 = 7.0, c2 = 1.0, reference_temperature = 293.15 }",
                13,
                &format!("material.wlf.temperature: missing; {POSITIVE}"),
            ),
        ],
    );
}

#[test]
fn values_out_of_range() {
    let wlf = |c2: f64, temperature: f64| {
        format!("wlf = {{ c1 = 7.5, c2 = {c2:?}, reference_temperature = 300.0, temperature = {temperature:?} }}")
    };
    assert_refused(
        "material-values",
        &[
            (5, "thickness = 0.0", 5, &format!("layer.thickness = 0.0: {POSITIVE}")),
            (8, "density = -1.0", 8, &format!("material.density = -1.0: {POSITIVE}")),
            (9, "poisson_ratio = 0.6", 9, "material.poisson_ratio = 0.6: expected 0 or a number from 1e-30 to 0.5"),
            (11, "viscosity = -1.0", 11, &format!("material.viscosity = -1.0: {NOT_NEGATIVE}")),
            (
                12,
                "prony = [{ modulus = 1.0, relaxation_time = 0.0 }]",
                12,
                &format!("material.prony[1].relaxation_time = 0.0: {POSITIVE}"),
            ),
            (13, &wlf(0.0, 300.0), 13, &format!("material.wlf.c2 = 0.0: {POSITIVE}")),
            (18, "shear_strength = -1.0", 18, &format!("friction.shear_strength = -1.0: {NOT_NEGATIVE}")),
            (
                22,
                "until_pressure = nan",
                22,
                "excitation[1].until_pressure = nan: expected a number from -1e30 to 1e30",
            ),
        ],
    );
}

#[test]
fn values_that_do_not_go_together() {
    let wlf = |temperature: f64| {
        format!("wlf = {{ c1 = 7.5, c2 = 100.0, reference_temperature = 300.0, temperature = {temperature:?} }}")
    };
    let pole = "expected more than material.wlf.reference_temperature - c2 = 200.00 K, where the shift has its pole";
    assert_refused(
        "material-together",
        &[
            (13, &wlf(200.0), 13, &format!("material.wlf.temperature = 200.0: {pole}")),
            (13, &wlf(150.0), 13, &format!("material.wlf.temperature = 150.0: {pole}")),
            (
                13,
                &wlf(200.5),
                7,
                &format!("damping of the vertical link (carrier to mass), from the material = inf: {NOT_NEGATIVE}"),
            ),
            (8, "density = 1e-29", 7, &format!("mass of a point mass, from the material = 5e-38: {POSITIVE}")),
        ],
    );
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
    assert_refused(
        "material-foundation",
        &[
            (
                6,
                "width = 1.0e-2\nfoundation = \"mattress\"",
                7,
                "layer.foundation = \"mattress\": expected one of \"springs\", \"half_space\", \"layer\"",
            ),
            (
                6,
                "width = 1.0e-2\nfoundation = \"half_space\"",
                5,
                "layer.thickness = 5.0e-3: expected no such key with foundation = \"half_space\", which has no end",
            ),
            (5, "foundation = \"layer\"", 2, "layer.thickness: missing; expected a number from 1e-30 to 1e30"),
        ],
    );
}

#[test]
fn real_areas() {
    let one = "expected rms_slope and wavelength, or rms_slope and modulus, or cut_off_wavelength alone";
    let of = |keys: &str| format!("coulomb = 0.3\nreal_area = {{ {keys} }}");
    let refused = |keys: &str, expected: &str| format!("friction.real_area = {{ {keys} }}: {expected}");
    for (keys, expected) in [
        ("rms_slope = 1.0", one),
        ("rms_slope = 1.0, wavelength = 1e-5, modulus = 1e6", one),
        ("wavelength = 1e-5", one),
        (
            "cut_off_wavelength = 1e-6",
            "expected cut_off_wavelength with a self_affine surface alone, whose law it continues",
        ),
    ] {
        assert_refused("material-real-area", &[(17, &of(keys), 18, &refused(keys, expected))]);
    }
    let negative = "friction.real_area.rms_slope = -1.0: expected 0 or a number from 1e-30 to 1e30";
    assert_refused("material-real-area", &[(17, &of("rms_slope = -1.0, modulus = 1e6"), 18, negative)]);
}
