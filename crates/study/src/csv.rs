//! Tables of text with a header: read with commas, semicolons or tabs between the fields, written with commas.

use std::borrow::Cow;
use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};

use asperity::outputs::OutputType;
use asperity::scene::Unit;
use asperity::tables::{self, Row};

use crate::decimals::file_decimal;
use crate::files::{ReadError, bytes};

/// A table cannot be read.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum CsvError {
    #[error(transparent)]
    File(#[from] ReadError),
    #[error("{}: line {line}: {message}", .path.display())]
    Line { path: PathBuf, line: usize, message: String },
    #[error("{}: no column {name}; there are {}", .path.display(), .columns.join(", "))]
    NoColumn { path: PathBuf, name: String, columns: Vec<String> },
    #[error("{}: expected a line with the columns' names and rows of numbers below it, found no rows", .path.display())]
    NoRows { path: PathBuf },
}

/// The fields as a line without its end.
pub fn line<T: AsRef<str>>(fields: impl IntoIterator<Item = T>) -> String {
    let fields: Vec<String> = fields.into_iter().map(|field| tables::quoted(field.as_ref())).collect();
    fields.join(",")
}

/// A table with this header and these rows.
pub fn text<'a>(head: impl IntoIterator<Item = &'a str>, rows: impl IntoIterator<Item = Vec<String>>) -> String {
    std::iter::once(line(head)).chain(rows.into_iter().map(line)).map(|line| line + "\n").collect()
}

/// What is above a column of a result file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Head {
    /// Its name.
    Name,
    /// Its name and, in brackets, its unit: `F_x [N]`.
    NameAndUnit,
}

impl Head {
    /// The text above a column of this name and unit.
    pub fn of(self, name: &str, unit: Unit) -> String {
        match self {
            Self::NameAndUnit if unit != Unit::One => format!("{name} [{}]", unit.name()),
            _ => name.to_owned(),
        }
    }
}

/// A value as files have it.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// How it is written.
    pub kind: OutputType,
    /// In the unit of its column.
    pub value: f64,
}

impl Field {
    /// A number.
    pub fn real(value: f64) -> Self {
        Self { kind: OutputType::Real, value }
    }
}

impl Display for Field {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self.kind {
            OutputType::Real => file_decimal(self.value).fmt(f),
            // A whole number is written faster as one.
            OutputType::Integer if self.value == self.value as i64 as f64 => (self.value as i64).fmt(f),
            OutputType::Integer => write!(f, "{:.0}", self.value),
        }
    }
}

/// A CSV file with a header, its fields as text.
#[derive(Debug)]
pub struct CsvFile {
    path: PathBuf,
    names: Vec<String>,
    records: Vec<Record>,
}

/// The fields of a line, as many as there are columns.
#[derive(Debug)]
pub struct Record {
    line: usize,
    /// As many as there are columns.
    pub fields: Vec<String>,
}

impl CsvFile {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// Where it cannot be read, or a line has not as many fields as the first.
    pub fn read(path: &Path) -> Result<Self, CsvError> {
        let bytes = bytes(path)?;
        let error = |line: usize, message: String| CsvError::Line { path: path.to_owned(), line, message };
        let text = tables::decode(&bytes).map_err(|problem| error(1, problem.to_string()))?;
        let owned = |row: Row<'_>| -> Vec<String> { row.fields.into_iter().map(Cow::into_owned).collect() };
        let mut rows = tables::rows(&text, None);
        let names = rows.next().map(owned).unwrap_or_default();
        let record = |row: Row<'_>| {
            let (line, fields) = (row.line, owned(row));
            if fields.len() == names.len() {
                return Ok(Record { line, fields });
            }
            let (expected, found) = (names.len(), fields.len());
            Err(error(line, format!("expected as many fields as in the first line, {expected}, found {found}")))
        };
        let records = rows.map(record).collect::<Result<_, _>>()?;
        Ok(Self { path: path.to_owned(), names, records })
    }

    /// Index of the column `name`; the unit of a header such as `speed [m/s]` may be left out.
    ///
    /// # Errors
    /// Where there is none.
    pub fn column(&self, name: &str) -> Result<usize, CsvError> {
        let without_unit = |header: &str| header.split_once(" [").is_some_and(|(start, _)| start == name);
        let named = self.names.iter().position(|other| other == name);
        let named = named.or_else(|| self.names.iter().position(|other| without_unit(other)));
        named.ok_or_else(|| CsvError::NoColumn {
            path: self.path.clone(),
            name: name.to_owned(),
            columns: self.names.clone(),
        })
    }

    /// The names of the columns.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The error `message` about the names of the columns.
    pub fn header_error(&self, message: String) -> CsvError {
        CsvError::Line { path: self.path.clone(), line: 1, message }
    }

    /// The lines below the header.
    pub fn records(&self) -> &[Record] {
        &self.records
    }

    /// The error `message` about a record, with its line.
    pub fn error(&self, record: &Record, message: String) -> CsvError {
        CsvError::Line { path: self.path.clone(), line: record.line, message }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_separated_as_the_header_is() {
        let path = std::env::temp_dir().join(format!("asperity-separators-{}.csv", std::process::id()));
        let quoted = "\"time; from the start\",F_x [N]\n0,1\n";
        for text in ["time [s],F_x [N]\n0,1\n", "time [s];F_x [N]\n0;1\n", "time [s]\tF_x [N]\n0\t1\n", quoted] {
            std::fs::write(&path, text).unwrap();
            let file = CsvFile::read(&path).unwrap();
            assert_eq!((file.column("F_x").unwrap(), &file.records()[0].fields[1][..]), (1, "1"), "{text}");
        }
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn integers_have_no_exponent() {
        assert_eq!(Field { kind: OutputType::Integer, value: 1e7 }.to_string(), "10000000");
    }
}
