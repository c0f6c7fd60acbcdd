//! The functions of FMI 2.0 for co-simulation, all 34, as a master calls them.
//!
//! # Safety
//!
//! All of them assume the standard's contract: a component is NULL or was returned by [`fmi2Instantiate`] and is not
//! freed, and one thread at a time uses it; a pointer to data is NULL or valid for the number of elements passed; a
//! string is NULL or ends with a zero. NULL is handled everywhere; other violations cannot be detected here.
#![allow(unsafe_code, non_snake_case, non_upper_case_globals, clippy::missing_safety_doc)]

use std::ffi::{CStr, c_char};
use std::{ptr, slice};

use asperity::scene::Value;

use super::bindings::*;
use super::callbacks::{Callbacks, DefaultFloatingPoint, library_file};
use super::error::{Error, catch_panic};
use super::instance::Instance;
use super::lifecycle::Function;
use super::log::Message;

/// What a component points to.
struct Component {
    instance: Instance,
    callbacks: Callbacks,
}

/// Common part of all functions that take an instance: checks for NULL, the life cycle, panics, the default
/// floating-point environment. Messages are delivered at the end, when the instance is no longer borrowed and the
/// host's environment is back.
unsafe fn call(
    component: fmi2Component,
    function: Function,
    body: impl FnOnce(&mut Instance) -> Result<(), Error>,
) -> fmi2Status {
    let component = component.cast::<Component>();
    if component.is_null() {
        return fmi2Status_fmi2Error;
    }
    let (status, messages) = {
        let _environment = DefaultFloatingPoint::enter();
        // SAFETY: not NULL, so a component that lives and that no other thread uses, by the contract.
        let instance = unsafe { &mut (*component).instance };
        (instance.call(function, body), instance.take_messages())
    };
    if !messages.is_empty() {
        // SAFETY: as above; the callbacks are never borrowed mutably.
        unsafe { &(*component).callbacks }.deliver(messages);
    }
    status.into()
}

/// An array that the master passes; NULL is an empty one.
unsafe fn array<'a, T>(name: &'static str, pointer: *const T, length: usize) -> Result<&'a [T], Error> {
    match length {
        0 => Ok(&[]),
        _ if pointer.is_null() => Err(Error::Null(name)),
        // SAFETY: not NULL, so `length` elements by the contract.
        _ => Ok(unsafe { slice::from_raw_parts(pointer, length) }),
    }
}

/// An array that the master wants filled; NULL is an empty one.
unsafe fn array_mut<'a, T>(name: &'static str, pointer: *mut T, length: usize) -> Result<&'a mut [T], Error> {
    match length {
        0 => Ok(&mut []),
        _ if pointer.is_null() => Err(Error::Null(name)),
        // SAFETY: not NULL, so `length` elements by the contract.
        _ => Ok(unsafe { slice::from_raw_parts_mut(pointer, length) }),
    }
}

/// The target of a pointer to one value.
unsafe fn target<'a, T>(name: &'static str, pointer: *mut T) -> Result<&'a mut T, Error> {
    // SAFETY: NULL or valid by the contract.
    unsafe { pointer.as_mut() }.ok_or(Error::Null(name))
}

/// Writes one value for the master.
unsafe fn put<T>(pointer: *mut T, value: T) -> Result<(), Error> {
    // SAFETY: the contract of this module.
    *unsafe { target("value", pointer) }? = value;
    Ok(())
}

/// A string that the master passes.
unsafe fn text<'a>(name: &'static str, pointer: fmi2String) -> Result<&'a str, Error> {
    if pointer.is_null() {
        return Err(Error::Null(name));
    }
    // SAFETY: not NULL, so a string that ends with a zero by the contract.
    unsafe { CStr::from_ptr(pointer) }.to_str().map_err(|_| Error::NotText(name))
}

unsafe fn texts<'a>(name: &'static str, pointer: *const fmi2String, length: usize) -> Result<Vec<&'a str>, Error> {
    // SAFETY: the contract holds for the array and for each of its strings.
    unsafe { array(name, pointer, length)?.iter().map(|&string| text(name, string)).collect() }
}

