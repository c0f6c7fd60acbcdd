//! The header of a profile as text: what its columns are, and their units.

use std::borrow::Cow;

use super::options::{LengthUnit, MeasuredPoints, ProfileOptions, ReadingNote};
use crate::scene::error::ContentError;
use crate::tables::{Block, Dimension, Heading, Line, Unit, Words, words};

const ONE_UNIT: &str = "the header names a unit for one of the two columns alone; it is taken for both: x_unit and \
                        z_unit say otherwise";

/// The beginning of a text, for messages.
pub(super) fn cut(text: &str) -> String {
    text.chars().take(60).collect()
}

/// What a column of a profile may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ColumnAxis {
    X,
    Y,
    Z,
}

const fn axis(
    axis: ColumnAxis,
    key_words: &'static [&'static str],
    other_words: &'static [&'static str],
) -> Words<ColumnAxis> {
    Words::new(axis, Dimension::Length, key_words, other_words)
}

pub(super) const VOCABULARY: [Words<ColumnAxis>; 3] = [
    axis(
        ColumnAxis::X,
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
        ColumnAxis::Z,
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
        ColumnAxis::Y,
        &["y", "y1", "y2", "y3", "y4"],
        &["axis", "coordinate", "coord", "position", "pos", "value", "values", "achse"],
    ),
];

/// The header of a profile.
#[derive(Debug)]
pub(super) struct Header<'a> {
    pub(super) names: Vec<Cow<'a, str>>,
    pub(super) line: Option<usize>,
    /// What the columns are, as far as their names say.
    pub(super) headings: Vec<Option<Heading<ColumnAxis>>>,
    /// The units of x and z that lines such as `X-Unit: mm` set.
    pub(super) set: [Option<Unit>; 2],
    /// A line that speaks of a unit, though it is none of names.
    stated: Option<(Line<'a>, Unit)>,
}

impl<'a> Header<'a> {
    pub(super) fn read(block: &Block<'a>) -> Self {
        let is_setting = |line: &str| setting(line).is_some();
        let mut named = block.clone();
        named.above.retain(|(_, line)| !is_setting(line));
        let is_known = |name: &str| Heading::parse(name, &VOCABULARY).is_some();
        let mut head = named.head(&is_known);
        // Words above such settings name the file, not its columns.
        let is_above = |names: usize| block.above.iter().any(|(line, text)| *line > names && is_setting(text));
        if head.line.is_some_and(is_above) && !head.names.iter().any(|name| is_known(name)) {
            (head.names, head.line) = (Vec::new(), None);
        }
        let headings = if head.names.is_empty() && head.units.len() == block.columns {
            unnamed(&head.units)
        } else {
            head.headings(&VOCABULARY)
        };
        let mut set = [None; 2];
        for (axes, unit) in block.above.iter().filter_map(|(_, line)| setting(line)) {
            axes.iter().for_each(|&axis| set[axis] = Some(unit));
        }
        let stated = named.stated_unit(Dimension::Length, head.line);
        Self { names: head.names, line: head.line, headings, set, stated }
    }

    /// Which columns are called so.
    pub(super) fn named(&self, axis: ColumnAxis) -> Vec<usize> {
        let is_it = |i: &usize| self.headings[*i].as_ref().is_some_and(|heading| heading.quantity == axis);
        (0..self.headings.len()).filter(is_it).collect()
    }

    pub(super) fn name(&self, column: usize) -> String {
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
        heading.map_or(Ok(None), |heading| heading.unit.known()).map_err(|unit| {
            let given = format!("\"{}\" of {}", cut(unit), self.name(column));
            let expected = format!("a unit of length: {}; or {key} in the scene", Dimension::Length.units());
            ContentError::value(self.line, "unit", &given, &expected)
        })
    }

    /// The units of x and z, and notes on them.
    pub(super) fn units(
        &self,
        (x_column, z_column): (Option<usize>, usize),
        options: &ProfileOptions,
        raw: &mut MeasuredPoints,
    ) -> Result<[Option<Unit>; 2], ContentError> {
        let given = [options.x_unit, options.z_unit].map(|unit| unit.map(LengthUnit::unit));
        let of_column = |axis: usize, column: Option<usize>, key: &str| match (given[axis], column) {
            (Some(unit), _) => Ok(Some(unit)),
            (None, Some(column)) => Ok(self.unit(column, key)?.or(self.set[axis])),
            (None, None) => Ok(self.set[axis]),
        };
        let (x, z) = (of_column(0, x_column, "x_unit")?, of_column(1, Some(z_column), "z_unit")?);
        if let (None, None, Some(((line, text), unit))) = (x, z, self.stated) {
            let expected =
                format!("the units beside the names, as in x [{unit}]; or x_unit and z_unit (--unit {unit})");
            return Err(ContentError::value(Some(line), "units", &format!("`{}`", cut(text)), &expected));
        }
        let Some(x_column) = x_column else {
            raw.notes.push(note(&format!("heights from {}", self.name(z_column)), z));
            // The spacing is in m.
            return Ok([None, z]);
        };
        if x.is_none() != z.is_none() {
            raw.warnings.push(ONE_UNIT.into());
        }
        let units = [x.or(z), z.or(x)];
        let [x, z] = [x_column, z_column].map(|column| self.name(column));
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
        if words(self.names.get(z_column).map_or("", |name| name)).iter().any(|word| word == "depth" || word == "tiefe")
        {
            raw.notes.push(ReadingNote { text: "depths are taken as heights, upwards".into(), assumed: true });
        }
        Ok(units)
    }
}

pub(super) fn note(what: &str, unit: Option<Unit>) -> ReadingNote {
    match unit {
        Some(unit) => ReadingNote { text: format!("{what} in {unit}"), assumed: false },
        None => ReadingNote { text: format!("{what}, which names no unit: m is assumed"), assumed: true },
    }
}

/// Columns that have units but no names: x and z.
fn unnamed(units: &[Cow<'_, str>]) -> Vec<Option<Heading<ColumnAxis>>> {
    let heading = |(axis, unit): (ColumnAxis, &Cow<'_, str>)| {
        let name = if axis == ColumnAxis::X { "x" } else { "z" };
        Heading::with_unit(name, unit, &VOCABULARY)
    };
    if units.len() == 2 {
        [ColumnAxis::X, ColumnAxis::Z].into_iter().zip(units).map(heading).collect()
    } else {
        Vec::new()
    }
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
