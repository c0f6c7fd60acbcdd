//! Tables of results: CSV files, and rows of a run.

use std::fs;
use std::path::Path;

/// Rows of fields under the names of their columns. A column is asked for by its name, with its unit or without.
#[derive(Debug, PartialEq)]
pub struct Table {
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads a file that has a line of names and then rows, as [`parse`](Self::parse) does.
    pub fn read(path: &Path) -> Self {
        Self::parse(&fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display())))
    }

    /// The table in a text, whose lines of comment begin with `#`.
    pub fn parse(text: &str) -> Self {
        let mut lines = csv::ReaderBuilder::new().has_headers(false).comment(Some(b'#')).from_reader(text.as_bytes());
        let mut rows = lines.records().map(|line| line.unwrap().iter().map(str::to_owned).collect());
        Self { names: rows.next().unwrap(), rows: rows.collect() }
    }

    /// The table with these rows.
    pub fn new(names: impl IntoIterator<Item = impl ToString>, rows: impl IntoIterator<Item = Vec<f64>>) -> Self {
        // 0 as 0.0: some readers take 0 for a column of integers.
        let row = |row: Vec<f64>| row.iter().map(|value| format!("{value:?}")).collect();
        let names = names.into_iter().map(|name| name.to_string()).collect();
        Self { names, rows: rows.into_iter().map(row).collect() }
    }

    pub fn write(&self, path: &Path) {
        let lines = [&self.names].into_iter().chain(&self.rows).map(|fields| fields.join(",") + "\n");
        fs::write(path, lines.collect::<String>()).unwrap();
    }

    /// The names of the columns.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    fn index(&self, name: &str) -> Option<usize> {
        let is_it = |other: &String| other == name || other.split_once(" [").is_some_and(|(other, _)| other == name);
        self.names.iter().position(is_it)
    }

    /// The fields of a column that has to be there.
    pub fn texts(&self, name: &str) -> Vec<&str> {
        let index = self.index(name).unwrap_or_else(|| panic!("no column {name} in {:?}", self.names));
        self.rows.iter().map(|row| row[index].as_str()).collect()
    }

    /// The values of a column that has to be there.
    pub fn column(&self, name: &str) -> Vec<f64> {
        let number = |text: &str| text.parse().unwrap_or_else(|_| panic!("{name}: {text:?} is no number"));
        self.texts(name).into_iter().map(number).collect()
    }

    /// The values of a column; `None` where there is no such column.
    pub fn get(&self, name: &str) -> Option<Vec<f64>> {
        self.index(name).map(|_| self.column(name))
    }

    /// A field of a column that has to be there.
    pub fn text(&self, row: usize, name: &str) -> &str {
        self.texts(name)[row]
    }

    /// A value of a column that has to be there.
    pub fn number(&self, row: usize, name: &str) -> f64 {
        let text = self.text(row, name);
        text.parse().unwrap_or_else(|_| panic!("{name}: {text:?} in {:?}", self.rows[row]))
    }

    /// The last value of a column that has to be there.
    pub fn last(&self, name: &str) -> f64 {
        self.number(self.len() - 1, name)
    }

    /// The rows after the first `count`.
    pub fn skip(mut self, count: usize) -> Self {
        self.rows.drain(..count);
        self
    }

    /// Every `step`th row.
    pub fn every(mut self, step: usize) -> Self {
        self.rows = self.rows.into_iter().step_by(step).collect();
        self
    }
}
