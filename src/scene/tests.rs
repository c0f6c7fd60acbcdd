#![allow(clippy::unwrap_used)]

use std::path::{Path as FilePath, PathBuf};

use super::{Extrapolation, Initial, Link, MaxwellElement, Method, OutputGroup, Path, Phase, Scene, Solver};

fn parse(text: &str) -> Scene {
    Scene::parse(text, FilePath::new("scene.toml")).unwrap_or_else(|error| unreachable!("{error}"))
}

/// A scene of four masses with what is given in `layer` and `rest`.
fn scene(layer: &str, rest: &str) -> Scene {
    parse(&format!("name = 'test'\n[layer]\nmasses = 4\nspacing = 0.25\nmass = 1\n{layer}\n{rest}"))
}

const FLAT: &str = "[surface]\nkind = 'flat'";

#[test]
fn what_is_left_out_is_absent() {
    let scene = scene("", FLAT);
    let layer = &scene.layer;
    assert_eq!(
        (layer.masses, layer.spacing, layer.origin, layer.clearance, layer.mass),
        (4, 0.25, 0.0, 0.0, Some(1.0))
    );
    assert_eq!((layer.initial, &layer.roughness), (Initial::Relaxed, &Vec::new()));
    assert_eq!([&layer.vertical, &layer.horizontal, &layer.lateral_x, &layer.lateral_z], [&None; 4]);
    assert_eq!((&scene.description, &scene.friction, scene.extrapolation), (&None, &None, Extrapolation::Linear));
    let defaults = Solver {
        method: Method::Event,
        relative_tolerance: 1e-6,
        absolute_tolerance: None,
        max_steps: 10_000_000,
        reduce: 0.0,
    };
    assert_eq!(scene.solver, defaults);
    assert_eq!(scene.outputs, [OutputGroup::Forces, OutputGroup::Dissipation]);
    assert_eq!((scene.excitation.len(), scene.files.len(), scene.warnings.len()), (0, 0, 0));
}

#[test]
fn reads_links_and_keeps_what_they_name() {
    let links = "[layer.vertical]\nstiffness = 2000\nmaxwell = [{ stiffness = 0, relaxation_time = 1e-4 }]\n\
                 [layer.lateral_x]\ndamping = 0.0\n[layer.lateral_z]\n";
    let layer = scene(links, FLAT).layer;
    let maxwell = vec![MaxwellElement { stiffness: 0.0, relaxation_time: 1e-4 }];
    assert_eq!(layer.vertical, Some(Link { stiffness: Some(2000.0), damping: None, maxwell }));
    assert_eq!(layer.lateral_x, Some(Link { damping: Some(0.0), ..Link::default() }));
    assert_eq!((layer.horizontal, layer.lateral_z), (None, Some(Link::default())));
}

#[test]
fn reads_settings() {
    let rest = "[friction]\ncoulomb = 1\n[solver]\nmethod = 'event'\nrelative_tolerance = 1e-3\n\
                absolute_tolerance = 1e-9\nmax_steps = 1_000\n[input]\nextrapolation = 'hold'\n\
                [fmu]\noutputs = ['elements', 'forces', 'solver']";
    let scene = scene("initial = 'undeformed'", &format!("{FLAT}\n{rest}"));
    let friction = scene.friction.clone().unwrap();
    assert_eq!((friction.coulomb, friction.shear_force), (Some(1.0), None));
    assert_eq!((scene.solver.relative_tolerance, scene.solver.max_steps), (1e-3, 1000));
    assert_eq!((scene.solver.absolute_tolerance, scene.absolute_tolerance()), (Some(1e-9), 1e-9));
    assert_eq!((scene.layer.initial, scene.extrapolation), (Initial::Undeformed, Extrapolation::Hold));
    assert_eq!(scene.outputs, [OutputGroup::Forces, OutputGroup::Solver, OutputGroup::Elements]);
}

#[test]
fn reads_phases() {
    let phases = "[[excitation]]\nduration = 1\nw_rate = -2\nuntil_force = 3\n\
                  [[excitation]]\nduration = 2\nu_sine = { amplitude = -1, frequency = 5 }";
    let excitation = scene("", &format!("{FLAT}\n{phases}")).excitation;
    let still = Path::default();
    let pressed = Path { rate: -2.0, ..still };
    let shaken = Path { rate: 0.0, amplitude: -1.0, frequency: 5.0 };
    assert_eq!(
        excitation[0],
        Phase { duration: 1.0, u: still, w: pressed, until_force: Some(3.0), until_pressure: None }
    );
    assert_eq!(excitation[1], Phase { duration: 2.0, u: shaken, w: still, until_force: None, until_pressure: None });
}

