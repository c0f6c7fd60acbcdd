//! The columns of tables of moduli: quantities by their names, and what a block of a table has.

use asperity::tables::{ContentError, Dimension, NumberRange, Role, Unit, shortened};
use asperity_formats::text::{Block, Decimal, Head, Row, UsedColumn, chosen, find, is_missing, plain, unit_beside};

use super::heading::{Condition, without_condition, without_logarithm};
use super::reading::{GivenUnits, Reading};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    /// Cycles or radians per second.
    Frequency,
    /// The same, times a_T already.
    ReducedFrequency,
    AngularFrequency,
    ReducedAngularFrequency,
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

/// The quantities, and what they are called. One name may be that of several; the first is meant where no unit tells.
const QUANTITIES: [Quantity; 20] = [
    Quantity::Frequency,
    Quantity::ReducedFrequency,
    Quantity::AngularFrequency,
    Quantity::ReducedAngularFrequency,
    Quantity::Storage,
    Quantity::Loss,
    Quantity::ShearStorage,
    Quantity::ShearLoss,
    Quantity::Complex,
    Quantity::ShearComplex,
    Quantity::LossTangent,
    Quantity::Phase,
    Quantity::ShiftFactor,
    Quantity::VerticalFactor,
    Quantity::Time,
    Quantity::Temperature,
    Quantity::SetTemperature,
    Quantity::Set,
    Quantity::Relaxation,
    Quantity::ShearRelaxation,
];

/// What the columns of moduli are called.
pub const ROLES: [Role; 20] = {
    use Dimension::{Angle, Frequency as Rate, Number, Pressure, Temperature as Kelvin, Time as Seconds};
    [
        Role::new(
            "frequency",
            "f, freq, frequencies, test frequency, oscillation frequency, excitation frequency, mean frequency, frequenz, \
             prüffrequenz, messfrequenz",
            Rate,
        ),
        Role::new("reduced_frequency", "a_T f, f a_T, a_T*f, a_T·f, shifted frequency, freq reduced", Rate),
        Role::new(
            "angular_frequency",
            "omega, ω, w, ang frequency, angular freq, circular frequency, kreisfrequenz",
            Rate,
        ),
        Role::new(
            "reduced_angular_frequency",
            "a_T omega, a_T ω, a_T*omega, a_T*ω, omega a_T, ω a_T, shifted angular frequency",
            Rate,
        ),
        Role::new(
            "storage_modulus",
            "E', storage, E stor, E storage, E prime, dynamic storage modulus, dyn storage modulus, tensile storage \
             modulus, young's storage modulus, elastic modulus E', speichermodul",
            Pressure,
        ),
        Role::new(
            "loss_modulus",
            "E'', loss, E loss, E double prime, E doubleprime, dynamic loss modulus, dyn loss modulus, tensile loss \
             modulus, young's loss modulus, verlustmodul",
            Pressure,
        ),
        Role::new(
            "shear_storage_modulus",
            "G', G stor, G storage, G prime, elastic shear modulus, storage modulus, speichermodul, dynamic shear storage \
             modulus",
            Pressure,
        ),
        Role::new(
            "shear_loss_modulus",
            "G'', G loss, G double prime, G doubleprime, viscous shear modulus, loss modulus, verlustmodul, dynamic shear \
             loss modulus",
            Pressure,
        ),
        Role::new(
            "complex_modulus",
            "|E*|, complex, abs E*, E star, magnitude of E*, complex young's modulus, complex tensile modulus, dynamic \
             modulus, komplexer modul",
            Pressure,
        ),
        Role::new(
            "complex_shear_modulus",
            "|G*|, abs G*, G star, magnitude of G*, complex modulus, dynamic shear modulus",
            Pressure,
        ),
        Role::new(
            "loss_tangent",
            "tan delta, tan d, tan δ, tan, loss factor, loss tan, tangent delta, damping factor, verlustfaktor",
            Number,
        ),
        Role::new(
            "phase_angle",
            "delta, δ, phase, phase lag, phase shift, phase delta, loss angle, phasenwinkel",
            Angle,
        ),
        Role::new("shift_factor", "a_T, horizontal shift factor, shift factors, shift, horizontal shift", Number),
        Role::new("vertical_factor", "b_T, vertical shift factor, vertical shift, vertical", Number),
        Role::new(
            "time",
            "t, test time, step time, run time, elapsed time, total time, relaxation time, zeit",
            Seconds,
        ),
        Role::new(
            "temperature",
            "T, t, temp, sample temperature, sample temp, mean temperature, average temperature, actual temperature, \
             measured temperature, isothermal temperature, temperatur, probentemperatur",
            Kelvin,
        ),
        Role::new(
            "set_temperature",
            "set temp, setpoint temperature, temperature setpoint, set point temperature, nominal temperature, furnace \
             temperature, oven temperature, chamber temperature, target temperature, program temperature, solltemperatur",
            Kelvin,
        ),
        Role::new("set", "set number, set no, set id", Number),
        Role::new(
            "relaxation_modulus",
            "E(t), E relax, E relaxation, tensile relaxation modulus, young's relaxation modulus, relaxation modulus of \
             tension, E",
            Pressure,
        ),
        Role::new(
            "shear_relaxation_modulus",
            "G(t), G relax, G relaxation, relaxation modulus, relaxation modulus of shear, relaxation shear modulus, G",
            Pressure,
        ),
    ]
};

