//! The FMU: the C interface of FMI 2.0 for co-simulation around a [`Simulation`](crate::simulation::Simulation) of a
//! layer, or an [`Element`](crate::element::Element) that looks the forces up.
//!
//! The exports check what a C caller can get wrong and then call a method of an instance in safe Rust. What may be
//! called when is one table, what a value reference means is one [`Catalogue`], which the writer of the model
//! description uses too. Two files hold unsafe code: `exports` (raw pointers in) and `callbacks` (the master's logger).

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
pub use resources::{SCENE_FILE, TABLE_FILE};

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
