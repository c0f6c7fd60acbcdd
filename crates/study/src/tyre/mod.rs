//! What a tyre engineer does with a patch whose tread runs through: curves of force over slip, and the numbers of tyre
//! models fitted to them.
//!
//! | file | what it holds |
//! |---|---|
//! | `rolling` | steady rolling of a tread at a load: its height, free rolling |
//! | `slip` | forces over slip and slip angle, as a table |
//! | `magic` | the Magic Formula, fitted to slip curves |
//! | `picture` | slip curves as a picture |
//! | `property` | tyre property files: numbers read, and set with all else as it was |
//! | `curve` | peak and stiffness of force over slip |
//! | `scaling` | a property file for another road, temperature or compound |

mod curve;
mod magic;
mod picture;
mod property;
mod rolling;
mod scaling;
mod slip;

pub use crate::least_squares::Determined;
pub use magic::{Coefficient, Direction, MagicFit, MagicFormula, magic};
pub use property::PropertyFile;
pub use rolling::Rolling;
pub use scaling::{ScaledTyre, Scaling};
pub use slip::{Fit, SlipConditions, SlipCurves, SlipOptions, SlipPoint};

#[cfg(test)]
mod tests;
