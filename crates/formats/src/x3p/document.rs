//! The container of an X3P file: the zip archive, its document `main.xml` and what that says of the points. What is
//! read is bounded: a few bytes may unpack into all memory.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{Cursor, Read};

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use zip::ZipArchive;
use zip::read::ZipFile;

use asperity::tables::{ANY, ContentError};

use crate::text::{NotText, decode};

/// The longest document, bytes: heights inline of some million points.
const LONGEST_MAIN: u64 = 1 << 27;

pub(super) struct Archive<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
    /// The paths of the entries with forward slashes; empty where one is none.
    names: Vec<String>,
    /// Where `main.xml` stands among them.
    main: usize,
}

impl<'a> Archive<'a> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, ContentError> {
        let zip = ZipArchive::new(Cursor::new(bytes)).map_err(|error| unreadable("the archive", &error))?;
        let names: Vec<String> =
            zip.file_names().map(|name| name.map_or_else(|_| String::new(), |name| plain(&name))).collect();
        let is_main = |name: &&String| base(name).eq_ignore_ascii_case("main.xml");
        // Of several, the one that lies highest.
        let depth = |name: &&String| name.matches('/').count();
        let found = names.iter().filter(is_main).min_by_key(depth);
        let main = found.and_then(|main| names.iter().position(|name| name == main));
        let main = main.ok_or_else(|| other_archive(&names))?;
        Ok(Self { zip, names, main })
    }

    pub(super) fn main(&mut self) -> Result<String, ContentError> {
        let file = self.zip.by_index(self.main).map_err(|error| unreadable("main.xml", &error))?;
        let mut bytes = Vec::new();
        file.take(LONGEST_MAIN + 1).read_to_end(&mut bytes).map_err(|error| unreadable("main.xml", &error))?;
        if bytes.len() as u64 > LONGEST_MAIN {
            return Err(ContentError::value(None, "main.xml", "too long", &format!("at most {LONGEST_MAIN} bytes")));
        }
        let text = decode(&bytes).map_err(|_| ContentError::value(None, "main.xml", NotText::FOUND, NotText::EXPECTED));
        text.map(Cow::into_owned)
    }

    /// The entry that the document links to: beside it, or wherever its path ends so.
    pub(super) fn linked(&mut self, link: &str) -> Result<ZipFile<'_, Cursor<&'a [u8]>>, ContentError> {
        let link = plain(link);
        let main = &self.names[self.main];
        let beside = format!("{}{link}", &main[..main.len() - base(main).len()]);
        let same = |wanted: &str| self.names.iter().position(|name| name.eq_ignore_ascii_case(wanted));
        let index = same(&beside).or_else(|| same(&link));
        let index = index
            .ok_or_else(|| ContentError::value(None, "PointDataLink", &link, "the name of a file of the archive"))?;
        self.zip.by_index(index).map_err(|error| unreadable(&link, &error))
    }
}

/// The error of an archive that is no X3P file, by what it is known to be.
fn other_archive(names: &[String]) -> ContentError {
    const KNOWN: [(&str, &str, &str); 5] = [
        ("xl/workbook.xml", "a workbook (xlsx)", "the sheet of the surface as CSV"),
        ("xl/workbook.bin", "a workbook (xlsb)", "the sheet of the surface as CSV"),
        ("content.xml", "an OpenDocument (ods)", "the sheet of the surface as CSV"),
        ("index.xml", "a file of Sensofar (PLUX)", "the surface as X3P, SDF, SUR or text"),
        ("word/document.xml", "a document of Word", "x and z as text"),
    ];
    let known = KNOWN.iter().find(|(part, ..)| names.iter().any(|name| name.eq_ignore_ascii_case(part)));
    let (given, expected) = match known {
        Some((_, kind, export)) => {
            (format!("{kind}, which is not read"), format!("an X3P file, or text: export {export}"))
        }
        None => ("a zip archive without main.xml".to_owned(), "an X3P file, or text: unpack it".to_owned()),
    };
    ContentError::value(None, "", &given, &expected)
}

pub(super) fn unreadable(what: &str, error: &dyn std::error::Error) -> ContentError {
    ContentError::value(None, what, &error.to_string(), "an archive that can be unpacked")
}

/// A path with forward slashes, from the archive's root.
fn plain(path: &str) -> String {
    let path = path.trim().replace('\\', "/");
    path.split('/').filter(|part| !["", "."].contains(part)).collect::<Vec<_>>().join("/")
}

