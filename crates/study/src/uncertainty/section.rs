//! What is not known of a scene: how far its numbers may be off, as the section `[uncertainty]` of its file says. Nothing
//! of a run depends on it.

use std::path::{Path, PathBuf};

use asperity::scene::{FineWaves, Scene, read_text};
use asperity::tables::{NumberRange, POSITIVE};
use toml::{Table, Value};

use super::covariance::{CANNOT_SAY, Covariance, LARGEST_FILE, Scale};
use crate::error::Error;

/// What is not known of a scene; empty where it does not say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Uncertainty {
    /// What may be off by itself, in the order of the keys.
    pub keys: Vec<UncertainKey>,
    /// Numbers that were fitted together; `None` without.
    pub covariance: Option<Covariance>,
}

/// A key of the scene, and how far what it says may be off.
#[derive(Clone, Debug, PartialEq)]
pub struct UncertainKey {
    /// The path of the key, elements of lists counted from 1.
    pub key: String,
    /// What may be off, and how.
    pub spread: Spread,
}

/// How far something may be off.
#[derive(Clone, Debug, PartialEq)]
pub enum Spread {
    /// A number.
    Number {
        /// What the scene says, in SI units.
        value: f64,
        /// How far it may be off.
        distribution: Distribution,
    },
    /// All moduli of the Prony series: log-normal, with one normal process over the logarithm of the relaxation time.
    Prony {
        /// Standard deviation of the logarithm of each modulus.
        relative: f64,
        /// log10 of the relaxation times over 1 s.
        decades: Vec<f64>,
    },
    /// The density of the spectrum of profile and bands: log-normal.
    Spectrum {
        /// Standard deviation of the logarithm.
        relative: f64,
        /// The [decades](asperity::scene::decade_of) of wavelengths that differ by themselves; `None`: one factor for all.
        decades: Option<Vec<i32>>,
    },
    /// Another self-affine surface of the same law each time.
    Seed,
}

/// How a number is distributed about what the scene says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// Log-normal: the standard deviation of the logarithm.
    Relative(f64),
    /// Log-uniform from one over this to this times the number.
    Factor(f64),
    /// Normal: the standard deviation, in the unit of the number.
    Absolute(f64),
}

/// The section of the file.
const SECTION: &str = "uncertainty";
/// Its key of the file of a covariance.
const COVARIANCE: &str = "covariance";
/// What a key of a number is set to.
const SPREADS: &str = "{ relative = ... }, { factor = ... } or { absolute = ... }";

type Result<T> = std::result::Result<T, Error>;

impl Uncertainty {
    /// The moduli of the Prony series.
    pub const PRONY: &str = "material.prony";
    /// The density of the spectrum.
    pub const SPECTRUM: &str = "surface.spectrum";
    /// The seed of a self-affine surface.
    pub const SURFACE: &str = "surface";

    /// What the section of the file of a `scene` says, and what to look at in it.
    ///
    /// # Errors
    /// With file, line and key, where the section names what the scene does not have or what cannot be drawn.
    pub fn of(scene: &Scene) -> Result<(Self, Vec<String>)> {
        let (mut uncertainty, mut warnings) = (Self::default(), Vec::new());
        let Some(section) = scene.values.get(SECTION).and_then(Value::as_table) else {
            return Ok((uncertainty, warnings));
        };
        for (key, value) in section.iter().filter(|(key, _)| *key != COVARIANCE) {
            let spread = SpreadEntry { scene, key, value }.read()?;
            uncertainty.keys.push(UncertainKey { key: key.clone(), spread });
        }
        if section.contains_key(COVARIANCE) {
            let (covariance, found) = fitted(scene)?;
            uncertainty.covariance = Some(covariance);
            warnings.extend(found);
        }
        uncertainty.check_once(scene, section)?;
        Ok((uncertainty, warnings))
    }

