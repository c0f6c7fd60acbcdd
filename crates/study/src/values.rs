//! Values of options as people write them: numbers with units, lists and ranges. An error says what was expected.

use asperity::tables::{ANY, Dimension, NOT_NEGATIVE, NumberRange, POSITIVE, Unit, quantity};
use serde::{Deserialize, Serialize};

use crate::decimals::rounded;

/// Values of a quantity, rising, each once.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "Vec<f64>")]
pub struct Values(pub Vec<f64>);

impl From<Vec<f64>> for Values {
    fn from(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        values.dedup();
        Self(values)
    }
}

/// Most values between two ends.
const MOST: usize = 10_000;
/// Significant digits of the values between two ends.
const DIGITS: usize = 6;

impl Values {
    /// Reads values of a dimension, in SI units or with their unit: `1e-4..10/20` is 20 values, ends included, evenly spaced
    /// in the logarithm, temperatures as such; also a list, or both separated by commas.
    ///
    /// # Errors
    /// What was expected of the text.
    pub fn parse(text: &str, dimension: Dimension) -> Result<Self, String> {
        Self::parse_within(text, dimension, POSITIVE, false)
    }

    fn parse_within(text: &str, dimension: Dimension, range: NumberRange, is_even: bool) -> Result<Self, String> {
        let is_even = is_even || dimension == Dimension::Temperature;
        let mut numbers = Numbers { dimension, range, is_even, with_unit: None };
        let parts = text.split(',').map(|part| values(part.trim(), &mut numbers));
        Ok(parts.collect::<Result<Vec<_>, _>>()?.concat().into())
    }

    /// What reads values of a dimension of which 0 is one.
    pub fn from_zero(dimension: Dimension) -> impl Fn(&str) -> Result<Self, String> + Clone {
        move |text| Self::parse_within(text, dimension, NOT_NEGATIVE, false)
    }

    /// What reads values of a dimension of either sign, those between two ends evenly spaced as such.
    pub fn signed(dimension: Dimension) -> impl Fn(&str) -> Result<Self, String> + Clone {
        move |text| Self::parse_within(text, dimension, ANY, true)
    }

    /// What reads values of a dimension.
    pub fn of(dimension: Dimension) -> impl Fn(&str) -> Result<Self, String> + Clone {
        move |text| Self::parse(text, dimension)
    }
}

fn values(part: &str, numbers: &mut Numbers) -> Result<Vec<f64>, String> {
    let Some((low, rest)) = part.split_once("..") else { return Ok(vec![numbers.read(part)?]) };
    let (high, count) = rest.rsplit_once('/').ok_or_else(|| wrong(part, "a..b/n, such as 1e-4..10/20"))?;
    let (low, high) = (numbers.read(low)?, numbers.read(high)?);
    let count: usize = count.trim().parse().map_err(|_| wrong(count, "a whole number of values"))?;
    if low >= high || (low == 0.0 && !numbers.is_even) || !(2..=MOST).contains(&count) {
        return Err(wrong(part, &format!("a..b/n with a < b and 2 to {MOST} values")));
    }
    let last = count - 1;
    let share = |i: usize| i as f64 / last as f64;
    // What is next to 0 but for rounding is 0.
    let even = |i: usize| Some(low + (high - low) * share(i)).filter(|value| value.abs() > 1e-9 * (high - low));
    let at = |i: usize| match i {
        0 => low,
        i if i == last => high,
        i if numbers.dimension == Dimension::Temperature => rounded(even(i).unwrap_or(0.0), DIGITS),
        // Angles that were given in degrees have no few digits.
        i if numbers.is_even => rounded(even(i).unwrap_or(0.0), 2 * DIGITS),
        i => rounded(low * (high / low).powf(share(i)), DIGITS),
    };
    Ok((0..count).map(at).collect())
}

/// Reads the numbers of an option, all of them with units or none.
struct Numbers {
    dimension: Dimension,
    range: NumberRange,
    /// Whether values between two ends are evenly spaced; else their logarithms are.
    is_even: bool,
    with_unit: Option<bool>,
}

impl Numbers {
    fn read(&mut self, text: &str) -> Result<f64, String> {
        let found = quantity(text, self.dimension).filter(|&(number, _)| self.range.holds(number));
        let (number, unit) = found.ok_or_else(|| wrong(text, &self.expected()))?;
        // 0 is 0 in any unit.
        match number == 0.0 || *self.with_unit.get_or_insert(unit.is_some()) == unit.is_some() {
            true => Ok(number),
            false => Err(wrong(text, "a unit behind each number or behind none")),
        }
    }

    fn expected(&self) -> String {
        format!("{} in {}, or with its unit, one of {}", self.range, Unit::si(self.dimension), self.dimension.units())
    }
}

fn wrong(found: &str, expected: &str) -> String {
    format!("expected {expected}, found {found:?}")
}

/// A number that is `allowed`; `expected` describes those.
///
/// # Errors
/// What was expected of the text.
pub fn number(text: &str, allowed: impl Fn(&f64) -> bool, expected: &str) -> Result<f64, String> {
    text.trim().parse().ok().filter(allowed).ok_or_else(|| format!("expected {expected}"))
}