/// The platform that the types belong to: "default".
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    fmi2TypesPlatform.as_ptr().cast()
}
const _: fmi2GetTypesPlatformTYPE = Some(fmi2GetTypesPlatform);

/// The version of the standard: "2.0".
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetVersion() -> *const c_char {
    fmi2Version.as_ptr().cast()
}
const _: fmi2GetVersionTYPE = Some(fmi2GetVersion);

/// Switches categories of messages on or off.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    c: fmi2Component,
    loggingOn: fmi2Boolean,
    nCategories: usize,
    categories: *const fmi2String,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::SetDebugLogging, |instance| {
            instance.set_debug_logging(loggingOn != 0, &texts("categories", categories, nCategories)?)
        })
    }
}
const _: fmi2SetDebugLoggingTYPE = Some(fmi2SetDebugLogging);

/// Creates an instance. Returns NULL where that fails; the reason is logged.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    instanceName: fmi2String,
    fmuType: fmi2Type,
    fmuGUID: fmi2String,
    fmuResourceLocation: fmi2String,
    functions: *const fmi2CallbackFunctions,
    _visible: fmi2Boolean,
    loggingOn: fmi2Boolean,
) -> fmi2Component {
    // SAFETY: the contract of this module.
    let (callbacks, instance) = unsafe {
        let _environment = DefaultFloatingPoint::enter();
        let instance = catch_panic(|| instantiate(fmuType, fmuGUID, fmuResourceLocation, loggingOn != 0));
        (Callbacks::new(functions, instanceName), instance)
    };
    match instance.unwrap_or_else(|panic| Err(Error::Panic(panic))) {
        Ok(mut instance) => {
            callbacks.deliver(instance.take_messages());
            Box::into_raw(Box::new(Component { instance, callbacks })).cast()
        }
        Err(error) => {
            let text = format!("fmi2Instantiate: {error}");
            callbacks.deliver(vec![Message::from_status(error.status(), text)]);
            ptr::null_mut()
        }
    }
}
const _: fmi2InstantiateTYPE = Some(fmi2Instantiate);

unsafe fn instantiate(
    kind: fmi2Type,
    guid: fmi2String,
    location: fmi2String,
    logging: bool,
) -> Result<Instance, Error> {
    if kind != fmi2Type_fmi2CoSimulation {
        return Err(Error::NotCoSimulation);
    }
    // SAFETY: the contract of this module.
    let (guid, location) = unsafe {
        let location = if location.is_null() { "" } else { text("fmuResourceLocation", location)? };
        (text("fmuGUID", guid)?, location)
    };
    Instance::new(guid, location, library_file().as_deref(), logging)
}

/// Frees an instance and all FMU states it has handed out; NULL is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(c: fmi2Component) {
    if c.is_null() {
        return;
    }
    // SAFETY: not NULL, so from Box::into_raw in fmi2Instantiate and not freed, by the contract.
    let component = unsafe { Box::from_raw(c.cast::<Component>()) };
    let _environment = DefaultFloatingPoint::enter();
    // There is no instance left to report a panic.
    let _ = catch_panic(|| drop(component));
}
const _: fmi2FreeInstanceTYPE = Some(fmi2FreeInstance);

/// Sets tolerance, start time and stop time.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    c: fmi2Component,
    toleranceDefined: fmi2Boolean,
    tolerance: fmi2Real,
    startTime: fmi2Real,
    stopTimeDefined: fmi2Boolean,
    stopTime: fmi2Real,
) -> fmi2Status {
    let tolerance = (toleranceDefined != 0).then_some(tolerance);
    let stop = (stopTimeDefined != 0).then_some(stopTime);
    // SAFETY: the contract of this module.
    unsafe { call(c, Function::SetupExperiment, |instance| instance.setup_experiment(tolerance, startTime, stop)) }
}
const _: fmi2SetupExperimentTYPE = Some(fmi2SetupExperiment);

