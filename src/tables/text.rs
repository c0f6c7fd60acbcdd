//! The fields of a line of a table.

use std::borrow::Cow;
use std::iter;

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
}
