//! What stands before the rows of a table: values by their keys.

use std::path::{Path, PathBuf};

use super::numbers::{number, parsed};

/// Why a table is refused: where, what was expected and what was found.
///
/// It reads like `table.csv:12: speed [m/s] = "fast": expected a number above 0`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}{}: {problem}", file.display(), line.map_or_else(String::new, |line| format!(":{line}")))]
pub struct TableError {
    /// The file.
    pub file: PathBuf,
    /// The line, from 1, where it is one.
    pub line: Option<usize>,
    /// What was expected and what was found.
    pub problem: String,
}

/// The values by their keys, in order, each as text, a number or numbers with their unit, or a whole number. They are
/// kept as files have them, and checked by who asks for them.
#[derive(Clone, Debug, Default)]
pub struct Header {
    /// Where it was read from.
    file: PathBuf,
    values: Vec<(String, String)>,
}

impl PartialEq for Header {
    /// The same values, wherever they were read from.
    fn eq(&self, other: &Self) -> bool {
        self.values == other.values
    }
}

impl Header {
    /// One that begins with the kind of the table and the version of that.
    pub fn new((kind, version): (&str, u64)) -> Self {
        Self::default().with_whole(kind, version)
    }

    /// That of a table in the file at `path`.
    #[must_use]
    pub fn of_file(self, path: &Path) -> Self {
        Self { file: path.to_owned(), ..self }
    }

    /// Refuses a table of another kind or version.
    ///
    /// # Errors
    /// [`TableError`] where it is one.
    pub fn check_kind(&self, (kind, version): (&str, u64)) -> Result<(), TableError> {
        self.check_line(kind, &version.to_string())
    }

    /// Refuses the header of another table: of another kind or version, which stand in the first line, or with another
    /// value of the key `fingerprint`, which tells tables of a kind from one another.
    pub(super) fn check_same(&self, other: &Self) -> Result<(), TableError> {
        let Some((kind, version)) = self.values.first() else { return Ok(()) };
        other.check_line(kind, version)?;
        let [found, ours] = [other, self].map(|header| header.find("fingerprint").unwrap_or("none"));
        if found == ours {
            return Ok(());
        }
        let kind = kind.trim_start_matches("asperity ");
        Err(other.error(format!("is the table of another {kind}: its fingerprint is {found}, expected {ours}")))
    }

    fn check_line(&self, kind: &str, version: &str) -> Result<(), TableError> {
        match self.find(kind) {
            Some(found) if found == version => Ok(()),
            found => {
                let found = found.unwrap_or("none");
                Err(self.error(format!("expected the line `# {kind} = {version}`, found {found}")))
            }
        }
    }

    /// That of a text.
    pub(super) fn parse(text: &str, file: &Path) -> Self {
        let value = |line: &str| {
            let (key, value) = line.strip_prefix('#')?.split_once('=')?;
            Some((key.trim().to_owned(), value.trim().to_owned()))
        };
        Self { file: file.to_owned(), values: text.lines().filter_map(value).collect() }
    }

    /// The lines of it.
    pub fn text(&self) -> String {
        self.values.iter().map(|(key, value)| format!("# {key} = {value}\n")).collect()
    }

    /// Sets the value of a key, behind all others where it is new, to a text, which becomes a line.
    pub fn set(&mut self, key: &str, text: &str) {
        let value = text.replace(['\n', '\r'], " ").trim().to_owned();
        match self.values.iter_mut().find(|(other, _)| other == key) {
            Some((_, other)) => *other = value,
            None => self.values.push((key.to_owned(), value)),
        }
    }

    /// Without the value of a key.
    pub fn remove(&mut self, key: &str) {
        self.values.retain(|(other, _)| other != key);
    }

    /// With a text.
    #[must_use]
    pub fn with(mut self, key: &str, text: &str) -> Self {
        self.set(key, text);
        self
    }

    /// With a text, where there is one.
    #[must_use]
    pub fn with_some(self, key: &str, text: Option<impl AsRef<str>>) -> Self {
        match text {
            Some(text) => self.with(key, text.as_ref()),
            None => self,
        }
    }

    /// With a whole number.
    #[must_use]
    pub fn with_whole(self, key: &str, whole: u64) -> Self {
        self.with(key, &whole.to_string())
    }

    /// With a number in a unit, which may be empty.
    #[must_use]
    pub fn with_number(self, key: &str, value: f64, unit: &str) -> Self {
        self.with_numbers(key, &[value], unit)
    }

    /// With numbers in a unit, which may be empty.
    #[must_use]
    pub fn with_numbers(self, key: &str, values: &[f64], unit: &str) -> Self {
        let numbers: Vec<String> = values.iter().map(|&value| number(value)).collect();
        self.with(key, &format!("{} {unit}", numbers.join(",")))
    }

    /// Whether a key has a value.
    pub fn has(&self, key: &str) -> bool {
        self.find(key).is_some()
    }

    fn find(&self, key: &str) -> Option<&str> {
        self.values.iter().find(|(other, _)| other == key).map(|(_, value)| value.as_str())
    }

    /// The text of a key, if it has one.
    pub fn text_of(&self, key: &str) -> Option<&str> {
        self.find(key)
    }

    /// The text of a key.
    ///
    /// # Errors
    /// [`TableError`] where it has none.
    pub fn needed(&self, key: &str) -> Result<&str, TableError> {
        self.value(key, "such a line", Some)
    }

    /// The whole number of a key.
    ///
    /// # Errors
    /// [`TableError`] where it has none.
    pub fn whole(&self, key: &str) -> Result<u64, TableError> {
        self.value(key, "a whole number", |text| text.parse().ok())
    }

    /// The number of a key in this unit.
    ///
    /// # Errors
    /// [`TableError`] where it has none.
    pub fn number(&self, key: &str, unit: &str) -> Result<f64, TableError> {
        let expected = if unit.is_empty() { "a number".to_owned() } else { format!("a number in {unit}") };
        self.value(key, &expected, |text| one(text.strip_suffix(unit)?))
    }

    /// The numbers of a key in this unit.
    ///
    /// # Errors
    /// [`TableError`] where it has none.
    pub fn numbers(&self, key: &str, unit: &str) -> Result<Vec<f64>, TableError> {
        self.value(key, &format!("numbers in {unit}"), |text| text.strip_suffix(unit)?.split(',').map(one).collect())
    }

    /// What `read` gets of a key that need not be there.
    ///
    /// # Errors
    /// Those of `read`.
    pub fn optional<T>(
        &self,
        key: &str,
        read: impl FnOnce(&Self, &str) -> Result<T, TableError>,
    ) -> Result<Option<T>, TableError> {
        self.has(key).then(|| read(self, key)).transpose()
    }

    fn value<'a, T>(
        &'a self,
        key: &str,
        expected: &str,
        read: impl FnOnce(&'a str) -> Option<T>,
    ) -> Result<T, TableError> {
        let found = self.find(key);
        let read = found.and_then(read);
        read.ok_or_else(|| self.error(format!("`# {key} = {}`: expected {expected}", found.unwrap_or_default())))
    }

    /// What is wrong with the table.
    pub fn error(&self, problem: impl Into<String>) -> TableError {
        TableError { file: self.file.clone(), line: None, problem: problem.into() }
    }
}

/// A number, which is not missing.
fn one(text: &str) -> Option<f64> {
    parsed(text.trim()).filter(|number| !number.is_nan())
}
