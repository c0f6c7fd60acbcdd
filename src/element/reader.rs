//! The text of a sweep's table: lines `# key = value`, a line of names with units, one row a point.

use std::collections::BTreeMap;

use super::error::TableProblem;
use crate::scene::is_possible;

/// What is wrong, and in which line, counted from 1.
pub(super) type Refusal = (Option<usize>, TableProblem);

/// The parts of the text.
#[derive(Debug)]
pub(super) struct Text {
    /// The lines at the top, by key.
    pub(super) head: BTreeMap<String, String>,
    /// The names of the columns, with their units.
    columns: Vec<String>,
    /// The line and the fields of each row.
    pub(super) rows: Vec<(usize, Vec<String>)>,
}

impl Text {
    /// Takes the text apart.
    pub(super) fn parse(text: &str) -> Result<Self, Refusal> {
        let mut parts = Self { head: BTreeMap::new(), columns: Vec::new(), rows: Vec::new() };
        let lines = text.strip_prefix('\u{feff}').unwrap_or(text).lines().zip(1..);
        for (line, number) in lines.filter(|(line, _)| !line.trim().is_empty()) {
            match line.strip_prefix('#') {
                Some(comment) => parts.head.extend(key_and_value(comment)),
                None if parts.columns.is_empty() => parts.columns = fields(line),
                None => parts.add_row(number, fields(line))?,
            }
        }
        Ok(parts)
    }

    fn add_row(&mut self, line: usize, fields: Vec<String>) -> Result<(), Refusal> {
        let (found, expected) = (fields.len(), self.columns.len());
        if found != expected {
            return Err((Some(line), TableProblem::Fields { found, expected }));
        }
        self.rows.push((line, fields));
        Ok(())
    }

    /// The place of the column `name`, with its unit.
    pub(super) fn column(&self, name: &str) -> Result<usize, Refusal> {
        self.columns.iter().position(|column| column == name).ok_or((None, TableProblem::NoColumn(name.into())))
    }

    /// The quantity in a line at the top, of the unit `unit`.
    pub(super) fn quantity(
        &self,
        key: &'static str,
        unit: &str,
        expected: &'static str,
        allowed: fn(f64) -> bool,
    ) -> Result<f64, Refusal> {
        let found = self.head.get(key).map_or("", String::as_str);
        let number = found.strip_suffix(unit).and_then(|number| number.trim().parse().ok());
        let refuse = || (None, TableProblem::Header { key, found: found.to_owned(), expected });
        number.filter(|&number: &f64| is_possible(number) && allowed(number)).ok_or_else(refuse)
    }
}

fn key_and_value(comment: &str) -> Option<(String, String)> {
    let (key, value) = comment.split_once('=')?;
    Some((key.trim().to_owned(), value.trim().to_owned()))
}

/// The fields of a line; one in quotes may hold commas, and quotes doubled.
fn fields(line: &str) -> Vec<String> {
    let (mut fields, mut field, mut quoted) = (Vec::new(), String::new(), false);
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '"' if quoted && letters.next_if_eq(&'"').is_some() => field.push('"'),
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(std::mem::take(&mut field)),
            _ => field.push(letter),
        }
    }
    fields.push(field);
    fields.iter().map(|field| field.trim().to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_in_quotes_hold_commas_and_quotes() {
        assert_eq!(fields(r#"1, "a, ""b""" ,,c"#), ["1", r#"a, "b""#, "", "c"]);
    }

    #[test]
    fn a_row_has_as_many_fields_as_there_are_columns() {
        let (line, problem) = Text::parse("# a = 1 = 2\nx [m],y [1]\n\n1,2\n1\n").unwrap_err();
        assert_eq!((line, problem), (Some(5), TableProblem::Fields { found: 1, expected: 2 }));
        let text = Text::parse("# a = 1 = 2\nx [m],y [1]\n1,2\n").unwrap();
        assert_eq!((text.head["a"].as_str(), text.column("y [1]").unwrap()), ("1 = 2", 1));
        assert_eq!(text.column("y [m]").unwrap_err().1.to_string(), "no column `y [m]`");
    }
}
