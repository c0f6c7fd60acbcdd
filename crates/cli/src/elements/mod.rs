//! The masses of a layer over the rows of a run, as arrays and as an animation.

mod arrays;
mod page;

pub(crate) use arrays::{ArraysError, write as write_arrays};
pub(crate) use page::write as write_page;
