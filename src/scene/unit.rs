//! The units of parameters and variables.

/// An SI unit, as a variable or parameter names it.
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
    /// N s/m.
    NewtonSecondPerMeter,
    /// K.
    Kelvin,
    /// m².
    SquareMeter,
    /// kg/m³.
    KilogramPerCubicMeter,
    /// Pa.
    Pascal,
    /// Pa s.
    PascalSecond,
    /// J.
    Joule,
    /// W.
    Watt,
}

impl Unit {
    /// The unit's name in the model description.
    pub fn name(self) -> &'static str {
        match self {
            Self::One => "1",
            Self::Meter => "m",
            Self::Second => "s",
            Self::MeterPerSecond => "m/s",
            Self::Kilogram => "kg",
            Self::Newton => "N",
            Self::NewtonPerMeter => "N/m",
            Self::NewtonSecondPerMeter => "N.s/m",
            Self::Kelvin => "K",
            Self::SquareMeter => "m2",
            Self::KilogramPerCubicMeter => "kg/m3",
            Self::Pascal => "Pa",
            Self::PascalSecond => "Pa.s",
            Self::Joule => "J",
            Self::Watt => "W",
        }
    }

    /// The exponents of kg, m, s and K in the unit.
    pub fn exponents(self) -> [i32; 4] {
        match self {
            Self::One => [0, 0, 0, 0],
            Self::Meter => [0, 1, 0, 0],
            Self::Second => [0, 0, 1, 0],
            Self::MeterPerSecond => [0, 1, -1, 0],
            Self::Kilogram => [1, 0, 0, 0],
            Self::Newton => [1, 1, -2, 0],
            Self::NewtonPerMeter => [1, 0, -2, 0],
            Self::NewtonSecondPerMeter => [1, 0, -1, 0],
            Self::Kelvin => [0, 0, 0, 1],
            Self::SquareMeter => [0, 2, 0, 0],
            Self::KilogramPerCubicMeter => [1, -3, 0, 0],
            Self::Pascal => [1, -1, -2, 0],
            Self::PascalSecond => [1, -1, -1, 0],
            Self::Joule => [1, 2, -2, 0],
            Self::Watt => [1, 2, -3, 0],
        }
    }
}
