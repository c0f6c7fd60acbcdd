//! What is wrong in the content of a file.

use std::path::Path;

/// What is wrong in the content of a file, before it is known which file that is.
///
/// It reads like `column 2 (E' [MPa]) = "x": expected a number from 1e-30 to 1e30 in Pa`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}expected {expected}", assignment(key, given))]
pub struct ContentError {
    /// The line, counted from 1.
    pub line: Option<usize>,
    /// The column or the element; empty where there is none.
    pub key: String,
    /// What was found; empty where something is missing.
    pub given: String,
    /// What is allowed.
    pub expected: String,
}

impl ContentError {
    /// The error of a value that is not what was `expected`. Texts of the file are shown on one line.
    pub fn value(line: Option<usize>, key: &str, given: &str, expected: &str) -> Self {
        let [key, given] = [key, given].map(|text| text.replace(['\n', '\r'], " "));
        Self { line, key, given, expected: expected.to_owned() }
    }

    /// The same with another way out.
    #[must_use]
    pub fn or(mut self, way: &str) -> Self {
        self.expected += &format!("; or {way}");
        self
    }

    /// The error in a sheet of a workbook.
    #[must_use]
    pub fn in_sheet(self, name: &str) -> Self {
        let key = if self.key.is_empty() { format!("sheet {name}") } else { format!("sheet {name}: {}", self.key) };
        Self { key, ..self }
    }

    /// The error with its place: `file:line: …`.
    pub fn within(&self, file: &Path) -> String {
        let line = self.line.map_or_else(String::new, |line| format!(":{line}"));
        format!("{}{line}: {self}", file.display())
    }
}

/// What stands where, for messages: `key = given: `.
pub fn assignment(key: &str, given: &str) -> String {
    match (key, given) {
        ("", "") => String::new(),
        (key, "") => format!("{key}: "),
        ("", given) => format!("{given}: "),
        (key, given) => format!("{key} = {given}: "),
    }
}

/// The beginning of a text, for messages.
pub fn shortened(text: &str) -> String {
    text.chars().take(60).collect()
}
