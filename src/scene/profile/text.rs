//! Profiles as text: two columns x and z, maybe a third that marks points, below a header of any length that may name
//! the units and the third column.

use std::fmt::Write as _;

use super::options::{LengthUnit, MeasuredPoints, Missing, ProfileOptions, ThirdColumn};
use super::plain::PlainLine;
use crate::scene::error::ContentError;
use crate::scene::text_table::Columns;
use crate::scene::values::ANY;

const EXPECTED_COLUMNS: &str = "two, x and z, separated by comma, semicolon, tab or blanks";
const ONE_UNIT: &str = "the header names a unit for one of the two columns alone; it is taken for both: x_unit and z_unit \
                        say otherwise";

/// Reads the points and what the header says of them.
pub(super) fn read(text: &str, options: &ProfileOptions) -> Result<MeasuredPoints, ContentError> {
    let numbered =
        || text.lines().zip(1..).map(|(line, number)| (number, trim(line))).filter(|(_, line)| !line.is_empty());
    let Some(first) = first_point(numbered()) else { return Err(refuse_all(text, numbered())) };
    let above: Vec<(usize, &str)> = numbered().take_while(|(number, _)| *number < first).collect();
    check_header(&above)?;
    let lines: Vec<&str> = above.iter().map(|(_, line)| *line).collect();
    let header = Header::read(&lines);
    let most = text.bytes().filter(|&byte| byte == b'\n').count() + 1;
    let mut reader = PointsReader::new(header.third_column, options, most);
    reader.raw.units = header.units;
    if header.is_one_sided && (options.x_unit.is_none() || options.z_unit.is_none()) {
        reader.raw.warnings.push(ONE_UNIT.into());
    }
    let start = text.split_inclusive('\n').take(first - 1).map(str::len).sum::<usize>();
    reader.add_lines(&text[start..], first)?;
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

/// The line of the first point: the next line has numbers too, or there is none.
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

/// A single line above the data holds names; a word among numbers there is a mistake. Longer headers may hold
/// anything.
fn check_header(above: &[(usize, &str)]) -> Result<(), ContentError> {
    let mut lines = above.iter().filter(|(_, line)| !is_comment(line));
    let (Some((number, line)), None) = (lines.next(), lines.next()) else { return Ok(()) };
    let row = Columns::split(line, false);
    if row.is_header() { Ok(()) } else { Err(refuse_row(&row, *number, line)) }
}

/// No line of the text is a point.
fn refuse_all<'a>(text: &str, lines: impl Iterator<Item = (usize, &'a str)>) -> ContentError {
    let mut lines = lines.filter(|(_, line)| !is_comment(line));
    match lines.next() {
        Some((number, line)) if !Columns::split(line, false).is_header() => {
            refuse_row(&Columns::split(line, false), number, line)
        }
        _ => ContentError::value(Some(text.lines().count().max(1)), "points", "0", "at least 2 points for a profile"),
    }
}

fn refuse_row(row: &Columns<'_>, number: usize, line: &str) -> ContentError {
    match row.count {
        2 if row.number(0).is_none_or(|x| !ANY.holds(x)) => refuse_field(row, 0, number),
        2 => refuse_field(row, 1, number),
        _ => refuse_count(row, number, line),
    }
}

fn refuse_count(row: &Columns<'_>, number: usize, line: &str) -> ContentError {
    let given = format!("{} in `{}`", row.count, cut(line));
    let third = "; third_column says what a third one means";
    ContentError::value(
        Some(number),
        "columns",
        &given,
        &format!("{EXPECTED_COLUMNS}{}", if row.count == 3 { third } else { "" }),
    )
}

fn refuse_field(row: &Columns<'_>, column: usize, number: usize) -> ContentError {
    let given = format!("\"{}\"", cut(row.fields[column]));
    let missing = if column == 1 { ", or missing = \"fill\" where heights are missing" } else { "" };
    ContentError::value(Some(number), ["x", "z"][column], &given, &format!("{ANY}{missing}"))
}

