//! Numbers as text: the shortest decimals that read back as the same numbers, and rounded ones.

use std::fmt::{self, Display, Formatter, LowerExp};
use std::ops::Range;

/// The shortest decimal that reads back as the same number; with an exponent outside the magnitudes `plain`.
pub fn decimal(value: f64, plain: Range<f64>) -> String {
    Decimal { value, plain }.to_string()
}

/// A number as files have it: the shortest decimal that reads back as the same number.
pub fn real(value: f64) -> String {
    file_decimal(value).to_string()
}

/// [`real`], to be written without a text of its own.
pub fn file_decimal(value: f64) -> Decimal {
    Decimal { value, plain: 1e-4..1e16 }
}

/// The shortest decimal that reads back as the same number; with an exponent outside the magnitudes `plain`.
#[derive(Debug)]
pub struct Decimal {
    value: f64,
    plain: Range<f64>,
}

impl Display for Decimal {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { value, plain } = self;
        let is_plain = *value == 0.0 || plain.contains(&value.abs());
        // Of the same digits, in fewer instructions; exponents begin elsewhere, and have a sign.
        let mut buffer = zmij::Buffer::new();
        let shortest = buffer.format(*value);
        let is_as_asked = if is_plain { !shortest.contains('e') } else { shortest.contains("e-") };
        if is_as_asked {
            f.write_str(shortest.strip_suffix(".0").unwrap_or(shortest))
        } else if is_plain {
            Display::fmt(value, f)
        } else {
            LowerExp::fmt(value, f)
        }
    }
}

/// The number rounded to `digits` significant digits.
pub fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// A number for reading, in all its digits: with an exponent outside 1e-3 to 1e5.
pub fn plain(value: f64) -> String {
    decimal(value, 1e-3..1e5)
}

/// A number for reading, of some significant digits.
pub fn short(value: f64, digits: usize) -> String {
    plain(rounded(value, digits))
}

/// A share in per cent, of some significant digits.
pub fn percent(value: f64, digits: usize) -> String {
    format!("{} %", short(100.0 * value, digits))
}

/// Prefixes of units, the largest first.
const PREFIXES: [(&str, f64); 9] =
    [("G", 1e9), ("M", 1e6), ("k", 1e3), ("", 1.0), ("m", 1e-3), ("µ", 1e-6), ("n", 1e-9), ("p", 1e-12), ("f", 1e-15)];

/// The largest prefix that leaves `largest` at 1 or more, and its factor.
pub fn prefix(largest: f64, unit: &str) -> (&'static str, f64) {
    // A prefix before m² would be one of m.
    if unit.is_empty() || unit.contains(['²', '³']) || unit == "kg" || largest == 0.0 {
        return ("", 1.0);
    }
    PREFIXES.into_iter().find(|(_, factor)| largest >= 0.999 * factor).unwrap_or(("f", 1e-15))
}

/// A quantity in three digits, with the prefix of its unit that suits `largest`: `1.23 mN`.
pub fn with_prefix(value: f64, largest: f64, unit: &str) -> String {
    let (prefix, factor) = prefix(largest.abs(), unit);
    format!("{} {prefix}{unit}", rounded(value / factor, 3))
}

/// A quantity that was given, in all its digits, with the prefix of its unit that suits it: `200 kPa`.
pub fn as_given(value: f64, unit: &str) -> String {
    let (prefix, factor) = prefix(value.abs(), unit);
    // The quotient of decimals is one but for its rounding.
    format!("{} {prefix}{unit}", rounded(value / factor, 12))
}

/// A temperature that was given in K, in °C where that takes fewer digits: 293.15 K was given as 20 °C.
pub fn temperature_as_given(kelvin: f64) -> String {
    let [kelvin, celsius] = [kelvin, kelvin - 273.15].map(|value| rounded(value, 9).to_string());
    if celsius.len() < kelvin.len() { format!("{celsius} °C") } else { format!("{kelvin} K") }
}

/// A tenth of a number, rounded in decimal: 1e-11 for 1e-10.
pub fn tenth(number: f64) -> f64 {
    let written = format!("{number:e}");
    let parts = written.split_once('e').and_then(|(digits, power)| Some((digits, power.parse::<i32>().ok()?)));
    parts.and_then(|(digits, power)| format!("{digits}e{}", power - 1).parse().ok()).unwrap_or(number / 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_have_a_prefix_of_their_unit() {
        let names = [2e5, 4e4, 20.0, 0.05].map(|value| as_given(value, "Pa"));
        assert_eq!(names, ["200 kPa", "40 kPa", "20 Pa", "50 mPa"]);
        let names = [293.15, 268.15, 300.0, 273.0, 273.15 + 0.1].map(temperature_as_given);
        assert_eq!(names, ["20 °C", "-5 °C", "300 K", "273 K", "0.1 °C"]);
    }

    #[test]
    fn quantities_have_few_digits_and_a_prefix() {
        assert_eq!([with_prefix(0.9, 4.5, "s"), with_prefix(389_123.0, 4e5, "Pa")], ["0.9 s", "389 kPa"]);
        assert_eq!(with_prefix(0.0, 0.0, "N"), "0 N");
    }

    #[test]
    fn numbers_far_from_one_have_an_exponent_and_few_digits_if_asked_for() {
        assert_eq!([0.0, 1e-3, -12.5, 1e5].map(|value| decimal(value, 1e-3..1e5)), ["0", "0.001", "-12.5", "1e5"]);
        assert_eq!(
            [rounded(0.1 + 0.2, 12), rounded(-1234.5, 2), rounded(f64::INFINITY, 3)],
            [0.3, -1200.0, f64::INFINITY]
        );
    }

    #[test]
    fn numbers_in_files_are_short_and_read_back_as_the_same() {
        for (value, text) in [(0.0, "0"), (1e-5, "1e-5"), (0.1 + 0.2, "0.30000000000000004"), (-2.5, "-2.5")] {
            assert_eq!(real(value), text);
            assert_eq!(real(value).parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
    }

    /// The text of the standard library, bit for bit of the number and letter for letter.
    #[test]
    fn numbers_in_files_are_those_of_the_standard_library() {
        let edges =
            [-0.0, 5e-324, f64::MIN_POSITIVE, f64::MAX, 1e-4, 9.999e-5, 1e15, 1e16, 1e22, 123_456_789_012_345_680.0];
        let others = (-330..310).map(|power| 1.234_567_890_123_4 * 10_f64.powi(power));
        for value in edges.into_iter().chain(others).chain([f64::INFINITY, f64::NEG_INFINITY, f64::NAN]) {
            let is_plain = value == 0.0 || (1e-4..1e16).contains(&value.abs());
            assert_eq!(real(value), if is_plain { format!("{value}") } else { format!("{value:e}") });
        }
    }
}
