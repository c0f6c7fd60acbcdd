//! Prony series fitted to measured moduli.
//!
//! Moduli are read as people and instruments write them ([`FitOptions`]); those of several temperatures become those of one
//! by shift factors that are given or found; and the series with the fewest terms within an error is searched for:
//! [`fit_moduli`].

mod columns;
mod compound;
mod conditions;
mod consistency;
mod fitted;
mod measured;
mod nnls;
mod options;
mod prony;
mod shift;
mod table;
mod temperatures;

pub use columns::ROLES;
pub use compound::{FitErrors, RelativeError, Sample, Test};
pub use consistency::{Consistency, DecadeConsistency};
pub use fitted::{FittedModuli, fit_moduli};
pub use options::{FitOptions, Vertical, Weight, WlfConstants};
pub use temperatures::{SHIFTS, ShiftedCurve};
