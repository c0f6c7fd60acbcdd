//! CSV files with a header, also with semicolons or tabs for commas; result files among them: columns `time` and the
//! inputs, then the output variables.

use std::fmt::{self, Display, Formatter};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use asperity::outputs::{OutputType, Variable};
use asperity::scene::{Input, Unit};
use asperity::tables::{self, ContentError, Csv, decode};

use super::draft::Draft;
use super::files::{FileError, read};
use super::runner::InputSample;
use asperity_study::decimals::file_decimal;

/// A result file cannot be read.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ResultFileError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}", .error.within(.path))]
    Content { path: PathBuf, error: ContentError },
    #[error("{}: expected a line with the columns' names and rows of numbers below it, found no rows", .path.display())]
    NoRows { path: PathBuf },
}

/// Writes a CSV file line by line.
#[derive(Debug)]
pub(crate) struct CsvWriter {
    path: PathBuf,
    file: Draft,
}

impl CsvWriter {
    /// Begins the file for `path` and writes its header.
    pub(crate) fn create<'a>(path: &Path, head: impl IntoIterator<Item = &'a str>) -> Result<Self, FileError> {
        let mut writer = Self { path: path.to_owned(), file: Draft::create(path)? };
        writer.write(head)?;
        Ok(writer)
    }

    pub(crate) fn write<T: AsRef<str>>(&mut self, fields: impl IntoIterator<Item = T>) -> Result<(), FileError> {
        let fields: Vec<String> = fields.into_iter().map(|field| tables::quoted(field.as_ref())).collect();
        writeln!(self.file, "{}", fields.join(",")).map_err(FileError::io("write", &self.path))
    }

    /// Writes a line of values, none of which needs quotation marks.
    pub(crate) fn write_values(&mut self, values: impl IntoIterator<Item = Field>) -> Result<(), FileError> {
        let write = || {
            for (i, value) in values.into_iter().enumerate() {
                self.file.write_all(if i > 0 { b"," } else { b"" })?;
                write!(self.file, "{value}")?;
            }
            writeln!(self.file)
        };
        write().map_err(FileError::io("write", &self.path))
    }

    /// Puts the file in its place.
    pub(crate) fn finish(self) -> Result<(), FileError> {
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
    pub(crate) fn create(path: &Path, inputs: &[Input], variables: &[Variable], head: Head) -> Result<Self, FileError> {
        let inputs_and_units = inputs.iter().map(|input| (input.name(), input.unit()));
        let variables_and_units = variables.iter().map(|variable| (variable.name.as_str(), variable.unit));
        let columns = std::iter::once(("time", Unit::Second)).chain(inputs_and_units).chain(variables_and_units);
        let names: Vec<String> = columns.map(|(name, unit)| head.of(name, unit)).collect();
        let kinds = variables.iter().map(|variable| variable.kind).collect();
        let file = CsvWriter::create(path, names.iter().map(String::as_str))?;
        Ok(Self { file, inputs: inputs.to_vec(), kinds })
    }

    pub(crate) fn write(&mut self, carrier: InputSample, values: &[f64]) -> Result<(), FileError> {
        let real = |value: f64| Field { kind: OutputType::Real, value };
        let variables = self.kinds.iter().zip(values).map(|(&kind, &value)| Field { kind, value });
        let inputs = self.inputs.iter().map(|&input| real(carrier.input(input)));
        self.file.write_values(std::iter::once(real(carrier.time)).chain(inputs).chain(variables))
    }

    /// Puts the file in its place.
    pub(crate) fn finish(self) -> Result<(), FileError> {
        self.file.finish()
    }
}

/// What is above a column of a result file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Head {
    /// Its name.
    Name,
    /// Its name and, in brackets, its unit: `F_x [N]`.
    NameAndUnit,
}

impl Head {
    pub(crate) fn of(self, name: &str, unit: Unit) -> String {
        match self {
            Self::NameAndUnit if unit != Unit::One => format!("{name} [{}]", unit.name()),
            _ => name.to_owned(),
        }
    }
}

/// A value as files have it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Field {
    pub(crate) kind: OutputType,
    pub(crate) value: f64,
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

impl ResultFileError {
    /// What is wrong in the content of the file at `path`.
    pub(crate) fn content(path: &Path, error: ContentError) -> Self {
        Self::Content { path: path.to_owned(), error }
    }
}

/// The file at `path`, which begins with the names of its columns.
pub(crate) fn read_csv(path: &Path) -> Result<Csv, ResultFileError> {
    let bytes = read(path)?;
    let parsed = decode(&bytes).map_err(ContentError::from).and_then(|text| Csv::parse(&text, None));
    parsed.map_err(|error| ResultFileError::content(path, error))
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
            let file = read_csv(&path).unwrap();
            assert_eq!((file.column("F_x").unwrap(), &file.rows[0].fields[1][..]), (1, "1"), "{text}");
        }
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn integers_have_no_exponent() {
        assert_eq!(Field { kind: OutputType::Integer, value: 1e7 }.to_string(), "10000000");
    }
}
