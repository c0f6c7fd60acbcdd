//! Why something is not done: what was expected, what was found, and where. One type for all that is computed here; what
//! a caller does differently is its [kind](ErrorKind).
//!
//! Where the error is made, a message is enough: `Error::scene("the scene has no width")`. A file that cannot be read,
//! what is wrong in its content, and who asked for it are added on the way:
//!
//! ```ignore
//! let bytes = fs::read(path).map_err(Error::io("read", path))?;
//! let table = Table::parse(&bytes).map_err(Error::content(path))?;
//! let scene = scene.at_temperature(kelvin).context("`temperature`")?;
//! ```

use std::fmt::{self, Display};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use asperity::element::ElementError;
use asperity::math::NotEnoughMemory;
use asperity::patch::{MotionError, PatchError, PatchRestoreError};
use asperity::scene::{ParameterError, SceneError};
use asperity::seal::{FilmError, FilmRestoreError, SealError};
use asperity::simulation::{OutOfRange, SimulationError};
use asperity::table::TableError;
use asperity::tables::ContentError;

use crate::progress::Stopped;

/// What a caller does differently: the class of an exception, the exit status of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// A scene, a patch, or what is asked of one is refused.
    Scene,
    /// A table, an option or another value is refused.
    Value,
    /// A file cannot be read or written.
    File(io::ErrorKind),
    /// A run could not go on.
    Run,
    /// Nobody wants the result any more.
    Stopped,
}

/// Why something is not done. It reads like `scene.toml:12: layer.mass = -1.0: expected a number from 1e-30 to 1e30`.
#[derive(Clone, Debug)]
pub struct Error(Box<Details>);

#[derive(Clone, Debug)]
struct Details {
    kind: ErrorKind,
    file: Option<PathBuf>,
    line: Option<usize>,
    key: Option<String>,
    /// With the place.
    message: String,
    /// What the system says of a file.
    source: Option<Arc<io::Error>>,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.message)
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        let source: &io::Error = self.0.source.as_ref()?;
        Some(source)
    }
}

impl Error {
    pub(crate) fn new(kind: ErrorKind, message: impl ToString) -> Self {
        let message = message.to_string();
        Self(Box::new(Details { kind, file: None, line: None, key: None, message, source: None }))
    }

    /// A scene, a patch, or what is asked of one is refused.
    pub fn scene(message: impl ToString) -> Self {
        Self::new(ErrorKind::Scene, message)
    }

    /// A table, an option or another value is refused.
    pub fn value(message: impl ToString) -> Self {
        Self::new(ErrorKind::Value, message)
    }

    /// A run could not go on.
    pub fn run(message: impl ToString) -> Self {
        Self::new(ErrorKind::Run, message)
    }

    /// The key of a scene or a patch, and what is wrong with it.
    pub fn of_key(key: &str, problem: impl Display) -> Self {
        Self::scene(format!("{key}: {problem}")).with_key(key)
    }

    /// What is wrong in a file, in a line of it counted from 1 where one is meant.
    pub fn in_file(path: &Path, line: Option<usize>, problem: impl Display) -> Self {
        Self::value(problem).at(path, line)
    }

    /// For `map_err`: `action` ("read", "write") on the file at `path` failed.
    pub fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |error| {
            let message = format!("cannot {action} {}: {}", path.display(), reason(&path, &error));
            let mut made = Self::new(ErrorKind::File(error.kind()), message);
            (made.0.file, made.0.source) = (Some(path), Some(Arc::new(error)));
            made
        }
    }

    /// For `map_err`: what is wrong in the content of the file at `path`.
    pub fn content<E: Into<ContentError>>(path: &Path) -> impl FnOnce(E) -> Self + use<E> {
        let path = path.to_owned();
        move |error| {
            let error = error.into();
            Self::in_file(&path, error.line, &error).with_key(&error.key)
        }
    }

    /// The same error, of what `what` names: a scene of several, an option.
    #[must_use]
    pub fn context(mut self, what: impl Display) -> Self {
        self.0.message = format!("{what}: {}", self.0.message);
        self
    }

    /// The same error as one of another kind.
    #[must_use]
    pub fn of_kind(mut self, kind: ErrorKind) -> Self {
        self.0.kind = kind;
        self
    }

    fn with_key(mut self, key: &str) -> Self {
        self.0.key = Some(key.to_owned()).filter(|key| !key.is_empty());
        self
    }

    fn at(mut self, path: &Path, line: Option<usize>) -> Self {
        let in_line = line.map_or_else(String::new, |line| format!(":{line}"));
        (self.0.file, self.0.line) = (Some(path.to_owned()), line);
        self.context(format!("{}{in_line}", path.display()))
    }

    /// What a caller does differently.
    pub fn kind(&self) -> ErrorKind {
        self.0.kind
    }

    /// The file with the error; `None` where it is in none.
    pub fn file(&self) -> Option<&Path> {
        self.0.file.as_deref()
    }

    /// Its line, counted from 1; `None` where the whole file or no file is meant.
    pub fn line(&self) -> Option<usize> {
        self.0.line
    }

    /// The path of the key or the name of the column; `None` where none is meant.
    pub fn key(&self) -> Option<&str> {
        self.0.key.as_deref()
    }
}

