//! What holds for a whole column, table or sheet of moduli: temperatures, frequencies and units that stand in a heading, above
//! the names, in a line of settings or in the name of a sheet; logarithms.

use std::ops::Range;

use asperity::scene::Wlf;
use asperity::tables::{ContentError, Dimension, Unit};
use asperity_formats::text::{Block, number, plain};

/// What a heading says of all numbers of its column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Condition {
    /// Which quantity it is.
    pub(super) dimension: Dimension,
    /// What that is, in SI units.
    pub(super) value: f64,
}

/// A heading without what it says of its whole column, that, and the base of the logarithm that it names.
pub(super) fn parted(name: &str) -> (String, Option<Condition>, Option<f64>) {
    let found = [Dimension::Temperature, Dimension::Frequency].into_iter();
    let found = found.filter_map(|dimension| without_condition(name, dimension)).next();
    let (name, condition) = found.map_or_else(|| (name.to_owned(), None), |(name, it)| (name, Some(it)));
    let plain = plain(&name);
    let (inner, logarithm) = without_logarithm(&plain);
    (inner.to_owned(), condition, logarithm)
}

/// A heading without what it says of all its column, as in `E' (MPa) @ 20 °C` and `E'' (f = 1 Hz)`, and that; `None` where
/// it says nothing of this dimension.
fn without_condition(text: &str, dimension: Dimension) -> Option<(String, Condition)> {
    /// What may stand before it: `E' at 20 °C`, `E', T = 20 °C`.
    const WORDS: [&str; 10] = ["at", "bei", "T", "temp", "temperature", "f", "freq", "frequency", "ω", "omega"];
    let (place, value) = find_quantity(text, dimension)?;
    let trimmed = |text: &'_ str| text.trim_end_matches(['@', ',', ';', '_', '-', ' ']).len();
    let mut before = &text[..place.start];
    before = &before[..trimmed(before)];
    let (named, is_set) = before.strip_suffix(['=', ':']).map_or((before, false), |named| (named.trim_end(), true));
    let start = named.rfind([' ', ',', ';', '_', '(', '[', '@']).map_or(0, |last| last + 1);
    if WORDS.iter().any(|word| *word == &named[start..]) && (is_set || ["at", "bei"].contains(&&named[start..])) {
        before = &named[..start];
        before = &before[..trimmed(before)];
    }
    let mut behind = text[place.end..].trim_start_matches(['@', ',', ';', '_', ':', ' ']);
    for (open, close) in [('(', ')'), ('[', ']')] {
        if let (Some(outer), Some(rest)) = (before.strip_suffix(open), behind.strip_prefix(close)) {
            (before, behind) = (outer.trim_end(), rest.trim_start());
        }
    }
    let parted = if behind.starts_with([')', ']']) { "" } else { " " };
    let name =
        format!("{before}{parted}{behind}").trim().trim_end_matches(['@', ',', ';', '_', '-', '(', ' ']).to_owned();
    Some((name, Condition { dimension, value }))
}

/// The bytes of a text from a number to the end of its unit of this dimension, and the number in SI units.
fn find_quantity(text: &str, dimension: Dimension) -> Option<(Range<usize>, f64)> {
    let is_digit = |letter: char| letter.is_ascii_digit() || "+-.,\u{2212}".contains(letter);
    let mut from = 0;
    while let Some(offset) = text[from..].find(|letter: char| letter.is_ascii_digit()) {
        let mut start = from + offset;
        while let Some(before) = text[..start].chars().next_back().filter(|letter| "+-\u{2212}".contains(*letter)) {
            start -= before.len_utf8();
        }
        let end =
            text[from + offset..].find(|letter: char| !is_digit(letter)).map_or(text.len(), |end| from + offset + end);
        let behind = text[end..].trim_start();
        let stop =
            behind.find(|letter: char| letter.is_whitespace() || ")],;:_@".contains(letter)).unwrap_or(behind.len());
        let spaced = plain(&behind[..stop]);
        // One word of a unit, or the sign of degrees and its letter.
        let unit = Unit::parse(&spaced).filter(|unit| unit.dimension == dimension);
        if let (Some(unit), Some(number)) = (unit, number(text[start..end].trim_matches(','))) {
            return Some((start..text.len() - behind.len() + stop, unit.to_si(number)));
        }
        from = end.max(from + offset + 1);
    }
    None
}

/// Of `log10(f / Hz)` and `lg f [Hz]` the inner part, and the base.
fn without_logarithm(text: &str) -> (&str, Option<f64>) {
    const BASES: [(&str, f64); 6] = [
        ("log10", 10.0),
        ("log_10", 10.0),
        ("log", 10.0),
        ("lg", 10.0),
        ("ln", std::f64::consts::E),
        ("loge", std::f64::consts::E),
    ];
    let found = BASES.iter().find_map(|(name, base)| {
        let head = text.get(..name.len())?;
        let rest = &text[name.len()..];
        let parts = rest.starts_with([' ', '(', '_', '[', '|']);
        (parts && head.eq_ignore_ascii_case(name)).then_some((rest.trim_start_matches([' ', '_']), *base))
    });
    let Some((rest, base)) = found else { return (text, None) };
    let inner = rest.strip_prefix('(').and_then(|inner| inner.strip_suffix(')')).unwrap_or(rest);
    (inner, Some(base))
}

