//! The architecture, held against the sources: which package and which module uses which, and where unsafe code may be.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic, reason = "tests may fail")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The packages, and those of the project that each may use.
const PACKAGES: [(&str, &[&str]); 7] = [
    (".", &[]),
    ("crates/fmi", &["asperity"]),
    ("crates/fmu", &["asperity-fmi"]),
    ("crates/formats", &["asperity"]),
    ("crates/study", &["asperity", "asperity-fmi", "asperity-formats"]),
    ("crates/cli", &["asperity", "asperity-fmi", "asperity-formats", "asperity-study"]),
    ("python", &["asperity", "asperity-fmi", "asperity-formats", "asperity-study"]),
];

/// The two files of the C interface; and the C types, which name unsafe functions but call none.
const UNSAFE: [&str; 3] = ["crates/fmi/exports.rs", "crates/fmi/callbacks.rs", "crates/fmi/bindings.rs"];

/// A source: its path within `src`, and its code without comments and without the tests at its end.
struct Source {
    path: String,
    code: String,
}

fn root() -> PathBuf {
    env!("CARGO_MANIFEST_DIR").into()
}

/// The sources of a package that are not tests alone.
fn sources(package: &str) -> Vec<Source> {
    let (folder, mut found) = (root().join(package).join("src"), Vec::new());
    collect(&folder, &folder, &mut found);
    assert!(!found.is_empty(), "{package}");
    found
}

fn collect(src: &Path, folder: &Path, found: &mut Vec<Source>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            collect(src, &path, found);
        } else if name.ends_with(".rs") && !name.ends_with("tests.rs") {
            let text = fs::read_to_string(&path).unwrap();
            let lines = text.lines().map(|line| line.split_once("//").map_or(line, |(code, _)| code));
            let code = lines.collect::<Vec<_>>().join("\n");
            let code = code.split("\nmod tests {").next().unwrap().to_owned();
            found.push(Source { path: path.strip_prefix(src).unwrap().to_string_lossy().replace('\\', "/"), code });
        }
    }
}

/// The rows of the table of modules in a package's `lib.rs`: each module, and those that it may use; with no second column
/// each may use those above it.
fn modules(package: &str) -> Vec<(String, Vec<String>)> {
    let text = fs::read_to_string(root().join(package).join("src/lib.rs")).unwrap();
    let lines: Vec<&str> = text.lines().map(|line| line.strip_prefix("//! |").unwrap_or_default()).collect();
    let start = lines.iter().position(|line| line.starts_with("--")).unwrap_or_else(|| panic!("{package}: no table"));
    let has_uses = lines[start].matches('|').count() == 3;
    let names = |cell: &str| -> Vec<String> {
        let name = |word: &str| word.trim().trim_matches(['[', ']', '`']).to_owned();
        cell.split(',').map(name).filter(|name| !name.is_empty()).collect()
    };
    let mut rows: Vec<(String, Vec<String>)> = Vec::new();
    for line in lines[start + 1..].iter().take_while(|line| !line.is_empty()) {
        let cells: Vec<&str> = line.split('|').collect();
        for module in names(cells[0]) {
            let above = || rows.iter().map(|(module, _)| module.clone()).collect();
            let uses = if has_uses { names(cells[1]) } else { above() };
            rows.push((module, uses));
        }
    }
    rows
}

/// The module that a source belongs to.
fn module_of(path: &str) -> &str {
    path.split_once('/').map_or_else(|| path.trim_end_matches(".rs"), |(folder, _)| folder)
}

/// The packages with a table of modules: all but the shared library and Python's, which are a page each.
fn with_modules() -> impl Iterator<Item = &'static str> {
    PACKAGES.into_iter().map(|(package, _)| package).filter(|package| !["crates/fmu", "python"].contains(package))
}

/// The words that follow `prefix` in `code`.
fn words_after<'a>(code: &'a str, prefix: &str) -> impl Iterator<Item = &'a str> {
    let word = |rest: &'a str| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap();
    code.split(prefix).skip(1).map(word).collect::<Vec<_>>().into_iter()
}

