//! Profiles as text: columns of x and z, found by their names, below a header of any length; a column of heights alone;
//! and areal measurements, as columns x, y, z or as a matrix of heights.

use std::borrow::Cow;
use std::fmt::Write as _;

use super::MeasuredSurface;
use super::areal::Areal;
use super::header::{Header, VOCABULARY, note};
use super::options::{LengthUnit, MeasuredPoints, Missing, ProfileOptions, ThirdColumn};
use super::roles::{EXPECTED_COLUMNS, Roles};
use crate::tables::{
    ANY, Block, ContentError, DecimalSigns, Heading, Line, NumberStyle, ReadingNote, Separator, UsedColumn,
    behind_note, is_missing, number, shortened,
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
    let read_as = |roles: Roles| PointsReader::new(block, roles, options).read(text, &header);
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
    ContentError::value(Some(number), "columns", &format!("{count} in \"{}\"", shortened(line)), expected)
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
fn matrix<'a>(
    text: &'a str,
    block: &Block<'a>,
    header: &Header<'_>,
    options: &ProfileOptions,
) -> Result<Areal, ContentError> {
    let used: Vec<UsedColumn> = (0..block.columns).map(|index| UsedColumn::new(index, "z")).collect();
    let (mut style, decided) = block.style_with(text, DecimalSigns::of([block], text), &used)?;
    let unit = options.z_unit.map(LengthUnit::unit).or(header.set[1]);
    let mut heights = Vec::with_capacity(block.rows * block.columns);
    for row in block.rows(text) {
        for field in row.fields.iter().take(block.columns) {
            let written = value(&mut style, field, "z", row.line)?;
            let height = written.filter(|height| height.is_nan() || ANY.holds(*height));
            let height = height.or_else(|| is_missing(field).then_some(f64::NAN));
            heights.push(height.ok_or_else(|| refuse_field(field, "z", row.line))?);
        }
    }
    let [dx, dy] = [options.spacing[0], options.spacing[1]];
    let mut areal = Areal::even("a matrix of heights", [block.columns, block.rows], [dx, dy], heights);
    areal.unit = unit;
    areal.notes.push(note("heights", unit));
    areal.notes.extend(decided.into_iter().take(1));
    Ok(areal)
}

/// The number in a field.
fn value(style: &mut NumberStyle, field: &str, axis: &str, line: usize) -> Result<Option<f64>, ContentError> {
    let given = || format!("\"{}\"", shortened(field));
    style.read(field).map_err(|_| ContentError::value(Some(line), axis, &given(), NumberStyle::EXPECTED))
}

/// Collects the points, line by line.
struct PointsReader<'a, 'b> {
    block: &'b Block<'a>,
    roles: Roles,
    options: &'b ProfileOptions,
    style: NumberStyle,
    raw: MeasuredPoints,
    y: Vec<f64>,
}

impl<'a, 'b> PointsReader<'a, 'b> {
    fn new(block: &'b Block<'a>, roles: Roles, options: &'b ProfileOptions) -> Self {
        let raw = MeasuredPoints::with_capacity(block.rows);
        Self { block, roles, options, style: block.style(), raw, y: Vec::new() }
    }

    /// The profile; or the map, where y takes several values.
    fn read(mut self, text: &'a str, header: &Header<'_>) -> Result<Content, ContentError> {
        let used = [("x", self.roles.x), ("y", self.roles.y), ("z", Some(self.roles.z))];
        let used: Vec<UsedColumn> = used.iter().filter_map(|(axis, i)| Some(UsedColumn::new((*i)?, axis))).collect();
        let (style, decided) = self.block.style_with(text, DecimalSigns::of([self.block], text), &used)?;
        self.style = style;
        self.raw.notes.extend(decided);
        self.raw.units = header.units((self.roles.x, self.roles.z), self.options, &mut self.raw)?;
        let below: Vec<Line<'_>> = self.block.below(text).collect();
        let end = below.iter().rposition(|(_, line)| self.is_row(line)).map_or(0, |last| last + 1);
        let (meant, footer) = below.split_at(end);
        for line in self.block.lines(text).chain(meant.iter().copied()) {
            self.add(line)?;
        }
        self.tell_depths(header.says_depth(self.roles.z));
        // Words and results.
        self.raw.notes.extend(footer.first().map(|(line, _)| behind_note(*line, footer.len())));
        if self.y.windows(2).any(|pair| pair[0] != pair[1]) {
            let y_unit = self.roles.y.map(|column| header.unit_of_y(column, self.options)).transpose()?.flatten();
            return Areal::of_points(self.raw, &self.y, y_unit).map(Content::Map);
        }
        self.raw.is_spaced = self.roles.x.is_none();
        if header.table.names.is_empty() && self.roles.x.is_some() {
            let text = "no names: x is the first column, z the second".to_owned();
            self.raw.notes.push(ReadingNote { text, assumed: true });
        }
        Ok(Content::Profile(self.raw))
    }

