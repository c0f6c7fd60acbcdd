//! Kinds of files with columns: what each of their columns holds and is called, and the canonical form of such a file.
//!
//! A [`FileKind`] is all that there is to know of a kind. What people and instruments write is read by the reader of
//! `asperity-formats`; the canonical form, that of the files in an FMU, by [`FileKind::read_canonical`]: text in UTF-8,
//! comments behind `#`, a line of names in SI units, `speed [m/s],pressure [Pa]`, rows with commas.

use std::fmt::Write as _;
use std::path::Path;

use super::error::ContentError;
use super::range::{ANY, NumberRange};
use super::units::{Dimension, Unit};

/// What a file of some kind must hold.
#[derive(Clone, Copy, Debug)]
pub struct FileKind {
    /// What it is, for messages: "a motion".
    pub name: &'static str,
    /// What its columns may hold.
    pub roles: &'static [Role],
    /// Keys of roles of which a file has one; where it has several, those behind the first are left out.
    pub one_of: &'static [&'static [&'static str]],
    /// What is expected, in words.
    pub expected: &'static str,
    /// Whether columns without names may be taken by their positions.
    pub by_position: bool,
    /// The least number of rows.
    pub least: usize,
    /// Whether the numbers of the first role must rise.
    pub rises: bool,
    /// What else the file may hold.
    pub others: Others,
}

/// What is done about all that is not one of the roles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Others {
    /// There must be no other columns and no other lines but comments.
    Refused,
    /// Columns, and lines behind the table, are left out, which is said; a second table is refused.
    LeftOut,
    /// So are other tables than the longest.
    Tables,
}

/// The columns that are said to be those of roles: keys of roles, and names or numbers from 1.
pub type GivenColumns = [(String, String)];

/// What a column may hold.
#[derive(Clone, Copy, Debug)]
pub struct Role {
    /// Its name in canonical files, and in `columns = { key = "…" }`.
    pub key: &'static str,
    /// Its other names and symbols, separated by commas; case, blanks and `_` do not count.
    pub names: &'static str,
    /// What its unit measures.
    pub dimension: Dimension,
    /// The numbers that it may hold, in SI units.
    pub range: NumberRange,
    /// Whether a file must have it.
    pub presence: Presence,
    /// What is done where no unit is named.
    pub unit: UnitRule,
}

/// Whether a file has a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Presence {
    /// It must.
    Required,
    /// One without names must.
    Unnamed,
    /// It need not.
    Optional,
    /// It must not.
    Absent,
}

/// What is done about a unit that is not named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnitRule {
    /// The SI unit is assumed, which is said.
    Assumed,
    /// The column is refused.
    Named,
    /// Numbers are taken as they stand, whatever unit is named.
    Ignored,
}

impl Role {
    /// A column that must be there, with any number.
    pub const fn new(key: &'static str, names: &'static str, dimension: Dimension) -> Self {
        Self { key, names, dimension, range: ANY, presence: Presence::Required, unit: UnitRule::Assumed }
    }

    /// The same, which need not be there.
    pub const fn optional(self) -> Self {
        Self { presence: Presence::Optional, ..self }
    }

    /// The same with numbers of a range.
    pub const fn within(self, range: NumberRange) -> Self {
        Self { range, ..self }
    }

    /// The same whose unit must be named.
    pub const fn with_unit(self) -> Self {
        Self { unit: UnitRule::Named, ..self }
    }
}

impl FileKind {
    /// A kind with these columns, by their names or their order, and nothing else of importance.
    pub const fn new(name: &'static str, roles: &'static [Role], expected: &'static str) -> Self {
        let (by_position, least, rises, others) = (true, 1, false, Others::LeftOut);
        Self { name, roles, one_of: &[], expected, by_position, least, rises, others }
    }

