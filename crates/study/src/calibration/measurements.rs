//! Tables of measured friction: columns by their names and units.

use asperity::element::{Load, OperatingPoint};
use asperity::tables::{Block, Dimension, Head, Heading, HeadingUnit, NumberStyle, Unit, Words, decode};

/// A measured friction coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Its line in the file, from 1.
    pub line: usize,
    /// Speed (m/s), pressure (Pa), temperature (K).
    pub point: OperatingPoint,
    /// The friction coefficient.
    pub friction: f64,
    /// Its standard deviation, where it was measured.
    pub sigma: Option<f64>,
}

impl Measured {
    /// The standard deviation, or what it is assumed to be.
    pub fn sigma_or_assumed(&self) -> f64 {
        self.sigma.unwrap_or_else(|| assumed_sigma(self.friction))
    }
}

/// The standard deviation of a friction coefficient that none is given for: 5 % of it and 0.01.
pub(super) fn assumed_sigma(friction: f64) -> f64 {
    (0.05 * friction).hypot(0.01)
}

/// A table of measured friction.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurements {
    /// The rows; several of a point are repeats.
    pub rows: Vec<Measured>,
    /// How the columns were read.
    pub notes: Vec<String>,
}

/// Why a table is refused: `12: column 2 (mu) = "fast": expected a number above 0`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{line}: {problem}")]
pub struct MeasurementsError {
    line: usize,
    problem: String,
}

