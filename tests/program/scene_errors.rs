//! Every refusal of a scene names the file, the line, the key, what was given and what is allowed; refusals.txt has most.

use std::fs;
use std::path::{Path, PathBuf};

use asperity::patch::Patch;
use asperity::scene::{Problem, Scene, SceneError};
use asperity_formats::Instruments;

use crate::common::assert_names;

/// Scenes without fault; each case replaces a line of one.
const DIRECT: &str = r#"name = "base"
description = "A scene to spoil"
[layer]
masses = 3
spacing = 1.0e-4
mass = 1.0e-7
initial = "relaxed"

[layer.vertical]
stiffness = 2000.0
damping = 0.008
maxwell = [{ stiffness = 1000.0, relaxation_time = 1.0e-4 }]

[surface]
kind = "flat"

[friction]
coulomb = 0.3

[solver]
relative_tolerance = 1.0e-6

[input]
extrapolation = "linear"

[fmu]
outputs = ["forces"]

[[excitation]]
duration = 1.0e-3
u_sine = { amplitude = 1.0e-5, frequency = 2000.0 }"#;
const MATERIAL: &str = r#"name = "base"
[layer]
masses = 4
spacing = 1.0e-4
thickness = 5.0e-3
width = 1.0e-2
[material]
density = 1100.0
poisson_ratio = 0.49
equilibrium_modulus = 2.0e6
viscosity = 10.0
prony = [ { modulus = 5.0e6, relaxation_time = 1.0e-5 } ]
wlf = { c1 = 7.52, c2 = 119.75, reference_temperature = 293.15, temperature = 313.15 }
[surface]
kind = "flat"
[friction]
coulomb = 0.3
shear_strength = 1.0e5
[[excitation]]
duration = 1.0e-3
w_rate = -0.1
until_pressure = 2.0e5"#;
const CARRIED: &str = "name = 'base'
layer = { masses = 2, spacing = 1e-4, mass = 1e-7, vertical = { stiffness = 1e3 } }
surface = { kind = 'flat' }
";
const CARRIED_MATERIAL: &str = "name = 'base'
layer = { masses = 2, spacing = 1e-4, thickness = 1e-3, width = 1e-2 }
material = { density = 1e3, poisson_ratio = 0.49, equilibrium_modulus = 1e6, prony = [], WLF }
surface = { kind = 'flat' }
";
const WLF: &str = "wlf = { c1 = 7, c2 = 119, reference_temperature = 293, temperature = 293 }";
const SELF_AFFINE: &str = "kind = 'self_affine'\nlength = 0.1\npoints = 2000\nhurst = 0.8\nrms = 2e-5\n\
                           roll_off_wavelength = 5e-3\ncut_off_wavelength = 1e-4\nseed = 7";

fn spoiled(base: &str, line: usize, replacement: &str) -> String {
    let mut lines: Vec<&str> = base.split('\n').collect();
    lines[line - 1] = replacement;
    lines.join("\n")
}

fn self_affine() -> String {
    spoiled(DIRECT, 15, SELF_AFFINE)
}

