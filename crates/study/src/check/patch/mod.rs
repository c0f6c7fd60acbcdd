//! Elements of a tilted patch, each beside its layer, dragged along x at speeds of the table and to and fro; and the patch
//! beside one of twice as many elements along and across. Of a table that was solved for, what is solved for stands for
//! the layers.

mod check;
mod doubled;
mod elements;
mod sliding;
mod tilt;
mod wrench;

pub use check::PatchCheck;
pub use doubled::Doubled;
pub use elements::Dragged;
pub use sliding::{COMPARED, ElementErrors, Sliding};
pub use wrench::{COMPONENTS, Wrench, WrenchSeries};