/// What is said on the way from where an error is found to who asked.
pub trait Context<T> {
    /// Adds what the error is of: a scene of several, an option.
    ///
    /// # Errors
    /// The error, with that before it.
    fn context(self, what: impl Display) -> Result<T, Error>;
}

impl<T, E: Into<Error>> Context<T> for Result<T, E> {
    fn context(self, what: impl Display) -> Result<T, Error> {
        self.map_err(|error| error.into().context(what))
    }
}

/// What the system says of a file at `path`, or that there is no such folder.
fn reason(path: &Path, error: &io::Error) -> String {
    let folder = path.parent().filter(|folder| *folder != Path::new("") && !folder.exists());
    folder.map_or_else(|| error.to_string(), |folder| format!("there is no folder {}", folder.display()))
}

impl From<SceneError> for Error {
    fn from(error: SceneError) -> Self {
        let mut made = Self::scene(&error).with_key(error.key());
        made.0.file = Some(error.file().to_owned()).filter(|_| !error.is_of_setting());
        made.0.line = error.line();
        made
    }
}

impl From<ParameterError> for Error {
    fn from(error: ParameterError) -> Self {
        Self::scene(&error).with_key(error.name())
    }
}

impl From<PatchError> for Error {
    fn from(error: PatchError) -> Self {
        match error {
            PatchError::File(error) => error.into(),
            PatchError::Table(error) => Self::scene(error),
        }
    }
}

impl From<SealError> for Error {
    fn from(error: SealError) -> Self {
        match error {
            SealError::File(error) => error.into(),
            SealError::Table(error) => error.into(),
        }
    }
}

impl From<FilmError> for Error {
    fn from(error: FilmError) -> Self {
        let kind = if matches!(error, FilmError::OutOfRange { .. }) { ErrorKind::Value } else { ErrorKind::Run };
        Self::new(kind, error)
    }
}

impl From<SimulationError> for Error {
    fn from(error: SimulationError) -> Self {
        match error {
            SimulationError::Scene(error) => error.into(),
            SimulationError::OutOfRange(error) => error.into(),
            error => Self::run(error),
        }
    }
}

impl From<MotionError> for Error {
    fn from(error: MotionError) -> Self {
        let kind = if matches!(error, MotionError::OutOfRange { .. }) { ErrorKind::Value } else { ErrorKind::Run };
        Self::new(kind, error)
    }
}

impl From<ElementError> for Error {
    fn from(error: ElementError) -> Self {
        let kind = if matches!(error, ElementError::OutOfRange(_)) { ErrorKind::Value } else { ErrorKind::Run };
        Self::new(kind, error)
    }
}

/// Errors that are of one kind, without a place.
macro_rules! of_kind {
    ($($error:ty => $kind:ident),* $(,)?) => {
        $(impl From<$error> for $crate::Error {
            fn from(error: $error) -> Self {
                Self::new($crate::ErrorKind::$kind, error)
            }
        })*
    };
}

of_kind! {
    ContentError => Value,
    PatchRestoreError => Value,
    FilmRestoreError => Value,
    OutOfRange => Value,
    NotEnoughMemory => Scene,
    Stopped => Stopped,
}

impl From<TableError> for Error {
    fn from(error: TableError) -> Self {
        Self::in_file(&error.file, error.line, error.problem)
    }
}

impl From<serde_json::Error> for Error {
    fn from(error: serde_json::Error) -> Self {
        Self::value(format!("cannot be written as JSON: {error}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_says_where_it_is_and_what_it_is_of() {
        let content = ContentError::value(Some(3), "speed", "fast", "a number");
        let error = Error::content(Path::new("t.csv"))(content).context("`table`");
        assert_eq!(error.to_string(), "`table`: t.csv:3: speed = fast: expected a number");
        assert_eq!((error.kind(), error.line(), error.key()), (ErrorKind::Value, Some(3), Some("speed")));
        let missing = Error::io("read", Path::new("no/such.csv"))(io::ErrorKind::NotFound.into());
        assert_eq!(missing.to_string(), "cannot read no/such.csv: there is no folder no");
        assert_eq!(missing.kind(), ErrorKind::File(io::ErrorKind::NotFound));
    }
}
