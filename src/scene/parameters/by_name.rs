//! Parameters by their names, as `--set KEY=VALUE` gives them.

use super::{Parameter, ParameterError, Value};
use crate::scene::{Problem, Scene};

impl Scene {
    /// The parameter called `name`.
    pub fn parameter_named(&self, name: &str) -> Option<Parameter> {
        self.parameters().into_iter().find(|parameter| parameter.name() == name)
    }

    /// Gives the parameter called `name` the value that `text` writes.
    ///
    /// # Errors
    /// [`ParameterError`] as for [`set_parameter`](Self::set_parameter), and for an unknown name, with the parameters
    /// whose names are similar or, failing these, all that the scene has.
    pub fn set_by_name(&mut self, name: &str, text: &str) -> Result<(), ParameterError> {
        let parameter = self.parameter_named(name).ok_or_else(|| self.unknown(name))?;
        let value = match self.parameter(parameter) {
            Value::Real(_) => text.trim().parse().map(Value::Real).map_err(|_| parameter.refuse(text))?,
            Value::Integer(_) => text.trim().parse().map(Value::Integer).map_err(|_| parameter.refuse(text))?,
            Value::Text(_) => Value::Text(text.trim().to_owned()),
        };
        self.set_parameter(parameter, value)
    }

    pub(super) fn unknown(&self, name: &str) -> ParameterError {
        let names: Vec<String> = self.parameters().into_iter().map(Parameter::name).collect();
        let near: Vec<String> = names.iter().filter(|other| is_near(name, other)).cloned().collect();
        let allowed = if near.is_empty() { names } else { near };
        ParameterError { name: name.to_owned(), problem: Problem::Unknown { allowed } }
    }
}

/// A few letters differ, or only the end of the path is given.
fn is_near(given: &str, name: &str) -> bool {
    let end_of_path = name.strip_suffix(given).is_some_and(|start| start.ends_with('.'));
    end_of_path || edits(given, name) <= 1 + given.chars().count() / 8
}

/// Letters to insert, leave out or change (Levenshtein).
fn edits(from: &str, to: &str) -> usize {
    let to: Vec<char> = to.chars().collect();
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (i, letter) in from.chars().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for j in 0..to.len() {
            let changed = diagonal + usize::from(letter != to[j]);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[to.len()]
}
