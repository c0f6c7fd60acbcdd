//! Profiles as text: columns of x and z, found by their names, below a header of any length; a column of heights alone;
//! and areal measurements, as columns x, y, z or as a matrix of heights.

use std::fmt::Write as _;

use super::MeasuredSurface;
use super::areal::Areal;
use super::header::{Header, VOCABULARY, note};
use super::options::{LengthUnit, MeasuredPoints, Missing, ProfileOptions, ThirdColumn};
use super::plain::PlainLine;
use super::roles::{EXPECTED_COLUMNS, Roles};
use crate::tables::{
    ANY, Block, ContentError, Heading, NumberStyle, ReadingNote, Separator, behind_note, is_missing, number, shortened,
};

/// What a file holds.
#[derive(Debug)]
pub(super) enum Content {
    Profile(MeasuredPoints),
    Map(Areal),
}

impl Content {
    /// The profile, or the line of the map that `options` choose.
    pub(super) fn line(self, options: &ProfileOptions) -> Result<MeasuredSurface, ContentError> {
        match self {
            Self::Profile(line) => Ok(MeasuredSurface { line, map: None }),
            Self::Map(areal) => areal.surface(options),
        }
    }
}

/// Reads the points and what the header says of them.
pub(super) fn read(text: &str, options: &ProfileOptions) -> Result<Content, ContentError> {
    let blocks = Block::all(text, false);
    let Some(block) = largest(&blocks)? else { return Err(refuse_all(text)) };
    check_above(block)?;
    let column = decimal_column(block);
    let block = column.as_ref().unwrap_or(block);
    let header = Header::read(block);
    if is_matrix(block, &header, options) {
        return matrix(text, block, &header, options).map(Content::Map);
    }
    let read_as = |roles: Roles| {
        let mut reader = PointsReader::new(block, roles, options);
        reader.raw.units = header.units((roles.x, roles.z), options, &mut reader.raw)?;
        reader.add_lines(&text[block.start..], block.first)?;
        reader.finish(&header)
    };
    let is_unnamed = header.table.names.is_empty() && header.table.headings.is_empty();
    let may_be_points =
        is_unnamed && block.columns == 3 && options.third_column.is_none() && options.columns.is_empty();
    match Roles::choose(block, &header, options) {
        Ok(roles) => read_as(roles),
        // Three columns without names that make a grid can be nothing else.
        Err(error) if may_be_points => match read_as(Roles::XYZ) {
            Ok(Content::Map(areal)) => Ok(Content::Map(areal)),
            _ => Err(error),
        },
        Err(error) => Err(error),
    }
}

/// One column of numbers with decimal commas, which look like two columns: below a single name that is known.
fn decimal_column<'a>(block: &Block<'a>) -> Option<Block<'a>> {
    let (_, name) = block.above.last()?;
    let is_name = !name.contains(',') && Heading::parse(name, &VOCABULARY).is_some();
    let two = block.separator == Separator::Letter(',') && block.columns == 2;
    (is_name && two).then(|| block.as_column())
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

/// The block with most rows: what stands above it is a header, however many numbers that has. Of two long ones neither
/// is a header.
fn largest<'b, 'a>(blocks: &'b [Block<'a>]) -> Result<Option<&'b Block<'a>>, ContentError> {
    /// Rows of numbers that a header may have.
    const HEADER: usize = 20;
    let most = blocks.iter().map(|block| block.rows).max().unwrap_or(0);
    let Some(largest) = blocks.iter().find(|block| block.rows == most) else { return Ok(None) };
    let long = |block: &&Block<'_>| block.rows > HEADER && block.first != largest.first;
    match blocks.iter().find(long) {
        Some(other) => {
            let given = format!("from line {} and from line {}", largest.first, other.first);
            Err(ContentError::value(Some(other.first), "tables", &given, "one profile: a file for each"))
        }
        None => Ok(Some(largest)),
    }
}

/// A single line above the data holds names; a word among numbers there is a mistake. Longer headers may hold
/// anything.
fn check_above(block: &Block<'_>) -> Result<(), ContentError> {
    let [(number_of_line, line)] = block.above[..] else { return Ok(()) };
    let fields = block.separator.split(line);
    let is_number = |field: &str| number(field, block.separator.allows_decimal_comma()).is_some();
    let mixed = fields.len() == block.columns && block.columns > 1 && fields.iter().any(|field| is_number(field));
    if !mixed {
        return Ok(());
    }
    let column = fields.iter().position(|field| !is_number(field)).unwrap_or(0);
    Err(refuse_field(&fields[column], if column == 0 { "x" } else { "z" }, number_of_line))
}

