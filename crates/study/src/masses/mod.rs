//! The masses of a layer over the rows of a run: their outputs, a picture of a row, and an animation of all.

mod animation;
mod history;
mod picture;

pub use animation::animation;
pub use history::{Element, ElementField, ElementFields, ElementHistory, Instant, Span, Touch};
