//! What there is in a scene, in an element's table and in a patch, in lines: what is printed of them, and what the
//! documentation of an FMU says.

mod described;
mod fine;
mod foundation;
mod friction;
mod patch;
mod picture;
mod scene;
mod words;

pub use described::{DescribedScene, described, described_patch, described_shortly};
pub use friction::FallingFriction;
pub use patch::{missing_backing, patch_rows, table_rows};
pub use picture::picture;
pub use scene::scene_rows;

/// A line with a label; without one it continues the line above.
pub type LabelledLine = (&'static str, String);

/// Lines of which the first has the label.
pub fn labelled(label: &'static str, texts: impl IntoIterator<Item = String>) -> Vec<LabelledLine> {
    texts.into_iter().enumerate().map(|(i, text)| (if i == 0 { label } else { "" }, text)).collect()
}
