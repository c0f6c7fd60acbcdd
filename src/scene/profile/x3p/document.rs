//! `main.xml`: what is measured, how many points there are, and where their heights stand.

use std::collections::BTreeMap;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::missing;
use crate::scene::allowed;
use crate::scene::profile::{ProfileError, refuse};

/// The texts of a document's elements, by the names of parent and element: `CX.Increment`. Prefixes of name spaces are
/// left out.
#[derive(Debug, Default)]
pub(super) struct Document {
    texts: BTreeMap<String, String>,
    /// The points that stand inline, each ended by a line feed.
    points: String,
    /// Whether they do.
    inline: bool,
}

/// Elements whose texts are kept are in one of these.
const PARENTS: [&str; 7] = ["Record1", "Record3", "CX", "CY", "CZ", "MatrixDimension", "DataLink"];
/// Elements in each other: a document has five.
const DEEPEST: usize = 32;
/// Letters of a text: those of the document are shorter.
const LONGEST_TEXT: usize = 4096;

impl Document {
    pub(super) fn parse(text: &str) -> Result<Self, ProfileError> {
        let wrong = |reason: &str| refuse(None, "main.xml", &reason.replace(['\n', '\r'], " "), "XML of an X3P file");
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

    pub(super) fn whole(&self, key: &str) -> Result<Option<usize>, ProfileError> {
        let number = |text: &str| text.parse().map_err(|_| refuse(None, key, text, "a whole number"));
        self.text(key).map(number).transpose()
    }

    pub(super) fn number(&self, key: &str) -> Result<Option<f64>, ProfileError> {
        let number = |text: &str| {
            let number = text.parse().ok().filter(|number| allowed::PLACE.holds(*number));
            number.ok_or_else(|| refuse(None, key, text, &allowed::PLACE.to_string()))
        };
        self.text(key).map(number).transpose()
    }

    pub(super) fn required(&self, key: &str) -> Result<&str, ProfileError> {
        self.text(key).ok_or_else(|| missing(key))
    }
}

/// The way through a document.
#[derive(Default)]
struct Walk {
    document: Document,
    /// The elements that are open.
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
