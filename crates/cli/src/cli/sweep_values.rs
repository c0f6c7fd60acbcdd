//! The values of a sweep and its shards as the command line gives them.

use std::fmt;

use asperity::element::{OperatingPoint, SweepGrid};
use asperity::tables::{Dimension, POSITIVE, Unit, quantity};

use asperity_study::decimals::{as_given, rounded};

/// Values of a quantity, rising, each once.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Values(pub(crate) Vec<f64>);

/// The spacing of the values of `a..b/n`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Spacing {
    Logarithmic,
    Linear,
}

/// Most values between two ends.
const MOST: usize = 10_000;
/// Significant digits of the values between two ends.
const DIGITS: usize = 6;

impl Values {
    /// Speeds, in m/s or with their unit: `1e-4..10/20` is 20 values evenly spaced in the logarithm, ends included;
    /// also a list, or both separated by commas.
    pub(crate) fn speeds(text: &str) -> Result<Self, String> {
        Self::parse(text, Spacing::Logarithmic, Dimension::Speed)
    }

    /// Pressures, in Pa or with their unit, as [`speeds`](Self::speeds).
    pub(crate) fn pressures(text: &str) -> Result<Self, String> {
        Self::parse(text, Spacing::Logarithmic, Dimension::Pressure)
    }

    /// Ways, in m or with their unit, as [`speeds`](Self::speeds).
    pub(crate) fn ways(text: &str) -> Result<Self, String> {
        Self::parse(text, Spacing::Logarithmic, Dimension::Length)
    }

    /// Forces, in N or with their unit, as [`speeds`](Self::speeds).
    pub(crate) fn forces(text: &str) -> Result<Self, String> {
        Self::parse(text, Spacing::Logarithmic, Dimension::Force)
    }

    /// Temperatures, in K or with their unit: `273..313/3` is 3 evenly spaced values.
    pub(crate) fn temperatures(text: &str) -> Result<Self, String> {
        Self::parse(text, Spacing::Linear, Dimension::Temperature)
    }

    fn parse(text: &str, spacing: Spacing, dimension: Dimension) -> Result<Self, String> {
        let mut numbers = Numbers { dimension, with_unit: None };
        let parts: Result<Vec<Vec<f64>>, String> =
            text.split(',').map(|part| values(part.trim(), spacing, &mut numbers)).collect();
        let mut all = parts?.concat();
        all.sort_by(f64::total_cmp);
        all.dedup();
        Ok(Self(all))
    }
}

fn values(part: &str, spacing: Spacing, numbers: &mut Numbers) -> Result<Vec<f64>, String> {
    let Some((low, rest)) = part.split_once("..") else { return Ok(vec![numbers.read(part)?]) };
    let (high, count) = rest.rsplit_once('/').ok_or_else(|| wrong(part, "a..b/n, such as 1e-4..10/20"))?;
    let (low, high) = (numbers.read(low)?, numbers.read(high)?);
    let count: usize = count.trim().parse().map_err(|_| wrong(count, "a whole number of values"))?;
    if low >= high || !(2..=MOST).contains(&count) {
        return Err(wrong(part, &format!("a..b/n with a < b and 2 to {MOST} values")));
    }
    let last = count - 1;
    let at = |i: usize| match (i, spacing) {
        (0, _) => low,
        (i, _) if i == last => high,
        (i, Spacing::Logarithmic) => rounded(low * (high / low).powf(i as f64 / last as f64), DIGITS),
        (i, Spacing::Linear) => rounded(low + (high - low) * (i as f64 / last as f64), DIGITS),
    };
    Ok((0..count).map(at).collect())
}

/// Reads the numbers of an option, all of them with units or none.
struct Numbers {
    dimension: Dimension,
    with_unit: Option<bool>,
}

impl Numbers {
    fn read(&mut self, text: &str) -> Result<f64, String> {
        let found = quantity(text, self.dimension).filter(|&(number, _)| POSITIVE.holds(number));
        let (number, unit) = found.ok_or_else(|| wrong(text, &self.expected()))?;
        match *self.with_unit.get_or_insert(unit.is_some()) == unit.is_some() {
            true => Ok(number),
            false => Err(wrong(text, "a unit behind each number or behind none")),
        }
    }

    fn expected(&self) -> String {
        format!("{POSITIVE} in {}, or with its unit, one of {}", Unit::si(self.dimension), self.dimension.units())
    }
}

fn wrong(found: &str, expected: &str) -> String {
    format!("expected {expected}, found {found:?}")
}

/// One of the three quantities that a sweep goes over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SweptQuantity {
    Speed,
    Pressure,
    Force,
    Temperature,
}

