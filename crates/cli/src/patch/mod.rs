//! Contact patches on the command line.

mod describe;
mod simulate;

pub(crate) use describe::{describe, rows, warn_of_missing_backing};
pub(crate) use simulate::simulate;
