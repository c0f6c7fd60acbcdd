//! What the absence of a key stands for: as the table of keys says it, and as files without the key are read.

use std::fs;
use std::path::{Path, PathBuf};

use asperity::scene::{
    Absent, CanonicalFiles, KeyEntry, PatchFile, Scene, SealFile, patch_keys, scene_keys, seal_keys,
};
use toml_edit::{DocumentMut, Item, TableLike, Value};

/// Ends of keys of which a scene keeps whether they are given, since only those that are given are parameters. The value
/// that they are given by default has to be 0.
const KEPT_APART: [&str; 12] = [
    "stiffness",
    "damping",
    "viscosity",
    "coulomb",
    "shear_force",
    "shear_strength",
    "pull",
    "load",
    "start_rate",
    "load_rate",
    "pull_rate",
    "pressure_rate",
];

/// Keys that no other file has.
const OTHERS: [&str; 7] = [
    "name = 'bodies'
    layer = { masses = 2, spacing = 1, mass = 1, vertical = { stiffness = 1 } }
    surface = { kind = 'flat' }
    carrier.x = { mass = 1, stiffness = 1, damping = 1, pull = 1, start_rate = 1 }
    carrier.z = { mass = 1, stiffness = 1, damping = 1, load = 1, start_rate = 1, start = 0 }
    friction = { coulomb = 0.5, shear_force = 1 }
    input = { extrapolation = 'hold', interval = 1 }
    fmu = { integers = 'real', dependencies = 'none', outputs = ['energy'] }
    [[excitation]]
    duration = 1
    load_rate = 1
    pull_rate = 1
    load_sine = { amplitude = 1, frequency = 1 }",
    "name = 'pressed'
    layer = { masses = 2, spacing = 1, thickness = 1, width = 1, foundation = 'layer' }
    material = { density = 1, poisson_ratio = 0.5, equilibrium_modulus = 1, prony = [], viscosity = 1 }
    surface = { kind = 'flat' }
    carrier.z = { mass = 1, initial = 'equilibrium' }
    friction = { shear_strength = 1 }
    excitation = [{ duration = 1, pressure = 1, pressure_rate = 1 }]",
    "name = 'moved'
    layer = { masses = 2, spacing = 1, mass = 1, origin = 1, clearance = 1, initial = 'undeformed' }
    surface = { kind = 'flat' }
    excitation = [{ file = 'motion.csv' }]",
    "name = 'measured'
    layer = { masses = 2, spacing = 1, thickness = 1, width = 1 }
    material = { density = 1, poisson_ratio = 0.5, equilibrium_modulus = 1, prony = [] }
    surface.kind = 'file'
    surface.path = 'line.csv'
    surface.missing = 'fill'
    surface.tilt = 'remove'
    surface.fine = { spectrum = 'spectrum.csv', longest = 1e-3, shortest = 1e-4, convention = 'contact.engineering' }",
    "name = 'fitted'
    layer = { masses = 2, spacing = 1, mass = 1 }
    surface = { kind = 'flat' }
    friction.coulomb = 0.5
    uncertainty.covariance = 'fit.csv'",
    "name = 'patch'
    table = { path = 'table.csv', extrapolation = 'refuse' }
    patch = { shape = 'flat', length = 1, width = 1, nx = 1, ny = 1, transport = true, offset = [1, 0, 0], damping = 1 }
    input = { extrapolation = 'hold', interval = 1 }
    solver = { refine = 2 }
    fmu = { outputs = [], integers = 'real', dependencies = 'none' }",
    "name = 'seal'
    table = { path = 'table.csv', extrapolation = 'refuse', temperature = 300 }
    seal = { pressure = 'lip.csv', length = 1, rough = 'moving', stiffness = 1, approach_stiffness = 1, cells = 8, columns = { x = 'x' } }
    fluid = { viscosity = 1, air = 'dry', supply = 1, start = 1 }
    input = { extrapolation = 'hold', interval = 1 }
    solver = { relative_tolerance = 1e-2 }
    fmu = { outputs = [], integers = 'real', dependencies = 'none' }",
];

/// The folders whose scenes and patches have most keys.
const FOLDERS: [&str; 3] = ["scenes", "tests/reference", "tests/malformed_inputs/seeds/scene"];

struct Example {
    file: PathBuf,
    content: DocumentMut,
}

/// All files of TOML below `folder`.
fn examples(folder: &Path) -> Vec<Example> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let of_entry = |file: PathBuf| match file.extension() {
        _ if file.is_dir() => examples(&file),
        Some(end) if end == "toml" => {
            let content = fs::read_to_string(&file).unwrap().parse().unwrap();
            vec![Example { file, content }]
        }
        _ => Vec::new(),
    };
    entries.flat_map(of_entry).collect()
}