#[test]
fn output_groups_have_the_names_that_a_scene_uses() {
    for group in OutputGroup::ALL {
        let scene = scene("", &format!("{FLAT}\n[fmu]\noutputs = ['{}']", group.name()));
        assert_eq!(scene.outputs, [group]);
    }
}

#[test]
fn a_sinusoid_closes_exactly() {
    let rest = "[surface]\nkind = 'sinusoid'\namplitude = 2\nwavelength = 4\npoints_per_wavelength = 8";
    let surface = scene("", rest).surface;
    assert!(surface.periodic);
    assert_eq!(surface.x, [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0]);
    assert_eq!((surface.z[0], surface.z[2], surface.z[8]), (0.0, 2.0, 0.0));
    let defaulted = scene("", "[surface]\nkind = 'sinusoid'\namplitude = 2\nwavelength = 4").surface;
    assert_eq!(defaulted.x.len(), 65);
}

#[test]
fn reads_points() {
    let rest = "[surface]\nkind = 'points'\nx = [0, 1, 2.5]\nz = [1, 0, 1]\nperiodic = true";
    let surface = scene("", rest).surface;
    assert_eq!((surface.x.as_slice(), surface.z.as_slice()), ([0.0, 1.0, 2.5].as_slice(), [1.0, 0.0, 1.0].as_slice()));
    assert_eq!(surface.spline().period(), Some(2.5));
}

#[test]
fn roughness_is_given_at_the_masses_or_sampled_there() {
    let roughness = |text: &str| scene(&format!("origin = 1\nroughness = {{ {text} }}"), FLAT).layer.roughness;
    assert_eq!(roughness("kind = 'points', z = [0, 1, 2, 3]"), [0.0, 1.0, 2.0, 3.0]);
    assert_eq!(roughness("kind = 'points', x = [0, 2], z = [0, 4]"), [2.0, 2.5, 3.0, 3.5]);
    assert!(roughness("kind = 'flat'").is_empty());
    let sampled = roughness("kind = 'sinusoid', amplitude = 3, wavelength = 1, points_per_wavelength = 4");
    for (found, expected) in sampled.into_iter().zip([0.0, 3.0, 0.0, -3.0]) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}

#[test]
fn the_height_adds_profile_and_roughness() {
    let sinusoid = "[surface]\nkind = 'sinusoid'\namplitude = 2\nwavelength = 4";
    assert_eq!(scene("roughness = { kind = 'points', z = [0, 1, -1, 0] }", sinusoid).height(), 6.0);
    assert_eq!(scene("", sinusoid).absolute_tolerance(), 4e-6);
    assert_eq!(scene("", FLAT).height(), 0.25);
}

#[test]
fn derives_an_identifier_from_the_name() {
    for (name, identifier) in
        [("rough-coulomb", "rough_coulomb"), ("7 seals", "_7_seals"), ("Größe", "Gr__e"), ("a_B9", "a_B9")]
    {
        let mut scene = scene("", FLAT);
        scene.name = name.into();
        assert_eq!(scene.model_identifier(), identifier);
    }
}

