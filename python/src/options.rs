//! Options of a command as keyword arguments of Python.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use serde::de::DeserializeOwned;

/// The options that keyword arguments give; what they leave out is as the command has it.
pub(crate) struct Options<T>(pub(crate) T);

impl<T: DeserializeOwned> FromPyObject<'_, '_> for Options<T> {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        let refused = |error: pythonize::PythonizeError| match PyErr::from(error) {
            error if error.is_instance_of::<PyTypeError>(given.py()) => error,
            error => PyValueError::new_err(error.value(given.py()).to_string()),
        };
        pythonize::depythonize(&given).map(Self).map_err(refused)
    }
}
