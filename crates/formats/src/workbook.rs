//! Workbooks of spreadsheets as text, which is then read like any other.
//!
//! A few bytes may unpack into all memory, and two cells may span a billion empty ones. What is unpacked is bounded, and
//! cells are kept one by one, never as the rectangle that they span.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{Cursor, Read as _, copy, sink};

use asperity::tables::ContentError;
use calamine::{Data, DataRef, Ods, Range, Reader as _, Xls, Xlsb, Xlsx};
use quick_xml::events::{BytesStart, Event};
use zip::ZipArchive;

/// How an archive begins, and how an old workbook of Excel does.
const ARCHIVE: &[u8] = b"PK\x03\x04";
const OLD: &[u8] = b"\xd0\xcf\x11\xe0";
/// The most bytes that the parts of a workbook unpack into.
const MOST_BYTES: u64 = 1 << 27;
/// The most cells of a sheet.
const MOST_CELLS: u64 = 1_000_000;

/// Parts that an archive has that is a workbook.
const PARTS: [&str; 3] = ["xl/workbook.xml", "xl/workbook.bin", "content.xml"];

/// Whether bytes are those of a workbook: a zip archive with one's parts, or an old one of Excel.
pub fn is_workbook(bytes: &[u8]) -> bool {
    let has = |archive: ZipArchive<Cursor<&[u8]>>| PARTS.iter().any(|part| archive.index_for_name(part).is_some());
    bytes.starts_with(OLD) || (bytes.starts_with(ARCHIVE) && ZipArchive::new(Cursor::new(bytes)).is_ok_and(has))
}

impl From<WorkbookError> for ContentError {
    fn from(error: WorkbookError) -> Self {
        Self::value(None, "", "a workbook", &format!("one that can be read: {error}"))
    }
}

/// What `read` makes of the only sheet that it can read, and the name of that.
///
/// # Errors
/// [`ContentError`] where none can be read, that of the longest; or several can.
pub fn only_sheet<T>(
    sheets: &[(String, String)],
    read: impl Fn(&[u8]) -> Result<T, ContentError>,
) -> Result<(T, String), ContentError> {
    let (mut found, mut errors) = (Vec::new(), Vec::new());
    for (name, text) in sheets.iter().filter(|(_, text)| !text.trim().is_empty()) {
        match read(text.as_bytes()) {
            Ok(content) => found.push((content, name.clone())),
            Err(error) => errors.push((text.len(), error.in_sheet(name))),
        }
    }
    if found.len() > 1 {
        let names: Vec<&str> = found.iter().map(|(_, name)| name.as_str()).collect();
        return Err(ContentError::value(None, "sheets", &names.join(", "), "one with such a table"));
    }
    let longest = errors.into_iter().max_by_key(|(length, _)| *length).map(|(_, error)| error);
    let none = || longest.unwrap_or_else(|| ContentError::value(None, "sheets", "empty", "one with a table"));
    found.pop().ok_or_else(none)
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

/// The sheets as lines with tabs: name and text. Lines count as in the sheet, and have as many fields. Of a formula the
/// value is taken that was stored with it; one without is given as it stands, behind a sign of equality. A number in per
/// cent is given with its sign, as it is seen.
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
        let last = |cells: &BTreeMap<u32, String>| cells.last_key_value().map_or(0, |(column, _)| *column);
        let width = self.rows.values().map(last).max().unwrap_or(0);
        let gaps = self.rows.last_key_value().map_or(0, |(row, _)| u64::from(*row))
            + self.rows.len() as u64 * u64::from(width);
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
            (at..width).for_each(|_| text.push('\t'));
        }
        text.push('\n');
        Ok(text)
    }
}

fn xlsx_sheets(bytes: &[u8]) -> Result<Vec<(String, String)>, WorkbookError> {
    let error = |error| WorkbookError::Content(calamine::Error::Xlsx(error));
    let mut workbook = Xlsx::new(Cursor::new(bytes)).map_err(error)?;
    let names = workbook.sheet_names();
    let percent = percent_cells(bytes)?;
    let read = |(index, name): (usize, String)| {
        let mut sheet = Sheet::default();
        let mut cells = workbook.worksheet_cells_reader(&name).map_err(error)?;
        while let Some(found) = cells.next_cell_with_formula().map_err(error)? {
            let is_percent = percent.get(index).is_some_and(|cells| cells.contains(&found.pos));
            let text = match (found.value, found.formula) {
                (DataRef::Empty, Some(formula)) => format!("={formula}"),
                (DataRef::Float(number), _) if is_percent => in_percent(number),
                (DataRef::Int(number), _) if is_percent => in_percent(number as f64),
                (value, _) => text_of(&value.into()),
            };
            sheet.add(&name, found.pos, text)?;
        }
        sheet.text(&name).map(|text| (name, text))
    };
    names.into_iter().enumerate().map(read).collect()
}

