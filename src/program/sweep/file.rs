//! The file of a sweep: points are added as they are done, and what is there is not done again.

use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use super::error::SweepError;
use super::grid::Point;
use super::table::{Header, Line, Table};
use crate::program::error::ProgramError;

/// A table on its way.
#[derive(Debug)]
pub(super) struct TableFile {
    path: PathBuf,
    /// Where lines are added; a line is written at once, so that one that is cut off has no end.
    file: Mutex<File>,
    /// The points that were there.
    pub(super) done: Vec<Line>,
}

impl TableFile {
    /// Begins a table, or takes up the one that is there.
    pub(super) fn open(path: &Path, header: &Header, force: bool) -> Result<Self, ProgramError> {
        let done = if force { Vec::new() } else { points_done(path, header)? };
        write_table(path, header, done.iter().map(|line| line.text.as_str()))?;
        let file = OpenOptions::new().append(true).open(path).map_err(ProgramError::file("write", path))?;
        Ok(Self { path: path.to_owned(), file: Mutex::new(file), done })
    }

    /// Adds a point's line; it is in the file when this returns.
    pub(super) fn add(&self, line: &str) -> Result<(), ProgramError> {
        let mut file = self.file.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let written = file.write_all(line.as_bytes()).and_then(|()| file.sync_data());
        written.map_err(ProgramError::file("write", &self.path))
    }
}

/// The points of the table at `path`; none where there is no file, or only the beginning of a header.
fn points_done(path: &Path, header: &Header) -> Result<Vec<Line>, ProgramError> {
    let text = match fs::read(path) {
        Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(ProgramError::file("read", path)(error)),
    };
    if header.text().starts_with(&text) {
        return Ok(Vec::new());
    }
    let table = parse(path, &text, true)?;
    if table.header.fingerprint != header.fingerprint {
        let (found, expected) = (table.header.fingerprint, header.fingerprint.clone());
        return Err(SweepError::Foreign { path: path.to_owned(), found, expected }.into());
    }
    let points = header.grid.points();
    match table.lines.iter().find(|line| !points.contains(&line.point)) {
        Some(line) => Err(SweepError::Outside { path: path.to_owned(), point: describe(&line.point, header) }.into()),
        None => Ok(table.lines),
    }
}

/// Reads the table at `path`.
pub(super) fn read(path: &Path) -> Result<Table, ProgramError> {
    parse(path, &fs::read_to_string(path).map_err(ProgramError::file("read", path))?, false)
}

fn parse(path: &Path, text: &str, is_output: bool) -> Result<Table, ProgramError> {
    let no_table = |error: super::table::Unreadable| SweepError::NoTable {
        path: path.to_owned(),
        line: error.line,
        expected: error.expected,
        is_output,
    };
    Ok(Table::read(text).map_err(no_table)?)
}

/// Writes a table in one go: what is at `path` is the one before or this one, whole.
pub(super) fn write_table<'a>(
    path: &Path,
    header: &Header,
    lines: impl Iterator<Item = &'a str>,
) -> Result<(), ProgramError> {
    let mut beside = path.as_os_str().to_owned();
    beside.push(".part");
    let beside = PathBuf::from(beside);
    let text = header.text() + &lines.collect::<String>();
    let write = || {
        let mut file = File::create(&beside)?;
        file.write_all(text.as_bytes())?;
        file.sync_all()?;
        fs::rename(&beside, path)
    };
    write().map_err(ProgramError::file("write", path))
}

/// Where a point lies, in words.
pub(super) fn describe(point: &Point, header: &Header) -> String {
    let temperature = point.temperature.map_or_else(String::new, |temperature| format!(", {temperature} K"));
    format!("{} m/s, {} {}{temperature}", point.speed, point.load, header.load.unit())
}
