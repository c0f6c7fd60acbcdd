//! Tables as the project writes them: a header of lines `# key = value unit`, the names of the columns with their units
//! in brackets, and rows with commas between the fields.
//!
//! One reader, which guesses nothing, and one writer: a table that was written is read as the same, to the last bit. A
//! column holds numbers or words; a number that is missing is NaN in a column and an empty field in a file. Clients find
//! columns by name and unit, cells by their row, and errors say the file and the line.

mod header;
mod numbers;

use std::borrow::Cow;
use std::path::Path;

use crate::tables::{fields, quoted};

pub use header::{Header, TableError};
pub use numbers::number;

/// A column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name, without the unit.
    pub name: String,
    /// Its unit; empty where it has none.
    pub unit: String,
    /// Whether it holds words; else it holds numbers.
    pub has_words: bool,
}

/// A value of a row.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A number; NaN where there is none.
    Number(f64),
    /// A word; empty where there is none.
    Word(String),
}

/// A table.
#[derive(Clone, Debug)]
pub struct Table {
    /// What stands before its rows.
    pub header: Header,
    columns: Vec<Column>,
    rows: Vec<Row>,
}

/// A row: a cell for each column.
#[derive(Clone, Debug)]
struct Row {
    /// Its line in the file that it was read from, from 1; 0 where it was added.
    line: usize,
    cells: Vec<Cell>,
}

impl PartialEq for Table {
    /// The same text, wherever they were read from.
    fn eq(&self, other: &Self) -> bool {
        self.text() == other.text()
    }
}

impl Column {
    /// A column of numbers.
    pub fn numbers(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into(), has_words: false }
    }

    /// A column of words.
    pub fn words(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { has_words: true, ..Self::numbers(name, unit) }
    }

    /// What stands above it: `speed [m/s]`.
    pub fn heading(&self) -> String {
        heading(&self.name, &self.unit)
    }
}

fn heading(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} [{unit}]") }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<Option<f64>> for Cell {
    fn from(number: Option<f64>) -> Self {
        Self::Number(number.unwrap_or(f64::NAN))
    }
}

impl From<&str> for Cell {
    fn from(word: &str) -> Self {
        Self::Word(word.to_owned())
    }
}

impl From<String> for Cell {
    fn from(word: String) -> Self {
        Self::Word(word)
    }
}

impl Cell {
    /// As it stands in a file, quotation marks apart.
    pub fn text(&self) -> String {
        match self {
            Self::Number(number) => numbers::cell(*number),
            Self::Word(word) => word.clone(),
        }
    }

    /// Its number, NaN where there is none; `None` of another word.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            Self::Word(word) => numbers::parsed(word),
        }
    }
}

impl Table {
    /// A table without rows.
    pub fn new(header: Header, columns: impl IntoIterator<Item = Column>) -> Self {
        Self { header, columns: columns.into_iter().collect(), rows: Vec::new() }
    }

    /// Reads a table from its text; `file` is where it came from. A column whose fields are all numbers or empty holds
    /// numbers.
    ///
    /// # Errors
    /// [`TableError`] where a row has more or fewer fields than there are columns.
    pub fn parse(text: &str, file: &Path) -> Result<Self, TableError> {
        let (mut table, rows) = Self::divided(text, file);
        for row in rows {
            table.check_count(&row)?;
            table.rows.push(row);
        }
        for at in 0..table.columns.len() {
            let numbers: Option<Vec<f64>> = table.rows.iter().map(|row| row.cells[at].number()).collect();
            table.columns[at].has_words = numbers.is_none();
            let cells = table.rows.iter_mut().map(|row| &mut row.cells[at]);
            cells.zip(numbers.into_iter().flatten()).for_each(|(cell, number)| *cell = Cell::Number(number));
        }
        Ok(table)
    }

    /// Reads what a command that was stopped has left of this table: its rows, and what is wrong with those that it could
    /// not have written. A last line without an end was cut off.
    ///
    /// # Errors
    /// [`TableError`] where the text is of another table: of another kind, fingerprint or other columns.
    pub fn begun(&self, text: &str, file: &Path) -> Result<(Self, Vec<TableError>), TableError> {
        let (mut table, mut corrupt) = (Self { rows: Vec::new(), ..self.clone() }, Vec::new());
        if self.head().starts_with(text) {
            return Ok((table, corrupt));
        }
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        let (read, rows) = Self::divided(whole, file);
        self.header.check_same(&read.header)?;
        // Even the names may have been cut off.
        if !read.columns.is_empty() && self.headings() != read.headings() {
            return Err(read.error(format!("expected the columns {}", self.headings())));
        }
        table.header = read.header;
        for row in rows {
            match table.check_cells(&row) {
                Ok(()) => table.rows.push(row),
                Err(error) => corrupt.push(error),
            }
        }
        Ok((table, corrupt))
    }

