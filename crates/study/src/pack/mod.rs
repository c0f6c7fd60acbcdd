//! FMUs: a scene, the table of a sweep or a patch, and shared libraries, as one archive.

mod archive;
mod description;
mod experiment;
mod fmu;
mod icon;
mod terminals;
mod verify;

pub use archive::{Library, LibraryFile, Platform};
pub use fmu::{Fmu, FmuOptions, flat_names, not_converged, summary, warnings};
pub use icon::{element_icon, layer_icon};
pub use verify::{Carried, NumberColumns, Verified, verify};
