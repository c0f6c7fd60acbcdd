#![allow(clippy::unwrap_used)]

use std::path::Path;

use super::{Parameter, Value};
use crate::scene::{Scene, Unit};

const SCENE: &str = r#"
name = "all"
[layer]
masses = 2
spacing = 1e-4
mass = 1e-7
roughness = { kind = "points", z = [0.0, 2e-6] }
[layer.vertical]
stiffness = 2000
maxwell = [{ stiffness = 1000, relaxation_time = 1e-4 }, { stiffness = 500, relaxation_time = 1e-5 }]
[layer.lateral_x]
damping = 0.5
[layer.lateral_z]
[surface]
kind = "sinusoid"
amplitude = 1e-5
wavelength = 1e-3
[friction]
shear_force = 0
rate_shear = { force = 1e-4, reference_speed = 6e-3, sharpness = 0.1 }
"#;

fn scene() -> Scene {
    Scene::parse(SCENE, Path::new("all.toml")).unwrap()
}

fn bare() -> Scene {
    let text = "name='b'\nlayer = {masses = 1, spacing = 0.5, mass = 1}\nsurface = {kind = 'flat'}";
    Scene::parse(text, Path::new("bare.toml")).unwrap()
}

fn refusal(scene: &mut Scene, name: &str, text: &str) -> String {
    let before = scene.clone();
    let message = scene.set_by_name(name, text).unwrap_err().to_string();
    assert_eq!(*scene, before);
    message
}

#[test]
fn has_what_the_scene_names_in_its_order() {
    let names: Vec<String> = scene().parameters().into_iter().map(Parameter::name).collect();
    let expected = [
        "layer.clearance",
        "layer.mass",
        "layer.initial",
        "layer.vertical.stiffness",
        "layer.vertical.maxwell[1].stiffness",
        "layer.vertical.maxwell[1].relaxation_time",
        "layer.vertical.maxwell[2].stiffness",
        "layer.vertical.maxwell[2].relaxation_time",
        "layer.lateral_x.damping",
        "friction.shear_force",
        "friction.memory",
        "friction.rate_shear.force",
        "friction.rate_shear.reference_speed",
        "friction.rate_shear.sharpness",
        "friction.rate_shear.creep_speed",
        "solver.method",
        "solver.relative_tolerance",
        "solver.absolute_tolerance",
        "solver.max_steps",
        "input.extrapolation",
        "input.interval",
    ];
    assert_eq!(names, expected);
}

#[test]
fn a_bare_scene_has_few() {
    assert_eq!(bare().parameters().len(), 9);
}

#[test]
fn gives_values_units_and_descriptions() {
    let scene = scene();
    let [time, damping] = ["layer.vertical.maxwell[2].relaxation_time", "layer.lateral_x.damping"]
        .map(|name| scene.parameter_named(name));
    assert_eq!(scene.parameter(time.unwrap()), Value::Real(1e-5));
    assert_eq!(time.unwrap().unit(), Unit::Second);
    assert_eq!(damping.unwrap().unit(), Unit::NewtonSecondPerMeter);
    assert_eq!(scene.parameter(Parameter::new("solver.max_steps")), Value::Integer(10_000_000));
    assert_eq!(scene.parameter(Parameter::METHOD), Value::Text("event".into()));
    assert_eq!(scene.parameter(Parameter::INITIAL), Value::Text("relaxed".into()));
    assert_eq!(scene.parameter(Parameter::EXTRAPOLATION), Value::Text("linear".into()));
    assert!(scene.parameters().iter().all(|parameter| !parameter.description().is_empty()));
}

#[test]
fn sets_every_parameter() {
    let fine = [SELF_AFFINE, "rms_slope = 1.0, modulus = 1e7"].map(on_fine_roughness);
    for mut scene in [scene(), rubber()].into_iter().chain(fine) {
        for parameter in scene.parameters() {
            let other = match (parameter, scene.parameter(parameter)) {
                (_, Value::Real(number)) => Value::Real(0.01 + 0.5 * number),
                (_, Value::Integer(number)) => Value::Integer(number - 1),
                (Parameter::INITIAL, _) => Value::Text("undeformed".into()),
                (Parameter::EXTRAPOLATION, _) => Value::Text("hold".into()),
                (_, text) => text,
            };
            scene.set_parameter(parameter, other.clone()).unwrap();
            assert_eq!(scene.parameter(parameter), other, "{}", parameter.name());
        }
    }
}

