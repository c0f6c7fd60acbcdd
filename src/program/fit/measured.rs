//! Tables of measured moduli, as people and instruments write them, and their shift to one temperature.

use std::borrow::Cow;
use std::fmt;

use asperity::scene::text_table::{self, Row};

use super::header::{EXPECTED_HEADER, Header, Quantity, Scale};
use super::search::Sample;
use crate::program::cli::WlfConstants;

/// Measured moduli in SI units.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MeasuredModuli {
    pub(super) points: Vec<MeasuredPoint>,
    /// Whether the file gives frequencies in Hz, not in rad/s.
    pub(super) in_hertz: bool,
    /// The column of the temperatures, if there is one.
    pub(super) temperature: Option<ColumnName>,
    /// Line number of the header.
    pub(super) header_line: usize,
    /// Assumptions made in reading, for the user.
    pub(super) notes: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeasuredPoint {
    /// Line number in the file.
    pub(super) line: usize,
    pub(super) sample: Sample,
    /// K.
    pub(super) temperature: Option<f64>,
}

/// A column, for messages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ColumnName {
    /// Counted from 1.
    number: usize,
    header: String,
}

/// A table cannot be used: where, what was found and what was expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) struct ModuliError {
    line: usize,
    column: Option<ColumnName>,
    /// As written in the file; empty where something is missing.
    found: String,
    expected: String,
}

impl fmt::Display for ModuliError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let found = shortened(&self.found);
        write!(f, "{}: ", self.line)?;
        match &self.column {
            Some(ColumnName { number, header }) if header.is_empty() || *header == self.found => {
                write!(f, "column {number}")?;
            }
            Some(ColumnName { number, header }) => write!(f, "column {number} ({header})")?,
            None => {}
        }
        match (&self.column, found.as_str()) {
            (Some(_), "") => write!(f, ": ")?,
            (Some(_), found) => write!(f, " = \"{found}\": ")?,
            (None, "") => {}
            (None, found) => write!(f, "{found}: ")?,
        }
        write!(f, "expected {}", self.expected)
    }
}

fn shortened(text: &str) -> String {
    text.chars().take(60).collect()
}

impl ModuliError {
    fn in_line(line: usize, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self { line, column: None, found: found.into(), expected: expected.into() }
    }
}

#[derive(Clone, Debug)]
struct Column {
    /// Counted from 0.
    index: usize,
    text: String,
    header: Header,
    scale: Scale,
}

impl Column {
    fn name(&self) -> ColumnName {
        ColumnName { number: self.index + 1, header: self.text.clone() }
    }

    fn error(&self, line: usize, found: &str, expected: impl Into<String>) -> ModuliError {
        ModuliError { line, column: Some(self.name()), found: found.into(), expected: expected.into() }
    }

    /// The number in a row, in SI units. A comma is a decimal comma, since commas that separate are gone.
    fn number(&self, row: &Row<'_>) -> Option<f64> {
        let written: f64 = row.fields[self.index].replace(',', ".").parse().ok()?;
        Some(self.scale.apply(written)).filter(|value| value.is_finite())
    }

    fn positive(&self, row: &Row<'_>) -> Result<f64, ModuliError> {
        self.checked(row, "a number above 0 (from 1e-30 to 1e30 in SI units)")
    }

    fn temperature(&self, row: &Row<'_>) -> Result<f64, ModuliError> {
        self.checked(row, "a temperature above 0 K")
    }

    /// The number in a row, above 0 and of a size that a scene may have.
    fn checked(&self, row: &Row<'_>, expected: &str) -> Result<f64, ModuliError> {
        let value = self.number(row).filter(|value| (1e-30..=1e30).contains(value));
        value.ok_or_else(|| self.error(row.line, &row.fields[self.index], expected))
    }
}

struct Columns {
    /// Number of fields in a row.
    fields: usize,
    frequency: Column,
    storage: Column,
    loss: Option<Column>,
    tangent: Option<Column>,
    temperature: Option<Column>,
}

