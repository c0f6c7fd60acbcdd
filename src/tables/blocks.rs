//! Where the tables stand in a text: runs of lines of numbers, and the lines of names and units above them.

use std::borrow::Cow;

use super::headings::{Heading, Words};
use super::units::{Dimension, Unit};
use super::{fields, unquoted};

/// What parts the fields of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    /// A letter; an empty field stands between two of them.
    Letter(char),
    /// Any number of tabs and blanks.
    Blanks,
}

impl Separator {
    const ALL: [Self; 4] = [Self::Letter(';'), Self::Letter('\t'), Self::Letter(','), Self::Blanks];

    /// The fields of a line.
    pub fn split(self, line: &str) -> Vec<Cow<'_, str>> {
        match self {
            Self::Letter(letter) => fields(line, letter).collect(),
            Self::Blanks => line.split_whitespace().map(unquoted).collect(),
        }
    }

    /// Whether a comma in a number stands before its decimals.
    pub fn allows_decimal_comma(self) -> bool {
        self != Self::Letter(',')
    }
}

/// Reads the numbers of a table: with decimal points or with decimal commas, but not with both, for commas may then
/// stand between thousands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NumberStyle {
    decimal_comma: bool,
    points: bool,
    commas: bool,
}

/// A table has numbers with points and others with commas.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected {}", NumberStyle::EXPECTED)]
pub struct MixedDecimals;

impl NumberStyle {
    /// What a table must have.
    pub const EXPECTED: &str = "numbers with decimal points or with decimal commas, not both in one file";

    /// That of a block whose numbers are still to be read.
    pub fn of(block: &Block<'_>) -> Self {
        Self { decimal_comma: block.separator.allows_decimal_comma(), points: false, commas: false }
    }

    /// The number in a field, if it is one; it may be NaN.
    ///
    /// # Errors
    /// [`MixedDecimals`] where numbers before had the other sign.
    pub fn read(&mut self, field: &str) -> Result<Option<f64>, MixedDecimals> {
        let value = number(field, self.decimal_comma);
        if value.is_some() { self.add(field).map(|()| value) } else { Ok(None) }
    }

    /// Notes the sign in a number.
    ///
    /// # Errors
    /// As [`NumberStyle::read`].
    pub fn add(&mut self, field: &str) -> Result<(), MixedDecimals> {
        self.points |= field.contains('.');
        self.commas |= field.contains(',');
        if self.points && self.commas && field.contains(['.', ',']) { Err(MixedDecimals) } else { Ok(()) }
    }
}

/// Words for a value that is not there.
pub const MISSING: [&str; 12] =
    ["nan", "n/a", "na", "#n/a", "null", "none", "bad", "missing", "invalid", "void", "#div/0!", "."];

/// Whether a field says in one of the usual ways that there is no value.
pub fn is_missing(field: &str) -> bool {
    field.chars().all(|sign| "*-".contains(sign)) || MISSING.iter().any(|word| field.eq_ignore_ascii_case(word))
}

/// The number in a field; it may be NaN. Where `decimal_comma`, a comma may stand before the decimals.
pub fn number(field: &str, decimal_comma: bool) -> Option<f64> {
    if let Ok(number) = field.parse() {
        return Some(number);
    }
    let begins = field.starts_with(|letter: char| letter.is_ascii_digit() || "+-.,\u{2212}".contains(letter));
    if !begins {
        return None;
    }
    let plain = field.replace('\u{2212}', "-");
    let plain = if decimal_comma && !plain.contains('.') { plain.replacen(',', ".", 1) } else { plain };
    // FORTRAN's double precision: 1.0D-03.
    plain.parse().or_else(|_| plain.replace(['D', 'd'], "e").parse()).ok()
}

/// A line of a text, with its number from 1.
pub type Line<'a> = (usize, &'a str);

/// A run of lines of numbers with the same number of fields, and what stands above it.
#[derive(Clone, Debug)]
pub struct Block<'a> {
    /// Parts its fields.
    pub separator: Separator,
    /// Fields of a line.
    pub columns: usize,
    /// The lines between the block before it and its first row, blank ones left out; comments without their sign.
    pub above: Vec<Line<'a>>,
    /// The lines of its rows.
    pub first: usize,
    /// The line of its last row.
    pub last: usize,
    /// Number of its rows.
    pub rows: usize,
    /// Where its first row begins in the text, in bytes.
    pub start: usize,
    /// Some fields of its first row are empty.
    gaps: bool,
    /// The lines above that are comments.
    comments: Vec<usize>,
}

/// The blocks of a text so far.
struct Blocks<'a> {
    text: &'a str,
    blocks: Vec<Block<'a>>,
    /// The lines since the last row, and the numbers of those that are comments.
    above: Vec<Line<'a>>,
    comments: Vec<usize>,
    /// Whether a row may belong to the last block.
    is_open: bool,
}