    /// The role with this key.
    pub fn role(&self, key: &str) -> Option<&'static Role> {
        self.roles.iter().find(|role| role.key == key)
    }

    /// Reads a file in its canonical form.
    ///
    /// # Errors
    /// [`ContentError`] with the line, the column, what was found and what was expected.
    pub fn read_canonical(&self, bytes: &[u8]) -> Result<ReadTable, ContentError> {
        let text = std::str::from_utf8(bytes).map_err(|_| ContentError::value(None, "", "bytes", "text in UTF-8"))?;
        let is_data = |(_, line): &(usize, &str)| !line.trim().is_empty() && !line.starts_with('#');
        let mut lines = (1..).zip(text.lines()).filter(is_data);
        let (first, names) = lines.next().unwrap_or((1, ""));
        let column = |(index, name): (usize, &str)| {
            let role = self.roles.iter().find(|role| is_canonical(role, name.trim()));
            let role = role.ok_or_else(|| {
                let known: Vec<String> =
                    self.roles.iter().map(|role| canonical_name(role.key, role.dimension)).collect();
                ContentError::value(
                    Some(first),
                    "columns",
                    &format!("\"{name}\""),
                    &format!("one of {}", known.join(", ")),
                )
            })?;
            Ok(ReadColumn::new(role, index, Unit::si(role.dimension)))
        };
        let columns = names.split(',').enumerate().map(column).collect::<Result<Vec<_>, ContentError>>()?;
        let mut table = ReadTable { columns, line: Some(first), ..ReadTable::default() };
        for (line, row) in lines {
            let fields: Vec<&str> = row.split(',').collect();
            if fields.len() != table.columns.len() {
                let expected = table.columns.len().to_string();
                return Err(ContentError::value(Some(line), "columns", &fields.len().to_string(), &expected));
            }
            for (column, field) in table.columns.iter_mut().zip(fields) {
                let range = self.role(column.key).map_or(ANY, |role| role.range);
                let number = field.trim().parse().ok().filter(|number| range.holds(*number));
                let refuse =
                    || ContentError::value(Some(line), column.key, &format!("\"{field}\""), &range.to_string());
                column.values.push(number.ok_or_else(refuse)?);
            }
            table.lines.push(line);
        }
        self.check(&table)?;
        Ok(table)
    }

    /// Refuses a table that lacks columns or rows, or whose first numbers do not rise.
    ///
    /// # Errors
    /// [`ContentError`] with what is missing.
    pub fn check(&self, table: &ReadTable) -> Result<(), ContentError> {
        let has = |key: &str| table.column(key).is_some();
        let lacks = |role: &Role| role.presence == Presence::Required && !has(role.key);
        let lacks_all = |keys: &&[&str]| !keys.iter().any(|key| has(key));
        if self.roles.iter().any(lacks) || self.one_of.iter().any(lacks_all) {
            let found: Vec<&str> = table.columns.iter().map(|column| column.key).collect();
            return Err(ContentError::value(table.line, "columns", &found.join(", "), self.expected));
        }
        if table.lines.len() < self.least {
            let least = if self.least == 1 { "at least one row" } else { "at least two rows" };
            let expected = format!("{least} of numbers: {}", self.expected);
            return Err(ContentError::value(table.line, "rows", &table.lines.len().to_string(), &expected));
        }
        let first = self.roles.first().and_then(|role| table.column(role.key)).filter(|_| self.rises);
        let Some(column) = first else { return Ok(()) };
        let falls = column.values.windows(2).position(|pair| pair[1] <= pair[0]);
        falls.map_or(Ok(()), |row| {
            let [before, found] = [row, row + 1].map(|row| column.in_si_units(column.values[row]));
            let is_jump = column.values[row] == column.values[row + 1];
            let jump = if is_jump { ", and what jumps between two rows has no rate" } else { "" };
            let expected = format!("more than {before}, that of the row before: they must rise{jump}");
            Err(ContentError::value(table.lines.get(row + 1).copied(), &column.label(), &found, &expected))
        })
    }
}

/// Whether a name is that of a role, with its SI unit or without one.
fn is_canonical(role: &Role, name: &str) -> bool {
    let name = name.replace('(', "[").replace(')', "]");
    name == role.key || name == canonical_name(role.key, role.dimension)
}

/// The name of a column in canonical files.
pub fn canonical_name(key: &str, dimension: Dimension) -> String {
    format!("{key} [{}]", Unit::si(dimension))
}

/// How a table was read, for those who use what it holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadingNote {
    /// What was found or assumed: columns, units.
    pub text: String,
    /// Whether something was assumed that the file does not say.
    pub assumed: bool,
}

impl ReadingNote {
    /// The note with the name of the file.
    #[must_use]
    pub fn of(self, file: &Path) -> Self {
        Self { text: format!("{}: {}", file.display(), self.text), ..self }
    }
}

/// The numbers of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadTable {
    /// The columns that the file has.
    pub columns: Vec<ReadColumn>,
    /// The lines of the rows.
    pub lines: Vec<usize>,
    /// How they were read.
    pub notes: Vec<ReadingNote>,
    /// The line of the names.
    pub line: Option<usize>,
}

