//! Workbooks of spreadsheets as text, which is then read like any other.
//!
//! A few bytes may unpack into all memory, and two cells may span a billion empty ones. What is unpacked is bounded, and
//! cells are kept one by one, never as the rectangle that they span.

use std::collections::BTreeMap;
use std::io::{Cursor, Read as _, copy, sink};
use std::path::Path;

use calamine::{Data, DataRef, Ods, Range, Reader as _, Xls, Xlsb, Xlsx};
use quick_xml::events::{BytesStart, Event};
use zip::ZipArchive;

/// The endings of workbooks.
const ENDINGS: [&str; 5] = ["xlsx", "xls", "xlsm", "xlsb", "ods"];
/// How an archive begins, and how an old workbook of Excel does.
const ARCHIVE: &[u8] = b"PK\x03\x04";
const OLD: &[u8] = b"\xd0\xcf\x11\xe0";
/// The most bytes that the parts of a workbook unpack into.
const MOST_BYTES: u64 = 1 << 27;
/// The most cells of a sheet.
const MOST_CELLS: u64 = 1_000_000;

/// Whether bytes are those of a workbook: a zip archive or an old one of Excel.
pub fn is_workbook(bytes: &[u8], path: &Path) -> bool {
    let named = path.extension().is_some_and(|ending| ENDINGS.iter().any(|known| ending.eq_ignore_ascii_case(known)));
    named || bytes.starts_with(ARCHIVE) || bytes.starts_with(OLD)
}

