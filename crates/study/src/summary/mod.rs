//! What there is in a scene, in an element's table and in a patch, in lines: what is printed of them, and what the
//! documentation of an FMU says.

mod described;
mod fine;
mod foundation;
mod friction;
mod heating;
mod json;
mod motion;
mod patch;
mod reduction;
mod scene;
mod short;
mod table;
mod words;

pub use described::{described, described_patch, described_shortly};
pub use fine::{FineFrictionCurve, MIDDLE as MIDDLE_PRESSURE};
pub use friction::FallingFriction;
pub use json::DescribedScene;
pub use patch::{missing_backing, patch_rows};
pub use scene::scene_rows;
pub use table::table_rows;
