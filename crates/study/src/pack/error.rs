//! Why nothing is packed.

use std::io;
use std::path::PathBuf;

use zip::result::ZipError;

use crate::files::ReadError;

/// An FMU cannot be packed.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum PackError {
    #[error(transparent)]
    Read(#[from] ReadError),
    #[error("no shared library at {}", .path.display())]
    NoLibrary { path: PathBuf },
    #[error("`library`: two of {platform}: {} and {}", .first.display(), .second.display())]
    SamePlatform { platform: &'static str, first: PathBuf, second: PathBuf },
    #[error("the scene reads {}, which is not below the scene's folder: an FMU carries only what is", .path.display())]
    Outside { path: PathBuf },
    #[error("`flat-names`: {first} and {second} would have one name")]
    SameName { first: String, second: String },
    #[error("cannot write {document}: {source}")]
    Document { document: &'static str, source: io::Error },
    #[error("cannot pack: {0}")]
    Zip(#[from] ZipError),
}
