//! Tables of measured moduli: comma, semicolon or tab, UTF-8 with or without a mark or Latin-1, any line ends.

use std::fmt;
use std::path::Path;

use super::FitError;
use super::compound::Sample;
use super::quantity::{ALLOWED, Meaning, Quantity, Scale};
use crate::program::files::FileError;

/// Measured moduli in SI units.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Measured {
    pub(super) rows: Vec<Row>,
    /// Whether frequencies are written in Hz, not in rad/s.
    pub(super) in_hertz: bool,
    /// The column of the temperatures, if there is one: its number from 1 and its header.
    pub(super) temperature: Option<(usize, String)>,
    /// The line of the headers.
    pub(super) header_line: usize,
    /// What the reader had to assume.
    pub(super) notes: Vec<String>,
}

/// A row and its line in the file, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    pub(super) line: usize,
    pub(super) sample: Sample,
    /// K.
    pub(super) temperature: Option<f64>,
}

/// Why a table is refused: where, what was found, what is allowed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Refusal {
    pub(super) line: usize,
    /// Number of the column from 1, and its header.
    pub(super) column: Option<(usize, String)>,
    /// As it is written; nothing where something is missing.
    pub(super) given: String,
    pub(super) expected: String,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.line)?;
        match &self.column {
            Some((number, header)) if header.is_empty() || *header == self.given => write!(f, "column {number}")?,
            Some((number, header)) => write!(f, "column {number} ({header})")?,
            None => {}
        }
        match (&self.column, self.given.as_str()) {
            (Some(_), "") => write!(f, ": ")?,
            (Some(_), given) => write!(f, " = \"{given}\": ")?,
            (None, "") => {}
            (None, given) => write!(f, "{given}: ")?,
        }
        write!(f, "expected {}", self.expected)
    }
}

/// A column that is read.
#[derive(Clone, Debug)]
struct Column {
    /// Counted from 0.
    index: usize,
    header: String,
    quantity: Quantity,
    meaning: Meaning,
    scale: Scale,
}

impl Column {
    /// Its number from 1 and its header, for messages.
    fn place(&self) -> (usize, String) {
        (self.index + 1, self.header.clone())
    }

    fn refuse(&self, line: usize, given: &str, expected: impl Into<String>) -> Refusal {
        Refusal { line, column: Some(self.place()), given: shortened(given), expected: expected.into() }
    }
}

/// A line of the file with its number and its fields.
struct Line {
    number: usize,
    fields: Vec<String>,
}

impl Measured {
    /// Reads the table at `path` without the columns whose headers are `ignored`.
    pub(super) fn read(path: &Path, ignored: &[String]) -> Result<Self, FitError> {
        let bytes = std::fs::read(path).map_err(FileError::io("read", path))?;
        parse(&bytes, ignored).map_err(|refusal| FitError::Moduli { path: path.to_owned(), refusal })
    }
}

fn parse(bytes: &[u8], ignored: &[String]) -> Result<Measured, Refusal> {
    if bytes.contains(&0) {
        let expected = "text in UTF-8 or Latin-1, not UTF-16 or binary data".into();
        return Err(Refusal { line: 1, column: None, given: "bytes that are zero".into(), expected });
    }
    let text = decoded(bytes);
    let mut lines = lines(text.strip_prefix('\u{feff}').unwrap_or(&text)).into_iter().peekable();
    let missing =
        |line: usize, expected: &str| Refusal { line, column: None, given: String::new(), expected: expected.into() };
    let header = lines.next().ok_or_else(|| missing(1, "a line of headers, then rows"))?;
    let mut columns = columns(&header, ignored)?;
    if let Some(below) = lines.peek().and_then(|line| with_units(&columns, line)) {
        columns = below;
        lines.next();
    }
    let notes = complete(&mut columns, &header)?;
    let find = |quantity: Quantity| columns.iter().find(|column| column.quantity == quantity);
    let layout = Layout {
        fields: header.fields.len(),
        frequency: find(Quantity::Frequency)
            .ok_or_else(|| missing(header.number, "a frequency column: f [Hz] or omega [rad/s]"))?,
        storage: find(Quantity::Storage)
            .ok_or_else(|| missing(header.number, "a column of the storage modulus: E' [MPa]"))?,
        loss: find(Quantity::Loss),
        tangent: find(Quantity::LossTangent),
        temperature: find(Quantity::Temperature),
    };
    if layout.loss.or(layout.tangent).is_none() {
        return Err(missing(header.number, "a column of the loss: E'' [MPa] or tan delta"));
    }
    let rows: Vec<Row> = lines.map(|line| layout.row(&line)).collect::<Result<_, _>>()?;
    if rows.is_empty() {
        return Err(missing(header.number + 1, "a row of numbers"));
    }
    Ok(Measured {
        rows,
        in_hertz: layout.frequency.scale.factor != 1.0,
        temperature: layout.temperature.map(Column::place),
        header_line: header.number,
        notes,
    })
}

