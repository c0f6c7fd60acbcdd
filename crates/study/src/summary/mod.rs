//! What there is in a scene, in an element's table and in a patch, in lines: what is printed of them, and what the
//! documentation of an FMU says.

mod foundation;
mod friction;
mod patch;
mod scene;
mod seal;
mod words;

pub use friction::FallingFriction;
pub use patch::{described_patch, missing_backing, patch_rows, table_rows};
pub use scene::{DescribedScene, described, described_shortly, picture, scene_rows};
pub use seal::{described_seal, seal_rows};
pub use words::{LabelledLine, labelled};
