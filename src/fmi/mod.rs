//! The FMU: the C interface of FMI 2.0 for co-simulation around a [`Simulation`](crate::simulation::Simulation) of a
//! layer, an [`Element`](crate::element::Element) that interpolates the forces in a table, or a
//! [patch](crate::patch::PatchRun) of many.
//!
//! The exports check pointers and then call a method of an instance in safe Rust. Each file uses only those above it:
//!
//! | file | what it holds |
//! |------|---------------|
//! | `bindings` | C types, generated from the standard's headers |
//! | `lifecycle` | states of an instance and the functions allowed in each |
//! | `error` | errors with the status that each returns; panics |
//! | `resources` | the file of the scene or table in the FMU's resources |
//! | `definition` | what the FMU simulates, its parameters, variables by value reference, GUID |
//! | `inputs` | inputs and the carrier's motion between communication points |
//! | `patch_inputs` | the same of a patch |
//! | `model` | the instance's model: a simulation of the layer, an element or a patch |
//! | `state` | the state of an instance, its copy in an FMU state, its clock |
//! | `fmu_states` | FMU states handed out, and as byte strings |
//! | `log` | messages by category, warnings of runs that the scene does not cover |
//! | `instance` | an instance: its functions |
//! | `values` | functions that get and set variables, and derivatives |
//! | `callbacks` | the master's logger (unsafe code) |
//! | `exports` | the 34 C functions (unsafe code) |

mod callbacks;
mod definition;
mod error;
mod exports;
mod fmu_states;
mod inputs;
mod instance;
mod lifecycle;
mod log;
mod model;
mod patch_inputs;
mod resources;
mod state;
mod values;

#[cfg_attr(feature = "verify-bindings", path = "verify.rs")]
#[rustfmt::skip]
pub mod bindings;

pub use definition::{Catalogue, Definition, Entry, Input, Kind, Sources, guid};
pub use error::InputOutOfRange;
pub use exports::*;
pub use inputs::Inputs;
pub use log::Category;
pub use patch_inputs::PatchInput;
pub use resources::{PATCH_FILE, SCENE_FILE, TABLE_FILE};

/// The capabilities that the model description claims, as attributes of its element `CoSimulation`; those left out are
/// false.
pub const CAPABILITIES: [(&str, &str); 7] = [
    ("canHandleVariableCommunicationStepSize", "true"),
    ("canInterpolateInputs", "true"),
    ("maxOutputDerivativeOrder", "1"),
    ("canGetAndSetFMUstate", "true"),
    ("canSerializeFMUstate", "true"),
    ("providesDirectionalDerivative", "true"),
    ("canNotUseMemoryManagementFunctions", "true"),
];
