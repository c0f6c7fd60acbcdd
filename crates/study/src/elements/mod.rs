//! The masses of a layer over the rows of a run: their outputs, and what pictures and animations show of them.

mod fields;
mod history;
mod page;

pub use fields::{ElementField, ElementFields};
pub use history::{Element, ElementHistory, Instant, Span, Touch};
pub use page::animation;