/// A column that is used.
#[derive(Clone, Debug)]
pub(super) struct Column {
    /// Its place, counted from 0.
    pub(super) index: usize,
    /// Its heading as written.
    pub(super) text: String,
    /// What it holds.
    pub(super) quantity: Quantity,
    /// The unit of its numbers.
    pub(super) unit: Unit,
    /// Whether that was named, not assumed.
    pub(super) names_unit: bool,
    /// What its heading says of all its numbers.
    pub(super) condition: Option<Condition>,
    /// Its numbers are logarithms to this base.
    logarithm: Option<f64>,
}

impl Column {
    /// The column in messages: its number from 1, and its heading.
    pub(super) fn label(&self) -> String {
        format!("column {} \"{}\"", self.index + 1, shortened(&self.text))
    }

    /// The unit that is assumed, where none is named.
    pub(super) fn assumed_unit(&self) -> Option<Unit> {
        (!self.names_unit && self.unit.dimension != Dimension::Number).then_some(self.unit)
    }

    /// The column as one that is read.
    pub(super) fn used(&self) -> UsedColumn {
        let is_out = matches!(self.unit.dimension, Dimension::Number | Dimension::Temperature | Dimension::Angle);
        UsedColumn { index: self.index, label: self.label(), at_stake: !is_out && self.logarithm.is_none() }
    }

    /// Its field in a row; empty where the row has none.
    pub(super) fn field<'r>(&self, row: &'r Row<'_>) -> &'r str {
        row.fields.get(self.index).map_or("", |field| field)
    }

    /// Whether a row has no number there, and says so.
    pub(super) fn is_empty(&self, row: &Row<'_>) -> bool {
        is_missing(self.field(row))
    }

    /// The number in a row, in SI units; `None` where the field is none or it is not finite.
    pub(super) fn number(&self, row: &Row<'_>, decimal: Decimal) -> Option<f64> {
        let field = self.field(row);
        let written = match field.strip_suffix('%').filter(|_| self.unit.dimension == Dimension::Number) {
            Some(percent) => return decimal.read(percent.trim_end()).map(|number| number / 100.0),
            None => decimal.read(field)?,
        };
        let written = self.logarithm.map_or(written, |base| base.powf(written));
        Some(self.unit.to_si(written)).filter(|value| value.is_finite())
    }