impl<'a> Blocks<'a> {
    /// Adds a row to the last block or to a new one: its line, where that begins, its separator and columns.
    fn add_row(&mut self, (line, start): (usize, usize), form: (Separator, usize), gaps: bool) {
        let is_open = self.is_open;
        let goes_on = |block: &&mut Block<'_>| is_open && (block.separator, block.columns) == form;
        if let Some(block) = self.blocks.last_mut().filter(goes_on) {
            (block.last, block.rows) = (line, block.rows + 1);
            self.above.clear();
            return;
        }
        let mut above = std::mem::take(&mut self.above);
        // A row of numbers with gaps, and words below it: they are a header of the columns.
        if let Some(row) = self.blocks.pop_if(|block| block.gaps && block.rows == 1 && !above.is_empty()) {
            let text = trimmed(self.text[row.start..].lines().next().unwrap_or_default());
            above = row.above.into_iter().chain([(row.first, text)]).chain(above).collect();
        }
        let (separator, columns) = form;
        let comments = std::mem::take(&mut self.comments);
        self.blocks.push(Block { separator, columns, above, first: line, last: line, rows: 1, start, gaps, comments });
        self.is_open = true;
    }
}

/// What a line is.
enum Kind {
    Blank,
    Comment,
    /// `gaps`: some of its fields are empty.
    Data {
        separator: Separator,
        columns: usize,
        gaps: bool,
    },
    Other,
}

impl<'a> Block<'a> {
    /// The blocks of a text. Comments (`#`, `%`, `!`, `//`) end one where `comments_part`.
    pub fn all(text: &'a str, comments_part: bool) -> Vec<Self> {
        let mut found = Blocks { text, blocks: Vec::new(), above: Vec::new(), comments: Vec::new(), is_open: false };
        let mut start = 0;
        for (number, line) in (1..).zip(text.split_inclusive('\n')) {
            let bare = trimmed(line);
            match kind(bare, found.blocks.last().filter(|_| found.is_open)) {
                Kind::Blank => (),
                Kind::Comment => {
                    found.is_open &= !comments_part;
                    found.comments.push(number);
                    found.above.push((number, without_sign(bare)));
                }
                Kind::Data { separator, columns, gaps } => found.add_row((number, start), (separator, columns), gaps),
                Kind::Other => {
                    found.is_open = false;
                    found.above.push((number, bare));
                }
            }
            start += line.len();
        }
        found.blocks
    }

