//! Calls that involve one instance alone.

use std::ptr;

use asperity_fmi::bindings::*;
use asperity_fmi::*;

use super::super::fmu::{Fmu, MAX_STEPS, OK, checked};
use super::super::number::Number;
use super::{Array, Call, MAX_ELEMENTS, Reference, Text, or_null, pointer};

pub(super) fn step(fmu: Fmu, call: &Call) {
    let own = || fmu.time().unwrap_or_default();
    match *call {
        Call::Inputs { u, w } => {
            // SAFETY: an instance that lives, slices of the lengths given.
            checked(unsafe { fmi2SetReal(fmu.c, fmu.site.inputs.as_ptr(), 2, [u.value(), w.value()].as_ptr()) });
        }
        Call::Rates { u, w } => {
            fmu.set_rates([u, w].map(Number::value));
        }
        Call::Step { h } => {
            fmu.checked_step(own(), h.value());
        }
        Call::StepsOfMicroseconds { count, h } => {
            (0..count % 8).for_each(|_| {
                fmu.checked_step(own(), f64::from(h) * 1e-6);
            });
        }
        Call::StepTwice { h } => step_twice(fmu, own(), h.value()),
        Call::DoStep { point, h } => {
            fmu.checked_step(point.map_or_else(own, Number::value), h.value());
        }
        _ => (),
    }
}

/// A step from the same state has the same result, bit for bit.
fn step_twice(fmu: Fmu, point: f64, h: f64) {
    let state = fmu.keep();
    if state.is_null() {
        return;
    }
    let first = (fmu.checked_step(point, h), fmu.outputs(), fmu.frozen());
    // SAFETY: an instance that lives, a state of it.
    assert_eq!(unsafe { fmi2SetFMUstate(fmu.c, state) }, OK);
    let second = (fmu.step(point, h), fmu.outputs(), fmu.frozen());
    assert!(first == second, "another result from the same state");
    fmu.forget(state);
}

/// Functions of the life cycle and of the status.
pub(super) fn call_function(fmu: Fmu, call: &Call) {
    let c = fmu.c;
    // SAFETY: an instance that lives; slices of the lengths given, or NULL.
    let status = unsafe {
        match call {
            Call::SetDebugLogging { on, categories } => {
                let strings: Vec<_> = categories.taken().map(Text::string).collect();
                let pointers: Vec<_> = strings.iter().map(pointer).collect();
                fmi2SetDebugLogging(c, (*on).into(), pointers.len(), categories.pointer(&pointers))
            }
            Call::SetupExperiment { tolerance, start, stop } => {
                let value = |number: &Option<Number>| number.map_or(0.0, Number::value);
                let (has_tolerance, has_stop) = (tolerance.is_some().into(), stop.is_some().into());
                fmi2SetupExperiment(c, has_tolerance, value(tolerance), start.value(), has_stop, value(stop))
            }
            Call::EnterInitializationMode => fmi2EnterInitializationMode(c),
            Call::ExitInitializationMode => fmi2ExitInitializationMode(c),
            Call::Terminate => fmi2Terminate(c),
            Call::Reset => reset(fmu),
            Call::CancelStep => fmi2CancelStep(c),
            Call::GetStatus { kind, which, null } => get_status(c, (*kind).into(), *which, *null),
            _ => return get(fmu, call),
        }
    };
    checked(status);
}

fn get(fmu: Fmu, call: &Call) {
    let c = fmu.c;
    // SAFETY: an instance that lives; slices of the lengths given, or NULL.
    let status = unsafe {
        match call {
            Call::GetReal(array, null) => {
                let (vr, mut values) = (references(array), [0.0; MAX_ELEMENTS]);
                fmi2GetReal(c, array.pointer(&vr), vr.len(), or_null(*null, &mut values))
            }
            Call::GetInteger(array, null) => {
                let (vr, mut values) = (references(array), [0; MAX_ELEMENTS]);
                fmi2GetInteger(c, array.pointer(&vr), vr.len(), or_null(*null, &mut values))
            }
            Call::GetBoolean(array, null) => {
                let (vr, mut values) = (references(array), [0; MAX_ELEMENTS]);
                fmi2GetBoolean(c, array.pointer(&vr), vr.len(), or_null(*null, &mut values))
            }
            Call::GetString(array, null) => {
                let (vr, mut values) = (references(array), [ptr::null(); MAX_ELEMENTS]);
                fmi2GetString(c, array.pointer(&vr), vr.len(), or_null(*null, &mut values))
            }
            _ => return set(fmu, call),
        }
    };
    checked(status);
}