/// What a number in the format of per cent shows.
fn in_percent(number: f64) -> String {
    // Twelve digits: the rounding of a hundredth is none of the number.
    let shown: f64 = format!("{:.11e}", 100.0 * number).parse().unwrap_or(100.0 * number);
    format!("{}%", decimal(shown))
}

/// The places of the cells in the format of per cent, of each sheet in the order of the workbook.
fn percent_cells(bytes: &[u8]) -> Result<Vec<BTreeSet<(u32, u32)>>, WorkbookError> {
    let mut archive = ZipArchive::new(Cursor::new(bytes))?;
    let mut part = |name: &str| {
        let mut text = String::new();
        let read = archive.by_name(name).ok().map(|mut part| part.read_to_string(&mut text));
        read.and_then(Result::ok).map(|_| text)
    };
    let Some(styles) = part("xl/styles.xml") else { return Ok(Vec::new()) };
    let styles = percent_styles(&styles)?;
    if styles.is_empty() {
        return Ok(Vec::new());
    }
    let (workbook, relations) =
        (part("xl/workbook.xml").unwrap_or_default(), part("xl/_rels/workbook.xml.rels").unwrap_or_default());
    let mut targets = BTreeMap::new();
    each_element(&relations, |element| {
        targets.extend(attribute(element, "Id").zip(attribute(element, "Target")));
    })?;
    let mut ids = Vec::new();
    each_element(&workbook, |element| {
        if element.name().0.rsplit(':').next() == Some("sheet") {
            ids.push(attribute(element, "r:id").unwrap_or_default());
        }
    })?;
    let mut found = Vec::new();
    for id in ids {
        let target = targets.get(&id).cloned().unwrap_or_default();
        let name = target.strip_prefix('/').map_or_else(|| format!("xl/{target}"), str::to_owned);
        let mut cells = BTreeSet::new();
        each_element(&part(&name).unwrap_or_default(), |element| {
            let style = attribute(element, "s").and_then(|style| style.parse().ok());
            if element.name().0 == "c" && style.is_some_and(|style: usize| styles.contains(&style)) {
                cells.extend(attribute(element, "r").and_then(|place| cell_place(&place)));
            }
        })?;
        found.push(cells);
    }
    Ok(found)
}

/// The numbers of the styles of cells that are formats of per cent.
fn percent_styles(styles: &str) -> Result<BTreeSet<usize>, WorkbookError> {
    // 0% and 0.00% are built in.
    let mut formats = BTreeSet::from(["9".to_owned(), "10".to_owned()]);
    let (mut found, mut index, mut is_of_cells) = (BTreeSet::new(), 0, false);
    each_element(styles, |element| match element.name().0 {
        "numFmt" => {
            let code = attribute(element, "formatCode").unwrap_or_default();
            // A sign in quotation marks is a text.
            let is_percent = code.split('"').step_by(2).any(|part| part.replace("\\%", "").contains('%'));
            formats.extend(attribute(element, "numFmtId").filter(|_| is_percent));
        }
        "cellXfs" => is_of_cells = true,
        "cellStyles" | "dxfs" => is_of_cells = false,
        "xf" if is_of_cells => {
            if attribute(element, "numFmtId").is_some_and(|format| formats.contains(&format)) {
                found.insert(index);
            }
            index += 1;
        }
        _ => (),
    })?;
    Ok(found)
}