/// Begins the initialisation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterInitializationMode(c: fmi2Component) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe { call(c, Function::EnterInitializationMode, Instance::enter_initialization_mode) }
}
const _: fmi2EnterInitializationModeTYPE = Some(fmi2EnterInitializationMode);

/// Ends the initialisation: the run starts with the inputs and parameters as they are.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2ExitInitializationMode(c: fmi2Component) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe { call(c, Function::ExitInitializationMode, Instance::exit_initialization_mode) }
}
const _: fmi2ExitInitializationModeTYPE = Some(fmi2ExitInitializationMode);

/// Ends the run.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Terminate(c: fmi2Component) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe { call(c, Function::Terminate, Instance::terminate) }
}
const _: fmi2TerminateTYPE = Some(fmi2Terminate);

/// Returns to the state after fmi2Instantiate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(c: fmi2Component) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe { call(c, Function::Reset, Instance::reset) }
}
const _: fmi2ResetTYPE = Some(fmi2Reset);

/// Gets Reals.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::GetReal, |instance| {
            instance.get_reals(array("vr", vr, nvr)?, array_mut("value", value, nvr)?)
        })
    }
}
const _: fmi2GetRealTYPE = Some(fmi2GetReal);

/// Gets Integers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetInteger(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2Integer,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::GetInteger, |instance| {
            instance.get_integers(array("vr", vr, nvr)?, array_mut("value", value, nvr)?)
        })
    }
}
const _: fmi2GetIntegerTYPE = Some(fmi2GetInteger);

/// Gets Booleans: there are none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBoolean(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    _value: *mut fmi2Boolean,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe { call(c, Function::GetBoolean, |instance| instance.refuse_booleans(array("vr", vr, nvr)?)) }
}
const _: fmi2GetBooleanTYPE = Some(fmi2GetBoolean);

/// Gets Strings, which remain valid until the next call on this instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetString(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2String,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::GetString, |instance| {
            let pointers = array_mut("value", value, nvr)?;
            let texts = instance.get_strings(array("vr", vr, nvr)?)?;
            pointers.iter_mut().zip(texts).for_each(|(pointer, text)| *pointer = text.as_ptr());
            Ok(())
        })
    }
}
const _: fmi2GetStringTYPE = Some(fmi2GetString);

/// Sets Reals: inputs, and parameters before the run.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2Real,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::SetReal, |instance| {
            let values = array("value", value, nvr)?.iter().map(|&value| Value::Real(value));
            instance.set(array("vr", vr, nvr)?, values)
        })
    }
}
const _: fmi2SetRealTYPE = Some(fmi2SetReal);

/// Sets Integers: parameters before the run.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetInteger(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2Integer,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::SetInteger, |instance| {
            let values = array("value", value, nvr)?.iter().map(|&value| Value::Integer(value));
            instance.set(array("vr", vr, nvr)?, values)
        })
    }
}
const _: fmi2SetIntegerTYPE = Some(fmi2SetInteger);

/// Sets Booleans: there are none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetBoolean(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    _value: *const fmi2Boolean,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe { call(c, Function::SetBoolean, |instance| instance.refuse_booleans(array("vr", vr, nvr)?)) }
}
const _: fmi2SetBooleanTYPE = Some(fmi2SetBoolean);

/// Sets Strings: parameters before the run.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetString(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2String,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::SetString, |instance| {
            let values = texts("value", value, nvr)?.into_iter().map(|value| Value::Text(value.into()));
            instance.set(array("vr", vr, nvr)?, values)
        })
    }
}
const _: fmi2SetStringTYPE = Some(fmi2SetString);

/// Copies the state of the instance into a new FMU state or over an existing one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(c: fmi2Component, FMUstate: *mut fmi2FMUstate) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::GetFmuState, |instance| {
            let state = target("FMUstate", FMUstate)?;
            *state = ptr::without_provenance_mut(instance.get_state(state.addr())?);
            Ok(())
        })
    }
}
const _: fmi2GetFMUstateTYPE = Some(fmi2GetFMUstate);

