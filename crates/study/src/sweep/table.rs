//! The table of a sweep: read from a file, made of rows that were found.

use std::path::Path;

use asperity::element::{FORMAT, Table, TableError, TableHeader, TableRow, TableText};
use asperity::scene::Scene;

use super::low_end::low_end;
use super::ranking::ranking;
use crate::error::Error;
use crate::files;

/// A table cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum SweepTableError {
    /// The file.
    #[error(transparent)]
    File(#[from] Error),
    /// What is in it.
    #[error(transparent)]
    Table(#[from] TableError),
}

/// A row as it stands in a file: a table that is continued or merged keeps it to the letter.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredRow {
    /// The row.
    pub row: TableRow,
    text: String,
}

impl StoredRow {
    /// The line of the row, its end included.
    pub fn line(&self) -> &str {
        &self.text
    }
}

/// A table read from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepTable {
    /// What stands before the rows.
    pub header: TableHeader,
    /// The rows, those of points not yet found missing.
    pub rows: Vec<StoredRow>,
}

impl SweepTable {
    /// The table of rows that were found, in the order of the points.
    pub fn new(header: TableHeader, rows: Vec<TableRow>) -> Self {
        let rows = rows.into_iter().map(|row| StoredRow { text: row.line(), row });
        let mut table = Self { header, rows: rows.collect() };
        table.sort();
        table.conclude(Path::new("table"));
        table
    }

    /// Reads a table.
    ///
    /// # Errors
    /// Where the file cannot be read, or is no such table.
    pub fn read(path: &Path) -> Result<Self, SweepTableError> {
        let text = files::text(path)?;
        let (table, corrupt) = Self::parse(&text, path)?;
        corrupt.into_iter().next().map_or(Ok(table), |error| Err(error.into()))
    }

    /// The table of a `text`, which is that of the file at `path`, without its corrupt rows, and what is wrong with those.
    ///
    /// # Errors
    /// Where the text is no such table.
    pub fn parse(text: &str, path: &Path) -> Result<(Self, Vec<TableError>), TableError> {
        // A last line without an end was cut off as its writer was stopped.
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        let (text, corrupt) = TableText::parse_sound(whole, path)?;
        let header = text.header()?;
        let rows = text.rows(header.load)?.into_iter().zip(&text.lines);
        let rows = rows.map(|(row, line)| StoredRow { row, text: format!("{}\n", line.text) }).collect();
        Ok((Self { header, rows }, corrupt))
    }

    /// Sorts the rows in the order of the points.
    pub fn sort(&mut self) {
        let grid = &self.header.grid;
        self.rows.sort_by_key(|stored| grid.index(&stored.row.point));
    }

    /// Says in the header what follows from all rows: what lies at the low end, where every point is there and steady and
    /// there are several loads; how samples rank.
    pub fn conclude(&mut self, path: &Path) {
        self.header.ranking = self.ranking();
        self.header.low_end = Table::parse(&self.text(), path).ok().map(|table| low_end(&table));
    }

    /// The samples, from 1, by their mean friction over the table, the lowest first; a sample without a result at a point
    /// counts there with the median. Empty while points are missing, and without samples.
    pub fn ranking(&self) -> Vec<usize> {
        let rows: Vec<&TableRow> = self.rows.iter().map(|stored| &stored.row).collect();
        if rows.len() == self.header.grid.count() { ranking(&rows) } else { Vec::new() }
    }

    /// The table as files have it.
    pub fn text(&self) -> String {
        self.header.text() + &self.rows.iter().map(|stored| stored.text.as_str()).collect::<String>()
    }
}

/// Tells one sweep from another: depends on everything in the scene that its points depend on, and on the settings.
///
/// # Errors
/// Where the scene cannot be written as JSON.
pub fn fingerprint(scene: &Scene, settings: &str) -> Result<String, serde_json::Error> {
    let text = format!("{FORMAT}\n{}\n{settings}\n{}", env!("CARGO_PKG_VERSION"), serde_json::to_string(scene)?);
    Ok(fingerprint_of(&text))
}

/// Tells one text from another.
pub(super) fn fingerprint_of(text: &str) -> String {
    uuid::Uuid::new_v5(&uuid::Uuid::NAMESPACE_OID, text.as_bytes()).simple().to_string()
}