/// A folder of its own for each test, removed in the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("asperity-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.0.join(name), text).unwrap();
    }

    fn load(&self, text: &str) -> Result<Scene, SceneError> {
        self.write("scene.toml", text);
        Scene::parse_with(text, &self.0.join("scene.toml"), &Instruments, &[])
    }

    /// Why the scene of that `text` is refused.
    fn refusal(&self, text: &str) -> String {
        summary(&self.load(text).unwrap_err())
    }

    /// Why a file is refused that `key` of the scene's `line` names.
    fn refusal_of_file(&self, text: &str, key: &str, line: usize) -> String {
        let error = self.load(text).unwrap_err();
        let (_, named_by) = error.to_string().rsplit_once('(').map(|(a, b)| (a.to_owned(), b.to_owned())).unwrap();
        assert!(named_by.contains(key) && named_by.ends_with(&format!("scene.toml:{line})")), "{error}");
        summary(&error)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Where an error is, its key, what was given or is wrong with it, and the numbers and words that are named.
fn summary(error: &SceneError) -> String {
    let named = |text: &str| {
        let words = text.split([' ', ',', ';', ':', '=', '(', ')']);
        words.filter(|word| word.starts_with('"') || word.parse::<f64>().is_ok()).map(str::to_owned).collect()
    };
    let key = error.key();
    let (what, named): (_, Vec<String>) = match error.problem() {
        Problem::Syntax { .. } => ("not TOML".into(), Vec::new()),
        Problem::Unreadable { given, .. } => (format!("{key} = {given}: unreadable"), Vec::new()),
        Problem::Unknown { similar, .. } => (format!("{key}: unknown"), similar.clone()),
        Problem::Missing { expected } => (format!("{key}: missing"), named(expected)),
        Problem::Value { given, expected } => (format!("{key} = {given}"), named(expected)),
        _ => panic!("{error}"),
    };
    let file = error.file().file_name().and_then(|name| name.to_str()).filter(|name| *name != "scene.toml");
    let place = [file.map(str::to_owned), error.line().map(|line| line.to_string())];
    let place: Vec<String> = place.into_iter().flatten().collect();
    let named = if named.is_empty() { String::new() } else { format!(": {}", named.join(" ")) };
    format!("{}: {what}{named}", place.join(":"))
}

/// The error of a scene that is not in a file.
fn parsed(text: &str) -> String {
    summary(&Scene::parse(text, "scene.toml".as_ref()).unwrap_err())
}

#[test]
fn scenes_are_refused_with_line_key_value_and_what_is_allowed() {
    let carried_material = CARRIED_MATERIAL.replace("WLF", WLF);
    let self_affine = self_affine();
    let folder = Folder::new("refusals");
    folder.write("profile.csv", "0 1\n1 2\n2 1\n");
    let (mut wrong, mut count) = (Vec::new(), 0);
    for section in include_str!("refusals.txt").split("\n\n").skip(1) {
        let mut lines = section.lines();
        let title = lines.next().unwrap();
        let base = match title {
            "[keys of a material without one]" => DIRECT,
            "[bodies of a carrier]" | "[phases of a carrier]" => CARRIED,
            "[pressures and temperatures]" => &carried_material,
            "[self-affine surfaces]" => &self_affine,
            "[values that do not go together]" | "[foundations]" => MATERIAL,
            _ if title.contains("material") || title.contains("fine roughness") => MATERIAL,
            _ => DIRECT,
        };
        while let (Some(case), Some(expected)) = (lines.next(), lines.next()) {
            let (line, replacement) = case.split_once(" |").unwrap();
            let replacement = replacement.trim_start().replace("\\n", "\n");
            let refusal = folder.load(&spoiled(base, line.parse().unwrap(), &replacement));
            let refusal = refusal.map_or_else(|error| summary(&error), |_| "taken".into());
            if refusal != expected.trim_start() {
                wrong.push(format!("{title}\n{case}\n    {refusal}"));
            }
            count += 1;
        }
    }
    assert!(wrong.is_empty(), "said now:\n{}", wrong.join("\n"));
    assert!(count > 200, "{count}");
}

#[test]
fn the_bases_are_scenes() {
    let folder = Folder::new("bases");
    let scene = folder.load(DIRECT).unwrap();
    assert_eq!((scene.name.as_str(), scene.layer.masses, scene.warnings.len()), ("base", 3, 0));
    let scene = folder.load(MATERIAL).unwrap();
    assert_eq!((scene.layer.thickness, scene.layer.width, scene.layer.mass), (Some(5e-3), Some(1e-2), None));
    assert_eq!(scene.material.map(|material| material.prony.len()), Some(1));
    for text in [CARRIED, &CARRIED_MATERIAL.replace("WLF", WLF), &self_affine()] {
        folder.load(text).unwrap();
    }
    // As many lines along y as are as far apart as the points along x.
    let scene = folder.load(&spoiled(&self_affine(), 22, "seed = 7\nisotropic = true\nsize_y = 0.05\nline = 1000"));
    let scene = scene.unwrap();
    let map = scene.surface.map().unwrap();
    assert_eq!((map.nx(), map.ny(), map.line(999)), (2000, 1000, &scene.surface.z()[..2000]));
    let refusal = folder.refusal(&spoiled(&self_affine(), 22, "seed = 7\nisotropic = true\nsize_y = 1"));
    assert!(refusal.starts_with("17: surface.points = 2000: 16777216"), "{refusal}");
}

#[test]
fn an_error_can_be_asked_for_its_parts() {
    let error = Scene::parse(&spoiled(DIRECT, 6, "mass = -1.0"), "some/scene.toml".as_ref()).unwrap_err();
    assert_eq!(error.file(), PathBuf::from("some/scene.toml"));
    assert_eq!((error.line(), error.key()), (Some(6), "layer.mass"));
    let expected = Problem::Value { given: "-1.0".into(), expected: "a number from 1e-30 to 1e30".into() };
    assert_eq!(*error.problem(), expected);
    assert_eq!(error.to_string(), "some/scene.toml:6: layer.mass = -1.0: expected a number from 1e-30 to 1e30");
}

#[test]
fn a_scene_that_is_no_file_no_text_or_has_no_tables() {
    let folder = Folder::new("no-scene");
    fs::write(folder.0.join("binary.toml"), b"name = \"\xff\"").unwrap();
    for name in ["missing.toml", "binary.toml"] {
        let error = Scene::load(&folder.0.join(name)).unwrap_err();
        assert!(matches!(error.problem(), Problem::Unreadable { .. }) && error.file().ends_with(name), "{error}");
    }
    assert_eq!(parsed("name = 'a'"), "1: layer: missing");
    let layer = "layer = { masses = 1, spacing = 1, mass = 1 }";
    assert_eq!(parsed(&format!("name = 'a'\n{layer}")), "1: surface: missing");
    let excitation = format!("name = 'a'\nexcitation = 1\n{layer}\nsurface = {{ kind = 'flat' }}");
    assert_eq!(parsed(&excitation), "2: excitation = 1");
    let patch = "name = 'p'\ntable = { path = 't.csv', extrapolaton = 'hold' }\n[patch]\nshape = 'flat'\n";
    assert_names(Patch::parse(patch, "p.toml".as_ref()).unwrap_err().to_string(), "table.extrapolation?");
}

#[test]
fn temperatures_that_the_material_does_not_have() {
    let base = CARRIED_MATERIAL.replace("WLF", WLF);
    let cold = parsed(&format!("{base}input.temperature = true\n[[excitation]]\nduration = 1\ntemperature = 150"));
    assert!(cold.starts_with("8: excitation[1].temperature = 150.0: "), "{cold}");
    let without = format!("{}input.temperature = true", CARRIED_MATERIAL.replace(", WLF", ""));
    assert_eq!(parsed(&without), "5: input.temperature = true");
}

#[test]
fn files_of_a_prony_series() {
    let folder = Folder::new("material-file");
    let text = spoiled(MATERIAL, 12, "prony = 'compound.csv'");
    assert_eq!(folder.refusal(&text), "12: material.prony = 'compound.csv': unreadable");
    for (table, refusal) in [
        ("1e-5,5e6\n-1,1\n", "compound.csv:2: column 1 = \"-1\": 1e-30 1e30"),
        ("tau,E\n1,x\n", "compound.csv:2: column 2 \"E\" = \"x\": 0 1e-30 1e30"),
        ("tau,E\n", "compound.csv:1: rows = 0"),
    ] {
        folder.write("compound.csv", table);
        assert_eq!(folder.refusal_of_file(&text, "material.prony", 12), refusal, "{table}");
    }
    let above = folder.refusal(&text.replace("'compound.csv'", "'../compound.csv'"));
    assert_eq!(above, "12: material.prony = '../compound.csv'");
    folder.write("compound.csv", "1e-5,5e6\n1,1e6");
    let scene = folder.load(&text).unwrap();
    assert!(scene.files.len() == 1 && scene.files[0].path.as_path() == Path::new("compound.csv"));
    assert_eq!(scene.material.map(|material| material.prony[1].modulus), Some(1e6));
}

/// Without friction nothing rubs but by hysteresis.
#[test]
fn fine_roughness_needs_what_rubs() {
    let folder = Folder::new("fine-frictionless");
    let area = "hurst = 0.8, rms_slope = 1.0, longest = 1e-3, shortest = 1e-5, hysteresis = false";
    for (fine, refusal) in [
        (area, "16: surface.fine.hysteresis = false"),
        ("rms_slope = 1.0, modulus = 1e7", "16: surface.fine = { rms_slope = 1.0, modulus = 1e7 }"),
    ] {
        let mut lines: Vec<&str> = MATERIAL.lines().collect();
        let fine = format!("fine = {{ {fine} }}");
        lines.splice(15..18, [fine.as_str()]);
        assert_eq!(folder.refusal(&lines.join("\n")), refusal);
    }
}

#[test]
fn files_of_fine_roughness() {
    let folder = Folder::new("fine-files");
    let scene = |fine: &str| spoiled(MATERIAL, 15, &format!("kind = \"flat\"\nfine = {{ {fine} }}"));
    let waves = |longest: &str, shortest: &str| {
        scene(&format!("spectrum = 'psd.csv', longest = {longest}, shortest = {shortest}"))
    };
    let table = waves("1e-3", "1e-5");
    assert_eq!(folder.refusal(&table), "16: surface.fine.spectrum = 'psd.csv': unreadable");
    folder.write("psd.csv", "q [1/mm],C [m^4]\n1,1e-18\n0.5,1e-25\n");
    let falling = folder.refusal_of_file(&table, "surface.fine.spectrum", 16);
    assert_eq!(falling, "psd.csv:3: column 1 \"q [1/mm]\" = 500.0 1/m: 1000.0");
    // 2π/q from 6.28 mm to 62.8 µm.
    folder.write("psd.csv", "q [1/mm],C [m^4]\n1,1e-18\n100,1e-25\n");
    let covered = "0.006283185307179587 6.283185307179586e-5";
    assert_eq!(folder.refusal(&table), format!("16: surface.fine.shortest = 1e-5: {covered}"));
    assert_eq!(folder.refusal(&waves("7e-3", "1e-4")), format!("16: surface.fine.longest = 7e-3: {covered}"));
    folder.write("strain.csv", "strain,storage,loss\n0.001,1,1\n0.1,1.5,1\n");
    let softened = "hurst = 0.8, rms_slope = 1.0, longest = 1e-3, shortest = 1e-5, softening = 'strain.csv'";
    let stiffer = folder.refusal_of_file(&scene(softened), "surface.fine.softening", 16);
    assert_eq!(stiffer, "strain.csv:3: column 2 \"storage\" = \"1.5\": 1e-30 1.0");
    folder.write("strain.csv", "strain,storage,loss\n0.001,1,1\n0.1,.5,1\n");
    let good = scene("spectrum = 'psd.csv', longest = 6e-3, shortest = 7e-5, softening = 'strain.csv'");
    let files = folder.load(&good).unwrap().files;
    let files: Vec<String> = files.iter().map(|file| file.path.display().to_string()).collect();
    assert_eq!(files, ["psd.csv", "strain.csv"], "{files:?}");
    // Of lines of 100 points over 1 mm: a quarter of the line at most, four steps of it at least.
    let line: String = (0..=100).map(|i| format!("{i}e-5,{}e-6\n", i % 7)).collect();
    folder.write("line.csv", &format!("x [m],z [m]\n{line}"));
    for (split, allowed) in [("2.6e-4", "0.00025"), ("3.9e-5", "4e-5")] {
        let surface = format!("kind = 'file'\npath = 'line.csv'\nfine = {{ split = {split}, shortest = 1e-6 }}");
        let refusal = folder.refusal(&spoiled(MATERIAL, 15, &surface));
        assert_eq!(refusal, format!("17: surface.fine.split = {split}: {allowed}"));
    }
}

/// What makes a file no profile is asked of its reader.
#[test]
fn files_that_are_not_the_profile_asked_for() {
    let folder = Folder::new("profiles");
    let scene = |keys: &str| spoiled(DIRECT, 15, &format!("kind = 'file'\npath = 'profile.csv'\n{keys}"));
    assert_eq!(folder.refusal(&scene("")), "16: surface.path = 'profile.csv': unreadable");
    for (profile, keys, refusal) in [
        ("x,z\n0,1\n1,high\n", "", "profile.csv:3: z = \"high\": -1e30 1e30 \"fill\""),
        ("0 1\n1 2\n2 3\n", "periodic = true", "profile.csv:3: z = 3.0: 1.0"),
        ("0 1\n1 2\n2 1\n", "line = 1", "profile.csv: line = 1"),
        ("0 1\n1 2\n2 1\n", "tilt = 'remove'\nperiodic = true", "profile.csv: tilt = \"remove\": \"keep\""),
    ] {
        folder.write("profile.csv", profile);
        assert_eq!(folder.refusal_of_file(&scene(keys), "surface.path", 16), refusal);
    }
}
