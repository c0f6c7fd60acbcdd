//! Keys of a scene or a patch file set in its text, as if the file had them so.

use std::path::Path;

use asperity::model::EvenSliding;
use asperity::patch::{Patch, PatchError};
use asperity::scene::{ParameterError, Problem, Scene, SceneError, similar_keys};
use asperity::tables::quantity_with_unit;
use asperity_formats::Instruments;
use toml_edit::{Array, DocumentMut, Item, Table, TableLike, Value};

/// A key's path, elements of lists counted from 1, and its value.
pub type Setting = (String, String);

/// A key cannot be set.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum OverrideError {
    #[error(
        "{key}: expected the path of a key, such as solver.relative_tolerance or layer.vertical.maxwell[1].stiffness"
    )]
    NotAPath { key: String },
    #[error("{key}: {list} has {count} elements, counted from 1")]
    NoElement { key: String, list: String, count: usize },
    #[error("{key}: {name} is {found} in the file")]
    NothingBelow { key: String, name: String, found: &'static str },
    #[error("{problem}; did you mean {}?", .similar.join(", "))]
    Unknown { key: String, problem: String, similar: Vec<String> },
    #[error("{problem}")]
    Refused { key: String, problem: String },
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}

impl OverrideError {
    /// The path of the key.
    pub fn key(&self) -> &str {
        match self {
            Self::NotAPath { key }
            | Self::NoElement { key, .. }
            | Self::NothingBelow { key, .. }
            | Self::Unknown { key, .. }
            | Self::Refused { key, .. } => key,
            Self::Parameter(error) => error.name(),
        }
    }
}

/// A file is refused: its own text, or what is set in it.
#[derive(Debug)]
pub enum Refusal<E> {
    /// Its own text.
    Own(E),
    /// What is set in it.
    Set(OverrideError),
}

/// The text of a file with keys set.
#[derive(Debug)]
pub struct Overridden {
    /// The text.
    pub text: String,
    /// What stands in a file that the scene names, such as a term of its Prony series: to be set once that is read.
    pub in_named_files: Vec<Setting>,
}

/// Reads a scene from `text`, its keys overridden, as if it were the content of `file`.
pub fn scene(text: &str, file: &Path, set: &[Setting]) -> Result<Scene, Refusal<SceneError>> {
    let Overridden { text: edited, in_named_files } = overridden(text, set).map_err(Refusal::Set)?;
    let parsed = Scene::parse_with(&edited, file, &Instruments);
    let mut scene = parsed.map_err(|error| refusal(error, Scene::parse_with(text, file, &Instruments).err(), file))?;
    set_in_named_files(&mut scene, &in_named_files).map_err(Refusal::Set)?;
    EvenSliding::warn_of(&mut scene);
    Ok(scene)
}

/// Reads a patch from `text`, as [`scene`] does a scene.
pub fn patch(text: &str, file: &Path, set: &[Setting]) -> Result<Patch, Refusal<PatchError>> {
    let edited = overridden(text, set).map_err(Refusal::Set)?.text;
    Patch::parse(&edited, file).map_err(|error| match (error, Patch::parse(text, file).err()) {
        (PatchError::File(error), own) => {
            let own = own.and_then(|own| if let PatchError::File(own) = own { Some(own) } else { None });
            match refusal(error, own, file) {
                Refusal::Own(error) => Refusal::Own(error.into()),
                Refusal::Set(error) => Refusal::Set(error),
            }
        }
        (error, _) => Refusal::Own(error),
    })
}

/// Sets what stands in files that a scene names.
pub fn set_in_named_files(scene: &mut Scene, settings: &[Setting]) -> Result<(), OverrideError> {
    settings.iter().try_for_each(|(key, value)| scene.set_by_name(key, value))?;
    Ok(scene.check()?)
}

