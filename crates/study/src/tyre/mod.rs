//! What a tyre engineer does with a patch whose tread runs through: curves of force over slip, and the numbers of tyre
//! models fitted to them.
//!
//! | file | what it holds |
//! |---|---|
//! | `rolling` | steady rolling of a tread at a load: its height, free rolling |
//! | `slip` | forces over slip and slip angle, as a table |
//! | `least_squares` | a formula's numbers fitted to data, and which of them these determine |
//! | `magic` | the Magic Formula, fitted to slip curves |
//! | `picture` | slip curves as a picture |

mod least_squares;
mod magic;
mod picture;
mod rolling;
mod slip;

pub use least_squares::Determined;
pub use magic::{Coefficient, Direction, MagicFit, MagicFormula, magic};
pub use rolling::Rolling;
pub use slip::{Fit, SlipConditions, SlipCurves, SlipOptions, SlipPoint};

#[cfg(test)]
mod tests;
