//! States of runs as bytes, for pickle and copy.

use pyo3::PyClass;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// The class of a state and what it is made of anew.
pub(crate) type Reduced<'py> = (Bound<'py, PyAny>, (Bound<'py, PyBytes>,));

/// Reads a state of `what`.
pub(crate) fn read<T: DeserializeOwned>(bytes: &[u8], what: &str) -> PyResult<T> {
    postcard::from_bytes(bytes).map_err(|error| PyValueError::new_err(format!("not a state of {what}: {error}")))
}

/// What `__reduce__` of the object `of` a `state` returns.
pub(crate) fn reduced<'py, C: PyClass>(of: &Bound<'py, C>, state: &impl Serialize) -> PyResult<Reduced<'py>> {
    let bytes = postcard::to_stdvec(state).map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    Ok((of.as_any().get_type().into_any(), (PyBytes::new(of.py(), &bytes),)))
}

/// A class of Python for all that changes in a run of `$what`: made of bytes, pickled, copied and compared.
macro_rules! state_class {
    ($name:ident, $state:ty, $what:literal) => {
        /// All that changes in a run.
        #[pyclass(frozen, module = "asperity._native")]
        #[derive(Debug)]
        pub(crate) struct $name(pub(crate) $state);

        #[pymethods]
        impl $name {
            #[new]
            fn new(bytes: &[u8]) -> PyResult<Self> {
                Ok(Self($crate::state::read(bytes, $what)?))
            }

            /// For pickle and copy.
            fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<$crate::state::Reduced<'py>> {
                $crate::state::reduced(slf, &slf.get().0)
            }

            fn __eq__(&self, other: &Self) -> bool {
                self.0 == other.0
            }
        }
    };
}
pub(crate) use state_class;
