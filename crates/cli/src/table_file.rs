//! Tables that long commands add rows to: rows that a command has written before it was stopped are not computed again.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Write as _};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use asperity::scene::read_file;
use asperity::table::{Cell, Table, TableError};
use asperity_study::Error;
use asperity_study::files;

use super::draft::TablePlace;
use super::files::write;
use super::lock::TableLock;
use super::output::unwritten;
use super::terminal::warn;

/// A table to which rows are added, from any thread, and that no other command adds to meanwhile.
#[derive(Debug)]
pub(crate) struct TableFile {
    place: TablePlace,
    /// A line is written at once, so that one that is cut off has no end.
    file: Mutex<File>,
    _lock: TableLock,
}

impl TableFile {
    /// Begins the file of a `table` without rows for an `output` or, unless it is to be replaced, continues the one that is
    /// there. Returns [its rows](rows_of), as `read` makes them of a table.
    ///
    /// # Errors
    /// Those of `read`, and where the file is of another table, cannot be read or written or another command has it.
    pub(crate) fn open<R>(
        output: &Path,
        table: &Table,
        replace: bool,
        read: impl FnOnce(&Table) -> Result<Vec<Result<R, TableError>>, TableError>,
    ) -> Result<(Self, Vec<R>), Error> {
        let place = TablePlace::new(output)?;
        let (path, lock) = (&place.path, TableLock::take(&place.path)?);
        let (kept, rows) = if replace { (table.clone(), Vec::new()) } else { rows_of(path, table, read)? };
        write(path, kept.text())?;
        let file = OpenOptions::new().append(true).open(path).map_err(unwritten(path))?;
        Ok((Self { file: Mutex::new(file), place, _lock: lock }, rows))
    }

    /// Adds a row; it is in the file when this returns.
    pub(crate) fn add(&self, row: &[Cell]) -> Result<(), Error> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let written = file.write_all(Table::line(row).as_bytes()).and_then(|()| file.sync_data());
        written.map_err(unwritten(&self.place.path))
    }

    /// Writes what `change` makes of the table in the file in its place.
    pub(crate) fn finish_with(self, change: impl FnOnce(&Table) -> Table) -> Result<(), Error> {
        let path = &self.place.path;
        let table = Table::parse(&files::text(path)?, path)?;
        self.finish(&change(&table))
    }

    /// Writes the whole table in place of its rows as they were added.
    pub(crate) fn finish(self, table: &Table) -> Result<(), Error> {
        write(&self.place.path, table.text())?;
        let Self { place, .. } = self;
        place.finish()
    }
}

/// What the file at `path` has of a `table`, as it is and as `read` makes it: none where there is no file. Rows that are
/// corrupt, or refused by `read`, are named and left out.
///
/// # Errors
/// Those of `read`, and where the file is of another table or cannot be read.
fn rows_of<R>(
    path: &Path,
    table: &Table,
    read: impl FnOnce(&Table) -> Result<Vec<Result<R, TableError>>, TableError>,
) -> Result<(Table, Vec<R>), Error> {
    let text = match read_file(path) {
        Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
        Err(error) if error.kind() == ErrorKind::NotFound => String::new(),
        Err(error) => return Err(Error::io("read", path)(error)),
    };
    let refused = |error: TableError| {
        let problem = format!("{}; name another -o, or give --force to replace it", error.problem);
        Error::from(TableError { problem, ..error })
    };
    let (found, mut corrupt) = table.begun(&text, path).map_err(refused)?;
    let read = if found.is_empty() { Vec::new() } else { read(&found).map_err(refused)? };
    let kept = found.filtered(table.header.clone(), |row| read[row].is_ok());
    let mut rows = Vec::new();
    for row in read {
        match row {
            Ok(row) => rows.push(row),
            Err(error) => corrupt.push(error),
        }
    }
    corrupt.sort_by_key(|error| error.line);
    corrupt.iter().for_each(|error| warn(&format!("{error}; it is computed again")));
    Ok((kept, rows))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use asperity::table::{Column, Header};

    use super::*;

    fn table() -> Table {
        Table::new(Header::new(("numbers", 1)), [Column::numbers("number", "")])
    }

    /// A table of numbers below 1000.
    fn open(path: &Path, replace: bool) -> Result<(TableFile, Vec<f64>), Error> {
        TableFile::open(path, &table(), replace, |found| {
            let row = |row| {
                let number = found.number(row, "number", "")?.filter(|number| *number < 1000.0);
                number.ok_or_else(|| found.error_in(row, "too large"))
            };
            Ok((0..found.len()).map(row).collect())
        })
    }

    #[test]
    fn rows_are_kept_wherever_the_table_was_cut_off() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        let (file, rows) = open(&path, false).unwrap();
        assert!(rows.is_empty());
        [10.0, 200.0, 3000.0].iter().for_each(|number| file.add(&[Cell::from(*number)]).unwrap());
        drop(file);
        let (whole, head) = (fs::read_to_string(&path).unwrap(), table().head());
        assert_eq!(whole, format!("{head}10\n200\n3000\n"));
        for cut in 0..=whole.len() {
            fs::write(&path, &whole[..cut]).unwrap();
            let ends = [head.len() + 3, head.len() + 7].into_iter().filter(|end| *end <= cut).count();
            assert_eq!(open(&path, false).unwrap().1, [10.0, 200.0][..ends], "cut off after {cut}");
        }
    }

    #[test]
    fn another_file_is_replaced_when_asked_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        for other in ["notes", "notes\n", "# numbers = 1\nother\n1\n"] {
            fs::write(&path, other).unwrap();
            assert!(open(&path, false).is_err() && fs::read_to_string(&path).unwrap() == other, "{other:?}");
            assert!(open(&path, true).unwrap().1.is_empty());
            assert_eq!(fs::read_to_string(&path).unwrap(), table().head());
        }
    }
}
