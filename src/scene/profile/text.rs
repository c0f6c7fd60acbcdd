//! Profiles as text: columns of x and z, found by their names, below a header of any length; a column of heights alone; and
//! areal measurements, as columns x, y, z or as a matrix of heights.

use std::fmt::Write as _;

use super::areal::Areal;
use super::options::{LengthUnit, MeasuredPoints, Missing, ProfileOptions, ReadingNote, ThirdColumn};
use super::plain::PlainLine;
use crate::scene::error::ContentError;
use crate::scene::text_table::{
    Block, Dimension, Head, Heading, HeadingUnit, Line, NumberStyle, Separator, Unit, Words, is_missing, number, words,
};
use crate::scene::values::ANY;

const EXPECTED_COLUMNS: &str = "two, x and z, separated by comma, semicolon, tab or blanks";
const ONE_UNIT: &str = "the header names a unit for one of the two columns alone; it is taken for both: x_unit and z_unit \
                        say otherwise";
const CHOOSE: &str = "columns = [\"x\", \"z\"] (--columns x,z) with the names or the numbers of the columns";

/// What a text holds.
#[derive(Debug)]
pub(super) enum Content {
    Profile(MeasuredPoints),
    Map(Areal),
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
    let roles = Roles::choose(block, &header, options)?;
    let mut reader = PointsReader::new(block, roles, options);
    reader.raw.units = header.units(&roles, options, &mut reader.raw)?;
    reader.add_lines(&text[block.start..], block.first)?;
    reader.finish(&header)
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
    ContentError::value(Some(number), "columns", &format!("{count} in `{}`", cut(line)), expected)
}

fn refuse_field(field: &str, axis: &str, number: usize) -> ContentError {
    let given = format!("\"{}\"", cut(field));
    let missing = if axis == "z" { ", or missing = \"fill\" where heights are missing" } else { "" };
    ContentError::value(Some(number), axis, &given, &format!("{ANY}{missing}"))
}

fn cut(text: &str) -> String {
    text.chars().take(60).collect()
}

/// What a column of a profile may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Axis {
    X,
    Y,
    Z,
}

const fn axis(axis: Axis, key_words: &'static [&'static str], other_words: &'static [&'static str]) -> Words<Axis> {
    Words { quantity: axis, dimension: Dimension::Length, key_words, other_words }
}

const VOCABULARY: [Words<Axis>; 3] = [
    axis(
        Axis::X,
        &[
            "x", "distance", "position", "pos", "lateral", "length", "chainage", "station", "abscissa", "place", "weg",
            "strecke", "abstand", "länge", "laenge", "location", "dist", "xpos", "mileage",
        ],
        &[
            "axis",
            "coordinate",
            "coord",
            "value",
            "values",
            "scan",
            "direction",
            "profile",
            "trace",
            "along",
            "travel",
            "travelled",
            "measured",
            "horizontal",
            "achse",
            "stylus",
            "x1",
            "the",
            "road",
            "of",
        ],
    ),
    axis(
        Axis::Z,
        &[
            "z",
            "z2",
            "z3",
            "z4",
            "height",
            "heights",
            "elevation",
            "elev",
            "depth",
            "profile",
            "topography",
            "altitude",
            "amplitude",
            "höhe",
            "hoehe",
            "tiefe",
            "ordinate",
            "z1",
            "profil",
        ],
        &[
            "axis",
            "coordinate",
            "coord",
            "value",
            "values",
            "roughness",
            "raw",
            "primary",
            "r",
            "p",
            "w",
            "waviness",
            "surface",
            "data",
            "filtered",
            "leveled",
            "levelled",
            "relative",
            "mean",
            "measured",
            "vertical",
            "corrected",
            "left",
            "right",
            "achse",
            "road",
            "of",
            "the",
            "center",
            "centre",
        ],
    ),
    axis(
        Axis::Y,
        &["y", "y1", "y2", "y3", "y4"],
        &["axis", "coordinate", "coord", "position", "pos", "value", "values", "achse"],
    ),
];