/// The tables at a path such as `layer.vertical.maxwell[]`.
fn tables<'a>(table: &'a mut dyn TableLike, path: &[&str]) -> Vec<&'a mut dyn TableLike> {
    let Some((name, rest)) = path.split_first() else { return vec![table] };
    let below = |table: &'a mut dyn TableLike| tables(table, rest);
    match table.get_mut(name.trim_end_matches("[]")) {
        Some(Item::ArrayOfTables(array)) => array.iter_mut().flat_map(|table| below(table)).collect(),
        Some(Item::Value(Value::Array(array))) => {
            array.iter_mut().filter_map(Value::as_inline_table_mut).flat_map(|table| below(table)).collect()
        }
        Some(item) => item.as_table_like_mut().map(below).unwrap_or_default(),
        None => Vec::new(),
    }
}

/// What files with a key become without it.
#[derive(Debug, Default)]
struct Found {
    /// Whether a file had it.
    had: bool,
    /// Whether a table without it could be read.
    could: bool,
}

/// Takes a key out of each of the tables that have it, in turn, and checks what is then read against the table of keys.
fn without<F: PartialEq>(key: &KeyEntry, examples: &[Example], parse: impl Fn(&str, &Path) -> Option<F>) -> Found {
    let mut path: Vec<&str> = key.path.split('.').collect();
    let name = path.pop().unwrap();
    let mut found = Found::default();
    for Example { file, content } in examples {
        for i in 0..tables(content.clone().as_table_mut(), &path).len() {
            let mut changed = content.clone();
            let given = tables(changed.as_table_mut(), &path)[i].remove(name).is_some();
            let read = parse(&changed.to_string(), file);
            found.had |= given;
            found.could |= read.is_some();
            match (key.absent, read) {
                (Absent::Refused, read) if given => assert!(read.is_none(), "{} of {}", key.path, file.display()),
                (Absent::Value(value), _) if KEPT_APART.contains(&name) => assert_eq!(value, "0"),
                (Absent::Value(value), Some(read)) if given => {
                    let value: Value = value.parse().unwrap();
                    tables(changed.as_table_mut(), &path)[i].insert(name, Item::Value(value));
                    let is_same = parse(&changed.to_string(), file) == Some(read);
                    assert!(is_same, "{} of {}", key.path, file.display());
                }
                _ => {}
            }
        }
    }
    found
}

/// Checks all keys by all files that `parse` can read.
fn check<F: PartialEq>(keys: &[KeyEntry], parse: impl Fn(&str, &Path) -> Option<F>) {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("motion.csv"), "time [s],u [m],w [m]\n0,0,0\n1,1,0\n").unwrap();
    fs::write(folder.path().join("lip.csv"), "sealed_pressure [Pa],x [m],pressure [Pa]\n0,0,1\n0,1,1\n").unwrap();
    fs::write(folder.path().join("line.csv"), "x [m],z [m]\n0,0\n1,0\n2,0\n").unwrap();
    fs::write(folder.path().join("spectrum.csv"), "q,C\n1e3,1e-18\n1e4,1e-21\n1e5,1e-24\n").unwrap();
    fs::write(folder.path().join("fit.csv"), "key,value,scale,friction.coulomb\nfriction.coulomb,0.5,log,0.01\n")
        .unwrap();
    let other = |text: &&str| Example { file: folder.path().join("other.toml"), content: text.parse().unwrap() };
    let mut all: Vec<Example> = FOLDERS.iter().flat_map(|folder| examples(&root.join(folder))).collect();
    all.extend(OTHERS.iter().map(other));
    all.retain(|example| parse(&example.content.to_string(), &example.file).is_some());
    let is_unmet = |key: &&KeyEntry| {
        let Found { had, could } = without(key, &all, &parse);
        !match key.absent {
            Absent::Refused => had,
            Absent::Value(_) => had && could,
            Absent::Follows(_) | Absent::None => could,
        }
    };
    let unmet: Vec<&str> = keys.iter().filter(is_unmet).map(|key| key.path.as_str()).collect();
    assert!(unmet.is_empty(), "no file has {unmet:?}, or none could be read without");
}

#[test]
fn of_a_scene() {
    check(&scene_keys(), |text, file| Scene::parse(text, file).ok());
}

#[test]
fn of_a_patch() {
    check(&patch_keys(), |text, file| PatchFile::parse(text, file).ok());
}

#[test]
fn of_a_seal() {
    check(&seal_keys(), |text, file| SealFile::parse_with(text, file, &CanonicalFiles, &[]).ok());
}
