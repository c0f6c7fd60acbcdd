//! From TOML text to a [`Scene`].

mod carrier;
mod fine;
mod patch;
mod seal;
mod surface;
mod table;

pub use patch::POINTS;
pub use seal::LIP_PRESSURES;

use std::path::Path as FilePath;
use std::sync::Arc;

use super::error::{Location, Problem};
use super::file_values::{FileValues, Setting};
use super::keys::{self, At, Form, KeyRow, ROOT};
use super::values::Word;
use super::{
    CanonicalFiles, CarrierBodies, ElasticConstants, FileFormats, FmuOptions, Foundation, FoundationKind, Friction,
    Heat, InputRule, Layer, Link, LinkKind, Material, MaxwellElement, OutputGroup, ParameterError, PronyTerm,
    RateShear, Scene, SceneError, Solver, Surface, Wlf, read_text, warnings,
};
use surface::Findings;
use table::{Entry, Result, Source, TableReader};

/// The most letters of a scene's name.
const LONGEST_NAME: usize = 200;

impl Scene {
    /// Reads the scene file at `path` and the files that it names.
    ///
    /// # Errors
    /// [`SceneError`] with the file, the line, the key, what was given and what is allowed.
    pub fn load(path: &FilePath) -> Result<Self> {
        let text = read_text(path).map_err(|error| SceneError::unreadable(path, &error))?;
        Self::parse(&text, path)
    }

    /// Reads a scene from `text` as if it were the content of `file`; the files that it names are looked for in the
    /// same folder.
    ///
    /// # Errors
    /// As for [`load`](Self::load).
    pub fn parse(text: &str, file: &FilePath) -> Result<Self> {
        Self::parse_with(text, file, &CanonicalFiles, &[])
    }

    /// As [`parse`](Self::parse), with `formats` for the files of surfaces that are no text, and with keys set to other
    /// values.
    ///
    /// # Errors
    /// As for [`load`](Self::load); without file and line where it comes of a key that is set.
    pub fn parse_with(
        text: &str,
        file: &FilePath,
        formats: &'static dyn FileFormats,
        settings: &[Setting],
    ) -> Result<Self> {
        FileValues::parse(text, file, formats)?.with(settings, Self::of_values)
    }

    /// The scene with a key set to another value, elements of lists counted from 1: `with("friction.coulomb", 0.3)`. It is
    /// built anew of the [values](Self::values) that it was read from, and the files are not read again.
    ///
    /// # Errors
    /// Where there is no such key, the scene cannot have the value, or code has changed fields of the scene since it was
    /// read, which what it was read from does not have.
    pub fn with(&self, key: &str, value: impl Into<toml::Value>) -> Result<Self> {
        self.with_all(&[Setting::new(key, value)])
    }

    /// As [`with`](Self::with), with several keys set one after another.
    ///
    /// # Errors
    /// As for [`with`](Self::with).
    pub fn with_all(&self, settings: &[Setting]) -> Result<Self> {
        if !self.is_as_read() {
            let keys: Vec<&str> = settings.iter().map(|setting| setting.key.as_str()).collect();
            return Err(SceneError::new(Location::default(), keys.join(", "), Problem::Changed));
        }
        Self::of_values(FileValues::clone(&self.values), settings)
    }

    /// Whether its fields are as they were read.
    fn is_as_read(&self) -> bool {
        let read = self.values.as_read(|values| Self::of_values(values, &[]));
        read.is_some_and(|read| self.is_same(&read))
    }

    /// Whether the scene is the same as another, whatever text and files it is read from.
    pub fn is_same(&self, other: &Self) -> bool {
        let (files, warnings, notes) = (self.files.clone(), self.warnings.clone(), self.notes.clone());
        *self == Self { files, warnings, notes, ..other.clone() }
    }

    fn of_values(mut values: FileValues, settings: &[Setting]) -> Result<Self> {
        let in_files = values.set_all(settings)?;
        let scene = read_scene(values)?;
        if in_files.is_empty() {
            return Ok(scene);
        }
        // What stands in a file is put in the place of its name.
        let mut values = FileValues::clone(&scene.values);
        for (list, setting) in &in_files {
            let elements = scene.elements(list);
            values.set_all(&[Setting::new(list, elements), setting.clone()])?;
        }
        let notes = scene.notes;
        let mut scene = read_scene(values)?;
        scene.notes = notes;
        Ok(scene)
    }

