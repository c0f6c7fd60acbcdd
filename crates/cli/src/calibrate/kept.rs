//! The table beside a calibration's output, to which points are added as they are found.

use std::path::{Path, PathBuf};

use asperity_study::calibration::points_table::{DamagedLine, head, line, read};
use asperity_study::calibration::{FreeScene, Outcome, Task};

use super::CalibrateError;
use crate::files::FileError;
use crate::resumable_table::ResumableTable;
use crate::terminal::warn;

/// A table to which points are added.
#[derive(Debug)]
pub(super) struct KeptPoints(ResumableTable);

impl KeptPoints {
    /// Begins a table or, unless it is to be replaced, continues the one that is there; and the points that it has.
    pub(super) fn open(
        path: &Path,
        fingerprint: &str,
        free: &FreeScene<'_>,
        replace: bool,
    ) -> Result<(Self, Vec<(Task, Outcome)>), CalibrateError> {
        let head = head(fingerprint, free.parameters());
        let read = |text: &str| -> Result<_, CalibrateError> {
            let other = || CalibrateError::OtherCalibration { path: PathBuf::from(path) };
            let points = read(text, &head, free.parameters().len()).ok_or_else(other)?;
            Ok(points.into_iter().filter_map(|point| point.map_err(|line| damaged(path, line)).ok()).collect())
        };
        let (table, known) = ResumableTable::open(path, &head, replace, read, |(task, outcome)| line(task, outcome))?;
        Ok((Self(table), known))
    }

    /// Adds a point; it is in the file when this returns.
    pub(super) fn add(&self, task: &Task, outcome: &Outcome) -> Result<(), FileError> {
        self.0.add(&line(task, outcome))
    }
}

fn damaged(path: &Path, DamagedLine(number): DamagedLine) {
    warn(&format!("{}:{number}: the row is damaged; its point is found again", path.display()));
}