    /// Whether everything is known.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty() && self.covariance.is_none()
    }

    /// Refuses what would be drawn twice.
    fn check_once(&self, scene: &Scene, section: &Table) -> Result<()> {
        let numbers = self.covariance.iter().flat_map(|covariance| &covariance.numbers);
        let fitted: Vec<&str> = numbers.map(|number| number.key.as_str()).collect();
        let is_modulus = |key: &str| {
            key.strip_prefix(Self::PRONY).is_some_and(|rest| rest.starts_with('[')) && key.ends_with(".modulus")
        };
        let has_prony = section.contains_key(Self::PRONY);
        for key in section.keys() {
            let expected = match key.as_str() {
                key if fitted.contains(&key) => "no such key: the covariance has it",
                key if has_prony && is_modulus(key) => "no such key beside \"material.prony\", which has all moduli",
                Self::PRONY if fitted.iter().any(|key| is_modulus(key)) => {
                    "no such key: the covariance has moduli of the series"
                }
                _ => continue,
            };
            return Err(refused(scene, key, expected));
        }
        Ok(())
    }
}

/// The path of a key of the section.
fn path(key: &str) -> String {
    format!("{SECTION}.\"{key}\"")
}

fn refused(scene: &Scene, key: &str, expected: impl ToString) -> Error {
    scene.values.refuse(&path(key), expected).into()
}

/// A key of the section and what it is set to.
struct SpreadEntry<'a> {
    scene: &'a Scene,
    key: &'a str,
    value: &'a Value,
}

impl SpreadEntry<'_> {
    fn refuse(&self, expected: impl ToString) -> Error {
        refused(self.scene, self.key, expected)
    }

    fn read(&self) -> Result<Spread> {
        match self.key {
            Uncertainty::PRONY => self.prony(),
            Uncertainty::SPECTRUM => self.spectrum(),
            Uncertainty::SURFACE => self.surface(),
            _ => self.number(),
        }
    }

    /// The table that it is, with these keys alone.
    fn table(&self, allowed: &[&str]) -> Result<&Table> {
        let table = self.value.as_table().ok_or_else(|| self.refuse("a table"))?;
        match table.keys().find(|key| !allowed.contains(&key.as_str())) {
            Some(key) => Err(self.scene.values.unknown(&format!("{}.{key}", path(self.key)), allowed).into()),
            None => Ok(table),
        }
    }

    /// A number of the table in a range; `None` where it is not there.
    fn part(&self, table: &Table, name: &str, range: NumberRange) -> Result<Option<f64>> {
        let Some(value) = table.get(name) else { return Ok(None) };
        let number = value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
        let refused = || Error::from(self.scene.values.refuse(&format!("{}.{name}", path(self.key)), range));
        number.filter(|number| range.holds(*number)).map(Some).ok_or_else(refused)
    }

    fn relative(&self, table: &Table) -> Result<f64> {
        self.part(table, "relative", POSITIVE)?.ok_or_else(|| self.refuse("{ relative = ... }"))
    }

    fn prony(&self) -> Result<Spread> {
        let relative = self.relative(self.table(&["relative"])?)?;
        let terms = self.scene.material.iter().flat_map(|material| &material.prony);
        match terms.clone().count() {
            0 => Err(self.refuse("no such key: the scene has no Prony series")),
            _ => Ok(Spread::Prony { relative, decades: terms.map(|term| term.relaxation_time.log10()).collect() }),
        }
    }

    fn spectrum(&self) -> Result<Spread> {
        let table = self.table(&["relative", "each"])?;
        let relative = self.relative(table)?;
        let has_each = table.contains_key("each");
        if has_each && table.get("each").and_then(Value::as_str) != Some("decade") {
            let each = format!("{}.each", path(self.key));
            return Err(self.scene.values.refuse(&each, "one of \"decade\"").into());
        }
        let decades = self.scene.spectrum_decades();
        let has_modulus = self.scene.fine.as_ref().is_some_and(|fine| matches!(fine.waves, FineWaves::Modulus { .. }));
        if decades.is_empty() && !has_modulus {
            return Err(self.refuse("no such key: the surface is flat and has no surface.fine"));
        }
        if has_each && has_modulus {
            return Err(self.refuse("no `each` beside surface.fine.modulus, whose waves have no lengths"));
        }
        Ok(Spread::Spectrum { relative, decades: has_each.then_some(decades) })
    }

    fn surface(&self) -> Result<Spread> {
        match (self.value.as_str(), self.scene.surface.self_affine()) {
            (None, _) => {
                Err(self.refuse("\"seed\", or the whole path of a number in quotation marks, as \"surface.rms\""))
            }
            (Some("seed"), Some(_)) => Ok(Spread::Seed),
            (Some("seed"), None) => {
                Err(self.refuse("no such key: only a surface with kind = \"self_affine\" has a seed"))
            }
            (Some(_), _) => Err(self.refuse("one of \"seed\"")),
        }
    }

    fn number(&self) -> Result<Spread> {
        const KEYS: [&str; 3] = ["relative", "factor", "absolute"];
        let own = self.value.as_table();
        if Scene::is_table(self.key) && own.is_some_and(|table| !KEYS.iter().any(|key| table.contains_key(*key))) {
            let example = "\"friction.rate_shear.strength\" = { relative = 0.1 }";
            return Err(self.refuse(format_args!("the whole path of a number in quotation marks, as {example}")));
        }
        let number = self.scene.number_or_following(self.key);
        let number = number.map_err(|error| self.scene.values.error(&path(self.key), error.problem().clone()))?;
        let table = if own.is_some() { self.table(&KEYS)? } else { return Err(self.refuse(SPREADS)) };
        let absolute = match table.get("absolute") {
            Some(value) => Some(number.unit.difference(value).map_err(|expected| {
                Error::from(self.scene.values.refuse(&format!("{}.absolute", path(self.key)), expected))
            })?),
            None => None,
        };
        let relative = self.part(table, "relative", POSITIVE)?;
        let factor = self.part(table, "factor", POSITIVE.down_to(1.0))?;
        let distribution = match (relative, factor, absolute) {
            (Some(relative), None, None) => Distribution::Relative(relative),
            (None, Some(factor), None) => Distribution::Factor(factor),
            (None, None, Some(absolute)) => Distribution::Absolute(absolute),
            _ => return Err(self.refuse(SPREADS)),
        };
        if number.value <= 0.0 && absolute.is_none() {
            let (key, value) = (self.key, number.value);
            return Err(self.refuse(format_args!("{{ absolute = ... }}, for {key} is {value:?}")));
        }
        Ok(Spread::Number { value: number.value, distribution })
    }
}

