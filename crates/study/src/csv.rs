//! Tables of text with a header: read with commas, semicolons or tabs between the fields, written with commas.

use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};

use asperity::outputs::OutputType;
use asperity::scene::Unit;
use asperity::tables::{self, ContentError, Csv, decode};

use crate::decimals::file_decimal;
use crate::error::Error;
use crate::files::bytes;

/// A table cannot be read.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum CsvError {
    #[error(transparent)]
    File(#[from] Error),
    #[error("{}", .error.within(.path))]
    Content { path: PathBuf, error: ContentError },
}

impl From<CsvError> for Error {
    fn from(error: CsvError) -> Self {
        match error {
            CsvError::File(error) => error,
            CsvError::Content { path, error } => Self::content(&path)(error),
        }
    }
}

impl CsvError {
    /// What is wrong in the content of the file at `path`.
    pub fn content(path: &Path, error: impl Into<ContentError>) -> Self {
        Self::Content { path: path.to_owned(), error: error.into() }
    }
}

/// Reads the file at `path`, which begins with the names of its columns.
///
/// # Errors
/// Where it cannot be read, or a line has not as many fields as the first.
pub fn read(path: &Path) -> Result<Csv, CsvError> {
    let bytes = bytes(path)?;
    let parsed = decode(&bytes).map_err(ContentError::from).and_then(|text| Csv::parse(&text, None));
    parsed.map_err(|error| CsvError::content(path, error))
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
            let file = read(&path).unwrap();
            assert_eq!((file.column("F_x").unwrap(), &file.rows[0].fields[1][..]), (1, "1"), "{text}");
        }
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn integers_have_no_exponent() {
        assert_eq!(Field { kind: OutputType::Integer, value: 1e7 }.to_string(), "10000000");
    }
}
