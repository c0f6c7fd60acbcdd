//! The columns of tables of moduli: quantities as people and instruments name them, and what a block of a table has.

use asperity::tables::{Block, ContentError, Dimension, Header, Heading, HeadingUnit, Unit, UnitRule, Words, words};

use super::reading::GivenUnits;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    /// Cycles or radians per second; reduced: times a_T already.
    Frequency,
    AngularFrequency,
    /// E', E'' and |E*|.
    Storage,
    Loss,
    Complex,
    /// G', G'' and |G*|.
    ShearStorage,
    ShearLoss,
    ShearComplex,
    /// tan δ and δ.
    LossTangent,
    Phase,
    Temperature,
    /// Of the oven, or as it was set: used where there is no other.
    SetTemperature,
    /// Numbers the measurements.
    Set,
    Time,
    /// E(t) and G(t).
    Relaxation,
    ShearRelaxation,
    /// a_T.
    ShiftFactor,
    /// b_T.
    VerticalFactor,
}

impl Quantity {
    /// Whether a table of oscillation may need it, so that its unit must be known.
    fn is_needed(self) -> bool {
        !matches!(self, Self::Time | Self::Set | Self::SetTemperature | Self::Relaxation | Self::ShearRelaxation)
    }
}

/// What the file should hold, for messages.
pub(super) const EXPECTED: &str = "columns by their names with units: f [Hz] or omega [rad/s]; E' [MPa] and E'' [MPa] \
     or tan delta, or G' and G'', or |E*| and delta [°]; temperature [°C] if it varies; or time [s] and E(t) [MPa]";

/// One word may name several quantities; the first is meant where no unit tells.
const VOCABULARY: [Words<Quantity>; 19] = {
    use Dimension::{Angle, Frequency as Rate, Number, Pressure, Temperature as Kelvin, Time as Seconds};
    [
        Words::new(
            Quantity::Frequency,
            Rate,
            "f freq frequency frequenz frequencies prüffrequenz messfrequenz",
            "oscillation test reduced at a T shifted excitation f mean",
        ),
        Words::new(
            Quantity::AngularFrequency,
            Rate,
            "omega ω angular ang circular kreisfrequenz w",
            "f freq frequency reduced at a T shifted oscillation omega ω",
        ),
        Words::new(
            Quantity::Storage,
            Pressure,
            "e' storage speichermodul stor estor",
            "e' e modulus moduli mod dynamic dyn tensile elastic young's real measured",
        ),
        Words::new(
            Quantity::Loss,
            Pressure,
            "e'' loss verlustmodul eloss",
            "e'' e modulus moduli mod dynamic dyn tensile young's imaginary measured",
        ),
        Words::new(
            Quantity::ShearStorage,
            Pressure,
            "g' storage speichermodul stor gstor",
            "g' g shear modulus moduli mod dynamic dyn elastic schub measured",
        ),
        Words::new(
            Quantity::ShearLoss,
            Pressure,
            "g'' loss verlustmodul gloss",
            "g'' g shear modulus moduli mod dynamic dyn viscous schub measured",
        ),
        Words::new(
            Quantity::Complex,
            Pressure,
            "estar complex komplexer",
            "e estar modulus modul tensile abs magnitude young's dynamic",
        ),
        Words::new(Quantity::ShearComplex, Pressure, "gstar complex", "g gstar shear modulus abs magnitude dynamic"),
        Words::new(
            Quantity::LossTangent,
            Number,
            "tan tandelta tanδ tand factor tangent verlustfaktor",
            "delta δ d loss damping factor",
        ),
        Words::new(Quantity::Phase, Angle, "delta δ phase phasenwinkel", "angle lag delta δ shift"),
        Words::new(Quantity::ShiftFactor, Number, "at a shift", "T factor factors horizontal at a"),
        Words::new(Quantity::VerticalFactor, Number, "bt b vertical", "T factor factors shift bt b"),
        Words::new(Quantity::Time, Seconds, "t time zeit", "step run test elapsed relaxation total"),
        Words::new(
            Quantity::Temperature,
            Kelvin,
            "T temp temperature temperatur t",
            "sample mean average actual probe probentemperatur T temp isothermal measured",
        ),
        Words::new(
            Quantity::SetTemperature,
            Kelvin,
            "temp temperature temperatur T",
            "set setpoint point nominal furnace oven chamber target soll program",
        ),
        Words::new(Quantity::Set, Number, "set", "no number id"),
        Words::new(
            Quantity::Relaxation,
            Pressure,
            "e relax relaxation erelax",
            "e t modulus relaxation tensile young's stress",
        ),
        Words::new(Quantity::ShearRelaxation, Pressure, "g relax relaxation grelax", "g t modulus relaxation shear"),
        Words::new(Quantity::ShearRelaxation, Pressure, "g(t)", ""),
    ]
};

