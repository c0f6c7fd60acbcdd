//! What headings of moduli say beside a name and a unit: a temperature or a frequency of the whole column, a logarithm.

use std::ops::Range;

use asperity::tables::{Dimension, Unit};
use asperity_formats::text::{number, plain};

/// What a heading says of all numbers of its column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Condition {
    /// Which quantity it is.
    pub(super) dimension: Dimension,
    /// What that is, in SI units.
    pub(super) value: f64,
}

/// A heading without what it says of all its column, as in `E' (MPa) @ 20 °C` and `E'' (f = 1 Hz)`, and that; `None` where
/// it says nothing of this dimension.
pub(super) fn without_condition(text: &str, dimension: Dimension) -> Option<(String, Condition)> {
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
pub(super) fn find_quantity(text: &str, dimension: Dimension) -> Option<(Range<usize>, f64)> {
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
pub(super) fn without_logarithm(text: &str) -> (&str, Option<f64>) {
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

#[cfg(test)]
mod tests {
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
}
