//! Workbooks of spreadsheets as text, which is then read like any other.

use std::io::Cursor;
use std::path::Path;

use calamine::{Data, Reader as _, open_workbook_auto_from_rs};

/// Whether bytes are those of a workbook: a zip archive or an old one of Excel.
pub fn is_workbook(bytes: &[u8], path: &Path) -> bool {
    let named = path.extension().is_some_and(|ending| {
        ["xlsx", "xls", "xlsm", "xlsb", "ods"].iter().any(|known| ending.eq_ignore_ascii_case(known))
    });
    named || bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"\xd0\xcf\x11\xe0")
}

/// A workbook cannot be read.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub struct WorkbookError(#[from] calamine::Error);

/// The sheets as lines with tabs: name and text. Lines count as in the sheet.
///
/// # Errors
/// Where the bytes are no workbook, or a sheet cannot be read.
pub fn sheets(bytes: &[u8]) -> Result<Vec<(String, String)>, WorkbookError> {
    let mut workbook = open_workbook_auto_from_rs(Cursor::new(bytes.to_vec()))?;
    let names = workbook.sheet_names();
    names
        .into_iter()
        .map(|name| {
            let range = workbook.worksheet_range(&name)?;
            let (above, before) = range.start().map_or((0, 0), |(row, column)| (row as usize, column as usize));
            let mut text = "\n".repeat(above);
            for row in range.rows() {
                let cells = std::iter::repeat_n(String::new(), before).chain(row.iter().map(cell));
                text += &(cells.collect::<Vec<_>>().join("\t") + "\n");
            }
            Ok((name, text))
        })
        .collect()
}

fn cell(value: &Data) -> String {
    match value {
        Data::Float(number) => format!("{number:?}"),
        Data::Int(number) => number.to_string(),
        Data::String(text) => text.replace(['\t', '\n', '\r'], " "),
        Data::Bool(value) => value.to_string(),
        Data::DateTime(time) => format!("at {time}"),
        Data::DateTimeIso(text) | Data::DurationIso(text) => text.clone(),
        Data::Error(_) => "#N/A".into(),
        Data::Empty => String::new(),
    }
}