/// A workbook cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum WorkbookError {
    /// Its content is not what it should be.
    #[error(transparent)]
    Content(#[from] calamine::Error),
    /// It is no archive that can be unpacked.
    #[error("it cannot be unpacked: {0}")]
    Archive(#[from] zip::result::ZipError),
    /// A part of it cannot be unpacked.
    #[error("{part} cannot be unpacked: {source}")]
    Part {
        /// Its name.
        part: String,
        /// What is wrong.
        source: std::io::Error,
    },
    /// The sheets of an OpenDocument are no XML.
    #[error("content.xml: {0}")]
    Sheets(#[from] quick_xml::Error),
    /// It unpacks into too much.
    #[error("it unpacks into more than {} MB: expected at most that; export the sheet as CSV", MOST_BYTES >> 20)]
    TooLong,
    /// A sheet has too many cells.
    #[error("sheet {0} has more than {MOST_CELLS} cells: expected at most that; export it as CSV")]
    TooManyCells(String),
}

/// The sheets as lines with tabs: name and text. Lines count as in the sheet. Of a formula the value is taken that was
/// stored with it; one without is given as it stands, behind a sign of equality.
///
/// # Errors
/// Where the bytes are no workbook, a sheet cannot be read, or there is more in it than can be meant.
pub fn sheets(bytes: &[u8]) -> Result<Vec<(String, String)>, WorkbookError> {
    if !bytes.starts_with(ARCHIVE) {
        return old_sheets(bytes);
    }
    let parts = checked_parts(bytes)?;
    let has = |part: &str| parts.iter().any(|name| name == part);
    if has("content.xml") {
        return ods_sheets(bytes);
    }
    if has("xl/workbook.bin") { xlsb_sheets(bytes) } else { xlsx_sheets(bytes) }
}

/// The names of an archive's parts, which together unpack into no more than is allowed, whatever sizes it states.
fn checked_parts(bytes: &[u8]) -> Result<Vec<String>, WorkbookError> {
    let mut archive = ZipArchive::new(Cursor::new(bytes))?;
    let (mut names, mut left) = (Vec::new(), MOST_BYTES);
    for index in 0..archive.len() {
        let part = archive.by_index(index)?;
        let name = part.name().map_or_else(|_| String::new(), |name| name.replace('\\', "/"));
        let unpacked = copy(&mut part.take(left + 1), &mut sink());
        let unpacked = unpacked.map_err(|source| WorkbookError::Part { part: name.clone(), source })?;
        left = left.checked_sub(unpacked).ok_or(WorkbookError::TooLong)?;
        names.push(name);
    }
    Ok(names)
}

/// The cells of a sheet by their places, row by row.
#[derive(Debug, Default)]
struct Sheet {
    rows: BTreeMap<u32, BTreeMap<u32, String>>,
    cells: u64,
    bytes: u64,
}

impl Sheet {
    /// Adds a cell of the sheet called `name`.
    fn add(&mut self, name: &str, (row, column): (u32, u32), text: String) -> Result<(), WorkbookError> {
        if text.is_empty() {
            return Ok(());
        }
        self.cells += 1;
        self.bytes += text.len() as u64;
        self.rows.entry(row).or_default().insert(column, text);
        let is_allowed = self.cells <= MOST_CELLS && self.bytes <= MOST_BYTES;
        if is_allowed { Ok(()) } else { Err(WorkbookError::TooManyCells(name.to_owned())) }
    }

    /// The cells as lines with tabs, which are counted before they are written.
    fn text(&self, name: &str) -> Result<String, WorkbookError> {
        let last = |cells: &BTreeMap<u32, String>| cells.last_key_value().map_or(0, |(column, _)| u64::from(*column));
        let gaps = self.rows.last_key_value().map_or(0, |(row, _)| u64::from(*row))
            + self.rows.values().map(last).sum::<u64>();
        if gaps > MOST_BYTES {
            return Err(WorkbookError::TooManyCells(name.to_owned()));
        }
        let (mut text, mut line) = (String::new(), 0);
        for (row, cells) in &self.rows {
            (line..*row).for_each(|_| text.push('\n'));
            line = *row;
            let mut at = 0;
            for (column, cell) in cells {
                (at..*column).for_each(|_| text.push('\t'));
                at = *column;
                text += cell;
            }
        }
        text.push('\n');
        Ok(text)
    }
}

fn xlsx_sheets(bytes: &[u8]) -> Result<Vec<(String, String)>, WorkbookError> {
    let error = |error| WorkbookError::Content(calamine::Error::Xlsx(error));
    let mut workbook = Xlsx::new(Cursor::new(bytes)).map_err(error)?;
    let names = workbook.sheet_names();
    let read = |name: String| {
        let mut sheet = Sheet::default();
        let mut cells = workbook.worksheet_cells_reader(&name).map_err(error)?;
        while let Some(found) = cells.next_cell_with_formula().map_err(error)? {
            let text = match (found.value, found.formula) {
                (DataRef::Empty, Some(formula)) => format!("={formula}"),
                (value, _) => text_of(&value.into()),
            };
            sheet.add(&name, found.pos, text)?;
        }
        sheet.text(&name).map(|text| (name, text))
    };
    names.into_iter().map(read).collect()
}

fn xlsb_sheets(bytes: &[u8]) -> Result<Vec<(String, String)>, WorkbookError> {
    let error = |error| WorkbookError::Content(calamine::Error::Xlsb(error));
    let mut workbook = Xlsb::new(Cursor::new(bytes)).map_err(error)?;
    let names = workbook.sheet_names();
    let read = |name: String| {
        let mut sheet = Sheet::default();
        let mut cells = workbook.worksheet_cells_reader(&name).map_err(error)?;
        while let Some(found) = cells.next_cell().map_err(error)? {
            sheet.add(&name, found.get_position(), text_of(&Data::from(found.get_value().clone())))?;
        }
        sheet.text(&name).map(|text| (name, text))
    };
    names.into_iter().map(read).collect()
}

fn ods_sheets(bytes: &[u8]) -> Result<Vec<(String, String)>, WorkbookError> {
    let mut content = String::new();
    let mut archive = ZipArchive::new(Cursor::new(bytes))?;
    let read = archive.by_name("content.xml")?.read_to_string(&mut content);
    read.map_err(|source| WorkbookError::Part { part: "content.xml".to_owned(), source })?;
    check_spans(&content)?;
    let error = |error| WorkbookError::Content(calamine::Error::Ods(error));
    let mut workbook = Ods::new(Cursor::new(bytes)).map_err(error)?;
    let names = workbook.sheet_names();
    names.into_iter().map(|name| of_range(&workbook.worksheet_range(&name).map_err(error)?, name)).collect()
}

/// Checks the rectangle of each sheet of an OpenDocument, whose rows and cells say how often they are repeated: its reader
/// makes all of it.
fn check_spans(content: &str) -> Result<(), WorkbookError> {
    let mut reader = quick_xml::Reader::from_str(content);
    let (mut rows, mut column, mut widest) = (0_u64, 0_u64, 0_u64);
    loop {
        let event = reader.read_event()?;
        let element = match &event {
            Event::Start(element) | Event::Empty(element) => element,
            Event::Eof => return Ok(()),
            _ => continue,
        };
        match element.name().0 {
            "table:table" => (rows, widest) = (0, 0),
            "table:table-row" => {
                rows = rows.saturating_add(repeats(element, "table:number-rows-repeated"));
                column = 0;
            }
            "table:table-cell" | "table:covered-table-cell" => {
                column = column.saturating_add(repeats(element, "table:number-columns-repeated"));
                if holds_value(element) {
                    widest = widest.max(column);
                    if widest.saturating_mul(rows) > MOST_CELLS {
                        return Err(WorkbookError::TooManyCells("of the OpenDocument".to_owned()));
                    }
                }
            }
            _ => (),
        }
    }
}

fn repeats(element: &BytesStart<'_>, key: &str) -> u64 {
    let found = element.attributes().flatten().find(|attribute| attribute.key.0 == key);
    found.and_then(|attribute| attribute.value.parse().ok()).unwrap_or(1)
}

fn holds_value(element: &BytesStart<'_>) -> bool {
    let of_value = ["office:", "calcext:", "table:formula"];
    element.attributes().flatten().any(|attribute| of_value.iter().any(|key| attribute.key.0.starts_with(key)))
}

fn old_sheets(bytes: &[u8]) -> Result<Vec<(String, String)>, WorkbookError> {
    let error = |error| WorkbookError::Content(calamine::Error::Xls(error));
    let mut workbook = Xls::new(Cursor::new(bytes)).map_err(error)?;
    let names = workbook.sheet_names();
    names.into_iter().map(|name| of_range(&workbook.worksheet_range(&name).map_err(error)?, name)).collect()
}

/// The text of a sheet that was read as a rectangle.
fn of_range(range: &Range<Data>, name: String) -> Result<(String, String), WorkbookError> {
    let (above, before) = range.start().unwrap_or_default();
    let mut sheet = Sheet::default();
    for (row, column, value) in range.used_cells() {
        sheet.add(&name, (above + row as u32, before + column as u32), text_of(value))?;
    }
    sheet.text(&name).map(|text| (name, text))
}

/// A number with more or less than three decimals, which could be taken for thousands.
fn decimal(number: f64) -> String {
    let text = format!("{number:?}");
    let is_doubtful = text.split_once('.').is_some_and(|(_, decimals)| decimals.len() == 3);
    if is_doubtful { text + "0" } else { text }
}

fn text_of(value: &Data) -> String {
    match value {
        Data::Float(number) => decimal(*number),
        Data::Int(number) => number.to_string(),
        Data::String(text) => text.replace(['\t', '\n', '\r'], " "),
        Data::Bool(value) => value.to_string(),
        Data::DateTime(time) => format!("at {time}"),
        Data::DateTimeIso(text) | Data::DurationIso(text) => text.clone(),
        Data::Error(_) => "#N/A".into(),
        Data::Empty => String::new(),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::io::Write as _;

    use zip::write::{SimpleFileOptions, ZipWriter};

    use super::*;

    fn archive(parts: &[(&str, &str)]) -> Vec<u8> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, content) in parts {
            writer.start_file(*name, SimpleFileOptions::default()).unwrap();
            writer.write_all(content.as_bytes()).unwrap();
        }
        writer.finish().unwrap().into_inner()
    }

    /// A workbook of one sheet with these rows.
    fn xlsx(rows: &str) -> Vec<u8> {
        let relations = "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
            <Relationship Id=\"r1\" Type=\"http://schemas.openxmlformats.org/officeDocument/2006/relationships/worksheet\" \
            Target=\"worksheets/sheet1.xml\"/></Relationships>";
        let workbook = "<workbook xmlns=\"http://schemas.openxmlformats.org/spreadsheetml/2006/main\" \
            xmlns:r=\"http://schemas.openxmlformats.org/officeDocument/2006/relationships\"><sheets>\
            <sheet name=\"one\" sheetId=\"1\" r:id=\"r1\"/></sheets></workbook>";
        let sheet = format!(
            "<worksheet xmlns=\"http://schemas.openxmlformats.org/spreadsheetml/2006/main\"><sheetData>{rows}</sheetData>\
             </worksheet>"
        );
        let root = "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
            <Relationship Id=\"r1\" Type=\"http://schemas.openxmlformats.org/officeDocument/2006/relationships/\
            officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>";
        archive(&[
            ("_rels/.rels", root),
            ("xl/_rels/workbook.xml.rels", relations),
            ("xl/workbook.xml", workbook),
            ("xl/worksheets/sheet1.xml", &sheet),
        ])
    }

    fn ods(rows: &str) -> Vec<u8> {
        let content = format!(
            "<office:document-content><office:body><office:spreadsheet><table:table table:name=\"one\">{rows}\
             </table:table></office:spreadsheet></office:body></office:document-content>"
        );
        archive(&[
            ("mimetype", "application/vnd.oasis.opendocument.spreadsheet"),
            ("META-INF/manifest.xml", "<manifest:manifest/>"),
            ("content.xml", &content),
        ])
    }

    fn text(bytes: &[u8]) -> String {
        let mut sheets = sheets(bytes).unwrap();
        assert_eq!((sheets.len(), sheets[0].0.as_str()), (1, "one"));
        sheets.remove(0).1
    }

    #[test]
    fn cells_far_apart_are_kept_one_by_one() {
        let cells = text(&xlsx(
            "<row r=\"1\"><c r=\"A1\"><v>1</v></c></row><row r=\"1048576\"><c r=\"XFD1048576\"><v>2</v></c></row>",
        ));
        let lines: Vec<&str> = cells.lines().collect();
        assert_eq!((lines.len(), lines[0], lines[1], lines[1_048_575].len()), (1 << 20, "1.0", "", 16383 + 3));
    }

    #[test]
    fn formulas_have_their_values_or_stand_as_they_are() {
        let cells = "<row r=\"2\"><c r=\"B2\"><f>A1*2</f><v>7.125</v></c><c r=\"C2\" t=\"str\"><f>A1</f><v>x</v></c>\
                     <c r=\"D2\"><f>A1*3</f></c><c r=\"E2\" t=\"e\"><f>1/0</f><v>#DIV/0!</v></c></row>";
        assert_eq!(text(&xlsx(cells)), "\n\t7.1250\tx\t=A1*3\t#N/A\n");
    }

    #[test]
    fn what_unpacks_into_all_memory_is_refused() {
        let long = archive(&[("xl/sharedStrings.xml", &"x".repeat((MOST_BYTES + 1) as usize))]);
        assert!(long.len() < 1 << 20 && matches!(sheets(&long), Err(WorkbookError::TooLong)));
        let number = "<table:table-cell office:value-type=\"float\" office:value=\"1\"/>";
        let row = format!("<table:table-row>{number}</table:table-row>");
        let empty = "<table:table-row table:number-rows-repeated=\"900000\"><table:table-cell \
                     table:number-columns-repeated=\"16384\"/></table:table-row>";
        assert_eq!(text(&ods(&format!("{row}{empty}"))), "1.0\n");
        let far = format!("{empty}<table:table-row>{number}{number}</table:table-row>");
        assert!(matches!(sheets(&ods(&far)), Err(WorkbookError::TooManyCells(_))));
        let many = "<table:table-row table:number-rows-repeated=\"1000\"><table:table-cell office:value-type=\"float\" \
                    office:value=\"1\" table:number-columns-repeated=\"1001\"/></table:table-row>";
        assert!(matches!(sheets(&ods(many)), Err(WorkbookError::TooManyCells(_))));
    }
}
