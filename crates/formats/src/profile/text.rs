//! Profiles as text: columns of x and z, found by their names, below a header of any length; a column of heights alone;
//! and areal measurements, as columns x, y, z or as a matrix of heights.

use std::borrow::Cow;

use asperity::scene::{LengthUnit, Missing, ProfileOptions, ThirdColumn};
use asperity::tables::{ANY, ContentError, Dimension, ReadingNote, Role, Unit, shortened};

use super::grid::{Areal, refuse_lines};
use super::header::{Settings, Size};
use super::points::MeasuredPoints;
use crate::text::{
    Block, Decimal, Head, Line, Separator, UsedColumn, behind_note, chosen, decimal_of, find, is_missing, is_number,
    left_out_words, unit_beside,
};

/// What a column of a profile may be.
pub const ROLES: [Role; 3] = [
    Role::new(
        "x",
        "position, pos, x position, x pos, xpos, lateral position, x coordinate, x coord, x axis, x value, x values, \
         distance, dist, x distance, distance along road, travel distance, travelled distance, measured distance, length, \
         profile length, scan length, trace length, measured length, travel, chainage, station, mileage, abscissa, place, \
         location, lateral, x1, weg, strecke, messstrecke, abstand, länge, laenge, x achse",
        Dimension::Length,
    ),
    Role::new(
        "z",
        "height, heights, z height, profile height, surface height, height values, z position, z coordinate, z coord, z \
         axis, z value, z values, mean height, relative height, measured height, filtered height, levelled height, \
         leveled height, corrected height, raw height, elevation, elev, elevation of the road, altitude, amplitude, \
         ordinate, profile, profile data, raw profile, primary profile, roughness profile, waviness profile, filtered \
         profile, levelled profile, leveled profile, p profile, r profile, w profile, topography, z1, z2, z3, z4, höhe, \
         hoehe, profil, z achse, depth, depths, profile depth, measured depth, tiefe",
        Dimension::Length,
    ),
    Role::new(
        "y",
        "y position, y pos, y coordinate, y coord, y axis, y value, y values, y1, y2, y3, y4, y achse",
        Dimension::Length,
    ),
];
const X: usize = 0;
const Z: usize = 1;
const Y: usize = 2;

const EXPECTED: &str = "two, x and z, separated by comma, semicolon, tab or blanks";
const CHOOSE: &str =
    "columns = { x = \"NAME\", z = \"NAME\" } (--columns x,z) with the names or the numbers of the columns";

/// What a file holds.
#[derive(Debug)]
pub(super) enum Content {
    /// A line.
    Profile(MeasuredPoints),
    /// Lines.
    Map(Areal),
}