/// The unit that is given for a column of this heading, by its name with its own unit or without.
pub(super) fn given_unit(heading: &str, units: &[(String, Unit)]) -> Option<Unit> {
    let normal = |text: &str| plain(text).to_lowercase().replace([' ', '_'], "");
    let heading = normal(heading);
    let bare = heading.split(['[', '(']).next().unwrap_or_default();
    let is_it = |name: &String| [heading.as_str(), bare].contains(&normal(name).as_str());
    units.iter().find(|(name, _)| is_it(name)).map(|(_, unit)| *unit)
}

/// The temperature in a text, K.
fn temperature(text: &str) -> Option<f64> {
    find_quantity(text, Dimension::Temperature).map(|(_, kelvin)| kelvin)
}

/// The temperatures or frequencies in the line above the names, in SI units: each holds to the next one.
pub(super) fn conditions_above(
    block: &Block<'_>,
    names: usize,
    units: &[(String, Unit)],
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
pub(super) fn setting(line: &str, units: &[(String, Unit)]) -> Option<Setting> {
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

/// What the names of sheets say of all their rows: `20C`, `-10 °C`, `T=25`, `1 Hz`. A temperature without a unit is in °C
/// where one of them is too cold for rubber in K.
pub(super) fn conditions_of(names: &[&str], units: &[(String, Unit)]) -> Vec<Option<Condition>> {
    let settings: Vec<Option<Setting>> = names.iter().map(|name| setting(name, units)).collect();
    let bare = |found: &Option<Setting>| match found {
        Some(Setting::Bare(text)) => {
            text.split_once(['=', ':']).or_else(|| text.split_once(' ')).and_then(|(_, value)| number(value.trim()))
        }
        _ => None,
    };
    let in_celsius = settings.iter().filter_map(bare).any(|value| value < Wlf::COLDEST);
    let unit = Unit::parse(if in_celsius { "°C" } else { "K" });
    let temperature = |value| Some(Condition { dimension: Dimension::Temperature, value });
    let of_name = |(name, found): (&&str, &Option<Setting>)| {
        let named = [Dimension::Temperature, Dimension::Frequency].into_iter();
        let named = named
            .filter_map(|dimension| find_quantity(name, dimension).map(|(_, value)| Condition { dimension, value }));
        match found {
            Some(Setting::Kelvin(value)) => temperature(*value),
            Some(Setting::Bare(_)) => bare(found).zip(unit).and_then(|(value, unit)| temperature(unit.to_si(value))),
            None => named.into_iter().next(),
        }
    };
    names.iter().zip(&settings).map(of_name).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn headings_may_say_what_holds_for_their_column() {
        let read =
            |text: &str, dimension| without_condition(text, dimension).map(|(name, condition)| (name, condition.value));
        for (text, name, kelvin) in [
            ("E' (MPa) @ 20 °C", "E' (MPa)", 293.15),
            ("E'' 313.15 K", "E''", 313.15),
            ("40C E' (MPa)", "E' (MPa)", 313.15),
            ("E' at -10°C [MPa]", "E' [MPa]", 263.15),
            ("E' (MPa, 20 °C)", "E' (MPa)", 293.15),
            ("E' [MPa], T = 20 °C", "E' [MPa]", 293.15),
        ] {
            assert_eq!(read(text, Dimension::Temperature), Some((name.to_owned(), kelvin)), "{text}");
        }
        for (text, name, hertz) in [
            ("E' 1 Hz", "E'", 1.0),
            ("E'' (10 Hz) [MPa]", "E'' [MPa]", 10.0),
            ("E'_0.5Hz_MPa", "E' MPa", 0.5),
            ("tan(d) (f = 2 Hz)", "tan(d)", 2.0),
            ("E' [MPa] @ 1 kHz", "E' [MPa]", 1e3),
            ("1Hz E' [MPa]", "E' [MPa]", 1.0),
        ] {
            let omega = hertz * std::f64::consts::TAU;
            assert_eq!(read(text, Dimension::Frequency), Some((name.to_owned(), omega)), "{text}");
        }
        assert_eq!((read("E' (MPa)", Dimension::Temperature), read("N/mm2", Dimension::Frequency)), (None, None));
    }

    #[test]
    fn names_of_sheets_say_their_temperature() {
        let of = |names: &[&str]| {
            conditions_of(names, &[]).into_iter().map(|found| found.map(|found| found.value)).collect::<Vec<_>>()
        };
        assert_eq!(of(&["20C", "-10 °C", "T=25", "E at 300 K"]), [293.15, 263.15, 298.15, 300.0].map(Some));
        assert_eq!(of(&["T=250", "T = 300", "20 degC"]), [250.0, 300.0, 293.15].map(Some));
        assert_eq!(of(&["Sheet1", "1", "Data", "20"]), [None; 4]);
        assert_eq!(of(&["1 Hz"]), [Some(TAU)]);
    }
}
