//! The FMU: the C interface of FMI 2.0 for co-simulation around a [`Simulation`](asperity::simulation::Simulation) of a
//! layer, an [`Element`](asperity::element::Element) that interpolates the forces in a table, a
//! [patch](asperity::patch::PatchRun) of many, or a [lip with a film](asperity::seal::SealRun).
//!
//! The exports check pointers and then call a method of an instance in safe Rust. Each file uses only those above it:
//!
//! | file | what it holds |
//! |------|---------------|
//! | `bindings` | C types, generated from the standard's headers |
//! | `lifecycle` | states of an instance and the functions allowed in each |
//! | `error` | errors with the status that each returns; panics; memory that the system would refuse |
//! | `resources` | the file of the scene, table or patch in the FMU's resources |
//! | `history` | the values that an input had |
//! | `inputs` | inputs as a master sets them, and where they go in a communication step |
//! | `variables` | the table of variables by value reference |
//! | `log` | messages by category |
//! | `model` | what all layers below ask of a model and of its run |
//! | `layer`, `element`, `patch`, `seal` | the four models |
//! | `provisional` | the last step, where it is done again once the values at its end are known |
//! | `definition` | what an FMU simulates: one of them, its parameters, its GUID |
//! | `state` | the state of an instance, its copy in an FMU state, its clock |
//! | `fmu_states` | FMU states handed out, and as byte strings |
//! | `instance` | an instance: its functions |
//! | `values` | functions that get and set variables, and derivatives |
//! | `callbacks` | the master's logger (unsafe code) |
//! | `exports` | the 34 C functions (unsafe code) |

mod callbacks;
mod definition;
mod element;
mod error;
mod exports;
mod fmu_states;
mod history;
mod inputs;
mod instance;
mod layer;
mod lifecycle;
mod log;
mod model;
mod patch;
mod provisional;
mod resources;
mod seal;
mod state;
mod values;
mod variables;

#[cfg_attr(feature = "verify-bindings", path = "verify.rs")]
#[rustfmt::skip]
pub mod bindings;

pub use definition::{Definition, Sources, guid};
pub use error::InputOutOfRange;
pub use exports::*;
pub use inputs::{CommunicationStep, InputScales, Inputs, ProvisionalStep};
pub use layer::{layer_motion, layer_scales, layer_start};
pub use log::Category;
pub use model::{CarriedFile, Experiment, FmuModel};
pub use resources::{PATCH_FILE, SCENE_FILE, SEAL_FILE, TABLE_FILE};
pub use variables::{Kind, Role, VariableRef, VariableTable};

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