/// The header of a profile.
#[derive(Debug)]
struct Header<'a> {
    names: Vec<std::borrow::Cow<'a, str>>,
    line: Option<usize>,
    /// What the columns are, as far as their names say.
    headings: Vec<Option<Heading<Axis>>>,
    /// The units of x and z that lines such as `X-Unit: mm` set.
    set: [Option<Unit>; 2],
    /// A line that speaks of a unit, though it is none of names.
    stated: Option<(Line<'a>, Unit)>,
}

impl<'a> Header<'a> {
    fn read(block: &Block<'a>) -> Self {
        let is_setting = |line: &str| setting(line).is_some();
        let mut named = block.clone();
        named.above.retain(|(_, line)| !is_setting(line));
        let is_known = |name: &str| Heading::parse(name, &VOCABULARY).is_some();
        let Head { mut names, mut line, units } = named.head(&is_known);
        // Words above such settings name the file, not its columns.
        let is_above = |names: usize| block.above.iter().any(|(line, text)| *line > names && is_setting(text));
        if line.is_some_and(is_above) && !names.iter().any(|name| is_known(name)) {
            (names, line) = (Vec::new(), None);
        }
        let heading = |(i, name): (usize, &std::borrow::Cow<'a, str>)| {
            Heading::with_unit(name, units.get(i).map_or("", |unit| unit), &VOCABULARY)
        };
        let mut headings: Vec<_> = names.iter().enumerate().map(heading).collect();
        if names.is_empty() && units.len() == block.columns {
            headings = unnamed(&units);
        }
        let mut set = [None; 2];
        for (axes, unit) in block.above.iter().filter_map(|(_, line)| setting(line)) {
            axes.iter().for_each(|&axis| set[axis] = Some(unit));
        }
        let stated = named.stated_unit(Dimension::Length, line);
        Self { names, line, headings, set, stated }
    }

    /// Which columns are called so.
    fn named(&self, axis: Axis) -> Vec<usize> {
        let is_it = |i: &usize| self.headings[*i].as_ref().is_some_and(|heading| heading.quantity == axis);
        (0..self.headings.len()).filter(is_it).collect()
    }

    fn name(&self, column: usize) -> String {
        match self.names.get(column).map(|name| name.trim()).filter(|name| !name.is_empty()) {
            Some(name) => format!("column {} ({name})", column + 1),
            None => format!("column {}", column + 1),
        }
    }

    /// The unit that a column's heading names.
    fn unit(&self, column: usize, key: &str) -> Result<Option<Unit>, ContentError> {
        let heading = self.headings.get(column).and_then(Option::as_ref);
        if heading.is_some_and(|heading| heading.logarithm.is_some()) {
            return Err(ContentError::value(self.line, "columns", &self.name(column), "numbers, not their logarithms"));
        }
        match heading.map(|heading| &heading.unit) {
            Some(HeadingUnit::Known(unit)) => Ok(Some(*unit)),
            Some(HeadingUnit::Unknown(unit)) => {
                let given = format!("\"{}\" of {}", cut(unit), self.name(column));
                let expected = format!("a unit of length: {}; or {key} in the scene", Dimension::Length.units());
                Err(ContentError::value(self.line, "unit", &given, &expected))
            }
            _ => Ok(None),
        }
    }

