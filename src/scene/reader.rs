//! From TOML text to a [`Scene`].

use std::path::Path;

use super::{Scene, SceneError};

impl Scene {
    /// Reads the scene file at `path` and the files that it names.
    ///
    /// # Errors
    /// See [`SceneError`].
    pub fn load(_path: &Path) -> Result<Self, SceneError> {
        Err(SceneError)
    }
}
