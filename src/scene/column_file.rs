//! Files with one table of numbers: columns found by their names, with units.

use super::error::ContentError;
use super::profile::ReadingNote;
use super::values::NumberRange;
use crate::tables::{Block, Dimension, Head, Heading, HeadingUnit, Line, NumberStyle, Unit, Words, decode};

/// What a file must hold.
#[derive(Debug)]
pub(super) struct ColumnFile<Q: 'static, const N: usize> {
    /// The words of its quantities.
    pub(super) vocabulary: &'static [Words<Q>],
    /// Its columns; the numbers of the first rise.
    pub(super) columns: [Column<Q>; N],
    /// The columns in words.
    pub(super) expected: &'static str,
}

/// A column of a file.
#[derive(Debug)]
pub(super) struct Column<Q: 'static> {
    /// Whether a file must have it; files without names have these alone.
    pub(super) required: bool,
    /// What it may hold; the first where the file has no names, and it alone where it names no unit.
    pub(super) quantities: &'static [Q],
    /// Its name in messages.
    pub(super) name: &'static str,
    /// What its numbers are, as a plural.
    pub(super) meaning: &'static str,
    /// The numbers that it may hold, in SI units.
    pub(super) range: NumberRange,
}

/// The numbers of a file.
#[derive(Debug)]
pub(super) struct Columns<Q, const N: usize> {
    /// What each column holds; `None` of those that the file does not have.
    pub(super) quantities: [Option<Q>; N],
    /// The rows, in SI units; at least two. 0 in columns that the file does not have.
    pub(super) rows: Vec<[f64; N]>,
    /// How they were read.
    pub(super) notes: Vec<ReadingNote>,
}

/// Where a column stands, counted from 0, and what it holds.
#[derive(Clone, Copy, Debug)]
struct Place<Q> {
    index: usize,
    quantity: Q,
    unit: Unit,
}

impl<Q: Copy + PartialEq, const N: usize> ColumnFile<Q, N> {
    /// Reads the only table in the bytes of a file. Without names its columns stand in their order, in SI units.
    pub(super) fn read(&self, bytes: &[u8]) -> Result<Columns<Q, N>, ContentError> {
        let text = decode(bytes).map_err(|error| ContentError::new(Some(1), "", error))?;
        let blocks = Block::all(&text, false);
        let Some(block) = blocks.iter().max_by_key(|block| block.rows) else {
            let last = text.lines().count().max(1);
            return Err(ContentError::value(Some(last), "rows", "0", "at least two rows"));
        };
        if let Some(other) = blocks.iter().find(|other| other.first != block.first && other.columns > 1) {
            let given = format!("from line {} and from line {}", other.first, block.first);
            return Err(ContentError::value(Some(other.first), "tables", &given, "one table"));
        }
        let mut notes = Vec::new();
        let head = block.head(&|name| Heading::parse(name, self.vocabulary).is_some());
        let places = if head.names.is_empty() {
            self.unnamed(block, &mut notes)?
        } else {
            self.named(block, &head, &mut notes)?
        };
        let rows = self.rows(block, &text, &places)?;
        Ok(Columns { quantities: places.map(|place| Some(place?.quantity)), rows, notes })
    }

    /// The columns by their names, each at most once.
    fn named(
        &self,
        block: &Block<'_>,
        head: &Head<'_>,
        notes: &mut Vec<ReadingNote>,
    ) -> Result<[Option<Place<Q>>; N], ContentError> {
        let headings = head.headings(self.vocabulary);
        let mut places = [None; N];
        for (place, column) in places.iter_mut().zip(&self.columns) {
            let is_it = |heading: &Heading<Q>| column.quantities.contains(&heading.quantity);
            let found: Vec<_> = (0..)
                .zip(&headings)
                .filter_map(|(i, heading)| Some((i, heading.as_ref().filter(|h| is_it(h))?)))
                .collect();
            if found.is_empty() && !column.required {
                continue;
            }
            let &[(index, heading)] = &found[..] else {
                let given = format!("`{}`", shortened(&head.names.join(", ")));
                return Err(ContentError::value(head.line, "columns", &given, self.expected));
            };
            if heading.logarithm.is_some() {
                let expected = "numbers, not their logarithms";
                return Err(ContentError::value(head.line, column.name, head.names[index].trim(), expected));
            }
            if heading.quantity != column.quantities[0] && heading.unit == HeadingUnit::None {
                let expected = format!("its unit, one of {}", heading.dimension.units());
                return Err(ContentError::value(head.line, column.name, head.names[index].trim(), &expected));
            }
            let (unit, note) = column.unit(block, head, index, heading)?;
            *place = Some(Place { index, quantity: heading.quantity, unit });
            notes.push(note);
        }
        Ok(places)
    }

