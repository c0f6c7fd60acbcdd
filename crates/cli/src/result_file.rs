//! CSV files written line by line; result files among them: columns `time` and the inputs, then the output variables.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use asperity::outputs::{OutputType, Variable};
use asperity::scene::{Input, Unit};
use asperity_study::csv::{Field, Head, line};

use super::draft::Draft;
use asperity_study::Error;
use asperity_study::runner::InputSample;

/// Writes a CSV file line by line.
#[derive(Debug)]
pub(crate) struct CsvWriter {
    path: PathBuf,
    file: Draft,
}

impl CsvWriter {
    /// Begins the file for `path` and writes its header.
    pub(crate) fn create<'a>(path: &Path, head: impl IntoIterator<Item = &'a str>) -> Result<Self, Error> {
        let mut writer = Self { path: path.to_owned(), file: Draft::create(path)? };
        writer.write(head)?;
        Ok(writer)
    }

    pub(crate) fn write<T: AsRef<str>>(&mut self, fields: impl IntoIterator<Item = T>) -> Result<(), Error> {
        writeln!(self.file, "{}", line(fields)).map_err(Error::io("write", &self.path))
    }

    /// Writes a line of values, none of which needs quotation marks.
    pub(crate) fn write_values(&mut self, values: impl IntoIterator<Item = Field>) -> Result<(), Error> {
        let write = || {
            for (i, value) in values.into_iter().enumerate() {
                self.file.write_all(if i > 0 { b"," } else { b"" })?;
                write!(self.file, "{value}")?;
            }
            writeln!(self.file)
        };
        write().map_err(Error::io("write", &self.path))
    }

    /// Puts the file in its place.
    pub(crate) fn finish(self) -> Result<(), Error> {
        self.file.finish()
    }
}

/// Writes a result file row by row.
#[derive(Debug)]
pub(crate) struct ResultWriter {
    file: CsvWriter,
    inputs: Vec<Input>,
    kinds: Vec<OutputType>,
}

impl ResultWriter {
    /// Begins the file for `path` and writes its header.
    pub(crate) fn create(path: &Path, inputs: &[Input], variables: &[Variable], head: Head) -> Result<Self, Error> {
        let inputs_and_units = inputs.iter().map(|input| (input.name(), input.unit()));
        let variables_and_units = variables.iter().map(|variable| (variable.name.as_str(), variable.unit));
        let columns = std::iter::once(("time", Unit::Second)).chain(inputs_and_units).chain(variables_and_units);
        let names: Vec<String> = columns.map(|(name, unit)| head.of(name, unit)).collect();
        let kinds = variables.iter().map(|variable| variable.kind).collect();
        let file = CsvWriter::create(path, names.iter().map(String::as_str))?;
        Ok(Self { file, inputs: inputs.to_vec(), kinds })
    }

    pub(crate) fn write(&mut self, carrier: InputSample, values: &[f64]) -> Result<(), Error> {
        let real = |value: f64| Field { kind: OutputType::Real, value };
        let variables = self.kinds.iter().zip(values).map(|(&kind, &value)| Field { kind, value });
        let inputs = self.inputs.iter().map(|&input| real(carrier.input(input)));
        self.file.write_values(std::iter::once(real(carrier.time)).chain(inputs).chain(variables))
    }

    /// Puts the file in its place.
    pub(crate) fn finish(self) -> Result<(), Error> {
        self.file.finish()
    }
}