    /// The number that the file has at a key, in SI units; `None` where it has none.
    pub fn number(&self, key: &str) -> Option<f64> {
        table::number_of(self.values.get(key)?, keys::find(ROOT, key)?.0.unit)
    }

    /// The elements of a list, as a file would have them.
    fn elements(&self, list: &str) -> Vec<toml::Value> {
        let below = format!("{list}[].");
        let rows: Vec<_> = keys::fields().into_iter().filter(|row| row.path.starts_with(&below)).collect();
        let element = |index: usize| {
            let value = |row: &KeyRow| {
                let value = (row.key.field?.get)(self, row.at.element(index))?;
                Some((row.key.name.to_owned(), value.into()))
            };
            let table: toml::Table = rows.iter().filter_map(value).collect();
            (!table.is_empty()).then_some(toml::Value::Table(table))
        };
        (0..).map_while(element).collect()
    }
}

fn read_scene(mut values: FileValues) -> Result<Scene> {
    let form = if values.root.contains_key("material") { Form::Material } else { Form::Direct };
    let source = Source { values: &values, form, keys: ROOT };
    let mut found = Findings { named: values.files.clone(), ..Findings::default() };
    // Its fields are set one by one: threads of hosts may have small stacks, on which a scene is not small.
    let mut scene = read_root(TableReader::root(source)?, &mut found)?;
    values.files = found.named;
    (scene.values, scene.files, scene.notes) = (Arc::new(values), found.files, found.notes);
    Ok(scene)
}

fn read_root(mut root: TableReader<'_>, found: &mut Findings) -> Result<Scene> {
    let mut scene = unread_scene();
    scene.name = read_name(&root.required("name")?)?;
    scene.description = root.entry("description").map(|entry| read_description(&entry)).transpose()?;
    root.required("layer")?.table(|table| read_layer(table, &mut scene, found))?;
    let material = root.entry("material");
    if let Some(entry) = &material {
        entry.table(|table| read_material(table, &mut scene, found))?;
        scene.default_memory = Scene::DEFAULT_MEMORY;
    }
    let surface = root.required("surface")?;
    let read = surface::read(&surface, found)?;
    (scene.surface, scene.fine) = fine::read(&surface, read, found)?;
    let carrier = root.entry("carrier");
    if let Some(entry) = &carrier {
        entry.table(|table| carrier::read(table, &mut scene))?;
    }
    root.optional_table("friction", |table| read_friction(table, &mut scene))?;
    fine::check_rest(&surface, material.as_ref(), &scene)?;
    read_options(&mut root, &mut scene)?;
    let temperature = wlf(&scene).filter(|_| scene.temperature_input);
    let phases = |table: &mut TableReader<'_>| carrier::read_phases(table, &scene.carrier, temperature, found);
    scene.excitation = root.tables("excitation", phases)?.concat();
    scene.foundation =
        scene.material.as_ref().and_then(|material| Foundation::new(&scene.layer, material, &scene.surface));
    // What is not known of the scene: no run depends on it.
    root.entry("uncertainty").map(|entry| entry.open()).transpose()?;
    root.finish()?;
    scene.warnings = std::mem::take(&mut found.warnings);
    add_warnings(&mut scene);
    refuse_at(carrier, scene.check_equilibrium(scene.first_load()))?;
    refuse_at(material, scene.check())?;
    Ok(scene)
}

/// A scene whose file says nothing.
fn unread_scene() -> Scene {
    let mut scene = Scene {
        name: String::new(),
        description: None,
        layer: Layer::default(),
        material: None,
        foundation: None,
        surface: Surface::flat(),
        fine: None,
        carrier: CarrierBodies::default(),
        friction: None,
        default_memory: 0.0,
        solver: Solver::default(),
        input_rule: InputRule::default(),
        temperature_input: false,
        outputs: default_outputs(),
        fmu: FmuOptions::default(),
        excitation: Vec::new(),
        files: Vec::new(),
        warnings: Vec::new(),
        notes: Vec::new(),
        values: Arc::default(),
    };
    keys::fields().iter().for_each(|row| row.key.set_default(&mut scene, row.at));
    scene
}

fn wlf(scene: &Scene) -> Option<&Wlf> {
    scene.material.as_ref()?.wlf.as_ref()
}

