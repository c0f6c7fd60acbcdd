//! Tables of text as people, instruments and spreadsheets write them: from bytes to text, from text to rows of fields.
//!
//! The one reader of text tables: profiles, Prony series, measured moduli, sweep tables and result files go through it.
//! Files with the same separator on all lines are read by [`rows`]; the output of instruments, whose headers may hold
//! anything, line by line, each with the separator that it shows.

use std::borrow::Cow;
use std::iter;

use super::Problem;

/// The bytes are no text: some are zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: expected {}", Self::FOUND, Self::EXPECTED)]
pub struct NotText;

impl NotText {
    /// What was found.
    pub const FOUND: &str = "bytes that are zero";
    /// What was expected.
    pub const EXPECTED: &str = "text in UTF-8, UTF-16 or Latin-1";
}

impl From<NotText> for Problem {
    fn from(_: NotText) -> Self {
        Self::Value { given: NotText::FOUND.into(), expected: NotText::EXPECTED.into() }
    }
}

/// The text in `bytes`: UTF-8, UTF-16 (by its mark, or by its zeros) or else Latin-1, without a byte order mark, its
/// lines ended by line feeds.
///
/// # Errors
/// [`NotText`] where a character is U+0000.
pub fn decode(bytes: &[u8]) -> Result<Cow<'_, str>, NotText> {
    let text = match bytes {
        [0xff, 0xfe, rest @ ..] => Cow::Owned(utf_16(rest, u16::from_le_bytes)),
        [0xfe, 0xff, rest @ ..] => Cow::Owned(utf_16(rest, u16::from_be_bytes)),
        [1..=255, 0, 1..=255, 0, ..] => Cow::Owned(utf_16(bytes, u16::from_le_bytes)),
        [0, 1..=255, 0, 1..=255, ..] => Cow::Owned(utf_16(bytes, u16::from_be_bytes)),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => Cow::Borrowed(text.strip_prefix('\u{feff}').unwrap_or(text)),
            // Of Latin-1 every byte is the number of its letter: µ is 0xb5.
            Err(_) => Cow::Owned(bytes.iter().copied().map(char::from).collect()),
        },
    };
    if text.contains('\0') {
        return Err(NotText);
    }
    // Lines of an old Macintosh.
    if text.contains('\r') && !text.contains('\n') { Ok(Cow::Owned(text.replace('\r', "\n"))) } else { Ok(text) }
}

fn utf_16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let units: Vec<u16> = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]])).collect();
    String::from_utf16_lossy(&units)
}

/// A row of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row<'a> {
    /// Its line in the file, counted from 1.
    pub line: usize,
    /// Its fields, see [`fields`].
    pub fields: Vec<Cow<'a, str>>,
}

/// The lines that are neither blank nor comments (`# …`), as rows: their fields are separated by `separator` or, where
/// none is given, by the first of semicolon, tab and comma that is in the first row.
pub fn rows(text: &str, separator: Option<char>) -> impl Iterator<Item = Row<'_>> {
    let filled = || numbered_lines(text).filter(|(_, line)| !line.starts_with('#'));
    let found =
        || [';', '\t', ','].into_iter().find(|&sign| filled().next().is_some_and(|(_, line)| line.contains(sign)));
    let separator = separator.or_else(found).unwrap_or(',');
    filled().map(move |(line, text)| Row { line, fields: fields(text, separator).collect() })
}

/// The lines that are comments, without their `#`, and their numbers from 1.
pub fn comments(text: &str) -> impl Iterator<Item = (usize, &str)> {
    numbered_lines(text).filter_map(|(number, line)| Some((number, line.strip_prefix('#')?)))
}

fn numbered_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty())
}