/// A column that is used.
pub(super) type Column = asperity::tables::Column<Quantity>;

/// Refuses to assume a unit where the header speaks of another one, and for angles.
pub(super) fn check_unit(column: &Column, block: &Block<'_>, line: usize) -> Result<(), ContentError> {
    column.check_assumed(block, Some(line)).map_err(|error| error.or("`unit` NAME=UNIT"))?;
    let is_phase = column.assumed_unit().is_some_and(|unit| unit.dimension == Dimension::Angle);
    if is_phase { Err(column.refuse(line, "", &with_unit(column, "°"))) } else { Ok(()) }
}

/// What to write, in a file or on the command line, for a unit to be known.
pub(super) fn with_unit(column: &Column, unit: &str) -> String {
    format!("the unit beside the name, as in {0} [{unit}]; or `unit` '{0}={unit}'", column.text)
}

/// Whether a frequency is in Hz or another number of cycles.
pub(super) fn counts_cycles(column: &Column) -> bool {
    !(column.unit.is_si() || column.unit.dimension == Dimension::Rate)
}

/// Whether a frequency was multiplied by a_T already.
pub(super) fn is_reduced(column: &Column) -> bool {
    let says_so = |word: &String| ["reduced", "at", "a", "shifted"].contains(&word.as_str());
    column.quantity == Quantity::Frequency && words(&column.text).iter().any(says_so)
}

/// What a block has: the columns that are known, and those left out.
#[derive(Debug)]
pub(super) struct Columns {
    pub(super) line: usize,
    pub(super) used: Vec<Column>,
    pub(super) left_out: Vec<String>,
}

impl Columns {
    /// The columns of a block by the names above it; `None` where it has none of a table of moduli.
    pub(super) fn read(
        block: &Block<'_>,
        ignored: &[String],
        units: &GivenUnits,
    ) -> Result<Option<Self>, ContentError> {
        let header = Header::read(block, &VOCABULARY, &[Dimension::Temperature, Dimension::Frequency]);
        let Some(line) = header.line else { return Ok(None) };
        let mut columns = Self { line, used: Vec::new(), left_out: Vec::new() };
        let is_unknown = |heading: &Heading<Quantity>| matches!(heading.unit, HeadingUnit::Unknown(_));
        for (index, text) in header.names.iter().enumerate() {
            let is_ignored = ignored.iter().any(|other| other.trim() == text.trim());
            // `F [N]` is no frequency where there is one, and a time in counts need not be known.
            let is_other = |heading: &Heading<Quantity>| {
                let alike = |other: &Heading<Quantity>| other.quantity == heading.quantity && !is_unknown(other);
                is_unknown(heading) && (!heading.quantity.is_needed() || header.headings.iter().flatten().any(alike))
            };
            match header.headings[index].as_ref().filter(|heading| !is_ignored && !is_other(heading)) {
                Some(_) => columns.used.push(column(&header, index, units)?),
                None if text.trim().is_empty() => (),
                None => columns.left_out.push(text.trim().to_owned()),
            }
        }
        Ok(Some(columns))
    }

    pub(super) fn all(&self, quantities: &[Quantity]) -> Vec<&Column> {
        self.used.iter().filter(|column| quantities.contains(&column.quantity)).collect()
    }

    /// The columns of the first kind of quantity that there is.
    pub(super) fn first(&self, kinds: &[&[Quantity]]) -> Vec<Column> {
        let found = kinds.iter().map(|quantities| self.all(quantities)).find(|found| !found.is_empty());
        found.unwrap_or_default().into_iter().cloned().collect()
    }
}

