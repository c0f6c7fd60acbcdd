//! Whether area and friction of a scene depend on its spacing, its length or on chance.

mod picture;
mod plan;
mod study;
mod table;
mod variants;

pub use picture::picture;
pub use plan::{LargestOpen, Open, Pair, Source, Verdict, percent};
pub use study::{ConvergenceOptions, ConvergenceStudy, Ended, Findings, Round};
pub use table::{Measured, RunRow, StudyHeader};
pub use variants::{Dimensions, Parts, Variant};
