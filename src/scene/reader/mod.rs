//! From TOML text to a [`Scene`].

mod carrier;
mod fine;
mod patch;
mod surface;
mod table;

use std::path::Path as FilePath;

use super::keys::Form;
use super::prony_file::{ElasticConstants, PronySeries};
use super::values::Word;
use super::{
    ByLink, CarrierBodies, Extrapolation, FmuOptions, Foundation, FoundationKind, Friction, Heat, Initial, Layer, Link,
    LinkKind, Material, MaxwellElement, OutputGroup, PronyTerm, RateShear, Scene, SceneError, Solver, SurfaceFormats,
    TextAlone, Wlf, read_text, warnings,
};
use surface::Found;
use table::{Entry, Result, Source, TableReader};

/// The most letters of a scene's name.
const LONGEST_NAME: usize = 200;

impl Scene {
    /// Reads the scene file at `path` and the files that it names.
    ///
    /// # Errors
    /// [`SceneError`] with the file, the line, the key, what was given and what is allowed.
    pub fn load(path: &FilePath) -> Result<Self> {
        Self::load_with(path, &TextAlone)
    }

    /// As [`load`](Self::load), with `formats` for the files of surfaces that are no text.
    ///
    /// # Errors
    /// As for [`load`](Self::load).
    pub fn load_with(path: &FilePath, formats: &dyn SurfaceFormats) -> Result<Self> {
        let text = read_text(path).map_err(|error| SceneError::unreadable(path, &error))?;
        Self::parse_with(&text, path, formats)
    }

    /// Reads a scene from `text` as if it were the content of `file`; the files that it names are looked for in the
    /// same folder.
    ///
    /// # Errors
    /// As for [`load`](Self::load).
    pub fn parse(text: &str, file: &FilePath) -> Result<Self> {
        Self::parse_with(text, file, &TextAlone)
    }

    /// As [`parse`](Self::parse), with `formats` for the files of surfaces that are no text.
    ///
    /// # Errors
    /// As for [`load`](Self::load).
    pub fn parse_with(text: &str, file: &FilePath, formats: &dyn SurfaceFormats) -> Result<Self> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let source = Source { file, text, form: Form::Direct, formats };
        let document = source.parse()?;
        let document = document.get_ref();
        let form = if document.contains_key("material") { Form::Material } else { Form::Direct };
        read_scene(TableReader::root(Source { form, ..source }, document))
    }
}