#[test]
fn reads_files_once_each_from_beside_the_scene() {
    let folder = std::env::temp_dir().join(format!("asperity-files-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("profiles")).unwrap();
    std::fs::write(folder.join("profiles/a.csv"), "x;z\r\n0;0,5\r\n1;0,5\r\n").unwrap();
    let file = |more: &str| format!("kind = 'file', path = '{more}profiles/a.csv'");
    let text = format!("name = 'f'\nsurface = {{ {} }}\n[layer]\nmasses = 1\nspacing = 1\nmass = 1\n", file("./"));
    std::fs::write(folder.join("s.toml"), format!("\u{feff}{text}roughness = {{ {} }}", file(""))).unwrap();
    let scene = Scene::load(&folder.join("s.toml")).unwrap();
    assert_eq!(scene.files, [PathBuf::from("profiles/a.csv")]);
    assert_eq!((scene.surface.z, scene.layer.roughness), (vec![0.5, 0.5], vec![0.5]));
    std::fs::remove_dir_all(folder).unwrap();
}

fn warnings(layer: &str, phases: &str) -> Vec<String> {
    let layer = format!("[layer]\nmasses = 4\nspacing = 0.25\nmass = 1\n{layer}");
    parse(&format!("name = 'w'\n{phases}\n{layer}\n[surface]\nkind = 'points'\nx = [0, 1]\nz = [0, 1]")).warnings
}

#[test]
fn a_profile_shorter_than_the_way_is_a_warning() {
    assert_eq!(warnings("", "").len(), 0);
    assert_eq!(warnings("origin = 0.25000000001", "").len(), 0);
    assert_eq!(warnings("", "excitation = [{ duration = 1, u_rate = 0.25 }]").len(), 0);
    let told = [
        warnings("origin = -0.5", ""),
        warnings("origin = 0.5", ""),
        warnings("", "excitation = [{ duration = 2, u_rate = -0.125 }]"),
        warnings("", "excitation = [{ duration = 1, u_sine = { amplitude = -0.3, frequency = 1 } }]"),
        warnings("", "excitation = [{ duration = 2, u_rate = 0.125 }, { duration = 1, u_rate = 0.125 }]"),
        warnings("", "excitation = [{ duration = 2, u_rate = -0.1, until_force = 1 }, { duration = 1, u_rate = 0.3 }]"),
    ];
    assert!(told.iter().all(|warnings| warnings.len() == 1), "{told:?}");
    let text = "the profile reaches from 0.0 m to 1.0 m, but the layer moves from -0.5 m to 0.25 m: \
                beyond its ends the profile goes on straight, along its end tangents";
    assert_eq!(told[0], [text]);
}

#[test]
fn a_roughness_shorter_than_the_layer_is_a_warning() {
    let roughness = |x: &str| scene(&format!("roughness = {{ kind = 'points', x = {x}, z = [0, 1] }}"), FLAT).warnings;
    assert!(roughness("[0, 0.75]").is_empty());
    let text = "the roughness reaches from 0.0 m to 0.5 m, but the layer from 0.0 m to 0.75 m: \
                beyond its ends the roughness goes on straight, along its end tangents";
    assert_eq!(roughness("[0, 0.5]"), [text]);
}

#[test]
fn temperatures_in_degrees_celsius_are_a_warning() {
    let told = |reference: f64, temperature: f64| {
        parse(&format!(
            "name = 't'\nlayer = {{ masses = 4, spacing = 1e-4, thickness = 1e-3, width = 1e-2 }}\nsurface = {{ kind = 'flat' }}
            [material]\ndensity = 1100\npoisson_ratio = 0.49\nequilibrium_modulus = 1e6\nprony = []
            wlf = {{ c1 = 7.52, c2 = 119.75, reference_temperature = {reference}, temperature = {temperature} }}"
        ))
        .warnings
    };
    let meant = |name: &str| {
        [format!("material.wlf.{name} K is too cold for rubber: temperatures are in K, 20 °C being 293.15 K")]
    };
    assert!(told(293.15, 313.15).is_empty());
    assert_eq!(told(20.0, 40.0), meant("reference_temperature = 20.0"));
    assert_eq!(told(200.0, 99.0), meant("temperature = 99.0"));
}

#[test]
fn a_periodic_or_a_level_profile_is_never_too_short() {
    let far = "excitation = [{ duration = 1, u_rate = 1e3 }]";
    let periodic = "surface = { kind = 'sinusoid', amplitude = 1, wavelength = 1 }";
    for surface in ["surface = { kind = 'flat' }", "surface = { kind = 'points', x = [0, 1], z = [2, 2] }", periodic] {
        let text = format!("name = 'n'\nlayer = {{ masses = 9, spacing = 1, mass = 1 }}\n{surface}\n{far}");
        assert!(parse(&text).warnings.is_empty());
    }
}

#[test]
fn a_path_has_the_rates_of_its_displacement() {
    let path = Path { rate: 0.3, amplitude: 1e-3, frequency: 40.0 };
    let (s, h) = (0.0123, 1e-6);
    let [_, velocity, acceleration] = path.motion(s);
    let difference = |component: usize| (path.motion(s + h)[component] - path.motion(s - h)[component]) / (2.0 * h);
    // Central differences: error h² ω³ amplitude / 6, and roundings of 1e-16 over h.
    assert!((difference(0) - velocity).abs() < 1e-8);
    assert!((difference(1) - acceleration).abs() < 1e-5);
}
