//! What may be called when: the state table of FMI 2.0.4, section 4.2.4, as data.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::fault::Fault;

/// The states of a co-simulation slave that this FMU can be in. Steps never run asynchronously, so the standard's
/// stepInProgress and stepCanceled are never reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum State {
    /// After fmi2Instantiate and fmi2Reset.
    Instantiated,
    /// Between fmi2EnterInitializationMode and fmi2ExitInitializationMode.
    InitializationMode,
    /// Initialised, and after a step that succeeded.
    StepComplete,
    /// After a step that was discarded.
    StepFailed,
    /// After fmi2Terminate.
    Terminated,
    /// After an error in a step or at the end of the initialisation.
    Error,
    /// After a panic: the instance is poisoned.
    Fatal,
}

impl State {
    /// The standard's name.
    fn name(self) -> &'static str {
        match self {
            Self::Instantiated => "instantiated",
            Self::InitializationMode => "initializationMode",
            Self::StepComplete => "stepComplete",
            Self::StepFailed => "stepFailed",
            Self::Terminated => "terminated",
            Self::Error => "error",
            Self::Fatal => "fatal",
        }
    }

    /// Whether parameters may still be set.
    pub(super) fn before_run(self) -> bool {
        matches!(self, Self::Instantiated | Self::InitializationMode)
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The functions that take an instance, in the order of [`TABLE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    SetDebugLogging,
    FreeInstance,
    SetupExperiment,
    EnterInitializationMode,
    ExitInitializationMode,
    Terminate,
    Reset,
    GetReal,
    GetInteger,
    GetBoolean,
    GetString,
    SetReal,
    SetInteger,
    SetBoolean,
    SetString,
    GetFmuState,
    SetFmuState,
    FreeFmuState,
    SerializedFmuStateSize,
    SerializeFmuState,
    DeSerializeFmuState,
    GetDirectionalDerivative,
    SetRealInputDerivatives,
    GetRealOutputDerivatives,
    DoStep,
    CancelStep,
    GetStatus,
    GetRealStatus,
    GetIntegerStatus,
    GetBooleanStatus,
    GetStringStatus,
}

impl Function {
    /// Refuses a call that is out of place.
    pub(super) fn check(self, state: State) -> Result<(), Fault> {
        match (self, self.row().2.contains(&state)) {
            (_, true) => Ok(()),
            (Self::CancelStep, false) => Err(Fault::NothingToCancel(state)),
            (_, false) => Err(Fault::OutOfPlace(state)),
        }
    }

    fn row(self) -> &'static Row {
        &TABLE[self as usize]
    }
}

impl fmt::Display for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.row().1)
    }
}

/// A function, its name and the states in which it may be called.
type Row = (Function, &'static str, &'static [State]);

/// Every state, fatal as an addition to the standard's table: a poisoned instance can be freed, as no memory is
/// corrupt.
const EVERY: &[State] = {
    use State::{Error, Fatal, InitializationMode, Instantiated, StepComplete, StepFailed, Terminated};
    &[Instantiated, InitializationMode, StepComplete, StepFailed, Terminated, Error, Fatal]
};

/// Every state but fatal.
const ALIVE: &[State] = {
    use State::{Error, InitializationMode, Instantiated, StepComplete, StepFailed, Terminated};
    &[Instantiated, InitializationMode, StepComplete, StepFailed, Terminated, Error]
};

/// Outputs are there: the results of an error state serve for debugging only.
const READABLE: &[State] = {
    use State::{Error, InitializationMode, StepComplete, StepFailed, Terminated};
    &[InitializationMode, StepComplete, StepFailed, Terminated, Error]
};

/// Inputs are taken. stepFailed is an addition to the standard's table: a discarded step left everything as it was, so
/// a master without rollback may try a smaller one, with other inputs.
const WRITABLE: &[State] = {
    use State::{InitializationMode, Instantiated, StepComplete, StepFailed};
    &[Instantiated, InitializationMode, StepComplete, StepFailed]
};

/// A step has been possible.
const STEPPED: &[State] = &[State::StepComplete, State::StepFailed, State::Terminated];

/// The table, one row a function, in the order of [`Function`].
#[rustfmt::skip]
const TABLE: [Row; 31] = {
    use State::{Error, InitializationMode, Instantiated, StepComplete, StepFailed, Terminated};
    [
        (Function::SetDebugLogging, "fmi2SetDebugLogging", ALIVE),
        (Function::FreeInstance, "fmi2FreeInstance", EVERY),
        (Function::SetupExperiment, "fmi2SetupExperiment", &[Instantiated]),
        (Function::EnterInitializationMode, "fmi2EnterInitializationMode", &[Instantiated]),
        (Function::ExitInitializationMode, "fmi2ExitInitializationMode", &[InitializationMode]),
        (Function::Terminate, "fmi2Terminate", &[StepComplete, StepFailed]),
        (Function::Reset, "fmi2Reset", ALIVE),
        (Function::GetReal, "fmi2GetReal", READABLE),
        (Function::GetInteger, "fmi2GetInteger", READABLE),
        (Function::GetBoolean, "fmi2GetBoolean", READABLE),
        (Function::GetString, "fmi2GetString", READABLE),
        (Function::SetReal, "fmi2SetReal", WRITABLE),
        (Function::SetInteger, "fmi2SetInteger", WRITABLE),
        (Function::SetBoolean, "fmi2SetBoolean", WRITABLE),
        (Function::SetString, "fmi2SetString", WRITABLE),
        (Function::GetFmuState, "fmi2GetFMUstate", ALIVE),
        (Function::SetFmuState, "fmi2SetFMUstate", ALIVE),
        (Function::FreeFmuState, "fmi2FreeFMUstate", ALIVE),
        (Function::SerializedFmuStateSize, "fmi2SerializedFMUstateSize", ALIVE),
        (Function::SerializeFmuState, "fmi2SerializeFMUstate", ALIVE),
        (Function::DeSerializeFmuState, "fmi2DeSerializeFMUstate", ALIVE),
        (Function::GetDirectionalDerivative, "fmi2GetDirectionalDerivative", READABLE),
        (Function::SetRealInputDerivatives, "fmi2SetRealInputDerivatives", WRITABLE),
        (Function::GetRealOutputDerivatives, "fmi2GetRealOutputDerivatives",
            &[StepComplete, StepFailed, Terminated, Error]),
        (Function::DoStep, "fmi2DoStep", &[StepComplete, StepFailed]),
        (Function::CancelStep, "fmi2CancelStep", &[]),
        (Function::GetStatus, "fmi2GetStatus", STEPPED),
        (Function::GetRealStatus, "fmi2GetRealStatus", STEPPED),
        (Function::GetIntegerStatus, "fmi2GetIntegerStatus", STEPPED),
        (Function::GetBooleanStatus, "fmi2GetBooleanStatus", STEPPED),
        (Function::GetStringStatus, "fmi2GetStringStatus", STEPPED),
    ]
};

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn every_row_stands_in_its_functions_place() {
        for (place, row) in TABLE.iter().enumerate() {
            assert_eq!(row.0 as usize, place, "{}", row.1);
        }
    }

    #[test]
    fn a_call_out_of_place_names_the_function_and_the_state() {
        let fault = Function::DoStep.check(State::Instantiated).unwrap_err();
        assert_eq!(format!("{}: {fault}", Function::DoStep), "fmi2DoStep: not allowed in the state instantiated");
    }

    #[test]
    fn after_a_discard_inputs_and_steps_are_accepted() {
        for function in [Function::SetReal, Function::SetRealInputDerivatives, Function::DoStep] {
            assert!(function.check(State::StepFailed).is_ok());
            assert!(function.check(State::Error).is_err());
        }
    }

    #[test]
    fn a_poisoned_instance_can_be_freed_and_nothing_else() {
        let allowed: Vec<_> = TABLE.iter().filter(|row| row.0.check(State::Fatal).is_ok()).map(|row| row.0).collect();
        assert_eq!(allowed, [Function::FreeInstance]);
    }

    #[test]
    fn no_step_can_be_cancelled_as_none_runs_asynchronously() {
        let fault = Function::CancelStep.check(State::StepComplete).unwrap_err().to_string();
        assert!(fault.contains("stepComplete") && fault.contains("asynchronous"), "{fault}");
    }
}
