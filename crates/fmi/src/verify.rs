//! The types of FMI 2.0 as the package `fmi-sys` generates them from the official headers when it is built: with the
//! feature `verify-bindings` they replace the committed ones, so that every export is checked against them.

#[path = "bindings.rs"]
#[rustfmt::skip]
pub mod committed;

pub use fmi_sys::fmi2::*;

/// The exports check the function types; this checks the struct's layout and the constants.
const _: () = {
    use std::mem::{offset_of, size_of};
    type Ours = committed::fmi2CallbackFunctions;
    type Theirs = fmi2CallbackFunctions;
    assert!(size_of::<Ours>() == size_of::<Theirs>());
    assert!(offset_of!(Ours, logger) == offset_of!(Theirs, logger));
    assert!(offset_of!(Ours, componentEnvironment) == offset_of!(Theirs, componentEnvironment));
    assert!(committed::fmi2Status_fmi2Discard == fmi2Status_fmi2Discard);
    assert!(committed::fmi2Status_fmi2Fatal == fmi2Status_fmi2Fatal);
    assert!(committed::fmi2Type_fmi2CoSimulation == fmi2Type_fmi2CoSimulation);
    assert!(committed::fmi2StatusKind_fmi2Terminated == fmi2StatusKind_fmi2Terminated);
};
