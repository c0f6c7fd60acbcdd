//! Whether the values of a point can be relied on.

/// The status of a point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PointStatus {
    /// The values can be relied on.
    Steady,
    /// What is wrong.
    Problem(String),
}

const STEADY: &str = "steady";

impl PointStatus {
    /// By what is wrong, if anything is.
    pub fn new(problem: Option<impl ToString>) -> Self {
        problem.map_or(Self::Steady, |problem| Self::Problem(problem.to_string()))
    }

    /// As tables have it.
    pub fn text(&self) -> &str {
        match self {
            Self::Steady => STEADY,
            Self::Problem(problem) => problem,
        }
    }

    /// From its [text](Self::text).
    pub fn read(text: &str) -> Self {
        if text == STEADY { Self::Steady } else { Self::Problem(text.to_owned()) }
    }
}
