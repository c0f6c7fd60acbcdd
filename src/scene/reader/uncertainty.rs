//! Reading of `[uncertainty]`: what is not known of a scene.

use super::surface::{Findings, read_path};
use super::table::{Entry, Result, TableReader};
use crate::scene::error::{Location, Problem};
use crate::scene::keys::{self, Allowed, At, ROOT, SPREAD};
use crate::scene::uncertainty::{Each, Other, read_covariance};
use crate::scene::values::Value;
use crate::scene::{
    Covariance, Distribution, FineWaves, FittedNumber, Scale, Scene, SceneError, Spread, UncertainKey, Uncertainty,
    Unit,
};

/// What a key of a number is set to.
const SPREADS: &str = "{ relative = ... }, { factor = ... } or { absolute = ... }";

/// What the section says of the `scene`, all of which is read; the file that it names is added to those `found`.
pub(super) fn read(root: &mut TableReader<'_>, scene: &Scene, found: &mut Findings) -> Result<Uncertainty> {
    let Some(section) = root.entry("uncertainty") else { return Ok(Uncertainty::default()) };
    let mut table = section.open()?;
    let mut uncertainty = Uncertainty::default();
    let covariance = table.entry("covariance");
    for (name, entry) in table.entries(&SPREAD).into_iter().filter(|(name, _)| name != "covariance") {
        let spread = read_spread(root, &name, &entry, scene)?;
        uncertainty.keys.push(UncertainKey { key: name, spread });
    }
    uncertainty.keys.sort_by(|one, other| one.key.cmp(&other.key));
    uncertainty.covariance = covariance.map(|entry| read_fitted(root, &entry, scene, found)).transpose()?;
    check_once(&table, &uncertainty)?;
    Ok(uncertainty)
}

fn read_spread(root: &TableReader<'_>, name: &str, entry: &Entry<'_>, scene: &Scene) -> Result<Spread> {
    match name {
        Uncertainty::PRONY => read_prony(entry, scene),
        Uncertainty::SPECTRUM => read_spectrum(entry, scene),
        Uncertainty::SURFACE => read_surface(entry, scene),
        _ => read_number(root, name, entry, scene),
    }
}

/// The standard deviation of the logarithm of what has no other.
fn read_relative(entry: &Entry<'_>, others: &[&'static str]) -> Result<f64> {
    entry.table(|table| {
        let relative = table.number("relative")?;
        others.iter().for_each(|name| drop(table.entry(name)));
        Ok(relative)
    })
}

fn read_prony(entry: &Entry<'_>, scene: &Scene) -> Result<Spread> {
    let relative = read_relative(entry, &[])?;
    let terms = scene.material.iter().flat_map(|material| &material.prony);
    match terms.clone().count() {
        0 => Err(entry.refuse("no such key: the scene has no Prony series")),
        _ => Ok(Spread::of_prony(relative, terms.map(|term| term.relaxation_time))),
    }
}

fn read_spectrum(entry: &Entry<'_>, scene: &Scene) -> Result<Spread> {
    let relative = read_relative(entry, &["each"])?;
    let each = entry.open()?.optional_choice::<Each>("each")?;
    let decades = scene.spectrum_decades();
    let has_modulus = scene.fine.as_ref().is_some_and(|fine| matches!(fine.waves, FineWaves::Modulus { .. }));
    if decades.is_empty() && !has_modulus {
        return Err(entry.refuse("no such key: the surface is flat and has no surface.fine"));
    }
    if each.is_some() && has_modulus {
        return Err(entry.refuse("no `each` beside surface.fine.modulus, whose waves have no lengths"));
    }
    Ok(Spread::Spectrum { relative, decades: each.map(|_| decades) })
}

fn read_surface(entry: &Entry<'_>, scene: &Scene) -> Result<Spread> {
    if !entry.is_text() {
        return Err(entry.refuse("\"seed\", or the whole path of a number in quotation marks, as \"surface.rms\""));
    }
    entry.choice::<Other>()?;
    match scene.surface.self_affine() {
        Some(_) => Ok(Spread::Seed),
        None => Err(entry.refuse("no such key: only a surface with kind = \"self_affine\" has a seed")),
    }
}

fn read_number(root: &TableReader<'_>, name: &str, entry: &Entry<'_>, scene: &Scene) -> Result<Spread> {
    let is_nested = |table: &TableReader<'_>| ["relative", "factor", "absolute"].iter().all(|key| !table.has(key));
    let is_table = keys::find(ROOT, name).is_some_and(|(key, _)| !key.keys().is_empty());
    if is_table && entry.open().is_ok_and(|table| is_nested(&table)) {
        let expected =
            "the whole path of a number in quotation marks, as \"friction.rate_shear.strength\" = { relative = 0.1 }";
        return Err(entry.refuse(expected));
    }
    let number = number_of(root, name, scene).map_err(|problem| entry.error(problem))?;
    if entry.open().is_err() {
        return Err(entry.refuse(SPREADS));
    }
    let distribution = entry.table(|table| read_distribution(table, number.unit))?;
    let Some(distribution) = distribution else { return Err(entry.refuse(SPREADS)) };
    if number.value <= 0.0 && !matches!(distribution, Distribution::Absolute(_)) {
        return Err(entry.refuse(format_args!("{{ absolute = ... }}, for {name} is {:?}", number.value)));
    }
    Ok(Spread::Number { value: number.value, distribution })
}

