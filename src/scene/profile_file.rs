//! Profiles in files: two columns x, z in m, separated by comma, semicolon, tab or blanks, with or without a header
//! line.

use std::fs;
use std::path::Path;

use super::allowed;
use super::error::Place;
use super::points::{self, Axis};
use super::table::Entry;
use super::{Problem, SceneError, Surface};

const COLUMNS: [&str; 2] = ["x", "z"];
const EXPECTED_COLUMNS: &str = "two, x and z, separated by comma, semicolon, tab or blanks";

/// What is wrong in a profile, before it is known which file that is.
#[derive(Clone, Debug, PartialEq, Eq)]
struct ProfileError {
    line: usize,
    column: &'static str,
    problem: Problem,
}

/// Points and the lines that they stand in.
#[derive(Clone, Debug, Default, PartialEq)]
struct Table {
    x: Vec<f64>,
    z: Vec<f64>,
    lines: Vec<usize>,
}

/// Reads the profile at `path`, which `entry` names.
pub(super) fn read(entry: &Entry<'_>, path: &Path, periodic: bool) -> Result<Surface, SceneError> {
    let file = entry.source().beside(path);
    let bytes = fs::read(&file)
        .map_err(|error| entry.problem(Problem::Unreadable { given: entry.given(), reason: error.to_string() }))?;
    parse(&bytes, periodic).map_err(|error| {
        let place = Place { file, line: Some(error.line) };
        SceneError::new(place, error.column, error.problem).named_by(entry.place(), entry.key())
    })
}

fn parse(bytes: &[u8], periodic: bool) -> Result<Surface, ProfileError> {
    let text = text_of(bytes).map_err(|problem| ProfileError { line: 1, column: "", problem })?;
    let mut table = parse_lines(&text)?;
    let (x, z) = (&table.x, &mut table.z);
    points::check(x, z, periodic).map_err(|refusal| match refusal.index {
        Some(i) => {
            let (column, value) = if refusal.axis == Axis::X { ("x", x[i]) } else { ("z", z[i]) };
            refuse(table.lines[i], column, &format!("{value:?}"), &refusal.expected)
        }
        None => {
            let last_line = text.lines().count().max(1);
            refuse(last_line, "points", &x.len().to_string(), &refusal.expected)
        }
    })?;
    Ok(Surface { x: table.x, z: table.z, periodic })
}

/// The text of a file of columns, without a byte order mark.
pub(super) fn text_of(bytes: &[u8]) -> Result<String, Problem> {
    if bytes.contains(&0) {
        let (given, expected) = ("bytes that are zero".into(), "text in UTF-8, not UTF-16 or binary data".into());
        return Err(Problem::Value { given, expected });
    }
    // A header may hold units in an older encoding; numbers never do.
    let text = String::from_utf8_lossy(bytes);
    Ok(text.strip_prefix('\u{feff}').unwrap_or(&text).to_owned())
}

/// The lines that hold data, without comments and a header: their numbers, counted from 1, themselves and their columns.
pub(super) fn data_lines(text: &str) -> impl Iterator<Item = (usize, &str, Vec<String>)> {
    let numbered = text.lines().zip(1..).map(|(line, number)| (line.trim(), number));
    let filled = numbered.filter(|(line, _)| !line.is_empty() && !line.starts_with('#'));
    let columns = filled.map(|(line, number)| (number, line, split(line))).enumerate();
    columns.filter(|(count, (_, _, fields))| *count > 0 || !is_header(fields)).map(|(_, line)| line)
}

fn refuse(line: usize, column: &'static str, given: &str, expected: &str) -> ProfileError {
    ProfileError { line, column, problem: Problem::Value { given: given.to_owned(), expected: expected.to_owned() } }
}

fn parse_lines(text: &str) -> Result<Table, ProfileError> {
    let mut table = Table::default();
    for (number, line, fields) in data_lines(text) {
        let [x, z] = parse_row(&fields, number, line)?;
        table.x.push(x);
        table.z.push(z);
        table.lines.push(number);
    }
    Ok(table)
}

/// The columns of a line. With another separator, a comma is a decimal one.
fn split(line: &str) -> Vec<String> {
    let decimal_comma = |field: &str| field.trim().replace(',', ".");
    if line.contains(';') {
        line.split(';').map(decimal_comma).collect()
    } else if line.contains('\t') {
        line.split_whitespace().map(decimal_comma).collect()
    } else if line.contains(',') {
        line.split(',').map(|field| field.trim().to_owned()).collect()
    } else {
        line.split_whitespace().map(String::from).collect()
    }
}

/// Words alone; one word among numbers is a mistake.
fn is_header(fields: &[String]) -> bool {
    let is_word = |field: Option<&String>| field.is_some_and(|field| field.parse::<f64>().is_err());
    is_word(fields.first()) && is_word(fields.last())
}

fn parse_row(fields: &[String], number: usize, line: &str) -> Result<[f64; 2], ProfileError> {
    let [x, z] = fields else {
        let given = format!("{} in `{}`", fields.len(), line.chars().take(60).collect::<String>());
        return Err(refuse(number, "columns", &given, EXPECTED_COLUMNS));
    };
    Ok([parse_number(x, number, COLUMNS[0])?, parse_number(z, number, COLUMNS[1])?])
}

fn parse_number(field: &str, line: usize, column: &'static str) -> Result<f64, ProfileError> {
    let number = field.parse().ok().filter(|&number| allowed::PLACE.holds(number));
    number.ok_or_else(|| {
        let given = format!("\"{}\"", field.chars().take(60).collect::<String>());
        refuse(line, column, &given, &allowed::PLACE.to_string())
    })
}

#[cfg(test)]
#[path = "profile_file_tests.rs"]
mod tests;
