//! Scenes, patches and other files, read.

use std::io;
use std::path::{Path, PathBuf};

use asperity::patch::{Patch, PatchError};
use asperity::scene::{FileFormats as _, Scene, SceneError, read_file, read_text};
use asperity::tables::{ContentError, text_or_sheet};
use asperity_formats::Instruments;

use crate::settings::{self, OverrideError, Refusal, Setting};

/// A file cannot be read, or the scene or the patch in it is refused.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The patch.
    #[error(transparent)]
    Patch(#[from] PatchError),
    /// A key that is set in it.
    #[error(transparent)]
    Set(#[from] OverrideError),
    /// The file.
    #[error("cannot read {}: {}", .path.display(), reason(.path, .source))]
    Io {
        /// The file's path.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

impl<E: Into<ReadError>> From<Refusal<E>> for ReadError {
    fn from(refusal: Refusal<E>) -> Self {
        match refusal {
            Refusal::Own(error) => error.into(),
            Refusal::Set(error) => error.into(),
        }
    }
}

/// What the system says of a file at `path`, or that there is no such folder.
pub fn reason(path: &Path, source: &io::Error) -> String {
    let folder = path.parent().filter(|folder| *folder != Path::new("") && !folder.exists());
    folder.map_or_else(|| source.to_string(), |folder| format!("there is no folder {}", folder.display()))
}

/// Reads a scene from `text`, its keys set to other values, as if it were the content of `file`.
///
/// # Errors
/// Where the text or what is set in it is refused.
pub fn parse_scene(text: &str, file: &Path, set: &[Setting]) -> Result<Scene, ReadError> {
    Ok(settings::scene(text, file, set)?)
}

/// Reads the scene at `path`, its keys set to other values.
///
/// # Errors
/// Where the file cannot be read, or its text or what is set in it is refused.
pub fn load_scene(path: &Path, set: &[Setting]) -> Result<Scene, ReadError> {
    parse_scene(&text(path)?, path, set)
}

/// Reads the patch at `path`, its keys set to other values.
///
/// # Errors
/// As for [`load_scene`].
pub fn load_patch(path: &Path, set: &[Setting]) -> Result<Patch, ReadError> {
    Ok(settings::patch(&text(path)?, path, set)?)
}

/// The text of the file at `path`.
///
/// # Errors
/// Where it cannot be read.
pub fn text(path: &Path) -> Result<String, ReadError> {
    read_text(path).map_err(|source| ReadError::Io { path: path.to_owned(), source })
}

/// The bytes of the file at `path`.
///
/// # Errors
/// Where it cannot be read.
pub fn bytes(path: &Path) -> Result<Vec<u8>, ReadError> {
    read_file(path).map_err(|source| ReadError::Io { path: path.to_owned(), source })
}

/// What `read` makes of the bytes of a file of a table, or of a sheet of a workbook; then with a note of its name.
///
/// # Errors
/// Those of `read`, and where several sheets could be meant.
pub fn read_table<T>(
    bytes: &[u8],
    read: impl Fn(&[u8]) -> Result<T, ContentError>,
) -> Result<(T, Option<String>), ContentError> {
    let (content, sheet) = text_or_sheet(bytes, Instruments.sheets(bytes), read)?;
    Ok((content, sheet.map(|(_, note)| note.text)))
}

/// The file's name without its folder.
pub fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
