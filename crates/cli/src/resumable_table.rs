//! Tables that long commands add rows to: rows that a command has written before it was stopped are not computed again.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use asperity::scene::read_file;

use super::files::{FileError, write};
use super::lock::TableLock;

/// A table to which rows are added, from any thread, and that no other command adds to meanwhile.
#[derive(Debug)]
pub(crate) struct ResumableTable {
    path: PathBuf,
    /// A line is written at once, so that one that is cut off has no end.
    file: Mutex<File>,
    _lock: TableLock,
}

impl ResumableTable {
    /// Begins the table at `path` with its `header`, all lines before the rows, or, unless it is to be replaced, continues
    /// the one that is there. Returns [the rows that it has](rows_of); `line` writes one.
    ///
    /// # Errors
    /// Those of `read`, and where the file cannot be read or written or another command has it.
    pub(crate) fn open<R, E: From<FileError>>(
        path: &Path,
        header: &str,
        replace: bool,
        read: impl FnOnce(&str) -> Result<Vec<R>, E>,
        line: impl Fn(&R) -> String,
    ) -> Result<(Self, Vec<R>), E> {
        let lock = TableLock::take(path)?;
        let rows = if replace { Vec::new() } else { rows_of(path, header, read)? };
        write(path, header.to_owned() + &rows.iter().map(line).collect::<String>())?;
        let file = OpenOptions::new().append(true).open(path).map_err(FileError::io("write", path))?;
        Ok((Self { path: path.to_owned(), file: Mutex::new(file), _lock: lock }, rows))
    }

    /// Adds the line of a row, its end included; it is in the file when this returns.
    pub(crate) fn add(&self, line: &str) -> Result<(), FileError> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let written = file.write_all(line.as_bytes()).and_then(|()| file.sync_data());
        written.map_err(FileError::io("write", &self.path))
    }
}

/// The rows of the table at `path`, which `read` finds in its text, whose lines are whole; none where there is no file or
/// only the beginning of the `header`.
///
/// # Errors
/// Those of `read`, and where the file cannot be read.
pub(crate) fn rows_of<R, E: From<FileError>>(
    path: &Path,
    header: &str,
    read: impl FnOnce(&str) -> Result<Vec<R>, E>,
) -> Result<Vec<R>, E> {
    let text = match read_file(path) {
        Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(FileError::io("read", path)(error).into()),
    };
    if header.starts_with(&text) {
        return Ok(Vec::new());
    }
    // A last line without an end was cut off as its writer was stopped.
    read(text.rfind('\n').map_or("", |end| &text[..=end]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    const HEADER: &str = "# numbers\nnumber\n";

    /// A table of numbers; that of another header is refused.
    fn open(path: &Path, replace: bool) -> Result<(ResumableTable, Vec<u32>), FileError> {
        let read = |text: &str| {
            let rows = text.strip_prefix(HEADER).ok_or_else(|| FileError::value("another table"))?;
            Ok(rows.lines().filter_map(|line| line.parse().ok()).collect())
        };
        ResumableTable::open(path, HEADER, replace, read, |row| format!("{row}\n"))
    }

    #[test]
    fn rows_are_kept_wherever_the_table_was_cut_off() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        let (table, rows) = open(&path, false).unwrap();
        assert!(rows.is_empty());
        table.add("10\n").and_then(|()| table.add("200\n")).unwrap();
        drop(table);
        let whole = fs::read_to_string(&path).unwrap();
        assert_eq!(whole, format!("{HEADER}10\n200\n"));
        for cut in 0..=whole.len() {
            fs::write(&path, &whole[..cut]).unwrap();
            let ends = [HEADER.len() + 3, whole.len()].into_iter().filter(|end| *end <= cut).count();
            assert_eq!(open(&path, false).unwrap().1, [10, 200][..ends], "cut off after {cut}");
        }
    }

    #[test]
    fn another_file_is_replaced_when_asked_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        for other in ["notes", "notes\n", "# numbers\nother\n1\n"] {
            fs::write(&path, other).unwrap();
            assert!(open(&path, false).is_err() && fs::read_to_string(&path).unwrap() == other, "{other:?}");
            assert!(open(&path, true).unwrap().1.is_empty());
            assert_eq!(fs::read_to_string(&path).unwrap(), HEADER);
        }
    }
}
