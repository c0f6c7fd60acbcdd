//! Scenes and other files that commands read and write.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use asperity::scene::{EXCITATION, ParameterError, Scene, SceneError};

use super::terminal::{note, warn};

/// A file cannot be read or written, or its scene is invalid.
#[derive(Debug, thiserror::Error)]
pub(crate) enum FileError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error("--set: {0}")]
    Parameter(#[from] ParameterError),
    #[error("cannot {action} {}: {}", .path.display(), reason(.path, .source))]
    Io { action: &'static str, path: PathBuf, source: io::Error },
    #[error("will not write {}: it is read or written here already", .path.display())]
    Overwrites { path: PathBuf },
    #[error("cannot draw {}: {message}", .path.display())]
    Picture { path: PathBuf, message: String },
}

impl FileError {
    /// For `map_err`: `action` ("read", "write") on `path` failed.
    pub(crate) fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |source| Self::Io { action, path, source }
    }

    pub(crate) fn picture(path: &Path, error: &dyn std::error::Error) -> Self {
        Self::Picture { path: path.to_owned(), message: error.to_string() }
    }
}

fn reason(path: &Path, source: &io::Error) -> String {
    let folder = path.parent().filter(|folder| *folder != Path::new("") && !folder.exists());
    folder.map_or_else(|| source.to_string(), |folder| format!("there is no folder {}", folder.display()))
}

/// Reads a scene and prints its warnings, and what was assumed in reading its tables.
pub(crate) fn load(path: &Path) -> Result<Scene, FileError> {
    let scene = Scene::load(path)?;
    scene.warnings.iter().for_each(|warning| warn(warning));
    scene.notes.iter().filter(|read| read.assumed).for_each(|read| note(&read.text));
    Ok(scene)
}

/// Overrides parameters as `--set` gives them, then checks the scene as a whole.
pub(crate) fn set_parameters(scene: &mut Scene, set: &[(String, String)]) -> Result<(), FileError> {
    set.iter().try_for_each(|(key, value)| match key.starts_with(EXCITATION) {
        true => scene.set_excitation(key, value),
        false => scene.set_by_name(key, value),
    })?;
    Ok(scene.check()?)
}

/// The files that a scene is read from.
pub(crate) fn sources(path: &Path, scene: &Scene) -> Vec<PathBuf> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let files = scene.files.iter().chain(scene.extracts.iter().map(|extract| &extract.source));
    std::iter::once(path.to_owned()).chain(files.map(|file| folder.join(file))).collect()
}

/// Refuses an output that would overwrite one of `others`. A file that does not exist yet overwrites none.
pub(crate) fn check_output(output: &Path, others: &[PathBuf]) -> Result<(), FileError> {
    let resolved = |path: &Path| path.canonicalize().ok();
    let same = |other: &PathBuf| other == output || (resolved(output).is_some() && resolved(other) == resolved(output));
    if others.iter().any(same) { Err(FileError::Overwrites { path: output.to_owned() }) } else { Ok(()) }
}

/// Refuses outputs that would overwrite one of `taken` or one another.
pub(crate) fn check_outputs<'a>(
    outputs: impl IntoIterator<Item = &'a PathBuf>,
    mut taken: Vec<PathBuf>,
) -> Result<(), FileError> {
    outputs.into_iter().try_for_each(|output| {
        check_output(output, &taken)?;
        taken.push(output.clone());
        Ok(())
    })
}

pub(crate) fn read(path: &Path) -> Result<Vec<u8>, FileError> {
    fs::read(path).map_err(FileError::io("read", path))
}

pub(crate) fn write(path: &Path, content: impl AsRef<[u8]>) -> Result<(), FileError> {
    fs::write(path, content).map_err(FileError::io("write", path))
}

/// Writes a file at once: what is at `path` is the one before or this one, whole.
pub(crate) fn replace(path: &Path, text: &str) -> Result<(), FileError> {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    let part = PathBuf::from(part);
    let write = || {
        let mut file = File::create(&part)?;
        file.write_all(text.as_bytes())?;
        file.sync_all()?;
        fs::rename(&part, path)
    };
    write().map_err(FileError::io("write", path))
}

/// A file to which lines are added, from any thread.
#[derive(Debug)]
pub(crate) struct LineFile {
    path: PathBuf,
    /// A line is written at once, so that one that is cut off has no end.
    file: Mutex<File>,
}

impl LineFile {
    /// A file that begins with `text`, in the place of what was at `path`.
    pub(crate) fn create(path: &Path, text: &str) -> Result<Self, FileError> {
        replace(path, text)?;
        let file = OpenOptions::new().append(true).open(path).map_err(FileError::io("write", path))?;
        Ok(Self { path: path.to_owned(), file: Mutex::new(file) })
    }

    /// Adds a line, its end included; it is in the file when this returns.
    pub(crate) fn add(&self, line: &str) -> Result<(), FileError> {
        let mut file = self.file.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let written = file.write_all(line.as_bytes()).and_then(|()| file.sync_data());
        written.map_err(FileError::io("write", &self.path))
    }
}

pub(crate) fn print(text: &str) -> Result<(), FileError> {
    io::stdout().write_all(text.as_bytes()).map_err(FileError::io("write", Path::new("standard output")))
}

/// Whether the file has the extension `ending`, in either case.
pub(crate) fn ends_in(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending))
}

/// The file's name without its folder.
pub(crate) fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
