//! The architecture, held against the sources: which module uses which, and where unsafe code may be.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests may fail")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

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

/// The rows of the table of modules in `src/lib.rs`: each module, and those that it may use.
fn modules() -> Vec<(String, Vec<String>)> {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs")).unwrap();
    let table = text.split_once("//! | module | uses | contents |\n//! |---|---|---|\n").unwrap().1;
    let row = |line: &str| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let uses = cells[2].split(", ").filter(|name| !name.is_empty()).map(str::to_owned).collect();
        (cells[1].trim_matches(['[', ']', '`']).to_owned(), uses)
    };
    table.lines().take_while(|line| line.starts_with("//! |")).map(row).collect()
}

/// The module that a source belongs to.
fn module_of(path: &str) -> &str {
    path.split_once('/').map_or_else(|| path.trim_end_matches(".rs"), |(folder, _)| folder)
}

#[test]
fn the_table_has_every_module_after_those_that_it_uses() {
    let modules = modules();
    for (i, (module, uses)) in modules.iter().enumerate() {
        let is_before = |used: &String| modules[..i].iter().any(|(before, _)| before == used);
        assert!(uses.iter().all(is_before), "{module} uses {uses:?}, of which some do not stand before it");
    }
    let of_sources: BTreeSet<String> = sources(".").iter().map(|(path, _)| module_of(path).to_owned()).collect();
    let of_table = modules.into_iter().map(|(module, _)| module).chain(["lib".to_owned(), "main".to_owned()]).collect();
    assert_eq!(of_sources, of_table);
}

#[test]
fn each_module_uses_only_those_named_beside_it() {
    let (sources, modules) = (sources("."), modules());
    for (module, uses) in &modules {
        for (path, code) in sources.iter().filter(|(path, _)| module_of(path) == module) {
            assert!(!code.contains("crate::{"), "{path}: one `use crate::module` a line");
            for (other, _) in modules.iter().filter(|(other, _)| other != module && !uses.contains(other)) {
                assert!(!code.contains(&format!("crate::{other}::")), "{path} uses {other}, which {module} may not");
            }
        }
    }
}

/// But for those of the program, whose commands share what the program's own file has.
#[test]
fn the_files_of_a_module_use_each_other_in_no_cycle() {
    for (folder, _) in modules().iter().filter(|(module, _)| module != "program") {
        if !Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(folder).is_dir() {
            continue;
        }
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
        assert!(uses.is_empty(), "{folder}: a cycle of {:?}", uses.keys());
    }
}

#[test]
fn unsafe_code_is_in_the_files_of_the_c_interface_alone() {
    for (path, code) in sources(".") {
        let mut words = code.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
        assert!(UNSAFE.contains(&path.as_str()) || !words.any(|word| word == "unsafe"), "{path} has unsafe code");
    }
}