/// A column in the unit that is given or named; of frequencies that are not called angular, 1/s and no unit are Hz.
fn column(header: &Header<'_, Quantity>, index: usize, units: &GivenUnits) -> Result<Column, ContentError> {
    let text = header.names[index].trim();
    let given = units.iter().find(|(name, _)| words(text).starts_with(&words(name)) || name.trim() == text);
    let column = header.column(index, UnitRule::Assumed, given.map(|(_, unit)| *unit));
    let column = column.map_err(|error| error.or("`ignore` NAME leaves the column out"))?;
    let is_rate = column.unit.dimension == Dimension::Rate;
    match column.quantity {
        Quantity::Frequency if is_rate || !column.names_unit => {
            Ok(Column { unit: Unit::parse("Hz").unwrap_or(column.unit), ..column })
        }
        Quantity::AngularFrequency if column.unit.name.ends_with("Hz") => {
            let expected = "rad/s or 1/s of an angular frequency; a frequency is in Hz";
            Err(ContentError::value(header.line, &column.label(), "", expected))
        }
        Quantity::AngularFrequency => Ok(Column { quantity: Quantity::Frequency, ..column }),
        _ => Ok(column),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Option<(Quantity, Option<&'static str>)> {
        let heading = Heading::parse(text, &VOCABULARY)?;
        let unit = match heading.unit {
            HeadingUnit::None => None,
            HeadingUnit::Known(unit) => Some(unit.name),
            HeadingUnit::Unknown(_) => Some("?"),
        };
        Some((heading.quantity, unit))
    }

    #[test]
    fn headings_as_people_and_instruments_write_them() {
        use Quantity::{
            AngularFrequency, Complex, Frequency, Loss, LossTangent, Phase, Relaxation, Set, SetTemperature, ShearLoss,
            ShearRelaxation, ShearStorage, ShiftFactor, Storage, Temperature, Time, VerticalFactor,
        };
        let cases = [
            ("frequency [Hz]", Frequency, Some("Hz")),
            ("f / Hz", Frequency, Some("Hz")),
            ("Freq_Hz", Frequency, Some("Hz")),
            ("Frequency in kHz", Frequency, Some("kHz")),
            ("frequency [1/s]", Frequency, Some("1/s")),
            ("Oscillation frequency", Frequency, None),
            ("a_T f [Hz]", Frequency, Some("Hz")),
            ("log f [Hz]", Frequency, Some("Hz")),
            ("Ang. frequency", AngularFrequency, None),
            ("ω / rad/s", AngularFrequency, Some("rad/s")),
            ("Angular frequency (rad s^-1)", AngularFrequency, Some("rad/s")),
            ("aT*ω [rad·s⁻¹]", AngularFrequency, Some("rad/s")),
            ("E' [MPa]", Storage, Some("MPa")),
            ("E′ (GPa)", Storage, Some("GPa")),
            ("E’ in Mpa", Storage, Some("MPa")),
            ("E_prime_Pa", Storage, Some("Pa")),
            ("E_stor", Storage, None),
            ("Dyn. Storage Modulus", Storage, None),
            ("Storage Modulus (E') [kPa]", Storage, Some("kPa")),
            ("Speichermodul E' [N/mm²]", Storage, Some("N/mm²")),
            ("E\" [MPa]", Loss, Some("MPa")),
            ("E double prime (MPa)", Loss, Some("MPa")),
            ("Loss Modulus, MPa", Loss, Some("MPa")),
            ("Verlustmodul E\" [MPa]", Loss, Some("MPa")),
            ("E' [psi]", Storage, Some("psi")),
            ("G' (MPa)", ShearStorage, Some("MPa")),
            ("Shear storage modulus", ShearStorage, None),
            ("Storage modulus G' [Pa]", ShearStorage, Some("Pa")),
            ("G\"", ShearLoss, None),
            ("|E*| (MPa)", Complex, Some("MPa")),
            ("Complex modulus [MPa]", Complex, Some("MPa")),
            ("tan(d) [-]", LossTangent, Some("1")),
            ("Tan Delta", LossTangent, None),
            ("loss factor", LossTangent, None),
            ("Phase angle [°]", Phase, Some("°")),
            ("delta (deg)", Phase, Some("°")),
            ("Temp. [°C]", Temperature, Some("°C")),
            ("T [degC]", Temperature, Some("°C")),
            ("T [F]", Temperature, Some("°F")),
            ("t [°C]", Temperature, Some("°C")),
            ("t [s]", Time, Some("s")),
            ("Set temperature [°C]", SetTemperature, Some("°C")),
            ("Set", Set, None),
            ("E_relax", Relaxation, None),
            ("E(t) [MPa]", Relaxation, Some("MPa")),
            ("G(t)", ShearRelaxation, None),
            ("a_T", ShiftFactor, None),
            ("log aT", ShiftFactor, None),
            ("Shift factor", ShiftFactor, None),
            ("b_T", VerticalFactor, None),
            ("log bT", VerticalFactor, None),
            ("Vertical shift factor", VerticalFactor, None),
        ];
        for (header, quantity, unit) in cases {
            assert_eq!(read(header), Some((quantity, unit)), "{header}");
        }
        for header in ["", "[MPa]", "Strain [%]", "Force [N]", "Point", "1.0", "Displacement", "J' [1/Pa]", "Torque"] {
            assert_eq!(read(header), None, "{header}");
        }
        for header in ["E'' [mPa]", "omega [V]", "f [mhz]"] {
            assert_eq!(read(header).and_then(|(_, unit)| unit), Some("?"), "{header}");
        }
    }
}