#[test]
fn the_absolute_tolerance_follows_until_it_is_set() {
    let mut scene = scene();
    let height = 2e-5 + 2e-6;
    let absolute = |scene: &Scene| match scene.parameter(Parameter::new("solver.absolute_tolerance")) {
        Value::Real(number) => number,
        other => unreachable!("{other}"),
    };
    assert!((scene.height() - height).abs() < 1e-15);
    assert!((absolute(&scene) - 1e-6 * height).abs() < 1e-20);
    scene.set_by_name("solver.relative_tolerance", "1e-9").unwrap();
    assert!((absolute(&scene) - 1e-9 * height).abs() < 1e-20);
    scene.set_by_name("solver.absolute_tolerance", "1e-12").unwrap();
    scene.set_by_name("solver.relative_tolerance", "1e-3").unwrap();
    assert_eq!(absolute(&scene), 1e-12);
    assert_eq!(bare().absolute_tolerance(), 1e-6 * 0.5);
}

/// A millionth of the reference speed, whatever that becomes, until it is set itself.
#[test]
fn the_creep_speed_follows_the_reference_speed() {
    let mut scene = scene();
    let creep = |scene: &Scene| scene.parameter(scene.parameter_named("friction.rate_shear.creep_speed").unwrap());
    assert_eq!(creep(&scene), Value::Real(1e-6 * 6e-3));
    scene.set_by_name("friction.rate_shear.reference_speed", "2.0").unwrap();
    assert_eq!(creep(&scene), Value::Real(1e-6 * 2.0));
    // No smaller than it could be set.
    scene.set_by_name("friction.rate_shear.reference_speed", "1e-28").unwrap();
    assert_eq!(creep(&scene), Value::Real(1e-30));
    scene.set_by_name("friction.rate_shear.creep_speed", "1e-5").unwrap();
    scene.set_by_name("friction.rate_shear.reference_speed", "1e-3").unwrap();
    assert_eq!(creep(&scene), Value::Real(1e-5));
    let unit = |name: &str| scene.parameter_named(name).unwrap().unit();
    assert_eq!(unit("friction.rate_shear.creep_speed"), Unit::MeterPerSecond);
    assert_eq!(unit("friction.rate_shear.reference_speed"), Unit::MeterPerSecond);
    assert_eq!(unit("friction.rate_shear.force"), Unit::Newton);
    assert_eq!(unit("friction.rate_shear.sharpness"), Unit::One);
}

#[test]
fn refuses_what_the_reader_refuses() {
    let (any, positive, other) = ("-1e30 to 1e30", "a number from 1e-30 to 1e30", "0 or a number from 1e-30 to 1e30");
    let cases = [
        ("layer.mass", "0", "0.0", positive),
        ("layer.mass", "nan", "NaN", positive),
        ("layer.mass", "heavy", "heavy", positive),
        ("layer.clearance", "inf", "inf", any),
        ("layer.vertical.stiffness", "-1", "-1.0", other),
        ("layer.lateral_x.damping", "-1", "-1.0", other),
        ("layer.vertical.maxwell[1].relaxation_time", "0", "0.0", positive),
        ("solver.relative_tolerance", "1", "1.0", "1e-30 to 0.1"),
        ("solver.absolute_tolerance", "0", "0.0", positive),
        ("solver.max_steps", "0", "0", "1 to 2147483647"),
        ("solver.max_steps", "3e9", "3e9", "1 to 2147483647"),
        ("solver.method", "fast", "\"fast\"", "\"event\", \"step\", \"auto\""),
        ("friction.rate_shear.force", "-1", "-1.0", other),
        ("friction.rate_shear.reference_speed", "0", "0.0", positive),
        ("friction.rate_shear.sharpness", "-0.1", "-0.1", other),
        ("friction.rate_shear.creep_speed", "0", "0.0", positive),
        ("layer.initial", "cold", "\"cold\"", "\"relaxed\", \"undeformed\""),
        ("input.extrapolation", "no", "\"no\"", "\"linear\", \"hold\""),
    ];
    for (name, text, given, allowed) in cases {
        let message = refusal(&mut scene(), name, text);
        assert!(message.starts_with(&format!("{name} = {given}: ")) && message.ends_with(allowed), "{message}");
    }
}