fn set(fmu: Fmu, call: &Call) {
    let c = fmu.c;
    // SAFETY: an instance that lives; slices of the lengths given, or NULL.
    let status = unsafe {
        match call {
            Call::Parameter { which, value } => {
                let reference = fmu.site.numbers[usize::from(*which) % fmu.site.numbers.len()];
                fmi2SetReal(c, &reference, 1, &value.value())
            }
            Call::SetReal(array, null) => {
                let (vr, mut values): (Vec<_>, Vec<_>) =
                    array.taken().map(|(reference, value)| (reference.number(), value.value())).unzip();
                fmi2SetReal(c, array.pointer(&vr), vr.len(), or_null(*null, &mut values))
            }
            Call::SetInteger(array, null) => {
                let capped = |reference: u32, value: i32| {
                    if Some(reference) == fmu.site.max_steps { value.min(MAX_STEPS) } else { value }
                };
                let (vr, mut values): (Vec<_>, Vec<_>) = array
                    .taken()
                    .map(|(reference, value)| (reference.number(), capped(reference.number(), *value)))
                    .unzip();
                fmi2SetInteger(c, array.pointer(&vr), vr.len(), or_null(*null, &mut values))
            }
            Call::SetBoolean(array, null) => {
                let (vr, mut values): (Vec<_>, Vec<_>) =
                    array.taken().map(|(reference, value)| (reference.number(), *value)).unzip();
                fmi2SetBoolean(c, array.pointer(&vr), vr.len(), or_null(*null, &mut values))
            }
            Call::SetString(array, null) => {
                // References of other types are tried by the other functions.
                let reference = |one: &Reference| match fmu.site.texts.get(usize::from(one.0)) {
                    Some(&text) => text,
                    None => one.number(),
                };
                let strings: Vec<_> = array.taken().map(|(_, text)| text.string()).collect();
                let (vr, mut values): (Vec<_>, Vec<_>) =
                    array.taken().zip(&strings).map(|((one, _), text)| (reference(one), pointer(text))).unzip();
                fmi2SetString(c, array.pointer(&vr), vr.len(), or_null(*null, &mut values))
            }
            _ => return derive(fmu, call),
        }
    };
    checked(status);
}

fn derive(fmu: Fmu, call: &Call) {
    let c = fmu.c;
    // SAFETY: an instance that lives; slices of the lengths given, or NULL.
    let status = unsafe {
        match call {
            Call::DirectionalDerivative { unknowns, knowns, null } => {
                let unknown = references(unknowns);
                let (known, direction): (Vec<_>, Vec<_>) =
                    knowns.taken().map(|(reference, value)| (reference.number(), value.value())).unzip();
                let (known, count, steps) = (knowns.pointer(&known), known.len(), direction.as_ptr());
                let mut values = [0.0; MAX_ELEMENTS];
                let place = or_null(*null, &mut values);
                let (unknowns, unknown_count) = (unknowns.pointer(&unknown), unknown.len());
                let status = fmi2GetDirectionalDerivative(c, unknowns, unknown_count, known, count, steps, place);
                assert!(values.iter().all(|value| value.is_finite()));
                status
            }
            Call::AllDerivatives { u, w } => {
                fmu.check_derivatives([u, w].map(|number| number.value()));
                OK
            }
            Call::SetInputDerivatives(array, null) => {
                let vr: Vec<_> = array.taken().map(|one| one.0.number()).collect();
                let orders: Vec<_> = array.taken().map(|one| one.1).collect();
                let mut values: Vec<_> = array.taken().map(|one| one.2.value()).collect();
                let place = or_null(*null, &mut values);
                fmi2SetRealInputDerivatives(c, array.pointer(&vr), vr.len(), orders.as_ptr(), place)
            }
            Call::GetOutputDerivatives(array, null) => {
                let vr: Vec<_> = array.taken().map(|one| one.0.number()).collect();
                let orders: Vec<_> = array.taken().map(|one| one.1).collect();
                let mut values = [0.0; MAX_ELEMENTS];
                let place = or_null(*null, &mut values);
                fmi2GetRealOutputDerivatives(c, array.pointer(&vr), vr.len(), orders.as_ptr(), place)
            }
            _ => return,
        }
    };
    checked(status);
}

fn references(array: &Array<Reference>) -> Vec<u32> {
    array.taken().map(|one| one.number()).collect()
}

/// Returns to the state of a new instance.
fn reset(fmu: Fmu) -> fmi2Status {
    // SAFETY: an instance that lives.
    let status = checked(unsafe { fmi2Reset(fmu.c) });
    assert!(fmu.frozen().as_ref() == Some(&fmu.site.fresh), "a reset instance is not as a new one");
    status
}

unsafe fn get_status(c: fmi2Component, kind: fmi2StatusKind, which: u8, null: bool) -> fmi2Status {
    // SAFETY: an instance that lives, places or NULL.
    unsafe {
        match which % 5 {
            0 => fmi2GetStatus(c, kind, or_null(null, &mut [0])),
            1 => fmi2GetRealStatus(c, kind, or_null(null, &mut [0.0])),
            2 => fmi2GetIntegerStatus(c, kind, or_null(null, &mut [0])),
            3 => fmi2GetBooleanStatus(c, kind, or_null(null, &mut [0])),
            _ => fmi2GetStringStatus(c, kind, or_null(null, &mut [ptr::null()])),
        }
    }
}

/// Functions without an instance, or with NULL instead of one.
pub(super) fn on_nothing() {
    // SAFETY: NULL is what is tested.
    unsafe {
        assert!(!fmi2GetVersion().is_null() && !fmi2GetTypesPlatform().is_null());
        let c = ptr::null_mut();
        fmi2FreeInstance(c);
        assert_eq!((fmi2DoStep(c, 0.0, 1.0, 1), fmi2Reset(c)), (fmi2Status_fmi2Error, fmi2Status_fmi2Error));
    }
}
