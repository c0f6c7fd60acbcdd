//! Why the program stops.

use std::path::Path;

use asperity::element::TableError;
use asperity::scene::ParameterError;
use asperity::simulation::SimulationError;

use super::files::FileError;
use super::result_file::ResultFileError;
use super::sweep::SweepError;

/// Why the program stops; its text is the one line that the user sees.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ProgramError {
    /// A scene or another file is refused.
    #[error(transparent)]
    File(#[from] FileError),
    /// A result file is refused.
    #[error(transparent)]
    Results(#[from] ResultFileError),
    /// The table is refused.
    #[error(transparent)]
    Table(#[from] TableError),
    /// What is to be told cannot be written as JSON.
    #[error("cannot be written as JSON: {0}")]
    Json(serde_json::Error),
    /// There is no run to report on.
    #[error("the scene {0}")]
    NoRun(&'static str),
    /// No run comes to its end, so that there is nothing to compare with.
    #[error("no reference: not even the loosest tolerance comes to its end: {0}")]
    Reference(SimulationError),
    /// A sweep stops, or has points without a result.
    #[error(transparent)]
    Sweep(#[from] SweepError),
    /// A temperature that the scene cannot have.
    #[error("{option}: {refusal}")]
    Temperature { option: &'static str, refusal: ParameterError },
    /// A plot is refused.
    #[error(transparent)]
    Plot(#[from] super::figure::PlotError),
}

impl ProgramError {
    /// The picture at `path` could not be drawn.
    pub(crate) fn picture(path: &Path, error: &dyn std::error::Error) -> Self {
        FileError::picture(path, error).into()
    }

    /// For `map_err`: `action` ("read", "write") on `path` failed.
    pub(crate) fn file(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Self + use<> {
        let error = FileError::io(action, path);
        move |source| error(source).into()
    }
}
