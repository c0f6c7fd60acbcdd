//! What stops a calibration.

use std::path::PathBuf;

use asperity::element::OperatingPoint;
use asperity::scene::{ParameterError, did_you_mean, similar_keys};
use asperity::tables::ContentError;
use rmpfit::MPError;

use crate::error::Error;

/// Why there is no steady sliding at a point, as tables of points have it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NoSliding(String);

impl NoSliding {
    /// For this reason.
    pub fn new(reason: impl ToString) -> Self {
        Self(reason.to_string())
    }

    /// The reason.
    pub fn reason(&self) -> &str {
        &self.0
    }
}

/// A model has no friction at some values of the parameters, or the least squares of it cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The scene is not possible at some values within the bounds.
    #[error("{parameters}: {problem}")]
    Scene {
        /// The values, by key.
        parameters: String,
        /// Why the scene is refused.
        problem: Box<Error>,
    },
    /// The scene has no steady sliding to be solved for.
    #[error("steady sliding takes a scene in the material form, with layer.width")]
    NotSolvable,
    /// Persson's theory knows nothing of the scene.
    #[error("Persson's theory takes a scene in the material form, with layer.width")]
    NoTheory,
    /// Steady sliding of the scene is not solved for; of these words the method that it has.
    #[error("{0}")]
    Layer(String),
    /// Steady sliding of the scene cannot be solved for.
    #[error(transparent)]
    Method(#[from] Error),
    /// The method of Levenberg and Marquardt has met what it cannot go on with.
    #[error("the fit cannot go on: {0}")]
    LeastSquares(MPError),
    /// Who waits for it says to stop.
    #[error("stopped")]
    Stopped,
    /// Points of the measurements that cannot be simulated at the parameters tried.
    #[error("{} points cannot be simulated", .0.len())]
    NotSteady(Vec<(OperatingPoint, NoSliding)>),
    /// No measurement is left.
    #[error(
        "{rows} measurements can be simulated, fewer than the {parameters} free parameters{}",
        .left_out.as_ref().map_or_else(String::new, |left_out| format!("; {left_out}"))
    )]
    TooFew {
        /// How many there are.
        rows: usize,
        /// The free parameters.
        parameters: usize,
        /// Which others there are, and why they cannot.
        left_out: Option<String>,
    },
}

/// The parameters to fit are none of the scene.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum FreeParameterError {
    #[error(
        "`free` {key}: expected a number in the scene file, to start from; the file has none there{}",
        did_you_mean(&similar_keys(key))
    )]
    NoNumber { key: String },
    #[error("`free` {key}: expected it once")]
    Twice { key: String },
    #[error("`free`: expected a parameter to fit, found none")]
    None,
    #[error("`free`: expected at most {most} parameters, found {found}")]
    Many { most: usize, found: usize },
    #[error("`free` {key}: expected a scene whose steady sliding is solved for: the layer has no heat in it")]
    HeatOfLayer { key: String },
    #[error("`free` {key}: {problem}")]
    Bound { key: String, problem: ModelError },
}

/// The table of measured friction does not go with the scene, or is none.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum MeasuredFrictionError {
    #[error(transparent)]
    Read(#[from] Error),
    #[error("{}", .error.within(.path))]
    Content { path: PathBuf, error: ContentError },
    #[error("{}: the scene has no material.wlf, so nothing in it depends on the temperature of the data", .0.display())]
    NoWlf(PathBuf),
    #[error("{}:{line}: {problem}", .path.display())]
    Temperature { path: PathBuf, line: usize, problem: ParameterError },
    #[error("{}:{line}: {problem}", .path.display())]
    Way { path: PathBuf, line: usize, problem: Error },
}

impl From<MeasuredFrictionError> for Error {
    fn from(error: MeasuredFrictionError) -> Self {
        match error {
            MeasuredFrictionError::Read(error) => error,
            error => Self::value(error),
        }
    }
}

/// A calibration refuses the scene, the data or the parameters, or cannot go on.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum CalibrationError {
    #[error(transparent)]
    Read(#[from] Error),
    #[error("the scene has no material or layer.width, so nothing in it has a pressure: expected the material form")]
    NoArea,
    #[error("the scene has [carrier.x]; expected none, since the speed is prescribed")]
    BodyAlongX,
    #[error(transparent)]
    Free(#[from] FreeParameterError),
    #[error(transparent)]
    Measured(#[from] MeasuredFrictionError),
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error("cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

impl From<CalibrationError> for Error {
    fn from(error: CalibrationError) -> Self {
        match error {
            CalibrationError::Read(error) => error,
            CalibrationError::Measured(error) => error.into(),
            error => Self::value(error),
        }
    }
}