impl Columns {
    fn new(columns: &[Column], header: &Row<'_>) -> Result<Self, ModuliError> {
        let find = |quantity: Quantity| columns.iter().find(|column| column.header.quantity == quantity).cloned();
        let missing = |expected: &str| ModuliError::in_line(header.line, "", expected);
        let found = Self {
            fields: header.fields.len(),
            frequency: find(Quantity::Frequency)
                .ok_or_else(|| missing("a frequency column: f [Hz] or omega [rad/s]"))?,
            storage: find(Quantity::Storage).ok_or_else(|| missing("a column of the storage modulus: E' [MPa]"))?,
            loss: find(Quantity::Loss),
            tangent: find(Quantity::LossTangent),
            temperature: find(Quantity::Temperature),
        };
        if found.loss.is_none() && found.tangent.is_none() {
            return Err(missing("a column of the loss: E'' [MPa] or tan delta"));
        }
        Ok(found)
    }

    fn point(&self, row: &Row<'_>) -> Result<MeasuredPoint, ModuliError> {
        if row.fields.len() != self.fields {
            let found = format!("{} columns", row.fields.len());
            return Err(ModuliError::in_line(row.line, found, format!("{}, as many as headers", self.fields)));
        }
        let omega = self.frequency.positive(row)?;
        let storage = self.storage.positive(row)?;
        let tangent = self.tangent.as_ref().map(|column| column.positive(row)).transpose()?;
        let loss = self.loss.as_ref().map(|column| column.positive(row)).transpose()?;
        let loss = loss.or(tangent.map(|tangent| storage * tangent)).unwrap_or_default();
        let temperature = self.temperature.as_ref().map(|column| column.temperature(row)).transpose()?;
        Ok(MeasuredPoint { line: row.line, sample: Sample { omega, storage, loss }, temperature })
    }
}

impl MeasuredModuli {
    /// Reads a table without the columns whose headers are `ignored`.
    pub(super) fn parse(bytes: &[u8], ignored: &[String]) -> Result<Self, ModuliError> {
        let text = text_table::decode(bytes)
            .map_err(|_| ModuliError::in_line(1, text_table::NotText::FOUND, text_table::NotText::EXPECTED))?;
        let mut rows = text_table::rows(&text, None).peekable();
        let header = rows.next().ok_or_else(|| ModuliError::in_line(1, "", "a header line, then rows"))?;
        let mut columns = columns(&header, ignored)?;
        if let Some(with_units) = rows.peek().and_then(|row| with_units(&columns, row)) {
            columns = with_units;
            rows.next();
        }
        let notes = assume_units(&mut columns, &header)?;
        let columns = Columns::new(&columns, &header)?;
        let points: Vec<MeasuredPoint> = rows.map(|row| columns.point(&row)).collect::<Result<_, _>>()?;
        if points.is_empty() {
            return Err(ModuliError::in_line(header.line + 1, "", "a row of numbers"));
        }
        Ok(Self {
            points,
            in_hertz: columns.frequency.scale.factor != 1.0,
            temperature: columns.temperature.as_ref().map(Column::name),
            header_line: header.line,
            notes,
        })
    }

    /// The points at the reference temperature by time-temperature superposition: at a_T ω, their moduli unchanged.
    /// Points without a temperature are taken to be at the reference temperature.
    pub(super) fn at_reference(&self, wlf: Option<WlfConstants>) -> Result<Vec<Sample>, ModuliError> {
        match (&self.temperature, wlf) {
            (Some(column), None) => Err(ModuliError {
                line: self.header_line,
                column: Some(column.clone()),
                found: column.header.clone(),
                expected:
                    "the constants to shift by as well: --wlf C1,C2,TREF (C2 and TREF in K); or, for rows of one \
                           temperature, --ignore with this header"
                        .into(),
            }),
            (Some(column), Some(wlf)) => self.points.iter().map(|point| shifted(point, column, wlf)).collect(),
            (None, _) => Ok(self.points.iter().map(|point| point.sample).collect()),
        }
    }
}

fn shifted(point: &MeasuredPoint, column: &ColumnName, wlf: WlfConstants) -> Result<Sample, ModuliError> {
    /// Far above the shift of any rubber: closer to the pole, a fit would depend on the constants alone.
    const LARGEST: f64 = 1e60;
    let temperature = point.temperature.unwrap_or(wlf.reference_temperature);
    let wlf = wlf.at(temperature);
    let factor = wlf.shift_factor();
    if temperature > wlf.lowest_temperature() && (1.0 / LARGEST..=LARGEST).contains(&factor) {
        return Ok(Sample { omega: point.sample.omega * factor, ..point.sample });
    }
    Err(ModuliError {
        line: point.line,
        column: Some(column.clone()),
        found: format!("{temperature} K"),
        expected: format!(
            "more than TREF - C2 = {:.2} K, and not close to it: there the shift has its pole",
            wlf.lowest_temperature()
        ),
    })
}