/// A column that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadColumn {
    /// The key of its role.
    pub key: &'static str,
    /// What its role measures.
    pub dimension: Dimension,
    /// Its place, counted from 0.
    pub index: usize,
    /// Its heading as written; empty without one.
    pub text: String,
    /// The unit of its numbers in the file.
    pub unit: Unit,
    /// Whether that was named, not assumed.
    pub names_unit: bool,
    /// Its numbers, in SI units.
    pub values: Vec<f64>,
}

impl ReadColumn {
    /// One of a role, called by its key, without numbers so far.
    pub fn new(role: &Role, index: usize, unit: Unit) -> Self {
        let (key, text, dimension) = (role.key, role.key.to_owned(), role.dimension);
        Self { key, dimension, index, text, unit, names_unit: true, values: Vec::new() }
    }

    /// The column in messages: its number from 1, and its heading.
    pub fn label(&self) -> String {
        match self.text.trim() {
            "" => format!("column {}", self.index + 1),
            heading => format!("column {} \"{}\"", self.index + 1, super::error::shortened(heading)),
        }
    }

    /// A number in SI units, with its unit, for messages.
    pub fn in_si_units(&self, number: f64) -> String {
        match self.dimension {
            Dimension::Number => format!("{number:?}"),
            dimension => format!("{number:?} {}", Unit::si(dimension)),
        }
    }
}

impl ReadTable {
    /// The column of a role.
    pub fn column(&self, key: &str) -> Option<&ReadColumn> {
        self.columns.iter().find(|column| column.key == key)
    }

    /// The numbers of a role; none of one that the file does not have.
    pub fn values(&self, key: &str) -> &[f64] {
        self.column(key).map_or(&[], |column| &column.values)
    }

    /// The file in its canonical form.
    pub fn canonical(&self) -> String {
        let columns = self.columns.iter().map(|column| (column.key, column.dimension, &column.values[..]));
        canonical(&columns.collect::<Vec<_>>())
    }
}

/// Columns by their keys, dimensions and numbers in SI units as a canonical file.
pub fn canonical(columns: &[(&str, Dimension, &[f64])]) -> String {
    let names: Vec<String> = columns.iter().map(|(key, dimension, _)| canonical_name(key, *dimension)).collect();
    let mut text = names.join(",") + "\n";
    for row in 0..columns.first().map_or(0, |(_, _, values)| values.len()) {
        for (i, (_, _, values)) in columns.iter().enumerate() {
            // Writing to a string does not fail.
            let _ = write!(text, "{}{:?}", if i > 0 { "," } else { "" }, values[row]);
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::range::POSITIVE;
    use super::*;

    const ROLES: [Role; 2] =
        [Role::new("time", "t", Dimension::Time), Role::new("load", "F", Dimension::Force).optional().within(POSITIVE)];
    const LOADS: FileKind = FileKind { rises: true, ..FileKind::new("loads", &ROLES, "time [s], load [N]") };

    #[test]
    fn canonical_files_are_read_as_they_are_written() {
        let text = "# packed\nload [N],time [s]\n5.0,0.0\n0.1,1e-7\n";
        let table = LOADS.read_canonical(text.as_bytes()).unwrap_or_else(|error| unreachable!("{error}"));
        assert_eq!((table.values("time"), table.values("load")), (&[0.0, 1e-7][..], &[5.0, 0.1][..]));
        assert_eq!(LOADS.read_canonical(table.canonical().as_bytes()).map(|again| again.columns), Ok(table.columns));
    }

    #[test]
    fn all_else_is_refused() {
        for (text, line, key) in [
            ("time [ms]\n1\n", Some(1), "columns"),
            ("t [s]\n1\n", Some(1), "columns"),
            ("load [N]\n1\n", Some(1), "columns"),
            ("time [s]\n", Some(1), "rows"),
            ("time [s];load [N]\n1;2\n", Some(1), "columns"),
            ("time [s],load [N]\n1,-2\n", Some(2), "load"),
            ("time [s]\n1\n1\n", Some(3), "column 1 \"time\""),
            ("time [s]\n1,2\n", Some(2), "columns"),
        ] {
            let error = LOADS.read_canonical(text.as_bytes()).map_or_else(|error| error, |_| unreachable!("{text}"));
            assert_eq!((error.line, &error.key[..]), (line, key), "{text}");
        }
    }
}
