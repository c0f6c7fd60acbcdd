//! Errors of scenes and of parameters: what was expected, what was found, and where.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::tables::{ContentError, assignment};

/// Why a scene is refused: what was expected, what was found, and where.
///
/// It reads like `scene.toml:12: layer.mass = -1.0: expected a number from 1e-30 to 1e30`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct SceneError(Box<Details>);

#[derive(Clone, Debug, PartialEq, Eq)]
struct Details {
    location: Location,
    key: String,
    problem: Problem,
    /// The key that names the file, and where it is.
    named_by: Option<(Location, String)>,
}

/// Why the value or the name of a parameter is refused.
///
/// It reads like `layer.mass = -1.0: expected a number from 1e-30 to 1e30`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", problem.about(name))]
pub struct ParameterError {
    name: String,
    problem: Problem,
}

/// What is wrong with a key or its value.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Problem {
    /// The scene is not TOML.
    Syntax {
        /// The message of the TOML parser.
        reason: String,
    },
    /// A file cannot be read.
    Unreadable {
        /// The value that names the file; empty for the scene file itself.
        given: String,
        /// The message of the operating system.
        reason: String,
    },
    /// There is no such key or parameter.
    Unknown {
        /// Those that there are.
        allowed: Vec<String>,
        /// Those that may be meant, by their whole paths.
        similar: Vec<String>,
    },
    /// Keys are set in a scene of which code has changed fields.
    Changed,
    /// A required key is missing.
    Missing {
        /// What it should hold.
        expected: String,
    },
    /// A value has the wrong type, is out of range or contradicts another one.
    Value {
        /// The value as it was written.
        given: String,
        /// What is allowed.
        expected: String,
    },
}

/// A line of a file, counted from 1; no line where the whole file is meant, and no file of what was set.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Location {
    pub(super) file: PathBuf,
    pub(super) line: Option<usize>,
}

impl SceneError {
    pub(super) fn new(location: Location, key: impl Into<String>, problem: Problem) -> Self {
        Self(Box::new(Details { location, key: key.into(), problem, named_by: None }))
    }

    /// The error of a file that cannot be read and that no key names.
    pub(super) fn unreadable(file: &Path, error: &std::io::Error) -> Self {
        let problem = Problem::Unreadable { given: String::new(), reason: error.to_string() };
        Self::new(Location { file: file.to_owned(), line: None }, "", problem)
    }

    /// Adds the key that names the file, and where it is.
    pub(super) fn named_by(mut self, location: Location, key: &str) -> Self {
        self.0.named_by = Some((location, key.to_owned()));
        self
    }

    /// The file with the error: the scene's or one that the scene names; empty of a key that was set.
    pub fn file(&self) -> &Path {
        &self.0.location.file
    }

    /// The line of the error, counted from 1.
    pub fn line(&self) -> Option<usize> {
        self.0.location.line
    }

    /// Whether it is of a key that was set, not of a file.
    pub fn is_of_setting(&self) -> bool {
        self.0.location == Location::default()
    }

    /// The full path of the key, or the column of a profile; empty where there is none.
    pub fn key(&self) -> &str {
        &self.0.key
    }

    /// What is wrong.
    pub fn problem(&self) -> &Problem {
        &self.0.problem
    }
}

impl ContentError {
    pub(super) fn in_file(self, file: PathBuf) -> SceneError {
        let problem = Problem::Value { given: self.given, expected: self.expected };
        SceneError::new(Location { file, line: self.line }, self.key, problem)
    }
}

impl ParameterError {
    /// The error of the parameter called `name`.
    pub(crate) fn new(name: impl Into<String>, problem: Problem) -> Self {
        Self { name: name.into(), problem }
    }

    /// The name of the parameter, as it was given.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What was given and what is allowed.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }
}

impl Problem {
    pub(super) fn value(given: impl ToString, expected: impl ToString) -> Self {
        Self::Value { given: given.to_string(), expected: expected.to_string() }
    }

    /// The problem in words, as that of `key`.
    pub(super) fn about(&self, key: &str) -> String {
        match self {
            Self::Syntax { reason } => format!("not TOML: {reason}"),
            Self::Unreadable { given, reason } => format!("{}cannot be read: {reason}", assignment(key, given)),
            Self::Unknown { allowed, similar } => {
                format!("{key}: unknown; allowed: {}{}", allowed.join(", "), did_you_mean(similar))
            }
            Self::Changed => format!(
                "{key}: code has changed fields of the scene since it was read, and a scene with keys set, which is built \
                 anew of what was read, would not have them: expected keys to be set first, or the field itself to be changed"
            ),
            Self::Missing { expected } => format!("{key}: missing; expected {expected}"),
            Self::Value { given, expected } => format!("{}expected {expected}", assignment(key, given)),
        }
    }
}

/// Names what may be meant in place of what was refused; nothing where nothing is like it.
pub fn did_you_mean(similar: &[String]) -> String {
    if similar.is_empty() { String::new() } else { format!("; did you mean {}?", similar.join(", ")) }
}

impl fmt::Display for Details {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.location != Location::default() {
            write!(f, "{}: ", self.location)?;
        }
        f.write_str(&self.problem.about(&self.key))?;
        match &self.named_by {
            Some((location, key)) if *location == Location::default() => write!(f, " (file named by {key})"),
            Some((location, key)) => write!(f, " (file named by {key}, {location})"),
            None => Ok(()),
        }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        self.line.map_or(Ok(()), |line| write!(f, ":{line}"))
    }
}
