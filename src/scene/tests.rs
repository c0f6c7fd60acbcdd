#![allow(clippy::unwrap_used)]

use std::path::{Path as FilePath, PathBuf};

use super::{
    ByLink, Extrapolation, Initial, Link, LinkKind, MaxwellElement, Method, OutputGroup, Path, Phase, Scene, Setting,
    Solver,
};

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
    assert_eq!(layer.links, ByLink::default());
    assert_eq!(
        (&scene.description, &scene.friction, scene.input_rule.extrapolation),
        (&None, &None, Extrapolation::Linear)
    );
    let defaults = Solver {
        method: Method::Event,
        relative_tolerance: 1e-6,
        absolute_tolerance: None,
        max_steps: None,
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
    assert_eq!(layer.links[LinkKind::Vertical], Some(Link { stiffness: Some(2000.0), damping: None, maxwell }));
    assert_eq!(layer.links[LinkKind::LateralX], Some(Link { damping: Some(0.0), ..Link::default() }));
    assert_eq!([&layer.links[LinkKind::Horizontal], &layer.links[LinkKind::LateralZ]], [&None, &Some(Link::default())]);
}

#[test]
fn reads_settings() {
    let rest = "[friction]\ncoulomb = 1\n[solver]\nmethod = 'event'\nrelative_tolerance = 1e-3\n\
                absolute_tolerance = 1e-9\nmax_steps = 1_000\n[input]\nextrapolation = 'hold'\n\
                [fmu]\noutputs = ['elements', 'forces', 'solver']";
    let scene = scene("initial = 'undeformed'", &format!("{FLAT}\n{rest}"));
    let friction = scene.friction.clone().unwrap();
    assert_eq!((friction.coulomb, friction.shear_force), (Some(1.0), None));
    assert_eq!((scene.solver.relative_tolerance, scene.solver.max_steps), (1e-3, Some(1000)));
    assert_eq!((scene.solver.absolute_tolerance, scene.absolute_tolerance()), (Some(1e-9), 1e-9));
    assert_eq!((scene.layer.initial, scene.input_rule.extrapolation), (Initial::Undeformed, Extrapolation::Hold));
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
        Phase { duration: 1.0, u: still, w: pressed, until_force: Some(3.0), until_pressure: None, ..Phase::default() }
    );
    assert_eq!(
        excitation[1],
        Phase { duration: 2.0, u: shaken, w: still, until_force: None, until_pressure: None, ..Phase::default() }
    );
}

#[test]
fn output_groups_have_the_names_that_a_scene_uses() {
    for group in OutputGroup::ALL {
        let scene = scene("", &format!("{FLAT}\n[carrier.z]\nmass = 1\n[fmu]\noutputs = ['{}']", group.word()));
        assert_eq!(scene.outputs, [group]);
    }
}

#[test]
fn a_sinusoid_closes_exactly() {
    let rest = "[surface]\nkind = 'sinusoid'\namplitude = 2\nwavelength = 4\npoints_per_wavelength = 8";
    let surface = scene("", rest).surface;
    assert!(surface.is_periodic());
    assert_eq!(surface.x(), [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0]);
    assert_eq!((surface.z()[0], surface.z()[2], surface.z()[8]), (0.0, 2.0, 0.0));
    let defaulted = scene("", "[surface]\nkind = 'sinusoid'\namplitude = 2\nwavelength = 4").surface;
    assert_eq!(defaulted.x().len(), 65);
}

#[test]
fn reads_points() {
    let rest = "[surface]\nkind = 'points'\nx = [0, 1, 2.5]\nz = [1, 0, 1]\nperiodic = true";
    let surface = scene("", rest).surface;
    assert_eq!((surface.x(), surface.z()), ([0.0, 1.0, 2.5].as_slice(), [1.0, 0.0, 1.0].as_slice()));
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
        assert_eq!(super::identifier(name), identifier);
    }
}