/// Restores an FMU state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(c: fmi2Component, FMUstate: fmi2FMUstate) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe { call(c, Function::SetFmuState, |instance| instance.set_state(FMUstate.addr())) }
}
const _: fmi2SetFMUstateTYPE = Some(fmi2SetFMUstate);

/// Frees an FMU state; NULL is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(c: fmi2Component, FMUstate: *mut fmi2FMUstate) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::FreeFmuState, |instance| {
            let Some(state) = FMUstate.as_mut() else { return Ok(()) };
            instance.free_state(state.addr())?;
            *state = ptr::null_mut();
            Ok(())
        })
    }
}
const _: fmi2FreeFMUstateTYPE = Some(fmi2FreeFMUstate);

/// The number of bytes of an FMU state as a byte string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(
    c: fmi2Component,
    FMUstate: fmi2FMUstate,
    size: *mut usize,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::SerializedFmuStateSize, |instance| {
            *target("size", size)? = instance.serialised_size(FMUstate.addr())?;
            Ok(())
        })
    }
}
const _: fmi2SerializedFMUstateSizeTYPE = Some(fmi2SerializedFMUstateSize);

/// Writes an FMU state as a byte string, whose size is that of [`fmi2SerializedFMUstateSize`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    c: fmi2Component,
    FMUstate: fmi2FMUstate,
    serializedState: *mut fmi2Byte,
    size: usize,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::SerializeFmuState, |instance| {
            let bytes = instance.serialise_state(FMUstate.addr())?;
            if bytes.len() != size {
                return Err(Error::SerialisedSize { needed: bytes.len(), given: size });
            }
            array_mut("serializedState", serializedState.cast::<u8>(), size)?.copy_from_slice(&bytes);
            Ok(())
        })
    }
}
const _: fmi2SerializeFMUstateTYPE = Some(fmi2SerializeFMUstate);

/// Creates a new FMU state from a byte string; the target of `FMUstate` is written and never read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    c: fmi2Component,
    serializedState: *const fmi2Byte,
    size: usize,
    FMUstate: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::DeSerializeFmuState, |instance| {
            let state = target("FMUstate", FMUstate)?;
            let bytes = array("serializedState", serializedState.cast::<u8>(), size)?;
            *state = ptr::without_provenance_mut(instance.deserialise_state(bytes)?);
            Ok(())
        })
    }
}
const _: fmi2DeSerializeFMUstateTYPE = Some(fmi2DeSerializeFMUstate);

/// Directional derivatives of outputs by inputs, at constant states.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDirectionalDerivative(
    c: fmi2Component,
    vUnknown_ref: *const fmi2ValueReference,
    nUnknown: usize,
    vKnown_ref: *const fmi2ValueReference,
    nKnown: usize,
    dvKnown: *const fmi2Real,
    dvUnknown: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::GetDirectionalDerivative, |instance| {
            let unknowns = array("vUnknown_ref", vUnknown_ref, nUnknown)?;
            let knowns = array("vKnown_ref", vKnown_ref, nKnown)?;
            let direction = array("dvKnown", dvKnown, nKnown)?;
            let values = array_mut("dvUnknown", dvUnknown, nUnknown)?;
            instance.directional_derivatives(unknowns, knowns, direction, values)
        })
    }
}
const _: fmi2GetDirectionalDerivativeTYPE = Some(fmi2GetDirectionalDerivative);

/// Sets first derivatives of inputs for the next step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    order: *const fmi2Integer,
    value: *const fmi2Real,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::SetRealInputDerivatives, |instance| {
            instance.set_rates(array("vr", vr, nvr)?, array("order", order, nvr)?, array("value", value, nvr)?)
        })
    }
}
const _: fmi2SetRealInputDerivativesTYPE = Some(fmi2SetRealInputDerivatives);

/// Gets first derivatives of F_x and F_z.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    order: *const fmi2Integer,
    value: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::GetRealOutputDerivatives, |instance| {
            let orders = array("order", order, nvr)?;
            instance.output_derivatives(array("vr", vr, nvr)?, orders, array_mut("value", value, nvr)?)
        })
    }
}
const _: fmi2GetRealOutputDerivativesTYPE = Some(fmi2GetRealOutputDerivatives);

