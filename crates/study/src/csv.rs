//! Tables of text with a header: read with commas, semicolons or tabs between the fields, written with commas.

use std::borrow::Cow;
use std::fmt::{self, Display, Formatter};
use std::path::Path;

use asperity::outputs::OutputType;
use asperity::scene::Unit;
use asperity::tables::{ContentError, fields, quoted};
use asperity_formats::text::{Row, decode};

use crate::decimals::file_decimal;
use crate::error::Error;
use crate::files::bytes;

/// A file that begins with the names of its columns, its fields as text.
#[derive(Clone, Debug, Default)]
pub struct Csv {
    /// The names of the columns.
    pub names: Vec<String>,
    /// The rows, each with as many fields.
    pub rows: Vec<Row<'static>>,
    /// The line of the names.
    pub line: usize,
}

impl Csv {
    /// The file in a text; see `rows` for the separator.
    ///
    /// # Errors
    /// [`ContentError`] where a row has more or fewer fields than there are names.
    pub fn parse(text: &str, separator: Option<char>) -> Result<Self, ContentError> {
        let mut rows = rows(text, separator).map(Row::into_owned);
        let Some(head) = rows.next() else { return Ok(Self::default()) };
        let names: Vec<String> = head.fields.into_iter().map(Cow::into_owned).collect();
        let whole = |row: Row<'static>| match row.fields.len() {
            found if found == names.len() => Ok(row),
            found => {
                let expected = format!("{}, as in line {}, that of the names", names.len(), head.line);
                Err(ContentError::value(Some(row.line), "fields", &found.to_string(), &expected))
            }
        };
        let rows = rows.map(whole).collect::<Result<_, _>>()?;
        Ok(Self { names, rows, line: head.line })
    }

    /// The place of the column `name`; the unit of a name such as `speed [m/s]` may be left out.
    ///
    /// # Errors
    /// [`ContentError`] with the names that there are.
    pub fn column(&self, name: &str) -> Result<usize, ContentError> {
        let without_unit = |header: &str| header.split_once(" [").is_some_and(|(start, _)| start == name);
        let named = self.names.iter().position(|other| other == name);
        let named = named.or_else(|| self.names.iter().position(|other| without_unit(other)));
        named.ok_or_else(|| {
            let line = (self.line > 0).then_some(self.line);
            ContentError::value(line, "columns", &self.names.join(", "), &format!("{name} among them"))
        })
    }
}

/// Reads the file at `path`, which begins with the names of its columns.
///
/// # Errors
/// Where it cannot be read, or a line has not as many fields as the first.
pub fn read(path: &Path) -> Result<Csv, Error> {
    let bytes = bytes(path)?;
    let parsed = decode(&bytes).map_err(ContentError::from).and_then(|text| Csv::parse(&text, None));
    parsed.map_err(Error::content(path))
}

/// The lines that are neither blank nor comments (`# …`), as rows: their fields are separated by `separator` or, where
/// none is given, by the first of semicolon, tab and comma that is in the first row outside quotation marks.
fn rows(text: &str, separator: Option<char>) -> impl Iterator<Item = Row<'_>> {
    let filled = || (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    let parts = |sign: char| filled().next().is_some_and(|(_, line)| fields(line, sign).nth(1).is_some());
    let found = || [';', '\t', ','].into_iter().find(|&sign| parts(sign));
    let separator = separator.or_else(found).unwrap_or(',');
    filled().map(move |(line, text)| Row { line, fields: fields(text, separator).collect() })
}

/// The fields as a line without its end.
pub fn line<T: AsRef<str>>(fields: impl IntoIterator<Item = T>) -> String {
    let fields: Vec<String> = fields.into_iter().map(|field| quoted(field.as_ref())).collect();
    fields.join(",")
}

/// A name that somebody gave, as a field: where a spreadsheet would take it for a formula it has an apostrophe before it,
/// which spreadsheets do not show.
pub fn given_name(name: &str) -> String {
    let is_formula = name.trim_start().starts_with(['=', '+', '-', '@']);
    if is_formula { format!("'{name}") } else { name.to_owned() }
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
    fn names_are_no_formulas() {
        let names = ["=1+1", "+a", "-5 °C", "@x", " =b", "a=b"].map(given_name);
        assert_eq!(names, ["'=1+1", "'+a", "'-5 °C", "'@x", "' =b", "a=b"]);
    }

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
    fn rows_have_their_lines_and_the_separator_of_the_first() {
        let text = "# by hand\n\na;b,c\r\n1;2\n \n# end\n3,5;4\n";
        let found: Vec<(usize, Vec<Cow<'_, str>>)> = rows(text, None).map(|row| (row.line, row.fields)).collect();
        let row = |line, fields: [&'static str; 2]| (line, fields.map(Cow::from).to_vec());
        assert_eq!(found, [row(3, ["a", "b,c"]), row(4, ["1", "2"]), row(7, ["3,5", "4"])]);
        let by_commas: Vec<_> = rows(text, Some(',')).map(|row| row.fields.len()).collect();
        assert_eq!(by_commas, [2, 1, 2]);
    }

    #[test]
    fn integers_have_no_exponent() {
        assert_eq!(Field { kind: OutputType::Integer, value: 1e7 }.to_string(), "10000000");
    }
}
