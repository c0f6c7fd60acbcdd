//! The lines of names and of units above a table.
//!
//! A table has a row of names or none. The row has as many names as there are columns; a last column that has a name and no
//! values, or values and no name, has its empty field there, and is left out.

use std::borrow::Cow;

use asperity::tables::{ContentError, Dimension, Unit, shortened};

use super::blocks::Block;
use super::lines::{Line, Separator};
use super::numbers::is_number;

/// The lines of names and of units above a block.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Head<'a> {
    /// The names of the columns, at least as many as there are columns with values; none where there is no such line.
    pub names: Vec<Cow<'a, str>>,
    /// The line of the names.
    pub line: Option<usize>,
    /// The units below the names; none where there is no such line.
    pub units: Vec<Cow<'a, str>>,
}

/// How many lines of a header may stand between the names of columns and the first row.
const NEAR: usize = 6;

/// What a line above a block is.
enum Kind<'a> {
    Names(Vec<Cow<'a, str>>),
    Units(Vec<Cow<'a, str>>),
    /// Names, but so many that they are not those of the columns.
    Misfit(usize),
    Other,
}

impl<'a> Block<'a> {
    /// The fields of a line of names or units, at least as many as columns. `None` where it cannot be parted so.
    pub fn fields(&self, line: &'a str) -> Option<Vec<Cow<'a, str>>> {
        let fitting = |mut found: Vec<Cow<'a, str>>| {
            let filled = found.iter().rposition(|field| !field.is_empty()).map_or(0, |last| last + 1);
            let fits = filled <= self.width && found.len() >= self.columns;
            found.truncate(filled.max(self.columns));
            fits.then_some(found)
        };
        let parted = |separator: Separator| match separator {
            Separator::Letter(_) => fitting(separator.split(line)),
            // A unit in brackets belongs to the name before it, unless all are units.
            Separator::Blanks => fitting(named_units(line)).or_else(|| {
                let fields = separator.split(line);
                let is_bracketed = |field: &Cow<'_, str>| field.starts_with(['[', '(']);
                let are_units = fields.iter().all(is_bracketed) || !fields.iter().any(is_bracketed);
                are_units.then(|| fitting(fields)).flatten()
            }),
        };
        if self.parts(line) {
            return parted(self.separator);
        }
        let is_there = |separator: &Separator| match separator {
            Separator::Letter(letter) => line.contains(*letter),
            Separator::Blanks => true,
        };
        let others = Separator::ALL.into_iter().filter(is_there).find_map(parted);
        others
            .or_else(|| parted(self.separator))
            .or_else(|| fitting(phrases(line)))
            // `Units: x [mm] z [µm]`
            .or_else(|| fitting(named_units(line.split_once(':')?.1)))
    }

    /// Whether the letter that parts the rows is in a line.
    fn parts(&self, line: &str) -> bool {
        matches!(self.separator, Separator::Letter(letter) if line.contains(letter))
    }

    /// The lines of names and units: names are the words right above the first row or its units, or a comment there that has
    /// names that are known.
    ///
    /// # Errors
    /// [`ContentError`] where there are more or fewer names than columns.
    pub fn head(&self, is_known: &dyn Fn(&str) -> bool) -> Result<Head<'a>, ContentError> {
        let mut units = Vec::new();
        let has_content =
            |line: &&Line<'a>| line.1.contains(|letter: char| letter.is_alphanumeric() || "%°".contains(letter));
        for &(line, text) in self.above.iter().rev().filter(has_content).take(NEAR) {
            match self.kind(line, text, is_known) {
                Kind::Names(names) => return Ok(Head { names, line: Some(line), units }),
                Kind::Units(found) if units.is_empty() => units = found,
                Kind::Misfit(count) => {
                    let given = format!("{count} names above {} columns: \"{}\"", self.columns, shortened(text));
                    let expected = "as many names as columns; decimal commas need another sign between the columns";
                    return Err(ContentError::value(Some(line), "columns", &given, expected));
                }
                Kind::Units(_) | Kind::Other => (),
            }
        }
        Ok(Head { names: Vec::new(), line: None, units })
    }

    fn kind(&self, line: usize, text: &'a str, is_known: &dyn Fn(&str) -> bool) -> Kind<'a> {
        let is_comment = self.comments.contains(&line);
        let known = |fields: &[Cow<'_, str>]| fields.iter().filter(|field| is_known(field)).count();
        let is_setting = |field: &Cow<'_, str>| is_number(field) || field.ends_with(':') || field.contains('=');
        let Some(fields) = self.fields(text) else {
            let parts = if self.parts(text) { self.separator.split(text) } else { named_units(text) };
            let parts: Vec<_> = parts.into_iter().filter(|part| !part.is_empty()).collect();
            let known = known(&parts);
            let is_meant = match (is_comment, self.parts(text)) {
                (true, _) => 2 * known > parts.len(),
                (false, true) => parts.len() > 1,
                (false, false) => known > 0,
            };
            let is_other =
                parts.iter().any(is_setting) || text.split_once(':').is_some_and(|(_, value)| !value.is_empty());
            return if is_meant && !is_other { Kind::Misfit(parts.len()) } else { Kind::Other };
        };
        let (known, columns) = (known(&fields), fields.iter().filter(|field| !field.is_empty()).count());
        if known == 0 && is_unit_row(&fields) {
            return Kind::Units(fields);
        }
        // Prose in a comment may have a word that is known, and so may a setting: `Height,16`.
        let is_prose = is_comment && !text.contains([',', ';', '\t']);
        let are_names = match known {
            0 => {
                // A line without the letter that parts the rows is a title.
                let is_parted = self.columns == 1 || self.separator == Separator::Blanks || self.parts(text);
                !is_comment && is_parted && fields.iter().any(|field| field.contains(char::is_alphabetic))
            }
            1 => columns == 1 || !is_prose,
            _ => true,
        };
        let may_be = known > 1 || !fields.iter().any(is_setting);
        if are_names && may_be { Kind::Names(fields) } else { Kind::Other }
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
                    let of_number = is_number(std::mem::replace(&mut before, word));
                    Unit::parse(word).filter(|unit| unit.is_of(dimension) && is_clear(word) && !of_number)
                })
                .next()
        };
        let others = self.above.iter().filter(|(line, _)| Some(*line) != names);
        others.into_iter().find_map(|line| Some((*line, stated(line.1)?)))
    }

    /// A line between the names and the first row that is neither a comment nor one of units.
    pub fn stray_line(&self, head: &Head<'_>) -> Option<Line<'_>> {
        let is_stray = |(number, line): &&Line<'_>| {
            let is_unit = || self.fields(line).is_some_and(|fields| is_unit_row(&fields));
            head.line.is_some_and(|names| *number > names) && !self.comments.contains(number) && !is_unit()
        };
        self.above.iter().find(is_stray).copied()
    }
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
        for (data, line, names) in [
            ("1;2", "a, b;c", &["a, b", "c"][..]),
            ("1 2 3", "X[um] Y[um] Z[um]", &["X[um]", "Y[um]", "Z[um]"]),
            ("1 2", "Frequency (Hz)   E' (MPa)", &["Frequency (Hz)", "E' (MPa)"]),
            ("1 2", "x / mm z [nm]", &["x / mm", "z [nm]"]),
            ("1,2", "rel_mod, rel_time", &["rel_mod", "rel_time"]),
            ("1;2;\n3;4;", "a;b;note", &["a", "b", "note"]),
            ("1;2;\n3;4;x", "a;b;", &["a", "b", ""]),
            ("1;2", "a;b;", &["a", "b"]),
        ] {
            assert_eq!(part(data, line).unwrap_or_default(), names, "{line}");
        }
        for (data, line) in [("1 2", "a header of five words"), ("1;2;3", "a;b"), ("1;2", "a;b;c"), ("1,2", "a")] {
            assert_eq!(part(data, line), None, "{line}");
        }
    }

    #[test]
    fn names_stand_right_above_the_rows_or_are_none() {
        let names = |text: &str| {
            let blocks = Block::all(text, true);
            let head = blocks[0].head(&|name| ["x", "z"].contains(&name)).map_err(|error| error.given)?;
            Ok::<_, String>(head.names.iter().map(|name| name.to_string()).collect::<Vec<_>>())
        };
        for (text, found) in [
            ("x,z\n1,2\n", &["x", "z"][..]),
            ("Height,16\n1,2\n", &[]),
            ("# x,z\n1,2\n", &["x", "z"]),
            ("# by hand, indoors\n1,2\n", &[]),
            ("a title\n1,2\n", &[]),
            ("x,z\na,b\nmm,um\n1,2\n", &["a", "b"]),
            ("x,z\n# twice\n1,2\n", &["x", "z"]),
        ] {
            assert_eq!(names(text).unwrap_or_default(), found, "{text}");
        }
        for (text, count) in [("x,z\n1,2,3\n", "2 names above 3"), ("x,z,t\n1,2\n", "3 names above 2")] {
            assert!(names(text).is_err_and(|given| given.starts_with(count)), "{text}");
        }
    }
}
