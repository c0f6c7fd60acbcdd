//! From TOML text to a [`Scene`].

use std::fs;
use std::path::Path;

use toml::de::DeTable;

use super::error::Place;
use super::form::Form;
use super::surface::{Found, read_surface};
use super::table::{Entry, Source, TableReader};
use super::{Problem, Scene, SceneError, excitation, layer, material_reader, settings, warnings};

const KEYS: [&str; 10] =
    ["name", "description", "layer", "material", "surface", "friction", "solver", "input", "fmu", "excitation"];

/// Letters of a scene's name.
const LONGEST_NAME: usize = 200;

impl Scene {
    /// Reads the scene file at `path` and the files that it names.
    ///
    /// # Errors
    /// [`SceneError`] with the file, the line, the key, what was given and what is allowed.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        Self::parse(&read_text(path)?, path)
    }

    /// Reads a scene from `text` as if it stood in `file`, beside which the files that it names are looked for.
    ///
    /// # Errors
    /// As for [`load`](Self::load).
    pub fn parse(text: &str, file: &Path) -> Result<Self, SceneError> {
        let source = Source { file, text: text.strip_prefix('\u{feff}').unwrap_or(text) };
        let document = source.parse()?;
        read_scene(source, document.get_ref())
    }
}

fn read_text(path: &Path) -> Result<String, SceneError> {
    fs::read_to_string(path).map_err(|error| {
        let problem = Problem::Unreadable { given: String::new(), reason: error.to_string() };
        SceneError::new(Place { file: path.to_owned(), line: None }, "", problem)
    })
}

fn read_scene(source: Source<'_>, document: &DeTable<'_>) -> Result<Scene, SceneError> {
    let mut root = TableReader::root(source, document);
    root.allow(&KEYS)?;
    let name = read_name(&root.required("name", "a text")?)?;
    let description = root.entry("description").map(|entry| read_description(&entry)).transpose()?;
    let mut found = Found::default();
    let of_material = root.entry("material");
    let form = if of_material.is_some() { Form::Material } else { Form::Direct };
    let layer = layer::read_layer(&root.required("layer", "a table")?, form, &mut found)?;
    let material = of_material.as_ref().map(|entry| material_reader::read_material(entry, &mut found)).transpose()?;
    let surface = read_surface(&root.required("surface", "a table")?, &mut found)?;
    let friction = root.optional_table("friction", |table| settings::read_friction(table, form))?;
    let solver = root.optional_table("solver", settings::read_solver)?.unwrap_or_default();
    let extrapolation = root.optional_table("input", settings::read_input)?.unwrap_or_default();
    let outputs = root.optional_table("fmu", settings::read_fmu)?.unwrap_or_else(settings::default_outputs);
    let excitation = root.tables("excitation", |table| excitation::read_phase(table, form))?;
    root.finish()?;
    let Found { files, extracts, mut warnings } = found;
    warnings.extend(warnings::short_profile(&layer, &surface, &excitation));
    warnings.extend(material.as_ref().and_then(warnings::cold_temperatures));
    let scene = Scene {
        name,
        description,
        layer,
        material,
        surface,
        friction,
        solver,
        extrapolation,
        outputs,
        excitation,
        files,
        extracts,
        warnings,
    };
    match (scene.check(), of_material) {
        (Err(error), Some(material)) => Err(SceneError::new(material.place(), error.name(), error.problem().clone())),
        _ => Ok(scene),
    }
}

/// The name ends up in XML attributes and, changed into an identifier, in file names, which hold 255 letters.
fn read_name(entry: &Entry<'_>) -> Result<String, SceneError> {
    let expected = format!("a text, not empty, without control characters and of at most {LONGEST_NAME} letters");
    let name = entry.text(&expected)?;
    let short = name.chars().nth(LONGEST_NAME).is_none();
    let legal = short && !name.trim().is_empty() && !name.contains(char::is_control);
    if legal { Ok(name.to_owned()) } else { Err(entry.refuse(expected)) }
}

fn read_description(entry: &Entry<'_>) -> Result<String, SceneError> {
    let expected = "a text without control characters but line breaks and tabs";
    let description = entry.text(expected)?;
    let illegal = |letter: char| letter.is_control() && !"\n\r\t".contains(letter);
    if description.contains(illegal) { Err(entry.refuse(expected)) } else { Ok(description.to_owned()) }
}
