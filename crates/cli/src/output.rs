//! Names of files in messages, and what goes wrong with them.

use std::error::Error;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use asperity_study::files::{ReadError, reason};
use asperity_study::settings::OverrideError;

/// What stands for standard output as the name of an output.
pub(crate) const STANDARD_OUTPUT: &str = "-";

/// Whether an output goes to standard output.
pub(crate) fn is_standard_output(path: &Path) -> bool {
    [STANDARD_OUTPUT, "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"].iter().any(|name| path == Path::new(name))
}

/// Whether an output is a pipe or a device, beside which no file belongs.
pub(crate) fn is_stream(path: &Path) -> bool {
    is_standard_output(path) || fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

/// Whether an error, or what caused it, is that nobody reads the output.
pub(crate) fn is_broken_pipe(error: &(dyn Error + 'static)) -> bool {
    let mut next = Some(error);
    while let Some(error) = next {
        let of_file = match error.downcast_ref::<FileError>() {
            Some(FileError::Io { source, .. }) => Some(source),
            _ => error.downcast_ref::<io::Error>(),
        };
        if of_file.is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe) {
            return true;
        }
        next = error.source();
    }
    false
}

/// An output's name in messages.
pub(crate) fn named(path: &Path) -> String {
    if is_standard_output(path) { "standard output".into() } else { path.display().to_string() }
}

/// A file cannot be read or written, or its scene is invalid.
#[derive(Debug, thiserror::Error)]
pub(crate) enum FileError {
    #[error(transparent)]
    Read(ReadError),
    #[error("--set: {0}")]
    Set(OverrideError),
    #[error("cannot {action} {}: {}", named(.path), reason(.path, .source))]
    Io { action: &'static str, path: PathBuf, source: io::Error },
    #[error("will not write {}: it is read or written here already", named(.path))]
    Overwrites { path: PathBuf },
    #[error("cannot write {}: {holder} writes it; wait for that, or name another -o", .path.display())]
    Locked { path: PathBuf, holder: String },
    #[error("cannot draw {}: {message}", .path.display())]
    Picture { path: PathBuf, message: String },
}

impl FileError {
    /// For `map_err`: `action` ("read", "write") on `path` failed.
    pub(crate) fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |source| Self::Io { action, path, source }
    }

    pub(crate) fn picture(path: &Path, error: &dyn std::error::Error) -> Self {
        Self::Picture { path: path.to_owned(), message: error.to_string() }
    }
}

impl<E: Into<ReadError>> From<E> for FileError {
    fn from(error: E) -> Self {
        match error.into() {
            ReadError::Set(error) => Self::Set(error),
            error => Self::Read(error),
        }
    }
}