#[test]
fn refuses_the_wrong_type() {
    let mut scene = scene();
    for value in [Value::Integer(1), Value::Text("1".into())] {
        let message = scene.set_parameter(Parameter::new("layer.mass"), value).unwrap_err().to_string();
        assert!(message.ends_with("expected a number from 1e-30 to 1e30"), "{message}");
    }
    assert!(scene.set_parameter(Parameter::new("solver.max_steps"), Value::Real(1.0)).is_err());
    assert!(scene.set_parameter(Parameter::METHOD, Value::Real(1.0)).is_err());
}

#[test]
fn an_unknown_name_gets_similar_ones_or_all() {
    let scene = &mut scene();
    assert_eq!(refusal(scene, "layer.mas", "1"), "layer.mas: unknown; allowed: layer.mass");
    assert_eq!(refusal(scene, "max_steps", "1"), "max_steps: unknown; allowed: solver.max_steps");
    assert!(refusal(scene, "layer.spacing", "1").contains("allowed: layer.clearance, layer.mass, layer.initial, "));
    assert!(!refusal(scene, "friction.coulomb", "1").contains("= 1"));
}

#[test]
fn a_parameter_that_the_scene_lacks_cannot_be_set() {
    let mut bare = bare();
    let before = bare.clone();
    for parameter in scene().parameters() {
        if !bare.parameters().contains(&parameter) {
            assert_eq!(bare.parameter(parameter), Value::Real(0.0));
            let error = bare.set_parameter(parameter, Value::Real(1.0)).unwrap_err();
            assert_eq!(error.name(), parameter.name());
        }
    }
    assert_eq!(bare, before);
}

const MATERIAL: &str = r#"
name = "rubber"
[layer]
masses = 2
spacing = 1e-4
thickness = 5e-3
width = 1e-2
[material]
density = 1100
poisson_ratio = 0.49
equilibrium_modulus = 2e6
viscosity = 10
prony = [{ modulus = 5e6, relaxation_time = 1e-5 }]
wlf = { c1 = 7.52, c2 = 119.75, reference_temperature = 293.15, temperature = 313.15 }
[surface]
kind = "flat"
[friction]
shear_strength = 1e5
"#;

fn rubber() -> Scene {
    Scene::parse(MATERIAL, Path::new("rubber.toml")).unwrap()
}

#[test]
fn a_material_has_its_own_and_none_of_the_links() {
    let expected = [
        ("layer.clearance", Unit::Meter),
        ("layer.initial", Unit::One),
        ("layer.thickness", Unit::Meter),
        ("material.density", Unit::KilogramPerCubicMeter),
        ("material.poisson_ratio", Unit::One),
        ("material.equilibrium_modulus", Unit::Pascal),
        ("material.viscosity", Unit::PascalSecond),
        ("material.prony[1].modulus", Unit::Pascal),
        ("material.prony[1].relaxation_time", Unit::Second),
        ("material.wlf.c1", Unit::One),
        ("material.wlf.c2", Unit::Kelvin),
        ("material.wlf.reference_temperature", Unit::Kelvin),
        ("material.wlf.temperature", Unit::Kelvin),
        ("friction.shear_strength", Unit::Pascal),
    ];
    let parameters = rubber().parameters();
    for (parameter, (name, unit)) in parameters.iter().zip(expected) {
        assert_eq!((parameter.name().as_str(), parameter.unit()), (name, unit));
        assert!(!parameter.description().is_empty());
    }
    assert_eq!(parameters.len(), expected.len() + 6);
}

#[test]
fn links_follow_what_is_set_of_a_material() {
    let mut hot = rubber();
    let before = hot.link(crate::scene::LinkKind::Vertical).unwrap();
    hot.set_by_name("material.prony[1].modulus", "1e7").unwrap();
    let after = hot.link(crate::scene::LinkKind::Vertical).unwrap();
    assert_eq!(after.maxwell[0].stiffness, 2.0 * before.maxwell[0].stiffness);
    assert_eq!(after.stiffness, before.stiffness);
}

#[test]
fn a_temperature_that_has_no_shift_is_found_once_all_is_set() {
    let mut scene = rubber();
    scene.set_by_name("material.wlf.temperature", "173").unwrap();
    let told = scene.check().unwrap_err().to_string();
    assert!(told.starts_with("material.wlf.temperature = 173.0: expected more than "), "{told}");
    scene.set_by_name("material.wlf.reference_temperature", "200").unwrap();
    assert_eq!(scene.check(), Ok(()));
    let refused = refusal(&mut scene, "material.wlf.temperature", "0");
    assert_eq!(refused, "material.wlf.temperature = 0.0: expected a number from 1e-30 to 1e30");
}

