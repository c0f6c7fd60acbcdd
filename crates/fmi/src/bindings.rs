//! The types of FMI 2.0 for co-simulation. Generated, not to be edited: by bindgen 0.73.2 (libclang 14) from the official
//! headers of FMI 2.0.4, `fmi2Functions.h` and what it includes (2-Clause BSD License, © Modelica Association Project
//! "FMI"), with this command; these comments and the `allow` are the only lines added.
//!
//! ```text
//! bindgen fmi2Functions.h --allowlist-item 'fmi2.*' --ignore-functions --use-core --rust-target 1.85 --rust-edition 2024 \
//!     --blocklist-type 'fmi2(EventInfo|(EnterEventMode|NewDiscreteStates|EnterContinuousTimeMode|CompletedIntegratorStep|
//!     SetTime|SetContinuousStates|GetDerivatives|GetEventIndicators|GetContinuousStates|GetNominalsOfContinuousStates)TYPE)'
//! ```
//!
//! Enumerations are plain integers with constants, so that no value that a master passes is undefined behaviour. The
//! feature `verify-bindings` builds the exports against the types of the package `fmi-sys` instead, which generates them
//! from the same headers when it is built.
#![allow(missing_docs, non_camel_case_types, non_snake_case, non_upper_case_globals)]


pub const fmi2TypesPlatform: &[u8; 8] = b"default\0";
pub const fmi2True: u32 = 1;
pub const fmi2False: u32 = 0;
pub const fmi2Version: &[u8; 4] = b"2.0\0";
pub type fmi2Component = *mut ::core::ffi::c_void;
pub type fmi2ComponentEnvironment = *mut ::core::ffi::c_void;
pub type fmi2FMUstate = *mut ::core::ffi::c_void;
pub type fmi2ValueReference = ::core::ffi::c_uint;
pub type fmi2Real = f64;
pub type fmi2Integer = ::core::ffi::c_int;
pub type fmi2Boolean = ::core::ffi::c_int;
pub type fmi2Char = ::core::ffi::c_char;
pub type fmi2String = *const fmi2Char;
pub type fmi2Byte = ::core::ffi::c_char;
pub const fmi2Status_fmi2OK: fmi2Status = 0;
pub const fmi2Status_fmi2Warning: fmi2Status = 1;
pub const fmi2Status_fmi2Discard: fmi2Status = 2;
pub const fmi2Status_fmi2Error: fmi2Status = 3;
pub const fmi2Status_fmi2Fatal: fmi2Status = 4;
pub const fmi2Status_fmi2Pending: fmi2Status = 5;
pub type fmi2Status = ::core::ffi::c_uint;
pub const fmi2Type_fmi2ModelExchange: fmi2Type = 0;
pub const fmi2Type_fmi2CoSimulation: fmi2Type = 1;
pub type fmi2Type = ::core::ffi::c_uint;
pub const fmi2StatusKind_fmi2DoStepStatus: fmi2StatusKind = 0;
pub const fmi2StatusKind_fmi2PendingStatus: fmi2StatusKind = 1;
pub const fmi2StatusKind_fmi2LastSuccessfulTime: fmi2StatusKind = 2;
pub const fmi2StatusKind_fmi2Terminated: fmi2StatusKind = 3;
pub type fmi2StatusKind = ::core::ffi::c_uint;
pub type fmi2CallbackLogger = ::core::option::Option<
    unsafe extern "C" fn(
        componentEnvironment: fmi2ComponentEnvironment,
        instanceName: fmi2String,
        status: fmi2Status,
        category: fmi2String,
        message: fmi2String,
        ...
    ),
>;
pub type fmi2CallbackAllocateMemory = ::core::option::Option<
    unsafe extern "C" fn(nobj: usize, size: usize) -> *mut ::core::ffi::c_void,
>;
pub type fmi2CallbackFreeMemory =
    ::core::option::Option<unsafe extern "C" fn(obj: *mut ::core::ffi::c_void)>;
pub type fmi2StepFinished = ::core::option::Option<
    unsafe extern "C" fn(componentEnvironment: fmi2ComponentEnvironment, status: fmi2Status),
