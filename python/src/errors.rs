//! Errors of the library as exceptions of `asperity`.

use std::io;

use asperity_study::{Error, ErrorKind};
use pyo3::call::PyCallArgs;
use pyo3::exceptions::{PyFileNotFoundError, PyKeyError, PyOSError, PyValueError};
use pyo3::prelude::*;

/// An exception of a class of `asperity`.
fn own(class: &str, arguments: impl for<'py> PyCallArgs<'py>) -> PyErr {
    Python::attach(|py| {
        let class = py.import("asperity._errors").and_then(|module| module.getattr(class));
        class.and_then(|class| class.call1(arguments)).map_or_else(|error| error, PyErr::from_value)
    })
}

/// A `KeyError`: the outputs of a scene or a patch are `known`, none has this name.
pub(crate) fn no_output<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> PyErr {
    let known = known.collect::<Vec<_>>().join(", ");
    PyKeyError::new_err(format!("{name}: expected one of {known}; fmu.outputs of the file says which there are"))
}

/// Refuses a duration of a motion (s) that is not above 0.
pub(crate) fn check_dt(dt: f64) -> PyResult<()> {
    if dt > 0.0 { Ok(()) } else { Err(PyValueError::new_err(format!("dt = {dt}: expected a number above 0, in s"))) }
}

/// An error of the library as an exception.
pub(crate) trait Raise {
    /// The exception.
    fn raise(self) -> PyErr;
}

impl<E: Into<Error>> Raise for E {
    fn raise(self) -> PyErr {
        let error: Error = self.into();
        let message = error.to_string();
        match error.kind() {
            ErrorKind::Scene => own("SceneError", (message, error.file(), error.line(), error.key())),
            ErrorKind::File(io::ErrorKind::NotFound) => PyFileNotFoundError::new_err(message),
            ErrorKind::File(_) => PyOSError::new_err(message),
            ErrorKind::Run => own("SimulationError", (message,)),
            ErrorKind::Value | ErrorKind::Stopped => PyValueError::new_err(message),
        }
    }
}
