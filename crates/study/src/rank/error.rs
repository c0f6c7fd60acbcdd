//! Why scenes are not ranked.

use std::path::PathBuf;

use asperity::tables::ContentError;

use crate::csv::CsvError;
use crate::error::Error;
use crate::progress::Stopped;

/// The scenes cannot be ranked.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum RankError {
    #[error(transparent)]
    Read(#[from] Error),
    #[error("{scene}: {error}")]
    Sweep { scene: String, error: Box<Error> },
    #[error(transparent)]
    Csv(#[from] CsvError),
    #[error("expected at least 2 scenes to rank, found {0}")]
    TooFew(usize),
    #[error("the scenes have other temperatures of their own: {0}; expected `temperatures`, at which all are compared")]
    OtherTemperatures(String),
    #[error("{}", .error.within(.path))]
    Weights { path: PathBuf, error: ContentError },
    #[error("{}:{line}: a weight of a point that is not asked for: {point}", .path.display())]
    NotAsked { path: PathBuf, line: usize, point: String },
    #[error("{}:{line}: {point} has a weight in line {other} already", .path.display())]
    Twice { path: PathBuf, line: usize, other: usize, point: String },
    #[error("{}: no weight of {points}", .path.display())]
    NoWeight { path: PathBuf, points: String },
    #[error("{}: expected a weight above 0", .path.display())]
    AllZero { path: PathBuf },
    #[error("there is no point at which all scenes have a result: {0}")]
    NoPoint(String),
    #[error(
        "{0}: its friction in the mean is not above 0, so that nothing can be compared with it: name another scene first"
    )]
    NoFriction(String),
    #[error("{failed} of {count} samples have no result: {left} are too few to rank by")]
    NoSamples { failed: usize, count: usize, left: usize },
    #[error("{}: {problem}", .path.display())]
    Measured { path: PathBuf, problem: String },
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

impl From<RankError> for Error {
    fn from(error: RankError) -> Self {
        match error {
            RankError::Read(error) => error,
            error @ (RankError::Sweep { .. } | RankError::OtherTemperatures(_) | RankError::Uncertainty(_)) => {
                Self::scene(error)
            }
            error => Self::value(error),
        }
    }
}
