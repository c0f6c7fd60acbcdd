//! A Prony series in a file: two columns, relaxation time in s and modulus in Pa, separated by comma, semicolon, tab or
//! blanks, with or without a header line.

use std::fs;
use std::path::Path;

use super::allowed::{self, Range};
use super::error::Place;
use super::table::Entry;
use super::text_table::{Columns, decode};
use super::{Problem, PronyTerm, SceneError};

const COLUMNS: [&str; 2] = ["relaxation_time", "modulus"];
const EXPECTED_COLUMNS: &str = "two, relaxation_time and modulus, separated by comma, semicolon, tab or blanks";

/// What is wrong: the line, the column, the problem.
type Refusal = (usize, &'static str, Problem);

/// Reads the series at `path`, which `entry` names.
pub(super) fn read(entry: &Entry<'_>, path: &Path) -> Result<Vec<PronyTerm>, SceneError> {
    let file = entry.source().folder().join(path);
    let bytes = fs::read(&file)
        .map_err(|error| entry.problem(Problem::Unreadable { given: entry.given(), reason: error.to_string() }))?;
    parse(&bytes).map_err(|(line, column, problem)| {
        let place = Place { file, line: Some(line) };
        SceneError::new(place, column, problem).named_by(entry.place(), entry.key())
    })
}

fn parse(bytes: &[u8]) -> Result<Vec<PronyTerm>, Refusal> {
    let text = decode(bytes).map_err(|error| (1, "", error.into()))?;
    if let Some((line, header)) = swapped_header(&text) {
        return Err((line, "columns", refused(&format!("`{header}`"), "relaxation_time before modulus")));
    }
    let terms: Vec<PronyTerm> = rows(&text).map(|(line, row)| term(line, &row)).collect::<Result<_, _>>()?;
    if terms.is_empty() {
        return Err((text.lines().count().max(1), "terms", refused("0", "at least one term")));
    }
    Ok(terms)
}

/// A header that names the columns the other way round: its numbers would be taken for each other.
fn swapped_header(text: &str) -> Option<(usize, &str)> {
    let mut numbered = text.lines().zip(1..).map(|(line, number)| (number, line.trim()));
    let header = numbered.find(|(_, line)| !line.is_empty() && !line.starts_with('#'))?;
    let names = header.1.to_lowercase();
    (names.find("modulus")? < names.find("relaxation")?).then_some(header)
}

/// The columns of the lines that hold data, without comments and a header, and the lines' numbers from 1.
fn rows(text: &str) -> impl Iterator<Item = (usize, Columns<'_>)> {
    let numbered = text.lines().zip(1..).map(|(line, number)| (line.trim(), number));
    let filled = numbered.filter(|(line, _)| !line.is_empty() && !line.starts_with('#'));
    let rows = filled.map(|(line, number)| (number, Columns::split(line, false))).enumerate();
    rows.filter(|(count, (_, row))| *count > 0 || !row.is_header()).map(|(_, row)| row)
}

fn term(line: usize, row: &Columns<'_>) -> Result<PronyTerm, Refusal> {
    if row.count != COLUMNS.len() {
        return Err((line, "columns", refused(&row.count.to_string(), EXPECTED_COLUMNS)));
    }
    Ok(PronyTerm {
        relaxation_time: number(row, 0, line, &allowed::RELAXATION_TIME)?,
        modulus: number(row, 1, line, &allowed::MODULUS)?,
    })
}

fn number(row: &Columns<'_>, column: usize, line: usize, range: &Range) -> Result<f64, Refusal> {
    let number = row.number(column).filter(|&number| range.holds(number));
    let given = || format!("\"{}\"", row.fields[column].chars().take(60).collect::<String>());
    number.ok_or_else(|| (line, COLUMNS[column], refused(&given(), &range.to_string())))
}

fn refused(given: &str, expected: &str) -> Problem {
    Problem::Value { given: given.to_owned(), expected: expected.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_every_separator_with_and_without_a_header() {
        let texts = [
            "1e-3,2e6\n10,5e5\n",
            "relaxation_time,modulus\n1e-3,2e6\n10,5e5\n",
            "relaxation_time [s]; modulus [Pa]\r\n0,001;2000000\r\n1e1;5e5\r\n",
            "# a compound\n\ntau E\n1e-3 2e6\n# long\n10\t5e5",
        ];
        let expected =
            [(1e-3, 2e6), (10.0, 5e5)].map(|(relaxation_time, modulus)| PronyTerm { relaxation_time, modulus });
        for text in texts {
            assert_eq!(parse(text.as_bytes()).as_deref(), Ok(&expected[..]), "{text:?}");
        }
    }

    #[test]
    fn refuses_what_is_no_series() {
        let cases = [
            ("", 1, "terms = 0: expected at least one term"),
            ("tau,E\n", 1, "terms = 0: expected at least one term"),
            ("tau,E\n1,2\n0,3\n", 3, "relaxation_time = \"0\": expected a number from 1e-30 to 1e30"),
            ("1,2\n2,-3\n", 2, "modulus = \"-3\": expected 0 or a number from 1e-30 to 1e30"),
            ("1,2\n2,soft\n", 2, "modulus = \"soft\": expected 0 or a number from 1e-30 to 1e30"),
            (
                "1,2,3\n",
                1,
                "columns = 3: expected two, relaxation_time and modulus, separated by comma, semicolon, tab or blanks",
            ),
            (
                "# a compound\nModulus (Pa); Relaxation time (s)\n1e6;1\n",
                2,
                "columns = `Modulus (Pa); Relaxation time (s)`: expected relaxation_time before modulus",
            ),
            ("1\0,2\n", 1, "bytes that are zero: expected text in UTF-8, UTF-16 or Latin-1"),
        ];
        for (text, line, message) in cases {
            let (at, column, problem) = parse(text.as_bytes()).unwrap_err();
            assert_eq!((at, problem.about(column)), (line, message.to_owned()), "{text:?}");
        }
    }
}
