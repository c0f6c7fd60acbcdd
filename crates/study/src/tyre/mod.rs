//! What a tyre engineer does with a patch whose tread runs through: curves of force over slip, and the numbers of tyre
//! models fitted to them.
//!
//! | file | what it holds |
//! |---|---|
//! | `rolling` | steady rolling of a tread at a load: its height, free rolling |
//! | `slip` | forces over slip and slip angle, as a table |
//! | `picture` | slip curves as a picture |

mod picture;
mod rolling;
mod slip;

pub use rolling::Rolling;
pub use slip::{Fit, SlipConditions, SlipCurves, SlipOptions, SlipPoint};