/// The settings of `[solver]`, `[input]` and `[fmu]`.
fn read_options(root: &mut TableReader<'_>, scene: &mut Scene) -> Result<()> {
    root.optional_table("solver", |table| table.fill(scene, At::FIRST))?;
    root.optional_table("input", |table| {
        table.fill(scene, At::FIRST)?;
        scene.temperature_input = read_temperature_input(table, wlf(scene).is_some(), scene.solver.reduce)?;
        Ok(())
    })?;
    root.optional_table("fmu", |table| {
        scene.outputs = read_outputs(table, &scene.carrier)?;
        scene.fmu = read_fmu_options(table)?;
        Ok(())
    })?;
    Ok(())
}

/// Adds what is probably not meant, beside what reading has found.
fn add_warnings(scene: &mut Scene) {
    let temperature = wlf(scene).map(|wlf| wlf.temperature);
    let cold_contacts = temperature.and_then(|temperature| scene.cold_contacts(temperature));
    let of_scene = warnings::other_units(scene).into_iter().chain(warnings::other_spacing(scene));
    let of_scene = of_scene.chain(scene.short_profile());
    let of_scene = of_scene.chain(scene.material.as_ref().and_then(warnings::cold_temperatures));
    let of_contacts = scene.fine_warnings().into_iter().chain(cold_contacts);
    let warnings: Vec<String> = of_scene.chain(scene.foundation_warnings()).chain(of_contacts).collect();
    scene.warnings.extend(warnings);
}

/// An error of what several keys together say, at the table with them, if it is there.
fn refuse_at(table: Option<Entry<'_>>, checked: std::result::Result<(), ParameterError>) -> Result<()> {
    match (checked, table) {
        (Err(error), Some(entry)) => Err(SceneError::new(entry.location(), error.name(), error.problem().clone())),
        _ => Ok(()),
    }
}

/// The name goes into XML attributes and, changed into an identifier, into file names, which hold 255 letters.
fn read_name(entry: &Entry<'_>) -> Result<String> {
    let expected = format!("a text, not empty, without control characters and of at most {LONGEST_NAME} letters");
    let legal = |name: &&str| {
        let short = name.chars().nth(LONGEST_NAME).is_none();
        short && !name.trim().is_empty() && !name.contains(char::is_control)
    };
    let name = entry.text().ok().filter(legal);
    name.map(str::to_owned).ok_or_else(|| entry.refuse(expected))
}

fn read_description(entry: &Entry<'_>) -> Result<String> {
    let description = entry.text()?;
    let illegal = |letter: char| letter.is_control() && !"\n\r\t".contains(letter);
    if description.contains(illegal) { Err(entry.refuse_type()) } else { Ok(description.to_owned()) }
}

fn read_layer(table: &mut TableReader<'_>, scene: &mut Scene, found: &mut Findings) -> Result<()> {
    table.fill(scene, At::FIRST)?;
    let foundation = table.optional_choice("foundation")?.unwrap_or_default();
    scene.layer.foundation = table.is_material().then_some(foundation);
    check_thickness(table, foundation)?;
    scene.layer.kinematics = table.optional_choice("kinematics")?;
    for kind in LinkKind::ALL {
        table.optional_table(kind.name(), |table| read_link(table, scene, At::link(kind)))?;
    }
    if let Some(entry) = table.entry("roughness") {
        scene.layer.roughness = surface::read_roughness(&entry, &scene.layer, found)?;
    }
    Ok(())
}

/// A half-space has no thickness.
fn check_thickness(table: &mut TableReader<'_>, foundation: FoundationKind) -> Result<()> {
    if !table.is_material() {
        return Ok(());
    }
    match table.entry("thickness").filter(|_| foundation == FoundationKind::HalfSpace) {
        Some(entry) => Err(entry.refuse("no such key with foundation = \"half_space\", which has no end")),
        None if foundation == FoundationKind::HalfSpace => Ok(()),
        None => table.required("thickness").map(|_| ()),
    }
}

fn read_link(table: &mut TableReader<'_>, scene: &mut Scene, at: At) -> Result<()> {
    scene.layer.links[at.link] = Some(Link::default());
    table.fill(scene, at)?;
    let elements = table.entry("maxwell").map_or_else(|| Ok(Vec::new()), |entry| entry.elements())?;
    if let Some(link) = &mut scene.layer.links[at.link] {
        link.maxwell = vec![MaxwellElement::default(); elements.len()];
    }
    fill_each(&elements, scene, at)
}

