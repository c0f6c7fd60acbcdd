//! Why no samples are drawn.

use crate::error::of_kind;

of_kind! { UncertaintyError => Scene }

/// Scenes cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum UncertaintyError {
    #[error("`samples`: expected a scene with a section [uncertainty], which says how far its numbers may be off")]
    Nothing,
    #[error("`samples`: expected a number from 2 to {most}, found {found}")]
    Count { most: usize, found: usize },
    #[error(
        "[uncertainty] has {found} dimensions, expected up to {most}: leave keys out, or give the whole spectrum one factor"
    )]
    Dimensions { most: usize, found: usize },
    #[error(
        "{refused} of {drawn} draws are no scene, expected one of ten at most; the first: {problem}; give {key} less in \
         [uncertainty]"
    )]
    Refused { key: String, problem: String, refused: usize, drawn: usize },
    #[error("sample {sample}: {problem}")]
    Sample { sample: usize, problem: String },
}
