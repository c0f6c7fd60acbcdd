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
            let code = code.split("mod tests {").next().unwrap().to_owned();
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
        // The other bindings of the C interface are a path of theirs.
        let bindings = if package == "crates/fmi" { "verify" } else { "" };
        let own = ["lib", "main", "internals", bindings].map(str::to_owned);
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

/// The files of a package by their modules, as paths of names.
struct Files(BTreeMap<Vec<String>, File>);

/// What a file defines, and takes from others.
struct File {
    defined: BTreeSet<String>,
    /// By its `use` lines: whether for others too, and the path.
    imported: Vec<(bool, Vec<String>)>,
    /// The words of all other lines; paths are one.
    words: BTreeSet<String>,
}

fn names(path: &str) -> Vec<String> {
    path.split("::").filter(|name| !name.is_empty() && *name != "self").map(str::to_owned).collect()
}

/// The paths of the tree of a `use`.
fn paths_of(tree: &str) -> Vec<String> {
    let Some((before, inner)) = tree.split_once('{') else {
        return vec![tree.split(" as ").next().unwrap().trim().to_owned()];
    };
    let inner = inner.trim_end().strip_suffix('}').unwrap();
    let mut depth = 0;
    let branches = inner.split(|letter: char| {
        depth += i32::from(letter == '{') - i32::from(letter == '}');
        letter == ',' && depth == 0
    });
    let branches = branches.filter(|branch| !branch.trim().is_empty());
    branches.flat_map(|branch| paths_of(&format!("{}{}", before.trim(), branch.trim()))).collect()
}

impl File {
    fn new(code: &str) -> Self {
        const ITEMS: [&str; 7] = ["struct", "enum", "trait", "type", "fn", "const", "static"];
        let is_of_name = |letter: char| letter.is_alphanumeric() || letter == '_';
        let mut file = Self { defined: BTreeSet::new(), imported: Vec::new(), words: BTreeSet::new() };
        let mut lines = code.lines();
        while let Some(line) = lines.next() {
            // How far something can be seen is no use of it.
            let line = line.replace("(in crate::", "(");
            if let Some((before, tree)) = line
                .split_once("use ")
                .filter(|(before, _)| before.trim().is_empty() || before.trim().starts_with("pub"))
            {
                let mut tree = tree.to_owned();
                while !tree.contains(';') {
                    tree.push_str(lines.next().unwrap());
                }
                let paths = paths_of(tree.trim_end_matches(';'));
                file.imported.extend(paths.iter().map(|path| (before.contains("pub"), names(path))));
                continue;
            }
            if line.starts_with(is_of_name) {
                let mut words = line.split(|letter| !is_of_name(letter));
                if words.any(|word| ITEMS.contains(&word)) {
                    file.defined.extend(words.next().map(str::to_owned));
                }
            }
            file.words.extend(line.split(|letter| !is_of_name(letter) && letter != ':').map(str::to_owned));
        }
        file
    }
}

impl Files {
    fn new(package: &str) -> Self {
        let of_source = |Source { path, code }: &Source| {
            let mut module = names(&path.trim_end_matches(".rs").replace('/', "::"));
            if ["mod", "lib", "main"].contains(&module.last().unwrap().as_str()) {
                module.pop();
            }
            (module, File::new(code))
        };
        Self(sources(package).iter().map(of_source).collect())
    }

    /// The path from the root of the package of one that `module` writes; `None` where it leads out of it.
    fn absolute(&self, module: &[String], path: &[String]) -> Option<Vec<String>> {
        let supers = path.iter().take_while(|name| *name == "super").count();
        let below = [module, path].concat();
        match path.first()?.as_str() {
            "crate" => Some(path[1..].to_vec()),
            "super" => Some([&module[..module.len().checked_sub(supers)?], &path[supers..]].concat()),
            _ if self.0.contains_key(&below[..=module.len()]) => Some(below),
            first => {
                // What has the name of its package, as pythonize::pythonize, begins with that.
                let is_it = |imported: &&Vec<String>| imported.last().unwrap() == first && imported[0] != first;
                let imported = self.0[module].imported.iter().map(|(_, path)| path).find(is_it)?;
                Some([&self.absolute(module, imported)?[..], &path[1..]].concat())
            }
        }
    }

    /// The module whose file defines what a path from the root of the package names: re-exports are followed.
    fn defining(&self, path: &[String]) -> Option<Vec<String>> {
        let end = (0..=path.len()).rev().find(|&end| self.0.contains_key(&path[..end]))?;
        let (module, rest) = path.split_at(end);
        let exported = rest.first().filter(|name| !self.0[module].defined.contains(*name)).and_then(|name| {
            let exports = self.0[module].imported.iter().filter(|(is_public, _)| *is_public);
            exports.map(|(_, path)| path).find(|path| path.last() == Some(name))
        });
        match exported {
            Some(path) => self.defining(&[&self.absolute(module, path)?[..], &rest[1..]].concat()),
            None => Some(module.to_vec()),
        }
    }

    /// The modules whose files that of `module` uses. What it re-exports counts where it uses the type itself.
    fn used_by(&self, module: &Vec<String>) -> BTreeSet<Vec<String>> {
        let File { imported, words, .. } = &self.0[module];
        let is_used = |name: &String| name.starts_with(char::is_uppercase) && words.contains(name);
        let imported = imported.iter().filter(|(is_public, path)| !is_public || path.last().is_some_and(is_used));
        let inline = words.iter().filter(|word| word.contains("::")).map(|word| names(word));
        let paths = imported.map(|(_, path)| path.clone()).chain(inline);
        paths.filter_map(|path| self.defining(&self.absolute(module, &path)?)).filter(|used| used != module).collect()
    }
}

/// All that a file uses, and what these use in turn.
fn reached(uses: &BTreeMap<Vec<String>, BTreeSet<Vec<String>>>, from: &Vec<String>) -> BTreeSet<Vec<String>> {
    let (mut found, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(module) = open.pop() {
        open.extend(uses[module].iter().filter(|used| found.insert((*used).clone())));
    }
    found
}

#[test]
fn files_use_each_other_in_no_circle() {
    for (package, _) in PACKAGES {
        let files = Files::new(package);
        let uses: BTreeMap<_, _> = files.0.keys().map(|module| (module.clone(), files.used_by(module))).collect();
        let in_circles = uses.keys().filter(|module| reached(&uses, module).contains(*module));
        let found: Vec<_> = in_circles.map(|module| format!("{package}: {}", module.join("::"))).collect();
        assert!(found.is_empty(), "in circles: {found:#?}");
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
