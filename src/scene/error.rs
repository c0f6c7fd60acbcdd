//! Why a scene is refused.

/// Why a scene is refused: what was expected, what was found, and where.
#[derive(Debug, thiserror::Error)]
#[error("not yet")]
pub struct SceneError;
