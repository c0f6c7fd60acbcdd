//! Whether the values of a point can be relied on.

use crate::table::{Column, Table, TableError};

/// The status of a point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PointStatus {
    /// The values can be relied on.
    Steady,
    /// So can friction and area; everything touches, so that nothing gives way but what stands behind.
    FullContact,
    /// What is wrong.
    Problem(String),
}

const STEADY: &str = "steady";
const FULL_CONTACT: &str = "full contact";

impl PointStatus {
    /// By what is wrong, if anything is.
    pub fn new(problem: Option<impl ToString>) -> Self {
        problem.map_or(Self::Steady, |problem| Self::read(&problem.to_string()))
    }

    /// As tables have it.
    pub fn text(&self) -> &str {
        match self {
            Self::Steady => STEADY,
            Self::FullContact => FULL_CONTACT,
            Self::Problem(problem) => problem,
        }
    }

    /// From its [text](Self::text).
    pub fn read(text: &str) -> Self {
        match text {
            STEADY => Self::Steady,
            FULL_CONTACT => Self::FullContact,
            problem => Self::Problem(problem.to_owned()),
        }
    }

    /// Its column.
    pub fn column() -> Column {
        Column::words("status", "")
    }

    /// That of a row.
    ///
    /// # Errors
    /// [`TableError`] where the table has no such column.
    pub fn of_row(table: &Table, row: usize) -> Result<Self, TableError> {
        table.word(row, "status", "").map(|text| Self::read(&text))
    }

    /// Whether friction and area are a result.
    pub fn is_result(&self) -> bool {
        matches!(self, Self::Steady | Self::FullContact)
    }
}