    /// The units of x and z, and notes on them.
    fn units(
        &self,
        roles: &Roles,
        options: &ProfileOptions,
        raw: &mut MeasuredPoints,
    ) -> Result<[Option<Unit>; 2], ContentError> {
        let given = [options.x_unit, options.z_unit].map(|unit| unit.map(LengthUnit::unit));
        let of_column = |axis: usize, column: Option<usize>, key: &str| match (given[axis], column) {
            (Some(unit), _) => Ok(Some(unit)),
            (None, Some(column)) => Ok(self.unit(column, key)?.or(self.set[axis])),
            (None, None) => Ok(self.set[axis]),
        };
        let (x, z) = (of_column(0, roles.x, "x_unit")?, of_column(1, Some(roles.z), "z_unit")?);
        if let (None, None, Some(((line, text), unit))) = (x, z, self.stated) {
            let expected =
                format!("the units beside the names, as in x [{unit}]; or x_unit and z_unit (--unit {unit})");
            return Err(ContentError::value(Some(line), "units", &format!("`{}`", cut(text)), &expected));
        }
        if roles.x.is_none() {
            raw.notes.push(note(&format!("heights from {}", self.name(roles.z)), z));
            // The spacing is in m.
            return Ok([None, z]);
        }
        if x.is_none() != z.is_none() {
            raw.warnings.push(ONE_UNIT.into());
        }
        let units = [x.or(z), z.or(x)];
        let [x, z] = [roles.x.unwrap_or(0), roles.z].map(|column| self.name(column));
        raw.notes.push(match units {
            [Some(x_unit), Some(z_unit)] => {
                let text = format!("x from {x} in {x_unit}, z from {z} in {z_unit}");
                ReadingNote { text, assumed: false }
            }
            _ => {
                let text = format!("x from {x}, z from {z}, which name no unit: m is assumed");
                ReadingNote { text, assumed: true }
            }
        });
        if words(self.names.get(roles.z).map_or("", |name| name)).iter().any(|word| word == "depth" || word == "tiefe")
        {
            raw.notes.push(ReadingNote { text: "depths are taken as heights, upwards".into(), assumed: true });
        }
        Ok(units)
    }
}

fn note(what: &str, unit: Option<Unit>) -> ReadingNote {
    match unit {
        Some(unit) => ReadingNote { text: format!("{what} in {unit}"), assumed: false },
        None => ReadingNote { text: format!("{what}, which names no unit: m is assumed"), assumed: true },
    }
}

