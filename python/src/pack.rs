//! FMUs, written at once.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::{fs, process};

use asperity_fmi::Definition;
use asperity_study::Error;
use asperity_study::pack::{Fmu, FmuOptions, Library, LibraryFile, summary, warnings};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors::Raise as _;
use crate::options::Options;

/// Writes the FMU of a `definition`, which was read from the file at `path`, with these shared libraries, each as
/// `asperity pack --library` takes it; returns warnings. What is at `output` is what was there before, or the whole FMU.
pub(crate) fn pack(
    definition: &Definition,
    path: &Path,
    libraries: &[OsString],
    (output, Options(options)): (&Path, Options<FmuOptions>),
) -> PyResult<Vec<String>> {
    let files: Vec<LibraryFile> = libraries.iter().map(|text| LibraryFile::named(text)).collect();
    let mut read: Vec<PathBuf> = definition.sources(path);
    read.extend(files.iter().map(|file| file.path().to_owned()));
    let place = output.canonicalize().ok();
    if place.is_some() && read.iter().any(|file| file.canonicalize().ok() == place) {
        return Err(PyValueError::new_err(format!("will not write {}: it is read here", output.display())));
    }
    let libraries = Library::read_all(&files).map_err(|error| error.raise())?;
    let summary = summary(definition);
    let (libraries, summary) = (&libraries, &summary);
    let fmu = Fmu { definition, path, libraries, summary, picture: None, options };
    let (archive, left_out) = fmu.pack().map_err(|error| error.raise())?;
    write(output, &archive)?;
    Ok(warnings(definition, path).into_iter().chain(left_out).collect())
}

/// Writes a file beside its place, and puts it there.
fn write(output: &Path, bytes: &[u8]) -> PyResult<()> {
    let name = output.file_name().unwrap_or_default().to_string_lossy();
    let draft = output.with_file_name(format!(".{name}.{}", process::id()));
    let written = fs::write(&draft, bytes).and_then(|()| fs::rename(&draft, output));
    written.inspect_err(|_| drop(fs::remove_file(&draft))).map_err(Error::io("write", output)).map_err(Error::raise)
}
