//! What a map of a sweep is over, and shards of a sweep, as the command line gives them.

use std::fmt;

use asperity::element::{OperatingPoint, SweepGrid};
use asperity_study::decimals::as_given;

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
