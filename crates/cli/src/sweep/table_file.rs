//! The file of a sweep: points are added as they are done and not computed again; shards are merged into one.

use std::path::{Path, PathBuf};

use asperity::element::{FORMAT, OperatingPoint, Table, TableError, TableHeader, TableRow, TableText, some_of};
use asperity::scene::{Scene, read_text};

use super::low_end::low_end;
use crate::files::{FileError, write};
use crate::lock::TableLock;
use crate::resumable_table::{ResumableTable, rows_of};
use crate::terminal::warn;

/// A table cannot be read, continued or merged.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum TableFileError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error("{0}; name another -o, or give --force to replace it")]
    NotATable(TableError),
    #[error(
        "{} is the table of another sweep: its fingerprint is {found}, that of this scene with these settings {expected}; name \
         another -o, or give --force to replace it",
        .path.display()
    )]
    OtherSweep { path: PathBuf, found: String, expected: String },
    #[error(
        "{} has points that this sweep does not have, the first at {point}: include their values, name another -o, or give --force \
         to replace the table",
        .path.display()
    )]
    UnknownPoint { path: PathBuf, point: String },
    #[error("--merge: {} and {} are of different sweeps: {difference}", .first.display(), .other.display())]
    Different { first: PathBuf, other: PathBuf, difference: String },
    #[error("--merge: {} and {} differ at {point}", .first.display(), .other.display())]
    Contradiction { first: PathBuf, other: PathBuf, point: String },
    #[error(
        "{} of {total} points are missing: {}; {} has the others, and `asperity sweep` with this -o continues it",
        .missing.len(), some_of(.missing), .path.display()
    )]
    Missing { missing: Vec<String>, total: usize, path: PathBuf },
}

/// A row as it stands in a file: a table that is continued or merged keeps it to the letter.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredRow {
    /// The row.
    pub row: TableRow,
    text: String,
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
        table.find_low_end(Path::new("table"));
        table
    }

    /// Reads a table.
    ///
    /// # Errors
    /// Where the file cannot be read, or is no such table.
    pub fn read(path: &Path) -> Result<Self, TableFileError> {
        let text = read_text(path).map_err(FileError::io("read", path))?;
        let (table, corrupt) = Self::parse(&text, path)?;
        corrupt.into_iter().next().map_or(Ok(table), |error| Err(error.into()))
    }

    /// The table without its corrupt rows, and what is wrong with those.
    fn parse(text: &str, path: &Path) -> Result<(Self, Vec<TableError>), TableError> {
        // A last line without an end was cut off as its writer was stopped.
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        let (text, corrupt) = TableText::parse_sound(whole, path)?;
        let header = text.header()?;
        let rows = text.rows(header.load)?.into_iter().zip(&text.lines);
        let rows = rows.map(|(row, line)| StoredRow { row, text: format!("{}\n", line.text) }).collect();
        Ok((Self { header, rows }, corrupt))
    }

    #[cfg(test)]
    pub(super) fn of_rows(header: TableHeader, rows: Vec<TableRow>) -> Self {
        let rows = rows.into_iter().map(|row| StoredRow { text: row.line(), row }).collect();
        Self { header, rows }
    }

    /// Sorts the rows in the order of the points.
    pub(super) fn sort(&mut self) {
        let grid = &self.header.grid;
        self.rows.sort_by_key(|stored| grid.index(&stored.row.point));
    }

    /// Says in the header what lies at the low end, where every point is there and steady and there are several loads.
    pub(super) fn find_low_end(&mut self, path: &Path) {
        self.header.low_end = Table::parse(&self.text(), path).ok().map(|table| low_end(&table));
    }

    /// The table as files have it.
    pub fn text(&self) -> String {
        self.header.text() + &self.rows.iter().map(|stored| stored.text.as_str()).collect::<String>()
    }

    /// Writes the table at once: what is at `path` is the one before or this one, whole.
    pub(super) fn write(&self, path: &Path) -> Result<(), FileError> {
        write(path, self.text())
    }

    /// Merges the tables at `paths` with the one of the same sweep at `output`, unless that is to be replaced, and
    /// writes the result there.
    pub(super) fn merge(paths: &[PathBuf], output: &Path, replace: bool) -> Result<Self, TableFileError> {
        let _lock = TableLock::take(output)?;
        let mut tables: Vec<Self> = paths.iter().map(|path| Self::read(path)).collect::<Result<_, _>>()?;
        let header = tables[0].header.clone();
        for (path, table) in paths.iter().zip(&tables) {
            if let Some(difference) = difference(&header, &table.header) {
                let (first, other) = (paths[0].clone(), path.clone());
                return Err(TableFileError::Different { first, other, difference });
            }
        }
        let mut paths = paths.to_vec();
        if !replace {
            tables.push(Self {
                header: header.clone(),
                rows: rows_of(output, &header.text(), |text| rows_in(text, output, &header))?,
            });
            paths.push(output.to_owned());
        }
        let (mut rows, mut missing) = (Vec::new(), Vec::new());
        for point in header.grid.points() {
            match row_of(&tables, &paths, &point)? {
                Some(stored) => rows.push(stored.clone()),
                None => missing.push(point.describe(header.load)),
            }
        }
        let mut table = Self { header, rows };
        table.find_low_end(output);
        table.write(output)?;
        if missing.is_empty() {
            return Ok(table);
        }
        let total = table.rows.len() + missing.len();
        Err(TableFileError::Missing { missing, total, path: output.to_owned() })
    }
}

