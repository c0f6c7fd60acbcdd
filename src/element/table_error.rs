//! Why a table is refused.

use std::path::{Path, PathBuf};

/// Why a table is refused: where, what was expected and what was found.
///
/// It reads like `table.csv:12: speed [m/s] = "fast": expected a number above 0`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}{}: {problem}", file.display(), line.map_or_else(String::new, |line| format!(":{line}")))]
pub struct TableError {
    file: PathBuf,
    pub(super) line: Option<usize>,
    problem: String,
}

impl TableError {
    pub(super) fn new(file: &Path, line: Option<usize>, problem: String) -> Self {
        Self { file: file.to_owned(), line, problem }
    }
}