/// The `error` of a text with keys set; the file's `own`, with the line that it stands in, where it is the same.
fn refusal(error: SceneError, own: Option<SceneError>, file: &Path) -> Refusal<SceneError> {
    match own {
        Some(own) if (own.key(), own.problem()) == (error.key(), error.problem()) => Refusal::Own(own),
        _ if error.file() != file => {
            Refusal::Set(OverrideError::Refused { key: error.key().to_owned(), problem: error.to_string() })
        }
        _ => Refusal::Set(refused(&error)),
    }
}

/// A key of the text that was not refused before.
fn refused(error: &SceneError) -> OverrideError {
    let (problem, similar) = (error.without_place(), similar_keys(error.key()));
    let key = error.key().to_owned();
    match error.problem() {
        Problem::Unknown { .. } if !similar.is_empty() => OverrideError::Unknown { key, problem, similar },
        _ => OverrideError::Refused { key, problem },
    }
}

/// The text of a TOML file with keys set; what stands in files that it names stays there.
///
/// # Errors
/// Where a key leads nowhere.
pub fn with_settings(text: &str, set: &[Setting]) -> Result<String, OverrideError> {
    Ok(overridden(text, set)?.text)
}

/// Sets keys in the text of a TOML file; a text that is not TOML stays as it is, for its reader to refuse.
pub fn overridden(text: &str, set: &[Setting]) -> Result<Overridden, OverrideError> {
    let mut in_named_files = Vec::new();
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let Some(mut document) = Some(set).filter(|set| !set.is_empty()).and_then(|_| text.parse::<DocumentMut>().ok())
    else {
        return Ok(Overridden { text: text.to_owned(), in_named_files });
    };
    for (key, given) in set {
        let path = segments(key).ok_or_else(|| OverrideError::NotAPath { key: key.clone() })?;
        let mut place = Place { key, table: document.as_table_mut(), name: String::new() };
        match place.set(&path, value(given)) {
            Ok(()) => (),
            Err(Obstacle::NamedFile) => in_named_files.push((key.clone(), given.clone())),
            Err(Obstacle::Error(error)) => return Err(error),
        }
    }
    Ok(Overridden { text: document.to_string(), in_named_files })
}

/// What stands at a key of a TOML text; `None` where nothing does.
pub fn item_at(text: &str, key: &str) -> Option<Item> {
    let document: DocumentMut = text.strip_prefix('\u{feff}').unwrap_or(text).parse().ok()?;
    item_below(document.as_item(), &segments(key)?)
}

fn item_below(item: &Item, path: &[PathSegment<'_>]) -> Option<Item> {
    let [segment, rest @ ..] = path else { return Some(item.clone()) };
    let named = item.as_table_like()?.get(segment.name)?;
    match (segment.element, named) {
        (None, _) => item_below(named, rest),
        (Some(element), Item::ArrayOfTables(tables)) => item_below(&tables.get(element)?.clone().into(), rest),
        (Some(element), _) => item_below(&named.as_array()?.get(element)?.clone().into(), rest),
    }
}

/// The number at a key of the text, in SI units where it is a text with a unit; `None` where there is none.
pub fn number(text: &str, key: &str) -> Option<f64> {
    let item = item_at(text, key)?;
    let plain = item.as_float().or_else(|| item.as_integer().map(|whole| whole as f64));
    plain.or_else(|| item.as_str().and_then(quantity_with_unit))
}

/// A value of TOML; what is none is a text, so that words need no quotation marks, or a number such as `.5`.
fn value(given: &str) -> Value {
    let is_digit_or_sign = |first: char| first.is_ascii_digit() || "+-.".contains(first);
    let number = || given.parse::<f64>().ok().filter(|_| given.starts_with(is_digit_or_sign));
    given.parse().unwrap_or_else(|_| number().map_or_else(|| given.into(), Value::from))
}

/// A key, and which element of its list, from 0.
#[derive(Debug)]
struct PathSegment<'a> {
    name: &'a str,
    element: Option<usize>,
}

