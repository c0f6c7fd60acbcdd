//! The header of a profile as text: what its columns are, and their units.

use std::borrow::Cow;

use super::options::{LengthUnit, MeasuredPoints, ProfileOptions};
use crate::tables::{
    Block, ContentError, Dimension, Header as TableHeader, Heading, Line, ReadingNote, Unit, UnitRule, Words,
    shortened, words,
};

const ONE_UNIT: &str = "the header names a unit for one of the two columns alone; it is taken for both: x_unit and \
                        z_unit say otherwise";

/// What a column of a profile may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ColumnAxis {
    X,
    Y,
    Z,
}

pub(super) const VOCABULARY: [Words<ColumnAxis>; 3] = [
    Words::new(
        ColumnAxis::X,
        Dimension::Length,
        "x distance position pos lateral length chainage station abscissa place weg strecke abstand länge laenge location \
         dist xpos mileage",
        "axis coordinate coord value values scan direction profile trace along travel travelled measured horizontal achse \
         stylus x1 the road of",
    ),
    Words::new(
        ColumnAxis::Z,
        Dimension::Length,
        "z z2 z3 z4 height heights elevation elev depth profile topography altitude amplitude höhe hoehe tiefe ordinate z1 \
         profil",
        "axis coordinate coord value values roughness raw primary r p w waviness surface data filtered leveled levelled \
         relative mean measured vertical corrected left right achse road of the center centre",
    ),
    Words::new(
        ColumnAxis::Y,
        Dimension::Length,
        "y y1 y2 y3 y4",
        "axis coordinate coord position pos value values achse",
    ),
];

/// The header of a profile.
#[derive(Debug)]
pub(super) struct Header<'a> {
    /// The names of the columns, and what these are.
    pub(super) table: TableHeader<'a, ColumnAxis>,
    /// The units of x and z that lines such as `X-Unit: mm` set.
    pub(super) set: [Option<Unit>; 2],
    /// A line that speaks of a unit, though it is none of names.
    stated: Option<(Line<'a>, Unit)>,
}

impl<'a> Header<'a> {
    pub(super) fn read(block: &Block<'a>) -> Self {
        let is_setting = |line: &str| setting(line).is_some();
        let is_known = |name: &str| Heading::parse(name, &VOCABULARY).is_some();
        let mut named = block.clone();
        named.above.retain(|(_, line)| !is_setting(line));
        let mut table = TableHeader::read(&named, &VOCABULARY, &[]);
        // Words above such settings name the file, not its columns.
        let is_above = |names: usize| block.above.iter().any(|(line, text)| *line > names && is_setting(text));
        if table.line.is_some_and(is_above) && !table.names.iter().any(|name| is_known(name)) {
            (table.names, table.line, table.headings) = (Vec::new(), None, Vec::new());
        }
        if table.names.is_empty() && table.head.units.len() == block.columns {
            table.headings = unnamed(&table.head.units);
        }
        let mut set = [None; 2];
        for (axes, unit) in block.above.iter().filter_map(|(_, line)| setting(line)) {
            axes.iter().for_each(|&axis| set[axis] = Some(unit));
        }
        let stated = named.stated_unit(Dimension::Length, table.line);
        Self { table, set, stated }
    }

    /// The unit that a column's heading names, be the name one that is known or one that was chosen.
    fn unit(&self, column: usize, key: &str) -> Result<Option<Unit>, ContentError> {
        let is_known = self.table.headings.get(column).is_some_and(Option::is_some);
        let found = if is_known {
            let found = self.table.column(column, UnitRule::Assumed, None);
            found.and_then(|found| found.check_plain(self.table.line).map(|()| found.names_unit.then_some(found.unit)))
        } else {
            self.table.unit(column, Dimension::Length)
        };
        found.map_err(|error| error.or(&format!("{key} in the scene")))
    }

    /// The unit of y, of points in space: its own, or else that of x.
    pub(super) fn unit_of_y(&self, column: usize, options: &ProfileOptions) -> Result<Option<Unit>, ContentError> {
        options.x_unit.map_or_else(|| self.unit(column, "x_unit"), |unit| Ok(Some(unit.unit())))
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
            (None, Some(column)) => self.unit(column, key).map(|unit| unit.or(self.set[axis])),
            (None, None) => Ok(self.set[axis]),
        };
        let (x, z) = (of_column(0, x_column, "x_unit")?, of_column(1, Some(z_column), "z_unit")?);
        if let (None, None, Some(((line, text), unit))) = (x, z, self.stated) {
            let expected =
                format!("the units beside the names, as in x [{unit}]; or x_unit and z_unit (--unit {unit})");
            return Err(ContentError::value(Some(line), "units", &format!("\"{}\"", shortened(text)), &expected));
        }
        let Some(x_column) = x_column else {
            raw.notes.push(note(&format!("heights from {}", self.table.label(z_column)), z));
            // The spacing is in m.
            return Ok([None, z]);
        };
        if x.is_none() != z.is_none() {
            raw.warnings.push(ONE_UNIT.into());
        }
        let units = [x.or(z), z.or(x)];
        let [x, z] = [x_column, z_column].map(|column| self.table.label(column));
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
        Ok(units)
    }

    /// Whether a column is called depth.
    pub(super) fn says_depth(&self, column: usize) -> bool {
        let name = self.table.names.get(column).map_or("", |name| name);
        words(name).iter().any(|word| ["depth", "depths", "tiefe", "profondeur"].contains(&word.as_str()))
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
