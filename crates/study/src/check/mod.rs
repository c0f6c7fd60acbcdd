//! Elements and patches against what was swept, in steady sliding and along a motion to and fro. Elements of a patch stand
//! tilted, each beside its layer, and the patch beside one of twice as many elements along and across. Of a table that was
//! solved for, what is solved for stands for the layers.

mod doubled;
mod drag;
mod element;
mod measure;
mod patch;
mod picture;
mod sliding;
mod tilt;

pub use doubled::Doubled;
pub use drag::Loop;
pub use element::{COMPARED as COMPARED_OF_ELEMENTS, ElementCheck, PointCheck, PointChecks};
pub use measure::{COMPONENTS, Wrench, WrenchSeries};
pub use patch::{Dragged, PatchCheck};
pub use sliding::{COMPARED as COMPARED_OF_PATCHES, ElementErrors, Sliding};
