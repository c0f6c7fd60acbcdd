//! Why the program stops.

use std::path::{Path, PathBuf};

use asperity::element::TableError;
use asperity::scene::{ParameterError, SceneError};
use asperity::simulation::SimulationError;

use super::fit::Refusal;
use super::sweep::SweepError;

/// Why the program stops; its text is the one line that the user sees.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ProgramError {
    /// The scene is refused.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The table is refused.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A parameter of the command line is refused.
    #[error("--set: {0}")]
    Parameter(#[from] ParameterError),
    /// The run cannot begin.
    #[error("the run cannot start: {0}")]
    Start(SimulationError),
    /// What is to be told cannot be written as JSON.
    #[error("cannot be written as JSON: {0}")]
    Json(serde_json::Error),
    /// Options for a file with a profile, but the file is a scene.
    #[error("{}: a scene says itself how its surface is read; the options are for profiles", .path.display())]
    SceneHasOptions { path: PathBuf },
    /// The run could not go on.
    #[error("{source}; the rows so far, up to t = {time} s, are in {}", .output.display())]
    Run { source: SimulationError, time: f64, output: PathBuf },
    /// There is no run to report on.
    #[error("the scene {0}")]
    NoRun(&'static str),
    /// No run comes to its end, so that there is nothing to compare with.
    #[error("no reference: not even the loosest tolerance comes to its end: {0}")]
    Reference(SimulationError),
    /// A sweep stops, or has points without a result.
    #[error(transparent)]
    Sweep(#[from] SweepError),
    /// A file cannot be read or written.
    #[error("cannot {action} {}: {}", .path.display(), reason(.path, .source))]
    File { action: &'static str, path: PathBuf, source: std::io::Error },
    /// An output would take the place of what the command reads or writes already.
    #[error("will not write {}: it is read or written here already", .path.display())]
    Overwrites { path: PathBuf },
    /// A result file is not one.
    #[error("{}: {message}", .path.display())]
    ResultFile { path: PathBuf, message: String },
    /// A table of measured moduli is refused.
    #[error("{}:{refusal}", .path.display())]
    Moduli { path: PathBuf, refusal: Refusal },
    /// The fit is written, but its error is larger than was asked for.
    #[error(
        "the error asked for, {wanted}, cannot be had: {reached} is about the least of any series with moduli of 0 or more, \
         and {} has such a one; for less the data are too uneven, and --error takes what is enough",
        .output.display()
    )]
    FitError { wanted: String, reached: String, output: PathBuf },
    /// A temperature that the scene cannot have.
    #[error("{option}: {refusal}")]
    Temperature { option: &'static str, refusal: ParameterError },
    /// A temperature for a scene without any.
    #[error("--temperature: the scene has no material.wlf, so nothing in it depends on temperature")]
    NoTemperature,
    /// A direct form that names no link.
    #[error("the scene has neither a material nor a link, so there is nothing that a modulus could be of")]
    NoLinks,
    /// What the command line asks of `plot` cannot be.
    #[error("--labels: expected {files}, one name for each file, found {labels}")]
    Labels { labels: usize, files: usize },
    /// A picture cannot be drawn.
    #[error("cannot draw {}: {message}", .path.display())]
    Picture { path: PathBuf, message: String },
    /// The shared library is not there.
    #[error(
        "no shared library at {}: build it with `cargo rustc --release --lib --no-default-features --crate-type \
         cdylib` and name it with --library, or use build-fmu.sh, which does both",
        .path.display()
    )]
    NoLibrary { path: PathBuf },
    /// Two libraries for one platform.
    #[error("--library: two of {platform}: {} and {}", .first.display(), .second.display())]
    SamePlatform { platform: &'static str, first: PathBuf, second: PathBuf },
    /// A file of the scene has no place in the archive.
    #[error("the scene reads {}, which is not below the scene's folder: an FMU carries only what is", .path.display())]
    Outside { path: PathBuf },
    /// The archive cannot be written.
    #[error("cannot pack: {0}")]
    Archive(#[from] zip::result::ZipError),
    /// A document of the archive cannot be written.
    #[error("cannot write {document}: {source}")]
    Document { document: &'static str, source: std::io::Error },
}

/// Why a file cannot be read or written.
fn reason(path: &Path, source: &std::io::Error) -> String {
    let folder = path.parent().filter(|folder| *folder != Path::new("") && !folder.exists());
    folder.map_or_else(|| source.to_string(), |folder| format!("there is no folder {}", folder.display()))
}

impl ProgramError {
    /// The picture at `path` could not be drawn.
    pub(crate) fn picture(path: &Path, error: &dyn std::error::Error) -> Self {
        Self::Picture { path: path.to_owned(), message: error.to_string() }
    }

    /// For `map_err`: `action` ("read", "write") on `path` failed.
    pub(crate) fn file(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |source| Self::File { action, path, source }
    }
}
