//! What a run gives: the variables of the output groups and their values.

mod dependencies;
mod derivative;
mod snapshot;
mod variables;

pub use dependencies::{Dependencies, dependencies};
pub use snapshot::{Accounts, Counters, Energies, Snapshot};
pub use variables::{Kind, Output, Variable, unit_of, variable, variables};
