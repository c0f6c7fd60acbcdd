//! What the lines of a text are: rows of numbers, comments, words.

use std::borrow::Cow;

use asperity::tables::{fields, unquoted};

use super::numbers::{is_missing, is_number};

/// A line of a text, with its number from 1.
pub type Line<'a> = (usize, &'a str);

/// A row of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row<'a> {
    /// Its line in the file, counted from 1.
    pub line: usize,
    /// Its fields.
    pub fields: Vec<Cow<'a, str>>,
}

impl Row<'_> {
    /// The row, whose fields are its own.
    pub fn into_owned(self) -> Row<'static> {
        Row { line: self.line, fields: self.fields.into_iter().map(|field| Cow::Owned(field.into_owned())).collect() }
    }
}

/// What parts the fields of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    /// A letter; an empty field stands between two of them.
    Letter(char),
    /// Any number of tabs and blanks.
    Blanks,
}

impl Separator {
    pub(super) const ALL: [Self; 4] = [Self::Letter(';'), Self::Letter('\t'), Self::Letter(','), Self::Blanks];

    /// The fields of a line.
    pub fn split(self, line: &str) -> Vec<Cow<'_, str>> {
        match self {
            Self::Letter(letter) => fields(line, letter).collect(),
            Self::Blanks => words(line).map(unquoted).collect(),
        }
    }
}

/// What stands between blanks and tabs; other blanks, U+00A0 and its like, part thousands.
fn words(line: &str) -> impl Iterator<Item = &str> {
    line.split([' ', '\t', '\r', '\n']).filter(|word| !word.is_empty())
}

/// What a line is.
pub(super) enum Kind {
    Blank,
    Comment,
    Data(Form),
    Other,
}

/// How a row of numbers is parted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Form {
    pub(super) separator: Separator,
    /// Its fields.
    pub(super) width: usize,
    /// Its fields up to the last that is not empty.
    pub(super) columns: usize,
    /// Whether some of these are empty.
    pub(super) gaps: bool,
}

/// Without blanks around it; but a tab at the end may stand before an empty column.
pub(super) fn trimmed(line: &str) -> &str {
    line.trim_start_matches([' ', '\r', '\u{feff}']).trim_end_matches([' ', '\r', '\n'])
}

pub(super) fn is_comment(line: &str) -> bool {
    line.starts_with(['#', '%', '!']) || line.starts_with("//")
}

pub(super) fn without_sign(line: &str) -> &str {
    line.trim_start_matches(['#', '%', '!', '/', ' '])
}

/// How many plain decimals a line has with a `letter` between them, if it has nothing else: digits, with or without a
/// sign `-`, a point and an exponent. Nearly all lines of a long table are such ones, and are told at a glance.
fn plain_decimals(line: &str, letter: char) -> Option<usize> {
    let bytes = line.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let has = |at: usize, signs: &[u8]| bytes.get(at).is_some_and(|byte| signs.contains(byte));
    let (mut at, mut count) = (0, 0);
    loop {
        at += usize::from(has(at, b"-"));
        let whole = digits(at);
        at += whole;
        if has(at, b".") {
            at += 1 + digits(at + 1);
        }
        if has(at, b"eE") {
            let exponent = at + 1 + usize::from(has(at + 1, b"+-"));
            at = exponent + digits(exponent);
            if at == exponent {
                return None;
            }
        }
        count += 1;
        match bytes.get(at) {
            _ if whole == 0 => return None,
            None => return Some(count),
            Some(&byte) if char::from(byte) == letter => at += 1,
            Some(_) => return None,
        }
    }
}

/// What a line is; one that can belong to the open block is tried with the separator and the width of that first.
pub(super) fn kind(line: &str, open: Option<(Separator, usize)>) -> Kind {
    if let Some((Separator::Letter(letter), width)) = open
        && plain_decimals(line, letter) == Some(width)
    {
        return Kind::Data(Form { separator: Separator::Letter(letter), width, columns: width, gaps: false });
    }
    let bare = line.trim();
    if bare.is_empty() {
        return Kind::Blank;
    }
    if is_comment(bare) {
        return Kind::Comment;
    }
    if let Some((separator, width)) = open {
        let row = Shape::read(line, separator);
        // The last fields of a row may be left out. What begins with a number is a row, though words stand in it.
        let ragged = matches!(separator, Separator::Letter(_)) && row.width > 1 && row.columns <= width;
        let fits = row.width == width || (ragged && row.is_data());
        if fits && (row.is_data() || (row.begins_with_number && row.columns > 1)) {
            return Kind::Data(Form { width, ..row.form(separator) });
        }
    }
    let rows = || {
        let shows = |separator: &Separator| match separator {
            Separator::Letter(letter) => line.contains(*letter),
            Separator::Blanks => true,
        };
        Separator::ALL.into_iter().filter(shows).map(|separator| (separator, Shape::read(line, separator)))
    };
    // Numbers alone first: `0,5 1,5` are two, and not 0, `5 1` and 5.
    let found =
        rows().find(|(_, row)| row.is_data() && row.words == 0).or_else(|| rows().find(|(_, row)| row.is_data()));
    found.map_or(Kind::Other, |(separator, row)| Kind::Data(row.form(separator)))
}

/// What the fields of a line are.
#[derive(Clone, Copy, Debug, Default)]
struct Shape {
    width: usize,
    columns: usize,
    numbers: usize,
    words: usize,
    begins_with_number: bool,
}

impl Shape {
    fn read(line: &str, separator: Separator) -> Self {
        let mut row = Self::default();
        let mut add = |field: &str| {
            row.width += 1;
            if !field.is_empty() {
                row.columns = row.width;
            }
            if is_number(field) {
                row.numbers += 1;
                row.begins_with_number |= row.width == 1;
            } else if !is_missing(field) {
                row.words += 1;
            }
        };
        match separator {
            Separator::Letter(letter) => fields(line, letter).for_each(|field| add(&field)),
            Separator::Blanks => words(line).for_each(|field| add(&unquoted(field))),
        }
        row
    }

    fn form(&self, separator: Separator) -> Form {
        let gaps = self.numbers + self.words < self.columns;
        Form { separator, width: self.width, columns: self.columns, gaps }
    }

    /// Numbers alone, more numbers than words, or a number and behind it a word that may be a mistake.
    fn is_data(&self) -> bool {
        let mixed = self.numbers >= 2 && self.numbers > self.words;
        let mistaken = self.begins_with_number && self.words == 1 && self.columns == 2;
        self.numbers > 0 && (self.words == 0 || mixed || mistaken)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_decimals_are_told_at_a_glance() {
        for (line, count) in [("0,-1.5", 2), ("1.", 1), ("1e-05,-6.04E+3,7", 3)] {
            assert_eq!(plain_decimals(line, ','), Some(count), "{line}");
        }
        for line in ["", ",", "1,", "1,,2", "1e,2", "+1", "1.2.3", "nan", ".5", "-", "1;2", "1, 2", "1 "] {
            assert_eq!(plain_decimals(line, ','), None, "{line}");
        }
    }
}
