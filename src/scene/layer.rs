//! Reading of `[layer]`: the masses, their roughness and their links.

use super::allowed::{self, SurfaceKind};
use super::form::{Form, FormKeys};
use super::surface::{self, Found, KIND};
use super::table::{Entry, TableReader, read_table};
use super::{Initial, Layer, Link, MaxwellElement, SceneError, warnings};

const KEYS: [&str; 6] = ["masses", "spacing", "origin", "clearance", "initial", "roughness"];
const OF_FORM: FormKeys = FormKeys {
    direct: &["mass", "vertical", "horizontal", "lateral_x", "lateral_z"],
    material: &["thickness", "width"],
};

pub(super) fn read_layer(entry: &Entry<'_>, form: Form, found: &mut Found) -> Result<Layer, SceneError> {
    read_table(entry, |table| {
        form.allow(table, &KEYS, &OF_FORM)?;
        let mut layer = read_masses(table, form)?;
        layer.vertical = table.optional_table("vertical", read_link)?;
        layer.horizontal = table.optional_table("horizontal", read_link)?;
        layer.lateral_x = table.optional_table("lateral_x", read_link)?;
        layer.lateral_z = table.optional_table("lateral_z", read_link)?;
        if let Some(entry) = table.entry("roughness") {
            layer.roughness = read_roughness(&entry, &layer, found)?;
        }
        Ok(layer)
    })
}

/// The layer without its roughness and its links.
fn read_masses(table: &mut TableReader<'_>, form: Form) -> Result<Layer, SceneError> {
    let masses = table.required("masses", allowed::MASSES)?.whole(&allowed::MASSES)?;
    Ok(Layer {
        masses: usize::try_from(masses).unwrap_or(usize::MAX),
        spacing: table.number("spacing", &allowed::SPACING)?,
        origin: table.optional_number("origin", &allowed::PLACE)?.unwrap_or(0.0),
        clearance: table.optional_number("clearance", &allowed::HEIGHT)?.unwrap_or(0.0),
        mass: form.number(Form::Direct, table, "mass", &allowed::MASS)?,
        thickness: form.number(Form::Material, table, "thickness", &allowed::THICKNESS)?,
        width: form.number(Form::Material, table, "width", &allowed::WIDTH)?,
        initial: table.optional_choice("initial", &allowed::INITIAL)?.unwrap_or(Initial::Relaxed),
        roughness: Vec::new(),
        vertical: None,
        horizontal: None,
        lateral_x: None,
        lateral_z: None,
    })
}

fn read_link(table: &mut TableReader<'_>) -> Result<Link, SceneError> {
    table.allow(&["stiffness", "damping", "maxwell"])?;
    Ok(Link {
        stiffness: table.optional_number("stiffness", &allowed::STIFFNESS)?,
        damping: table.optional_number("damping", &allowed::DAMPING)?,
        maxwell: table.tables("maxwell", read_maxwell)?,
    })
}

fn read_maxwell(table: &mut TableReader<'_>) -> Result<MaxwellElement, SceneError> {
    table.allow(&["stiffness", "relaxation_time"])?;
    Ok(MaxwellElement {
        stiffness: table.number("stiffness", &allowed::STIFFNESS)?,
        relaxation_time: table.number("relaxation_time", &allowed::RELAXATION_TIME)?,
    })
}

/// The roughness at the masses: given there, or a surface sampled at the masses' places. A flat one is none.
fn read_roughness(entry: &Entry<'_>, layer: &Layer, found: &mut Found) -> Result<Vec<f64>, SceneError> {
    let mut table = entry.table()?;
    let kind = table.required(KIND, allowed::SURFACE)?.choice(&allowed::SURFACE)?;
    match (kind, table.entry("x")) {
        (SurfaceKind::Flat, _) => surface::read_surface(entry, found).map(|_| Vec::new()),
        (SurfaceKind::Points, None) => read_heights(&mut table, layer.masses),
        _ => sample(entry, layer, found),
    }
}

/// `z` without `x`: one height a mass.
fn read_heights(table: &mut TableReader<'_>, masses: usize) -> Result<Vec<f64>, SceneError> {
    table.allow(&[KIND, "z", "x", "periodic"])?;
    if let Some(entry) = table.entry("periodic") {
        return Err(entry.refuse("no such key for heights at the masses, which have no x"));
    }
    let expected = format!("{masses} heights, one a mass (layer.masses)");
    let entry = table.required("z", &expected)?;
    let heights = entry.numbers(&allowed::HEIGHT)?;
    if heights.len() == masses { Ok(heights) } else { Err(entry.refuse_count(heights.len(), &expected)) }
}

fn sample(entry: &Entry<'_>, layer: &Layer, found: &mut Found) -> Result<Vec<f64>, SceneError> {
    let surface = surface::read_surface(entry, found)?;
    found.warnings.extend(warnings::short_roughness(layer, &surface));
    let spline = surface.spline();
    let heights: Vec<f64> = (0..layer.masses).map(|i| spline.evaluate(layer.place(i)).0).collect();
    let finite = heights.iter().all(|height| height.is_finite());
    if finite { Ok(heights) } else { Err(entry.refuse("finite heights at the masses")) }
}

impl Layer {
    /// Place X_i of mass `i` (from 0) at rest, m.
    pub fn place(&self, i: usize) -> f64 {
        self.origin + i as f64 * self.spacing
    }
}
