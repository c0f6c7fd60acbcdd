//! Values of keys and parameters: ranges of numbers, words to choose from, units.

use std::f64::consts::TAU;
use std::fmt;

use serde::{Deserialize, Serialize};

pub(super) use crate::tables::{ANY, LARGEST, NOT_NEGATIVE, NumberRange, POSITIVE, SMALLEST};
use crate::tables::{Dimension, quantity};

/// Whether a carrier or a master may give `number`: it is one, and of a size up to [`LARGEST`].
pub fn is_possible(number: f64) -> bool {
    number.abs() <= LARGEST
}

/// Whole numbers from `low` to `high`, both included.
#[derive(Clone, Copy, Debug)]
pub(super) struct WholeRange {
    pub(super) low: i64,
    pub(super) high: i64,
}

impl WholeRange {
    pub(super) fn holds(&self, number: i64) -> bool {
        (self.low..=self.high).contains(&number)
    }
}

/// A choice that a scene makes by a word.
pub(super) trait Word: Copy + PartialEq + 'static {
    /// The words, and what each stands for.
    const WORDS: &'static [(&'static str, Self)];

    fn parse(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(name, _)| *name == word).map(|(_, choice)| *choice)
    }

    fn as_word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, other)| *other == self).map_or("", |(word, _)| word)
    }
}

/// The words to choose from: `one of "a", "b"`.
pub(super) fn words<T: Word>() -> String {
    let quoted: Vec<String> = T::WORDS.iter().map(|(word, _)| format!("\"{word}\"")).collect();
    format!("one of {}", quoted.join(", "))
}

/// Those of `paths`, but `given` itself, that look most like it, or end with it.
pub(super) fn closest(given: &str, paths: impl Iterator<Item = String>) -> Vec<String> {
    let difference = |path: &str| if is_end_of(given, path) { 0 } else { strsim::levenshtein(given, path) };
    let similar = paths.filter(|path| path != given && is_similar(given, path)).map(|path| (difference(&path), path));
    let mut similar: Vec<(usize, String)> = similar.collect();
    similar.sort_unstable();
    similar.dedup();
    let least = similar.first().map_or(0, |(difference, _)| *difference);
    similar.into_iter().take_while(|(difference, _)| *difference == least).map(|(_, path)| path).collect()
}

/// Whether a few letters differ, or only the end of the path is given.
pub(super) fn is_similar(given: &str, name: &str) -> bool {
    is_end_of(given, name) || strsim::levenshtein(given, name) <= 1 + given.chars().count() / 8
}

fn is_end_of(given: &str, path: &str) -> bool {
    path.strip_suffix(given).is_some_and(|start| start.ends_with('.'))
}

/// The word in quotation marks within `expected` that looks most like `given`: hyphens, blanks and capitals do not count.
pub(super) fn similar_word<'a>(given: &str, expected: &'a str) -> Option<&'a str> {
    let plain = |word: &str| word.to_lowercase().replace(['-', '_', ' '], "");
    let wanted = plain(given);
    let most = 1 + wanted.chars().count() / 4;
    let difference = |word: &&str| strsim::levenshtein(&wanted, &plain(word));
    // Units and other short words are like too many.
    let is_long = |word: &&str| word.chars().count() >= 4 || plain(word) == wanted;
    let words = expected.split('"').skip(1).step_by(2).filter(|word| *word != given && is_long(word));
    words.filter(|word| difference(word) <= most).min_by_key(difference)
}

impl fmt::Display for WholeRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a whole number from {} to {}", self.low, self.high)
    }
}

/// A parameter's value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Value {
    /// A Real of FMI.
    Real(f64),
    /// An Integer of FMI.
    Integer(i32),
    /// A String of FMI.
    Text(String),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Real(number) => write!(f, "{number:?}"),
            Self::Integer(number) => write!(f, "{number}"),
            Self::Text(word) => write!(f, "{word:?}"),
        }
    }
}

/// As a file has it.
impl From<Value> for toml::Value {
    fn from(value: Value) -> Self {
        match value {
            Value::Real(number) => number.into(),
            Value::Integer(number) => number.into(),
            Value::Text(word) => word.into(),
        }
    }
}

/// The largest relative tolerance.
pub const LOOSEST_TOLERANCE: f64 = 0.1;

/// An SI unit of a variable or a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Unit {
    /// 1, a plain number.
    One,
    /// m.
    Meter,
    /// s.
    Second,
    /// m/s.
    MeterPerSecond,
    /// kg.
    Kilogram,
    /// N.
    Newton,
    /// N/m.
    NewtonPerMeter,
    /// Pa/m.
    PascalPerMeter,
    /// m/N.
    MeterPerNewton,
    /// 1/s.
    PerSecond,
    /// m/(N s).
    MeterPerNewtonSecond,
    /// N s/m.
    NewtonSecondPerMeter,
    /// K.
    Kelvin,
    /// m².
    SquareMeter,
    /// m³.
    CubicMeter,
    /// m³/s.
    CubicMeterPerSecond,
    /// kg/m³.
    KilogramPerCubicMeter,
    /// Pa.
    Pascal,
    /// Pa s.
    PascalSecond,
    /// W/(m K).
    WattPerMeterKelvin,
    /// J/(kg K).
    JoulePerKilogramKelvin,
    /// Hz.
    Hertz,
    /// J.
    Joule,
    /// W.
    Watt,
    /// rad.
    Radian,
    /// N m.
    NewtonMeter,
    /// N/rad.
    NewtonPerRadian,
    /// N m/rad.
    NewtonMeterPerRadian,
    /// N/s.
    NewtonPerSecond,
    /// Pa/s.
    PascalPerSecond,
}

