//! The masses of a layer over the rows of a run.

mod fields;

pub use fields::{ElementField, ElementFields};
