//! Every function in every state, against the standard's table with the additions of this FMU; the functions exported.

use std::collections::BTreeSet;
use std::process::Command;
use std::ptr;

use asperity_fmi::bindings::*;
use asperity_fmi::*;

use crate::common::{library, run};
use crate::fmu::fmi_interface::master::{DISCARD, ERROR, Fmu, OK};

/// The states that calls can lead to, by the letters of the table below.
pub const STATES: [(char, fn() -> Fmu); 6] =
    [('I', Fmu::new), ('M', Fmu::initialising), ('C', Fmu::running), ('F', failed), ('T', terminated), ('E', in_error)];

fn failed() -> Fmu {
    let fmu = Fmu::initialising();
    assert_eq!(fmu.set_integers(&[fmu.reference("solver.max_steps")], &[1]), OK);
    assert_eq!(fmu.set_rate("w", -1.0), OK);
    assert_eq!((fmu.exit(), fmu.step(0.0, 1.0)), (OK, DISCARD));
    fmu
}

fn terminated() -> Fmu {
    let fmu = Fmu::running();
    assert_eq!(fmu.terminate(), OK);
    fmu
}

fn in_error() -> Fmu {
    let fmu = Fmu::running();
    assert_eq!((fmu.set_real("u", f64::NAN), fmu.step(0.0, 1e-7)), (OK, ERROR));
    fmu
}

pub type Call = unsafe fn(&Fmu) -> fmi2Status;

/// Function, the states in which it is allowed, and a call that is harmless wherever it is allowed.
#[rustfmt::skip]
pub const TABLE: [(&str, &str, Call); 30] = [
    ("fmi2SetDebugLogging", "IMCFTE", |f| unsafe { fmi2SetDebugLogging(f.c, 0, 0, ptr::null()) }),
    ("fmi2SetupExperiment", "I", |f| unsafe { fmi2SetupExperiment(f.c, 0, 0.0, 0.0, 0, 0.0) }),
    ("fmi2EnterInitializationMode", "I", |f| unsafe { fmi2EnterInitializationMode(f.c) }),
    ("fmi2ExitInitializationMode", "M", |f| unsafe { fmi2ExitInitializationMode(f.c) }),
    ("fmi2Terminate", "CF", |f| unsafe { fmi2Terminate(f.c) }),
    ("fmi2Reset", "IMCFTE", |f| unsafe { fmi2Reset(f.c) }),
    ("fmi2GetReal", "MCFTE", |f| unsafe { fmi2GetReal(f.c, ptr::null(), 0, ptr::null_mut()) }),
    ("fmi2GetInteger", "MCFTE", |f| unsafe { fmi2GetInteger(f.c, ptr::null(), 0, ptr::null_mut()) }),
    ("fmi2GetBoolean", "MCFTE", |f| unsafe { fmi2GetBoolean(f.c, ptr::null(), 0, ptr::null_mut()) }),
    ("fmi2GetString", "MCFTE", |f| unsafe { fmi2GetString(f.c, ptr::null(), 0, ptr::null_mut()) }),
    ("fmi2SetReal", "IMCF", |f| unsafe { fmi2SetReal(f.c, ptr::null(), 0, ptr::null()) }),
    ("fmi2SetInteger", "IMCF", |f| unsafe { fmi2SetInteger(f.c, ptr::null(), 0, ptr::null()) }),
    ("fmi2SetBoolean", "IMCF", |f| unsafe { fmi2SetBoolean(f.c, ptr::null(), 0, ptr::null()) }),
    ("fmi2SetString", "IMCF", |f| unsafe { fmi2SetString(f.c, ptr::null(), 0, ptr::null()) }),
    ("fmi2GetFMUstate", "IMCFTE", |f| f.get_state(&mut ptr::null_mut())),
    ("fmi2SetFMUstate", "IMCFTE", same_state),
    ("fmi2FreeFMUstate", "IMCFTE", |f| f.free_state(&mut ptr::null_mut())),
    ("fmi2SerializedFMUstateSize", "IMCFTE", |f| unsafe { fmi2SerializedFMUstateSize(f.c, any_state(f), &mut 0) }),
    ("fmi2SerializeFMUstate", "IMCFTE", |f| f.serialise(any_state(f), &mut f.frozen())),
    ("fmi2DeSerializeFMUstate", "IMCFTE", |f| f.deserialise(&f.frozen(), &mut ptr::null_mut())),
    ("fmi2GetDirectionalDerivative", "MCFTE", |f| f.get_derivatives(&[], &[], &[], &mut [])),
    ("fmi2GetRealOutputDerivatives", "CFTE", |f| f.get_rates(&[], &[], &mut [])),
    ("fmi2SetRealInputDerivatives", "IMCF",
        |f| unsafe { fmi2SetRealInputDerivatives(f.c, ptr::null(), 0, ptr::null(), ptr::null()) }),
    ("fmi2DoStep", "CF", |f| unsafe { fmi2DoStep(f.c, 0.0, 0.0, 0) }),
    ("fmi2CancelStep", "", |f| unsafe { fmi2CancelStep(f.c) }),
    ("fmi2GetStatus", "CFT", |f| unsafe { fmi2GetStatus(f.c, fmi2StatusKind_fmi2DoStepStatus, &mut 0) }),
    ("fmi2GetRealStatus", "CFT", |f| unsafe { fmi2GetRealStatus(f.c, fmi2StatusKind_fmi2LastSuccessfulTime, &mut 0.0) }),
    ("fmi2GetIntegerStatus", "CFT", |f| unsafe { fmi2GetIntegerStatus(f.c, fmi2StatusKind_fmi2Terminated, &mut 0) }),
    ("fmi2GetBooleanStatus", "CFT", |f| unsafe { fmi2GetBooleanStatus(f.c, fmi2StatusKind_fmi2Terminated, &mut 0) }),
    ("fmi2GetStringStatus", "CFT",
        |f| unsafe { fmi2GetStringStatus(f.c, fmi2StatusKind_fmi2PendingStatus, &mut ptr::null()) }),
];

