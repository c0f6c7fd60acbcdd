//! Elements and patches against what was swept, in steady sliding and along a motion to and fro.

mod drag;
mod element;
mod element_at;
mod measure;
mod patch;
mod scene;
mod to_and_fro;

pub use element::{COMPARED as COMPARED_OF_ELEMENTS, ElementCheck, PointCheck, PointChecks};
pub use patch::{
    COMPARED as COMPARED_OF_PATCHES, COMPONENTS, Doubled, Dragged, ElementErrors, PatchCheck, Sliding, Wrench,
    WrenchSeries,
};
pub use to_and_fro::Loop;
