//! The table of a study: rows are added as their runs are done and not computed again.

use std::path::{Path, PathBuf};

use asperity_study::converge::{Findings, RunRow, RunsDone, StudyHeader, StudyTableError};

use super::ConvergeCommandError;
use crate::files::{FileError, write};
use crate::resumable_table::ResumableTable;
use crate::terminal::warn;

/// A table to which rows are added.
#[derive(Debug)]
pub(super) struct StudyTable<'a> {
    path: PathBuf,
    header: &'a StudyHeader,
    rows: ResumableTable,
}

impl<'a> StudyTable<'a> {
    /// Begins a table or, unless it is to be replaced, continues the one that is there. Returns the runs that it has.
    pub(super) fn open(
        path: &Path,
        header: &'a StudyHeader,
        force: bool,
    ) -> Result<(Self, Vec<RunRow>), ConvergeCommandError> {
        let read = |text: &str| runs_done(text, path, header);
        let (rows, runs) = ResumableTable::open(path, &header.text(None), force, read, |run| run.line(None))?;
        Ok((Self { path: path.to_owned(), header, rows }, runs))
    }

    /// Adds a row; it is in the file when this returns.
    pub(super) fn add(&self, run: &RunRow) -> Result<(), FileError> {
        self.rows.add(&run.line(None))
    }

    /// Writes the whole table with the verdict and the changes of the values, which rows that were added do not have.
    pub(super) fn finish(&self, findings: &Findings) -> Result<(), FileError> {
        let rows: String = findings.changes().iter().map(|(run, change)| run.line(*change)).collect();
        write(&self.path, self.header.text(Some(&findings.verdict.sentence())) + &rows)
    }
}

/// The runs of the table at `path`, which is the `text`, without the corrupt rows, which are named.
fn runs_done(text: &str, path: &Path, header: &StudyHeader) -> Result<Vec<RunRow>, ConvergeCommandError> {
    let RunsDone { runs, corrupt } = header.runs_done(text).map_err(|error| match error {
        StudyTableError::NotATable(problem) => ConvergeCommandError::NotATable { path: path.to_owned(), problem },
        StudyTableError::OtherStudy => ConvergeCommandError::OtherStudy { path: path.to_owned() },
    })?;
    let name = |line: &usize| {
        warn(&format!("{}:{line}: not a row of this study; the run is made again", path.display()));
    };
    corrupt.iter().for_each(name);
    Ok(runs)
}