fn base(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

/// The texts of a document's elements, by the names of parent and element: `CX.Increment`. Prefixes of name spaces are
/// left out.
#[derive(Debug, Default)]
pub(super) struct Document {
    texts: BTreeMap<String, String>,
    /// The points that stand inline, each ended by a line feed.
    points: String,
    inline: bool,
}

/// Elements whose texts are kept are in one of these.
const PARENTS: [&str; 7] = ["Record1", "Record3", "CX", "CY", "CZ", "MatrixDimension", "DataLink"];
/// Elements in each other: a document has five.
const DEEPEST: usize = 32;
/// Letters of a text: those of the document are shorter.
const LONGEST_TEXT: usize = 4096;

impl Document {
    pub(super) fn parse(text: &str) -> Result<Self, ContentError> {
        let wrong = |reason: &str| ContentError::value(None, "main.xml", reason, "XML of an X3P file");
        let mut reader = Reader::from_str(text);
        let mut walk = Walk::default();
        loop {
            match reader.read_event().map_err(|error| wrong(&error.to_string()))? {
                Event::Start(start) => walk.enter(&start).map_err(wrong)?,
                Event::Empty(start) => {
                    walk.enter(&start).map_err(wrong)?;
                    walk.leave();
                }
                Event::End(_) => walk.leave(),
                Event::Text(text) => walk.add(&text),
                Event::CData(text) => walk.add(&text),
                Event::Eof => break,
                _ => (),
            }
        }
        if walk.names.is_empty() { Ok(walk.document) } else { Err(wrong("an element without an end")) }
    }

    /// Whether the heights stand in the document.
    pub(super) fn is_inline(&self) -> bool {
        self.inline
    }

    /// The points of an inline list, as they are written.
    pub(super) fn points(&self) -> impl Iterator<Item = &str> {
        self.points.lines()
    }

    /// The text of an element that is not empty.
    pub(super) fn text(&self, key: &str) -> Option<&str> {
        self.texts.get(key).map(|text| text.trim()).filter(|text| !text.is_empty())
    }

    pub(super) fn whole(&self, key: &str) -> Result<Option<usize>, ContentError> {
        let number = |text: &str| text.parse().map_err(|_| ContentError::value(None, key, text, "a whole number"));
        self.text(key).map(number).transpose()
    }

    pub(super) fn number(&self, key: &str) -> Result<Option<f64>, ContentError> {
        let number = |text: &str| {
            let number = text.parse().ok().filter(|number| ANY.holds(*number));
            number.ok_or_else(|| ContentError::value(None, key, text, &ANY.to_string()))
        };
        self.text(key).map(number).transpose()
    }

    pub(super) fn required(&self, key: &str) -> Result<&str, ContentError> {
        self.text(key).ok_or_else(|| missing(key))
    }
}

/// The position in a document that is being read.
#[derive(Default)]
struct Walk {
    document: Document,
    names: Vec<String>,
    text: String,
}

impl Walk {
    fn enter(&mut self, start: &BytesStart<'_>) -> Result<(), &'static str> {
        if self.names.len() == DEEPEST {
            return Err("elements too deep in each other");
        }
        let name = start.local_name().as_ref().to_owned();
        self.document.inline |= name == "DataList";
        self.names.push(name);
        self.text.clear();
        Ok(())
    }

    fn add(&mut self, text: &str) {
        if self.text.len() + text.len() <= LONGEST_TEXT {
            self.text.push_str(text);
        }
    }

    fn leave(&mut self) {
        let (Some(name), parent) = (self.names.pop(), self.names.last()) else { return };
        let parent = parent.map_or("", |parent| parent);
        if parent == "DataList" {
            self.document.points.extend(self.text.trim().chars().filter(|letter| !letter.is_control()));
            self.document.points.push('\n');
        } else if PARENTS.contains(&parent) {
            self.document.texts.insert(format!("{parent}.{name}"), std::mem::take(&mut self.text));
        }
        self.text.clear();
    }
}

/// The most points of a measurement: more than 16 000 by 16 000.
const MAX_POINTS: usize = 1 << 28;
/// The most points of a line.
const MAX_COLUMNS: usize = 1 << 24;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MatrixSize {
    /// Points of a line.
    pub(super) columns: usize,
    /// Number of lines.
    pub(super) rows: usize,
}

impl MatrixSize {
    pub(super) fn new(document: &Document) -> Result<Self, ContentError> {
        let feature = document.text("Record1.FeatureType").unwrap_or("SUR");
        if !["PRF", "SUR"].contains(&feature) {
            return Err(ContentError::value(
                None,
                "FeatureType",
                feature,
                "PRF or SUR, a profile or an areal measurement",
            ));
        }
        let size = match document.whole("Record3.ListDimension")? {
            Some(columns) => Self { columns, rows: 1 },
            None => {
                let size = |key: &str| document.whole(key)?.ok_or_else(|| missing(key));
                let layers = size("MatrixDimension.SizeZ")?;
                if layers != 1 {
                    return Err(ContentError::value(
                        None,
                        "MatrixDimension.SizeZ",
                        &layers.to_string(),
                        "1: one height for each point",
                    ));
                }
                Self { columns: size("MatrixDimension.SizeX")?, rows: size("MatrixDimension.SizeY")? }
            }
        };
        let count = size.columns.checked_mul(size.rows);
        if size.columns <= MAX_COLUMNS && count.is_some_and(|count| (1..=MAX_POINTS).contains(&count)) {
            return Ok(size);
        }
        let given = format!("{} by {} points", size.columns, size.rows);
        let expected = format!("1 to {MAX_POINTS} points, at most {MAX_COLUMNS} of them in a line");
        Err(ContentError::value(None, "MatrixDimension", &given, &expected))
    }

    pub(super) fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// The line, from 0, that was asked for by a number from 1; the middle one where none was.
    pub(super) fn choose(&self, line: Option<usize>) -> Result<usize, ContentError> {
        let rows = self.rows;
        match line {
            None => Ok(rows.div_ceil(2) - 1),
            Some(line) if line <= rows => Ok(line - 1),
            Some(line) => Err(ContentError::value(
                None,
                "line",
                &line.to_string(),
                &format!("a whole number from 1 to {rows}, the lines that there are"),
            )),
        }
    }
}

pub(super) fn missing(key: &str) -> ContentError {
    ContentError::value(None, key, "not there", "an element of main.xml")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_archives_are_named() {
        let message = |part: &str| other_archive(&[part.to_owned()]).to_string();
        assert_eq!(
            message("xl/workbook.xml"),
            "a workbook (xlsx), which is not read: expected an X3P file, or text: export the sheet of the surface as CSV"
        );
        assert!(
            message("index.xml").contains("PLUX") && message("a.csv").starts_with("a zip archive without main.xml")
        );
    }
}