/// The segments of a path; `None` where it is none.
fn segments(path: &str) -> Option<Vec<PathSegment<'_>>> {
    let is_name = |name: &str| !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-');
    path.split('.')
        .map(|part| {
            let (name, element) = match part.split_once('[') {
                Some((name, rest)) => (name, Some(rest.strip_suffix(']')?.parse::<usize>().ok()?.checked_sub(1)?)),
                None => (part, None),
            };
            is_name(name).then_some(PathSegment { name, element })
        })
        .collect()
}

/// Why a key cannot be set in the text.
enum Obstacle {
    /// It is in a file that the text names.
    NamedFile,
    Error(OverrideError),
}

/// A table of the text on the way to the key.
struct Place<'a> {
    /// The key that is to be set.
    key: &'a str,
    table: &'a mut dyn TableLike,
    /// The table's name with the dot behind it; empty for the root.
    name: String,
}

impl Place<'_> {
    fn set(&mut self, path: &[PathSegment<'_>], value: Value) -> Result<(), Obstacle> {
        let [segment, rest @ ..] = path else { return Ok(()) };
        let (key, name) = (self.key, format!("{}{}", self.name, segment.name));
        if rest.is_empty() && segment.element.is_none() {
            self.table.insert(segment.name, value.into());
            return Ok(());
        }
        if segment.element.is_none() && !self.table.contains_key(segment.name) {
            self.table.insert(segment.name, Table::new().into());
        }
        let found = self.table.get_mut(segment.name).filter(|item| !item.is_none());
        let nothing_below =
            |found| error(OverrideError::NothingBelow { key: key.to_owned(), name: name.clone(), found });
        let Some(item) = found else { return Err(nothing_below("not")) };
        let kind = kind(item);
        let Some(element) = segment.element else {
            let Some(table) = item.as_table_like_mut() else { return Err(nothing_below(kind)) };
            return Place { key, table, name: format!("{name}.") }.set(rest, value);
        };
        let count = list_length(item).ok_or_else(|| match item.is_str() && !rest.is_empty() {
            true => Obstacle::NamedFile,
            false => nothing_below(kind),
        })?;
        let name_of_element = format!("{name}[{}].", element + 1);
        if element >= count {
            return Err(error(OverrideError::NoElement { key: key.to_owned(), list: name, count }));
        }
        match (rest, item.as_array_mut()) {
            ([], Some(list)) => drop(list.replace(element, value)),
            _ => {
                let Some(table) = table_of_list(item, element) else { return Err(nothing_below(kind)) };
                return Place { key, table, name: name_of_element }.set(rest, value);
            }
        }
        Ok(())
    }
}

fn error(error: OverrideError) -> Obstacle {
    Obstacle::Error(error)
}

fn kind(item: &Item) -> &'static str {
    match item {
        Item::Table(_) | Item::Value(Value::InlineTable(_)) => "a table",
        Item::ArrayOfTables(_) | Item::Value(Value::Array(_)) => "a list",
        Item::Value(Value::String(_)) => "a text",
        Item::Value(Value::Boolean(_)) => "true or false",
        Item::Value(_) => "a number",
        Item::None => "not",
    }
}

/// The number of elements of a list; `None` of everything else.
fn list_length(item: &Item) -> Option<usize> {
    item.as_array().map(Array::len).or_else(|| item.as_array_of_tables().map(toml_edit::ArrayOfTables::len))
}

