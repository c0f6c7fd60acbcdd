//! What stops a calibration.

use asperity::element::OperatingPoint;

/// A calibration cannot go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    /// The scene is not possible at some values within the bounds.
    #[error("{parameters}: {problem}")]
    Scene {
        /// The values, by key.
        parameters: String,
        /// Why the scene is refused.
        problem: String,
    },
    /// The scene has no friction that this model could give.
    #[error("{0}")]
    Model(String),
    /// What was found could not be kept.
    #[error("{0}")]
    NotKept(String),
    /// Points of the measurements that cannot be simulated at the parameters tried.
    #[error("{} points cannot be simulated", .0.len())]
    NotSteady(Vec<(OperatingPoint, String)>),
    /// No measurement is left.
    #[error("{rows} measurements can be simulated, fewer than the {parameters} free parameters")]
    TooFew {
        /// How many there are.
        rows: usize,
        /// The free parameters.
        parameters: usize,
    },
}