>;
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct fmi2CallbackFunctions {
    pub logger: fmi2CallbackLogger,
    pub allocateMemory: fmi2CallbackAllocateMemory,
    pub freeMemory: fmi2CallbackFreeMemory,
    pub stepFinished: fmi2StepFinished,
    pub componentEnvironment: fmi2ComponentEnvironment,
}
#[allow(clippy::unnecessary_operation, clippy::identity_op)]
const _: () = {
    ["Size of fmi2CallbackFunctions"][::core::mem::size_of::<fmi2CallbackFunctions>() - 40usize];
    ["Alignment of fmi2CallbackFunctions"]
        [::core::mem::align_of::<fmi2CallbackFunctions>() - 8usize];
    ["Offset of field: fmi2CallbackFunctions::logger"]
        [::core::mem::offset_of!(fmi2CallbackFunctions, logger) - 0usize];
    ["Offset of field: fmi2CallbackFunctions::allocateMemory"]
        [::core::mem::offset_of!(fmi2CallbackFunctions, allocateMemory) - 8usize];
    ["Offset of field: fmi2CallbackFunctions::freeMemory"]
        [::core::mem::offset_of!(fmi2CallbackFunctions, freeMemory) - 16usize];
    ["Offset of field: fmi2CallbackFunctions::stepFinished"]
        [::core::mem::offset_of!(fmi2CallbackFunctions, stepFinished) - 24usize];
    ["Offset of field: fmi2CallbackFunctions::componentEnvironment"]
        [::core::mem::offset_of!(fmi2CallbackFunctions, componentEnvironment) - 32usize];
};
#[doc = "Types for Common Functions"]
pub type fmi2GetTypesPlatformTYPE =
    ::core::option::Option<unsafe extern "C" fn() -> *const ::core::ffi::c_char>;
pub type fmi2GetVersionTYPE =
    ::core::option::Option<unsafe extern "C" fn() -> *const ::core::ffi::c_char>;
pub type fmi2SetDebugLoggingTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        loggingOn: fmi2Boolean,
        nCategories: usize,
        categories: *const fmi2String,
    ) -> fmi2Status,
>;
pub type fmi2InstantiateTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        instanceName: fmi2String,
        fmuType: fmi2Type,
        fmuGUID: fmi2String,
        fmuResourceLocation: fmi2String,
        functions: *const fmi2CallbackFunctions,
        visible: fmi2Boolean,
        loggingOn: fmi2Boolean,
    ) -> fmi2Component,
>;
pub type fmi2FreeInstanceTYPE = ::core::option::Option<unsafe extern "C" fn(c: fmi2Component)>;
pub type fmi2SetupExperimentTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        toleranceDefined: fmi2Boolean,
        tolerance: fmi2Real,
        startTime: fmi2Real,
        stopTimeDefined: fmi2Boolean,
        stopTime: fmi2Real,
    ) -> fmi2Status,
>;
pub type fmi2EnterInitializationModeTYPE =
    ::core::option::Option<unsafe extern "C" fn(c: fmi2Component) -> fmi2Status>;
pub type fmi2ExitInitializationModeTYPE =
    ::core::option::Option<unsafe extern "C" fn(c: fmi2Component) -> fmi2Status>;
pub type fmi2TerminateTYPE =
    ::core::option::Option<unsafe extern "C" fn(c: fmi2Component) -> fmi2Status>;
pub type fmi2ResetTYPE =
    ::core::option::Option<unsafe extern "C" fn(c: fmi2Component) -> fmi2Status>;
pub type fmi2GetRealTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        vr: *const fmi2ValueReference,
        nvr: usize,
        value: *mut fmi2Real,
    ) -> fmi2Status,
>;
pub type fmi2GetIntegerTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        vr: *const fmi2ValueReference,
        nvr: usize,
        value: *mut fmi2Integer,
    ) -> fmi2Status,
>;
pub type fmi2GetBooleanTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        vr: *const fmi2ValueReference,
        nvr: usize,
        value: *mut fmi2Boolean,
    ) -> fmi2Status,
>;
pub type fmi2GetStringTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        vr: *const fmi2ValueReference,
        nvr: usize,
        value: *mut fmi2String,
    ) -> fmi2Status,
