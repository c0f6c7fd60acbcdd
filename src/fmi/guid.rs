//! What the FMU is, as a GUID: the same on every build, another one for anything that would run differently.

use std::fs;
use std::path::Path;

use uuid::Uuid;

use crate::scene::Scene;

use super::catalogue::Catalogue;
use super::fault::Fault;
use super::subject::Subject;

/// The bytes that a scene or a table is read from, as an FMU carries them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sources {
    /// Its own file, then every file that it reads, in the scene's order.
    files: Vec<Vec<u8>>,
}

impl Sources {
    /// Reads the scene file at `path` and the files of `scene`, which was loaded from it.
    ///
    /// # Errors
    /// Where a file cannot be read.
    pub fn read(path: &Path, scene: &Scene) -> std::io::Result<Self> {
        Self::of(path, &scene.clone().into())
    }

    /// Reads the file at `path` and what else `subject`, which was loaded from it, reads.
    ///
    /// # Errors
    /// Where a file cannot be read.
    pub fn of(path: &Path, subject: &Subject) -> std::io::Result<Self> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut files = vec![fs::read(path)?];
        for file in subject.files() {
            files.push(subject.carried(folder, file)?);
        }
        Ok(Self { files })
    }

    pub(super) fn read_from(path: &Path, subject: &Subject) -> Result<Self, Fault> {
        Self::of(path, subject).map_err(|source| Fault::Unreadable { path: path.into(), source })
    }
}

/// The GUID of the FMU made from `sources`: a UUID of version 5 over the program's version, the bytes of every source
/// and the list of variables.
pub fn guid(sources: &Sources, catalogue: &Catalogue) -> String {
    let mut content = Vec::new();
    append(&mut content, env!("CARGO_PKG_VERSION").as_bytes());
    for file in &sources.files {
        append(&mut content, file);
    }
    for (reference, entry) in catalogue.entries() {
        append(&mut content, format!("{reference} {} {}", entry.name(), entry.kind()).as_bytes());
    }
    let namespace = Uuid::new_v5(&Uuid::NAMESPACE_URL, env!("CARGO_PKG_NAME").as_bytes());
    format!("{{{}}}", Uuid::new_v5(&namespace, &content))
}

/// The length before the bytes keeps two files from passing for two others with the same bytes in a row.
fn append(content: &mut Vec<u8>, bytes: &[u8]) {
    content.extend((bytes.len() as u64).to_le_bytes());
    content.extend(bytes);
}