/// The columns in use, with the units that their headers name.
fn columns(header: &Row<'_>, ignored: &[String]) -> Result<Vec<Column>, ModuliError> {
    if let Some(name) = ignored.iter().find(|name| !header.fields.iter().any(|field| field == name.trim())) {
        let expected = format!("one of the headers: {}", header.fields.join(", "));
        return Err(ModuliError::in_line(header.line, format!("--ignore {name}"), expected));
    }
    let mut columns: Vec<Column> = Vec::new();
    for (index, text) in header.fields.iter().enumerate() {
        let is_padding = header.fields[index..].iter().all(|field| field.is_empty());
        if is_padding || ignored.iter().any(|name| name.trim() == text) {
            continue;
        }
        let error = |expected: String| {
            let column = Some(ColumnName { number: index + 1, header: text.to_string() });
            ModuliError { line: header.line, column, found: text.to_string(), expected }
        };
        let header = Header::parse(text).ok_or_else(|| error(EXPECTED_HEADER.into()))?;
        if let Some(twin) = columns.iter().find(|column| column.header.quantity == header.quantity) {
            let expected = format!("one column of a kind: {} is there already; ignore one by --ignore NAME", twin.text);
            return Err(error(expected));
        }
        let scale = header.scale.unwrap_or(Scale::ONE);
        columns.push(Column { index, text: text.to_string(), header, scale });
    }
    Ok(columns)
}

/// The columns with the units of the line below the header; `None` if that is no line of units.
fn with_units(columns: &[Column], row: &Row<'_>) -> Option<Vec<Column>> {
    let is_empty = |column: &Column| row.fields.get(column.index).is_none_or(|field| field.is_empty());
    if columns.iter().all(is_empty) {
        return None;
    }
    let with_unit = |column: &Column| {
        let header = column.header.with_unit(row.fields.get(column.index).map(Cow::as_ref)?)?;
        Some(Column { header, scale: header.scale?, ..column.clone() })
    };
    columns.iter().map(with_unit).collect()
}

