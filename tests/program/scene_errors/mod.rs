//! Every refusal of a scene names the file, the line, the key, what was given and what is allowed.

mod carrier;
mod keys;
mod material;
mod profiles;
mod values;

use std::fs;
use std::path::PathBuf;

use asperity::scene::{Problem, Scene};

/// A scene without fault; each case replaces one of its lines.
const BASE: [&str; 31] = [
    r#"name = "base""#,
    r#"description = "A scene to spoil""#,
    "[layer]",
    "masses = 3",
    "spacing = 1.0e-4",
    "mass = 1.0e-7",
    r#"initial = "relaxed""#,
    "",
    "[layer.vertical]",
    "stiffness = 2000.0",
    "damping = 0.008",
    "maxwell = [{ stiffness = 1000.0, relaxation_time = 1.0e-4 }]",
    "",
    "[surface]",
    r#"kind = "flat""#,
    "",
    "[friction]",
    "coulomb = 0.3",
    "",
    "[solver]",
    "relative_tolerance = 1.0e-6",
    "",
    "[input]",
    r#"extrapolation = "linear""#,
    "",
    "[fmu]",
    r#"outputs = ["forces"]"#,
    "",
    "[[excitation]]",
    "duration = 1.0e-3",
    "u_sine = { amplitude = 1.0e-5, frequency = 2000.0 }",
];

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

    /// Why the scene of that `text` is refused, without the folder's name.
    fn refusal(&self, text: &str) -> String {
        self.write("scene.toml", text);
        let error = Scene::load(&self.0.join("scene.toml")).unwrap_err();
        error.to_string().replace(&format!("{}/", self.0.display()), "")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn spoiled(base: &[&str], line: usize, replacement: &str) -> String {
    let mut lines = base.to_vec();
    lines[line - 1] = replacement;
    lines.join("\n")
}

/// The direct form's base with a line replaced.
fn with_line(line: usize, replacement: &str) -> String {
    spoiled(&BASE, line, replacement)
}

/// Holds the cases of a section of refusals.txt against what is said of them.
fn assert_refusals(section: &str, base: &[&str]) {
    let (_, cases) = include_str!("refusals.txt").split_once(&format!("\n[{section}]\n")).unwrap();
    let cases: Vec<&str> = cases.lines().take_while(|line| !line.is_empty()).collect();
    let folder = Folder::new(&section.replace(' ', "-"));
    let mut wrong = Vec::new();
    for case in cases.chunks(2) {
        let (line, replacement) = case[0].split_once(" |").unwrap();
        let replacement = replacement.trim_start().replace("\\n", "\n");
        let refusal = folder.refusal(&spoiled(base, line.parse().unwrap(), &replacement));
        if refusal != format!("scene.toml:{}", case[1].trim_start()) {
            wrong.push(format!("{}\n    {}", case[0], refusal.trim_start_matches("scene.toml:")));
        }
    }
    assert!(wrong.is_empty(), "said now:\n{}", wrong.join("\n"));
}

const PATH: &str = "a relative path of a file beside or below the scene file, without `..` and backslashes";

#[test]
fn the_base_is_a_scene() {
    let folder = Folder::new("base");
    folder.write("scene.toml", &BASE.join("\n"));
    let scene = Scene::load(&folder.0.join("scene.toml")).unwrap();
    assert_eq!((scene.name.as_str(), scene.layer.masses, scene.warnings.len()), ("base", 3, 0));
}

#[test]
fn an_error_can_be_asked_for_its_parts() {
    let error = Scene::parse(&with_line(6, "mass = -1.0"), "some/scene.toml".as_ref()).unwrap_err();
    assert_eq!(error.file(), PathBuf::from("some/scene.toml"));
    assert_eq!((error.line(), error.key()), (Some(6), "layer.mass"));
    let expected = Problem::Value { given: "-1.0".into(), expected: "a number from 1e-30 to 1e30".into() };
    assert_eq!(*error.problem(), expected);
    assert_eq!(error.to_string(), "some/scene.toml:6: layer.mass = -1.0: expected a number from 1e-30 to 1e30");
}

#[test]
fn a_scene_that_is_no_file_or_no_toml() {
    let folder = Folder::new("no-toml");
    let missing = Scene::load(&folder.0.join("missing.toml")).unwrap_err();
    assert!(missing.to_string().contains("missing.toml: cannot be read: No such file"), "{missing}");
    fs::write(folder.0.join("scene.toml"), b"name = \"\xff\"").unwrap();
    let binary = Scene::load(&folder.0.join("scene.toml")).unwrap_err();
    assert!(binary.to_string().contains("scene.toml: cannot be read: stream did not contain valid UTF-8"), "{binary}");
    assert_refusals("no TOML", &BASE);
}
