//! Result files: `time`, `u`, `w`, then the output variables, one row each time.

use std::fs::File;
use std::path::{Path, PathBuf};

use asperity::outputs::{Kind, Variable};

use super::error::ProgramError;
use super::excitation::Carrier;
use super::text::decimal;

/// Writes a result file row by row.
#[derive(Debug)]
pub(crate) struct ResultWriter {
    path: PathBuf,
    writer: csv::Writer<File>,
    kinds: Vec<Kind>,
    fields: Vec<String>,
}

impl ResultWriter {
    /// Creates the file at `path` with the names of its columns.
    pub(crate) fn create(path: &Path, variables: &[Variable]) -> Result<Self, ProgramError> {
        let file = File::create(path).map_err(ProgramError::file("write", path))?;
        let mut writer = csv::Writer::from_writer(file);
        let names = ["time", "u", "w"].into_iter().chain(variables.iter().map(|variable| variable.name.as_str()));
        writer.write_record(names).map_err(|error| write_error(path, error))?;
        let kinds = variables.iter().map(|variable| variable.kind).collect();
        Ok(Self { path: path.to_owned(), writer, kinds, fields: Vec::new() })
    }

    /// Adds a row.
    pub(crate) fn write(&mut self, carrier: Carrier, values: &[f64]) -> Result<(), ProgramError> {
        self.fields.clear();
        self.fields.extend([carrier.time, carrier.u, carrier.w].map(real));
        self.fields.extend(self.kinds.iter().zip(values).map(|(&kind, &value)| field(kind, value)));
        self.writer.write_record(&self.fields).map_err(|error| write_error(&self.path, error))
    }

    /// Writes what is still held back.
    pub(crate) fn finish(mut self) -> Result<(), ProgramError> {
        self.writer.flush().map_err(ProgramError::file("write", &self.path))
    }
}

fn field(kind: Kind, value: f64) -> String {
    match kind {
        Kind::Real => real(value),
        Kind::Integer => format!("{value:.0}"),
    }
}

/// The shortest decimal that reads back as the same number; far from 1 with an exponent.
pub(crate) fn real(value: f64) -> String {
    decimal(value, 1e-4..1e16)
}

fn write_error(path: &Path, error: csv::Error) -> ProgramError {
    ProgramError::file("write", path)(error.into())
}

/// The columns of a result file.
#[derive(Debug)]
pub(crate) struct ResultFile {
    path: PathBuf,
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl ResultFile {
    /// Reads a whole file.
    pub(crate) fn read(path: &Path) -> Result<Self, ProgramError> {
        let file = File::open(path).map_err(ProgramError::file("read", path))?;
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(file);
        let wrong = |message: String| ProgramError::ResultFile { path: path.to_owned(), message };
        let names = reader.headers().map_err(|error| wrong(refusal(&error)))?.iter().map(str::to_owned).collect();
        let rows = reader.records().map(|record| numbers(&record.map_err(|error| refusal(&error))?));
        let rows: Vec<_> = rows.collect::<Result<_, String>>().map_err(wrong)?;
        if rows.is_empty() {
            return Err(wrong(
                "expected a line with the columns' names and rows of numbers below it, found no rows".into(),
            ));
        }
        Ok(Self { path: path.to_owned(), names, rows })
    }

    /// The values of the column `name`, row by row.
    pub(crate) fn column(&self, name: &str) -> Result<Vec<f64>, ProgramError> {
        let index = self.names.iter().position(|other| other == name).ok_or_else(|| {
            let message = no_column(name, self.names.iter().map(String::as_str));
            ProgramError::ResultFile { path: self.path.clone(), message }
        })?;
        Ok(self.rows.iter().map(|row| row[index]).collect())
    }
}

/// That a table has no column of this name, and which it has.
pub(crate) fn no_column<'a>(name: &str, there: impl Iterator<Item = &'a str>) -> String {
    format!("no column {name}; there are {}", there.collect::<Vec<_>>().join(", "))
}

/// What is wrong with the text of a table.
pub(crate) fn refusal(error: &csv::Error) -> String {
    let line = error.position().map_or(1, csv::Position::line);
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("line {line}: expected as many fields as in the first line, {expected_len}, found {len}")
        }
        csv::ErrorKind::Utf8 { .. } => format!("line {line}: expected text in UTF-8"),
        _ => error.to_string(),
    }
}

fn numbers(record: &csv::StringRecord) -> Result<Vec<f64>, String> {
    let line = record.position().map_or(0, csv::Position::line);
    let number = |text: &str| text.parse().map_err(|_| format!("line {line}: expected a number, found {text:?}"));
    record.iter().map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_read_back_as_the_same() {
        for (value, text) in [(0.0, "0"), (1e-5, "1e-5"), (0.1 + 0.2, "0.30000000000000004"), (-2.5, "-2.5")] {
            assert_eq!(real(value), text);
            assert_eq!(real(value).parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
        assert_eq!(field(Kind::Integer, 1e7), "10000000");
    }
}