fn cut(text: &str) -> String {
    text.chars().take(60).collect()
}

/// Collects the points, line by line.
struct PointsReader {
    raw: MeasuredPoints,
    third_column: Option<ThirdColumn>,
    missing: Missing,
}

impl PointsReader {
    /// A reader of up to `most` points, with the third column as the header has `named` it.
    fn new(named: Option<ThirdColumn>, options: &ProfileOptions, most: usize) -> Self {
        let raw = MeasuredPoints::with_capacity(most);
        Self { raw, third_column: options.third_column.or(named), missing: options.missing }
    }

    /// Adds the points in the lines of `text`, the first of which has the number `first`.
    fn add_lines(&mut self, text: &str, first: usize) -> Result<(), ContentError> {
        let mut rest = text;
        for number in first.. {
            if rest.is_empty() {
                break;
            }
            if let Some(length) = self.add_plain(number, rest) {
                rest = &rest[length..];
                continue;
            }
            let (line, behind) = rest.split_once('\n').unwrap_or((rest, ""));
            let line = trim(line);
            if !line.is_empty() && !is_comment(line) {
                self.add(number, line)?;
            }
            rest = behind;
        }
        Ok(())
    }

    /// Adds the first line of `text` if it is plain and its numbers are possible, and returns its bytes.
    fn add_plain(&mut self, number: usize, text: &str) -> Option<usize> {
        if self.third_column.is_some() {
            return None;
        }
        let PlainLine { x, z, length } = PlainLine::read(text).filter(|line| ANY.holds(line.x) && ANY.holds(line.z))?;
        self.raw.push(number, x, z);
        Some(length)
    }

    fn add(&mut self, number: usize, line: &str) -> Result<(), ContentError> {
        let row = Columns::split(line, self.third_column.is_some());
        let is_table = match self.third_column {
            None => row.count == 2,
            Some(ThirdColumn::Ignore) => row.count >= 2,
            Some(_) => row.count == 2 || row.count == 3,
        };
        if !is_table {
            return Err(refuse_count(&row, number, line));
        }
        let in_range = |column: usize| row.number(column).filter(|&value| ANY.holds(value));
        let x = in_range(0).ok_or_else(|| refuse_field(&row, 0, number))?;
        let z = if self.is_invalid(&row) { None } else { in_range(1) };
        let z = match z {
            Some(z) => z,
            None if self.missing == Missing::Fill && self.is_gap(&row) => f64::NAN,
            None if self.is_invalid(&row) => return Err(refuse_invalid(&row, number)),
            None => return Err(refuse_field(&row, 1, number)),
        };
        self.raw.push(number, x, z);
        Ok(())
    }

