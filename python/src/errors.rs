//! Errors of the library as exceptions of `asperity`.

use std::fmt::Display;
use std::path::Path;

use asperity::patch::{MotionError, PatchError, PatchRestoreError};
use asperity::scene::{ParameterError, SceneError};
use asperity::simulation::SimulationError;
use asperity_study::calibration::{CalibrationError, MeasuredFrictionError};
use asperity_study::converge::ConvergeError;
use asperity_study::fit::FitError;
use asperity_study::rank::RankError;
use asperity_study::surface::SurfaceError;
use asperity_study::{Error, ErrorKind};
use pyo3::exceptions::{PyFileNotFoundError, PyKeyError, PyOSError, PyValueError};
use pyo3::prelude::*;

/// `asperity.SceneError` with file, line and key where they are known.
fn scene_error(message: &dyn Display, file: Option<&Path>, line: Option<usize>, key: &str) -> PyErr {
    let key = Some(key).filter(|key| !key.is_empty());
    Python::attach(|py| {
        let raised = py
            .import("asperity._errors")
            .and_then(|module| module.getattr("SceneError"))
            .and_then(|class| class.call1((message.to_string(), file, line, key)));
        raised.map_or_else(|error| error, PyErr::from_value)
    })
}

/// `asperity.SimulationError`.
fn simulation_error(message: &dyn Display) -> PyErr {
    Python::attach(|py| {
        let class = py.import("asperity._errors").and_then(|module| module.getattr("SimulationError"));
        class.and_then(|class| class.call1((message.to_string(),))).map_or_else(|error| error, PyErr::from_value)
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

impl Raise for SceneError {
    fn raise(self) -> PyErr {
        scene_error(&self, Some(self.file()).filter(|_| !self.is_of_setting()), self.line(), self.key())
    }
}

impl Raise for ParameterError {
    fn raise(self) -> PyErr {
        scene_error(&self, None, None, self.name())
    }
}

impl Raise for PatchError {
    fn raise(self) -> PyErr {
        match self {
            Self::File(error) => error.raise(),
            error => scene_error(&error, None, None, ""),
        }
    }
}

impl Raise for Error {
    fn raise(self) -> PyErr {
        match self.kind() {
            ErrorKind::Scene => scene_error(&self, self.file(), self.line(), self.key().unwrap_or_default()),
            ErrorKind::File(std::io::ErrorKind::NotFound) => PyFileNotFoundError::new_err(self.to_string()),
            ErrorKind::File(_) => PyOSError::new_err(self.to_string()),
            ErrorKind::Run => simulation_error(&self),
            ErrorKind::Value | ErrorKind::Stopped => PyValueError::new_err(self.to_string()),
        }
    }
}

impl Raise for SimulationError {
    fn raise(self) -> PyErr {
        match self {
            Self::Scene(error) => error.raise(),
            Self::OutOfRange(error) => PyValueError::new_err(error.to_string()),
            error => simulation_error(&error),
        }
    }
}

impl Raise for MotionError {
    fn raise(self) -> PyErr {
        match self {
            Self::OutOfRange { .. } => PyValueError::new_err(self.to_string()),
            error => simulation_error(&error),
        }
    }
}

impl Raise for PatchRestoreError {
    fn raise(self) -> PyErr {
        PyValueError::new_err(self.to_string())
    }
}

impl Raise for RankError {
    fn raise(self) -> PyErr {
        match self {
            Self::Read(error) => error.raise(),
            error @ (Self::Sweep { .. } | Self::OtherTemperatures(_) | Self::Uncertainty(_)) => {
                scene_error(&error, None, None, "")
            }
            error => PyValueError::new_err(error.to_string()),
        }
    }
}

impl Raise for ConvergeError {
    fn raise(self) -> PyErr {
        match self {
            Self::Read(error) => error.raise(),
            error => scene_error(&error, None, None, ""),
        }
    }
}

impl Raise for SurfaceError {
    fn raise(self) -> PyErr {
        PyValueError::new_err(self.to_string())
    }
}

impl Raise for FitError {
    fn raise(self) -> PyErr {
        match self {
            Self::Read(error) => error.raise(),
            error => PyValueError::new_err(error.to_string()),
        }
    }
}

impl Raise for CalibrationError {
    fn raise(self) -> PyErr {
        match self {
            Self::Read(error) | Self::Measured(MeasuredFrictionError::Read(error)) => error.raise(),
            error => PyValueError::new_err(error.to_string()),
        }
    }
}
