//! The zip archive: its document and what the document names. What is read has its bound: a few bytes may unpack into
//! all memory.

use std::io::{Cursor, Read};

use zip::ZipArchive;
use zip::read::ZipFile;

use crate::scene::profile::{ProfileError, refuse};
use crate::scene::text_table::decode;

/// The longest document, bytes: heights inline of some million points.
const LONGEST_MAIN: u64 = 1 << 27;

/// An opened archive.
pub(super) struct Archive<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
    /// The paths of the entries with forward slashes; empty where one is none.
    names: Vec<String>,
    /// Where `main.xml` stands among them.
    main: usize,
}

impl<'a> Archive<'a> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, ProfileError> {
        let zip = ZipArchive::new(Cursor::new(bytes)).map_err(|error| unreadable("the archive", &error))?;
        let names: Vec<String> =
            zip.file_names().map(|name| name.map_or_else(|_| String::new(), |name| plain(&name))).collect();
        let is_main = |name: &&String| base(name).eq_ignore_ascii_case("main.xml");
        // Of several, the one that lies highest.
        let depth = |name: &&String| name.matches('/').count();
        let found = names.iter().filter(is_main).min_by_key(depth);
        let main = found.and_then(|main| names.iter().position(|name| name == main));
        let main = main.ok_or_else(|| refuse(None, "", "a zip archive without main.xml", "an X3P file, or text"))?;
        Ok(Self { zip, names, main })
    }

    /// The document's text.
    pub(super) fn main(&mut self) -> Result<String, ProfileError> {
        let file = self.zip.by_index(self.main).map_err(|error| unreadable("main.xml", &error))?;
        let mut bytes = Vec::new();
        file.take(LONGEST_MAIN + 1).read_to_end(&mut bytes).map_err(|error| unreadable("main.xml", &error))?;
        if bytes.len() as u64 > LONGEST_MAIN {
            return Err(refuse(None, "main.xml", "too long", &format!("at most {LONGEST_MAIN} bytes")));
        }
        let text = decode(&bytes).map_err(|error| ProfileError {
            line: None,
            key: "main.xml".into(),
            problem: error.into(),
        })?;
        Ok(text.into_owned())
    }

    /// The entry that the document links to: beside it, or wherever its path ends so.
    pub(super) fn linked(&mut self, link: &str) -> Result<ZipFile<'_, Cursor<&'a [u8]>>, ProfileError> {
        let link = plain(link);
        let main = &self.names[self.main];
        let beside = format!("{}{link}", &main[..main.len() - base(main).len()]);
        let same = |wanted: &str| self.names.iter().position(|name| name.eq_ignore_ascii_case(wanted));
        let index = same(&beside).or_else(|| same(&link));
        let index = index.ok_or_else(|| refuse(None, "PointDataLink", &link, "the name of a file of the archive"))?;
        self.zip.by_index(index).map_err(|error| unreadable(&link, &error))
    }
}

/// For what cannot be unpacked.
pub(super) fn unreadable(what: &str, error: &dyn std::error::Error) -> ProfileError {
    let reason = error.to_string().replace(['\n', '\r'], " ");
    refuse(None, what, &reason, "an archive that can be unpacked")
}

/// A path with forward slashes, from the archive's root.
fn plain(path: &str) -> String {
    let path = path.trim().replace('\\', "/");
    path.split('/').filter(|part| !["", "."].contains(part)).collect::<Vec<_>>().join("/")
}

/// The last part of a path.
fn base(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}