    /// The number in a row, in SI units, which is one of a range.
    pub(super) fn read(&self, row: &Row<'_>, decimal: Decimal, range: NumberRange) -> Result<f64, ContentError> {
        let value = self.number(row, decimal).filter(|value| range.holds(*value));
        value.ok_or_else(|| {
            let field = self.field(row);
            if decimal.read(field).is_none() && asperity_formats::text::is_number(field) {
                let expected = "numbers with decimal points or with decimal commas, not both in one file";
                return self.refuse(row.line, field, expected);
            }
            let dimension = self.unit.dimension;
            let is_plain = self.unit.is_si() || dimension == Dimension::Number;
            let expected = if is_plain { range.to_string() } else { format!("{range} in {}", Unit::si(dimension)) };
            self.refuse(row.line, field, &expected)
        })
    }

    /// The error of what was `found` in a line; empty where nothing was.
    pub(super) fn refuse(&self, line: usize, found: &str, expected: &str) -> ContentError {
        let given = if found.is_empty() { String::new() } else { format!("\"{}\"", shortened(found)) };
        ContentError::value(Some(line), &self.label(), &given, expected)
    }

    /// Refuses to assume a unit beside `others` of the same quantity that name another one.
    pub(super) fn check_beside<'c>(
        &self,
        others: impl IntoIterator<Item = &'c Self>,
        line: usize,
    ) -> Result<(), ContentError> {
        let Some(assumed) = self.assumed_unit() else { return Ok(()) };
        let is_other =
            |other: &&Self| other.names_unit && other.unit.dimension == assumed.dimension && !other.unit.is_si();
        let Some(other) = others.into_iter().find(is_other) else { return Ok(()) };
        let expected = format!("{}, for {} names {}", with_unit(self, assumed.name), other.label(), other.unit);
        Err(self.refuse(line, "", &expected))
    }
}

/// Refuses to assume a unit where the header speaks of another one, and for angles.
pub(super) fn check_unit(column: &Column, block: &Block<'_>, line: usize) -> Result<(), ContentError> {
    let Some(assumed) = column.assumed_unit() else { return Ok(()) };
    let stated = block.stated_unit(assumed.dimension, Some(line)).filter(|(_, unit)| unit.name != assumed.name);
    if let Some(((line, text), unit)) = stated {
        let given = format!("\"{}\"", shortened(text));
        return Err(ContentError::value(Some(line), "unit", &given, &with_unit(column, unit.name)));
    }
    let is_phase = assumed.dimension == Dimension::Angle;
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

/// The columns of a table.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    /// The line of the names.
    pub(super) line: usize,
    used: Vec<Column>,
    /// Headings of columns that are not used.
    pub(super) left_out: Vec<String>,
    /// Whether the frequencies were multiplied by a_T already.
    pub(super) reduced: bool,
}

/// A heading without what it says of its whole column, and that.
fn parted(name: &str) -> (String, Option<Condition>, Option<f64>) {
    let found = [Dimension::Temperature, Dimension::Frequency].into_iter();
    let found = found.filter_map(|dimension| without_condition(name, dimension)).next();
    let (name, condition) = found.map_or_else(|| (name.to_owned(), None), |(name, it)| (name, Some(it)));
    let plain = plain(&name);
    let (inner, logarithm) = without_logarithm(&plain);
    (inner.to_owned(), condition, logarithm)
}