impl Unit {
    /// What tables and texts with units call the quantity; `None` where they have none.
    fn dimension(self) -> Option<Dimension> {
        Some(match self {
            Self::One => Dimension::Number,
            Self::Meter => Dimension::Length,
            Self::Second => Dimension::Time,
            Self::MeterPerSecond => Dimension::Speed,
            Self::Kilogram => Dimension::Mass,
            Self::Newton => Dimension::Force,
            Self::NewtonPerMeter => Dimension::Stiffness,
            Self::Kelvin => Dimension::Temperature,
            Self::SquareMeter => Dimension::Area,
            Self::KilogramPerCubicMeter => Dimension::Density,
            Self::Pascal => Dimension::Pressure,
            Self::Hertz => Dimension::Frequency,
            Self::Radian => Dimension::Angle,
            _ => return None,
        })
    }

    /// The number of a text such as `8 MPa`, in this unit; `None` where the text is no number with a unit of this
    /// quantity behind it.
    pub(super) fn read(self, text: &str) -> Option<f64> {
        let (number, unit) = quantity(text, self.dimension()?)?;
        unit.map(|_| if self == Self::Hertz { number / TAU } else { number })
    }

    /// A difference above 0 of numbers of this unit: a number in SI units, or a text such as `2 °C`.
    ///
    /// # Errors
    /// What is expected.
    pub fn difference(self, value: &toml::Value) -> Result<f64, String> {
        let plain = value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
        let read = plain.or_else(|| self.read_difference(value.as_str()?));
        read.filter(|&number| POSITIVE.holds(number)).ok_or_else(|| match self.readable() {
            units if units.is_empty() => POSITIVE.to_string(),
            units => format!("{POSITIVE}, in SI units or as a text with its unit, one of {units}"),
        })
    }

    /// The difference of two numbers that a text gives, in this unit, as [`read`](Self::read) a number.
    fn read_difference(self, text: &str) -> Option<f64> {
        let (number, unit) = quantity(text, self.dimension()?)?;
        let difference = number - unit?.to_si(0.0);
        Some(if self == Self::Hertz { difference / TAU } else { difference })
    }

    /// The units that [`read`](Self::read) knows, for messages; empty where there is none.
    pub(super) fn readable(self) -> String {
        self.dimension().map(Dimension::units).unwrap_or_default()
    }

    /// The unit's name in the model description.
    pub fn name(self) -> &'static str {
        self.definition().0
    }

    /// The exponents of kg, m, s and K in the unit.
    pub fn exponents(self) -> [i32; 4] {
        self.definition().1
    }

    /// The exponent of rad in the unit.
    pub fn exponent_of_radian(self) -> i32 {
        match self {
            Self::Radian => 1,
            Self::NewtonPerRadian | Self::NewtonMeterPerRadian => -1,
            _ => 0,
        }
    }

    /// The name, and the exponents of kg, m, s and K.
    fn definition(self) -> (&'static str, [i32; 4]) {
        match self {
            Self::One => ("1", [0, 0, 0, 0]),
            Self::Meter => ("m", [0, 1, 0, 0]),
            Self::Second => ("s", [0, 0, 1, 0]),
            Self::MeterPerSecond => ("m/s", [0, 1, -1, 0]),
            Self::Kilogram => ("kg", [1, 0, 0, 0]),
            Self::NewtonPerSecond => ("N/s", [1, 1, -3, 0]),
            Self::PascalPerSecond => ("Pa/s", [1, -1, -3, 0]),
            Self::Newton => ("N", [1, 1, -2, 0]),
            Self::MeterPerNewton => ("m/N", [-1, 0, 2, 0]),
            Self::PerSecond => ("1/s", [0, 0, -1, 0]),
            Self::MeterPerNewtonSecond => ("m/(N.s)", [-1, 0, 1, 0]),
            Self::NewtonPerMeter => ("N/m", [1, 0, -2, 0]),
            Self::PascalPerMeter => ("Pa/m", [1, -2, -2, 0]),
            Self::NewtonSecondPerMeter => ("N.s/m", [1, 0, -1, 0]),
            Self::Kelvin => ("K", [0, 0, 0, 1]),
            Self::SquareMeter => ("m2", [0, 2, 0, 0]),
            Self::CubicMeter => ("m3", [0, 3, 0, 0]),
            Self::CubicMeterPerSecond => ("m3/s", [0, 3, -1, 0]),
            Self::KilogramPerCubicMeter => ("kg/m3", [1, -3, 0, 0]),
            Self::Pascal => ("Pa", [1, -1, -2, 0]),
            Self::PascalSecond => ("Pa.s", [1, -1, -1, 0]),
            Self::WattPerMeterKelvin => ("W/(m.K)", [1, 1, -3, -1]),
            Self::JoulePerKilogramKelvin => ("J/(kg.K)", [0, 2, -2, -1]),
            Self::Hertz => ("Hz", [0, 0, -1, 0]),
            Self::Joule => ("J", [1, 2, -2, 0]),
            Self::Watt => ("W", [1, 2, -3, 0]),
            Self::Radian => ("rad", [0, 0, 0, 0]),
            Self::NewtonMeter => ("N.m", [1, 2, -2, 0]),
            Self::NewtonPerRadian => ("N/rad", [1, 1, -2, 0]),
            Self::NewtonMeterPerRadian => ("N.m/rad", [1, 2, -2, 0]),
        }
    }
}