/// Does a communication step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(
    c: fmi2Component,
    currentCommunicationPoint: fmi2Real,
    communicationStepSize: fmi2Real,
    _noSetFMUStatePriorToCurrentPoint: fmi2Boolean,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe { call(c, Function::DoStep, |instance| instance.do_step(currentCommunicationPoint, communicationStepSize)) }
}
const _: fmi2DoStepTYPE = Some(fmi2DoStep);

/// Refused in every state, since no step runs asynchronously.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CancelStep(c: fmi2Component) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe { call(c, Function::CancelStep, |_| Ok(())) }
}
const _: fmi2CancelStepTYPE = Some(fmi2CancelStep);

/// What the last step returned.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStatus(c: fmi2Component, s: fmi2StatusKind, value: *mut fmi2Status) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::GetStatus, |instance| match s {
            fmi2StatusKind_fmi2DoStepStatus => put(value, instance.last_step().into()),
            _ => Err(Error::NoSuchStatus),
        })
    }
}
const _: fmi2GetStatusTYPE = Some(fmi2GetStatus);

/// The end of the last step that succeeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(c: fmi2Component, s: fmi2StatusKind, value: *mut fmi2Real) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::GetRealStatus, |instance| match s {
            fmi2StatusKind_fmi2LastSuccessfulTime => put(value, instance.last_successful_time()),
            _ => Err(Error::NoSuchStatus),
        })
    }
}
const _: fmi2GetRealStatusTYPE = Some(fmi2GetRealStatus);

/// There is no such status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetIntegerStatus(
    c: fmi2Component,
    _s: fmi2StatusKind,
    _value: *mut fmi2Integer,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe { call(c, Function::GetIntegerStatus, |_| Err(Error::NoSuchStatus)) }
}
const _: fmi2GetIntegerStatusTYPE = Some(fmi2GetIntegerStatus);

/// Whether the FMU wants the simulation to end: never.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(
    c: fmi2Component,
    s: fmi2StatusKind,
    value: *mut fmi2Boolean,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe {
        call(c, Function::GetBooleanStatus, |_| match s {
            fmi2StatusKind_fmi2Terminated => put(value, 0),
            _ => Err(Error::NoSuchStatus),
        })
    }
}
const _: fmi2GetBooleanStatusTYPE = Some(fmi2GetBooleanStatus);

/// There is no such status: no step is ever pending.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStringStatus(
    c: fmi2Component,
    _s: fmi2StatusKind,
    _value: *mut fmi2String,
) -> fmi2Status {
    // SAFETY: the contract of this module.
    unsafe { call(c, Function::GetStringStatus, |_| Err(Error::NoSuchStatus)) }
}
const _: fmi2GetStringStatusTYPE = Some(fmi2GetStringStatus);

#[cfg(test)]
mod tests {
    use super::super::instance;
    use super::*;

    /// The call returns fmi2Fatal, later ones fmi2Error; the instance can still be freed.
    #[test]
    fn a_panic_stops_at_the_interface() {
        // SAFETY: no callbacks.
        let callbacks = unsafe { Callbacks::new(ptr::null(), c"lost".as_ptr()) };
        let component = Component { instance: instance::tests::instance(), callbacks };
        let c: fmi2Component = Box::into_raw(Box::new(component)).cast();
        // SAFETY: the component lives until it is freed, once.
        unsafe {
            assert_eq!(call(c, Function::GetReal, |_| Ok(())), fmi2Status_fmi2Error, "too early");
            assert_eq!(call(c, Function::Reset, |_| panic!("lost a mass")), fmi2Status_fmi2Fatal);
            assert_eq!(fmi2Reset(c), fmi2Status_fmi2Error);
            assert_eq!(fmi2DoStep(c, 0.0, 1.0, 1), fmi2Status_fmi2Error);
            fmi2FreeInstance(c);
        }
    }
}
