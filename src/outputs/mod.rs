//! What a run gives: the variables of the output groups and their values.

mod variables;

pub use variables::{Kind, Output, Variable, unit_of, variables};