/// The two ends of `A..B`.
pub fn ends(text: &str) -> Option<(f64, f64)> {
    let number = |text: &str| text.trim().parse().ok();
    text.split_once("..").and_then(|(first, last)| Some((number(first)?, number(last)?)))
}

/// A number above 0, such as a quantity can have, in SI units or in the unit behind it.
pub fn above_zero(text: &str, dimension: Dimension) -> Option<f64> {
    quantity(text, dimension).map(|(number, _)| number).filter(|number| POSITIVE.holds(*number))
}

/// A whole number, 1 or more.
///
/// # Errors
/// What was expected of the text.
pub fn count(text: &str) -> Result<u32, String> {
    let number = text.trim().parse().ok().filter(|&number: &u32| number > 0);
    number.ok_or_else(|| "expected a whole number, 1 or more".into())
}

/// A share above 0, up to 1.
///
/// # Errors
/// What was expected of the text.
pub fn share(text: &str) -> Result<f64, String> {
    number(text, |share| *share > 0.0 && *share <= 1.0, "a share above 0, up to 1, such as 5e-3")
}

/// A pressure above 0, in Pa or in the unit behind it.
///
/// # Errors
/// What was expected of the text.
pub fn pressure(text: &str) -> Result<f64, String> {
    above_zero(text, Dimension::Pressure).ok_or_else(|| format!("expected {POSITIVE}, such as 2e5 (in Pa) or 2bar"))
}

/// A speed above 0, in m/s or in the unit behind it.
///
/// # Errors
/// What was expected of the text.
pub fn speed(text: &str) -> Result<f64, String> {
    above_zero(text, Dimension::Speed).ok_or_else(|| format!("expected {POSITIVE}, such as 0.1 (in m/s) or 100mm/s"))
}

/// A length above 0, in m or in the unit behind it.
///
/// # Errors
/// What was expected of the text.
pub fn length(text: &str) -> Result<f64, String> {
    above_zero(text, Dimension::Length).ok_or_else(|| "expected a length above 0, such as 5e-5 (in m) or 0.05mm".into())
}

/// A stiffness above 0, in N/m or in the unit behind it.
///
/// # Errors
/// What was expected of the text.
pub fn stiffness(text: &str) -> Result<f64, String> {
    let found = above_zero(text, Dimension::Stiffness);
    found.ok_or_else(|| "expected a stiffness above 0, such as 3e5 (in N/m) or 300N/mm".into())
}

/// A temperature above 0 K, in K or in the unit behind it.
///
/// # Errors
/// What was expected of the text.
pub fn temperature(text: &str) -> Result<f64, String> {
    let found = above_zero(text, Dimension::Temperature);
    found.ok_or_else(|| "expected a temperature above 0 K, such as 293.15 (in K) or 20°C".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_lists_ranges_or_both() {
        let logarithm = |text| Values::parse(text, Dimension::Speed).unwrap().0;
        assert_eq!(logarithm("1e-4..10/6"), [1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0]);
        assert_eq!(logarithm("2, 1,1..100/3,0.5"), [0.5, 1.0, 2.0, 10.0, 100.0]);
        assert_eq!(Values::parse("273.15..313.15/3", Dimension::Temperature).unwrap().0, [273.15, 293.15, 313.15]);
        assert_eq!(Values::parse("0 °C, 20°C", Dimension::Temperature).unwrap().0, [273.15, 293.15]);
        assert_eq!(Values::parse("1bar..4bar/3, 8 bar", Dimension::Pressure).unwrap().0, [1e5, 2e5, 4e5, 8e5]);
        assert_eq!(logarithm("1mm/s..1m/s/4"), [1e-3, 1e-2, 0.1, 1.0]);
        let signed = |text| Values::signed(Dimension::Number)(text).unwrap().0;
        assert_eq!(signed("-0.3..0.6/7"), [-0.3, -0.15, 0.0, 0.15, 0.3, 0.45, 0.6]);
        assert_eq!(signed("0.1,-1,0..0.1/2"), [-1.0, 0.0, 0.1]);
        let even = logarithm("1e-2..10/20");
        // Rounded to six digits.
        let ratio = 10_f64.powf(3.0 / 19.0);
        assert!(even.len() == 20 && even.windows(2).all(|pair| (pair[1] / pair[0] / ratio - 1.0).abs() < 1e-5));
    }

    #[test]
    fn wrong_values_are_refused_with_what_was_expected() {
        for (text, part) in [
            ("", "a number from 1e-30 to 1e30"),
            ("1,,2", "a number from 1e-30 to 1e30"),
            ("-1", "a number from 1e-30 to 1e30"),
            ("0..1/3", "a number from 1e-30 to 1e30"),
            ("NaN", "a number from 1e-30 to 1e30"),
            ("1e-300", "a number from 1e-30 to 1e30"),
            ("1e99", "a number from 1e-30 to 1e30"),
            ("1..2", "a..b/n"),
            ("2..1/3", "a < b"),
            ("1..2/1", "2 to"),
            ("1..2/x", "a whole number"),
            ("1..2 mm/s/3", "behind each number or behind none"),
            ("1 bar", "one of m/s, mm/s, km/h"),
        ] {
            let message = Values::parse(text, Dimension::Speed).unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