impl Columns {
    /// Those of a block; `None` where it has no names.
    pub(super) fn read(block: &Block<'_>, reading: &Reading<'_>) -> Result<Option<Self>, ContentError> {
        let is_given = |name: &str| reading.columns.iter().any(|(_, column)| column.trim() == name.trim());
        let is_known = |name: &str| is_given(name) || !matches!(find(&parted(name).0, "", &ROLES), Ok(None));
        let head = block.head(&is_known)?;
        let Some(line) = head.line else { return Ok(None) };
        let mut columns = Self { line, ..Self::default() };
        let reader = HeadReader { head: &head, reading, line, columns: block.columns };
        let found = reader.all()?;
        for (index, text) in head.names.iter().enumerate() {
            match found.get(index) {
                Some(Some(column)) => columns.used.push(column.clone()),
                _ if text.trim().is_empty() => (),
                _ => columns.left_out.push(text.trim().to_owned()),
            }
        }
        for column in &mut columns.used {
            let (quantity, reduced) = match column.quantity {
                Quantity::ReducedFrequency => (Quantity::Frequency, true),
                Quantity::AngularFrequency => (Quantity::Frequency, false),
                Quantity::ReducedAngularFrequency => (Quantity::Frequency, true),
                other => (other, false),
            };
            column.quantity = quantity;
            columns.reduced |= reduced;
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

/// Finds the columns of a line of names.
struct HeadReader<'h, 'a> {
    head: &'h Head<'a>,
    reading: &'h Reading<'h>,
    line: usize,
    columns: usize,
}

impl HeadReader<'_, '_> {
    fn below(&self, index: usize) -> &str {
        self.head.units.get(index).map_or("", |unit| unit)
    }

    /// The column at each place, where it is one of moduli.
    fn all(&self) -> Result<Vec<Option<Column>>, ContentError> {
        let mut given = Vec::new();
        for (key, name) in self.reading.columns {
            let place = ROLES.iter().position(|role| role.key == key).ok_or_else(|| {
                let known: Vec<&str> = ROLES.iter().map(|role| role.key).collect();
                ContentError::value(None, "columns", &format!("\"{key}\""), &format!("one of {}", known.join(", ")))
            })?;
            given.push((chosen(name, &self.head.names, self.columns, Some(self.line))?, place));
        }
        let is_given = |place: usize| given.iter().any(|(_, role)| *role == place);
        let count = self.head.names.len().min(self.columns);
        let names: Vec<_> = self.head.names[..count].iter().map(|name| parted(name)).collect();
        let found: Vec<_> = names.iter().enumerate().map(|(i, (name, ..))| find(name, self.below(i), &ROLES)).collect();
        let column = |index: usize| {
            let text = self.head.names[index].trim();
            let is_ignored = self.reading.ignored.iter().any(|other| other.trim() == text);
            if is_ignored {
                return Ok(None);
            }
            if let Some((_, place)) = given.iter().find(|(other, _)| *other == index) {
                let dimension = ROLES[*place].dimension;
                let unit = unit_beside(&names[index].0, self.below(index), dimension);
                return self.column(index, *place, unit.map_err(|found| (found, units_of(*place)))).map(Some);
            }
            match &found[index] {
                Ok(None) => Ok(None),
                Ok(Some(heading)) if is_given(heading.role) => Ok(None),
                Ok(Some(heading)) => self.column(index, heading.role, Ok(heading.unit)).map(Some),
                Err(refused) if is_given(refused.role) => Ok(None),
                Err(refused) => {
                    // `F [N]` is no frequency where there is one, and a time in counts need not be known.
                    let quantity = QUANTITIES[refused.role];
                    let has_other = found
                        .iter()
                        .any(|other| matches!(other, Ok(Some(heading)) if QUANTITIES[heading.role] == quantity));
                    let has_unit = self.given_unit(index).is_some();
                    if (has_other || !quantity.is_needed()) && !has_unit {
                        return Ok(None);
                    }
                    let unit = Err((refused.found.clone(), refused.expected.clone()));
                    self.column(index, refused.role, unit).map(Some)
                }
            }
        };
        (0..count).map(column).collect()
    }

    /// The unit that is given for a column.
    fn given_unit(&self, index: usize) -> Option<Unit> {
        given_unit(&self.head.names[index], self.reading.units)
    }

    /// A column in the unit that is given or named; of frequencies that are not called angular, 1/s and no unit are Hz.
    fn column(
        &self,
        index: usize,
        place: usize,
        unit: Result<Option<Unit>, (String, String)>,
    ) -> Result<Column, ContentError> {
        let (role, quantity) = (&ROLES[place], QUANTITIES[place]);
        let text = self.head.names[index].trim().to_owned();
        let label = format!("column {} \"{}\"", index + 1, shortened(&text));
        let refuse = |given: &str, expected: &str| {
            let error = ContentError::value(Some(self.line), &format!("unit of {label}"), given, expected);
            error.or("`ignore` NAME leaves the column out")
        };
        let named = match self.given_unit(index) {
            Some(unit) if unit.is_of(role.dimension) => Some(unit),
            Some(unit) => return Err(refuse(unit.name, &units_of(place))),
            None => unit.map_err(|(found, expected)| refuse(&format!("\"{}\"", shortened(&found)), &expected))?,
        };
        let (_, condition, logarithm) = parted(&text);
        let is_ratio = role.dimension == Dimension::Number;
        let column = Column {
            index,
            quantity,
            unit: named.unwrap_or(if is_ratio { Unit::ONE } else { Unit::si(role.dimension) }),
            names_unit: named.is_some() || is_ratio,
            condition,
            logarithm,
            text,
        };
        let is_rate = column.unit.dimension == Dimension::Rate;
        match quantity {
            Quantity::Frequency | Quantity::ReducedFrequency if is_rate || !column.names_unit => {
                Ok(Column { unit: Unit::parse("Hz").unwrap_or(column.unit), ..column })
            }
            Quantity::AngularFrequency | Quantity::ReducedAngularFrequency if column.unit.name.ends_with("Hz") => {
                let expected = "rad/s or 1/s of an angular frequency; a frequency is in Hz";
                Err(ContentError::value(Some(self.line), &column.label(), "", expected))
            }
            _ => Ok(column),
        }
    }
}

fn units_of(place: usize) -> String {
    format!("one of {}", ROLES[place].dimension.units())
}

/// The unit that is given for a column of this heading, by its name with its own unit or without.
pub(super) fn given_unit(heading: &str, units: &GivenUnits) -> Option<Unit> {
    let normal = |text: &str| plain(text).to_lowercase().replace([' ', '_'], "");
    let heading = normal(heading);
    let bare = heading.split(['[', '(']).next().unwrap_or_default();
    let is_it = |name: &String| [heading.as_str(), bare].contains(&normal(name).as_str());
    units.iter().find(|(name, _)| is_it(name)).map(|(_, unit)| *unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Option<(Quantity, Option<&'static str>)> {
        match find(&parted(text).0, "", &ROLES) {
            Ok(heading) => heading.map(|heading| (QUANTITIES[heading.role], heading.unit.map(|unit| unit.name))),
            Err(refused) => Some((QUANTITIES[refused.role], Some("?"))),
        }
    }

    #[test]
    fn headings_as_people_and_instruments_write_them() {
        use Quantity::{
            AngularFrequency, Complex, Frequency, Loss, LossTangent, Phase, ReducedAngularFrequency, ReducedFrequency,
            Relaxation, Set, SetTemperature, ShearLoss, ShearRelaxation, ShearStorage, ShiftFactor, Storage,
            Temperature, Time, VerticalFactor,
        };
        let cases = [
            ("frequency [Hz]", Frequency, Some("Hz")),
            ("f / Hz", Frequency, Some("Hz")),
            ("Freq_Hz", Frequency, Some("Hz")),
            ("Frequency in kHz", Frequency, Some("kHz")),
            ("frequency [1/s]", Frequency, Some("1/s")),
            ("Oscillation frequency", Frequency, None),
            ("a_T f [Hz]", ReducedFrequency, Some("Hz")),
            ("log f [Hz]", Frequency, Some("Hz")),
            ("Ang. frequency", AngularFrequency, None),
            ("ω / rad/s", AngularFrequency, Some("rad/s")),
            ("Angular frequency (rad s^-1)", AngularFrequency, Some("rad/s")),
            ("aT*ω [rad·s⁻¹]", ReducedAngularFrequency, Some("rad/s")),
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
        for header in [
            "",
            "[MPa]",
            "Strain [%]",
            "Force [N]",
            "Point",
            "1.0",
            "Displacement",
            "J' [1/Pa]",
            "Torque",
            "Relaxation stress [MPa]",
            "Curing temperature [°C]",
        ] {
            assert_eq!(read(header), None, "{header}");
        }
        for header in ["E'' [mPa]", "omega [V]", "f [mhz]"] {
            assert_eq!(read(header).and_then(|(_, unit)| unit), Some("?"), "{header}");
        }
    }
}
