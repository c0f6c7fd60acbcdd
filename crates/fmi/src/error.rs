//! Errors of the FMU and the status that each returns; panics and memory that the system would refuse, which become errors,
//! too.

use std::any::Any;
use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::path::PathBuf;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use asperity::element::{self, ElementError};
use asperity::math::can_allocate;
use asperity::patch::{self, MotionError, PatchError};
use asperity::scene::{LARGEST, ParameterError, SMALLEST, SceneError};
use asperity::seal::{FilmError, FilmRestoreError, SealError};
use asperity::simulation::{self, SimulationError};
use asperity::table::TableError;

use super::lifecycle::{Function, LifecycleState};

/// The status that a function returns; fmi2Pending never occurs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Status {
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

#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("not allowed in the state {0}")]
    NotAllowed(LifecycleState),
    #[error("not allowed in the state {0}: no step is asynchronous, so none is ever in progress")]
    NothingToCancel(LifecycleState),
    #[error("{0} is NULL")]
    Null(&'static str),
    #[error("{0} is not UTF-8")]
    NotText(&'static str),
    #[error("no variable has the value reference {0}")]
    UnknownReference(u32),
    #[error("{name} (value reference {reference}) is of type {actual}, not {asked}")]
    WrongType { reference: u32, name: String, actual: String, asked: String },
    #[error("{0} is an output and cannot be set")]
    OutputSet(String),
    #[error("{0} is not an input and takes no derivative")]
    NoInput(String),
    #[error("the derivative of {name} is of order {order}; only order 1 is supported")]
    DerivativeOrder { name: String, order: i32 },
    #[error("{0} has no derivative by time; only the forces have")]
    NoOutputDerivative(String),
    #[error("{0} is not an output; directional derivatives exist only for outputs")]
    NoUnknown(String),
    #[error("{0} is not an input; derivatives exist only with respect to the inputs")]
    NoKnown(String),
    #[error("{name} is a fixed parameter and cannot be set in the state {state}: its value stays")]
    Late { name: String, state: LifecycleState },
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error("{name} evaluates to {value} in this state")]
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
    #[error(
        "the input {name} goes to {value:?} m, where rounding is coarser than the profile; expected up to ±{farthest:?} m"
    )]
    TooFar { name: &'static str, value: f64, farthest: f64 },
    #[error(
        "the step of {h} s from t = {time} s, whose inputs were extrapolated, cannot be done again to the values that came: {source}"
    )]
    Repetition { time: f64, h: f64, source: Box<Error> },
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    #[error("no values: the initialisation failed")]
    NoRun,
    #[error("{0} is not an FMU state of this instance")]
    UnknownState(&'static str),
    #[error("the byte string is not an FMU state of this FMU: {0}")]
    Serialised(#[from] RestoreError),
    #[error("the serialised FMU state has {needed} bytes, but its buffer has {given}")]
    SerialisedSize { needed: usize, given: usize },
    #[error("this status is not available: steps never run asynchronously")]
    NoSuchStatus,
    #[error("the kind of the FMU is not co-simulation, the only one there is")]
    NotCoSimulation,
    #[error("the GUID is \"{given}\", but this FMU's is \"{own}\": model description, resources and binary differ")]
    Guid { given: String, own: String },
    #[error("no file {} in the resources at \"{location}\"; looked in {}", .files.join(" or "), list(.tried))]
    NoResource { location: String, files: &'static [&'static str], tried: Vec<PathBuf> },
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Table(#[from] TableError),
    #[error(transparent)]
    Element(#[from] ElementError),
    #[error(transparent)]
    Patch(#[from] PatchError),
    #[error(transparent)]
    Motion(#[from] MotionError),
    #[error(transparent)]
    Seal(#[from] SealError),
    #[error(transparent)]
    Film(#[from] FilmError),
    #[error("cannot read {path}: {source}", path = .path.display())]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("{what} needs {mebibytes} MiB of memory, more than the system has for it")]
    Memory { what: &'static str, mebibytes: usize },
    #[error("internal error, the instance is lost: {0}")]
    Panic(String),
}

impl Error {
    /// The error of calling `function` in a `state` that does not allow it.
    pub(super) fn not_allowed(function: Function, state: LifecycleState) -> Self {
        if function == Function::CancelStep { Self::NothingToCancel(state) } else { Self::NotAllowed(state) }
    }

    /// The status to return. A step is discarded where a smaller one may succeed.
    pub(super) fn status(&self) -> Status {
        match self {
            Self::Simulation(
                SimulationError::TooManySteps { .. }
                | SimulationError::TooMuchWork { .. }
                | SimulationError::StepTooSmall { .. }
                | SimulationError::Folded { .. },
            ) => Status::Discard,
            Self::Element(ElementError::Pressure { within: true, .. }) => Status::Discard,
            Self::Motion(
                MotionError::TooManySubsteps { .. }
                | MotionError::TooMuchWork { .. }
                | MotionError::BeyondTable { within: true, .. }
                | MotionError::ElementTooWarm { within: true, .. },
            ) => Status::Discard,
            Self::Film(
                FilmError::TooMuchWork { .. }
                | FilmError::BlownOpen { within: true, .. }
                | FilmError::Beyond { within: true, .. },
            ) => Status::Discard,
            Self::TooFar { .. } | Self::NoSuchStatus | Self::Repetition { .. } => Status::Discard,
            Self::Panic(_) => Status::Fatal,
            _ => Status::Error,
        }
    }
}

/// Why a byte string cannot be restored as an FMU state.
#[derive(Debug, thiserror::Error)]
pub enum RestoreError {
    #[error("it does not begin like one, or is cut short")]
    Mark,
    #[error("its format is {found}, expected {expected}")]
    Format { found: u32, expected: u32 },
    #[error("it is of another scene or another version")]
    Guid,
    #[error("it is cut short or has changed")]
    Changed,
    #[error("{0}")]
    Content(#[from] postcard::Error),
    #[error("it has the parameter {0}, which the FMU does not have")]
    NoParameter(String),
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error(transparent)]
    Simulation(#[from] simulation::SimulationRestoreError),
    #[error(transparent)]
    Element(#[from] element::ElementRestoreError),
    #[error(transparent)]
    Patch(#[from] patch::PatchRestoreError),
    #[error(transparent)]
    Seal(#[from] FilmRestoreError),
    #[error("{0}")]
    Invalid(&'static str),
}

impl RestoreError {
    /// The state is of a run of another kind of model.
    pub(super) const OTHER_MODEL: Self = Self::Invalid("its run is of something else");
}

/// An input is not a number or larger than [`LARGEST`], or its derivative leads to such a value.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the input {name} is {value:?} at t = {time} s, which is out of range; the step was not done")]
pub struct InputOutOfRange {
    /// The input's name.
    pub name: &'static str,
    /// Its value, or the value that it would reach.
    pub value: f64,
    /// The time of the step, s.
    pub time: f64,
}

fn list(paths: &[PathBuf]) -> String {
    let quoted: Vec<_> = paths.iter().map(|path| format!("\"{}\"", path.display())).collect();
    quoted.join(", ")
}

/// What stays free for all that is not reckoned, such as messages.
const SPARE: usize = 1 << 18;

/// Whether the system has so many bytes for `what` at once: what a call needs is reckoned and asked for before it is used,
/// since Rust ends the process where an allocation fails.
///
/// # Errors
/// [`Error::Memory`].
pub(super) fn check_memory(what: &'static str, bytes: usize) -> Result<(), Error> {
    if can_allocate(bytes.saturating_add(SPARE)) {
        return Ok(());
    }
    Err(Error::Memory { what, mebibytes: bytes.div_ceil(1 << 20) })
}

type Hook = Box<dyn Fn(&PanicHookInfo<'_>) + Send + Sync>;

thread_local! {
    /// Whether this thread is inside a guarded call.
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// Calls `body`. A panic in it is returned as its message, and nothing is written to stderr.
pub(super) fn catch_panic<T>(body: impl FnOnce() -> T) -> Result<T, String> {
    USUAL.get_or_init(silence_guarded_calls);
    let before = GUARDED.replace(true);
    let result = panic::catch_unwind(AssertUnwindSafe(body));
    GUARDED.set(before);
    result.map_err(|payload| message(payload.as_ref()))
}

/// The hook for panics outside of guarded calls, such as those of the program's other threads. It is kept here and not
/// in the new hook, which therefore needs no memory: that would leak when the library is unloaded.
static USUAL: OnceLock<Hook> = OnceLock::new();

/// Installs the new hook and returns the one before.
fn silence_guarded_calls() -> Hook {
    let usual = panic::take_hook();
    panic::set_hook(Box::new(|panic| match USUAL.get() {
        Some(usual) if !GUARDED.get() => usual(panic),
        _ => (),
    }));
    usual
}

fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("a panic without a message").to_owned()
}

#[cfg(test)]
#[allow(clippy::panic)]
mod tests {
    use super::*;

    #[test]
    fn a_call_not_allowed_names_the_state() {
        let error = Error::not_allowed(Function::DoStep, LifecycleState::Instantiated);
        assert_eq!(error.to_string(), "not allowed in the state instantiated");
        let error = Error::not_allowed(Function::CancelStep, LifecycleState::StepComplete).to_string();
        assert!(error.contains("stepComplete") && error.contains("asynchronous"), "{error}");
    }

    #[test]
    fn a_panic_becomes_its_message() {
        assert_eq!(catch_panic(|| 1), Ok(1));
        assert_eq!(catch_panic(|| panic!("plain")), Err::<(), _>("plain".into()));
        assert_eq!(catch_panic(|| panic!("number {}", 7)), Err::<(), _>("number 7".into()));
    }

    #[test]
    fn what_no_system_has_is_refused() {
        assert!(check_memory("a run", 1 << 20).is_ok());
        let error = check_memory("a run", 1 << 60).unwrap_err().to_string();
        assert_eq!(error, "a run needs 1099511627776 MiB of memory, more than the system has for it");
        assert!(check_memory("a run", usize::MAX).is_err());
    }
}