#[test]
fn packages_use_those_below_them() {
    for (package, allowed) in PACKAGES {
        let manifest = fs::read_to_string(root().join(package).join("Cargo.toml")).unwrap();
        let dependencies = manifest.split_once("[dependencies]").unwrap().1.split("\n[").next().unwrap();
        for name in dependencies.lines().filter_map(|line| line.split(['.', ' ', '=']).next()) {
            assert!(!name.starts_with("asperity") || allowed.contains(&name), "{package} uses {name}");
        }
    }
}

#[test]
fn the_table_has_every_module_after_those_that_it_uses() {
    for package in with_modules() {
        let modules = modules(package);
        for (i, (module, uses)) in modules.iter().enumerate() {
            let is_before = |used: &String| modules[..i].iter().any(|(before, _)| before == used);
            assert!(
                uses.iter().all(is_before),
                "{package}: {module} uses {uses:?}, of which some do not stand before it"
            );
        }
        let of_sources: BTreeSet<String> =
            sources(package).iter().map(|source| module_of(&source.path).to_owned()).collect();
        let own = ["lib", "main", "verify"].map(str::to_owned);
        let of_table: BTreeSet<String> = modules.into_iter().map(|(module, _)| module).collect();
        let of_sources: BTreeSet<String> = of_sources.into_iter().filter(|module| !own.contains(module)).collect();
        assert_eq!(of_sources, of_table, "{package}");
    }
}

#[test]
fn each_module_uses_only_those_named_beside_it() {
    for package in with_modules() {
        let (sources, modules) = (sources(package), modules(package));
        for (module, uses) in &modules {
            for Source { path, code } in sources.iter().filter(|source| module_of(&source.path) == module) {
                assert!(!code.contains("crate::{"), "{package}: {path}: one `use crate::module` a line");
                // At the root of the package `super` is the package, as it is in the file of a folder there.
                let inner = path.split_once('/').map(|(_, inner)| inner);
                let by_super = inner.is_none_or(|inner| inner == "mod.rs").then(|| words_after(code, "super::"));
                let used = words_after(code, "crate::").chain(by_super.into_iter().flatten());
                for other in used.filter(|used| modules.iter().any(|(other, _)| other == used)) {
                    let may = other == module || uses.iter().any(|name| name == other);
                    assert!(may, "{package}: {path} uses {other}, which {module} may not");
                }
            }
        }
    }
}

#[test]
fn the_files_of_a_module_use_each_other_in_no_circle() {
    for package in with_modules() {
        let sources = sources(package);
        for (folder, _) in modules(package) {
            let mut uses: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
            for Source { path, code } in &sources {
                let Some(inner) = path.strip_prefix(&format!("{folder}/")) else { continue };
                let (module, file) = inner.split_once('/').unwrap_or((inner, "mod.rs"));
                let used = uses.entry(module.trim_end_matches(".rs").to_owned()).or_default();
                used.extend(words_after(code, &format!("crate::{folder}::")).map(str::to_owned));
                if file == "mod.rs" {
                    used.extend(words_after(code, "super::").map(str::to_owned));
                }
            }
            uses.remove("mod");
            let is_free = |uses: &BTreeMap<String, BTreeSet<String>>, module: &str| {
                uses[module].iter().all(|used| used == module || !uses.contains_key(used))
            };
            while let Some(module) = uses.keys().find(|module| is_free(&uses, module)).cloned() {
                uses.remove(&module);
            }
            assert!(uses.is_empty(), "{package}: {folder}: a circle of {:?}", uses.keys());
        }
    }
}

#[test]
fn unsafe_code_is_in_the_files_of_the_c_interface_alone() {
    for (package, _) in PACKAGES {
        for Source { path, code } in sources(package) {
            let path = format!("{}{path}", if package == "." { String::new() } else { format!("{package}/") });
            let mut words = code.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
            assert!(UNSAFE.contains(&path.as_str()) || !words.any(|word| word == "unsafe"), "{path} has unsafe code");
        }
    }
}