/// Reads the points and what the header says of them.
pub(super) fn read(text: &str, options: &ProfileOptions) -> Result<Content, ContentError> {
    let blocks = Block::all(text, false);
    let Some(block) = largest(&blocks)? else {
        let line = Some(text.lines().count().max(1));
        return Err(ContentError::value(line, "points", "0", "at least 2 points for a profile"));
    };
    let settings = Settings::of(&block.above);
    let block = &block.under(settings.others(block));
    let is_chosen = |name: &str| options.columns.iter().any(|(_, column)| column.trim() == name.trim());
    let head = block.head(&|name| is_chosen(name) || !matches!(find(name, "", &ROLES), Ok(None)))?;
    let table = Table { text, block, head: &head, settings: &settings, options };
    let is_unnamed = head.names.is_empty() && head.units.is_empty() && options.columns.is_empty();
    if is_unnamed && block.columns > 2 && options.spacing.len() == 2 {
        return table.matrix().map(Content::Map);
    }
    if block.columns > 3 && is_unnamed && table.first_row_rises()? {
        return table.matrix().map(Content::Map);
    }
    let may_be_points = is_unnamed && block.columns == 3 && options.third_column.is_none();
    match table.places() {
        Ok(places) => table.points(&places),
        // Three columns without names that make a grid can be nothing else.
        Err(error) if may_be_points => match table.points(&Places::XYZ) {
            Ok(Content::Map(areal)) => Ok(Content::Map(areal)),
            _ => Err(error),
        },
        Err(error) => Err(error),
    }
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

/// Which columns hold what, from 0.
#[derive(Clone, Copy, Debug)]
struct Places {
    /// None where the points have an even spacing.
    x: Option<usize>,
    /// Of an areal measurement.
    y: Option<usize>,
    z: usize,
    mark: Option<(usize, ThirdColumn)>,
}

impl Places {
    /// Of points in space.
    const XYZ: Self = Self { x: Some(0), y: Some(1), z: 2, mark: None };
}

/// A table, and how it is to be read.
struct Table<'t, 'a> {
    text: &'a str,
    block: &'t Block<'a>,
    head: &'t Head<'a>,
    settings: &'t Settings<'a>,
    options: &'t ProfileOptions,
}

impl<'a> Table<'_, 'a> {
    fn name(&self, index: usize) -> &str {
        self.head.names.get(index).map_or("", |name| name.trim())
    }

    fn below(&self, index: usize) -> &str {
        self.head.units.get(index).map_or("", |unit| unit)
    }

    fn label(&self, index: usize) -> String {
        match self.name(index) {
            "" => format!("column {}", index + 1),
            name => format!("column {} \"{}\"", index + 1, shortened(name)),
        }
    }

    fn refuse(&self, key: &str, given: &str, expected: &str) -> ContentError {
        ContentError::value(self.head.line.or(Some(self.block.first)), key, given, expected)
    }

    /// The columns: those chosen, those of such names, or the only two there are.
    fn places(&self) -> Result<Places, ContentError> {
        let mark = self.mark();
        let column = |name: &str| chosen(name, &self.head.names, self.block.columns, self.head.line);
        let of_key = |key: &str| {
            let found = self.options.columns.iter().find(|(role, _)| role == key);
            found.map(|(_, name)| column(name)).transpose()
        };
        let (x, y, z) = (of_key("x")?, of_key("y")?, of_key("z")?);
        let places = if (x, y, z) == (None, None, None) {
            self.by_names(mark)?
        } else {
            // What is not said is found by its name.
            let x = x.or_else(|| self.only(X).filter(|x| self.options.spacing.is_empty() && Some(*x) != z));
            let z = z.or_else(|| self.only(Z).filter(|z| Some(*z) != x));
            Places { x, y, z: z.ok_or_else(|| self.unknown("no name is that of z"))?, mark }
        };
        match (places.x, &self.options.spacing[..]) {
            (None, []) => Err(self.no_spacing()),
            (Some(x), [_, ..]) => {
                let expected = format!("none, for x is {}", self.label(x));
                Err(ContentError::value(None, "spacing", "given", &expected))
            }
            _ => Ok(places),
        }
    }

    fn by_names(&self, mark: Option<(usize, ThirdColumn)>) -> Result<Places, ContentError> {
        if self.block.columns == 1 {
            return Ok(Places { x: None, y: None, z: 0, mark });
        }
        if self.head.names.is_empty() {
            return self.unnamed(mark);
        }
        let [x, z, y] = [X, Z, Y].map(|role| self.named(role));
        match (&x[..], &y[..], &z[..]) {
            (&[x], [], &[z]) | (&[x], &[z], []) => Ok(Places { x: Some(x), y: None, z, mark }),
            (&[x], &[y], &[z]) => Ok(Places { x: Some(x), y: Some(y), z, mark }),
            ([], [], &[z]) if !self.options.spacing.is_empty() => Ok(Places { x: None, y: None, z, mark }),
            (x, y, z) => Err(self.unknown(match (x.len(), z.len().max(y.len())) {
                (0, 0) => "the names do not tell x and z",
                (0, 1) => "no name is that of x; spacing in place of x where points are even",
                (1, 0) => "no name is that of z",
                _ => "several columns have such names",
            })),
        }
    }

    /// The columns that are called as a role is; what stands in the place of their unit is looked at once they are read.
    fn named(&self, role: usize) -> Vec<usize> {
        let is_it = |index: &usize| match find(self.name(*index), self.below(*index), &ROLES) {
            Ok(found) => found.is_some_and(|heading| heading.role == role),
            Err(refused) => refused.role == role,
        };
        (0..self.head.names.len().min(self.block.columns)).filter(is_it).collect()
    }

    fn only(&self, role: usize) -> Option<usize> {
        match self.named(role)[..] {
            [index] => Some(index),
            _ => None,
        }
    }

    fn unknown(&self, why: &str) -> ContentError {
        let names: Vec<&str> = self.head.names.iter().map(|name| name.trim()).collect();
        self.refuse("columns", &format!("\"{}\"", shortened(&names.join(", "))), &format!("{CHOOSE}: {why}"))
    }

    /// Without names: x and z, and beside them what `third_column` says.
    fn unnamed(&self, mark: Option<(usize, ThirdColumn)>) -> Result<Places, ContentError> {
        match (self.block.columns, self.options.third_column) {
            (2, _) | (3, Some(ThirdColumn::Valid | ThirdColumn::Invalid)) => {
                Ok(Places { x: Some(0), y: None, z: 1, mark })
            }
            // One of them may count the rows, or be y.
            (count, third) => {
                let marks = if count == 3 && third.is_none() {
                    "; third_column if the third one marks points"
                } else {
                    "; spacing = [DX, DY] of a matrix of heights"
                };
                Err(self.refuse("columns", &count.to_string(), &format!("{EXPECTED}{marks}; or {CHOOSE}")))
            }
        }
    }

    /// The column that marks points, by its name or else the third one.
    fn mark(&self) -> Option<(usize, ThirdColumn)> {
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
        let columns = self.block.columns;
        let by_name = (0..self.head.names.len().min(columns)).find_map(|i| Some((i, meaning(self.name(i))?)));
        match self.options.third_column {
            Some(ThirdColumn::Ignore) => None,
            Some(given) => by_name.map(|(i, _)| (i, given)).or((columns == 3).then_some((2, given))),
            None => by_name,
        }
    }

    fn no_spacing(&self) -> ContentError {
        let hint = self.block.above.iter().chain(&self.settings.lines).find(|(_, line)| {
            ["spacing", "step", "increment", "interval"].iter().any(|word| line.to_lowercase().contains(word))
        });
        let hint = hint.map_or_else(String::new, |(line, text)| format!("; line {line} says \"{}\"", shortened(text)));
        let which = if self.block.columns == 1 { "the only column".to_owned() } else { self.label(0) };
        let expected = format!(
            "the distance of the points in m, spacing = 1e-5 (--spacing 1e-5), for {which} holds heights without x{hint}"
        );
        ContentError::value(Some(self.block.first), "spacing", "not given", &expected)
    }

    /// The unit that a column's heading, or the line below it, names, or that a line sets for the `axis`.
    fn unit(&self, column: Option<usize>, axis: usize, key: &str) -> Result<Option<Unit>, ContentError> {
        let given = [self.options.x_unit, self.options.z_unit][axis.min(1)].map(LengthUnit::unit);
        if let (Some(unit), _) | (None, (None, Some(unit))) = (given, (column, self.settings.units[axis.min(1)])) {
            return Ok(Some(unit));
        }
        let Some(index) = column else { return Ok(None) };
        // One that is called as an axis is, with something else behind its name, is refused.
        let found = match find(self.name(index), self.below(index), &ROLES) {
            Ok(Some(heading)) => Ok(heading.unit),
            Err(refused) => Err((refused.found, refused.expected)),
            Ok(None) => unit_beside(self.name(index), self.below(index), Dimension::Length)
                .map_err(|found| (found, format!("one of {}", Dimension::Length.units()))),
        };
        let found = found.map_err(|(found, expected)| {
            let given = format!("\"{}\"", shortened(&found));
            self.refuse(&format!("unit of {}", self.label(index)), &given, &expected).or(&format!("{key} in the scene"))
        })?;
        Ok(found.or(self.settings.units[axis.min(1)]))
    }

    /// The units of x and z, where they are named.
    fn units(&self, places: &Places) -> Result<[Option<Unit>; 2], ContentError> {
        let units = [self.unit(places.x, X, "x_unit")?, self.unit(Some(places.z), Z, "z_unit")?];
        let (one, other) = match (places.x, units) {
            (Some(x), [None, Some(unit)]) => (x, unit),
            (Some(_), [Some(unit), None]) => (places.z, unit),
            (_, [_, None]) => {
                self.check_stated()?;
                return Ok(units);
            }
            _ => return Ok(units),
        };
        if other.is_si() {
            return Ok(units);
        }
        let name = self.name(one);
        let expected = format!(
            "it beside the name, as in {name} [{other}], for the other column names {other}; or unit, x_unit, z_unit"
        );
        Err(self.refuse(&format!("unit of {}", self.label(one)), "", &expected))
    }

    /// Refuses to assume metres where a line above speaks of another unit.
    fn check_stated(&self) -> Result<(), ContentError> {
        let stated = self.block.stated_unit(Dimension::Length, self.head.line).filter(|(_, unit)| !unit.is_si());
        let Some(((line, text), unit)) = stated else { return Ok(()) };
        let expected = format!("the units beside the names, as in x [{unit}]; or x_unit and z_unit (--unit {unit})");
        Err(ContentError::value(Some(line), "units", &format!("\"{}\"", shortened(text)), &expected))
    }

    /// The lines of the rows, and of those behind the block that are meant as such; how many others follow, and the first.
    fn lines(&self) -> (Vec<Line<'a>>, Option<(usize, usize)>) {
        let below: Vec<Line<'a>> = self.block.below(self.text).collect();
        let is_row = |line: &str| self.block.separator.split(line).first().is_some_and(|first| is_number(first));
        let end = below.iter().rposition(|(_, line)| is_row(line)).map_or(0, |last| last + 1);
        let (meant, footer) = below.split_at(end);
        let lines = self.block.lines(self.text).chain(meant.iter().copied()).collect();
        (lines, footer.first().map(|(line, _)| (*line, footer.len())))
    }

    /// The profile; or the map, where y takes several values.
    fn points(&self, places: &Places) -> Result<Content, ContentError> {
        let used = [("x", places.x), ("y", places.y), ("z", Some(places.z))];
        let used: Vec<UsedColumn> = used
            .iter()
            .filter_map(|(axis, i)| Some(UsedColumn { index: (*i)?, label: (*axis).to_owned(), at_stake: true }))
            .collect();
        let decimal = decimal_of(&[self.block], self.text, &used)?;
        let mut raw = MeasuredPoints { units: self.units(places)?, ..MeasuredPoints::default() };
        let (lines, footer) = self.lines();
        let mut reader = PointsReader { table: self, places, decimal, raw: MeasuredPoints::default(), y: Vec::new() };
        for line in lines {
            reader.add(line)?;
        }
        let (read, y) = (reader.raw, reader.y);
        (raw.x, raw.z, raw.lines) = (read.x, read.z, read.lines);
        raw.notes.push(self.told(places, raw.x.len(), raw.units));
        raw.notes.extend(self.settings.notes());
        self.tell_depths(places.z, &mut raw);
        raw.notes.extend(footer.map(|(line, count)| behind_note(line, count)));
        if y.windows(2).any(|pair| pair[0] != pair[1]) {
            let y_unit = self.unit(places.y, X, "x_unit")?;
            let areal = Areal::of_points(raw, &y, y_unit)?;
            return self.settings.check_size(areal.size()).map(|()| Content::Map(areal));
        }
        raw.is_spaced = places.x.is_none();
        if raw.is_spaced {
            if let Some(areal) = self.grid_of_one_column(&raw)? {
                return Ok(Content::Map(areal));
            }
            self.check_lines(places, decimal)?;
        }
        self.settings.check_points(raw.x.len(), &raw, self.options)?;
        if raw.x.len() > 1 && raw.x.windows(2).all(|pair| pair[1] < pair[0]) {
            raw.turn();
        }
        Ok(Content::Profile(raw))
    }

    /// Heights in one column that the header has the grid of, where both distances are given.
    fn grid_of_one_column(&self, raw: &MeasuredPoints) -> Result<Option<Areal>, ContentError> {
        let Some(Size { points, lines, line, text }) = self.settings.size().filter(|size| size.lines > 1) else {
            return Ok(None);
        };
        match self.options.spacing[..] {
            [dx, dy] if points * lines == raw.z.len() => {
                let mut areal = Areal::even("a column of heights", [points, lines], [dx, dy], raw.z.clone());
                areal.unit = raw.units[1];
                areal.notes.clone_from(&raw.notes);
                Ok(Some(areal))
            }
            _ => Err(refuse_lines(Some(line), &format!("{lines} lines of {points} points, as \"{text}\" says"))),
        }
    }

    /// Refuses heights without x of several lines of a scan: a column beside them counts these, or starts again.
    fn check_lines(&self, places: &Places, decimal: Decimal) -> Result<(), ContentError> {
        let is_other = |index: &usize| *index != places.z && places.mark.is_none_or(|(mark, _)| mark != *index);
        for index in (0..self.block.columns).filter(is_other) {
            let number = |row: crate::text::Row<'_>| decimal.read(row.fields.get(index)?);
            let numbers: Option<Vec<f64>> = self.block.rows(self.text).map(number).collect();
            if let Some(period) = numbers.as_deref().and_then(period_of_lines) {
                let given = format!("{} tells lines of {period} points each", self.label(index));
                return Err(refuse_lines(self.head.line, &given));
            }
        }
        Ok(())
    }

    /// How the file is read, in a line.
    fn told(&self, places: &Places, rows: usize, units: [Option<Unit>; 2]) -> ReadingNote {
        let assumed = |axis: usize, column: Option<usize>| {
            if units[axis].is_none() && column.is_some() { " in m, assumed" } else { "" }
        };
        let axes = [
            ("x", places.x, assumed(0, places.x)),
            ("y", places.y, ""),
            ("z", Some(places.z), assumed(1, Some(places.z))),
        ];
        let columns = axes.iter().filter_map(|(axis, i, said)| Some(format!("{axis} = {}{said}", self.label((*i)?))));
        let mark = places.mark.map(|(i, _)| format!("mark = {}", self.label(i)));
        let columns: Vec<String> = columns.chain(mark).collect();
        let used = [places.x, places.y, Some(places.z), places.mark.map(|(i, _)| i)];
        let is_out = |i: &usize| !used.contains(&Some(*i)) && *i < self.head.names.len();
        let name = |i: usize| match self.name(i) {
            "" => format!("column {} without a name", i + 1),
            name => shortened(name),
        };
        let left_out: Vec<String> =
            (0..self.head.names.len().max(self.block.columns)).filter(is_out).map(name).collect();
        let text = format!("{}; {rows} rows{}", columns.join(", "), left_out_words(&left_out));
        let is_assumed = axes.iter().any(|(_, _, said)| !said.is_empty()) || self.head.names.is_empty();
        ReadingNote { text, assumed: is_assumed }
    }

    /// Notes which way the numbers are taken to grow where their column is called depth. Depths below a datum are
    /// mostly above 0; where most are below, they are heights.
    fn tell_depths(&self, column: usize, raw: &mut MeasuredPoints) {
        let name = self.name(column).to_lowercase();
        let is_called = ["depth", "tiefe", "profondeur"].iter().any(|word| name.contains(word));
        let count = |is_it: fn(&f64) -> bool| raw.z.iter().filter(|z| is_it(z)).count();
        raw.is_depth = is_called && count(|z| *z > 0.0) >= count(|z| *z < 0.0);
        if is_called && self.options.depth.is_none() {
            let text = match raw.is_depth {
                true => {
                    "the column is called depth, so its numbers grow downwards, z = -depth: depth = \"up\" where they do not"
                }
                false => {
                    "the column is called depth, but most of its numbers are below 0 and taken as heights: depth = \"down\" \
                     turns them over"
                }
            };
            raw.notes.push(ReadingNote { text: text.to_owned(), assumed: true });
        }
    }

    /// Whether the numbers of the first row but the first of them rise evenly, as positions above a matrix do.
    fn first_row_rises(&self) -> Result<bool, ContentError> {
        let decimal = self.decimal_of_matrix()?;
        let first = self.block.rows(self.text).next();
        let numbers: Option<Vec<f64>> = first
            .map(|row| row.fields)
            .and_then(|fields| fields.iter().skip(1).map(|field| decimal.read(field)).collect());
        Ok(numbers.is_some_and(|numbers| super::grid::rises(&numbers)))
    }

    fn decimal_of_matrix(&self) -> Result<Decimal, ContentError> {
        let column = |index| UsedColumn { index, label: "z".to_owned(), at_stake: true };
        decimal_of(&[self.block], self.text, &(0..self.block.columns).map(column).collect::<Vec<_>>())
    }

    /// Refuses a matrix below a line that has a field for each column: names, and the first column may count the lines.
    fn check_unlabelled(&self) -> Result<(), ContentError> {
        let is_label = |(_, line): &&Line<'_>| {
            let fields = self.block.separator.split(line);
            let words = fields.iter().filter(|field| !field.is_empty() && !is_number(field)).count();
            matches!(self.block.separator, Separator::Letter(_)) && words == self.block.columns
        };
        let Some((line, text)) = self.block.above.iter().find(is_label) else { return Ok(()) };
        let expected = "heights alone, without names above them and without a column that counts the lines; or numbers that \
                        rise evenly, positions, as first row and column";
        Err(ContentError::value(Some(*line), "names of a matrix", &format!("\"{}\"", shortened(text)), expected))
    }

    /// A matrix of heights: a row is a line along x. Its first row and column may be their positions.
    fn matrix(&self) -> Result<Areal, ContentError> {
        self.check_unlabelled()?;
        let decimal = self.decimal_of_matrix()?;
        let columns = self.block.columns;
        let mut heights = Vec::with_capacity(self.block.rows * columns);
        for row in self.block.rows(self.text) {
            for index in 0..columns {
                let field = row.fields.get(index).map_or("", |field| field);
                let written = decimal.read(field).filter(|height| height.is_nan() || ANY.holds(*height));
                let height = written.or_else(|| is_missing(field).then_some(f64::NAN));
                heights.push(height.ok_or_else(|| refuse_field(field, "z", row.line))?);
            }
        }
        let unit = self.unit(None, Z, "z_unit")?;
        if unit.is_none() {
            self.check_stated()?;
        }
        let mut areal = Areal::of_matrix(columns, heights, self.options)?;
        areal.unit = unit;
        self.settings.check_size(areal.size())?;
        let [nx, ny] = areal.size();
        let assumed = if unit.is_none() { " in m, assumed" } else { "" };
        areal.notes.insert(
            0,
            ReadingNote { text: format!("a matrix of heights{assumed}; {ny} rows of {nx}"), assumed: unit.is_none() },
        );
        areal.notes.extend(self.settings.notes());
        Ok(areal)
    }
}

