//! Columns whose quantities are known: their units, and the numbers in their rows.

use std::borrow::Cow;

use super::blocks::Block;
use super::error::{ContentError, shortened};
use super::head::Head;
use super::headings::{Condition, Heading, HeadingUnit, Words, without_condition};
use super::numbers::{MixedDecimals, NumberStyle, is_missing};
use super::range::NumberRange;
use super::text::Row;
use super::units::{Dimension, Unit};

/// How a table was read, for those who use what it holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadingNote {
    /// What was found or assumed: columns, units.
    pub text: String,
    /// Whether something was assumed that the file does not say.
    pub assumed: bool,
}

/// What stands above a block: the names of its columns, and what they hold.
#[derive(Clone, Debug)]
pub struct Header<'a, Q> {
    /// The names of the columns, as many as there are columns; none where no line can be parted so.
    pub names: Vec<Cow<'a, str>>,
    /// The line of the names.
    pub line: Option<usize>,
    /// What the columns hold, as far as their names are in the vocabulary.
    pub headings: Vec<Option<Heading<Q>>>,
    /// What the headings say of all numbers of their columns, `E' [MPa] @ 20 °C`.
    pub conditions: Vec<Option<Condition>>,
    /// As it was found.
    pub head: Head<'a>,
}

/// What is done about a unit that a heading does not name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnitRule {
    /// SI units are assumed.
    Assumed,
    /// They are assumed of the first quantity that the column may hold alone.
    AssumedOfFirst,
    /// The column is refused.
    Named,
    /// Numbers are taken as they stand, whatever unit is named.
    Ignored,
}

impl<'a, Q: Copy + PartialEq> Header<'a, Q> {
    /// That of a block. Headings may name a quantity of one of the dimensions of `conditions` beside their own.
    pub fn read(block: &Block<'a>, vocabulary: &[Words<Q>], conditions: &[Dimension]) -> Self {
        let parted = |name: &str| {
            let found = conditions.iter().find_map(|dimension| without_condition(name, *dimension));
            found.map_or_else(|| (name.to_owned(), None), |(name, value)| (name, Some(value)))
        };
        let head = block.head(&|name| Heading::parse(&parted(name).0, vocabulary).is_some());
        let heading = |(i, name): (usize, &Cow<'a, str>)| {
            let (name, condition) = parted(name);
            let unit = head.units.get(i).map_or("", |unit| unit);
            (Heading::with_unit(&name, unit, vocabulary), condition)
        };
        let (headings, conditions) = head.names.iter().enumerate().map(heading).unzip();
        Self { names: head.names.clone(), line: head.line, headings, conditions, head }
    }

    /// The columns whose headings name one of these quantities.
    pub fn places(&self, quantities: &[Q]) -> Vec<usize> {
        let is_it = |i: &usize| self.headings[*i].as_ref().is_some_and(|found| quantities.contains(&found.quantity));
        (0..self.headings.len()).filter(is_it).collect()
    }

    /// The column in messages: its number from 1, and its heading.
    pub fn label(&self, index: usize) -> String {
        label(index, self.names.get(index).map_or("", |name| name))
    }

    /// The names in messages.
    pub fn given(&self) -> String {
        let names: Vec<&str> = self.names.iter().map(|name| name.trim()).collect();
        format!("\"{}\"", shortened(&names.join(", ")))
    }

    /// The column at a place, its unit the one `given` or that of its heading.
    ///
    /// # Errors
    /// [`ContentError`] where the unit is none of the quantity, or the rule refuses that there is none; also where the
    /// heading names no quantity.
    pub fn column(&self, index: usize, rule: UnitRule, given: Option<Unit>) -> Result<Column<Q>, ContentError> {
        let Some(heading) = self.headings.get(index).and_then(Option::as_ref) else {
            return Err(ContentError::value(self.line, "columns", &self.given(), "a name that is known"));
        };
        let dimension = heading.dimension;
        let named = match (given, &heading.unit) {
            (Some(unit), _) if unit.is_of(dimension) => Some(unit),
            (Some(unit), _) => return Err(self.refuse_unit(index, unit.name, dimension)),
            _ if rule == UnitRule::Ignored => Some(Unit::ONE),
            (None, HeadingUnit::None) if dimension == Dimension::Number => Some(Unit::ONE),
            (None, unit) => self.known_unit(index, unit, dimension)?,
        };
        if named.is_none() && rule == UnitRule::Named {
            let expected = format!("it beside the name: one of {}", dimension.units());
            return Err(ContentError::value(self.line, &self.unit_key(index), "", &expected));
        }
        Ok(Column {
            index,
            text: self.names.get(index).map_or_else(String::new, |name| name.trim().to_owned()),
            quantity: heading.quantity,
            unit: named.unwrap_or(Unit::si(dimension)),
            names_unit: named.is_some(),
            condition: self.conditions.get(index).copied().flatten(),
            logarithm: heading.logarithm,
        })
    }