/// UTF-8; else Latin-1, of which every byte is a letter.
fn decoded(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    }
}

/// The lines that hold something, by the separator that the first of them has.
fn lines(text: &str) -> Vec<Line> {
    let numbered = (1..).zip(text.lines());
    let filled: Vec<(usize, &str)> =
        numbered.filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#')).collect();
    let separators = [';', '\t', ','];
    let separator = separators.into_iter().find(|&sign| filled.first().is_some_and(|(_, line)| line.contains(sign)));
    let fields = |line: &str| split(line.trim_end_matches('\r'), separator.unwrap_or(','));
    filled.into_iter().map(|(number, line)| Line { number, fields: fields(line) }).collect()
}

/// The fields of a line, without the quotes that hold one together.
fn split(line: &str, separator: char) -> Vec<String> {
    let mut fields = vec![String::new()];
    let (mut quoted, mut letters) = (false, line.chars().peekable());
    while let Some(letter) = letters.next() {
        let last = fields.len() - 1;
        let field = &mut fields[last];
        match letter {
            '"' if quoted && letters.peek() == Some(&'"') => field.extend(letters.next()),
            '"' if quoted => quoted = false,
            '"' if field.trim().is_empty() => quoted = true,
            letter if letter == separator && !quoted => fields.push(String::new()),
            letter => field.push(letter),
        }
    }
    fields.into_iter().map(|field| field.trim().to_owned()).collect()
}

/// Refuses a name to ignore that no column has.
fn check_ignored(header: &Line, ignored: &[String]) -> Result<(), Refusal> {
    match ignored.iter().find(|name| !header.fields.iter().any(|field| field == name.trim())) {
        Some(name) => Err(Refusal {
            line: header.number,
            column: None,
            given: format!("--ignore {name}"),
            expected: format!("one of the headers: {}", header.fields.join(", ")),
        }),
        None => Ok(()),
    }
}

/// What the columns hold, with the unit that their header names, if it does.
fn columns(header: &Line, ignored: &[String]) -> Result<Vec<Column>, Refusal> {
    check_ignored(header, ignored)?;
    let mut columns: Vec<Column> = Vec::new();
    for (index, field) in header.fields.iter().enumerate() {
        let last = header.fields[index..].iter().all(String::is_empty);
        if last || ignored.iter().any(|name| name.trim() == field) {
            continue;
        }
        let refuse = |expected: String| {
            let column = Some((index + 1, field.clone()));
            Refusal { line: header.number, column, given: shortened(field), expected }
        };
        let meaning = Meaning::of(field).ok_or_else(|| refuse(ALLOWED.into()))?;
        if let Some(twin) = columns.iter().find(|column| column.quantity == meaning.quantity) {
            let twin = &twin.header;
            return Err(refuse(format!(
                "one column of a kind: {twin} is there already; leave one out by --ignore NAME"
            )));
        }
        let scale = meaning.scale.unwrap_or(Scale::ONE);
        columns.push(Column { index, header: field.clone(), quantity: meaning.quantity, meaning, scale });
    }
    Ok(columns)
}