/// The row of a point, which is the same in all tables that have it.
fn row_of<'a>(
    tables: &'a [SweepTable],
    paths: &[PathBuf],
    point: &OperatingPoint,
) -> Result<Option<&'a StoredRow>, TableFileError> {
    let all = tables.iter().zip(paths).flat_map(|(table, path)| table.rows.iter().map(move |stored| (stored, path)));
    let mut found = all.filter(|(stored, _)| stored.row.point == *point);
    let Some((stored, first)) = found.next() else { return Ok(None) };
    match found.find(|(other, _)| other.text != stored.text) {
        Some((_, other)) => {
            let point = point.describe(tables[0].header.load);
            Err(TableFileError::Contradiction { first: first.clone(), other: other.clone(), point })
        }
        None => Ok(Some(stored)),
    }
}

fn difference(first: &TableHeader, other: &TableHeader) -> Option<String> {
    if first.fingerprint != other.fingerprint {
        return Some(format!("fingerprint {} and {}", first.fingerprint, other.fingerprint));
    }
    (first != other).then(|| "they have different points".to_owned())
}

/// A table to which rows are added.
#[derive(Debug)]
pub(super) struct TableFile {
    rows: ResumableTable,
    /// The rows that were there.
    pub(super) done: Vec<StoredRow>,
}

impl TableFile {
    /// Begins a table or, unless it is to be replaced, continues the one that is there.
    pub(super) fn open(path: &Path, header: &TableHeader, replace: bool) -> Result<Self, TableFileError> {
        let read = |text: &str| rows_in(text, path, header);
        let (rows, done) =
            ResumableTable::open(path, &header.text(), replace, read, |stored: &StoredRow| stored.text.clone())?;
        Ok(Self { rows, done })
    }

    /// Adds a row; it is in the file when this returns.
    pub(super) fn add(&self, row: &TableRow) -> Result<(), FileError> {
        self.rows.add(&row.line())
    }
}

/// The rows of the table at `path`, which is the `text`, without the corrupt ones, which are named.
fn rows_in(text: &str, path: &Path, header: &TableHeader) -> Result<Vec<StoredRow>, TableFileError> {
    if is_begun(text, &header.text()) {
        return Ok(Vec::new());
    }
    let (table, corrupt) = SweepTable::parse(text, path).map_err(TableFileError::NotATable)?;
    if table.header.fingerprint != header.fingerprint {
        let (found, expected) = (table.header.fingerprint, header.fingerprint.clone());
        return Err(TableFileError::OtherSweep { path: path.to_owned(), found, expected });
    }
    corrupt.iter().for_each(|error| warn(&format!("{error}; the point is computed again")));
    match table.rows.iter().find(|stored| header.grid.index(&stored.row.point).is_none()) {
        Some(stored) => {
            let point = stored.row.point.describe(header.load);
            Err(TableFileError::UnknownPoint { path: path.to_owned(), point })
        }
        None => Ok(table.rows),
    }
}

/// Whether a text is a header without the names of the columns, before which a line on the low end may stand.
fn is_begun(text: &str, header: &str) -> bool {
    let names = header.trim_end().rfind('\n').map_or(0, |end| end + 1);
    text.strip_prefix(&header[..names]).is_some_and(|rest| rest.lines().all(|line| line.starts_with('#')))
}

/// Tells one sweep from another: depends on everything in the scene that its points depend on, and on the settings.
pub(crate) fn fingerprint(scene: &Scene, settings: &str) -> Result<String, serde_json::Error> {
    let text = format!("{FORMAT}\n{}\n{settings}\n{}", env!("CARGO_PKG_VERSION"), serde_json::to_string(scene)?);
    Ok(uuid::Uuid::new_v5(&uuid::Uuid::NAMESPACE_OID, text.as_bytes()).simple().to_string())
}
