//! The zip archive of an FMU.

use std::collections::BTreeMap;
use std::io::{Cursor, Write as _};

use zip::result::ZipResult;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// A file of the archive.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ArchiveEntry {
    /// Its path, with forward slashes.
    name: String,
    bytes: Vec<u8>,
    /// Some systems want shared libraries to be executable.
    executable: bool,
}

impl ArchiveEntry {
    /// A file that is not executable.
    pub(super) fn new(name: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        Self { name: name.into(), bytes: bytes.into(), executable: false }
    }

    /// Its path, with forward slashes.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// A file that is executable.
    pub(super) fn executable(name: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        Self { executable: true, ..Self::new(name, bytes) }
    }
}

/// Packs `entries`, ordered by name and dated 1980-01-01: the same entries give the same bytes. Of entries of one name,
/// which a scene has that names a file twice, the last is kept.
pub(super) fn zip(entries: Vec<ArchiveEntry>) -> ZipResult<Vec<u8>> {
    let sorted: BTreeMap<String, ArchiveEntry> = entries.into_iter().map(|entry| (entry.name.clone(), entry)).collect();
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for entry in sorted.values() {
        writer.start_file(entry.name.as_str(), options(entry))?;
        writer.write_all(&entry.bytes)?;
    }
    Ok(writer.finish()?.into_inner())
}

fn options(entry: &ArchiveEntry) -> SimpleFileOptions {
    SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .unix_permissions(if entry.executable { 0o755 } else { 0o644 })
}

#[cfg(test)]
mod tests {
    use zip::ZipArchive;

    use super::*;

    #[test]
    fn the_order_of_the_entries_makes_no_difference() {
        let [a, b] = ["a", "b"].map(|name| ArchiveEntry::new(name, name.repeat(1000)));
        let packed = zip(vec![a.clone(), b.clone()]).unwrap();
        assert_eq!(packed, zip(vec![b, a]).unwrap());
    }

    #[test]
    fn entries_are_plain_files_that_any_reader_can_unpack() {
        let library = ArchiveEntry::executable("a", [7; 1000]);
        let packed = zip(vec![library, ArchiveEntry::new("b", [])]).unwrap();
        let mut archive = ZipArchive::new(Cursor::new(&packed)).unwrap();
        for (i, mode) in [0o755, 0o644].into_iter().enumerate() {
            let file = archive.by_index(i).unwrap();
            assert!(matches!(file.compression(), CompressionMethod::Stored | CompressionMethod::Deflated));
            assert_eq!((file.is_file(), file.is_symlink()), (true, false));
            assert_eq!(file.unix_mode().map(|mode| mode & 0o777), Some(mode));
            let header = &packed[usize::try_from(file.header_start()).unwrap()..];
            assert_eq!(&header[4..6], &[20, 0], "version needed to extract is 2.0");
            assert_eq!(&header[10..14], &[0, 0, 0x21, 0], "1980-01-01, 00:00");
        }
    }
}
