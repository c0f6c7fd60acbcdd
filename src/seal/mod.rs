//! A lip with a film of fluid: what rubs and leaks where a seal runs in oil (docs/seal.md).
//!
//! The lip stands, the other side, a rod, moves along it. The total pressure on the lip is known: its own elasticity gives it.
//! Contacts bear what the fluid does not, by the table of a sweep with gaps, and the fluid's content over the width is one
//! conserved field.

mod definition;
mod derivatives;
mod film;
mod law;
mod rod;
mod run;
mod step;
#[cfg(test)]
mod tests;
mod variables;

pub use definition::{Seal, SealError};
pub use run::{FilmError, FilmRestoreError, SealMotion, SealRun, SealStart, SealState};
pub use variables::{SealOutput, SealVariable, catalogue, unit_of};
