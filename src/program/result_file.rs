//! Result files: `time`, `u`, `w`, then the output variables, one row each time.

use std::fs::File;
use std::path::{Path, PathBuf};

use asperity::outputs::{Kind, Variable};

use super::error::ProgramError;
use super::excitation::Carrier;

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
    if value == 0.0 || (1e-4..1e16).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
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
        let names = reader.headers().map_err(|error| wrong(error.to_string()))?.iter().map(str::to_owned).collect();
        let rows = reader.records().map(|record| numbers(&record.map_err(|error| error.to_string())?));
        let rows: Vec<_> = rows.collect::<Result<_, String>>().map_err(wrong)?;
        if rows.is_empty() {
            return Err(wrong("no rows".into()));
        }
        Ok(Self { path: path.to_owned(), names, rows })
    }

    /// The values of the column `name`, row by row.
    pub(crate) fn column(&self, name: &str) -> Result<Vec<f64>, ProgramError> {
        let index = self.names.iter().position(|other| other == name).ok_or_else(|| self.no_column(name))?;
        Ok(self.rows.iter().map(|row| row[index]).collect())
    }

    fn no_column(&self, name: &str) -> ProgramError {
        let message = format!("no column {name}; there are {}", self.names.join(", "));
        ProgramError::ResultFile { path: self.path.clone(), message }
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
