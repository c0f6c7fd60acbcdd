//! Why the program stops.

use std::path::Path;

use asperity::simulation::SimulationError;

use super::files::FileError;
use super::result_file::ResultFileError;

/// Why the program stops; its text is the one line that the user sees.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ProgramError {
    /// A scene or another file is refused.
    #[error(transparent)]
    File(#[from] FileError),
    /// A result file is refused.
    #[error(transparent)]
    Results(#[from] ResultFileError),
    /// There is no run to report on.
    #[error("the scene {0}")]
    NoRun(&'static str),
    /// No run comes to its end, so that there is nothing to compare with.
    #[error("no reference: not even the loosest tolerance comes to its end: {0}")]
    Reference(SimulationError),
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
