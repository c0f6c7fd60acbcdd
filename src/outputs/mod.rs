//! What a run gives: the variables of the output groups and their values.

mod dependencies;
mod derivative;
mod moment;
mod variables;

pub use dependencies::{Dependencies, dependencies};
pub use moment::{Accounts, Counters, Energies, Moment};
pub use variables::{Kind, Output, Variable, unit_of, variable, variables};
