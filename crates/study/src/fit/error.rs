//! Why no Prony series is fitted.

use std::path::PathBuf;

use asperity::tables::ContentError;

use super::shift_error::ShiftError;
use crate::error::Error;

/// The moduli cannot be read or put together.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum FitError {
    #[error("`weight` {0}: a relaxation has one modulus, which counts alone")]
    Weight(&'static str),
    #[error(transparent)]
    Read(#[from] Error),
    #[error("{}", .error.within(.path))]
    Moduli { path: PathBuf, error: ContentError },
    #[error("{}: {error}", .path.display())]
    Shift { path: PathBuf, error: ShiftError },
    #[error("{}: the workbook cannot be read: {error}", .path.display())]
    Workbook { path: PathBuf, error: Box<asperity_formats::workbook::WorkbookError> },
    #[error("{}: {}", .path.display(), sheets(.found, .expected))]
    Sheets { path: PathBuf, found: Vec<String>, expected: &'static str },
}

fn sheets(found: &[String], expected: &str) -> String {
    format!("sheets {}: expected {expected}", found.join(", "))
}

impl From<FitError> for Error {
    fn from(error: FitError) -> Self {
        match error {
            FitError::Read(error) => error,
            error => Self::value(error),
        }
    }
}