/// Columns that have units but no names: x and z.
fn unnamed(units: &[std::borrow::Cow<'_, str>]) -> Vec<Option<Heading<Axis>>> {
    let heading = |(axis, unit): (Axis, &std::borrow::Cow<'_, str>)| {
        let name = if axis == Axis::X { "x" } else { "z" };
        Heading::with_unit(name, unit, &VOCABULARY)
    };
    if units.len() == 2 { [Axis::X, Axis::Z].into_iter().zip(units).map(heading).collect() } else { Vec::new() }
}

/// Of a line such as `X-Unit: mm` or `unit;um`: the axes, 0 for x and 1 for z, and their unit.
fn setting(line: &str) -> Option<(&'static [usize], Unit)> {
    let words: Vec<&str> =
        line.split(|letter: char| !letter.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    let name = words.iter().position(|word| {
        let word = word.to_lowercase();
        word.ends_with("unit") || word.ends_with("units")
    })?;
    let is_length = |word: &&str| Unit::parse(word).filter(|unit| unit.dimension == Dimension::Length);
    let mut units = words[name + 1..].iter().filter_map(is_length);
    let (unit, None) = (units.next()?, units.next()) else { return None };
    let names = |axis: &[&str]| {
        let of_axis = |word: &&str| {
            let word = word.to_lowercase();
            axis.iter().any(|name| word == *name || word == format!("{name}unit") || word == format!("{name}units"))
        };
        words[..=name].iter().any(of_axis)
    };
    Some(match (names(&["x", "horizontal", "lateral"]), names(&["z", "y", "height", "vertical"])) {
        (true, false) => (&[0], unit),
        (false, true) => (&[1], unit),
        _ => (&[0, 1], unit),
    })
}

/// Which columns hold what, from 0.
#[derive(Clone, Copy, Debug)]
struct Roles {
    /// None where the points have an even spacing.
    x: Option<usize>,
    /// Of an areal measurement.
    y: Option<usize>,
    z: usize,
    mark: Option<(usize, ThirdColumn)>,
}

impl Roles {
    /// By `columns`, or by the names, or the first two columns of a file that has no others.
    fn choose(block: &Block<'_>, header: &Header<'_>, options: &ProfileOptions) -> Result<Self, ContentError> {
        let mark = mark(header, options, block.columns);
        let roles = match &options.columns[..] {
            [] => Self::by_names(block, header, options, mark)?,
            [z] => Self { x: None, y: None, z: column(z, block, header)?, mark },
            [x, z] => Self { x: Some(column(x, block, header)?), y: None, z: column(z, block, header)?, mark },
            more => {
                return Err(ContentError::value(
                    None,
                    "columns",
                    &format!("{} names", more.len()),
                    "x and z, or z alone",
                ));
            }
        };
        match (roles.x, &options.spacing[..]) {
            (None, []) => Err(no_spacing(block, header)),
            (Some(x), [_, ..]) => {
                let expected = format!("none, for x is {}", header.name(x));
                Err(ContentError::value(None, "spacing", "given", &expected))
            }
            _ => Ok(roles),
        }
    }

    fn by_names(
        block: &Block<'_>,
        header: &Header<'_>,
        options: &ProfileOptions,
        mark: Option<(usize, ThirdColumn)>,
    ) -> Result<Self, ContentError> {
        let [x, y, z] = [Axis::X, Axis::Y, Axis::Z].map(|axis| header.named(axis));
        if block.columns == 1 {
            return Ok(Self { x: None, y: None, z: 0, mark });
        }
        if header.names.is_empty() && header.headings.is_empty() {
            return Self::unnamed(block, options, mark);
        }
        match (&x[..], &y[..], &z[..]) {
            (&[x], [], &[z]) | (&[x], &[z], []) => Ok(Self { x: Some(x), y: None, z, mark }),
            (&[x], &[y], &[z]) => Ok(Self { x: Some(x), y: Some(y), z, mark }),
            ([], [], &[z]) if !options.spacing.is_empty() => Ok(Self { x: None, y: None, z, mark }),
            _ => {
                let names: Vec<&str> = header.names.iter().map(|name| name.trim()).collect();
                let given = format!("`{}`", cut(&names.join(", ")));
                let why = match (x.len(), z.len().max(y.len())) {
                    (0, 0) => "the names do not tell x and z",
                    (0, 1) => "no name is that of x; spacing in place of x where points are even",
                    (1, 0) => "no name is that of z",
                    _ => "several columns have such names",
                };
                Err(ContentError::value(header.line, "columns", &given, &format!("{CHOOSE}: {why}")))
            }
        }
    }

    /// Without names: x and z, and beside them what `third_column` says.
    fn unnamed(
        block: &Block<'_>,
        options: &ProfileOptions,
        mark: Option<(usize, ThirdColumn)>,
    ) -> Result<Self, ContentError> {
        match (block.columns, options.third_column) {
            (2, _) | (3, Some(ThirdColumn::Valid | ThirdColumn::Invalid)) => {
                Ok(Self { x: Some(0), y: None, z: 1, mark })
            }
            // One of them may count the rows, or be y.
            (count, third) => {
                let marks =
                    if count == 3 && third.is_none() { "; third_column if the third one marks points" } else { "" };
                let expected = format!("{EXPECTED_COLUMNS}{marks}; or {CHOOSE}");
                Err(ContentError::value(Some(block.first), "columns", &count.to_string(), &expected))
            }
        }
    }
}

fn no_spacing(block: &Block<'_>, header: &Header<'_>) -> ContentError {
    let hint = block.above.iter().find(|(_, line)| {
        ["spacing", "step", "increment", "interval"].iter().any(|word| line.to_lowercase().contains(word))
    });
    let hint = hint.map_or_else(String::new, |(line, text)| format!("; line {line} says `{}`", cut(text)));
    let expected = format!(
        "the distance of the points in m, spacing = 1e-5 (--spacing 1e-5), for {} holds heights without x{hint}",
        if block.columns == 1 { "the only column".into() } else { header.name(0) },
    );
    ContentError::value(Some(block.first), "spacing", "not given", &expected)
}

/// A column by its name, or by its number from 1.
fn column(name: &str, block: &Block<'_>, header: &Header<'_>) -> Result<usize, ContentError> {
    let wanted = words(name);
    let is_it =
        |by: &dyn Fn(&str) -> bool| (0..header.names.len()).filter(|&i| by(header.names[i].trim())).collect::<Vec<_>>();
    let number =
        || name.trim().parse().ok().filter(|number| (1..=block.columns).contains(number)).map(|number| number - 1);
    let exact = is_it(&|text| text == name.trim());
    let similar = is_it(&|text| words(text) == wanted);
    // Without its unit.
    let begins = is_it(&|text| words(text).starts_with(&wanted));
    let found = [exact, similar, begins].into_iter().find(|found| !found.is_empty()).unwrap_or_default();
    match (&found[..], number()) {
        (&[column], _) | ([], Some(column)) => Ok(column),
        (found, _) => {
            let names: Vec<String> = header.names.iter().map(|name| format!("\"{}\"", name.trim())).collect();
            let which = if found.is_empty() { "one of" } else { "one name of its own, of" };
            let expected = format!("{which} {} or a number from 1 to {}", names.join(", "), block.columns);
            Err(ContentError::value(header.line, "columns", &format!("\"{}\"", cut(name)), &expected))
        }
    }
}

/// The column that marks points, by its name or else the third one.
fn mark(header: &Header<'_>, options: &ProfileOptions, columns: usize) -> Option<(usize, ThirdColumn)> {
    let meaning = |name: &str| {
        let name = name.to_lowercase();
        let has = |parts: &[&str]| parts.iter().any(|part| name.contains(part));
        if has(&["invalid", "missing", "mask", "bad", "outlier"]) {
            Some(ThirdColumn::Invalid)
        } else if has(&["valid", "good"]) {
            Some(ThirdColumn::Valid)
        } else {
            None
        }
    };
    let by_name = (0..header.names.len()).find_map(|i| Some((i, meaning(&header.names[i])?)));
    match options.third_column {
        Some(ThirdColumn::Ignore) => None,
        Some(given) => by_name.map(|(i, _)| (i, given)).or((columns == 3).then_some((2, given))),
        None => by_name,
    }
}

/// Whether the block is a matrix of heights: unnamed columns with two spacings.
fn is_matrix(block: &Block<'_>, header: &Header<'_>, options: &ProfileOptions) -> bool {
    options.columns.is_empty() && header.names.is_empty() && block.columns > 1 && options.spacing.len() == 2
}

/// A matrix of heights: a row is a line along x.
fn matrix(text: &str, block: &Block<'_>, header: &Header<'_>, options: &ProfileOptions) -> Result<Areal, ContentError> {
    let mut style = NumberStyle::of(block);
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
            style: NumberStyle::of(block),
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
        let text = match lines {
            1 => format!("line {number}, behind the points, is left out"),
            _ => format!("{lines} lines from line {number} on, behind the points, are left out"),
        };
        self.raw.notes.push(ReadingNote { text, assumed: false });
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
        let given = || format!("\"{}\"", cut(field));
        self.style.read(field).map_err(|_| ContentError::value(Some(line), "number", &given(), NumberStyle::EXPECTED))
    }

    /// The profile; or the map, where y takes several values.
    fn finish(mut self, header: &Header<'_>) -> Result<Content, ContentError> {
        let varies = self.y.windows(2).any(|pair| pair[0] != pair[1]);
        if varies {
            return Areal::of_points(self.raw, &self.y).map(Content::Map);
        }
        self.raw.is_spaced = self.roles.x.is_none();
        if header.names.is_empty() && self.roles.x.is_some() {
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
    let given = format!("\"{}\"", cut(field));
    ContentError::value(Some(number), "third column", &given, "valid points alone, or missing = \"fill\"")
}