fn any_state(fmu: &Fmu) -> fmi2FMUstate {
    let mut state = ptr::null_mut();
    fmu.get_state(&mut state);
    state
}

fn same_state(fmu: &Fmu) -> fmi2Status {
    fmu.set_state(any_state(fmu))
}

#[test]
fn every_function_in_every_state() {
    try_all(STATES);
}

/// Calls every function in each of these states.
pub fn try_all(states: [(char, fn() -> Fmu); 6]) {
    for (letter, reach) in states {
        TABLE.iter().for_each(|row| try_in(letter, &reach(), row));
    }
}

fn try_in(letter: char, fmu: &Fmu, &(name, allowed, call): &(&str, &str, Call)) {
    fmu.messages();
    // SAFETY: the instance lives; the pointers are valid or NULL with n = 0.
    let status = unsafe { call(fmu) };
    // Statuses that do not exist are discarded where they may be asked for.
    let unavailable = matches!(name, "fmi2GetIntegerStatus" | "fmi2GetStringStatus");
    let expected = match allowed.contains(letter) {
        true if unavailable => DISCARD,
        true => OK,
        false => ERROR,
    };
    assert_eq!(status, expected, "{name} in {letter}");
    if expected == ERROR {
        let text = fmu.message();
        assert!(text.starts_with(&format!("{name}: not allowed in the state ")), "{text}");
    }
}

#[test]
fn a_call_not_allowed_changes_nothing() {
    let fmu = Fmu::initialising();
    assert_eq!((fmu.step(0.0, 1e-7), fmu.enter(), fmu.terminate()), (ERROR, ERROR, ERROR));
    assert_eq!((fmu.exit(), fmu.step(0.0, 1e-7)), (OK, OK));
}

#[test]
fn a_restored_state_or_a_reset_ends_the_error_state() {
    let fmu = Fmu::running();
    let mut state = ptr::null_mut();
    assert_eq!(fmu.get_state(&mut state), OK);
    assert_eq!((fmu.set_real("u", f64::NAN), fmu.step(0.0, 1e-7)), (OK, ERROR));
    assert_eq!(fmu.step(0.0, 1e-7), ERROR);
    assert_eq!(fmu.set_state(state), OK);
    assert_eq!(fmu.real("u"), 0.0);
    assert_eq!((fmu.step(0.0, 1e-7), fmu.reset(), fmu.enter()), (OK, OK, OK));
}

/// The functions that are not called on an instance in some state.
const OTHERS: [&str; 4] = ["fmi2GetTypesPlatform", "fmi2GetVersion", "fmi2Instantiate", "fmi2FreeInstance"];

#[test]
#[cfg(target_os = "linux")]
fn the_34_functions_are_exported_and_nothing_else() {
    let text = run(Command::new("nm").args(["-D", "--defined-only"]).arg(library()));
    let exported: Vec<_> = text.lines().filter_map(|line| line.split_whitespace().last()).collect();
    let expected: BTreeSet<_> = TABLE.iter().map(|row| row.0).chain(OTHERS).collect();
    assert_eq!((exported.len(), expected.len()), (34, 34), "{exported:?}");
    assert_eq!(BTreeSet::from_iter(exported), expected);
}