    /// The required columns in their order, in SI units.
    fn unnamed(&self, block: &Block<'_>, notes: &mut Vec<ReadingNote>) -> Result<[Option<Place<Q>>; N], ContentError> {
        let required = self.columns.iter().filter(|column| column.required).count();
        if block.columns != required {
            let expected = format!("{}; without names {required} columns in this order", self.expected);
            return Err(ContentError::value(Some(block.first), "columns", &block.columns.to_string(), &expected));
        }
        let places = self.in_order();
        for (place, column) in places.iter().zip(&self.columns).filter_map(|(place, column)| Some(((*place)?, column)))
        {
            check_stated(block, place.unit.dimension, column.name, None)?;
            let (meaning, unit, number) = (column.meaning, place.unit, place.index + 1);
            let text = format!("no names: column {number} is taken as {meaning} in {unit}");
            notes.push(ReadingNote { text, assumed: true });
        }
        Ok(places)
    }

    fn in_order(&self) -> [Option<Place<Q>>; N] {
        let mut next = 0..;
        self.columns.each_ref().map(|column| {
            let index = if column.required { next.next()? } else { return None };
            let quantity = column.quantities[0];
            let dimension =
                self.vocabulary.iter().find(|words| words.quantity == quantity).map(|words| words.dimension);
            Some(Place { index, quantity, unit: Unit::si(dimension.unwrap_or(Dimension::Number)) })
        })
    }

    fn rows(
        &self,
        block: &Block<'_>,
        text: &str,
        places: &[Option<Place<Q>>; N],
    ) -> Result<Vec<[f64; N]>, ContentError> {
        let mut style = NumberStyle::of(block);
        let mut rows: Vec<[f64; N]> = Vec::with_capacity(block.rows);
        for (line, row) in block.lines(text) {
            let fields = block.separator.split(row);
            let mut numbers = [0.0; N];
            for ((number, place), column) in numbers.iter_mut().zip(places).zip(&self.columns) {
                let Some(place) = place else { continue };
                let field = fields.get(place.index).map_or("", |field| field);
                *number = column.read(&mut style, line, field, place.unit)?;
            }
            if let Some(before) = rows.last().filter(|before| numbers[0] <= before[0]) {
                let expected = format!("more than {:?}, that of the row before: they must rise", before[0]);
                return Err(ContentError::value(
                    Some(line),
                    self.columns[0].name,
                    &format!("{:?}", numbers[0]),
                    &expected,
                ));
            }
            rows.push(numbers);
        }
        if rows.len() < 2 {
            return Err(ContentError::value(Some(block.last), "rows", &rows.len().to_string(), "at least two rows"));
        }
        Ok(rows)
    }
}

impl<Q> Column<Q> {
    /// The unit that a heading names or leaves to be assumed, and how to say so.
    fn unit(
        &self,
        block: &Block<'_>,
        head: &Head<'_>,
        index: usize,
        heading: &Heading<Q>,
    ) -> Result<(Unit, ReadingNote), ContentError> {
        let column = format!("column {} ({})", index + 1, head.names[index].trim());
        let is_plain = heading.dimension == Dimension::Number;
        let (unit, said) = match &heading.unit {
            HeadingUnit::Known(unit) => (*unit, format!(" in {unit}")),
            HeadingUnit::None if is_plain => (Unit::ONE, String::new()),
            HeadingUnit::None => {
                check_stated(block, heading.dimension, self.name, head.line)?;
                let unit = Unit::si(heading.dimension);
                (unit, format!(", which names no unit: {unit} is assumed"))
            }
            HeadingUnit::Unknown(unit) => {
                let expected = format!("one of {}", heading.dimension.units());
                return Err(ContentError::value(head.line, "unit", &format!("\"{unit}\" of {column}"), &expected));
            }
        };
        let assumed = heading.unit == HeadingUnit::None && !is_plain;
        Ok((unit, ReadingNote { text: format!("{} from {column}{said}", self.meaning), assumed }))
    }

    /// The number in a field, in SI units.
    fn read(&self, style: &mut NumberStyle, line: usize, field: &str, unit: Unit) -> Result<f64, ContentError> {
        let given = || format!("\"{}\"", shortened(field));
        let refuse = |expected: &str| ContentError::value(Some(line), self.name, &given(), expected);
        let written = style.read(field).map_err(|_| refuse(NumberStyle::EXPECTED))?;
        let value = written.map(|written| unit.to_si(written)).filter(|value| self.range.holds(*value));
        value.ok_or_else(|| refuse(&self.range.to_string()))
    }
}

/// Refuses to assume SI units where the header speaks of others.
pub(super) fn check_stated(
    block: &Block<'_>,
    dimension: Dimension,
    column: &str,
    names: Option<usize>,
) -> Result<(), ContentError> {
    let stated = block.stated_unit(dimension, names).filter(|(_, unit)| !unit.is_si());
    let Some(((line, text), unit)): Option<(Line<'_>, Unit)> = stated else { return Ok(()) };
    let expected = format!("the unit beside the name of its column, as in {column} [{unit}]");
    Err(ContentError::value(Some(line), "unit", &format!("`{}`", shortened(text)), &expected))
}

fn shortened(text: &str) -> String {
    text.chars().take(60).collect()
}