/// The one distribution that is given; `None` of none or several.
fn read_distribution(table: &mut TableReader<'_>, unit: Unit) -> Result<Option<Distribution>> {
    let relative = table.optional_number("relative")?.map(Distribution::Relative);
    let factor = table.optional_number("factor")?.map(Distribution::Factor);
    let absolute = table.entry("absolute").map(|entry| entry.difference(unit)).transpose()?.map(Distribution::Absolute);
    let mut given = [relative, factor, absolute].into_iter().flatten();
    Ok(given.next().filter(|_| given.next().is_none()))
}

/// A number of the scene.
struct SceneNumber {
    value: f64,
    unit: Unit,
}

/// The number at the path of a key: as the file has it, or as it follows.
fn number_of(root: &TableReader<'_>, path: &str, scene: &Scene) -> std::result::Result<SceneNumber, Problem> {
    let Some((key, at)) = keys::find(ROOT, path).filter(|_| path != keys::RETIRED) else {
        return Err(root.unknown_path(path));
    };
    if !matches!(key.allowed, Allowed::Number(_)) {
        return Err(Problem::value(path, "the key of a number that may have any value in a range"));
    }
    let in_file = root.at(path, key).and_then(|entry| entry.number().ok());
    let value = in_file.or_else(|| match (key.field?.get)(scene, at.element(element_of(path)?))? {
        Value::Real(number) => Some(number),
        _ => None,
    });
    match value {
        Some(value) => Ok(SceneNumber { value, unit: key.unit }),
        None => Err(Problem::value(path, "the key of a number that the scene has")),
    }
}

/// The element of the list in a path, from 0; 0 without one.
fn element_of(path: &str) -> Option<usize> {
    let Some((_, rest)) = path.split_once('[') else { return Some(At::FIRST.index) };
    rest.split_once(']')?.0.parse::<usize>().ok()?.checked_sub(1)
}

fn read_fitted(root: &TableReader<'_>, entry: &Entry<'_>, scene: &Scene, found: &mut Findings) -> Result<Covariance> {
    let path = read_path(entry)?;
    let (mut covariance, lines) = found.read_file(entry, &path, read_covariance)?;
    let mut moved = Vec::new();
    for (fitted, line) in covariance.numbers.iter_mut().zip(lines) {
        let refused = |problem| {
            SceneError::new(
                Location { file: entry.source().values.folder().join(&path), line: Some(line) },
                &fitted.key,
                problem,
            )
        };
        let number = number_of(root, &fitted.key, scene).map_err(refused)?;
        if number.value <= 0.0 && fitted.scale == Scale::Log {
            let problem = Problem::value(number.value, "a number above 0, whose logarithm was fitted");
            return Err(refused(problem));
        }
        if fitted.is_moved(number.value) {
            moved.push(format!("{} was fitted as {:?} and is {:?}", fitted.key, fitted.value, number.value));
        }
        *fitted = FittedNumber { value: number.value, ..fitted.clone() };
    }
    if !moved.is_empty() {
        let what = moved.join(", ");
        found.warnings.push(format!("{}: {what}; samples vary about what the scene says", path.display()));
    }
    Ok(covariance.of_file(&path))
}

/// Refuses what would be drawn twice.
fn check_once(table: &TableReader<'_>, uncertainty: &Uncertainty) -> Result<()> {
    let fitted: Vec<&str> = uncertainty
        .covariance
        .iter()
        .flat_map(|covariance| &covariance.numbers)
        .map(|number| number.key.as_str())
        .collect();
    let is_in = |list: &str, key: &str| key.strip_prefix(list).is_some_and(|rest| rest.starts_with('['));
    let has = |name: &str| uncertainty.keys.iter().any(|other| other.key == name);
    for (name, entry) in table.entries(&SPREAD) {
        if fitted.contains(&name.as_str()) {
            return Err(entry.refuse("no such key: the covariance has it"));
        }
        if has(Uncertainty::PRONY) && is_in(Uncertainty::PRONY, &name) && name.ends_with(".modulus") {
            return Err(entry.refuse("no such key beside \"material.prony\", which has all moduli"));
        }
    }
    let modulus = fitted.iter().find(|key| is_in(Uncertainty::PRONY, key) && key.ends_with(".modulus"));
    match (modulus, table.entries(&SPREAD).into_iter().find(|(name, _)| name == Uncertainty::PRONY)) {
        (Some(_), Some((_, entry))) => Err(entry.refuse("no such key: the covariance has moduli of the series")),
        _ => Ok(()),
    }
}
