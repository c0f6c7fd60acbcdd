//! Prony series fitted to measured moduli.
//!
//! Moduli are read as people and instruments write them ([`FitOptions`]); those of several temperatures become those of one
//! by shift factors that are given or found; and the series with the fewest terms within an error is searched for:
//! [`fit_moduli`].

mod columns;
mod compound;
mod consistency;
mod curves;
mod error;
mod file;
mod fitted;
mod heading;
mod measured;
mod nnls;
mod options;
mod picture;
mod prony_problem;
mod reading;
mod sample;
mod search;
mod shift;
mod shift_error;
mod stated_temperature;
mod table;
mod temperatures;
mod vertical;

pub use columns::ROLES;
pub use compound::{FitErrors, RelativeError};
pub use consistency::{Consistency, DecadeConsistency};
pub use error::FitError;
pub use fitted::{FittedModuli, fit_moduli};
pub use options::{FitOptions, Vertical, Weight, WlfConstants};
pub use sample::{Sample, Test};
pub use shift_error::ShiftError;
pub use temperatures::{SHIFTS, ShiftedCurve};
