//! The keys in a list, each with its full path.

use super::definition::{Absent, Allowed, Form, Key, KindKeys};
use super::field::At;
use super::patch::PATCH_ROOT;
use super::scene_file::ROOT;
use super::seal::SEAL_ROOT;
use crate::scene::Unit;
use crate::scene::values::{NumberRange, POSITIVE, closest};

/// A key and the place of its table.
#[derive(Clone, Debug)]
pub(in crate::scene) struct KeyRow {
    /// Its name with those of the tables around it; `[]` behind a table that may be repeated.
    pub(in crate::scene) path: String,
    pub(in crate::scene) key: &'static Key,
    pub(in crate::scene) at: At,
    /// The kinds of its table that have it; empty where all have.
    kinds: Vec<&'static str>,
}

/// The keys of the layer's roughness, which are those of the surface.
const ROUGHNESS: &str = "layer.roughness.";

/// The key at the end of a path in a file with these keys, and which of several equal tables it is in; lists are written
/// as `maxwell[]` or `maxwell[1]`.
pub(in crate::scene) fn find(root: &'static [Key], path: &str) -> Option<(&'static Key, At)> {
    find_below(root, At::FIRST, path)
}

fn find_below(keys: &'static [Key], at: At, path: &str) -> Option<(&'static Key, At)> {
    let (part, rest) = path.split_once('.').map_or((path, None), |(part, rest)| (part, Some(rest)));
    let name = part.split_once('[').map_or(part, |(name, _)| name);
    let key = keys.iter().find(|key| key.name == name)?;
    let at = key.at.unwrap_or(at);
    let Some(rest) = rest else { return Some((key, at)) };
    match key.allowed {
        Allowed::Table(keys) | Allowed::Tables(keys, _) => find_below(keys, at, rest),
        Allowed::Kinds(_, kinds) => kinds().into_iter().find_map(|(_, keys)| find_below(keys, at, rest)),
        _ => None,
    }
}

/// The paths of other keys of a scene and of a patch that look most like `given`, or end with it; elements of lists as
/// `[1]`.
pub fn similar_keys(given: &str) -> Vec<String> {
    let all = rows(ROOT).into_iter().chain(rows(PATCH_ROOT)).map(|row| row.path.replace("[]", "[1]"));
    let similar = closest(given, all);
    if similar.is_empty() { elsewhere(ROOT, Form::Material, given) } else { similar }
}

/// The paths of keys with the name at the end of `given`, which is none of the file's, in its other tables; none where
/// there are many.
pub(in crate::scene) fn elsewhere(root: &'static [Key], form: Form, given: &str) -> Vec<String> {
    /// Shorter names, such as x, say too little.
    const LEAST_LETTERS: usize = 4;
    const MANY: usize = 4;
    let name = given.rsplit('.').next().unwrap_or_default();
    let all = || rows(root).into_iter();
    let of_form = |row: &KeyRow| row.key.form.is_none_or(|own| own == form);
    let found: Vec<String> = all()
        .filter(|row| row.key.name == name && of_form(row) && !row.path.starts_with(ROUGHNESS))
        .map(|row| row.path.replace("[]", "[1]"))
        .collect();
    let is_of_another_kind = all().any(|row| without_numbers(given) == without_numbers(&row.path));
    if is_of_another_kind || name.len() < LEAST_LETTERS || found.len() >= MANY { Vec::new() } else { found }
}

/// A path without the numbers of elements.
fn without_numbers(path: &str) -> String {
    path.chars().filter(|character| !character.is_ascii_digit()).collect()
}

/// A key of a file, for a list of all keys.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyEntry {
    /// Its name with those of the tables around it; `[]` behind a table that may be repeated.
    pub path: String,
    /// What it may hold.
    pub allowed: String,
    /// The unit of a number.
    pub unit: Unit,
    /// What it means; empty of a table.
    pub meaning: &'static str,
    /// What its absence stands for.
    pub absent: Absent,
    /// The kinds of its table that have it; empty where all have.
    pub kinds: Vec<&'static str>,
    /// Whether it belongs to scenes with a material alone (`Some(true)`), or to those without (`Some(false)`).
    pub of_material: Option<bool>,
}

/// All keys of a scene; those of its surface are the layer's roughness's too.
pub fn scene_keys() -> Vec<KeyEntry> {
    rows(ROOT).into_iter().filter(|row| !row.path.starts_with(ROUGHNESS)).map(KeyEntry::from).collect()
}

/// All keys of a patch.
pub fn patch_keys() -> Vec<KeyEntry> {
    rows(PATCH_ROOT).into_iter().map(KeyEntry::from).collect()
}

/// All keys of a seal.
pub fn seal_keys() -> Vec<KeyEntry> {
    rows(SEAL_ROOT).into_iter().map(KeyEntry::from).collect()
}

impl From<KeyRow> for KeyEntry {
    fn from(KeyRow { path, key, kinds, .. }: KeyRow) -> Self {
        let of_material = key.form.map(|form| form == Form::Material);
        let (allowed, unit, meaning, absent) = (key.allowed.to_string(), key.unit, key.meaning, key.absent);
        Self { path, allowed, unit, meaning, absent, kinds, of_material }
    }
}

/// The keys of the scene that have a field, in the order of the parameters.
pub(in crate::scene) fn fields() -> Vec<KeyRow> {
    let mut all = below("", At::FIRST, ROOT, |keys| keys.sort_by_key(|key| !key.ahead));
    all.retain(|row| row.key.field.is_some() && !row.path.starts_with(ROUGHNESS));
    all
}

/// All keys in and below the table `root` of a file, in their order.
pub(in crate::scene) fn rows(root: &'static [Key]) -> Vec<KeyRow> {
    below("", At::FIRST, root, |_| ())
}

/// The keys in and below the table whose path is `start`, those of each table ordered by `sort`.
fn below(start: &str, at: At, keys: &'static [Key], sort: fn(&mut Vec<&'static Key>)) -> Vec<KeyRow> {
    let with_those_below = |key: &'static Key| {
        let path = format!("{start}{}", key.name);
        let at = key.at.unwrap_or(at);
        let below = match key.allowed {
            Allowed::Table(keys) => below(&format!("{path}."), at, keys, sort),
            Allowed::Tables(keys, _) => below(&format!("{path}[]."), at, keys, sort),
            Allowed::Kinds(_, kinds) => of_kinds(&kinds(), |keys| below(&format!("{path}."), at, keys, sort)),
            _ => Vec::new(),
        };
        std::iter::once(KeyRow { path, key, at, kinds: Vec::new() }).chain(below)
    };
    let mut keys: Vec<&'static Key> = keys.iter().collect();
    sort(&mut keys);
    keys.into_iter().flat_map(with_those_below).collect()
}

/// The keys of a table of several kinds, each once.
fn of_kinds(kinds: &[KindKeys], rows_of: impl Fn(&'static [Key]) -> Vec<KeyRow>) -> Vec<KeyRow> {
    let mut all: Vec<KeyRow> = Vec::new();
    for &(name, keys) in kinds {
        for row in rows_of(keys) {
            match all.iter_mut().find(|known| known.path == row.path) {
                Some(known) => known.kinds.push(name),
                None => all.push(KeyRow { kinds: vec![name], ..row }),
            }
        }
    }
    all.iter_mut().filter(|row| row.kinds.len() == kinds.len()).for_each(|row| row.kinds.clear());
    all
}

/// The range of the number at a path; positive numbers where there is none.
pub(in crate::scene) fn range_of(path: &str) -> NumberRange {
    find(ROOT, path).and_then(|(key, _)| key.range()).unwrap_or(POSITIVE)
}