    /// The header and the columns of a text, all of words, and its rows.
    fn divided(text: &str, file: &Path) -> (Self, impl Iterator<Item = Row>) {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let header = Header::parse(text, file);
        let filled = |(_, line): &(usize, &str)| !line.starts_with('#') && !line.trim().is_empty();
        let mut lines = (1..).zip(text.lines()).filter(filled);
        let column = |heading: Cow<'_, str>| {
            let parts = heading.strip_suffix(']').and_then(|text| text.rsplit_once(" ["));
            parts.map_or_else(|| Column::words(&*heading, ""), |(name, unit)| Column::words(name, unit))
        };
        let columns =
            lines.next().into_iter().flat_map(|(_, names)| fields(names, ',')).map(column).collect::<Vec<_>>();
        let cells = |line| fields(line, ',').map(|field| Cell::Word(field.into_owned())).collect();
        (Self::new(header, columns), lines.map(move |(line, text)| Row { line, cells: cells(text) }))
    }

    fn check_count(&self, row: &Row) -> Result<(), TableError> {
        match (row.cells.len(), self.columns.len()) {
            (found, expected) if found == expected => Ok(()),
            (found, expected) => Err(self.error_at(row, format!("{found} fields, expected {expected}"))),
        }
    }

    fn check_cells(&self, row: &Row) -> Result<(), TableError> {
        self.check_count(row)?;
        let mut all = self.columns.iter().zip(&row.cells);
        let wrong = all.find(|(column, cell)| !column.has_words && cell.number().is_none());
        wrong.map_or(Ok(()), |(column, cell)| Err(self.refused(row, column, cell, "a number")))
    }

    /// Adds a row, a cell for each column.
    pub fn push(&mut self, cells: impl IntoIterator<Item = Cell>) {
        self.push_read(0, cells);
    }

    /// Adds a row that was read in a line of the file, from 1.
    pub fn push_read(&mut self, line: usize, cells: impl IntoIterator<Item = Cell>) {
        self.rows.push(Row { line, cells: cells.into_iter().collect() });
    }

    /// The columns.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// The cells of the column at a place, row by row.
    pub fn cells(&self, column: usize) -> impl Iterator<Item = &Cell> {
        self.rows.iter().map(move |row| &row.cells[column])
    }

    /// The number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether it has no rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Whether it has a column of this name and unit.
    pub fn has(&self, name: &str, unit: &str) -> bool {
        self.column(name, unit).is_ok()
    }

    fn column(&self, name: &str, unit: &str) -> Result<usize, TableError> {
        let place = self.columns.iter().position(|column| column.name == name && column.unit == unit);
        place.ok_or_else(|| self.error(format!("no column `{}`", heading(name, unit))))
    }

    /// The number of a row in a column; `None` where it has none.
    ///
    /// # Errors
    /// [`TableError`] where there is no such column, or it has a word there.
    pub fn number(&self, row: usize, name: &str, unit: &str) -> Result<Option<f64>, TableError> {
        let number = self.rows[row].cells[self.column(name, unit)?].number();
        let number = number.ok_or_else(|| self.cell_error(row, name, unit, "a number"))?;
        Ok((!number.is_nan()).then_some(number))
    }

    /// The word of a row in a column; empty where it has none.
    ///
    /// # Errors
    /// [`TableError`] where there is no such column.
    pub fn word(&self, row: usize, name: &str, unit: &str) -> Result<String, TableError> {
        Ok(self.rows[row].cells[self.column(name, unit)?].text())
    }

    /// The table with those of its rows that are `kept`, and this header.
    #[must_use]
    pub fn filtered(&self, header: Header, kept: impl Fn(usize) -> bool) -> Self {
        let rows = self.rows.iter().enumerate().filter(|(row, _)| kept(*row)).map(|(_, row)| row.clone());
        Self { header, columns: self.columns.clone(), rows: rows.collect() }
    }

    /// The line of a row with these cells, its end included.
    pub fn line(cells: &[Cell]) -> String {
        cells.iter().map(|cell| quoted(&cell.text())).collect::<Vec<_>>().join(",") + "\n"
    }

    fn headings(&self) -> String {
        self.columns.iter().map(|column| quoted(&column.heading())).collect::<Vec<_>>().join(",")
    }

    /// The lines before the rows, the names of the columns included.
    pub fn head(&self) -> String {
        format!("{}{}\n", self.header.text(), self.headings())
    }

    /// The table as files have it.
    pub fn text(&self) -> String {
        self.head() + &self.rows.iter().map(|row| Self::line(&row.cells)).collect::<String>()
    }

    /// What is wrong with it.
    pub fn error(&self, problem: impl Into<String>) -> TableError {
        self.header.error(problem)
    }

    /// What is wrong in a row.
    pub fn error_in(&self, row: usize, problem: impl Into<String>) -> TableError {
        self.error_at(&self.rows[row], problem)
    }

    /// What is wrong with the cell of a row in a column: what was `expected` there.
    pub fn cell_error(&self, row: usize, name: &str, unit: &str, expected: &str) -> TableError {
        match self.column(name, unit) {
            Ok(at) => self.refused(&self.rows[row], &self.columns[at], &self.rows[row].cells[at], expected),
            Err(error) => error,
        }
    }

    fn refused(&self, row: &Row, column: &Column, cell: &Cell, expected: &str) -> TableError {
        self.error_at(row, format!("{} = \"{}\": expected {expected}", column.heading(), cell.text()))
    }

    fn error_at(&self, row: &Row, problem: impl Into<String>) -> TableError {
        TableError { line: (row.line > 0).then_some(row.line), ..self.error(problem) }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests may fail")]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Table, TableError> {
        Table::parse(text, Path::new("t.csv"))
    }

    #[test]
    fn what_is_written_is_read_as_the_same() {
        let header = Header::new(("asperity numbers", 1))
            .with("scene", "a = b,\nc")
            .with_number("area", 1e-5 / 3.0, "m2")
            .with_numbers("speeds", &[1e-30, 0.1 + 0.2], "m/s")
            .with_whole("seed", u64::MAX);
        let mut table =
            Table::new(header, [Column::numbers("x", "m"), Column::words("status", ""), Column::numbers("y", "")]);
        table.push([0.1.into(), "no, \"by far\"".into(), None.into()]);
        table.push([(-0.0).into(), "".into(), 1e300.into()]);
        let read = parse(&table.text()).unwrap();
        assert_eq!((&read, read.text()), (&table, table.text()));
        assert_eq!((read.number(0, "y", ""), read.number(0, "x", "m")), (Ok(None), Ok(Some(0.1))));
        assert_eq!((read.word(0, "status", "").unwrap().as_str(), read.len()), ("no, \"by far\"", 2));
        let header = &read.header;
        assert_eq!((header.text_of("scene"), header.whole("seed")), (Some("a = b, c"), Ok(u64::MAX)));
        assert_eq!(
            (header.number("area", "m2"), header.numbers("speeds", "m/s")),
            (Ok(1e-5 / 3.0), Ok(vec![1e-30, 0.1 + 0.2]))
        );
        let first = read.filtered(Header::default(), |row| row == 0);
        assert_eq!((first.number(0, "x", "m"), first.len()), (Ok(Some(0.1)), 1));
    }

    #[test]
    fn errors_say_where_and_what() {
        let said = |error: TableError| error.to_string();
        assert_eq!(said(parse("# a = 1\nx [m],y [1]\n\n1,2\n1\n").unwrap_err()), "t.csv:5: 1 fields, expected 2");
        let table = parse("# a = 1 = 2\nx [m],y [1]\n1,fast\n").unwrap();
        assert_eq!(table.header.text_of("a"), Some("1 = 2"));
        assert_eq!(said(table.number(0, "y", "m").unwrap_err()), "t.csv: no column `y [m]`");
        assert_eq!(said(table.number(0, "y", "1").unwrap_err()), "t.csv:3: y [1] = \"fast\": expected a number");
        assert_eq!(said(table.header.number("b", "Pa").unwrap_err()), "t.csv: `# b = `: expected a number in Pa");
        assert_eq!(table.header.optional("b", Header::whole), Ok(None));
    }

    #[test]
    fn what_a_stopped_command_has_left_is_found() {
        let header = Header::new(("n", 1)).with("fingerprint", "00");
        let table = Table::new(header, [Column::numbers("x", "m"), Column::words("status", "")]);
        let begun = |text: &str| table.begun(text, Path::new("t.csv"));
        let text = format!("{}1,steady\nx,steady\n2\n3,4\n5,stea", table.head());
        let (found, corrupt) = begun(&text).unwrap();
        assert_eq!(
            (found.len(), found.number(1, "x", "m"), found.word(1, "status", "")),
            (2, Ok(Some(3.0)), Ok("4".into()))
        );
        let said: Vec<String> = corrupt.iter().map(ToString::to_string).collect();
        assert_eq!(said, ["t.csv:5: x [m] = \"x\": expected a number", "t.csv:6: 1 fields, expected 2"]);
        // Cut off anywhere: the rows whose lines are whole.
        for cut in 0..text.len() {
            let rows = begun(&text[..cut]).unwrap().0.len();
            assert!(rows <= 2 && (rows == 0) == (cut < table.head().len() + "1,steady\n".len()), "cut off after {cut}");
        }
        for (other, why) in [
            ("# n = 1\n# fingerprint = 00\nx [mm],status\n", "expected the columns x [m],status"),
            ("# n = 1\n# fingerprint = 01\n", "another n: its fingerprint is 01, expected 00"),
            ("# n = 2\n", "expected the line `# n = 1`, found 2"),
            ("notes", "expected the line `# n = 1`, found none"),
        ] {
            let error = begun(other).unwrap_err().to_string();
            assert!(error.starts_with("t.csv: ") && error.contains(why), "{error}");
        }
    }
}