impl MeasurementsError {
    fn new(line: usize, problem: impl Into<String>) -> Self {
        Self { line, problem: problem.into() }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Speed,
    Pressure,
    Force,
    Friction,
    Temperature,
    Deviation,
}

const EXPECTED: &str = "columns by their names with units: speed [m/s], pressure [bar] or force [N], friction; temperature [°C] \
                        and the standard deviation of friction where there are such";

const VOCABULARY: [Words<Quantity>; 6] = [
    Words::new(
        Quantity::Deviation,
        Dimension::Number,
        &["sigma", "σ", "std", "sd", "stdev", "deviation", "uncertainty", "standardabweichung"],
        &["standard", "of", "friction", "coefficient", "mu", "μ", "cof", "error", "the"],
    ),
    Words::new(
        Quantity::Speed,
        Dimension::Speed,
        &["speed", "velocity", "v", "geschwindigkeit", "gleitgeschwindigkeit"],
        &["sliding", "slip", "slide", "relative", "mean", "v"],
    ),
    Words::new(
        Quantity::Pressure,
        Dimension::Pressure,
        &["pressure", "p", "druck", "flächenpressung"],
        &["mean", "nominal", "contact", "normal", "average", "p"],
    ),
    Words::new(
        Quantity::Force,
        Dimension::Force,
        &["force", "load", "fz", "fn", "normalkraft", "last"],
        &["normal", "f", "z", "vertical", "mean"],
    ),
    Words::new(
        Quantity::Friction,
        Dimension::Number,
        &["friction", "mu", "μ", "cof", "reibwert", "reibungszahl"],
        &["coefficient", "of", "friction", "mean", "the", "measured"],
    ),
    Words::new(
        Quantity::Temperature,
        Dimension::Temperature,
        &["T", "temp", "temperature", "temperatur", "t"],
        &["sample", "mean", "rubber", "surface", "ambient", "track", "measured"],
    ),
];

/// A column that is used.
#[derive(Clone, Copy, Debug)]
struct Column {
    index: usize,
    unit: Unit,
}

/// The numbers that a column may hold in SI units, and how to say so.
type Allowed = (fn(f64) -> bool, &'static str);
const ABOVE_ZERO: Allowed = (|value| value > 0.0, "a number above 0");

impl Measurements {
    /// Reads the table in the bytes of a file; forces are those on the whole layer, whose `area` (m²) makes pressures of
    /// them.
    ///
    /// # Errors
    /// [`MeasurementsError`] with the line, what was expected and what was found.
    pub fn parse(bytes: &[u8], area: f64) -> Result<Self, MeasurementsError> {
        let text = decode(bytes).map_err(|error| MeasurementsError::new(1, error.to_string()))?;
        let blocks = Block::all(&text, false);
        let Some(block) = blocks.iter().max_by_key(|block| block.rows) else {
            return Err(MeasurementsError::new(
                text.lines().count().max(1),
                format!("no rows of numbers: expected {EXPECTED}"),
            ));
        };
        let head = block.head(&|name| Heading::parse(name, &VOCABULARY).is_some());
        let mut reader = TableReader { block, head: &head, notes: Vec::new() };
        let needed = |column: Option<Column>| {
            let names = if head.names.is_empty() { "no names".to_owned() } else { head.names.join(", ") };
            let line = head.line.unwrap_or(block.first);
            column.ok_or_else(|| MeasurementsError::new(line, format!("columns {names}: expected {EXPECTED}")))
        };
        let speed = needed(reader.column(Quantity::Speed)?)?;
        let pressure = reader.column(Quantity::Pressure)?;
        let force = if pressure.is_none() { reader.column(Quantity::Force)? } else { None };
        let load = needed(pressure.or(force))?;
        let friction = needed(reader.column(Quantity::Friction)?)?;
        let (temperature, deviation) = (reader.column(Quantity::Temperature)?, reader.column(Quantity::Deviation)?);
        let to_pressure = if force.is_some() { Load::Pressure { area }.at_force(1.0) } else { 1.0 };
        if force.is_some() {
            reader.notes.push(format!("forces are those on the scene's whole layer, {area:.6e} m²"));
        }
        let mut style = NumberStyle::of(block);
        let mut rows = Vec::with_capacity(block.rows);
        for (line, row) in block.lines(&text) {
            let fields = block.separator.split(row);
            let mut number = |column: Column, allowed: Allowed| {
                let field = fields.get(column.index).map_or("", |field| field);
                reader.number(&mut style, line, field, column, allowed)
            };
            let point = OperatingPoint {
                speed: number(speed, ABOVE_ZERO)?,
                load: to_pressure * number(load, ABOVE_ZERO)?,
                temperature: temperature
                    .map(|column| number(column, (|value| value > 0.0, "a temperature above 0 K")))
                    .transpose()?,
            };
            let friction = number(friction, (f64::is_finite, "a number"))?;
            let sigma = deviation.map(|column| number(column, ABOVE_ZERO)).transpose()?;
            rows.push(Measured { line, point, friction, sigma });
        }
        Ok(Self { rows, notes: reader.notes })
    }

    /// Whether the standard deviations were measured.
    pub fn has_sigma(&self) -> bool {
        self.rows.iter().all(|row| row.sigma.is_some())
    }

    /// Whether the table has temperatures.
    pub fn has_temperature(&self) -> bool {
        self.rows.iter().any(|row| row.point.temperature.is_some())
    }
}

/// Reads the columns of a table.
#[derive(Debug)]
struct TableReader<'a, 'b> {
    block: &'a Block<'b>,
    head: &'a Head<'b>,
    notes: Vec<String>,
}

impl TableReader<'_, '_> {
    /// The column of a quantity; `None` where there is none.
    fn column(&mut self, quantity: Quantity) -> Result<Option<Column>, MeasurementsError> {
        let line = self.head.line.unwrap_or(self.block.first);
        let headings = self.head.headings(&VOCABULARY);
        let found: Vec<(usize, &Heading<Quantity>)> = (0..)
            .zip(&headings)
            .filter_map(|(index, heading)| Some((index, heading.as_ref()?)))
            .filter(|(_, heading)| heading.quantity == quantity)
            .collect();
        let (index, heading) = match found[..] {
            [] => return Ok(None),
            [only] => only,
            [(first, _), (second, _), ..] => {
                let [first, second] = [first, second].map(|index| self.head.names[index].trim());
                return Err(MeasurementsError::new(
                    line,
                    format!("columns {first} and {second}: expected one of them"),
                ));
            }
        };
        let name = format!("column {} ({})", index + 1, self.head.names[index].trim());
        if heading.logarithm.is_some() {
            return Err(MeasurementsError::new(line, format!("{name}: expected numbers, not their logarithms")));
        }
        let dimension = heading.dimension;
        let unit = match &heading.unit {
            HeadingUnit::Known(unit) => *unit,
            HeadingUnit::None if dimension == Dimension::Number => Unit::ONE,
            HeadingUnit::None if dimension == Dimension::Temperature => {
                let problem = format!("{name}: expected the unit beside the name, as in temperature [°C]");
                return Err(MeasurementsError::new(line, problem));
            }
            HeadingUnit::None => {
                let unit = Unit::si(dimension);
                if let Some(((stated, text), other)) = self.block.stated_unit(dimension, self.head.line)
                    && !other.is_si()
                {
                    let problem = format!("`{text}`: expected the unit beside the name of {name}, as in [{other}]");
                    return Err(MeasurementsError::new(stated, problem));
                }
                self.notes.push(format!("{name} names no unit: {unit} is assumed"));
                unit
            }
            HeadingUnit::Unknown(unit) => {
                let problem = format!("{name}: unit \"{unit}\": expected one of {}", dimension.units());
                return Err(MeasurementsError::new(line, problem));
            }
        };
        Ok(Some(Column { index, unit }))
    }

    /// The number in a field, in SI units.
    fn number(
        &self,
        style: &mut NumberStyle,
        line: usize,
        field: &str,
        column: Column,
        (is_allowed, expected): Allowed,
    ) -> Result<f64, MeasurementsError> {
        let name = self.head.names.get(column.index).map_or("", |name| name.trim());
        let refuse = |expected: &str| {
            let number = column.index + 1;
            MeasurementsError::new(line, format!("column {number} ({name}) = \"{field}\": expected {expected}"))
        };
        let written = style.read(field).map_err(|_| refuse(NumberStyle::EXPECTED))?;
        let value = written.map(|written| column.unit.to_si(written));
        value.filter(|value| value.is_finite() && is_allowed(*value)).ok_or_else(|| refuse(expected))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Measurements, String> {
        Measurements::parse(text.as_bytes(), 2e-3).map_err(|error| error.to_string())
    }

    #[test]
    fn columns_are_found_by_name_and_unit() {
        let measured =
            read("sample;v [mm/s];p [bar];T [°C];mu;std\n1;10;2,5;20;0,8;0,02\n1;100;2,5;40;0,7;0,03\n").unwrap();
        let first = measured.rows[0];
        assert_eq!(first.line, 2);
        assert_eq!(first.point, OperatingPoint { speed: 0.01, load: 2.5e5, temperature: Some(293.15) });
        assert_eq!((first.friction, first.sigma), (0.8, Some(0.02)));
        assert!(measured.has_sigma() && measured.has_temperature() && measured.notes.is_empty());
    }

    /// 40 N on 2e-3 m² are 20 kPa; 5 % of 0.8 and 0.01 together are 0.0412.
    #[test]
    fn forces_make_pressures_and_deviations_are_assumed() {
        let measured = read("speed,normal force [N],friction coefficient\n0.1,40,0.8\n0.1,40,0.9\n").unwrap();
        assert_eq!(measured.rows[0].point.load, 40.0 / 2e-3);
        assert!((measured.rows[0].sigma_or_assumed() - 0.0412).abs() < 1e-4 && !measured.has_sigma());
        assert_eq!(measured.notes.len(), 2, "{:?}", measured.notes);
        assert!(measured.notes[0].contains("m/s is assumed"), "{:?}", measured.notes);
    }

    #[test]
    fn what_is_missing_or_wrong_is_said_with_its_line() {
        for (text, message) in [
            ("speed [m/s],friction\n1,2\n2,3\n", "1: columns speed [m/s], friction: expected columns by"),
            ("speed [m/s],p [Pa],mu\n1,2,3\n2,-3,1\n", "3: column 2 (p [Pa]) = \"-3\": expected a number above 0"),
            ("speed [m/s],p [furlong],mu\n1,2,3\n", "1: column 2 (p [furlong]): unit \"furlong\": expected one of Pa"),
            ("speed [m/s],p [Pa],mu,temperature\n1,2,3,4\n", "1: column 4 (temperature): expected the unit"),
            ("speed [m/s],v [m/s],p [Pa],mu\n1,2,3,4\n", "1: columns speed [m/s] and v [m/s]: expected one of them"),
            ("only words\n", "1: no rows of numbers"),
        ] {
            let refusal = read(text).unwrap_err();
            assert!(refusal.starts_with(message), "{text}\n{refusal}");
        }
    }
}
