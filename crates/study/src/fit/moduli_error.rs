//! Why a table of moduli cannot be used.

use std::fmt;

use super::columns::Column;

/// A table cannot be used: where, what was found and what was expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct ModuliError {
    line: usize,
    /// Its number from 1, and its heading.
    column: Option<(usize, String)>,
    /// As written in the file; empty where something is missing.
    found: String,
    expected: String,
}

impl fmt::Display for ModuliError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let found: String = self.found.chars().take(60).collect();
        write!(f, "{}: ", self.line)?;
        match &self.column {
            Some((number, header)) if header.is_empty() || *header == self.found => write!(f, "column {number}")?,
            Some((number, header)) => write!(f, "column {number} ({header})")?,
            None => {}
        }
        match (&self.column, found.as_str()) {
            (Some(_), "") => write!(f, ": ")?,
            (Some(_), found) => write!(f, " = \"{found}\": ")?,
            (None, "") => {}
            (None, found) => write!(f, "{found}: ")?,
        }
        write!(f, "expected {}", self.expected)
    }
}

impl ModuliError {
    pub(super) fn in_line(line: usize, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self { line, column: None, found: found.into(), expected: expected.into() }
    }

    /// Of a column, counted from 0, by its heading.
    pub(super) fn in_column(line: usize, index: usize, text: &str, found: &str, expected: impl Into<String>) -> Self {
        let column = Some((index + 1, text.trim().to_owned()));
        Self { line, column, found: found.into(), expected: expected.into() }
    }

    pub(super) fn of(column: &Column, line: usize, found: &str, expected: impl Into<String>) -> Self {
        Self::in_column(line, column.index, &column.text, found, expected)
    }
}