fn read_scene(mut root: TableReader<'_>) -> Result<Scene> {
    root.check_keys()?;
    let mut found = Found::default();
    let name = read_name(&root.required("name")?)?;
    let description = root.entry("description").map(|entry| read_description(&entry)).transpose()?;
    let layer = root.required("layer")?.table(|table| read_layer(table, &mut found))?;
    let material_entry = root.entry("material");
    let read_material = |entry: &Entry<'_>| entry.table(|table| read_material(table, &mut found));
    let material = material_entry.as_ref().map(read_material).transpose()?;
    let surface_entry = root.required("surface")?;
    let surface = surface::read(&surface_entry, &mut found)?;
    let (surface, fine) = fine::read(&surface_entry, surface, &mut found)?;
    let carrier_entry = root.entry("carrier");
    let carrier = carrier_entry.as_ref().map(|entry| entry.table(carrier::read)).transpose()?.unwrap_or_default();
    let friction = root.optional_table("friction", read_friction)?;
    let material_and_entry = material_entry.as_ref().zip(material.as_ref());
    fine::check_rest(&surface_entry, fine.as_ref(), material_and_entry, friction.as_ref())?;
    let solver = root.optional_table("solver", read_solver)?.unwrap_or_default();
    let wlf = material.as_ref().and_then(|material| material.wlf.as_ref());
    let read_input = |table: &mut TableReader<'_>| {
        Ok((read_input(table)?, read_temperature_input(table, wlf.is_some(), solver.reduce)?))
    };
    let (extrapolation, temperature_input) = root.optional_table("input", read_input)?.unwrap_or_default();
    let read_fmu = |table: &mut TableReader<'_>| Ok((read_outputs(table, &carrier)?, read_fmu_options(table)?));
    let fmu = root.optional_table("fmu", read_fmu)?;
    let (outputs, fmu) = fmu.unwrap_or_else(|| (default_outputs(), FmuOptions::default()));
    let temperature = wlf.filter(|_| temperature_input);
    let excitation =
        root.tables("excitation", |table| carrier::read_phases(table, &carrier, temperature, &mut found))?.concat();
    root.finish()?;
    let Found { files, extracts, warnings, notes } = found;
    let foundation = material.as_ref().and_then(|material| Foundation::new(&layer, material, &surface));
    let mut scene = Scene {
        name,
        description,
        layer,
        material,
        foundation,
        surface,
        fine,
        carrier,
        friction,
        solver,
        extrapolation,
        temperature_input,
        outputs,
        fmu,
        excitation,
        files,
        extracts,
        warnings,
        notes,
    };
    let cold = scene.material.as_ref().and_then(warnings::cold_temperatures);
    let temperature = scene.material.as_ref().and_then(|material| material.wlf).map(|wlf| wlf.temperature);
    let cold_contacts = temperature.and_then(|temperature| scene.cold_contacts(temperature));
    let of_contacts = scene.fine_warnings().into_iter().chain(cold_contacts);
    let of_scene = warnings::other_units(&scene).into_iter().chain(scene.short_profile()).chain(cold);
    let of_scene = of_scene.chain(scene.foundation_warnings());
    let warnings: Vec<String> = of_scene.chain(of_contacts).collect();
    scene.warnings.extend(warnings);
    if let (Err(error), Some(entry)) = (scene.check_equilibrium(scene.first_load()), carrier_entry) {
        return Err(SceneError::new(entry.location(), error.name(), error.problem().clone()));
    }
    match (scene.check(), material_entry) {
        (Err(error), Some(entry)) => Err(SceneError::new(entry.location(), error.name(), error.problem().clone())),
        _ => Ok(scene),
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

fn read_layer(table: &mut TableReader<'_>, found: &mut Found) -> Result<Layer> {
    let foundation = table.optional_choice("foundation")?.unwrap_or_default();
    let mut layer = Layer {
        masses: usize::try_from(table.whole("masses")?).unwrap_or(usize::MAX),
        spacing: table.number("spacing")?,
        origin: table.optional_number("origin")?.unwrap_or(0.0),
        clearance: table.optional_number("clearance")?.unwrap_or(0.0),
        mass: table.number_of_form("mass")?,
        foundation: table.is_material().then_some(foundation),
        thickness: read_thickness(table, foundation)?,
        width: table.number_of_form("width")?,
        initial: table.optional_choice("initial")?.unwrap_or(Initial::Relaxed),
        roughness: Vec::new(),
        links: ByLink::default(),
    };
    for kind in LinkKind::ALL {
        layer.links[kind] = table.optional_table(kind.name(), read_link)?;
    }
    if let Some(entry) = table.entry("roughness") {
        layer.roughness = surface::read_roughness(&entry, &layer, found)?;
    }
    Ok(layer)
}

/// A half-space has no thickness.
fn read_thickness(table: &mut TableReader<'_>, foundation: FoundationKind) -> Result<Option<f64>> {
    if foundation != FoundationKind::HalfSpace {
        return table.number_of_form("thickness");
    }
    match table.entry("thickness") {
        Some(entry) => Err(entry.refuse("no such key with foundation = \"half_space\", which has no end")),
        None => Ok(None),
    }
}

fn read_link(table: &mut TableReader<'_>) -> Result<Link> {
    Ok(Link {
        stiffness: table.optional_number("stiffness")?,
        damping: table.optional_number("damping")?,
        maxwell: table.tables("maxwell", |table| {
            Ok(MaxwellElement {
                stiffness: table.number("stiffness")?,
                relaxation_time: table.number("relaxation_time")?,
            })
        })?,
    })
}

fn read_material(table: &mut TableReader<'_>, found: &mut Found) -> Result<Material> {
    let density = table.number("density")?;
    let (poisson_ratio, equilibrium_modulus) = (table.number("poisson_ratio")?, table.number("equilibrium_modulus")?);
    let elastic = ElasticConstants { poisson_ratio, equilibrium_modulus };
    Ok(Material {
        density,
        poisson_ratio,
        equilibrium_modulus,
        viscosity: table.optional_number("viscosity")?,
        prony: read_prony(&table.required("prony")?, elastic, found)?,
        wlf: table.optional_table("wlf", read_wlf)?,
        heat: table.optional_table("heat", read_heat)?,
    })
}

fn read_heat(table: &mut TableReader<'_>) -> Result<Heat> {
    Ok(Heat {
        conductivity: table.number("conductivity")?,
        capacity: table.number("capacity")?,
        share: table.optional_number("share")?.unwrap_or(1.0),
    })
}

/// The Prony series, in the scene or in a file.
fn read_prony(entry: &Entry<'_>, elastic: ElasticConstants, found: &mut Found) -> Result<Vec<PronyTerm>> {
    if !entry.is_text() {
        return entry.tables(|table| {
            Ok(PronyTerm { modulus: table.number("modulus")?, relaxation_time: table.number("relaxation_time")? })
        });
    }
    found.read_file(entry, &surface::read_path(entry)?, |bytes| {
        PronySeries::parse(bytes, elastic).map(|series| (series.terms, series.notes))
    })
}

fn read_wlf(table: &mut TableReader<'_>) -> Result<Wlf> {
    let temperature = table.required("temperature")?;
    let wlf = Wlf {
        c1: table.number("c1")?,
        c2: table.number("c2")?,
        reference_temperature: table.number("reference_temperature")?,
        temperature: temperature.number()?,
    };
    wlf.check().map_err(|error| temperature.error(error.problem().clone()))?;
    Ok(wlf)
}

fn read_friction(table: &mut TableReader<'_>) -> Result<Friction> {
    if let Some(entry) = table.entry("real_area") {
        return Err(entry.refuse(entry.table(fine_in_place)?));
    }
    Ok(Friction {
        coulomb: table.optional_number("coulomb")?,
        shear_force: table.optional_number("shear_force")?,
        shear_strength: table.optional_number("shear_strength")?,
        rate_shear: table.optional_table("rate_shear", read_rate_shear)?,
    })
}

/// What says the same as the old key `friction.real_area`.
fn fine_in_place(table: &mut TableReader<'_>) -> Result<String> {
    /// Half a band, of which one wave is the middle.
    const HALF_BAND: f64 = 1.0 / 16.0;
    let [slope, wavelength, modulus, cut_off] =
        ["rms_slope", "wavelength", "modulus", "cut_off_wavelength"].map(|name| table.optional_number(name));
    let keys = match (slope?, wavelength?, modulus?, cut_off?) {
        (Some(slope), Some(length), ..) => {
            let [longest, shortest] = [HALF_BAND, -HALF_BAND].map(|decades| length * 10_f64.powf(decades));
            format!(
                "hurst = 1, rms_slope = {slope}, longest = {longest:.6e}, shortest = {shortest:.6e}, hysteresis = false"
            )
        }
        (Some(slope), None, Some(modulus), _) => format!("rms_slope = {slope}, modulus = {modulus}"),
        (_, _, _, Some(cut_off)) => format!("shortest = {cut_off}, hysteresis = false"),
        _ => "...".into(),
    };
    Ok(format!("surface.fine = {{ {keys} }} in its place"))
}

fn read_rate_shear(table: &mut TableReader<'_>) -> Result<RateShear> {
    Ok(RateShear {
        force: table.number_of_form("force")?,
        strength: table.number_of_form("strength")?,
        reference_speed: table.number("reference_speed")?,
        sharpness: table.number("sharpness")?,
        creep_speed: table.optional_number("creep_speed")?,
    })
}

fn read_solver(table: &mut TableReader<'_>) -> Result<Solver> {
    let defaults = Solver::default();
    Ok(Solver {
        method: table.optional_choice("method")?.unwrap_or(defaults.method),
        relative_tolerance: table.optional_number("relative_tolerance")?.unwrap_or(defaults.relative_tolerance),
        absolute_tolerance: table.optional_number("absolute_tolerance")?,
        max_steps: table.optional_whole("max_steps")?.map(i64::unsigned_abs),
        reduce: table.optional_number("reduce")?.unwrap_or(defaults.reduce),
    })
}

fn read_input(table: &mut TableReader<'_>) -> Result<Extrapolation> {
    Ok(table.optional_choice("extrapolation")?.unwrap_or_default())
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
