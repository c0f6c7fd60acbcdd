//! The lines of names and of units above a table.

use std::borrow::Cow;

use super::blocks::Block;
use super::lines::{Line, Separator};
use super::numbers::number;
use super::units::{Dimension, Unit};

/// The lines of names and of units above a block.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Head<'a> {
    /// The names of the columns, as many as there are columns; none where no line can be parted so.
    pub names: Vec<Cow<'a, str>>,
    /// The line of the names.
    pub line: Option<usize>,
    /// The units below the names; none where there is no such line.
    pub units: Vec<Cow<'a, str>>,
}

/// How many lines of a header may stand between the names of columns and the first row.
const NEAR: usize = 6;

impl<'a> Block<'a> {
    /// The fields of a line of names or units, as many as the block has columns; empty ones may be left out at its end.
    /// `None` where it cannot be parted so.
    pub fn fields(&self, line: &'a str) -> Option<Vec<Cow<'a, str>>> {
        let fitting = |mut found: Vec<Cow<'a, str>>| {
            while found.len() > self.columns && found.last().is_some_and(|field| field.is_empty()) {
                found.pop();
            }
            let padded =
                found.len() < self.columns && found.len() > 1 && matches!(self.separator, Separator::Letter(_));
            if padded && line.contains(|letter| Separator::Letter(letter) == self.separator) {
                found.resize(self.columns, Cow::Borrowed(""));
            }
            (found.len() == self.columns).then_some(found)
        };
        let own = fitting(self.separator.split(line));
        own.or_else(|| Separator::ALL.into_iter().find_map(|other| fitting(other.split(line))))
            .or_else(|| fitting(phrases(line)))
            .or_else(|| fitting(named_units(line)))
            // `Units: x [mm] z [µm]`
            .or_else(|| fitting(named_units(line.split_once(':')?.1)))
    }

    /// The lines of names and units: names are those of which `is_known` knows most, or else the words right above the
    /// first row or its units.
    pub fn head(&self, is_known: &dyn Fn(&str) -> bool) -> Head<'a> {
        let mut near =
            self.above.iter().rev().filter(|(_, line)| line.contains(char::is_alphanumeric) || has_unit_sign(line));
        let parted: Vec<(usize, Vec<Cow<'a, str>>)> =
            near.by_ref().take(NEAR).map(|(number, line)| (*number, self.fields(line).unwrap_or_default())).collect();
        // Prose in a comment may have a word that is known.
        let known = |(line, fields): &(usize, Vec<Cow<'_, str>>)| {
            let known = fields.iter().filter(|field| is_known(field)).count();
            if self.is_prose(*line) && known < 2 && fields.len() > 1 { 0 } else { known }
        };
        let is_number = |field: &Cow<'_, str>| number(field, true).is_some();
        let most = parted.iter().map(known).max().unwrap_or(0);
        let by_words = || {
            let first =
                parted.iter().position(|(line, fields)| !is_unit_row(fields) && !self.comments.contains(line))?;
            let fields = &parted[first].1;
            let are_names = fields.iter().any(|field| field.contains(char::is_alphabetic))
                && !fields.iter().any(|field| is_number(field) || field.ends_with(':') || field.contains('='));
            are_names.then_some(first)
        };
        let names = if most > 0 { parted.iter().position(|line| known(line) == most) } else { by_words() };
        let below = &parted[..names.unwrap_or(parted.len().min(1))];
        let units = below.iter().map(|(_, fields)| fields).find(|fields| is_unit_row(fields)).cloned();
        Head {
            names: names.map(|i| parted[i].1.clone()).unwrap_or_default(),
            line: names.map(|i| parted[i].0),
            units: units.unwrap_or_default(),
        }
    }

    /// A line above, other than that of the `names`, that speaks of a unit of a dimension: `all heights in mm`. A unit
    /// behind a number belongs to that: `stylus tip 2 µm`.
    pub fn stated_unit(&self, dimension: Dimension, names: Option<usize>) -> Option<(Line<'a>, Unit)> {
        // One letter, and these, may be something else.
        let is_clear = |word: &str| word.chars().count() > 1 && !["in", "min", "bar"].contains(&word);
        let stated = |text: &str| {
            let mut before = "";
            text.split(|letter: char| letter.is_whitespace() || ",;:=()[]<>|\"".contains(letter))
                .filter(|word| !word.is_empty())
                .filter_map(|word| {
                    let of_number = number(std::mem::replace(&mut before, word), true).is_some();
                    Unit::parse(word).filter(|unit| unit.is_of(dimension) && is_clear(word) && !of_number)
                })
                .next()
        };
        let others = self.above.iter().filter(|(line, _)| Some(*line) != names);
        others.into_iter().find_map(|line| Some((*line, stated(line.1)?)))
    }
}

