//! What the section says.

use std::path::PathBuf;

use asperity::scene::Scene;

use super::*;
use crate::files::parse_scene;

const HEAD: &str = "name = 'rough'
layer = { foundation = 'half_space', masses = 32, spacing = 1e-4, width = '10 mm' }
friction = { rate_shear = { strength = '1 MPa', reference_speed = 1.0, sharpness = 0.1 } }
surface = { kind = 'self_affine', length = 0.1, points = 2000, hurst = 0.8, rms = 2e-5, roll_off_wavelength = 5e-3, cut_off_wavelength = 1e-4, seed = 7, fine = { shortest = 2e-6 } }
[material]
density = 1e3
poisson_ratio = 0.5
equilibrium_modulus = 2e6
prony = [{ relaxation_time = 1e-6, modulus = 5e6 }, { relaxation_time = 1e-2, modulus = 1e6 }]
wlf = { c1 = 8.86, c2 = 101.6, reference_temperature = 293.15, temperature = 293.15 }
";

fn parse(section: &str) -> Result<Scene, String> {
    let text = format!("{HEAD}[uncertainty]\n{section}");
    parse_scene(&text, "s.toml".as_ref(), &[]).map_err(|error| error.to_string())
}

fn uncertainty(scene: &Scene) -> Uncertainty {
    Uncertainty::of(scene).unwrap().0
}

fn keys(section: &str) -> Vec<UncertainKey> {
    uncertainty(&parse(section).unwrap_or_else(|error| unreachable!("{section}: {error}"))).keys
}

fn number(key: &str, value: f64, distribution: Distribution) -> UncertainKey {
    UncertainKey { key: key.into(), spread: Spread::Number { value, distribution } }
}

#[test]
fn numbers_are_read_in_the_order_of_their_keys() {
    let found = keys(
        "'material.wlf.temperature' = { absolute = '2 °C' }\n'friction.rate_shear.strength' = { relative = 0.1 }\n\
         'layer.width' = { absolute = '0.2 mm' }\n'surface.fine.shortest' = { factor = 2 }\n\
         'material.prony[2].modulus' = { relative = 0.2 }\n'friction.memory' = { factor = 3.0 }",
    );
    let wanted = [
        number("friction.memory", 50e-6, Distribution::Factor(3.0)),
        number("friction.rate_shear.strength", 1e6, Distribution::Relative(0.1)),
        number("layer.width", 1e-2, Distribution::Absolute(2e-4)),
        number("material.prony[2].modulus", 1e6, Distribution::Relative(0.2)),
        number("material.wlf.temperature", 293.15, Distribution::Absolute(2.0)),
        number("surface.fine.shortest", 2e-6, Distribution::Factor(2.0)),
    ];
    assert_eq!(found, wanted);
}

#[test]
fn what_is_no_number_has_a_spread_of_its_own() {
    let found = keys(
        "surface = 'seed'\n'surface.spectrum' = { relative = 0.2, each = 'decade' }\n'material.prony' = { relative = 0.05 }",
    );
    let spread = |key: &str, spread| UncertainKey { key: key.into(), spread };
    let decades = Some(vec![-6, -5, -4, -3, -2, -1]);
    let wanted = [
        spread("material.prony", Spread::Prony { relative: 0.05, decades: vec![1e-6_f64.log10(), 1e-2_f64.log10()] }),
        spread("surface", Spread::Seed),
        spread("surface.spectrum", Spread::Spectrum { relative: 0.2, decades }),
    ];
    assert_eq!(found, wanted);
}

