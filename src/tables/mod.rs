//! What the readers of files share: fields of lines, units, ranges of numbers, what is wrong in a file, and
//! kinds of files with columns in their canonical form.
//!
//! The engine reads files in their canonical form alone ([`FileKind`]); those that people and instruments write are read
//! by `asperity-formats`.

mod error;
mod kind;
mod range;
mod text;
mod units;

pub use error::{ContentError, assignment, shortened};
pub use kind::{
    FileKind, GivenColumns, Others, Presence, ReadColumn, ReadTable, ReadingNote, Role, UnitRule, canonical,
    canonical_name,
};
pub use range::{ABOVE_ZERO, ANY, FINITE, LARGEST, NOT_NEGATIVE, NumberRange, POSITIVE, SMALLEST};
pub use text::{fields, quoted, unquoted};
pub use units::{CYCLES, Dimension, Unit, quantity, quantity_with_unit};