    /// Whether the third column marks the height as not valid.
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

fn refuse_invalid(row: &Columns<'_>, number: usize) -> ContentError {
    let given = format!("\"{}\"", cut(row.fields[2]));
    ContentError::value(Some(number), "third column", &given, "valid points alone, or missing = \"fill\"")
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Header {
    units: [Option<LengthUnit>; 2],
    /// Whether a unit stands beside one of the two columns alone: it is taken for both, which may be wrong.
    is_one_sided: bool,
    third_column: Option<ThirdColumn>,
}

/// Lines above the data that may hold the names of the columns and their units.
const NEAR: usize = 2;

impl Header {
    /// Reads the header's `lines`, comments included. Units are looked for in the last two lines, beside or below the names
    /// of columns, as in `x [mm]; z (µm)`, `X_(microns),y1`, `z / µm`; and in lines of their own, as in `X-Unit: mm`.
    fn read(lines: &[&str]) -> Self {
        let lines: Vec<&str> = lines.iter().map(|line| line.trim_start_matches(['#', '%', '!', ' '])).collect();
        let mut set = [None; 2];
        let settings = lines.iter().filter_map(|line| setting(line));
        settings.for_each(|(axes, unit)| axes.iter().for_each(|&axis| set[axis] = Some(unit)));
        let near = || lines.iter().rev().filter(|line| setting(line).is_none()).take(NEAR);
        let beside = near().map(|line| column_units(line)).find(|units| *units != [None, None]).unwrap_or_default();
        let (x, z) = (beside[0].or(set[0]), beside[1].or(set[1]));
        Self {
            units: [x.or(z), z.or(x)],
            is_one_sided: x.is_none() != z.is_none(),
            third_column: near().find_map(|line| third_column(&Columns::split(line, true))),
        }
    }
}

/// Of a line such as `X-Unit: mm` or `unit;um`: the axes, 0 for x and 1 for z, and their unit.
fn setting(line: &str) -> Option<(&'static [usize], LengthUnit)> {
    let words: Vec<String> = words(line).map(str::to_lowercase).collect();
    let mut units = words.iter().filter_map(|word| unit_of(word));
    let (unit, None) = (units.next()?, units.next()) else { return None };
    let name = words.iter().position(|word| word.ends_with("unit") || word.ends_with("units"))?;
    let names = |axis: &[&str]| {
        let of_axis = |word: &String| axis.iter().any(|name| word == name || *word == format!("{name}unit"));
        words[..=name].iter().any(of_axis)
    };
    Some(match (names(&["x"]), names(&["z", "y", "height"])) {
        (true, false) => (&[0], unit),
        (false, true) => (&[1], unit),
        _ => (&[0, 1], unit),
    })
}

/// The units beside the names of two columns, or below them.
fn column_units(line: &str) -> [Option<LengthUnit>; 2] {
    if line.contains([';', '\t', ',']) {
        let row = Columns::split(line, true);
        return [field_unit(row.fields[0]), field_unit(row.fields[1])];
    }
    let fields: Vec<&str> = line.split_whitespace().collect();
    if let [x, z] = fields[..] {
        return [field_unit(x), field_unit(z)];
    }
    // Blanks separate too much: only what is marked as a unit is one.
    let marked = |(i, field): (usize, &&str)| {
        let after_slash = i > 0 && fields[i - 1].ends_with('/');
        if after_slash || field.contains(['[', '(', '/']) { field_unit(field) } else { None }
    };
    let mut units = fields.iter().enumerate().filter_map(marked);
    [units.next(), units.next()]
}

/// The unit at the end of the name of a column: `x [mm]`, `X_(microns)`, `z / µm`, `mm`.
fn field_unit(field: &str) -> Option<LengthUnit> {
    words(field).last().and_then(unit_of)
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|letter: char| !letter.is_alphanumeric()).filter(|word| !word.is_empty())
}

fn unit_of(word: &str) -> Option<LengthUnit> {
    let lower = word.to_lowercase();
    let stem = lower.strip_suffix('s').filter(|stem| stem.len() > 2).unwrap_or(&lower);
    Some(match stem {
        // A single capital M is no metre.
        "m" if word == "m" => LengthUnit::Metre,
        "meter" | "metre" => LengthUnit::Metre,
        "mm" | "millimeter" | "millimetre" => LengthUnit::Millimetre,
        // Two letters look like µ: the sign of the unit and the Greek one.
        "um" | "\u{b5}m" | "\u{3bc}m" | "micron" | "micrometer" | "micrometre" => LengthUnit::Micrometre,
        "nm" | "nanometer" | "nanometre" => LengthUnit::Nanometre,
        _ => return None,
    })
}

fn third_column(row: &Columns<'_>) -> Option<ThirdColumn> {
    if row.count < 3 {
        return None;
    }
    let name = row.fields[2].to_lowercase();
    let has = |parts: &[&str]| parts.iter().any(|part| name.contains(part));
    if has(&["invalid", "missing", "mask", "bad", "outlier"]) {
        Some(ThirdColumn::Invalid)
    } else if has(&["valid", "good"]) {
        Some(ThirdColumn::Valid)
    } else {
        None
    }
}
