//! Why a call fails, and with which status.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::element::{ElementError, TableError};
use crate::scene::{LARGEST, ParameterError, SMALLEST, SceneError};
use crate::simulation::SimulationError;

use super::carrier::InputOutOfRange;
use super::catalogue::Kind;
use super::lifecycle::State;
use super::serial::Misfit;

/// The status that a function returns, but for fmi2Pending, which never occurs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Status {
    /// fmi2OK
    Ok,
    /// fmi2Warning
    Warning,
    /// fmi2Discard
    Discard,
    /// fmi2Error
    Error,
    /// fmi2Fatal
    Fatal,
}

/// Why a call fails.
#[derive(Debug, thiserror::Error)]
pub(super) enum Fault {
    #[error("not allowed in the state {0}")]
    OutOfPlace(State),
    #[error("not allowed in the state {0}: no step is asynchronous, so none is ever in progress")]
    NothingToCancel(State),
    #[error("{0} is NULL")]
    Null(&'static str),
    #[error("{0} is not UTF-8")]
    NotText(&'static str),
    #[error("no variable has the value reference {0}")]
    UnknownReference(u32),
    #[error("{name} (value reference {reference}) is of type {actual}, not {asked}")]
    WrongType { reference: u32, name: String, actual: Kind, asked: Kind },
    #[error("{0} is an output and cannot be set")]
    OutputSet(String),
    #[error("{0} is not an input and takes no derivative")]
    NoInput(String),
    #[error("the derivative of {name} is of order {order}; only order 1 is supported")]
    DerivativeOrder { name: String, order: i32 },
    #[error("{0} has no derivative by time; only F_x and F_z have")]
    NoOutputDerivative(String),
    #[error("{0} is no output, whose directional derivative could be asked for")]
    NoUnknown(String),
    #[error("{0} is no input, by which an output could be derived")]
    NoKnown(String),
    #[error("{name} is a fixed parameter and cannot be set in the state {state}: its value stays")]
    Late { name: String, state: State },
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error("{name} is {value}: it has no value here")]
    NoValue { name: String, value: f64 },
    #[error("unknown log category \"{0}\"")]
    UnknownCategory(String),
    #[error("{what} is {value:?}, expected a number up to ±{LARGEST:?}")]
    OutOfRange { what: &'static str, value: f64 },
    #[error("the stop time {stop} s lies before the start time {start} s")]
    StopBeforeStart { start: f64, stop: f64 },
    #[error("the communication step size is {0:?} s, expected 0 or a number from {SMALLEST:?} to {LARGEST:?}")]
    StepSize(f64),
    #[error("the current communication point {given} s is not the time {own} s that the FMU has reached")]
    OtherPoint { given: f64, own: f64 },
    #[error("the step to {end} s goes beyond the stop time {stop} s")]
    BeyondStop { end: f64, stop: f64 },
    #[error(transparent)]
    Input(#[from] InputOutOfRange),
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    #[error("no values: the initialisation failed")]
    NoRun,
    #[error("{0} is no FMU state of this instance")]
    UnknownState(&'static str),
    #[error("the byte string is no FMU state of this FMU: {0}")]
    Serialised(#[from] Misfit),
    #[error("the serialised FMU state has {needed} bytes, but the place for it has {given}")]
    SerialisedSize { needed: usize, given: usize },
    #[error("this status is not available: steps never run asynchronously")]
    NoSuchStatus,
    #[error("the kind of the FMU is not co-simulation, the only one there is")]
    NotCoSimulation,
    #[error("the instance has no name")]
    NoName,
    #[error("the GUID is \"{given}\", but this FMU's is \"{own}\": model description, resources and binary differ")]
    Guid { given: String, own: String },
    #[error("fmuResourceLocation is NULL, expected the URI of the FMU's folder \"resources\"")]
    NoLocation,
    #[error("no file {} in the resources at \"{location}\"; looked in {}", .files.join(" or "), list(.tried))]
    NoResource { location: String, files: &'static [&'static str], tried: Vec<PathBuf> },
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error(transparent)]
    Element(#[from] ElementError),
    #[error("cannot read {path}: {source}", path = .path.display())]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("internal error, the instance is lost: {0}")]
    Panic(String),
}

impl Fault {
    /// The status that tells of the fault. A step is discarded where a smaller one may help.
    pub(super) fn status(&self) -> Status {
        match self {
            Self::Simulation(SimulationError::TooManySteps { .. } | SimulationError::StepTooSmall { .. }) => {
                Status::Discard
            }
            Self::Element(ElementError::Pressure { within: true, .. }) => Status::Discard,
            Self::NoSuchStatus => Status::Discard,
            Self::Panic(_) => Status::Fatal,
            _ => Status::Error,
        }
    }
}

fn list(paths: &[PathBuf]) -> String {
    let quoted: Vec<_> = paths.iter().map(|path| format!("\"{}\"", path.display())).collect();
    quoted.join(", ")
}
