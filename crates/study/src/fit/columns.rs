//! The columns of tables of moduli: what they are called, and what a block of a table has.

use std::ops::Deref;

use asperity::tables::{ContentError, Dimension, NumberRange, ReadColumn, Role, Unit, shortened};
use asperity_formats::text::{
    Block, Decimal, Head, Heading, Row, UsedColumn, assumed_unit, chosen, find, is_missing, no_number, number_of,
    unit_beside, used_column,
};

use super::conditions::{Condition, given_unit, parted};
use super::options::FitOptions;

/// What the file should hold, for messages.
pub(super) const EXPECTED: &str = "columns by their names with units: f [Hz] or omega [rad/s]; E' [MPa] and E'' [MPa] \
     or tan delta, or G' and G'', or |E*| and delta [°]; temperature [°C] if it varies; or time [s] and E(t) [MPa]";

/// What the columns of moduli are called. One name may be that of several; the first is meant where no unit tells.
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
            "E', storage modulus, storage, E stor, E storage, E prime, dynamic storage modulus, dyn storage modulus, tensile storage \
             modulus, young's storage modulus, elastic modulus E', speichermodul",
            Pressure,
        ),
        Role::new(
            "loss_modulus",
            "E'', loss modulus, loss, E loss, E double prime, E doubleprime, dynamic loss modulus, dyn loss modulus, tensile loss \
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
            "|E*|, complex modulus, complex, abs E*, E star, magnitude of E*, complex young's modulus, complex tensile modulus, dynamic \
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
            "E(t), relaxation modulus, E relax, E relaxation, tensile relaxation modulus, young's relaxation modulus, relaxation modulus of \
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

/// Columns that a table of moduli may have without needing them, so that their units need not be known.
const NOT_NEEDED: [&str; 5] = ["time", "set", "set_temperature", "relaxation_modulus", "shear_relaxation_modulus"];

/// A column that is used.
#[derive(Clone, Debug)]
pub(super) struct Column {
    /// Its role, place, heading and unit; not its numbers.
    read: ReadColumn,
    /// What its heading says of all its numbers.
    pub(super) condition: Option<Condition>,
    /// Its numbers are logarithms to this base.
    logarithm: Option<f64>,
}

impl Deref for Column {
    type Target = ReadColumn;

    fn deref(&self) -> &ReadColumn {
        &self.read
    }
}

impl Column {
    /// The column as one that is read.
    pub(super) fn used(&self) -> UsedColumn {
        let used = used_column(self);
        UsedColumn { at_stake: used.at_stake && self.logarithm.is_none(), ..used }
    }

    /// Whether it is one of some roles.
    pub(super) fn is(&self, keys: &[&str]) -> bool {
        keys.contains(&self.key)
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
        let found = match self.logarithm {
            Some(base) => decimal.read(self.field(row)).map(|written| self.unit.to_si(base.powf(written))),
            None => number_of(self, decimal, self.field(row)),
        };
        found.filter(|value| value.is_finite())
    }

    /// The number in a row, in SI units, which is one of a range.
    pub(super) fn read(&self, row: &Row<'_>, decimal: Decimal, range: NumberRange) -> Result<f64, ContentError> {
        let value = self.number(row, decimal).filter(|value| range.holds(*value));
        value.ok_or_else(|| no_number(self, range, decimal, (row.line, self.field(row))))
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
        let Some(assumed) = assumed_unit(self) else { return Ok(()) };
        let is_other =
            |other: &&Self| other.names_unit && other.unit.dimension == assumed.dimension && !other.unit.is_si();
        let Some(other) = others.into_iter().find(is_other) else { return Ok(()) };
        let expected = format!("{}, for {} names {}", with_unit(self, assumed.name), other.label(), other.unit);
        Err(self.refuse(line, "", &expected))
    }
}

/// Refuses to assume a unit where the header speaks of another one, and for angles.
pub(super) fn check_unit(column: &Column, block: &Block<'_>, line: usize) -> Result<(), ContentError> {
    let Some(assumed) = assumed_unit(column) else { return Ok(()) };
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

impl Columns {
    /// Those of a block; `None` where it has no names.
    pub(super) fn read(block: &Block<'_>, options: &FitOptions) -> Result<Option<Self>, ContentError> {
        let is_given = |name: &str| options.columns.iter().any(|(_, column)| column.trim() == name.trim());
        let is_known = |name: &str| is_given(name) || !matches!(find(&parted(name).0, "", &ROLES), Ok(None));
        let head = block.head(&is_known)?;
        let Some(line) = head.line else { return Ok(None) };
        let mut columns = Self { line, ..Self::default() };
        let reader = HeadReader { head: &head, options, line, columns: block.columns };
        let found = reader.all()?;
        for (index, text) in head.names.iter().enumerate() {
            match found.get(index) {
                Some(Some(column)) => columns.used.push(column.clone()),
                _ if text.trim().is_empty() => (),
                _ => columns.left_out.push(text.trim().to_owned()),
            }
        }
        for column in &mut columns.used {
            columns.reduced |= column.is(&["reduced_frequency", "reduced_angular_frequency"]);
            if column.is(&["reduced_frequency", "angular_frequency", "reduced_angular_frequency"]) {
                column.read.key = "frequency";
            }
        }
        Ok(Some(columns))
    }

    /// The columns of the first of some roles that has any.
    pub(super) fn first(&self, keys: &[&str]) -> Vec<Column> {
        let of_role = |key| self.used.iter().filter(|column| column.is(&[key])).cloned().collect::<Vec<_>>();
        keys.iter().map(|key| of_role(*key)).find(|found| !found.is_empty()).unwrap_or_default()
    }
}

/// Finds the columns of a line of names.
struct HeadReader<'h, 'a> {
    head: &'h Head<'a>,
    options: &'h FitOptions,
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
        for (key, name) in &self.options.columns {
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
            let is_ignored = self.options.ignore.iter().any(|other| other.trim() == text);
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
                    let is_of_role = |other: &Result<Option<Heading>, _>| matches!(other, Ok(Some(heading)) if heading.role == refused.role);
                    let is_spare = found.iter().any(is_of_role) || NOT_NEEDED.contains(&ROLES[refused.role].key);
                    if is_spare && self.given_unit(index).is_none() {
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
        given_unit(&self.head.names[index], &self.options.units)
    }

    /// A column in the unit that is given or named; of frequencies that are not called angular, 1/s and no unit are Hz.
    fn column(
        &self,
        index: usize,
        place: usize,
        unit: Result<Option<Unit>, (String, String)>,
    ) -> Result<Column, ContentError> {
        let role = &ROLES[place];
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
        let mut read = ReadColumn {
            names_unit: named.is_some() || is_ratio,
            text,
            ..ReadColumn::new(role, index, named.unwrap_or(if is_ratio { Unit::ONE } else { Unit::si(role.dimension) }))
        };
        let is_angular = ["angular_frequency", "reduced_angular_frequency"].contains(&role.key);
        let is_in_cycles = ["frequency", "reduced_frequency"].contains(&role.key);
        if is_in_cycles && (read.unit.dimension == Dimension::Rate || !read.names_unit) {
            read.unit = Unit::parse("Hz").unwrap_or(read.unit);
        } else if is_angular && read.unit.name.ends_with("Hz") {
            let expected = "rad/s or 1/s of an angular frequency; a frequency is in Hz";
            return Err(ContentError::value(Some(self.line), &read.label(), "", expected));
        }
        Ok(Column { read, condition, logarithm })
    }
}

fn units_of(place: usize) -> String {
    format!("one of {}", ROLES[place].dimension.units())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Option<(&'static str, Option<&'static str>)> {
        match find(&parted(text).0, "", &ROLES) {
            Ok(heading) => heading.map(|heading| (ROLES[heading.role].key, heading.unit.map(|unit| unit.name))),
            Err(refused) => Some((ROLES[refused.role].key, Some("?"))),
        }
    }

    #[test]
    fn headings_as_people_and_instruments_write_them() {
        let cases = [
            ("frequency [Hz]", "frequency", Some("Hz")),
            ("f / Hz", "frequency", Some("Hz")),
            ("Freq_Hz", "frequency", Some("Hz")),
            ("Frequency in kHz", "frequency", Some("kHz")),
            ("frequency [1/s]", "frequency", Some("1/s")),
            ("Oscillation frequency", "frequency", None),
            ("a_T f [Hz]", "reduced_frequency", Some("Hz")),
            ("log f [Hz]", "frequency", Some("Hz")),
            ("Ang. frequency", "angular_frequency", None),
            ("ω / rad/s", "angular_frequency", Some("rad/s")),
            ("Angular frequency (rad s^-1)", "angular_frequency", Some("rad/s")),
            ("aT*ω [rad·s⁻¹]", "reduced_angular_frequency", Some("rad/s")),
            ("E' [MPa]", "storage_modulus", Some("MPa")),
            ("E′ (GPa)", "storage_modulus", Some("GPa")),
            ("E’ in Mpa", "storage_modulus", Some("MPa")),
            ("E_prime_Pa", "storage_modulus", Some("Pa")),
            ("E_stor", "storage_modulus", None),
            ("Dyn. Storage Modulus", "storage_modulus", None),
            ("Storage Modulus (E') [kPa]", "storage_modulus", Some("kPa")),
            ("Speichermodul E' [N/mm²]", "storage_modulus", Some("N/mm²")),
            ("E\" [MPa]", "loss_modulus", Some("MPa")),
            ("E double prime (MPa)", "loss_modulus", Some("MPa")),
            ("Loss Modulus, MPa", "loss_modulus", Some("MPa")),
            ("Verlustmodul E\" [MPa]", "loss_modulus", Some("MPa")),
            ("E' [psi]", "storage_modulus", Some("psi")),
            ("G' (MPa)", "shear_storage_modulus", Some("MPa")),
            ("Shear storage modulus", "shear_storage_modulus", None),
            ("Storage modulus G' [Pa]", "shear_storage_modulus", Some("Pa")),
            ("G\"", "shear_loss_modulus", None),
            ("|E*| (MPa)", "complex_modulus", Some("MPa")),
            ("Complex modulus [MPa]", "complex_modulus", Some("MPa")),
            ("tan(d) [-]", "loss_tangent", Some("1")),
            ("Tan Delta", "loss_tangent", None),
            ("loss factor", "loss_tangent", None),
            ("Phase angle [°]", "phase_angle", Some("°")),
            ("delta (deg)", "phase_angle", Some("°")),
            ("Temp. [°C]", "temperature", Some("°C")),
            ("T [degC]", "temperature", Some("°C")),
            ("T [F]", "temperature", Some("°F")),
            ("t [°C]", "temperature", Some("°C")),
            ("t [s]", "time", Some("s")),
            ("Set temperature [°C]", "set_temperature", Some("°C")),
            ("Set", "set", None),
            ("E_relax", "relaxation_modulus", None),
            ("E(t) [MPa]", "relaxation_modulus", Some("MPa")),
            ("G(t)", "shear_relaxation_modulus", None),
            ("a_T", "shift_factor", None),
            ("log aT", "shift_factor", None),
            ("Shift factor", "shift_factor", None),
            ("b_T", "vertical_factor", None),
            ("log bT", "vertical_factor", None),
            ("Vertical shift factor", "vertical_factor", None),
        ];
        for (header, key, unit) in cases {
            assert_eq!(read(header), Some((key, unit)), "{header}");
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