/// No line of the text is a point.
fn refuse_all(text: &str) -> ContentError {
    ContentError::value(Some(text.lines().count().max(1)), "points", "0", "at least 2 points for a profile")
}

fn refuse_count(count: usize, number: usize, line: &str, expected: &str) -> ContentError {
    ContentError::value(Some(number), "columns", &format!("{count} in `{}`", shortened(line)), expected)
}

fn refuse_field(field: &str, axis: &str, number: usize) -> ContentError {
    let given = format!("\"{}\"", shortened(field));
    let missing = if axis == "z" { ", or missing = \"fill\" where heights are missing" } else { "" };
    ContentError::value(Some(number), axis, &given, &format!("{ANY}{missing}"))
}

/// Whether the block is a matrix of heights: unnamed columns with two spacings.
fn is_matrix(block: &Block<'_>, header: &Header<'_>, options: &ProfileOptions) -> bool {
    options.columns.is_empty() && header.table.names.is_empty() && block.columns > 1 && options.spacing.len() == 2
}

/// A matrix of heights: a row is a line along x.
fn matrix(text: &str, block: &Block<'_>, header: &Header<'_>, options: &ProfileOptions) -> Result<Areal, ContentError> {
    let mut style = block.style();
    let unit = options.z_unit.map(LengthUnit::unit).or(header.set[1]);
    let mut heights = Vec::with_capacity(block.rows * block.columns);
    for (line, row) in block.lines(text) {
        let fields = block.separator.split(row);
        for field in fields.iter().take(block.columns) {
            let written = style.read(field).map_err(|_| refuse_field(field, "z", line))?;
            let height = written.filter(|height| height.is_nan() || ANY.holds(*height));
            let height = height.or_else(|| is_missing(field).then_some(f64::NAN));
            heights.push(height.ok_or_else(|| refuse_field(field, "z", line))?);
        }
    }
    let [dx, dy] = [options.spacing[0], options.spacing[1]];
    let mut areal = Areal::even("a matrix of heights", [block.columns, block.rows], [dx, dy], heights);
    areal.unit = unit;
    areal.notes.push(note("heights", unit));
    Ok(areal)
}

/// Collects the points, line by line.
struct PointsReader {
    raw: MeasuredPoints,
    y: Vec<f64>,
    roles: Roles,
    columns: usize,
    last: usize,
    separator: Separator,
    style: NumberStyle,
    missing: Missing,
    spacing: f64,
}

impl PointsReader {
    fn new(block: &Block<'_>, roles: Roles, options: &ProfileOptions) -> Self {
        Self {
            raw: MeasuredPoints::with_capacity(block.rows),
            y: Vec::new(),
            roles,
            columns: block.columns,
            last: block.last,
            separator: block.separator,
            style: block.style(),
            missing: options.missing,
            spacing: options.spacing.first().copied().unwrap_or(0.0),
        }
    }

    /// Adds the points in the lines of `text`, the first of which has the number `first`.
    fn add_lines(&mut self, text: &str, first: usize) -> Result<(), ContentError> {
        let is_plain = self.columns == 2 && self.roles.x == Some(0) && self.roles.z == 1;
        let mut rest = text;
        for number in first.. {
            if rest.is_empty() {
                break;
            }
            if let Some(length) = is_plain.then(|| self.add_plain(number, rest)).flatten() {
                rest = &rest[length..];
                continue;
            }
            let (line, behind) = rest.split_once('\n').unwrap_or((rest, ""));
            let line = line.trim_start_matches([' ', '\r']).trim_end_matches([' ', '\r']);
            let is_comment = line.starts_with(['#', '%', '!']) || line.starts_with("//");
            if !line.trim().is_empty() && !is_comment {
                if number > self.last && !self.is_row(line) && !behind.lines().any(|line| self.is_row(line.trim())) {
                    self.record_footer(number, rest);
                    break;
                }
                self.add(number, line)?;
            }
            rest = behind;
        }
        Ok(())
    }

    /// Whether a line behind the block is meant as one of its rows: it begins with a number.
    fn is_row(&self, line: &str) -> bool {
        let first = self.separator.split(line).into_iter().next().unwrap_or_default();
        number(&first, self.separator.allows_decimal_comma()).is_some()
    }

    /// The lines behind the points, which hold words and results.
    fn record_footer(&mut self, number: usize, rest: &str) {
        let lines = rest.lines().filter(|line| !line.trim().is_empty()).count();
        self.raw.notes.push(behind_note(number, lines));
    }