/// The table that is an element of a list.
fn table_of_list(item: &mut Item, element: usize) -> Option<&mut dyn TableLike> {
    match item {
        Item::ArrayOfTables(tables) => tables.get_mut(element).map(|table| table as &mut dyn TableLike),
        Item::Value(Value::Array(list)) => {
            list.get_mut(element)?.as_inline_table_mut().map(|table| table as &mut dyn TableLike)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "name = 'a' # its name\n[layer]\nmasses = 2\n[layer.vertical]\nmaxwell = [{ stiffness = 1.0 }, \
                        { stiffness = 2.0 }]\n[fmu]\noutputs = ['forces']\n[material]\nprony = 'compound.csv'\n\
                        [[excitation]]\nduration = 1.0\n[[excitation]]\nduration = 2.0\nu_sine = { amplitude = 1.0 }\n";

    fn set(settings: &[(&str, &str)]) -> Result<Overridden, OverrideError> {
        let settings: Vec<Setting> = settings.iter().map(|&(key, value)| (key.into(), value.into())).collect();
        overridden(TEXT, &settings)
    }

    #[track_caller]
    fn text(settings: &[(&str, &str)]) -> String {
        set(settings).unwrap().text
    }

    #[test]
    fn every_key_can_be_set_and_the_rest_of_the_text_stays() {
        assert_eq!(text(&[]), TEXT);
        let changed = |key: &str, value: &str, from: &str, to: &str| {
            assert!(TEXT.contains(from), "{from}");
            assert_eq!(text(&[(key, value)]), TEXT.replacen(from, to, 1), "{key}");
        };
        changed("layer.masses", "4", "masses = 2", "masses = 4");
        changed("layer.vertical.maxwell[2].stiffness", "1e3", "stiffness = 2.0", "stiffness = 1e3");
        changed("excitation[2].u_sine.amplitude", ".5", "amplitude = 1.0", "amplitude = 0.5");
        changed("excitation[1].duration", "5", "duration = 1.0", "duration = 5");
        changed("fmu.outputs", "['contact', 'energy']", "['forces']", "['contact', 'energy']");
        changed("fmu.outputs[1]", "contact", "'forces'", "\"contact\"");
    }

    #[test]
    fn what_is_not_there_is_added_and_words_need_no_quotation_marks() {
        let parsed = |settings: &[(&str, &str)]| text(settings).parse::<DocumentMut>().unwrap();
        let document =
            parsed(&[("solver.method", "step"), ("carrier.z.mass", "2"), ("excitation[1].u_sine.frequency", "9")]);
        assert_eq!(document["solver"]["method"].as_str(), Some("step"));
        assert_eq!(document["carrier"]["z"]["mass"].as_integer(), Some(2));
        assert_eq!(document["excitation"][0]["u_sine"]["frequency"].as_integer(), Some(9));
        let document = parsed(&[("excitation", "[{ duration = 3.0 }]"), ("surface", "{ kind = 'flat' }")]);
        assert_eq!(document["excitation"][0]["duration"].as_float(), Some(3.0));
        assert_eq!(document["surface"]["kind"].as_str(), Some("flat"));
        // The last one holds.
        assert_eq!(parsed(&[("name", "b"), ("name", "a b")])["name"].as_str(), Some("a b"));
    }

    #[test]
    fn what_stands_in_a_file_is_left_to_its_reader() {
        let overridden = set(&[("material.prony[2].modulus", "1e6")]).unwrap();
        assert_eq!((overridden.text.as_str(), overridden.in_named_files.len()), (TEXT, 1));
    }

    #[test]
    fn a_number_is_found_by_its_key() {
        assert_eq!(number(TEXT, "layer.masses"), Some(2.0));
        assert_eq!(number(TEXT, "layer.vertical.maxwell[2].stiffness"), Some(2.0));
        assert_eq!(number(TEXT, "excitation[2].u_sine.amplitude"), Some(1.0));
        for key in ["name", "layer.mass", "excitation[3].duration", "material.prony[1].modulus", "..", "layer"] {
            assert_eq!(number(TEXT, key), None, "{key}");
        }
    }

    #[test]
    fn a_path_that_leads_nowhere_says_where_it_ends() {
        let refused = |key: &str| set(&[(key, "1")]).unwrap_err().to_string();
        assert!(refused("layer..masses").contains("expected the path of a key"));
        assert!(refused("excitation[0].duration").contains("expected the path of a key"));
        assert_eq!(
            refused("excitation[3].duration"),
            "excitation[3].duration: excitation has 2 elements, counted from 1"
        );
        assert!(refused("layer.masses.x").contains("layer.masses is a number in the file"));
        assert!(refused("layer[1].x").contains("layer is a table in the file"));
    }
}
