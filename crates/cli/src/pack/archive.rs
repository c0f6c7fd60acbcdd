//! The zip archive of an FMU: its entries, the shared libraries among them, and their packing.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};

use object::Endianness;
use object::elf::FileHeader64;
use object::read::elf::FileHeader as _;
use zip::result::{ZipError, ZipResult};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::files::{FileError, read};

#[derive(Debug, thiserror::Error)]
pub enum ArchiveError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(
        "no shared library at {}: build it with `cargo rustc --release --lib --no-default-features --crate-type \
         cdylib` and name it with --library, or use build-fmu.sh, which does both",
        .path.display()
    )]
    NoLibrary { path: PathBuf },
    #[error("--library: two of {platform}: {} and {}", .first.display(), .second.display())]
    SamePlatform { platform: &'static str, first: PathBuf, second: PathBuf },
    #[error("cannot pack: {0}")]
    Zip(#[from] ZipError),
}

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

/// A platform as FMI 2.0 names it.
#[derive(Debug, PartialEq)]
struct Platform {
    /// Its folder in `binaries/`.
    folder: &'static str,
    /// The extension of its shared libraries.
    extension: &'static str,
}

const LINUX: Platform = Platform { folder: "linux64", extension: "so" };
const WINDOWS: Platform = Platform { folder: "win64", extension: "dll" };
const MACOS: Platform = Platform { folder: "darwin64", extension: "dylib" };

/// The platform that this program was built for.
const HOST: Platform = if cfg!(target_os = "windows") {
    WINDOWS
} else if cfg!(target_os = "macos") {
    MACOS
} else {
    LINUX
};

/// The files of the shared libraries.
pub(super) fn libraries(arguments: &[OsString]) -> Vec<PathBuf> {
    if arguments.is_empty() { vec![default_library()] } else { arguments.iter().map(|one| library(one).1).collect() }
}

/// The entries of the shared libraries that `--library` names; by default of the one beside this program.
pub(super) fn binaries(identifier: &str, arguments: &[OsString]) -> Result<Vec<ArchiveEntry>, ArchiveError> {
    let mut libraries: Vec<_> = arguments.iter().map(library).collect();
    if libraries.is_empty() {
        libraries.push((HOST, default_library()));
    }
    check_platforms(&libraries)?;
    libraries.iter().map(|(platform, path)| binary(identifier, platform, path)).collect()
}

/// The platform of a shared library in an FMU, and the version of glibc that it asks for, as in "linux64: glibc 2.17".
pub(super) fn needs(entry: &ArchiveEntry) -> Option<String> {
    let platform = entry.name.strip_prefix("binaries/")?.split('/').next()?;
    let version = newest_glibc(&entry.bytes)?.iter().map(u32::to_string).collect::<Vec<_>>().join(".");
    Some(format!("{platform}: glibc {version} or later"))
}

/// The newest version of glibc among those that an ELF file's symbols are of.
fn newest_glibc(elf: &[u8]) -> Option<Vec<u32>> {
    let header = FileHeader64::<Endianness>::parse(elf).ok()?;
    let endian = header.endian().ok()?;
    let sections = header.sections(endian, elf).ok()?;
    let (mut files, strings) = sections.gnu_verneed(endian, elf).ok()??;
    let strings = sections.strings(endian, elf, strings).ok()?;
    let mut newest = None;
    while let Some((_, mut versions)) = files.next().ok()? {
        while let Some(version) = versions.next().ok()? {
            let name = std::str::from_utf8(version.name(endian, strings).ok()?).ok()?;
            // Private symbols have no number.
            let numbers = name.strip_prefix("GLIBC_").map(|name| name.split('.').map(str::parse).collect());
            newest = newest.max(numbers.and_then(Result::ok));
        }
    }
    newest
}

/// `PLATFORM=PATH`, or a path alone for this program's platform.
fn library(argument: &OsString) -> (Platform, PathBuf) {
    let named = argument.to_str().and_then(|text| text.split_once('=')).and_then(|(name, path)| {
        let platform = [LINUX, WINDOWS, MACOS].into_iter().find(|platform| platform.folder == name);
        platform.map(|platform| (platform, path.into()))
    });
    named.unwrap_or_else(|| (HOST, argument.into()))
}

/// The library that cargo builds beside this program.
fn default_library() -> PathBuf {
    let name = format!("{}asperity.{}", std::env::consts::DLL_PREFIX, HOST.extension);
    std::env::current_exe().unwrap_or_default().with_file_name(name)
}

/// Each platform may have one library.
fn check_platforms(libraries: &[(Platform, PathBuf)]) -> Result<(), ArchiveError> {
    for (i, (platform, second)) in libraries.iter().enumerate() {
        if let Some((_, first)) = libraries[..i].iter().find(|(other, _)| other == platform) {
            let (first, second) = (first.clone(), second.clone());
            return Err(ArchiveError::SamePlatform { platform: platform.folder, first, second });
        }
    }
    Ok(())
}

fn binary(identifier: &str, platform: &Platform, path: &Path) -> Result<ArchiveEntry, ArchiveError> {
    if !path.is_file() {
        return Err(ArchiveError::NoLibrary { path: path.to_owned() });
    }
    let name = format!("binaries/{}/{identifier}.{}", platform.folder, platform.extension);
    Ok(ArchiveEntry { executable: true, ..ArchiveEntry::new(name, read(path)?) })
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
        let library = ArchiveEntry { executable: true, ..ArchiveEntry::new("a", [7; 1000]) };
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

    #[test]
    fn a_library_is_this_platforms_unless_another_is_named() {
        let library = |text: &str| library(&text.into());
        assert_eq!(library("a/b.so"), (HOST, "a/b.so".into()));
        assert_eq!(library("win64=a/b.dll"), (WINDOWS, "a/b.dll".into()));
        assert_eq!(library("a=b/c.so"), (HOST, "a=b/c.so".into()));
    }

    /// The program itself is linked against one.
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    #[test]
    fn the_newest_glibc_is_read_from_the_file() {
        let own = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let version = newest_glibc(&own).unwrap();
        assert!(version >= vec![2, 17] && version < vec![3], "{version:?}");
        assert_eq!(newest_glibc(b"MZ"), None);
        assert_eq!(newest_glibc(&own[..100]), None);
    }

    #[test]
    fn a_platform_has_one_library() {
        let two = [(WINDOWS, "a".into()), (LINUX, "b".into()), (WINDOWS, "c".into())];
        let text = check_platforms(&two).unwrap_err().to_string();
        assert_eq!(text, "--library: two of win64: a and c");
        assert!(check_platforms(&two[..2]).is_ok());
    }
}