/// The fields of a line, without blanks around them. A field in quotation marks may hold separators, and quotation marks
/// doubled.
pub fn fields(line: &str, separator: char) -> impl Iterator<Item = Cow<'_, str>> {
    let mut rest = Some(line);
    iter::from_fn(move || {
        let text = rest?;
        let end = field_end(text, separator);
        rest = end.map(|end| &text[end + separator.len_utf8()..]);
        Some(unquoted(text[..end.unwrap_or(text.len())].trim()))
    })
}

/// The index of the first separator that is not in quotation marks.
fn field_end(text: &str, separator: char) -> Option<usize> {
    let mut quoted = false;
    for (i, letter) in text.char_indices() {
        if letter == separator && !quoted {
            return Some(i);
        }
        // They open at the start of a field alone; doubled ones close and open again.
        if letter == '"' && (quoted || text[..i].ends_with('"') || text[..i].trim().is_empty()) {
            quoted = !quoted;
        }
    }
    None
}

fn unquoted(field: &str) -> Cow<'_, str> {
    let Some(quoted) = field.strip_prefix('"') else { return Cow::Borrowed(field) };
    let (mut text, mut inside, mut letters) = (String::new(), true, quoted.chars().peekable());
    while let Some(letter) = letters.next() {
        match letter {
            '"' if inside && letters.next_if_eq(&'"').is_some() => text.push('"'),
            '"' if inside => inside = false,
            letter => text.push(letter),
        }
    }
    Cow::Owned(text.trim().to_owned())
}

/// The text as one field of a line with commas: in quotation marks where it needs them, line ends replaced by blanks.
pub fn quoted(text: &str) -> String {
    let text = text.replace(['\n', '\r'], " ");
    if text.contains([',', '"']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text }
}

/// The first columns of a line whose separator shows in the line itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Columns<'a> {
    /// Up to three columns, without blanks around them; empty where there are fewer.
    pub(super) fields: [&'a str; 3],
    /// The last column that is not empty.
    last: &'a str,
    /// How many columns there are: empty ones at the end count up to the second.
    pub(super) count: usize,
    /// Whether a comma in a number stands before its decimals: where it separates no columns.
    decimal_comma: bool,
}

impl<'a> Columns<'a> {
    /// Splits a line at semicolons, tabs or blanks, or else at commas. Any number of tabs and blanks separates, unless
    /// `tabs_count`: an empty column between two tabs is then one.
    pub(super) fn split(line: &'a str, tabs_count: bool) -> Self {
        if line.contains(';') {
            Self::of(line.split(';'), true)
        } else if line.contains('\t') {
            let blanks = Self::of(line.split_whitespace(), true);
            if tabs_count || blanks.count < 2 { Self::of(line.split('\t'), true) } else { blanks }
        } else if line.contains(',') {
            let commas = Self::of(line.split(','), false);
            // `0,5 1,5` are two numbers with decimal commas, for `5 1` is none.
            let is_blank = |field: &&str| field.contains(' ');
            if !line.contains(' ') || !commas.fields.iter().any(is_blank) {
                return commas;
            }
            Some(Self::of(line.split_whitespace(), true)).filter(Self::starts_with_numbers).unwrap_or(commas)
        } else {
            Self::of(line.split_whitespace(), false)
        }
    }

    fn of(fields: impl Iterator<Item = &'a str>, decimal_comma: bool) -> Self {
        let mut columns = Self { decimal_comma, ..Self::default() };
        for (i, field) in fields.enumerate() {
            let field = field.trim();
            if let Some(column) = columns.fields.get_mut(i) {
                *column = field;
            }
            if !field.is_empty() {
                columns.last = field;
            }
            if !field.is_empty() || i < 2 {
                columns.count = i + 1;
            }
        }
        columns
    }

    /// The number in column `i`; it may be NaN.
    pub(super) fn number(&self, i: usize) -> Option<f64> {
        self.parse(self.fields[i])
    }

    fn parse(&self, field: &str) -> Option<f64> {
        field.parse().ok().or_else(|| self.parse_quoted_or_with_comma(field))
    }