fn each_element(text: &str, mut see: impl FnMut(&BytesStart<'_>)) -> Result<(), WorkbookError> {
    let mut reader = quick_xml::Reader::from_str(text);
    loop {
        match reader.read_event()? {
            Event::Start(element) | Event::Empty(element) => see(&element),
            Event::Eof => return Ok(()),
            _ => (),
        }
    }
}

fn attribute(element: &BytesStart<'_>, key: &str) -> Option<String> {
    let found = element.attributes().flatten().find(|attribute| attribute.key.0 == key);
    found.map(|attribute| attribute.value.into_owned())
}

/// Row and column, from 0, of `B3`.
fn cell_place(text: &str) -> Option<(u32, u32)> {
    let digits = text.find(|letter: char| letter.is_ascii_digit())?;
    let column = text[..digits].bytes().try_fold(0_u32, |column, letter| {
        column.checked_mul(26)?.checked_add(u32::from(letter.to_ascii_uppercase()).checked_sub(64)?)
    })?;
    Some((text[digits..].parse::<u32>().ok()?.checked_sub(1)?, column.checked_sub(1)?))
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
    let percent = check_spans(&content)?;
    let error = |error| WorkbookError::Content(calamine::Error::Ods(error));
    let mut workbook = Ods::new(Cursor::new(bytes)).map_err(error)?;
    let names = workbook.sheet_names();
    let read = |(index, name): (usize, String)| {
        let range = workbook.worksheet_range(&name).map_err(error)?;
        of_range(&range, name, percent.get(index).unwrap_or(&BTreeSet::new()))
    };
    names.into_iter().enumerate().map(read).collect()
}

/// Checks the rectangle of each sheet of an OpenDocument, whose rows and cells say how often they are repeated: its reader
/// makes all of it. The places of each sheet's cells in the format of per cent.
fn check_spans(content: &str) -> Result<Vec<BTreeSet<(u32, u32)>>, WorkbookError> {
    let (mut top, mut rows, mut column, mut widest) = (0_u64, 0_u64, 0_u64, 0_u64);
    let (mut percent, mut is_too_wide) = (Vec::<BTreeSet<(u32, u32)>>::new(), false);
    each_element(content, |element| match element.name().0 {
        "table:table" => {
            (top, rows, widest) = (0, 0, 0);
            percent.push(BTreeSet::new());
        }
        "table:table-row" => {
            (top, column) = (rows, 0);
            rows = rows.saturating_add(repeats(element, "table:number-rows-repeated"));
        }
        "table:table-cell" | "table:covered-table-cell" => {
            let left = column;
            column = column.saturating_add(repeats(element, "table:number-columns-repeated"));
            if holds_value(element) {
                widest = widest.max(column);
                is_too_wide |= widest.saturating_mul(rows) > MOST_CELLS;
                let is_percent = attribute(element, "office:value-type").is_some_and(|kind| kind == "percentage");
                if let Some(cells) = percent.last_mut().filter(|_| is_percent && !is_too_wide) {
                    let places =
                        (top..rows).flat_map(|row| (left..column).map(move |column| (row as u32, column as u32)));
                    cells.extend(places);
                }
            }
        }
        _ => (),
    })?;
    if is_too_wide { Err(WorkbookError::TooManyCells("of the OpenDocument".to_owned())) } else { Ok(percent) }
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
    let none = BTreeSet::new();
    names.into_iter().map(|name| of_range(&workbook.worksheet_range(&name).map_err(error)?, name, &none)).collect()
}

/// The text of a sheet that was read as a rectangle, of whose cells some are in the format of per cent.
fn of_range(
    range: &Range<Data>,
    name: String,
    percent: &BTreeSet<(u32, u32)>,
) -> Result<(String, String), WorkbookError> {
    let (above, before) = range.start().unwrap_or_default();
    let mut sheet = Sheet::default();
    for (row, column, value) in range.used_cells() {
        let place = (above + row as u32, before + column as u32);
        let text = match value {
            Data::Float(number) if percent.contains(&place) => in_percent(*number),
            value => text_of(value),
        };
        sheet.add(&name, place, text)?;
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
        assert_eq!(
            (lines.len(), lines[0].trim_end(), lines[1], lines[1_048_575].len()),
            (1 << 20, "1.0", "", 16383 + 3)
        );
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
        let percent = "<table:table-cell office:value-type=\"percentage\" office:value=\"0.05\"/>";
        assert_eq!(text(&ods(&format!("<table:table-row>{number}{percent}</table:table-row>"))), "1.0\t5.0%\n");
        let far = format!("{empty}<table:table-row>{number}{number}</table:table-row>");
        assert!(matches!(sheets(&ods(&far)), Err(WorkbookError::TooManyCells(_))));
        let many = "<table:table-row table:number-rows-repeated=\"1000\"><table:table-cell office:value-type=\"float\" \
                    office:value=\"1\" table:number-columns-repeated=\"1001\"/></table:table-row>";
        assert!(matches!(sheets(&ods(many)), Err(WorkbookError::TooManyCells(_))));
    }
}
