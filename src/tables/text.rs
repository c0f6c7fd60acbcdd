//! From bytes to text, from text to rows of fields.

use std::borrow::Cow;
use std::iter;

use super::error::{ContentError, NotText};

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

/// A file that begins with the names of its columns, its fields as text.
#[derive(Clone, Debug, Default)]
pub struct Csv {
    /// The names of the columns.
    pub names: Vec<String>,
    /// The rows, each with as many fields.
    pub rows: Vec<Row<'static>>,
    /// The line of the names.
    pub line: usize,
}

impl Csv {
    /// The file in a text; see [`rows`] for the separator.
    ///
    /// # Errors
    /// [`ContentError`] where a row has more or fewer fields than there are names.
    pub fn parse(text: &str, separator: Option<char>) -> Result<Self, ContentError> {
        let mut rows = rows(text, separator).map(Row::into_owned);
        let Some(head) = rows.next() else { return Ok(Self::default()) };
        let names: Vec<String> = head.fields.into_iter().map(Cow::into_owned).collect();
        let whole = |row: Row<'static>| match row.fields.len() {
            found if found == names.len() => Ok(row),
            found => {
                let expected = format!("{}, as in line {}, that of the names", names.len(), head.line);
                Err(ContentError::value(Some(row.line), "fields", &found.to_string(), &expected))
            }
        };
        let rows = rows.map(whole).collect::<Result<_, _>>()?;
        Ok(Self { names, rows, line: head.line })
    }

    /// The place of the column `name`; the unit of a name such as `speed [m/s]` may be left out.
    ///
    /// # Errors
    /// [`ContentError`] with the names that there are.
    pub fn column(&self, name: &str) -> Result<usize, ContentError> {
        let without_unit = |header: &str| header.split_once(" [").is_some_and(|(start, _)| start == name);
        let named = self.names.iter().position(|other| other == name);
        let named = named.or_else(|| self.names.iter().position(|other| without_unit(other)));
        named.ok_or_else(|| {
            let line = (self.line > 0).then_some(self.line);
            ContentError::value(line, "columns", &self.names.join(", "), &format!("{name} among them"))
        })
    }
}

impl Row<'_> {
    fn into_owned(self) -> Row<'static> {
        Row { line: self.line, fields: self.fields.into_iter().map(|field| Cow::Owned(field.into_owned())).collect() }
    }
}

/// The lines that are neither blank nor comments (`# …`), as rows: their fields are separated by `separator` or, where
/// none is given, by the first of semicolon, tab and comma that is in the first row outside quotation marks.
pub fn rows(text: &str, separator: Option<char>) -> impl Iterator<Item = Row<'_>> {
    let filled = || numbered_lines(text).filter(|(_, line)| !line.starts_with('#'));
    let parts = |sign: char| filled().next().is_some_and(|(_, line)| fields(line, sign).nth(1).is_some());
    let found = || [';', '\t', ','].into_iter().find(|&sign| parts(sign));
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

/// The fields of a line, without blanks around them. A field in quotation marks may hold separators, and quotation
/// marks doubled.
pub fn fields(line: &str, separator: char) -> impl Iterator<Item = Cow<'_, str>> {
    let (mut rest, has_marks) = (Some(line), line.contains('"'));
    iter::from_fn(move || {
        let text = rest?;
        let end = if has_marks { field_end(text, separator) } else { text.find(separator) };
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

/// A field without its quotation marks.
pub fn unquoted(field: &str) -> Cow<'_, str> {
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