    /// Adds the first line of `text` if it is plain and its numbers are possible, and returns its bytes.
    fn add_plain(&mut self, number: usize, text: &str) -> Option<usize> {
        if self.roles.mark.is_some() {
            return None;
        }
        let PlainLine { x, z, length } = PlainLine::read(text).filter(|line| ANY.holds(line.x) && ANY.holds(line.z))?;
        if !text.as_bytes()[..length].contains(&self.separator_byte()) {
            return None;
        }
        let has_point = text.as_bytes()[..length].contains(&b'.');
        if has_point && self.style.add(".").is_err() {
            return None;
        }
        self.raw.push(number, x, z);
        Some(length)
    }

    fn separator_byte(&self) -> u8 {
        match self.separator {
            Separator::Letter(letter) => u8::try_from(letter).unwrap_or(b','),
            Separator::Blanks => b' ',
        }
    }

    fn add(&mut self, line_number: usize, line: &str) -> Result<(), ContentError> {
        let mut fields = self.separator.split(line);
        while fields.len() > self.columns && fields.last().is_some_and(|field| field.is_empty()) {
            fields.pop();
        }
        let least = self.roles.z.max(self.roles.x.unwrap_or(0)) + 1;
        if fields.len() > self.columns || fields.len() < least {
            let expected = if self.columns == 2 {
                let third = if fields.len() == 3 { "; third_column says what a third one means" } else { "" };
                format!("{EXPECTED_COLUMNS}{third}")
            } else {
                format!("{}, as in the rows above", self.columns)
            };
            return Err(refuse_count(fields.len(), line_number, line, &expected));
        }
        let x = match self.roles.x {
            Some(column) => {
                let x = self.value(&fields[column], line_number)?.filter(|&x| ANY.holds(x));
                x.ok_or_else(|| refuse_field(&fields[column], "x", line_number))?
            }
            None => self.spacing * self.raw.x.len() as f64,
        };
        let height = &fields[self.roles.z];
        let invalid = self.roles.mark.filter(|&mark| is_invalid(&fields, mark));
        let written = if invalid.is_some() { None } else { self.value(height, line_number)? };
        let z = written.filter(|&z| ANY.holds(z));
        // A number that no height can have, 1e38, is one of those that stand for none.
        let is_gap = invalid.is_some() || is_missing(height) || written.is_some();
        let z = match (z, invalid) {
            (Some(z), _) => z,
            (None, _) if self.missing == Missing::Fill && is_gap => f64::NAN,
            (None, Some((column, _))) => {
                return Err(refuse_invalid(fields.get(column).map_or("", |field| field), line_number));
            }
            (None, None) => return Err(refuse_field(height, "z", line_number)),
        };
        if let Some(column) = self.roles.y {
            let y = fields.get(column).map_or("", |field| field);
            let y_value = self.value(y, line_number)?.filter(|&y| ANY.holds(y));
            self.y.push(y_value.ok_or_else(|| refuse_field(y, "y", line_number))?);
        }
        self.raw.push(line_number, x, z);
        Ok(())
    }

    /// The number in a field.
    fn value(&mut self, field: &str, line: usize) -> Result<Option<f64>, ContentError> {
        let given = || format!("\"{}\"", shortened(field));
        self.style.read(field).map_err(|_| ContentError::value(Some(line), "number", &given(), NumberStyle::EXPECTED))
    }

    /// The profile; or the map, where y takes several values.
    fn finish(mut self, header: &Header<'_>) -> Result<Content, ContentError> {
        let varies = self.y.windows(2).any(|pair| pair[0] != pair[1]);
        if varies {
            return Areal::of_points(self.raw, &self.y).map(Content::Map);
        }
        self.raw.is_spaced = self.roles.x.is_none();
        if header.table.names.is_empty() && self.roles.x.is_some() {
            let text = "no names: x is the first column, z the second".to_owned();
            self.raw.notes.push(ReadingNote { text, assumed: true });
        }
        Ok(Content::Profile(self.raw))
    }
}

/// Whether the mark of a row says that its height is not valid.
fn is_invalid(fields: &[std::borrow::Cow<'_, str>], (column, meaning): (usize, ThirdColumn)) -> bool {
    const UNSET: [&str; 7] = ["", "false", "no", "n", "f", "-", "off"];
    let field = fields.get(column).map_or("", |field| field);
    let is_unset = UNSET.iter().any(|word| field.eq_ignore_ascii_case(word)) || number(field, true) == Some(0.0);
    match meaning {
        ThirdColumn::Invalid => !is_unset,
        ThirdColumn::Valid => is_unset,
        ThirdColumn::Ignore => false,
    }
}

fn refuse_invalid(field: &str, number: usize) -> ContentError {
    let given = format!("\"{}\"", shortened(field));
    ContentError::value(Some(number), "third column", &given, "valid points alone, or missing = \"fill\"")
}
