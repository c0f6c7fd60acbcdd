//! The order of the modules, held against the sources: which room uses which, and where unsafe code may be.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests may fail")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// The rooms of the library in their order, and which others each may use: only those to its left.
const ROOMS: [(&str, &[&str]); 14] = [
    ("math", &[]),
    ("scene", &["math"]),
    ("model", &["math", "scene"]),
    ("steady", &["math", "scene", "model"]),
    ("integrator", &["math", "model"]),
    ("contact", &["math", "scene", "model", "integrator"]),
    ("outputs", &["math", "scene", "model", "integrator"]),
    ("simulation", &["math", "scene", "model", "integrator", "contact", "outputs"]),
    ("robustness", &["scene", "simulation"]),
    ("element", &["math", "scene", "model", "outputs", "simulation"]),
    ("calibration", &["math", "scene", "model", "steady", "element"]),
    ("patch", &["math", "scene", "model", "outputs", "element"]),
    ("fmi", &["math", "scene", "model", "integrator", "contact", "outputs", "simulation", "element", "patch"]),
    // Used by none.
    (
        "program",
        &[
            "math",
            "scene",
            "model",
            "steady",
            "outputs",
            "simulation",
            "robustness",
            "element",
            "calibration",
            "patch",
            "fmi",
        ],
    ),
];

/// Folders whose files use each other in no circle.
const WITHOUT_CIRCLES: [&str; 12] = [
    "math",
    "scene",
    "model",
    "steady",
    "integrator",
    "contact",
    "outputs",
    "simulation",
    "element",
    "calibration",
    "patch",
    "fmi",
];

/// The two files of the C interface; and the C types, which name unsafe functions but call none.
const UNSAFE: [&str; 3] = ["fmi/exports.rs", "fmi/callbacks.rs", "fmi/bindings.rs"];

/// The sources in `folder` of `src`: path within `src`, and text without comments.
fn sources(folder: &str) -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    for entry in fs::read_dir(root.join(folder)).unwrap() {
        let entry = entry.unwrap();
        let path = format!("{folder}/{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            files.extend(sources(&path));
        } else if path.ends_with(".rs") {
            let text = fs::read_to_string(entry.path()).unwrap();
            let lines = text.lines().map(|line| line.split_once("//").map_or(line, |(code, _)| code));
            files.push((path.trim_start_matches("./").to_owned(), lines.collect::<Vec<_>>().join("\n")));
        }
    }
    files
}

#[test]
fn each_room_uses_only_rooms_to_its_left() {
    let sources = sources(".");
    for (room, allowed) in ROOMS {
        let (folder, file) = (format!("{room}/"), format!("{room}.rs"));
        for (path, code) in sources.iter().filter(|(path, _)| path.starts_with(&folder) || *path == file) {
            assert!(!code.contains("crate::{"), "{path}: one `use crate::room` a line");
            for (other, _) in ROOMS.iter().filter(|(other, _)| *other != room && !allowed.contains(other)) {
                assert!(!code.contains(&format!("crate::{other}::")), "{path} uses {other}, which {room} may not");
            }
        }
    }
}

#[test]
fn the_files_of_a_folder_use_each_other_in_no_circle() {
    for folder in WITHOUT_CIRCLES {
        let mut uses: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for (path, code) in sources(folder).iter().filter(|(path, _)| !path.ends_with("tests.rs")) {
            let inner = &path[folder.len() + 1..];
            let (module, file) = inner.split_once('/').unwrap_or((inner, "mod.rs"));
            let code = code.split("#[cfg(test)]\nmod tests {").next().unwrap();
            let within = |prefix: &str| -> Vec<String> {
                let word =
                    |rest: &str| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap().to_owned();
                code.split(prefix).skip(1).map(word).collect()
            };
            let used = uses.entry(module.trim_end_matches(".rs").to_owned()).or_default();
            used.extend(within(&format!("crate::{folder}::")));
            if file == "mod.rs" {
                used.extend(within("super::"));
            }
        }
        uses.remove("mod");
        let is_free = |uses: &BTreeMap<String, BTreeSet<String>>, module: &str| {
            uses[module].iter().all(|used| used == module || !uses.contains_key(used))
        };
        while let Some(module) = uses.keys().find(|module| is_free(&uses, module)).cloned() {
            uses.remove(&module);
        }
        assert!(uses.is_empty(), "{folder}: a circle of {:?}", uses.keys());
    }
}

#[test]
fn unsafe_code_is_in_the_files_of_the_c_interface_alone() {
    for (path, code) in sources(".") {
        let mut words = code.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
        assert!(UNSAFE.contains(&path.as_str()) || !words.any(|word| word == "unsafe"), "{path} has unsafe code");
    }
}