impl Block<'_> {
    /// A line between the names and the first row that is neither a comment nor one of units.
    pub fn stray_line(&self, head: &Head<'_>) -> Option<Line<'_>> {
        let is_stray = |(number, line): &&Line<'_>| {
            let is_unit = || self.fields(line).is_some_and(|fields| is_unit_row(&fields));
            head.line.is_some_and(|names| *number > names) && !self.comments.contains(number) && !is_unit()
        };
        self.above.iter().find(is_stray).copied()
    }

    /// Whether a line above is a comment parted by blanks alone.
    fn is_prose(&self, line: usize) -> bool {
        let is_parted = |(number, text): &Line<'_>| *number == line && text.contains([',', ';', '\t']);
        self.comments.contains(&line) && !self.above.iter().any(is_parted)
    }
}

fn has_unit_sign(line: &str) -> bool {
    line.contains(['%', '°'])
}

/// Whether fields are units alone, in brackets or known; one of them must be one.
fn is_unit_row(fields: &[Cow<'_, str>]) -> bool {
    let bracketed = |field: &str| {
        let field = field.trim();
        (field.starts_with('[') && field.ends_with(']')) || (field.starts_with('(') && field.ends_with(')'))
    };
    let is_unit = |field: &&Cow<'_, str>| bracketed(field) || Unit::parse(field).is_some();
    let filled = || fields.iter().filter(|field| !field.is_empty());
    let units = filled().filter(is_unit).count();
    let others = filled().count() - units;
    // A label may stand before them, as in `Units  s  °C`, and a few of them need not be known.
    let is_labelled = fields.first().is_some_and(|first| first.to_lowercase().starts_with("unit"));
    units > 0 && (units >= 2 * others || (is_labelled && others <= 1 + units / 2))
}

/// A line parted at tabs and wherever there are two blanks.
fn phrases(line: &str) -> Vec<Cow<'_, str>> {
    let parts = line.split("  ").flat_map(|part| part.split('\t')).map(str::trim);
    parts.filter(|part| !part.is_empty()).map(Cow::Borrowed).collect()
}

/// A line parted at blanks, a unit in brackets or behind a slash kept with its name: `x [mm] z / µm`.
fn named_units(line: &str) -> Vec<Cow<'_, str>> {
    let mut parts: Vec<String> = Vec::new();
    let mut open = false;
    for word in line.split_whitespace() {
        let belongs = open || word.starts_with(['[', '(', '<', '/']);
        match parts.last_mut().filter(|_| belongs) {
            Some(part) => *part += &format!(" {word}"),
            None => parts.push(word.to_owned()),
        }
        let depth = |part: &str| part.matches(['[', '(', '<']).count() > part.matches([']', ')', '>']).count();
        open = parts.last().is_some_and(|part| depth(part) || part.ends_with('/'));
    }
    parts.into_iter().map(Cow::Owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_names_are_parted_as_the_columns_are() {
        let part = |data: &str, line: &'static str| {
            let blocks = Block::all(data, true);
            let fields = blocks[0].fields(line)?;
            Some(fields.iter().map(|field| field.to_string()).collect::<Vec<_>>())
        };
        assert_eq!(part("1;2", "a, b;c").unwrap_or_default(), ["a, b", "c"]);
        assert_eq!(part("1 2 3", "X[um] Y[um] Z[um]").unwrap_or_default(), ["X[um]", "Y[um]", "Z[um]"]);
        assert_eq!(part("1 2", "Frequency (Hz)   E' (MPa)").unwrap_or_default(), ["Frequency (Hz)", "E' (MPa)"]);
        assert_eq!(part("1 2", "x / mm z [nm]").unwrap_or_default(), ["x / mm", "z [nm]"]);
        assert_eq!(part("1,2", "rel_mod, rel_time").unwrap_or_default(), ["rel_mod", "rel_time"]);
        assert_eq!(part("1 2", "a header of five words"), None);
        assert_eq!(part("1;2;3", "a;b").unwrap_or_default(), ["a", "b", ""]);
    }
}
