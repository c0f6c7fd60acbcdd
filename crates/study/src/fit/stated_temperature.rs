//! Temperatures and frequencies that stand above a table, not in a column: in the line above its names, in a line of settings.

use asperity::scene::Wlf;
use asperity::tables::{ContentError, Dimension, Unit};
use asperity_formats::text::{Block, number};

use super::columns::given_unit;
use super::heading::find_quantity;
use super::reading::GivenUnits;

/// The temperature in a text, K.
fn temperature(text: &str) -> Option<f64> {
    find_quantity(text, Dimension::Temperature).map(|(_, kelvin)| kelvin)
}

/// The temperatures or frequencies in the line above the names, in SI units: each holds to the next one.
pub(super) fn conditions_above(
    block: &Block<'_>,
    names: usize,
    units: &GivenUnits,
    dimension: Dimension,
) -> Result<Vec<Option<f64>>, ContentError> {
    let Some(&(line, text)) = block.above.iter().rev().find(|(line, _)| *line < names) else { return Ok(Vec::new()) };
    let Some(fields) = block.fields(text) else { return Ok(Vec::new()) };
    let given = units.iter().map(|(_, unit)| *unit).find(|unit| unit.dimension == dimension);
    let of_line = given.or_else(|| unit_of(text, dimension));
    let is_kelvin = |value: f64| dimension == Dimension::Temperature && value >= Wlf::COLDEST;
    let (mut found, mut last) = (Vec::new(), None);
    for (index, field) in fields.iter().enumerate() {
        let named = find_quantity(field, dimension).map(|(_, value)| value);
        let bare = number(field);
        match (named, bare, of_line) {
            (Some(value), _, _) => last = Some(value),
            (None, Some(value), Some(unit)) => last = Some(unit.to_si(value)),
            (None, Some(value), None) if is_kelvin(value) => last = Some(value),
            (None, Some(_), None) => {
                let expected = match dimension {
                    Dimension::Frequency => "a unit of frequency, as in 1 Hz, above each pair of columns",
                    _ => "a unit of temperature, as in 20 °C, above each pair of columns; or `unit` temperature=°C",
                };
                let key = format!("column {}", index + 1);
                return Err(ContentError::value(Some(line), &key, &format!("\"{field}\""), expected));
            }
            (None, None, _) if field.is_empty() => (),
            (None, None, _) => last = None,
        }
        found.push(last);
    }
    Ok(found)
}

/// The unit of a dimension that a line names by itself, as in `T [°C],20,,40,`.
fn unit_of(line: &str, dimension: Dimension) -> Option<Unit> {
    let parts = line.split(|letter: char| letter.is_whitespace() || "[](),;:=/\t".contains(letter));
    parts.filter_map(Unit::parse).find(|unit| unit.dimension == dimension)
}

/// A temperature in a line of settings.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Setting {
    Kelvin(f64),
    /// The text of one without a unit.
    Bare(String),
}

/// The keys of a temperature of all rows, in lower case and without blanks.
const TEMPERATURE: [&str; 12] = [
    "t",
    "temp",
    "temperature",
    "sampletemperature",
    "sampletemp",
    "testtemperature",
    "testtemp",
    "measurementtemperature",
    "isothermaltemperature",
    "temperatur",
    "prüftemperatur",
    "probentemperatur",
];

/// The temperature of a line such as `Temperature: 20 °C` or `T=20;Mw=90`.
pub(super) fn setting(line: &str, units: &GivenUnits) -> Option<Setting> {
    line.split([';', '\t', ',']).find_map(|part| {
        let (name, value) = part.split_once(['=', ':']).or_else(|| part.split_once(char::is_whitespace))?;
        let bare = name.split(['[', '(']).next().unwrap_or_default().trim();
        let key: String = bare.to_lowercase().chars().filter(|letter| letter.is_alphanumeric()).collect();
        let digits = value.trim();
        let is_number = digits.starts_with(|letter: char| letter.is_ascii_digit() || letter == '-');
        if !(TEMPERATURE.contains(&key.as_str()) && is_number) || bare == "t" {
            return None;
        }
        if let Some(kelvin) = temperature(digits) {
            return Some(Setting::Kelvin(kelvin));
        }
        let unit = given_unit(name, units).or_else(|| unit_of(name, Dimension::Temperature));
        let number = number(digits);
        Some(match (unit, number) {
            (Some(unit), Some(number)) => Setting::Kelvin(unit.to_si(number)),
            _ => Setting::Bare(part.trim().to_owned()),
        })
    })
}