>;
pub type fmi2SetRealTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        vr: *const fmi2ValueReference,
        nvr: usize,
        value: *const fmi2Real,
    ) -> fmi2Status,
>;
pub type fmi2SetIntegerTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        vr: *const fmi2ValueReference,
        nvr: usize,
        value: *const fmi2Integer,
    ) -> fmi2Status,
>;
pub type fmi2SetBooleanTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        vr: *const fmi2ValueReference,
        nvr: usize,
        value: *const fmi2Boolean,
    ) -> fmi2Status,
>;
pub type fmi2SetStringTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        vr: *const fmi2ValueReference,
        nvr: usize,
        value: *const fmi2String,
    ) -> fmi2Status,
>;
pub type fmi2GetFMUstateTYPE = ::core::option::Option<
    unsafe extern "C" fn(c: fmi2Component, FMUstate: *mut fmi2FMUstate) -> fmi2Status,
>;
pub type fmi2SetFMUstateTYPE = ::core::option::Option<
    unsafe extern "C" fn(c: fmi2Component, FMUstate: fmi2FMUstate) -> fmi2Status,
>;
pub type fmi2FreeFMUstateTYPE = ::core::option::Option<
    unsafe extern "C" fn(c: fmi2Component, FMUstate: *mut fmi2FMUstate) -> fmi2Status,
>;
pub type fmi2SerializedFMUstateSizeTYPE = ::core::option::Option<
    unsafe extern "C" fn(c: fmi2Component, FMUstate: fmi2FMUstate, size: *mut usize) -> fmi2Status,
>;
pub type fmi2SerializeFMUstateTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        FMUstate: fmi2FMUstate,
        serializedState: *mut fmi2Byte,
        size: usize,
    ) -> fmi2Status,
>;
pub type fmi2DeSerializeFMUstateTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        serializedState: *const fmi2Byte,
        size: usize,
        FMUstate: *mut fmi2FMUstate,
    ) -> fmi2Status,
>;
pub type fmi2GetDirectionalDerivativeTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        vUnknown_ref: *const fmi2ValueReference,
        nUnknown: usize,
        vKnown_ref: *const fmi2ValueReference,
        nKnown: usize,
        dvKnown: *const fmi2Real,
        dvUnknown: *mut fmi2Real,
    ) -> fmi2Status,
>;
#[doc = "Types for Functions for FMI2 for Co-Simulation"]
pub type fmi2SetRealInputDerivativesTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        vr: *const fmi2ValueReference,
        nvr: usize,
        order: *const fmi2Integer,
        value: *const fmi2Real,
    ) -> fmi2Status,
>;
pub type fmi2GetRealOutputDerivativesTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        vr: *const fmi2ValueReference,
        nvr: usize,
        order: *const fmi2Integer,
        value: *mut fmi2Real,
    ) -> fmi2Status,
>;
pub type fmi2DoStepTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        currentCommunicationPoint: fmi2Real,
        communicationStepSize: fmi2Real,
        noSetFMUStatePriorToCurrentPoint: fmi2Boolean,
    ) -> fmi2Status,
>;
pub type fmi2CancelStepTYPE =
    ::core::option::Option<unsafe extern "C" fn(c: fmi2Component) -> fmi2Status>;
pub type fmi2GetStatusTYPE = ::core::option::Option<
    unsafe extern "C" fn(c: fmi2Component, s: fmi2StatusKind, value: *mut fmi2Status) -> fmi2Status,
>;
pub type fmi2GetRealStatusTYPE = ::core::option::Option<
    unsafe extern "C" fn(c: fmi2Component, s: fmi2StatusKind, value: *mut fmi2Real) -> fmi2Status,
>;
pub type fmi2GetIntegerStatusTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        s: fmi2StatusKind,
        value: *mut fmi2Integer,
    ) -> fmi2Status,
>;
pub type fmi2GetBooleanStatusTYPE = ::core::option::Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        s: fmi2StatusKind,
        value: *mut fmi2Boolean,
    ) -> fmi2Status,
>;
pub type fmi2GetStringStatusTYPE = ::core::option::Option<
    unsafe extern "C" fn(c: fmi2Component, s: fmi2StatusKind, value: *mut fmi2String) -> fmi2Status,
>;