/// The number of points of each of several lines of a scan, if a column counts these lines (1 1 1 2 2 2) or starts
/// again in each (0 5 10 0 5 10).
fn period_of_lines(numbers: &[f64]) -> Option<usize> {
    let steps: Vec<bool> = numbers.windows(2).map(|pair| pair[1] != pair[0]).collect();
    let falls: Vec<bool> = numbers.windows(2).map(|pair| pair[1] < pair[0]).collect();
    let counts =
        numbers.windows(2).all(|pair| pair[1] >= pair[0]) && numbers.iter().all(|number| number.fract() == 0.0);
    let starts_again = numbers.windows(2).all(|pair| pair[1] != pair[0]);
    let ends = if counts { steps } else { falls };
    let period = 1 + ends.iter().position(|is_end| *is_end)?;
    let even = ends.iter().enumerate().all(|(i, is_end)| *is_end == ((i + 1) % period == 0));
    let repeats = || (period..numbers.len()).all(|i| numbers[i] == numbers[i - period]);
    (period > 2 && numbers.len() > period && even && (counts || (starts_again && repeats()))).then_some(period)
}

fn refuse_field(field: &str, axis: &str, line: usize) -> ContentError {
    let given = format!("\"{}\"", shortened(field));
    let missing = if axis == "z" { ", or missing = \"fill\" where heights are missing" } else { "" };
    let expected = match is_number(field) && !is_missing(field) && field.contains(['.', ',']) {
        true => "a number with the sign before its decimals that the others have".to_owned(),
        false => format!("{ANY}{missing}"),
    };
    ContentError::value(Some(line), axis, &given, &expected)
}

