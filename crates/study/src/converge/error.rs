//! Why the convergence of a scene is not studied.

use std::path::PathBuf;

use crate::error::Error;

/// The scene does not go with what is asked of the study.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum ConvergeError {
    #[error(transparent)]
    Read(#[from] Error),
    #[error("cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    #[error(
        "{}: the scene is in the direct form: its masses and links do not follow the spacing, so nothing could converge; \
         give [material], layer.width and layer.foundation",
        .path.display()
    )]
    DirectForm { path: PathBuf },
    #[error(
        "{}: layer.roughness has one height for each mass, and none for the masses between at half the spacing: give x too, \
         or another kind",
        .path.display()
    )]
    HeightsAtMasses { path: PathBuf },
    #[error("{}: layer.masses and layer.spacing: expected plain numbers in the file, which the study varies, no texts with units", .path.display())]
    Unclear { path: PathBuf },
    #[error("`seeds`: neither the scene's surface nor its roughness is self_affine, so nothing depends on a seed")]
    NoSeed,
    #[error(
        "`most_{parts}`: expected at least {least}: the scene has {own} {parts}, and its spacing is halved at least once"
    )]
    FewParts { parts: &'static str, own: u64, least: u64 },
}

impl From<ConvergeError> for Error {
    fn from(error: ConvergeError) -> Self {
        match error {
            ConvergeError::Read(error) => error,
            error => Self::scene(error),
        }
    }
}
