//! Points as lines of text: two columns x and z, maybe a third that marks them, below a header of any length.

use std::fmt::Write as _;

use super::{Missing, ProfileError, ProfileOptions, Raw, ThirdColumn, header, refuse};
use crate::scene::allowed;
use crate::scene::text_table::Columns;

const EXPECTED_COLUMNS: &str = "two, x and z, separated by comma, semicolon, tab or blanks";
const ONE_UNIT: &str = "the header names a unit for one of the two columns alone; it is taken for both: x_unit and z_unit \
                        say otherwise";

/// Reads the points and what the header says of them.
pub(super) fn read(text: &str, options: &ProfileOptions) -> Result<Raw, ProfileError> {
    let numbered =
        || text.lines().zip(1..).map(|(line, number)| (number, trim(line))).filter(|(_, line)| !line.is_empty());
    let Some(first) = first_point(numbered()) else { return Err(refuse_all(text, numbered())) };
    let above: Vec<(usize, &str)> = numbered().take_while(|(number, _)| *number < first).collect();
    check_header(&above)?;
    let lines: Vec<&str> = above.iter().map(|(_, line)| *line).collect();
    let header = header::read(&lines);
    let mut reader = Reader::new(header.third_column, options);
    reader.raw.units = header.units;
    if header.is_one_sided && (options.x_unit.is_none() || options.z_unit.is_none()) {
        reader.raw.warnings.push(ONE_UNIT.into());
    }
    for (number, line) in numbered().skip(above.len()).filter(|(_, line)| !is_comment(line)) {
        reader.add(number, line)?;
    }
    Ok(reader.raw)
}

/// Two columns, x and z in m, that are read again as the same numbers.
pub(super) fn write(x: &[f64], z: &[f64]) -> String {
    let mut text = String::from("x [m],z [m]\n");
    for (x, z) in x.iter().zip(z) {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{x:?},{z:?}");
    }
    text
}

/// Without blanks; but a tab at the end may stand before an empty column.
fn trim(line: &str) -> &str {
    line.trim_start().trim_end_matches([' ', '\r'])
}

fn is_comment(line: &str) -> bool {
    line.starts_with('#')
}

/// The line of the first point: below it goes on with numbers, or ends.
fn first_point<'a>(lines: impl Iterator<Item = (usize, &'a str)>) -> Option<usize> {
    let mut lines = lines.filter(|(_, line)| !is_comment(line)).peekable();
    while let Some((number, line)) = lines.next() {
        if !Columns::split(line, false).is_point() {
            continue;
        }
        let goes_on = lines.peek().is_none_or(|(_, line)| {
            let next = Columns::split(line, false);
            next.count > 1 && next.number(0).is_some()
        });
        if goes_on {
            return Some(number);
        }
    }
    None
}

/// A single line above the data holds names; a word among numbers there is a mistake. Longer headers hold what they
/// like.
fn check_header(above: &[(usize, &str)]) -> Result<(), ProfileError> {
    let mut lines = above.iter().filter(|(_, line)| !is_comment(line));
    let (Some((number, line)), None) = (lines.next(), lines.next()) else { return Ok(()) };
    let row = Columns::split(line, false);
    if row.is_header() { Ok(()) } else { Err(refuse_row(&row, *number, line)) }
}

/// No line of the text is a point.
fn refuse_all<'a>(text: &str, lines: impl Iterator<Item = (usize, &'a str)>) -> ProfileError {
    let mut lines = lines.filter(|(_, line)| !is_comment(line));
    match lines.next() {
        Some((number, line)) if !Columns::split(line, false).is_header() => {
            refuse_row(&Columns::split(line, false), number, line)
        }
        _ => refuse(Some(text.lines().count().max(1)), "points", "0", "at least 2 points for a profile"),
    }
}

fn refuse_row(row: &Columns<'_>, number: usize, line: &str) -> ProfileError {
    match row.count {
        2 if row.number(0).is_none_or(|x| !allowed::PLACE.holds(x)) => refuse_field(row, 0, number),
        2 => refuse_field(row, 1, number),
        _ => refuse_count(row, number, line),
    }
}

fn refuse_count(row: &Columns<'_>, number: usize, line: &str) -> ProfileError {
    let given = format!("{} in `{}`", row.count, cut(line));
    let third = "; third_column tells what a third one says";
    refuse(Some(number), "columns", &given, &format!("{EXPECTED_COLUMNS}{}", if row.count == 3 { third } else { "" }))
}

fn refuse_field(row: &Columns<'_>, column: usize, number: usize) -> ProfileError {
    let given = format!("\"{}\"", cut(row.fields[column]));
    let missing = if column == 1 { ", or missing = \"fill\" where heights are missing" } else { "" };
    refuse(Some(number), ["x", "z"][column], &given, &format!("{}{missing}", allowed::PLACE))
}

fn cut(text: &str) -> String {
    text.chars().take(60).collect()
}

/// Takes line by line.
struct Reader {
    raw: Raw,
    third_column: Option<ThirdColumn>,
    missing: Missing,
}

impl Reader {
    fn new(named: Option<ThirdColumn>, options: &ProfileOptions) -> Self {
        Self { raw: Raw::default(), third_column: options.third_column.or(named), missing: options.missing }
    }

    fn add(&mut self, number: usize, line: &str) -> Result<(), ProfileError> {
        let row = Columns::split(line, self.third_column.is_some());
        let is_table = match self.third_column {
            None => row.count == 2,
            Some(ThirdColumn::Ignore) => row.count >= 2,
            Some(_) => row.count == 2 || row.count == 3,
        };
        if !is_table {
            return Err(refuse_count(&row, number, line));
        }
        let in_range = |column: usize| row.number(column).filter(|&value| allowed::PLACE.holds(value));
        self.raw.x.push(in_range(0).ok_or_else(|| refuse_field(&row, 0, number))?);
        let z = if self.is_invalid(&row) { None } else { in_range(1) };
        self.raw.z.push(match z {
            Some(z) => z,
            None if self.missing == Missing::Fill && self.is_gap(&row) => f64::NAN,
            None if self.is_invalid(&row) => return Err(refuse_invalid(&row, number)),
            None => return Err(refuse_field(&row, 1, number)),
        });
        self.raw.lines.push(number);
        Ok(())
    }

    /// Whether the third column takes the height away.
    fn is_invalid(&self, row: &Columns<'_>) -> bool {
        match self.third_column {
            Some(ThirdColumn::Invalid) => row.is_marked(2),
            Some(ThirdColumn::Valid) => !row.is_marked(2),
            Some(ThirdColumn::Ignore) | None => false,
        }
    }

    fn is_gap(&self, row: &Columns<'_>) -> bool {
        self.is_invalid(row) || row.is_missing(1) || row.number(1).is_some_and(f64::is_nan)
    }
}

fn refuse_invalid(row: &Columns<'_>, number: usize) -> ProfileError {
    let given = format!("\"{}\"", cut(row.fields[2]));
    refuse(Some(number), "third column", &given, "valid points alone, or missing = \"fill\"")
}
