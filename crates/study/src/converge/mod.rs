//! Whether area and friction of a scene depend on its spacing, its length or on chance.

mod error;
mod measure;
mod picture;
mod plan;
mod study;
mod table;
mod variants;
mod verdict;

pub use error::ConvergeError;
pub use picture::picture;
pub use study::{ConvergenceOptions, ConvergenceStudy, Ended, Findings, Round};
pub use table::{Measured, RunRow, RunsDone, StudyHeader, StudyTableError};
pub use variants::{Dimensions, Parts, Variant};
pub use verdict::{LargestOpen, Open, Pair, Source, Verdict, percent};