impl SweptQuantity {
    const ALL: [Self; 4] = [Self::Speed, Self::Pressure, Self::Force, Self::Temperature];

    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::Pressure => "pressure",
            Self::Force => "force",
            Self::Temperature => "temperature",
        }
    }

    /// Whether it is the load.
    pub(crate) fn is_load(self) -> bool {
        matches!(self, Self::Pressure | Self::Force)
    }

    pub(crate) fn unit(self) -> &'static str {
        match self {
            Self::Speed => "m/s",
            Self::Pressure => "Pa",
            Self::Force => "N",
            Self::Temperature => "K",
        }
    }

    /// A value of it, for reading.
    pub(crate) fn named(self, value: f64) -> String {
        match self {
            Self::Temperature => format!("{value} K"),
            quantity => as_given(value, quantity.unit()),
        }
    }

    /// The values of a sweep; those of its loads, whichever they are.
    pub(crate) fn values(self, grid: &SweepGrid) -> &[f64] {
        match self {
            Self::Speed => &grid.speeds,
            Self::Pressure | Self::Force => &grid.loads,
            Self::Temperature => &grid.temperatures,
        }
    }

    /// Its value at a point.
    pub(crate) fn of(self, point: &OperatingPoint) -> Option<f64> {
        match self {
            Self::Speed => Some(point.speed),
            Self::Pressure | Self::Force => Some(point.load),
            Self::Temperature => point.temperature,
        }
    }

    pub(crate) fn set(self, point: &mut OperatingPoint, value: f64) {
        match self {
            Self::Speed => point.speed = value,
            Self::Pressure | Self::Force => point.load = value,
            Self::Temperature => point.temperature = Some(value),
        }
    }
}

/// The quantities along x and along y of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Over(pub(crate) [SweptQuantity; 2]);

impl Over {
    /// Two words, as `speed,temperature`.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let read = |word: &str| SweptQuantity::ALL.into_iter().find(|quantity| quantity.word() == word.trim());
        let pair = text.split_once(',').and_then(|(x, y)| Some([read(x)?, read(y)?]));
        let are_two = |[x, y]: &[SweptQuantity; 2]| x != y && !(x.is_load() && y.is_load());
        let expected = "two of speed, pressure (or force) and temperature, such as speed,temperature";
        pair.filter(are_two).map(Self).ok_or_else(|| wrong(text, expected))
    }
}

impl fmt::Display for Over {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{}", self.0[0].word(), self.0[1].word())
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shard {
    /// Counted from 1.
    index: usize,
    count: usize,
}

impl Shard {
    /// `I/N`, I from 1 to N.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(index, count)| Some((index.parse().ok()?, count.parse().ok()?)));
        match parts {
            Some((index, count)) if (1..=count).contains(&index) => Ok(Self { index, count }),
            _ => Err(wrong(text, "I/N with I from 1 to N, such as 3/8")),
        }
    }

    /// Whether the point of this index is in it: every `count`th is, so that all shards have slow and quick points.
    pub(crate) fn has(self, index: usize) -> bool {
        index % self.count == self.index - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_lists_ranges_or_both() {
        let logarithm = |text| Values::speeds(text).unwrap().0;
        assert_eq!(logarithm("1e-4..10/6"), [1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0]);
        assert_eq!(logarithm("2, 1,1..100/3,0.5"), [0.5, 1.0, 2.0, 10.0, 100.0]);
        assert_eq!(Values::temperatures("273.15..313.15/3").unwrap().0, [273.15, 293.15, 313.15]);
        assert_eq!(Values::temperatures("0 °C, 20°C").unwrap().0, [273.15, 293.15]);
        assert_eq!(Values::pressures("1bar..4bar/3, 8 bar").unwrap().0, [1e5, 2e5, 4e5, 8e5]);
        assert_eq!(logarithm("1mm/s..1m/s/4"), [1e-3, 1e-2, 0.1, 1.0]);
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
            let message = Values::speeds(text).unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
    }

    #[test]
    fn a_map_is_over_two_quantities() {
        let over = Over::parse("temperature, speed").unwrap();
        assert_eq!(over, Over([SweptQuantity::Temperature, SweptQuantity::Speed]));
        assert_eq!(over.to_string(), "temperature,speed");
        for text in ["speed", "speed,speed", "pressure,force", "speed,pressure,temperature", "speed,load", ""] {
            assert!(Over::parse(text).unwrap_err().contains("two of speed"), "{text}");
        }
    }

    #[test]
    fn shards_share_all_points() {
        let shards: Vec<Shard> = ["1/3", "2/3", "3/3"].map(|text| Shard::parse(text).unwrap()).into();
        assert!((0..10).all(|number| shards.iter().filter(|shard| shard.has(number)).count() == 1));
        assert!(["0/3", "4/3", "1", "a/2", "1/0"].iter().all(|text| Shard::parse(text).is_err()));
    }
}