/// The columns with the units of the line below the headers; `None` if that is no line of units.
fn with_units(columns: &[Column], line: &Line) -> Option<Vec<Column>> {
    if columns.iter().all(|column| line.fields.get(column.index).is_none_or(String::is_empty)) {
        return None;
    }
    let with_unit = |column: &Column| {
        let meaning = column.meaning.with_unit(line.fields.get(column.index)?)?;
        Some(Column { meaning, scale: meaning.scale?, ..column.clone() })
    };
    columns.iter().map(with_unit).collect()
}

/// Gives units to the columns that name none: a modulus has that of the other one. What was assumed.
fn complete(columns: &mut [Column], header: &Line) -> Result<Vec<String>, Refusal> {
    let modulus = |column: &&Column| matches!(column.quantity, Quantity::Storage | Quantity::Loss);
    let other = columns.iter().filter(modulus).find_map(|column| column.meaning.scale);
    let mut notes = Vec::new();
    for column in columns.iter_mut().filter(|column| column.meaning.scale.is_none()) {
        if column.quantity == Quantity::Temperature {
            return Err(column.refuse(header.number, &column.header, "a unit, °C or K, as in temperature [°C]"));
        }
        column.scale = column.meaning.default_scale().or(other).unwrap_or(Scale::ONE);
        let assumed = match (column.quantity, other) {
            (Quantity::LossTangent, _) => continue,
            (Quantity::Frequency, _) if column.scale == Scale::ONE => "rad/s",
            (Quantity::Frequency, _) => "Hz",
            (_, Some(_)) => "that of the other modulus",
            (_, None) => "Pa",
        };
        notes.push(format!("column {} ({}) names no unit: taken as {assumed}", column.index + 1, column.header));
    }
    let has = |quantity: Quantity| columns.iter().any(|column| column.quantity == quantity);
    if has(Quantity::Loss) && has(Quantity::LossTangent) {
        notes.push("E'' is there as well as tan delta: E'' counts".into());
    }
    Ok(notes)
}

/// Where the quantities stand in a row.
struct Layout<'a> {
    fields: usize,
    frequency: &'a Column,
    storage: &'a Column,
    loss: Option<&'a Column>,
    tangent: Option<&'a Column>,
    temperature: Option<&'a Column>,
}

impl Layout<'_> {
    fn row(&self, line: &Line) -> Result<Row, Refusal> {
        if line.fields.len() != self.fields {
            let given = format!("{} columns", line.fields.len());
            let expected = format!("{}, as many as headers", self.fields);
            return Err(Refusal { line: line.number, column: None, given, expected });
        }
        let omega = positive(self.frequency, line)?;
        let storage = positive(self.storage, line)?;
        let tangent = self.tangent.map(|column| positive(column, line)).transpose()?;
        let loss = self.loss.map(|column| positive(column, line)).transpose()?;
        let loss = loss.or(tangent.map(|tangent| storage * tangent)).unwrap_or_default();
        let temperature = self.temperature.map(|column| temperature(column, line)).transpose()?;
        Ok(Row { line: line.number, sample: Sample { omega, storage, loss }, temperature })
    }
}

/// The sizes that a quantity may have in SI units, as in a scene.
const SIZES: std::ops::RangeInclusive<f64> = 1e-30..=1e30;

fn positive(column: &Column, line: &Line) -> Result<f64, Refusal> {
    let value = number(column, line).filter(|value| SIZES.contains(value));
    value.ok_or_else(|| {
        column.refuse(line.number, &line.fields[column.index], "a number above 0 (from 1e-30 to 1e30 in SI units)")
    })
}

fn temperature(column: &Column, line: &Line) -> Result<f64, Refusal> {
    let value = number(column, line).filter(|value| *value > 0.0 && SIZES.contains(value));
    value.ok_or_else(|| column.refuse(line.number, &line.fields[column.index], "a temperature above 0 K"))
}

/// In SI units; a comma is a decimal one, since fields parted by it hold none.
fn number(column: &Column, line: &Line) -> Option<f64> {
    let written: f64 = line.fields[column.index].replace(',', ".").parse().ok()?;
    Some(column.scale.apply(written)).filter(|value| value.is_finite())
}

fn shortened(text: &str) -> String {
    text.chars().take(60).collect()
}

#[cfg(test)]
#[path = "measured_tests.rs"]
mod tests;