    fn parse_quoted_or_with_comma(&self, field: &str) -> Option<f64> {
        let bare = field.trim_matches('"').trim();
        if self.decimal_comma && bare.contains(',') { bare.replace(',', ".").parse().ok() } else { bare.parse().ok() }
    }

    fn starts_with_numbers(&self) -> bool {
        self.count >= 2 && self.number(0).is_some() && (self.number(1).is_some() || self.is_missing(1))
    }

    /// Whether this can be a point: x, and a height or none.
    pub(super) fn is_point(&self) -> bool {
        self.starts_with_numbers() && self.number(0).is_some_and(f64::is_finite)
    }

    /// Whether there are words alone, as the names of columns; one word among numbers is a mistake.
    pub(super) fn is_header(&self) -> bool {
        self.number(0).is_none() && self.parse(self.last).is_none()
    }

    /// Whether column `i` says in one of the usual ways that there is no value.
    pub(super) fn is_missing(&self, i: usize) -> bool {
        const WORDS: [&str; 8] = ["nan", "n/a", "na", "#n/a", "null", "none", "bad", "missing"];
        let field = self.fields[i].trim_matches('"');
        let signs = field.chars().all(|sign| "*-".contains(sign));
        signs || WORDS.iter().any(|word| field.eq_ignore_ascii_case(word))
    }

    /// Whether column `i` is a mark that is set: neither empty nor 0, nor a word such as `no`.
    pub(super) fn is_marked(&self, i: usize) -> bool {
        const UNSET: [&str; 7] = ["", "false", "no", "n", "f", "-", "off"];
        let field = self.fields[i].trim_matches('"');
        !UNSET.iter().any(|word| field.eq_ignore_ascii_case(word)) && self.number(i) != Some(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_in_quotes_hold_separators_and_quotes() {
        let cases: [(&str, char, &[&str]); 6] = [
            (r#"1, "a, ""b""" ,,c"#, ',', &["1", r#"a, "b""#, "", "c"]),
            (r#""Frequency, Hz","E"" [MPa]","""#, ',', &["Frequency, Hz", r#"E" [MPa]"#, ""]),
            (r#"5" stylus;"";""";"""#, ';', &[r#"5" stylus"#, "", r#"";""#]),
            ("a;b,c;", ';', &["a", "b,c", ""]),
            ("\t\"x\ty\"\t z ", '\t', &["", "x\ty", "z"]),
            ("", ',', &[""]),
        ];
        for (line, separator, expected) in cases {
            assert_eq!(fields(line, separator).collect::<Vec<_>>(), expected, "{line}");
        }
        assert_eq!(fields(&quoted("a, \"b\"\nc"), ',').collect::<Vec<_>>(), ["a, \"b\" c"]);
        assert_eq!(quoted("a b"), "a b");
    }

    #[test]
    fn rows_have_their_lines_and_the_separator_of_the_first() {
        let text = "# by hand\n\na;b,c\r\n1;2\n \n# end\n3,5;4\n";
        let found: Vec<(usize, Vec<Cow<'_, str>>)> = rows(text, None).map(|row| (row.line, row.fields)).collect();
        let row = |line, fields: [&'static str; 2]| (line, fields.map(Cow::from).to_vec());
        assert_eq!(found, [row(3, ["a", "b,c"]), row(4, ["1", "2"]), row(7, ["3,5", "4"])]);
        assert_eq!(comments(text).collect::<Vec<_>>(), [(1, " by hand"), (6, " end")]);
        let by_commas: Vec<_> = rows(text, Some(',')).map(|row| row.fields.len()).collect();
        assert_eq!(by_commas, [2, 1, 2]);
    }

    #[test]
    fn zeros_are_no_text() {
        let message = "bytes that are zero: expected text in UTF-8, UTF-16 or Latin-1";
        assert_eq!(decode(b"a\0").map_err(|error| error.to_string()), Err(message.into()));
        assert_eq!(decode(b"\xb5m").as_deref(), Ok("\u{b5}m"));
    }
}