    /// The unit of the column at a place, whatever its name: the one beside that or in the line below it.
    ///
    /// # Errors
    /// [`ContentError`] where that is none of the dimension.
    pub fn unit(&self, index: usize, dimension: Dimension) -> Result<Option<Unit>, ContentError> {
        let text = |texts: &'_ [Cow<'a, str>]| texts.get(index).map_or_else(String::new, |text| text.to_string());
        let unit = HeadingUnit::beside(&text(&self.names), &text(&self.head.units), dimension);
        self.known_unit(index, &unit, dimension)
    }

    fn known_unit(&self, index: usize, unit: &HeadingUnit, dimension: Dimension) -> Result<Option<Unit>, ContentError> {
        unit.known().map_err(|text| self.refuse_unit(index, &format!("\"{}\"", shortened(text)), dimension))
    }

    fn refuse_unit(&self, index: usize, found: &str, dimension: Dimension) -> ContentError {
        ContentError::value(self.line, &self.unit_key(index), found, &format!("one of {}", dimension.units()))
    }

    fn unit_key(&self, index: usize) -> String {
        format!("unit of {}", self.label(index))
    }

    /// The columns that are not among those `used`, in a note.
    pub fn left_out(&self, used: &[usize]) -> Option<ReadingNote> {
        let is_out = |(i, name): &(usize, &str)| !used.contains(i) && !name.is_empty();
        let names = self.names.iter().map(|name| name.trim()).enumerate();
        left_out_note(&names.filter(is_out).map(|(_, name)| name).collect::<Vec<_>>())
    }
}

/// A note of columns that are not read.
pub(super) fn left_out_note(names: &[&str]) -> Option<ReadingNote> {
    let more = if names.len() > 4 { format!(" and {} more", names.len() - 4) } else { String::new() };
    let few: Vec<&str> = names.iter().take(4).copied().collect();
    let text = format!("columns left out: {}{more}", few.join(", "));
    (!names.is_empty()).then_some(ReadingNote { text, assumed: false })
}

fn label(index: usize, heading: &str) -> String {
    match heading.trim() {
        "" => format!("column {}", index + 1),
        heading => format!("column {} ({})", index + 1, shortened(heading)),
    }
}

/// A column of a table.
#[derive(Clone, Debug)]
pub struct Column<Q> {
    /// Its place, counted from 0.
    pub index: usize,
    /// Its heading as written.
    pub text: String,
    /// What it holds.
    pub quantity: Q,
    /// The unit of its numbers.
    pub unit: Unit,
    /// Whether that was named, not assumed.
    pub names_unit: bool,
    /// What its heading says of all its numbers.
    pub condition: Option<Condition>,
    /// Its numbers are logarithms to this base.
    pub logarithm: Option<f64>,
}

impl<Q: Copy> Column<Q> {
    /// One without a heading, called `name`, in SI units.
    pub(super) fn unnamed(index: usize, name: &str, quantity: Q, dimension: Dimension) -> Self {
        let (text, unit) = (name.to_owned(), Unit::si(dimension));
        Self { index, text, quantity, unit, names_unit: false, condition: None, logarithm: None }
    }

    /// The column in messages: its number from 1, and its heading.
    pub fn label(&self) -> String {
        label(self.index, &self.text)
    }

    /// The unit that is assumed, where none is named.
    pub fn assumed_unit(&self) -> Option<Unit> {
        (!self.names_unit && self.unit.dimension != Dimension::Number).then_some(self.unit)
    }

    /// Refuses logarithms, in the line of the names.
    ///
    /// # Errors
    /// [`ContentError`] where the numbers are such.
    pub fn check_plain(&self, names: Option<usize>) -> Result<(), ContentError> {
        let refuse = |_| ContentError::value(names, &self.label(), "", "numbers, not their logarithms");
        self.logarithm.map_or(Ok(()), |base| Err(refuse(base)))
    }