/// Collects the points, line by line.
struct PointsReader<'t, 'a> {
    table: &'t Table<'t, 'a>,
    places: &'t Places,
    decimal: Decimal,
    raw: MeasuredPoints,
    y: Vec<f64>,
}

impl PointsReader<'_, '_> {
    fn add(&mut self, (line, text): Line<'_>) -> Result<(), ContentError> {
        let (columns, mut fields) = (self.table.block.columns, self.table.block.separator.split(text));
        while fields.len() > columns && fields.last().is_some_and(|field| field.is_empty()) {
            fields.pop();
        }
        let least = self.places.z.max(self.places.x.unwrap_or(0)) + 1;
        if fields.len() > columns || fields.len() < least {
            let expected = match (columns, fields.len()) {
                (2, 3) => format!("{EXPECTED}; third_column says what a third one means"),
                (2, _) => EXPECTED.to_owned(),
                _ => format!("{columns}, as in the rows above"),
            };
            let given = format!("{} in \"{}\"", fields.len(), shortened(text));
            return Err(ContentError::value(Some(line), "columns", &given, &expected));
        }
        let x = match self.places.x {
            Some(column) => self.position(&fields[column], "x", line)?,
            None => self.table.options.spacing.first().copied().unwrap_or(0.0) * self.raw.x.len() as f64,
        };
        let z = self.height(&fields, line)?;
        if let Some(column) = self.places.y {
            let y = self.position(fields.get(column).map_or("", |field| field), "y", line)?;
            self.y.push(y);
        }
        self.raw.push(line, x, z);
        Ok(())
    }