/// The rubber on roughness below its profile, with heat.
fn on_fine_roughness(fine: &str) -> Scene {
    let text = MATERIAL.replace("kind = \"flat\"", &format!("kind = \"flat\"\nfine = {{ {fine} }}"));
    let heat =
        if fine.contains("modulus") { "" } else { "heat = { conductivity = 0.25, capacity = 1700, share = 0.9 }\n" };
    Scene::parse(&text.replace("[surface]", &format!("{heat}[surface]")), Path::new("rubber.toml")).unwrap()
}

const SELF_AFFINE: &str = "hurst = 0.8, rms_slope = 1.0, longest = 1e-3, shortest = 1e-5";

#[test]
fn roughness_below_the_profile_has_its_numbers() {
    let names = |fine: &str| {
        let all = on_fine_roughness(fine).parameters().into_iter();
        let own = all.filter(|parameter| parameter.name().starts_with("surface."));
        own.map(|parameter| (parameter.name()["surface.fine.".len()..].to_owned(), parameter.unit()))
            .collect::<Vec<_>>()
    };
    let expected =
        |names: &[(&str, Unit)]| names.iter().map(|(name, unit)| ((*name).to_owned(), *unit)).collect::<Vec<_>>();
    let of_bands = [("creep_speed", Unit::MeterPerSecond), ("softening", Unit::One)];
    let lengths = [("longest", Unit::Meter), ("shortest", Unit::Meter)];
    let law = [("hurst", Unit::One), ("rms_slope", Unit::One)];
    assert_eq!(names(SELF_AFFINE), expected(&[&law[..], &lengths, &of_bands].concat()));
    assert_eq!(names("rms_slope = 1.0, modulus = 1e7"), expected(&[law[1], ("modulus", Unit::Pascal)]));
    let heat: Vec<_> = ["conductivity", "capacity", "share"].map(|name| format!("material.heat.{name}")).into();
    let all = on_fine_roughness(SELF_AFFINE).parameters().into_iter().map(Parameter::name);
    assert_eq!(all.filter(|name| name.starts_with("material.heat")).collect::<Vec<_>>(), heat);
}

#[test]
fn the_gradient_follows_what_is_set_of_roughness_below_the_profile() {
    let mut scene = on_fine_roughness(SELF_AFFINE);
    assert_eq!(scene.parameter(Parameter::new("surface.fine.creep_speed")), Value::Real(1e-6));
    scene.set_by_name("surface.fine.rms_slope", "0.5").unwrap();
    assert!((scene.fine_gradient() - 0.5).abs() < 1e-12);
}

/// Both wavelengths may be set one after the other.
#[test]
fn wavelengths_that_clash_are_found_once_all_is_set() {
    let mut scene = on_fine_roughness(SELF_AFFINE);
    scene.set_by_name("surface.fine.longest", "1e-6").unwrap();
    let told = scene.check().unwrap_err().to_string();
    assert_eq!(told, "surface.fine.longest = 1e-6: expected more than 1e-5 m, the shortest");
    scene.set_by_name("surface.fine.shortest", "1e-7").unwrap();
    assert_eq!(scene.check(), Ok(()));
}

/// Those that elements, patches and masters use by themselves are keys.
#[test]
fn parameters_by_name_have_their_keys() {
    let constants = [
        (Parameter::INITIAL, "one of \"relaxed\", \"undeformed\""),
        (Parameter::TEMPERATURE, "a number from 1e-30 to 1e30"),
        (Parameter::METHOD, "one of \"event\", \"step\", \"auto\""),
        (Parameter::RELATIVE_TOLERANCE, "a number from 1e-30 to 0.1"),
        (Parameter::EXTRAPOLATION, "one of \"linear\", \"hold\""),
        (Parameter::TABLE_EXTRAPOLATION, "one of \"refuse\", \"hold\""),
        (Parameter::DAMPING, "0 or a number from 1e-30 to 1.0"),
        (Parameter::REFINE, "a whole number from 1 to 1000"),
        (Parameter::new("patch.backing.normal"), "a number from 1e-30 to 1e30"),
        (Parameter::new("patch.heat.share"), "a number from 1e-30 to 1.0"),
    ];
    for (parameter, allowed) in constants {
        assert_eq!(parameter.allowed(), allowed, "{}", parameter.path());
    }
}