#[test]
fn reads_files_once_each_from_beside_the_scene() {
    let folder = std::env::temp_dir().join(format!("asperity-files-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("profiles")).unwrap();
    std::fs::write(folder.join("profiles/a.csv"), "x [m],z [m]\r\n0,0.5\r\n1,0.5\r\n").unwrap();
    let file = |more: &str| format!("kind = 'file', path = '{more}profiles/a.csv'");
    let text = format!("name = 'f'\nsurface = {{ {} }}\n[layer]\nmasses = 1\nspacing = 1\nmass = 1\n", file("./"));
    std::fs::write(folder.join("s.toml"), format!("\u{feff}{text}roughness = {{ {} }}", file(""))).unwrap();
    let scene = Scene::load(&folder.join("s.toml")).unwrap();
    assert_eq!(scene.files[0].path, PathBuf::from("profiles/a.csv"));
    assert_eq!((scene.surface.z(), scene.layer.roughness.as_slice()), ([0.5, 0.5].as_slice(), [0.5].as_slice()));
    std::fs::remove_dir_all(folder).unwrap();
}

/// Sweeps of a scene that names the default go on with tables of one that names none.
#[test]
fn the_most_steps_are_written_as_they_count() {
    let written =
        |solver: &str| postcard::to_stdvec(&scene("", &format!("{FLAT}\n[solver]\n{solver}")).solver).unwrap();
    assert_eq!(written("max_steps = 10_000_000"), written(""));
    assert_ne!(written("max_steps = 1_000"), written(""));
}

#[test]
fn a_scene_varies_as_a_value_and_its_files_are_read_once() {
    let folder = std::env::temp_dir().join(format!("asperity-with-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    write("road.csv", "x,z\n0,0\n1e-3,1e-6\n2e-3,0\n");
    write("series.csv", "relaxation_time,modulus\n1e-3,2e6\n1e-5,3e6\n");
    let text = "name = 'a'\nlayer = { masses = 4, spacing = 1e-4, thickness = 1e-3, width = 1e-2 }\n\
                [surface]\nkind = 'file'\npath = 'road.csv'\n[material]\ndensity = 1e3\npoisson_ratio = 0.49\n\
                equilibrium_modulus = 1e6\nprony = 'series.csv'\n";
    let scene = Scene::parse(text, &folder.join("scene.toml")).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    let with = |key: &str, value: &str| scene.with_all(&[Setting::parse(key, value)]);
    let found = with("layer.masses", "8").unwrap();
    assert_eq!((found.layer.masses, &found.surface), (8, &scene.surface));
    assert_eq!(with("layer.width", "2 cm").unwrap().layer.width, Some(0.02));
    assert_eq!(with("friction.coulomb", "0.3").unwrap().friction.unwrap().coulomb, Some(0.3));
    let terms = |scene: &Scene| scene.material.as_ref().unwrap().prony.clone();
    let mut wanted = terms(&scene);
    wanted[1].modulus = 4e6;
    let found = with("material.prony[2].modulus", "4e6").unwrap();
    assert_eq!(terms(&found), wanted);
    assert_eq!(terms(&found.with("layer.masses", 6).unwrap()), wanted);
    for (key, value, problem) in [
        ("layer.masses", "-1", "layer.masses = -1: expected a whole number"),
        ("layer.mases", "4", "layer.mases: unknown; allowed"),
        ("layer..masses", "4", "expected the path of a key"),
        ("excitation[0].duration", "4", "expected the path of a key"),
        ("excitation[3].duration", "4", "excitation is not there"),
        ("name.x", "4", "name is a text there"),
        ("material.prony[3].modulus", "4", "one of the 2 elements of material.prony"),
    ] {
        let error = with(key, value).unwrap_err();
        let said = error.to_string();
        assert!(error.is_of_setting() && said.starts_with(key) && said.contains(problem), "{said}");
    }
    // What stands in the file is found there.
    let error = Scene::parse(&text.replace("1e6", "-1.0"), &folder.join("scene.toml")).unwrap_err();
    assert_eq!((error.key(), error.line()), ("material.equilibrium_modulus", Some(9)));
}

/// What the file does not have would be lost.
#[test]
fn keys_are_not_set_in_a_scene_that_code_has_changed() {
    let text = "name = 'a'\nlayer = { masses = 4, spacing = 1e-4, mass = 1e-6 }\nsurface = { kind = 'flat' }\n";
    let mut scene = Scene::parse(text, FilePath::new("scene.toml")).unwrap();
    assert_eq!(scene.with("layer.masses", 8).unwrap().layer.masses, 8);
    scene.layer.spacing = 2e-4;
    let refused = scene.with("layer.masses", 8).unwrap_err();
    assert_eq!((refused.key(), refused.problem()), ("layer.masses", &crate::scene::Problem::Changed));
    scene.layer.spacing = 1e-4;
    assert!(scene.with("layer.masses", 8).is_ok());
}

/// A host's thread may have 64 KiB of stack: what lies too deep is refused before it is read.
#[test]
fn nesting_is_bounded() {
    let deep = |count: usize| [format!("a = {}", "[".repeat(count)), format!("a = {}", "{ a = ".repeat(count))];
    let dotted = |count: usize| [format!("{} = 1", ["a"; 60].join(".").split_at(2 * count).0.trim_end_matches('.'))];
    let refused = |text: &str| Scene::parse(text, FilePath::new("s.toml")).unwrap_err().to_string();
    let all =
        move || deep(20).iter().chain(&deep(5000)).chain(&dotted(20)).map(|text| refused(text)).collect::<Vec<_>>();
    let found = std::thread::Builder::new().stack_size(64 << 10).spawn(all).unwrap().join().unwrap();
    assert!(found.iter().all(|error| error.contains("s.toml:1") && error.contains("more than 16 deep")), "{found:?}");
    // Brackets and dots of texts and comments do not count, nor numbers.
    let brackets = "[".repeat(40);
    let text = format!("name = \"{brackets} \\\" {brackets}\" # {brackets}\ndescription = '{}'", ".".repeat(40));
    let error = refused(&format!("{text}\na = \"\"\"\n{brackets}\n\"\"\"\nb = [{}]", "1.5, ".repeat(40)));
    assert!(!error.contains("deep"), "{error}");
}
