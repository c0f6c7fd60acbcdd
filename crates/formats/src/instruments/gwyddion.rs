//! The text of a Gwyddion field: a matrix of heights below comments with its size.

use super::{Areal, check_size, check_step, length_unit};
use asperity::tables::ContentError;

use crate::text::decode;

use crate::text::{is_missing, number};

const KIND: &str = "a Gwyddion text file";

/// A matrix below `# Width:` and `# Value units:`.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    let Ok(text) = decode(&bytes[..bytes.len().min(2048)]) else { return false };
    let has = |name: &str| setting(&text, name).is_some();
    has("Width") && has("Height") && (has("Value units") || has("Channel"))
}

fn setting<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let comments = text.lines().take_while(|line| line.starts_with('#'));
    let mut pairs = comments.filter_map(|line| line.trim_start_matches(['#', ' ']).split_once(':'));
    pairs.find(|(key, _)| key.trim().eq_ignore_ascii_case(name)).map(|(_, value)| value.trim())
}

pub(super) fn read(bytes: &[u8]) -> Result<Areal, ContentError> {
    let text = decode(bytes)?;
    let length = |key: &str| {
        let value = setting(&text, key).unwrap_or_default();
        let parted = value.split_once(char::is_whitespace).unwrap_or((value, "m"));
        let number = number(parted.0).filter(|number| *number > 0.0);
        let number =
            number.ok_or_else(|| ContentError::value(None, key, &format!("\"{value}\""), "a length and its unit"))?;
        Ok::<f64, ContentError>(length_unit(key, parted.1)?.to_si(number))
    };
    let unit = length_unit("Value units", setting(&text, "Value units").unwrap_or_default())?;
    let (mut heights, mut columns, mut rows) = (Vec::new(), 0, 0);
    for (line, row) in (1..).zip(text.lines()).filter(|(_, row)| !row.starts_with('#') && !row.trim().is_empty()) {
        let before = heights.len();
        for field in row.split([' ', '\t', ';']).filter(|field| !field.is_empty()) {
            let height = number(field).or_else(|| is_missing(field).then_some(f64::NAN));
            let refuse = || ContentError::value(Some(line), "z", &format!("\"{field}\""), "a height");
            heights.push(unit.to_si(height.ok_or_else(refuse)?));
        }
        rows += 1;
        let found = heights.len() - before;
        if rows > 1 && found != columns {
            return Err(ContentError::value(
                Some(line),
                "columns",
                &found.to_string(),
                &format!("{columns}, as above"),
            ));
        }
        columns = found;
    }
    check_size(KIND, [columns, rows])?;
    // Each height is that of a pixel: as many pixels as heights make the width.
    let spacing = [length("Width")? / columns as f64, length("Height")? / rows as f64];
    Ok(Areal::even(KIND, [columns, rows], [check_step(KIND, spacing[0])?, check_step(KIND, spacing[1])?], heights))
}