    /// Refuses to assume a unit where a line above the block, other than that of the `names`, speaks of another one.
    ///
    /// # Errors
    /// [`ContentError`] with that line.
    pub fn check_assumed(&self, block: &Block<'_>, names: Option<usize>) -> Result<(), ContentError> {
        let Some(assumed) = self.assumed_unit() else { return Ok(()) };
        match block.stated_unit(assumed.dimension, names).filter(|(_, unit)| unit.name != assumed.name) {
            Some(((line, text), unit)) => {
                let expected = format!("the unit beside the name of its column, as in {} [{unit}]", self.text);
                Err(ContentError::value(Some(line), "unit", &format!("\"{}\"", shortened(text)), &expected))
            }
            None => Ok(()),
        }
    }

    /// Refuses to assume a unit beside `others` of the same quantity, lengths and areas being one, that name another one.
    ///
    /// # Errors
    /// [`ContentError`] in the line of the `names`.
    pub fn check_beside<'c>(
        &self,
        others: impl IntoIterator<Item = &'c Self>,
        names: Option<usize>,
    ) -> Result<(), ContentError>
    where
        Q: 'c,
    {
        let quantity = |unit: &Unit| if unit.dimension == Dimension::Area { Dimension::Length } else { unit.dimension };
        let Some(assumed) = self.assumed_unit() else { return Ok(()) };
        let is_other =
            |other: &&Self| other.names_unit && quantity(&other.unit) == quantity(&assumed) && !other.unit.is_si();
        let Some(other) = others.into_iter().find(is_other) else { return Ok(()) };
        let expected = format!(
            "the unit beside its name, as in {} [{assumed}], for {} names {}",
            self.text,
            other.label(),
            other.unit
        );
        Err(ContentError::value(names, &format!("unit of {}", self.label()), "", &expected))
    }

    /// How the column was found and its unit, where its numbers are called `meaning`.
    pub fn note(&self, meaning: &str) -> ReadingNote {
        let said = match self.assumed_unit() {
            Some(unit) => format!(", which names no unit: {unit} is assumed"),
            None if self.unit.dimension == Dimension::Number && self.unit.is_si() => String::new(),
            None => format!(" in {}", self.unit),
        };
        ReadingNote { text: format!("{meaning} from {}{said}", self.label()), assumed: self.assumed_unit().is_some() }
    }

    /// A number of the column in SI units.
    pub fn to_si(&self, written: f64) -> f64 {
        self.unit.to_si(self.logarithm.map_or(written, |base| base.powf(written)))
    }

    /// Its field in a row; empty where the row has none.
    pub fn field<'r>(&self, row: &'r Row<'_>) -> &'r str {
        row.fields.get(self.index).map_or("", |field| field)
    }

    /// Whether a row has no number there, and says so.
    pub fn is_empty(&self, row: &Row<'_>) -> bool {
        is_missing(self.field(row))
    }

    /// The number in a row, in SI units; `None` where the field is none or it is not finite.
    ///
    /// # Errors
    /// [`ContentError`] where the table has decimal points and decimal commas.
    pub fn number(&self, row: &Row<'_>, style: &mut NumberStyle) -> Result<Option<f64>, ContentError> {
        let field = self.field(row);
        let mixed = |_: MixedDecimals| self.refuse(row.line, field, NumberStyle::EXPECTED);
        let written = style.read(field).map_err(mixed)?;
        Ok(written.map(|written| self.to_si(written)).filter(|value| value.is_finite()))
    }

    /// The number in a row, in SI units, which is one of a range.
    ///
    /// # Errors
    /// [`ContentError`] where it is none of the range, or as for [`number`](Self::number).
    pub fn read(&self, row: &Row<'_>, style: &mut NumberStyle, range: NumberRange) -> Result<f64, ContentError> {
        let value = self.number(row, style)?.filter(|value| range.holds(*value));
        value.ok_or_else(|| self.refuse(row.line, self.field(row), &self.expected(range)))
    }

    /// A range in words, with the unit that it is in where the column has another one.
    fn expected(&self, range: NumberRange) -> String {
        let dimension = self.unit.dimension;
        let is_plain = self.unit.is_si() || dimension == Dimension::Number;
        if is_plain { range.to_string() } else { format!("{range} in {}", Unit::si(dimension)) }
    }

    /// A number in SI units, with its unit, for messages.
    pub(super) fn in_si_units(&self, number: f64) -> String {
        match self.unit.dimension {
            Dimension::Number => format!("{number:?}"),
            dimension => format!("{number:?} {}", Unit::si(dimension)),
        }
    }

    /// The error of what was `found` in a line; empty where nothing was.
    pub fn refuse(&self, line: usize, found: &str, expected: &str) -> ContentError {
        let given = if found.is_empty() { String::new() } else { format!("\"{}\"", shortened(found)) };
        ContentError::value(Some(line), &self.label(), &given, expected)
    }
}
