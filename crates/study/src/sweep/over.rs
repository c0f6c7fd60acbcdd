//! The quantities that a sweep goes over, and which two of them a map is over.

use std::fmt;

use asperity::element::{Load, OperatingPoint, SweepGrid};

use crate::decimals::as_given;
use crate::picture::{Axis, Fit};

/// One of the three quantities that a sweep goes over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SweptQuantity {
    /// m/s.
    Speed,
    /// Pa.
    Pressure,
    /// N.
    Force,
    /// K.
    Temperature,
}

impl SweptQuantity {
    const ALL: [Self; 4] = [Self::Speed, Self::Pressure, Self::Force, Self::Temperature];

    /// Its name.
    pub fn word(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::Pressure => "pressure",
            Self::Force => "force",
            Self::Temperature => "temperature",
        }
    }

    /// Whether it is the load.
    pub fn is_load(self) -> bool {
        matches!(self, Self::Pressure | Self::Force)
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Speed => "m/s",
            Self::Pressure => "Pa",
            Self::Force => "N",
            Self::Temperature => "K",
        }
    }

    /// A value of it, for reading.
    pub fn named(self, value: f64) -> String {
        match self {
            Self::Temperature => format!("{value} K"),
            quantity => as_given(value, quantity.unit()),
        }
    }

    /// The values of a sweep; those of its loads, whichever they are.
    pub fn values(self, grid: &SweepGrid) -> &[f64] {
        match self {
            Self::Speed => &grid.speeds,
            Self::Pressure | Self::Force => &grid.loads,
            Self::Temperature => &grid.temperatures,
        }
    }

    /// That of a table's loads.
    pub fn of_load(load: Load) -> Self {
        match load {
            Load::Pressure { .. } => Self::Pressure,
            Load::Force => Self::Force,
        }
    }

    /// The axis of its values, from the first to the last: logarithmic where they go by decades.
    pub(crate) fn axis(self, grid: &SweepGrid) -> Axis {
        /// From this ratio on loads do.
        const DECADE: f64 = 10.0;
        let (of, values) = ((self.word(), self.unit()), self.values(grid));
        let spans_decade = values.first().zip(values.last()).is_some_and(|(low, high)| *high >= DECADE * low);
        match self == Self::Speed || (self.is_load() && spans_decade) {
            true => Axis::logarithmic_tight(of, values.iter().copied()),
            false => Axis::linear(of, values.iter().copied(), Fit::Tight),
        }
    }

    /// Its value at a point.
    pub fn of(self, point: &OperatingPoint) -> Option<f64> {
        match self {
            Self::Speed => Some(point.speed),
            Self::Pressure | Self::Force => Some(point.load),
            Self::Temperature => point.temperature,
        }
    }

    /// Sets its value at a point.
    pub fn set(self, point: &mut OperatingPoint, value: f64) {
        match self {
            Self::Speed => point.speed = value,
            Self::Pressure | Self::Force => point.load = value,
            Self::Temperature => point.temperature = Some(value),
        }
    }
}

/// The quantities along x and along y of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Over(pub [SweptQuantity; 2]);

impl Over {
    /// Two words, as `speed,temperature`.
    ///
    /// # Errors
    /// Where they are not two of them.
    pub fn parse(text: &str) -> Result<Self, String> {
        let read = |word: &str| SweptQuantity::ALL.into_iter().find(|quantity| quantity.word() == word.trim());
        let pair = text.split_once(',').and_then(|(x, y)| Some([read(x)?, read(y)?]));
        let are_two = |[x, y]: &[SweptQuantity; 2]| x != y && !(x.is_load() && y.is_load());
        let expected = "two of speed, pressure (or force) and temperature, such as speed,temperature";
        pair.filter(are_two).map(Self).ok_or_else(|| format!("expected {expected}, found {text:?}"))
    }
}

impl fmt::Display for Over {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{}", self.0[0].word(), self.0[1].word())
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
    fn loads_are_logarithmic_from_a_decade_on() {
        let is_logarithmic = |loads: &[f64]| {
            let grid = SweepGrid { speeds: vec![1.0], loads: loads.to_vec(), temperatures: vec![] };
            SweptQuantity::Pressure.axis(&grid).is_logarithmic
        };
        assert!(is_logarithmic(&[1e5, 1e6]) && !is_logarithmic(&[1e5, 9e5]));
    }
}
