//! The file of a sweep: points are added as they are done and not computed again; shards are merged into one.

use std::path::{Path, PathBuf};

use asperity::element::{OperatingPoint, TableError, TableHeader, TableRow, some_of};
use asperity_study::sweep::{StoredRow, SweepTable, SweepTableError};

use crate::files::{FileError, write};
use crate::lock::TableLock;
use crate::resumable_table::{ResumableTable, rows_of};
use crate::terminal::warn;

/// A table cannot be read, continued or merged.
#[derive(Debug, thiserror::Error)]
pub(crate) enum TableFileError {
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

impl From<SweepTableError> for TableFileError {
    fn from(error: SweepTableError) -> Self {
        match error {
            SweepTableError::File(error) => Self::File(error.into()),
            SweepTableError::Table(error) => Self::Table(error),
        }
    }
}

/// Merges the tables at `paths` with the one of the same sweep at `output`, unless that is to be replaced, and
/// writes the result there.
pub(super) fn merge(paths: &[PathBuf], output: &Path, replace: bool) -> Result<SweepTable, TableFileError> {
    let _lock = TableLock::take(output)?;
    let mut tables: Vec<SweepTable> = paths.iter().map(|path| SweepTable::read(path)).collect::<Result<_, _>>()?;
    let header = tables[0].header.clone();
    for (path, table) in paths.iter().zip(&tables) {
        if let Some(difference) = difference(&header, &table.header) {
            let (first, other) = (paths[0].clone(), path.clone());
            return Err(TableFileError::Different { first, other, difference });
        }
    }
    let mut paths = paths.to_vec();
    if !replace {
        tables.push(SweepTable {
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
    let mut table = SweepTable { header, rows };
    table.conclude(output);
    write(output, table.text())?;
    if missing.is_empty() {
        return Ok(table);
    }
    let total = table.rows.len() + missing.len();
    Err(TableFileError::Missing { missing, total, path: output.to_owned() })
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
    match found.find(|(other, _)| other.line() != stored.line()) {
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
            ResumableTable::open(path, &header.text(), replace, read, |stored: &StoredRow| stored.line().to_owned())?;
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
