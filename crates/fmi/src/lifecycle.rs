//! The life cycle of an instance: which function may be called in which state, by the table of FMI 2.0.4, section
//! 4.2.4.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The states of a co-simulation slave that this FMU can be in. Steps never run asynchronously, so the standard's
/// stepInProgress and stepCanceled are never reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum LifecycleState {
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
    /// After a panic: the instance can only be freed.
    Fatal,
}

impl LifecycleState {
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

impl fmt::Display for LifecycleState {
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
    /// Whether the function may be called in `state`.
    pub(super) fn is_allowed(self, state: LifecycleState) -> bool {
        self.rule().states.contains(&state)
    }

    fn rule(self) -> &'static Rule {
        &TABLE[self as usize]
    }
}

impl fmt::Display for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.rule().name)
    }
}

struct Rule {
    function: Function,
    name: &'static str,
    /// The states in which the function may be called.
    states: &'static [LifecycleState],
}

const fn rule(function: Function, name: &'static str, states: &'static [LifecycleState]) -> Rule {
    Rule { function, name, states }
}

/// Every state. Fatal is an addition to the standard's table: an instance can be freed after a panic, since its memory
/// is intact.
const EVERY: &[LifecycleState] = {
    use LifecycleState::{Error, Fatal, InitializationMode, Instantiated, StepComplete, StepFailed, Terminated};
    &[Instantiated, InitializationMode, StepComplete, StepFailed, Terminated, Error, Fatal]
};

const ALIVE: &[LifecycleState] = {
    use LifecycleState::{Error, InitializationMode, Instantiated, StepComplete, StepFailed, Terminated};
    &[Instantiated, InitializationMode, StepComplete, StepFailed, Terminated, Error]
};

/// States in which outputs can be read; in the error state for debugging only.
const READABLE: &[LifecycleState] = {
    use LifecycleState::{Error, InitializationMode, StepComplete, StepFailed, Terminated};
    &[InitializationMode, StepComplete, StepFailed, Terminated, Error]
};

/// States in which inputs can be set. stepFailed is an addition to the standard's table: a discarded step left
/// everything as it was, so a master without rollback may try a smaller step with other inputs.
const WRITABLE: &[LifecycleState] = {
    use LifecycleState::{InitializationMode, Instantiated, StepComplete, StepFailed};
    &[Instantiated, InitializationMode, StepComplete, StepFailed]
};

/// States after a step was possible.
const STEPPED: &[LifecycleState] =
    &[LifecycleState::StepComplete, LifecycleState::StepFailed, LifecycleState::Terminated];

/// The table: one row per function, in the order of [`Function`].
#[rustfmt::skip]
const TABLE: [Rule; 31] = {
    use LifecycleState::{Error, InitializationMode, Instantiated, StepComplete, StepFailed, Terminated};
    [
        rule(Function::SetDebugLogging, "fmi2SetDebugLogging", ALIVE),
        rule(Function::FreeInstance, "fmi2FreeInstance", EVERY),
        rule(Function::SetupExperiment, "fmi2SetupExperiment", &[Instantiated]),
        rule(Function::EnterInitializationMode, "fmi2EnterInitializationMode", &[Instantiated]),
        rule(Function::ExitInitializationMode, "fmi2ExitInitializationMode", &[InitializationMode]),
        rule(Function::Terminate, "fmi2Terminate", &[StepComplete, StepFailed]),
        rule(Function::Reset, "fmi2Reset", ALIVE),
        rule(Function::GetReal, "fmi2GetReal", READABLE),
        rule(Function::GetInteger, "fmi2GetInteger", READABLE),
        rule(Function::GetBoolean, "fmi2GetBoolean", READABLE),
        rule(Function::GetString, "fmi2GetString", READABLE),
        rule(Function::SetReal, "fmi2SetReal", WRITABLE),
        rule(Function::SetInteger, "fmi2SetInteger", WRITABLE),
        rule(Function::SetBoolean, "fmi2SetBoolean", WRITABLE),
        rule(Function::SetString, "fmi2SetString", WRITABLE),
        rule(Function::GetFmuState, "fmi2GetFMUstate", ALIVE),
        rule(Function::SetFmuState, "fmi2SetFMUstate", ALIVE),
        rule(Function::FreeFmuState, "fmi2FreeFMUstate", ALIVE),
        rule(Function::SerializedFmuStateSize, "fmi2SerializedFMUstateSize", ALIVE),
        rule(Function::SerializeFmuState, "fmi2SerializeFMUstate", ALIVE),
        rule(Function::DeSerializeFmuState, "fmi2DeSerializeFMUstate", ALIVE),
        rule(Function::GetDirectionalDerivative, "fmi2GetDirectionalDerivative", READABLE),
        rule(Function::SetRealInputDerivatives, "fmi2SetRealInputDerivatives", WRITABLE),
        rule(Function::GetRealOutputDerivatives, "fmi2GetRealOutputDerivatives",
            &[StepComplete, StepFailed, Terminated, Error]),
        rule(Function::DoStep, "fmi2DoStep", &[StepComplete, StepFailed]),
        rule(Function::CancelStep, "fmi2CancelStep", &[]),
        rule(Function::GetStatus, "fmi2GetStatus", STEPPED),
        rule(Function::GetRealStatus, "fmi2GetRealStatus", STEPPED),
        rule(Function::GetIntegerStatus, "fmi2GetIntegerStatus", STEPPED),
        rule(Function::GetBooleanStatus, "fmi2GetBooleanStatus", STEPPED),
        rule(Function::GetStringStatus, "fmi2GetStringStatus", STEPPED),
    ]
};

const _: () = {
    let mut index = 0;
    while index < TABLE.len() {
        assert!(TABLE[index].function as usize == index, "rows are in the order of functions");
        index += 1;
    }
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn after_a_discard_inputs_and_steps_are_accepted() {
        for function in [Function::SetReal, Function::SetRealInputDerivatives, Function::DoStep] {
            assert!(function.is_allowed(LifecycleState::StepFailed));
            assert!(!function.is_allowed(LifecycleState::Error));
        }
    }

    #[test]
    fn after_a_panic_an_instance_can_only_be_freed() {
        let allowed =
            TABLE.iter().map(|rule| rule.function).filter(|function| function.is_allowed(LifecycleState::Fatal));
        assert_eq!(allowed.collect::<Vec<_>>(), [Function::FreeInstance]);
    }
}
