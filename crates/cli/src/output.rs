//! Exit statuses, names of files in messages, and what goes wrong with them.

use std::fs;
use std::io;
use std::path::Path;

use asperity_study::Error;

/// Exit status of a command that did what was asked for.
pub(crate) const SUCCESS: u8 = 0;
/// Exit status of one that did not.
pub(crate) const FAILURE: u8 = 1;
/// Exit status of one whose result is written and is to be looked at: it did not converge, or an error is larger than
/// asked for.
pub(crate) const NOT_REACHED: u8 = 3;
/// Exit status of one whose results nobody reads any more: 128 and the number of SIGPIPE.
pub(crate) const BROKEN_PIPE: u8 = 141;

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
pub(crate) fn is_broken_pipe(error: &(dyn std::error::Error + 'static)) -> bool {
    let is_one = |error: &io::Error| error.kind() == io::ErrorKind::BrokenPipe;
    std::iter::successors(Some(error), |error| error.source()).any(|error| error.downcast_ref().is_some_and(is_one))
}

/// An output's name in messages.
pub(crate) fn named(path: &Path) -> String {
    if is_standard_output(path) { "standard output".into() } else { path.display().to_string() }
}

/// For `map_err`: an output cannot be written.
pub(crate) fn unwritten(path: &Path) -> impl FnOnce(io::Error) -> Error + use<> {
    Error::io("write", Path::new(&named(path)))
}

/// An output would take the place of another file that is read or written.
pub(crate) fn overwrites(path: &Path) -> Error {
    Error::value(format!("will not write {}: it is read or written here already", named(path)))
}

/// A picture cannot be drawn.
pub(crate) fn not_drawn(path: &Path, error: impl std::fmt::Display) -> Error {
    Error::value(format!("cannot draw {}: {error}", path.display()))
}

/// An error of what was read with keys set: of a key that is in no file `--set` is named.
pub(crate) fn of_set(error: impl Into<Error>) -> Error {
    let error = error.into();
    if error.file().is_none() && error.key().is_some() { error.context("--set") } else { error }
}