/// Fills a list, which has its elements.
fn fill_each(elements: &[Entry<'_>], scene: &mut Scene, at: At) -> Result<()> {
    let mut numbered = elements.iter().enumerate();
    numbered.try_for_each(|(index, entry)| entry.table(|table| table.fill(scene, at.element(index))))
}

fn read_material(table: &mut TableReader<'_>, scene: &mut Scene, found: &mut Findings) -> Result<()> {
    scene.material = Some(Material::default());
    table.fill(scene, At::FIRST)?;
    read_prony(&table.required("prony")?, scene, found)?;
    table.optional_table("wlf", |table| read_wlf(table, scene))?;
    table.optional_table("heat", |table| {
        scene.material.as_mut().map(|material| material.heat.insert(Heat::default()));
        table.fill(scene, At::FIRST)
    })?;
    Ok(())
}

/// The Prony series, in the scene or in a file.
fn read_prony(entry: &Entry<'_>, scene: &mut Scene, found: &mut Findings) -> Result<()> {
    let Some(material) = &mut scene.material else { return Ok(()) };
    if !entry.is_file() {
        let elements = entry.elements()?;
        material.prony = vec![PronyTerm::default(); elements.len()];
        return fill_each(&elements, scene, At::FIRST);
    }
    let Material { poisson_ratio, equilibrium_modulus, .. } = *material;
    let elastic = ElasticConstants { poisson_ratio, equilibrium_modulus };
    material.prony = found.read_table(
        entry,
        |formats, bytes, columns| formats.series(bytes, elastic, columns),
        |table| Ok((PronyTerm::of_table(table), Vec::new())),
    )?;
    Ok(())
}

fn read_wlf(table: &mut TableReader<'_>, scene: &mut Scene) -> Result<()> {
    scene.material.as_mut().map(|material| material.wlf.insert(Wlf::default()));
    table.fill(scene, At::FIRST)?;
    let temperature = table.required("temperature")?;
    let checked = wlf(scene).map_or(Ok(()), Wlf::check);
    checked.map_err(|error| temperature.error(error.problem().clone()))
}

fn read_friction(table: &mut TableReader<'_>, scene: &mut Scene) -> Result<()> {
    scene.friction = Some(Friction::default());
    table.fill(scene, At::FIRST)?;
    table.optional_table("rate_shear", |table| {
        scene.friction.as_mut().map(|friction| friction.rate_shear.insert(RateShear::default()));
        table.fill(scene, At::FIRST)
    })?;
    Ok(())
}

fn read_input(table: &mut TableReader<'_>) -> Result<InputRule> {
    let extrapolation = table.optional_choice("extrapolation")?.unwrap_or_default();
    Ok(InputRule { extrapolation, interval: table.optional_number("interval")?.unwrap_or(0.0) })
}

/// Whether the temperature is an input.
fn read_temperature_input(table: &mut TableReader<'_>, has_wlf: bool, reduce: f64) -> Result<bool> {
    let Some(entry) = table.entry("temperature") else { return Ok(false) };
    match (entry.flag()?, has_wlf, reduce > 0.0) {
        (true, false, _) => Err(entry.refuse("false without [material.wlf], which says what a temperature does")),
        (true, _, true) => {
            Err(entry.refuse("false beside solver.reduce > 0, which leaves elements out for one temperature"))
        }
        (input, _, _) => Ok(input),
    }
}

fn default_outputs() -> Vec<OutputGroup> {
    vec![OutputGroup::Forces, OutputGroup::Dissipation]
}

/// The groups of a layer; that of a carrier that is a body where it is one.
fn read_outputs(table: &mut TableReader<'_>, carrier: &CarrierBodies) -> Result<Vec<OutputGroup>> {
    let Some(entry) = table.entry("outputs") else { return Ok(default_outputs()) };
    let groups = read_groups(&entry)?;
    match groups.contains(&OutputGroup::Carrier) && !carrier.any() {
        true => Err(entry.refuse("no group \"carrier\" without [carrier.x] or [carrier.z]: the carrier is no body")),
        false => Ok(groups),
    }
}

fn read_fmu_options(table: &mut TableReader<'_>) -> Result<FmuOptions> {
    Ok(FmuOptions {
        integers: table.optional_choice("integers")?.unwrap_or_default(),
        dependencies: table.optional_choice("dependencies")?.unwrap_or_default(),
    })
}

/// The groups in the order of the variables, whatever their order in the file.
fn read_groups<G: Word + Ord>(entry: &Entry<'_>) -> Result<Vec<G>> {
    let mut groups: Vec<G> = Vec::new();
    for element in entry.elements()? {
        let group = element.choice()?;
        if groups.contains(&group) {
            return Err(element.refuse("each group once"));
        }
        groups.push(group);
    }
    groups.sort_unstable();
    Ok(groups)
}
