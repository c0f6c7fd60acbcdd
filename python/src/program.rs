//! The command line program, in this process.

use std::ffi::OsString;
use std::path::PathBuf;

use pyo3::prelude::*;

/// Executes a command line, the program's name first, and returns the exit status. `library` is the shared library that
/// FMUs are packed with where the command line names none.
#[pyfunction]
#[pyo3(signature = (words, library=None))]
pub(crate) fn main(py: Python<'_>, words: Vec<OsString>, library: Option<PathBuf>) -> u8 {
    py.detach(|| asperity_cli::execute(words, library))
}
