//! The house's order, held against the sources: which room looks into which, where unsafe code is, how long files are.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic, reason = "tests may fail")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The rooms of the library in their order, and where each may look: to the left only, and there not everywhere.
const ROOMS: [(&str, &[&str]); 10] = [
    ("math", &[]),
    ("scene", &["math"]),
    ("model", &["math", "scene"]),
    ("integrator", &["math", "model"]),
    ("contact", &["math", "scene", "model", "integrator"]),
    ("outputs", &["math", "scene", "model"]),
    ("simulation", &["math", "scene", "model", "integrator", "contact", "outputs"]),
    ("robustness", &["scene", "simulation"]),
    ("element", &["math", "scene", "model", "outputs", "simulation"]),
    ("fmi", &["math", "scene", "model", "integrator", "contact", "outputs", "simulation", "element"]),
];

/// The two files of the C interface; and the C types, which name unsafe functions but hold none.
const UNSAFE: [&str; 3] = ["fmi/exports.rs", "fmi/callbacks.rs", "fmi/bindings.rs"];

/// The most lines of a file.
const LONGEST: usize = 420;

/// Longer ones: the 34 functions of FMI, one after another and alike.
const LONG: [&str; 1] = ["fmi/exports.rs"];

/// All sources, by their path in `src`.
fn sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    collect(&root, &mut files);
    let named = |file: &PathBuf| {
        let path = file.strip_prefix(&root).unwrap().to_string_lossy().replace('\\', "/");
        (path, fs::read_to_string(file).unwrap())
    };
    files.iter().map(named).collect()
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

/// The text without its comments, documentation included.
fn code(text: &str) -> String {
    let lines = text.lines().map(|line| line.split_once("//").map_or(line, |(code, _)| code));
    lines.collect::<Vec<_>>().join("\n")
}

/// The rooms that a text names as `crate::room` or in `crate::{…}`.
fn looks_into(text: &str) -> BTreeSet<String> {
    let code = code(text);
    let after = code.match_indices("crate::").map(|(at, found)| &code[at + found.len()..]);
    after.flat_map(first_names).filter(|name| ROOMS.iter().any(|(room, _)| room == name)).collect()
}

/// The first names of a path or of a group of paths in braces.
fn first_names(path: &str) -> Vec<String> {
    let Some(group) = path.strip_prefix('{') else { return vec![name(path)] };
    let (mut depth, mut names, mut start) = (0, Vec::new(), 0);
    for (at, letter) in group.char_indices() {
        match letter {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            ',' | '}' if depth == 0 => {
                names.push(name(group[start..at].trim()));
                start = at + 1;
                if letter == '}' {
                    break;
                }
            }
            _ => {}
        }
    }
    names
}

fn name(path: &str) -> String {
    path.chars().take_while(|letter| letter.is_alphanumeric() || *letter == '_').collect()
}

fn room_of(path: &str) -> Option<usize> {
    ROOMS.iter().position(|(room, _)| path.split(['/', '.']).next() == Some(room))
}

/// Every room of the library has its row in the table.
#[test]
fn the_table_has_every_room() {
    let library = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs")).unwrap();
    let modules = library.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'));
    let modules: BTreeSet<&str> = modules.collect();
    assert_eq!(modules, ROOMS.iter().map(|(room, _)| *room).collect());
    for (i, (room, allowed)) in ROOMS.iter().enumerate() {
        let left = |name: &&str| ROOMS[..i].iter().any(|room| room.0 == *name);
        assert!(allowed.iter().all(left), "{room} looks to its right");
    }
}

/// A room looks only where the table lets it; the program sees the library from outside.
#[test]
fn rooms_look_to_their_left() {
    for (path, text) in sources() {
        let seen = looks_into(&text);
        match room_of(&path) {
            Some(room) => {
                let (name, allowed) = ROOMS[room];
                let wrong: Vec<_> =
                    seen.iter().filter(|other| *other != name && !allowed.contains(&other.as_str())).collect();
                assert!(wrong.is_empty(), "src/{path} looks into {wrong:?}");
            }
            None => assert!(seen.is_empty(), "src/{path} is no room of the library but looks into {seen:?}"),
        }
    }
}

/// Unsafe code is in the two files of the C interface alone.
#[test]
fn unsafe_code_has_its_place() {
    let holds = |text: &str| code(text).split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == "unsafe");
    let found: BTreeSet<String> = sources().into_iter().filter(|(_, text)| holds(text)).map(|(path, _)| path).collect();
    assert_eq!(found, UNSAFE.iter().map(ToString::to_string).collect());
}

/// Files are short enough to be read at once.
#[test]
fn files_are_short() {
    for (path, text) in sources() {
        let lines = text.lines().count();
        assert!(lines <= LONGEST || LONG.contains(&path.as_str()), "src/{path} has {lines} lines");
    }
}

/// The reader of paths reads groups: a test of the tests.
#[test]
fn groups_of_paths_are_read() {
    let text = "use crate::{math::{Spline, Jet}, scene};\nuse crate::model::State; // crate::fmi\n";
    let expected = ["math", "model", "scene"].map(String::from);
    assert_eq!(looks_into(text), BTreeSet::from(expected));
}