    /// Notes which way the numbers are taken to grow where their column `is_called` depth. Depths below a datum are
    /// mostly above 0; where most are below, they are heights.
    fn tell_depths(&mut self, is_called: bool) {
        let count = |is_it: fn(&f64) -> bool| self.raw.z.iter().filter(|z| is_it(z)).count();
        self.raw.is_depth = is_called && count(|z| *z > 0.0) >= count(|z| *z < 0.0);
        if is_called && self.options.depth.is_none() {
            let text = match self.raw.is_depth {
                true => {
                    "the column is called depth, so its numbers grow downwards, z = -depth: depth = \"up\" where they do not"
                }
                false => {
                    "the column is called depth, but most of its numbers are below 0 and taken as heights: depth = \"down\" \
                     turns them over"
                }
            };
            self.raw.notes.push(ReadingNote { text: text.to_owned(), assumed: true });
        }
    }

    /// Whether a line behind the block is meant as one of its rows: it begins with a number.
    fn is_row(&self, line: &str) -> bool {
        let first = self.block.separator.split(line).into_iter().next().unwrap_or_default();
        number(&first, self.block.separator.allows_decimal_comma()).is_some()
    }

    fn add(&mut self, (line, text): Line<'_>) -> Result<(), ContentError> {
        let (columns, mut fields) = (self.block.columns, self.block.separator.split(text));
        while fields.len() > columns && fields.last().is_some_and(|field| field.is_empty()) {
            fields.pop();
        }
        let least = self.roles.z.max(self.roles.x.unwrap_or(0)) + 1;
        if fields.len() > columns || fields.len() < least {
            let expected = match (columns, fields.len()) {
                (2, 3) => format!("{EXPECTED_COLUMNS}; third_column says what a third one means"),
                (2, _) => EXPECTED_COLUMNS.to_owned(),
                _ => format!("{columns}, as in the rows above"),
            };
            return Err(refuse_count(fields.len(), line, text, &expected));
        }
        let x = match self.roles.x {
            Some(column) => self.position(&fields[column], "x", line)?,
            None => self.options.spacing.first().copied().unwrap_or(0.0) * self.raw.x.len() as f64,
        };
        let z = self.height(&fields, line)?;
        if let Some(column) = self.roles.y {
            let y = self.position(fields.get(column).map_or("", |field| field), "y", line)?;
            self.y.push(y);
        }
        self.raw.push(line, x, z);
        Ok(())
    }

    fn position(&mut self, field: &str, axis: &str, line: usize) -> Result<f64, ContentError> {
        let found = value(&mut self.style, field, axis, line)?.filter(|&number| ANY.holds(number));
        found.ok_or_else(|| refuse_field(field, axis, line))
    }

    /// The height in a row; NaN where it is missing and may be.
    fn height(&mut self, fields: &[Cow<'_, str>], line: usize) -> Result<f64, ContentError> {
        let field = &fields[self.roles.z];
        let invalid = self.roles.mark.filter(|&mark| is_invalid(fields, mark));
        let written = if invalid.is_some() { None } else { value(&mut self.style, field, "z", line)? };
        // A number that no height can have, 1e38, is one of those that stand for none.
        let is_gap = invalid.is_some() || is_missing(field) || written.is_some();
        match (written.filter(|&z| ANY.holds(z)), invalid) {
            (Some(z), _) => Ok(z),
            (None, _) if self.options.missing == Missing::Fill && is_gap => Ok(f64::NAN),
            (None, Some((column, _))) => Err(refuse_invalid(fields.get(column).map_or("", |field| field), line)),
            (None, None) => Err(refuse_field(field, "z", line)),
        }
    }
}

/// Whether the mark of a row says that its height is not valid.
fn is_invalid(fields: &[Cow<'_, str>], (column, meaning): (usize, ThirdColumn)) -> bool {
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