/// The file of the covariance that the section names, relative to the scene's folder.
pub fn covariance_file(scene: &Scene) -> Option<PathBuf> {
    Some(scene.values.get(SECTION)?.get(COVARIANCE)?.as_str()?.into())
}

/// The covariance in the file that the section names, about what the scene says; and what to look at: numbers that were
/// fitted as something else, and data that the scene could not say.
fn fitted(scene: &Scene) -> Result<(Covariance, Vec<String>)> {
    let key = format!("{SECTION}.{COVARIANCE}");
    let refused = |expected: String| Error::from(scene.values.refuse(&key, expected));
    let file = covariance_file(scene).ok_or_else(|| refused("the path of a file".to_owned()))?;
    let place = scene.values.file().parent().unwrap_or(Path::new("")).join(&file);
    let text = read_text(&place)
        .map_err(Error::io("read", &place))
        .map_err(|error| refused(format!("a file that can be read: {error}")))?;
    if text.len() > LARGEST_FILE {
        return Err(refused(format!("a file of a covariance, of at most {LARGEST_FILE} bytes, found {}", text.len())));
    }
    let table = asperity::table::Table::parse(&text, &place)?;
    let mut covariance = Covariance::of(&table, file.clone())?;
    let mut moved = Vec::new();
    for (row, fitted) in covariance.numbers.iter_mut().enumerate() {
        let refused = |problem: String| Error::from(table.error_in(row, problem));
        let number = scene.number_or_following(&fitted.key).map_err(|error| refused(error.to_string()))?;
        if number.value <= 0.0 && fitted.scale == Scale::Log {
            let (key, value) = (&fitted.key, number.value);
            return Err(refused(format!("{key} = {value:?}: expected a number above 0, whose logarithm was fitted")));
        }
        if fitted.is_moved(number.value) {
            moved.push(format!("{} was fitted as {:?} and is {:?}", fitted.key, fitted.value, number.value));
        }
        fitted.value = number.value;
    }
    let said = || format!("{}: {}; samples vary about what the scene says", file.display(), moved.join(", "));
    let moved = (!moved.is_empty()).then(said);
    let misfit = text.lines().filter_map(|line| line.strip_prefix("# ")).find(|line| line.starts_with(CANNOT_SAY));
    let misfit = misfit.map(|misfit| format!("{}: {misfit}", file.display()));
    Ok((covariance, moved.into_iter().chain(misfit).collect()))
}