    /// The block with more lines above it: the header of another one.
    pub fn below(&self, lines: &[Line<'a>]) -> Self {
        Self { above: lines.iter().chain(&self.above).copied().collect(), ..self.clone() }
    }

    /// The block as one column of numbers with decimal commas.
    pub fn as_column(&self) -> Self {
        Self { separator: Separator::Blanks, columns: 1, ..self.clone() }
    }

    /// The numbered lines of the rows of the block, from its first to its last.
    pub fn lines(&self, text: &'a str) -> impl Iterator<Item = Line<'a>> {
        let lines = text[self.start..].lines().zip(self.first..).take(self.last + 1 - self.first);
        lines.map(|(line, number)| (number, trimmed(line))).filter(|(_, line)| !line.is_empty() && !is_comment(line))
    }

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
}

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

impl Head<'_> {
    /// What the columns hold, as far as their names are in the vocabulary.
    pub fn headings<Q: Copy + PartialEq>(&self, vocabulary: &[Words<Q>]) -> Vec<Option<Heading<Q>>> {
        let unit = |i: usize| self.units.get(i).map_or("", |unit| unit);
        self.names.iter().enumerate().map(|(i, name)| Heading::with_unit(name, unit(i), vocabulary)).collect()
    }
}

/// How many lines of a header may stand between the names of columns and the first row.
const NEAR: usize = 6;

impl<'a> Block<'a> {
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
}

impl<'a> Block<'a> {
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

/// Without blanks around it; but a tab at the end may stand before an empty column.
pub(super) fn trimmed(line: &str) -> &str {
    line.trim_start_matches([' ', '\r', '\u{feff}']).trim_end_matches([' ', '\r', '\n'])
}

pub(super) fn is_comment(line: &str) -> bool {
    line.starts_with(['#', '%', '!']) || line.starts_with("//")
}

fn without_sign(line: &str) -> &str {
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

/// What a line is; one that can belong to the open block is tried with that block's separator first.
fn kind(line: &str, open: Option<&Block<'_>>) -> Kind {
    if let Some(&Block { separator: Separator::Letter(letter), columns, .. }) = open
        && plain_decimals(line, letter) == Some(columns)
    {
        return Kind::Data { separator: Separator::Letter(letter), columns, gaps: false };
    }
    let bare = line.trim();
    if bare.is_empty() {
        return Kind::Blank;
    }
    if is_comment(bare) {
        return Kind::Comment;
    }
    if let Some(block) = open {
        let row = Row::read(line, block.separator);
        // The last fields of a row may be left out. What begins with a number is a row, though words stand in it.
        let ragged = matches!(block.separator, Separator::Letter(_)) && (2..block.columns).contains(&row.columns);
        let fits = row.columns == block.columns || (ragged && row.is_data());
        if fits && (row.is_data() || (row.begins_with_number && row.columns > 1)) {
            return Kind::Data { separator: block.separator, columns: block.columns, gaps: row.has_gaps() };
        }
    }
    let rows = || {
        let shows = |separator: &Separator| match separator {
            Separator::Letter(letter) => line.contains(*letter),
            Separator::Blanks => true,
        };
        Separator::ALL.into_iter().filter(shows).map(|separator| (separator, Row::read(line, separator)))
    };
    // Numbers alone first: `0,5 1,5` are two, and not 0, `5 1` and 5.
    let found =
        rows().find(|(_, row)| row.is_data() && row.words == 0).or_else(|| rows().find(|(_, row)| row.is_data()));
    found.map_or(Kind::Other, |(separator, row)| Kind::Data { separator, columns: row.columns, gaps: row.has_gaps() })
}

/// What the fields of a line are.
#[derive(Clone, Copy, Debug, Default)]
struct Row {
    columns: usize,
    numbers: usize,
    words: usize,
    begins_with_number: bool,
}

impl Row {
    fn read(line: &str, separator: Separator) -> Self {
        let decimal_comma = separator.allows_decimal_comma();
        let (mut row, mut count, mut last) = (Self::default(), 0, 0);
        let mut add = |field: &str| {
            count += 1;
            if !field.is_empty() {
                last = count;
            }
            if number(field, decimal_comma).is_some() {
                row.numbers += 1;
                row.begins_with_number |= count == 1;
            } else if !is_missing(field) {
                row.words += 1;
            }
        };
        match separator {
            Separator::Letter(letter) => fields(line, letter).for_each(|field| add(&field)),
            Separator::Blanks => line.split_whitespace().for_each(|field| add(&unquoted(field))),
        }
        // `x;z;` has two columns, and `x;` has a height that is missing.
        row.columns = last.max(count.min(2));
        row
    }

    /// Numbers alone, more numbers than words, or a number and behind it a word that may be a mistake.
    fn is_data(&self) -> bool {
        let mixed = self.numbers >= 2 && self.numbers > self.words;
        let mistaken = self.begins_with_number && self.words == 1 && self.columns == 2;
        self.numbers > 0 && (self.words == 0 || mixed || mistaken)
    }

    fn has_gaps(&self) -> bool {
        self.numbers + self.words < self.columns
    }
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

    /// Columns, first and last line, lines above.
    type Found = (usize, usize, usize, usize);

    fn found(text: &str) -> Vec<Found> {
        let blocks = Block::all(text, true);
        blocks.iter().map(|block| (block.columns, block.first, block.last, block.above.len())).collect()
    }

    #[test]
    fn plain_decimals_are_told_at_a_glance() {
        for (line, count) in [("0,-1.5", 2), ("1.", 1), ("1e-05,-6.04E+3,7", 3)] {
            assert_eq!(plain_decimals(line, ','), Some(count), "{line}");
        }
        for line in ["", ",", "1,", "1,,2", "1e,2", "+1", "1.2.3", "nan", ".5", "-", "1;2", "1, 2", "1 "] {
            assert_eq!(plain_decimals(line, ','), None, "{line}");
        }
    }

    #[test]
    fn blocks_are_runs_of_numbers() {
        let cases: [(&str, &[Found]); 10] = [
            ("x,z\n0,1\n1,2\n", &[(2, 2, 3, 1)]),
            ("Sample\t5\nVariables\ta\tb\nData point\t1\t2\nData point\t3\t4\n", &[(3, 3, 4, 2)]),
            ("0 1\n1 2\nRa 0.19\n", &[(2, 1, 2, 0)]),
            ("a;b\n1;2\n\n3;4\n[next]\na;b\n5;6\n", &[(2, 2, 4, 1), (2, 7, 7, 2)]),
            ("# T = 20\n1 2\n# T = 40\n3 4\n", &[(2, 2, 2, 1), (2, 4, 4, 1)]),
            ("0,5 1,5\n1 -2,5e-1\n", &[(2, 1, 2, 0)]),
            ("1\n2\n", &[(1, 1, 2, 0)]),
            ("---\nx\n", &[]),
            ("1;2;\n3;;\n", &[(2, 1, 2, 0)]),
            (",20,,40,\nf,a,b,a,b\n1,2,3,4,5\n", &[(5, 3, 3, 2)]),
        ];
        for (text, expected) in cases {
            assert_eq!(found(text), expected, "{text:?}");
        }
    }

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

    #[test]
    fn numbers_as_instruments_write_them() {
        for (text, value) in [("1,5", 1.5), ("-,25", -0.25), ("1.5D-03", 1.5e-3), ("\u{2212}2", -2.0), ("1e5", 1e5)] {
            assert_eq!(number(text, true), Some(value), "{text}");
        }
        for text in ["1.234,5", "1,234,5", "x", "", "E", "d5", "12:30"] {
            assert_eq!(number(text, true), None, "{text}");
        }
        let mut style = NumberStyle { decimal_comma: true, points: false, commas: false };
        let read = ["1.5", "2", "x", "1,234"].map(|field| style.read(field));
        assert_eq!(read, [Ok(Some(1.5)), Ok(Some(2.0)), Ok(None), Err(MixedDecimals)]);
    }
}
