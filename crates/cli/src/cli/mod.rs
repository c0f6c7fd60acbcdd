//! The command line: what arguments of several commands share, and those of `fit`, `report` and `surface`.

mod measurements;
mod runs;
pub(crate) mod values;

pub(crate) use measurements::{Fit, Surface};
pub(crate) use runs::Report;