#[test]
fn what_cannot_be_drawn_is_refused_with_its_place() {
    for (section, message) in [
        (
            "'friction.rate_shear.strenght' = { relative = 0.1 }",
            "s.toml:12: uncertainty.\"friction.rate_shear.strenght\" = friction.rate_shear.strenght: expected the key of a \
             number of the scene; did you mean friction.rate_shear.strength?",
        ),
        ("'material.temperature' = { absolute = 2.0 }", "did you mean material.wlf.temperature?"),
        ("'friction.coulomb' = { relative = 0.1 }", "expected the key of a number that the scene has"),
        ("'layer.masses' = { relative = 0.1 }", "expected the key of a number that may have any value in a range"),
        ("friction.rate_shear.strength = { relative = 0.1 }", "expected the whole path of a number in quotation marks"),
        ("'layer.width' = { relative = 0.1, factor = 2.0 }", "expected { relative = ... }, { factor = ... } or"),
        ("'layer.width' = {}", "expected { relative = ... }, { factor = ... } or"),
        ("'layer.width' = 0.1", "expected { relative = ... }, { factor = ... } or"),
        ("'layer.width' = { relatve = 0.1 }", "relatve"),
        ("'layer.width' = { relative = -0.1 }", "relative = -0.1: expected"),
        ("'layer.width' = { factor = 0.5 }", "factor = 0.5: expected"),
        ("'layer.width' = { absolute = '0.2 MPa' }", "as a text with its unit"),
        ("'layer.origin' = { relative = 0.1 }", "expected { absolute = ... }, for layer.origin is 0.0"),
        ("surface = 'seeds'", "did you mean \"seed\"?"),
        ("covariance = 'none.csv'", "none.csv"),
        (
            "'material.prony' = { relative = 0.1 }\n'material.prony[1].modulus' = { relative = 0.1 }",
            "no such key beside \"material.prony\"",
        ),
    ] {
        let error = parse(section).err().unwrap_or_default();
        assert!(error.starts_with("s.toml:") && error.contains(message), "{section}: {error}");
    }
}

/// The file travels with the scene; a number that is no longer what was fitted is said once.
#[test]
fn fitted_numbers_are_read_from_their_file() {
    let folder = std::env::temp_dir().join(format!("asperity-covariance-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let text = |values: [&str; 2], second: &str| {
        format!(
            "# fitted\nkey,value,scale,friction.rate_shear.strength,{second}\nfriction.rate_shear.strength,{},log,0.01,0\n\
             {second},{},linear,0,4\n",
            values[0], values[1]
        )
    };
    let read = |file: &str, more: &str| {
        std::fs::write(folder.join("fit.csv"), file).unwrap();
        let text = format!("{HEAD}[uncertainty]\ncovariance = 'fit.csv'\n{more}");
        parse_scene(&text, &folder.join("s.toml"), &[]).map_err(|error| error.to_string())
    };
    let scene = read(&text(["1.000002e6", "300"], "material.wlf.temperature"), "").unwrap();
    let covariance = uncertainty(&scene).covariance.unwrap();
    assert_eq!((&scene.files[0].path, &covariance.file), (&PathBuf::from("fit.csv"), &PathBuf::from("fit.csv")));
    let numbers: Vec<(f64, Scale)> = covariance.numbers.iter().map(|number| (number.value, number.scale)).collect();
    assert_eq!(numbers, [(1e6, Scale::Log), (293.15, Scale::Linear)]);
    let said: Vec<&String> = scene.warnings.iter().filter(|warning| warning.contains("fit.csv")).collect();
    assert_eq!(said.len(), 1);
    assert!(said[0].starts_with("fit.csv: material.wlf.temperature was fitted as 300.0 and is 293.15"), "{said:?}");
    let no_fit = "# the scene cannot say this data: friction is off by 50 %\n".to_owned();
    let scene = read(&(no_fit + &text(["1e6", "293.15"], "material.wlf.temperature")), "").unwrap();
    assert!(scene.warnings.iter().any(|text| text.starts_with("fit.csv: the scene cannot say this data")));
    let error = read(&text(["1e6", "1"], "friction.coulomb"), "").unwrap_err();
    assert!(error.contains("fit.csv:4: friction.coulomb"), "{error}");
    let twice = "'material.wlf.temperature' = { absolute = 1.0 }";
    let error = read(&text(["1e6", "293.15"], "material.wlf.temperature"), twice).unwrap_err();
    assert!(error.contains("no such key: the covariance has it"), "{error}");
    std::fs::remove_dir_all(folder).unwrap();
}