    fn position(&self, field: &str, axis: &str, line: usize) -> Result<f64, ContentError> {
        self.decimal.read(field).filter(|number| ANY.holds(*number)).ok_or_else(|| refuse_field(field, axis, line))
    }

    /// The height in a row; NaN where it is missing and may be.
    fn height(&self, fields: &[Cow<'_, str>], line: usize) -> Result<f64, ContentError> {
        let field = &fields[self.places.z];
        let invalid = self.places.mark.filter(|&mark| is_invalid(fields, mark));
        let written = if invalid.is_some() { None } else { self.decimal.read(field) };
        // A number that no height can have, 1e38, is one of those that stand for none.
        let is_gap = invalid.is_some() || is_missing(field) || written.is_some();
        match (written.filter(|&z| ANY.holds(z)), invalid) {
            (Some(z), _) => Ok(z),
            (None, _) if self.table.options.missing == Missing::Fill && is_gap => Ok(f64::NAN),
            (None, Some((column, _))) => {
                let given = format!("\"{}\"", shortened(fields.get(column).map_or("", |field| field)));
                let expected = "valid points alone, or missing = \"fill\"";
                Err(ContentError::value(Some(line), "third column", &given, expected))
            }
            (None, None) => Err(refuse_field(field, "z", line)),
        }
    }
}

/// Whether the mark of a row says that its height is not valid.
fn is_invalid(fields: &[Cow<'_, str>], (column, meaning): (usize, ThirdColumn)) -> bool {
    const UNSET: [&str; 7] = ["", "false", "no", "n", "f", "-", "off"];
    let field = fields.get(column).map_or("", |field| field);
    let is_unset = UNSET.iter().any(|word| field.eq_ignore_ascii_case(word)) || Decimal::Point.read(field) == Some(0.0);
    match meaning {
        ThirdColumn::Invalid => !is_unset,
        ThirdColumn::Valid => is_unset,
        ThirdColumn::Ignore => false,
    }
}
