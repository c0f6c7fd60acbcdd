//! Why a scene, or a parameter's value, is refused.

use std::fmt;
use std::path::{Path, PathBuf};

/// Why a scene is refused: what was expected, what was found, and where.
///
/// It reads like `scene.toml:12: layer.mass = -1.0: expected a number from 1e-30 to 1e30`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct SceneError(Box<Refusal>);

/// What is wrong with a key or its value.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Problem {
    /// The scene is no TOML.
    Syntax {
        /// What the TOML parser says.
        reason: String,
    },
    /// A file cannot be read.
    Unreadable {
        /// The value that names the file; empty for the scene file itself.
        given: String,
        /// What the system says.
        reason: String,
    },
    /// There is no such key or parameter.
    Unknown {
        /// What there is instead.
        allowed: Vec<String>,
    },
    /// A key that must be there is not.
    Missing {
        /// What it should hold.
        expected: String,
    },
    /// A value of the wrong type, out of range or against another one.
    Value {
        /// The value as it was written.
        given: String,
        /// What is allowed.
        expected: String,
    },
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Refusal {
    place: Place,
    key: String,
    problem: Problem,
    named_by: Option<(Place, String)>,
}

/// A line of a file, counted from 1; no line where the file as a whole is meant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) file: PathBuf,
    pub(super) line: Option<usize>,
}

impl SceneError {
    pub(super) fn new(place: Place, key: impl Into<String>, problem: Problem) -> Self {
        Self(Box::new(Refusal { place, key: key.into(), problem, named_by: None }))
    }

    /// The same, telling which key of the scene names the file.
    pub(super) fn named_by(mut self, place: Place, key: &str) -> Self {
        self.0.named_by = Some((place, key.to_owned()));
        self
    }

    /// The file in which the mistake is: the scene's or one that the scene names.
    pub fn file(&self) -> &Path {
        &self.0.place.file
    }

    /// The line of the mistake, counted from 1.
    pub fn line(&self) -> Option<usize> {
        self.0.place.line
    }

    /// The key's full path, or the column of a profile; empty where there is none.
    pub fn key(&self) -> &str {
        &self.0.key
    }

    /// What is wrong.
    pub fn problem(&self) -> &Problem {
        &self.0.problem
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.problem.about(&self.key))?;
        match &self.named_by {
            Some((place, key)) => write!(f, " (file named by {key}, {place})"),
            None => Ok(()),
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        self.line.map_or(Ok(()), |line| write!(f, ":{line}"))
    }
}

impl Problem {
    /// The problem in words, as that of `key`.
    pub(super) fn about(&self, key: &str) -> String {
        match self {
            Self::Syntax { reason } => format!("not TOML: {reason}"),
            Self::Unreadable { given, reason } => format!("{}cannot be read: {reason}", assignment(key, given)),
            Self::Unknown { allowed } => format!("{key}: unknown; allowed: {}", allowed.join(", ")),
            Self::Missing { expected } => format!("{key}: missing; expected {expected}"),
            Self::Value { given, expected } => format!("{}expected {expected}", assignment(key, given)),
        }
    }
}

fn assignment(key: &str, given: &str) -> String {
    match (key, given) {
        ("", "") => String::new(),
        (key, "") => format!("{key}: "),
        ("", given) => format!("{given}: "),
        (key, given) => format!("{key} = {given}: "),
    }
}
