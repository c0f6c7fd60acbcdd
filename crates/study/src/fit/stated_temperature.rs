//! Temperatures that stand beside a table, not in a column: in headings, in the line above them, in a line of settings.

use std::borrow::Cow;

use asperity::scene::Wlf;
use asperity::tables::{Block, Dimension, Unit, number, plain, words};

use super::columns::GivenUnits;
use super::moduli_error::ModuliError;

/// A heading without the temperature that it names, as in `E' (MPa) @ 20 °C`, and the temperature in K.
pub(super) fn without_temperature(text: &str) -> (Cow<'_, str>, Option<f64>) {
    let Some((start, end, kelvin)) = find_temperature(text) else { return (Cow::Borrowed(text), None) };
    let rest = format!("{} {}", &text[..start], &text[end..]);
    let rest = rest.replace("()", "").replace("[]", "");
    let rest = rest.trim().trim_end_matches(['@', ',', ';', '_', '-', '(', ' ']).trim_end_matches(" at").trim();
    let rest = rest.trim_start_matches(['@', ',', ';', '_', ':', ' ']);
    (Cow::Owned(rest.to_owned()), Some(kelvin))
}

/// The bytes from the number to the end of its unit of temperature, and the temperature in K.
fn find_temperature(text: &str) -> Option<(usize, usize, f64)> {
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
        let unit = Unit::parse(&spaced).filter(is_of_temperature);
        let number = number(text[start..end].trim_matches(','), true);
        if let (Some(unit), Some(number)) = (unit, number) {
            let end = text.len() - behind.len() + stop;
            return Some((start, end, unit.to_si(number)));
        }
        from = end.max(from + offset + 1);
    }
    None
}

/// The temperatures in the line above the names: each holds to the next one.
pub(super) fn temperatures_above(
    block: &Block<'_>,
    names: usize,
    units: &GivenUnits,
) -> Result<Vec<Option<f64>>, ModuliError> {
    let Some(&(line, text)) = block.above.iter().rev().find(|(line, _)| *line < names) else { return Ok(Vec::new()) };
    let Some(fields) = block.fields(text) else { return Ok(Vec::new()) };
    let given = units.iter().map(|(_, unit)| *unit).find(is_of_temperature);
    let of_line = given.or_else(|| unit_of(text));
    let (mut found, mut last) = (Vec::new(), None);
    for (index, field) in fields.iter().enumerate() {
        let named = find_temperature(field).map(|(_, _, kelvin)| kelvin);
        let bare = number(field, block.separator.allows_decimal_comma());
        match (named, bare, of_line) {
            (Some(kelvin), _, _) => last = Some(kelvin),
            (None, Some(value), Some(unit)) => last = Some(unit.to_si(value)),
            (None, Some(value), None) if value >= Wlf::COLDEST => last = Some(value),
            (None, Some(_), None) => {
                let expected =
                    "a unit of temperature, as in 20 °C, above each pair of columns; or --unit temperature=°C";
                return Err(ModuliError::in_column(line, index, "", field, expected));
            }
            (None, None, _) if field.is_empty() => (),
            (None, None, _) => last = None,
        }
        found.push(last);
    }
    Ok(found)
}

/// The unit of temperature that a line names by itself, as in `T [°C],20,,40,`.
fn unit_of(line: &str) -> Option<Unit> {
    let parts = line.split(|letter: char| letter.is_whitespace() || "[](),;:=/\t".contains(letter));
    parts.filter_map(Unit::parse).find(is_of_temperature)
}

fn is_of_temperature(unit: &Unit) -> bool {
    unit.dimension == Dimension::Temperature
}

/// Of a line such as `Temperature: 20 °C` or `T=20;Mw=90`: the temperature in K, or the text where it names no unit.
pub(super) fn setting(line: &str, units: &GivenUnits) -> Option<Result<f64, String>> {
    line.split([';', '\t', ',']).find_map(|part| {
        let (name, value) = part.split_once(['=', ':']).or_else(|| part.split_once(char::is_whitespace))?;
        let found = words(name);
        let is_temperature =
            found.iter().any(|word| ["T", "temp", "temperature", "temperatur"].contains(&word.as_str()));
        let digits = value.trim();
        if !is_temperature
            || found.len() > 2
            || !digits.starts_with(|letter: char| letter.is_ascii_digit() || letter == '-')
        {
            return None;
        }
        if let Some((_, _, kelvin)) = find_temperature(digits) {
            return Some(Ok(kelvin));
        }
        let given = units.iter().find(|(name, _)| words(name) == found).map(|(_, unit)| *unit);
        let unit = given.or_else(|| unit_of(name));
        let number = number(digits, true);
        Some(match (unit, number) {
            (Some(unit), Some(number)) => Ok(unit.to_si(number)),
            _ => Err(part.trim().to_owned()),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_may_name_a_temperature() {
        let read = |text: &'static str| {
            let (name, kelvin) = without_temperature(text);
            (name.into_owned(), kelvin)
        };
        assert_eq!(read("E' (MPa) @ 20 °C"), ("E' (MPa)".into(), Some(293.15)));
        assert_eq!(read("E' at -10°C [MPa]").1, Some(263.15));
        assert_eq!(read("E'' 313.15 K"), ("E''".into(), Some(313.15)));
        assert_eq!(read("40C E' (MPa)"), ("E' (MPa)".into(), Some(313.15)));
        assert_eq!(read("E' (MPa)"), ("E' (MPa)".into(), None));
        assert_eq!(read("N/mm2"), ("N/mm2".into(), None));
    }
}