/// Assumes units where the file names none: a modulus has the unit of the other one. Returns notes on the assumptions.
fn assume_units(columns: &mut [Column], header: &Row<'_>) -> Result<Vec<String>, ModuliError> {
    let is_modulus = |column: &&Column| matches!(column.header.quantity, Quantity::Storage | Quantity::Loss);
    let other = columns.iter().filter(is_modulus).find_map(|column| column.header.scale);
    let mut notes = Vec::new();
    for column in columns.iter_mut().filter(|column| column.header.scale.is_none()) {
        if column.header.quantity == Quantity::Temperature {
            return Err(column.error(header.line, &column.text, "a unit, °C or K, as in temperature [°C]"));
        }
        column.scale = column.header.default_scale().or(other).unwrap_or(Scale::ONE);
        let assumed = match (column.header.quantity, other) {
            (Quantity::LossTangent, _) => continue,
            (Quantity::Frequency, _) if column.scale == Scale::ONE => "rad/s",
            (Quantity::Frequency, _) => "Hz",
            (_, Some(_)) => "that of the other modulus",
            (_, None) => "Pa",
        };
        notes.push(format!("column {} ({}) names no unit: taken as {assumed}", column.index + 1, column.text));
    }
    let has = |quantity: Quantity| columns.iter().any(|column| column.header.quantity == quantity);
    if has(Quantity::Loss) && has(Quantity::LossTangent) {
        notes.push("both E'' and tan delta are given: E'' is used".into());
    }
    Ok(notes)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn read(text: &str) -> MeasuredModuli {
        MeasuredModuli::parse(text.as_bytes(), &[]).unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    fn refusal(text: &str) -> String {
        MeasuredModuli::parse(text.as_bytes(), &[]).unwrap_err().to_string()
    }

    /// 2 Hz, E' = 3 MPa, E'' = 0.6 MPa, 20 °C, however they are written.
    #[test]
    fn tables_as_people_and_instruments_write_them() {
        let texts = [
            "frequency [Hz],E' [MPa],E'' [MPa],T [K]\n2,3,0.6,293.15\n",
            "\u{feff}f (Hz);E' (kPa);E'' (Pa);temperature [°C]\r\n2;3000;6e5;20\r\n",
            "# by hand\n\ntan delta\ttemperature (C)\tstorage modulus [GPa]\tf [kHz]\n0,2\t20,0\t0,003\t0,002\n",
            "Frequency,Storage modulus,Loss modulus,Temperature\nHz,MPa,MPa,°C\n2,3,0.6,20",
            "\"Frequency, Hz\",\"E\"\" [MPa]\",\"E' [MPa]\",\"T (K)\"\n\"2\",\"0.6\",\"3\",\"293.15\"\n",
            "omega [rad/s];E' [MPa];loss modulus;T [K];;\n12.566370614359172;3;0.6;293.15;;\n",
        ];
        for text in texts {
            let row = read(text).points[0];
            // Rounding of the conversions.
            let close = |value: f64, wanted: f64| (value / wanted - 1.0).abs() < 1e-15;
            let Sample { omega, storage, loss } = row.sample;
            assert!(close(omega, 2.0 * TAU) && close(storage, 3e6) && close(loss, 6e5), "{text}: {row:?}");
            assert!(close(row.temperature.unwrap(), 293.15), "{text}: {row:?}");
        }
    }

    #[test]
    fn latin_1_and_utf_16_are_read_too() {
        let bytes = b"f [Hz];E' [N/mm\xb2];tan d;Temp. [\xb0C]\r\n1;2;0,1;-10\r\n";
        let measured = MeasuredModuli::parse(bytes, &[]).unwrap();
        assert_eq!(measured.points[0].temperature, Some(263.15));
        assert_eq!(measured.points[0].sample.storage, 2e6);
        let text: String = bytes.iter().copied().map(char::from).collect();
        let utf_16: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(MeasuredModuli::parse(&utf_16, &[]), Ok(measured));
    }

    #[test]
    fn assumptions_are_noted() {
        let notes = |text: &str| read(text).notes;
        assert_eq!(
            notes("f,E' [MPa],E''\n1,2,3"),
            [
                "column 1 (f) names no unit: taken as Hz",
                "column 3 (E'') names no unit: taken as that of the other modulus"
            ]
        );
        assert_eq!(
            notes("omega,E',tan(d)\n1,2,3"),
            ["column 1 (omega) names no unit: taken as rad/s", "column 2 (E') names no unit: taken as Pa"]
        );
        assert_eq!(notes("f [Hz],E' [Pa],E'' [Pa],tan(d)\n1,2,3,9"), ["both E'' and tan delta are given: E'' is used"]);
        assert_eq!(read("f [Hz],E' [Pa],E'' [Pa],tan(d)\n1,2,3,9").points[0].sample.loss, 3.0);
    }

    #[test]
    fn a_column_is_left_out_by_its_name() {
        let text = "Point,f [Hz],E' [Pa],E'' [Pa]\na,1,2,3";
        assert!(refusal(text).starts_with("1: column 1 = \"Point\": expected a quantity and its unit, such as"));
        let ignored = |name: &str| MeasuredModuli::parse(text.as_bytes(), &[name.to_owned()]);
        assert_eq!(ignored("Point").unwrap().points.len(), 1);
        let message = "1: --ignore point: expected one of the headers: Point, f [Hz], E' [Pa], E'' [Pa]";
        assert_eq!(ignored("point").unwrap_err().to_string(), message);
    }

    #[test]
    fn what_is_wrong_is_refused_with_line_and_column() {
        const POSITIVE: &str = "expected a number above 0 (from 1e-30 to 1e30 in SI units)";
        let head = "f [Hz],E' [MPa],E'' [MPa]";
        let cases = [
            (format!("{head}\n1,2,3\n\n2,x,3"), format!("4: column 2 (E' [MPa]) = \"x\": {POSITIVE}")),
            (format!("{head}\n1,2,-3"), format!("2: column 3 (E'' [MPa]) = \"-3\": {POSITIVE}")),
            (format!("{head}\n0,2,3"), format!("2: column 1 (f [Hz]) = \"0\": {POSITIVE}")),
            (format!("{head}\n1,,3"), format!("2: column 2 (E' [MPa]): {POSITIVE}")),
            (format!("{head}\n1,nan,3"), format!("2: column 2 (E' [MPa]) = \"nan\": {POSITIVE}")),
            (format!("{head}\n1,1e-40,3"), format!("2: column 2 (E' [MPa]) = \"1e-40\": {POSITIVE}")),
            (format!("{head}\n1,2"), "2: 2 columns: expected 3, as many as headers".into()),
            (head.into(), "2: expected a row of numbers".into()),
            (String::new(), "1: expected a header line, then rows".into()),
            ("f [Hz],E'' [Pa]\n1,2".into(), "1: expected a column of the storage modulus: E' [MPa]".into()),
            ("f [Hz],E' [Pa]\n1,2".into(), "1: expected a column of the loss: E'' [MPa] or tan delta".into()),
            ("E' [Pa],E'' [Pa]\n1,2".into(), "1: expected a frequency column: f [Hz] or omega [rad/s]".into()),
            (
                "f [Hz],omega,E' [Pa],E'' [Pa]\n1,2,3,4".into(),
                "1: column 2 = \"omega\": expected one column of a kind: f [Hz] is there already; ignore one by \
                 --ignore NAME"
                    .into(),
            ),
            (
                "f [Hz],E' [Pa],E'' [Pa],temperature\n1,2,3,4".into(),
                "1: column 4 = \"temperature\": expected a unit, °C or K, as in temperature [°C]".into(),
            ),
            (
                "f [Hz],E' [Pa],E'' [Pa],T [°C]\n1,2,3,-300".into(),
                "2: column 4 (T [°C]) = \"-300\": expected a temperature above 0 K".into(),
            ),
            ("a\0".into(), "1: bytes that are zero: expected text in UTF-8, UTF-16 or Latin-1".into()),
        ];
        for (text, message) in cases {
            assert_eq!(refusal(&text), message, "{text}");
        }
        for (text, header) in [("1,2,3\n4,5,6", "1"), ("f [Hz],E' [psi],E'' [Pa]\n1,2,3", "E' [psi]")] {
            let wanted = format!("= \"{header}\": expected a quantity and its unit");
            assert!(refusal(text).contains(&wanted), "{}", refusal(text));
        }
    }

    const WLF: WlfConstants = WlfConstants { c1: 8.0, c2: 100.0, reference_temperature: 293.15 };

    fn at(temperature: f64) -> MeasuredModuli {
        let sample = Sample { omega: 3.0, storage: 2.0, loss: 1.0 };
        let points = vec![MeasuredPoint { line: 7, sample, temperature: Some(temperature) }];
        let temperature = Some(ColumnName { number: 4, header: "T [K]".to_owned() });
        MeasuredModuli { points, in_hertz: true, temperature, header_line: 1, notes: Vec::new() }
    }

    fn omega(temperature: f64) -> f64 {
        at(temperature).at_reference(Some(WLF)).unwrap()[0].omega
    }

    /// log10 a_T = -8·10/110 ten kelvin above, 8·10/90 ten below: heat acts as slower motion.
    #[test]
    fn points_are_shifted_by_wlf() {
        assert_eq!(omega(293.15), 3.0);
        assert!((omega(303.15) / 3.0 / 10.0_f64.powf(-80.0 / 110.0) - 1.0).abs() < 1e-12);
        assert!((omega(283.15) / 3.0 / 10.0_f64.powf(80.0 / 90.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn temperatures_at_and_near_the_pole_are_refused() {
        for temperature in [193.15, 150.0, 194.0] {
            let refusal = at(temperature).at_reference(Some(WLF)).unwrap_err().to_string();
            let wanted = format!("7: column 4 (T [K]) = \"{temperature} K\": expected more than TREF - C2 = 193.15");
            assert!(refusal.starts_with(&wanted), "{refusal}");
        }
    }

    #[test]
    fn temperatures_need_constants() {
        let refusal = at(293.15).at_reference(None).unwrap_err().to_string();
        assert!(
            refusal.starts_with("1: column 4 = \"T [K]\": expected the constants to shift by as well: --wlf"),
            "{refusal}"
        );
    }
}
