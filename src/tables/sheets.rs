//! Workbooks: of their sheets, each a table of text, the one that is meant.

use super::columns::ReadingNote;
use super::error::ContentError;

/// The sheets of a workbook, name and text.
pub type Sheets = Vec<(String, String)>;

/// What `read` makes of the only sheet that it can read, with its text and a note of its name.
///
/// # Errors
/// [`ContentError`] where none can be read, that of the longest; or several can.
fn only_sheet<T>(
    sheets: &[(String, String)],
    read: impl Fn(&[u8]) -> Result<T, ContentError>,
) -> Result<(T, &str, ReadingNote), ContentError> {
    let filled = sheets.iter().filter(|(_, text)| !text.trim().is_empty());
    let (mut found, mut errors) = (Vec::new(), Vec::new());
    for (name, text) in filled {
        match read(text.as_bytes()) {
            Ok(content) => found.push((content, name, text)),
            Err(error) => errors.push((text.len(), error.in_sheet(name))),
        }
    }
    if found.len() > 1 {
        let names: Vec<&str> = found.iter().map(|(_, name, _)| name.as_str()).collect();
        return Err(ContentError::value(None, "sheets", &names.join(", "), "one with such a table"));
    }
    let longest = errors.into_iter().max_by_key(|(length, _)| *length).map(|(_, error)| error);
    let none = || longest.unwrap_or_else(|| ContentError::value(None, "sheets", "empty", "one with a table"));
    let (content, name, text) = found.pop().ok_or_else(none)?;
    Ok((content, text, ReadingNote { text: format!("sheet {name}"), assumed: false }))
}

/// What `read` makes of the bytes of a file: of themselves, or of the only sheet that it can read of a workbook, whose
/// `sheets` are given; then with the text of that and a note of its name.
///
/// # Errors
/// Those of `read`, of several sheets that of the longest; or where several can be read.
pub fn text_or_sheet<T>(
    bytes: &[u8],
    sheets: Option<Result<Sheets, ContentError>>,
    read: impl Fn(&[u8]) -> Result<T, ContentError>,
) -> Result<(T, Option<(String, ReadingNote)>), ContentError> {
    let Some(sheets) = sheets else { return Ok((read(bytes)?, None)) };
    let sheets = sheets?;
    let (content, text, note) = only_sheet(&sheets, read)?;
    Ok((content, Some((text.to_owned(), note))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_only_sheet_that_can_be_read_is_meant() {
        let number = |bytes: &[u8]| {
            let text = str::from_utf8(bytes).unwrap();
            text.trim().parse::<f64>().map_err(|_| ContentError::value(Some(2), "x", text, "one"))
        };
        let of = |texts: &[(&str, &str)]| {
            let sheets: Sheets = texts.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect();
            text_or_sheet(b"", Some(Ok(sheets)), number).map_err(|error| error.within("t".as_ref()))
        };
        let (content, sheet) = of(&[("a", "words"), ("b", "1.5\n"), ("c", " \n")]).unwrap();
        let (text, note) = sheet.unwrap();
        assert_eq!((content, text.as_str(), note.text.as_str()), (1.5, "1.5\n", "sheet b"));
        assert_eq!(of(&[("a", "1"), ("b", "2")]).unwrap_err(), "t: sheets = a, b: expected one with such a table");
        assert_eq!(of(&[("a", "x"), ("b", "words")]).unwrap_err(), "t:2: sheet b: x = words: expected one");
        assert_eq!(of(&[("a", "")]).unwrap_err(), "t: sheets = empty: expected one with a table");
        assert_eq!(text_or_sheet(b"2", None, number).unwrap(), (2.0, None));
    }
}
