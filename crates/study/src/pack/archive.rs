//! The zip archive of an FMU, and the shared libraries in it, one a platform.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};

use object::Endianness;
use object::elf::{ET_DYN, FileHeader64, SHT_DYNSYM, SHT_NOBITS};
use object::read::elf::{FileHeader as _, ProgramHeader as _, SectionHeader as _, Sym as _};
use zip::result::ZipResult;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::error::Error;
use crate::files::bytes;

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

    /// Its content.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
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

/// A platform as FMI 2.0 names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Platform {
    /// Its folder in `binaries/`.
    pub folder: &'static str,
    /// The extension of its shared libraries.
    pub extension: &'static str,
}

impl Platform {
    pub(super) const LINUX: Self = Self { folder: "linux64", extension: "so" };
    const WINDOWS: Self = Self { folder: "win64", extension: "dll" };
    const MACOS: Self = Self { folder: "darwin64", extension: "dylib" };
    /// What FMI 2.0.4 names by the tuples of FMI 3.0.
    const LINUX_ON_ARM: Self = Self { folder: "aarch64-linux", extension: "so" };
    const MACOS_ON_ARM: Self = Self { folder: "aarch64-darwin", extension: "dylib" };
    pub(super) const ALL: [Self; 5] = [Self::LINUX, Self::WINDOWS, Self::MACOS, Self::LINUX_ON_ARM, Self::MACOS_ON_ARM];

    /// The platform that this is built for.
    pub const HOST: Self = if cfg!(target_os = "windows") {
        Self::WINDOWS
    } else if cfg!(target_os = "macos") {
        Self::MACOS
    } else {
        Self::LINUX
    };
}

/// Where a shared library is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LibraryFile {
    platform: Platform,
    path: PathBuf,
}

impl LibraryFile {
    /// The one for the platform that this is built for.
    pub fn of_host(path: impl Into<PathBuf>) -> Self {
        Self { platform: Platform::HOST, path: path.into() }
    }

    /// `PLATFORM=PATH`, as in `win64=asperity.dll`, or a path alone for the platform that this is built for.
    pub fn named(text: &OsStr) -> Self {
        let named = text.to_str().and_then(|text| text.split_once('=')).and_then(|(name, path)| {
            let platform = Platform::ALL.into_iter().find(|platform| platform.folder == name);
            platform.map(|platform| Self { platform, path: path.into() })
        });
        named.unwrap_or_else(|| Self::of_host(text))
    }

    /// The library that cargo builds beside the `program`, or that a package brings there.
    pub fn beside(program: &Path) -> Self {
        let name = format!("{}asperity_fmu.{}", std::env::consts::DLL_PREFIX, Platform::HOST.extension);
        Self::of_host(program.with_file_name(name))
    }

    /// The platform that it is for.
    pub fn platform(&self) -> Platform {
        self.platform
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// A shared library.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Library {
    /// Its platform.
    pub platform: Platform,
    /// The file's content.
    pub bytes: Vec<u8>,
}

impl Library {
    /// Reads libraries.
    ///
    /// # Errors
    /// Where one is not there or cannot be read, or a platform has two.
    pub fn read_all(files: &[LibraryFile]) -> Result<Vec<Self>, Error> {
        check_platforms(files)?;
        files.iter().map(Self::read).collect()
    }

    fn read(file: &LibraryFile) -> Result<Self, Error> {
        if !file.path.is_file() {
            return Err(Error::value(format!("no shared library at {}", file.path.display())));
        }
        Ok(Self { platform: file.platform, bytes: bytes(&file.path)? })
    }

    /// The version of glibc that it asks for, as in "linux64: glibc 2.17 or later".
    pub fn needs(&self) -> Option<String> {
        let version = newest_glibc(&self.bytes)?.iter().map(u32::to_string).collect::<Vec<_>>().join(".");
        Some(format!("{}: glibc {version} or later", self.platform.folder))
    }

    /// Checks that it is whole and has the functions of FMI 2.0, as far as is known of its platform's files.
    pub(super) fn check(&self) -> Result<(), String> {
        if self.platform == Platform::LINUX { check_elf(&self.bytes) } else { Ok(()) }
    }

    /// Its place in the archive of a model.
    pub(super) fn place(&self, identifier: &str) -> String {
        format!("binaries/{}/{identifier}.{}", self.platform.folder, self.platform.extension)
    }
}

/// Each platform may have one library.
fn check_platforms(libraries: &[LibraryFile]) -> Result<(), Error> {
    for (i, library) in libraries.iter().enumerate() {
        if let Some(other) = libraries[..i].iter().find(|other| other.platform == library.platform) {
            let (first, second) = (other.path.clone(), library.path.clone());
            return Err(Error::value(format!(
                "`library`: two of {}: {} and {}",
                library.platform.folder,
                first.display(),
                second.display()
            )));
        }
    }
    Ok(())
}

/// The functions of FMI 2.0 for co-simulation, without `fmi2`.
const FUNCTIONS: &str = "GetTypesPlatform GetVersion SetDebugLogging Instantiate FreeInstance SetupExperiment \
    EnterInitializationMode ExitInitializationMode Terminate Reset GetReal GetInteger GetBoolean GetString SetReal \
    SetInteger SetBoolean SetString GetFMUstate SetFMUstate FreeFMUstate SerializedFMUstateSize SerializeFMUstate \
    DeSerializeFMUstate GetDirectionalDerivative SetRealInputDerivatives GetRealOutputDerivatives DoStep CancelStep \
    GetStatus GetRealStatus GetIntegerStatus GetBooleanStatus GetStringStatus";

/// Refuses what is no shared library of 64 bits, ends before what its headers name, or lacks functions of FMI 2.0.
fn check_elf(elf: &[u8]) -> Result<(), String> {
    let unread = |error| format!("expected a whole shared library, an ELF file: {error}");
    let header = FileHeader64::<Endianness>::parse(elf).map_err(unread)?;
    let endian = header.endian().map_err(unread)?;
    if header.e_type(endian) != ET_DYN {
        return Err("expected a shared library, found another ELF file".to_owned());
    }
    let segments = header.program_headers(endian, elf).map_err(unread)?;
    let of_segments = segments.iter().map(|one| one.p_offset(endian).saturating_add(one.p_filesz(endian)));
    let sections = header.sections(endian, elf).map_err(unread)?;
    let of_sections = sections.iter().filter(|one| one.sh_type(endian) != SHT_NOBITS);
    let of_sections = of_sections.map(|one| one.sh_offset(endian).saturating_add(one.sh_size(endian)));
    let end = of_segments.chain(of_sections).max().unwrap_or(0);
    if end > elf.len() as u64 {
        return Err(format!("expected {end} bytes of a whole shared library, found {}", elf.len()));
    }
    let symbols = sections.symbols(endian, elf, SHT_DYNSYM).map_err(unread)?;
    let defined = symbols.iter().filter(|symbol| !symbol.is_undefined(endian));
    let names: BTreeSet<&[u8]> = defined.filter_map(|symbol| symbols.symbol_name(endian, symbol).ok()).collect();
    let is_missing = |name: &&str| !names.contains(format!("fmi2{name}").as_bytes());
    match FUNCTIONS.split_whitespace().find(is_missing) {
        Some(name) => Err(format!("expected the functions of FMI 2.0, found no fmi2{name}")),
        None => Ok(()),
    }
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
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

    #[test]
    fn a_library_is_this_platforms_unless_another_is_named() {
        let library = |text: &str| LibraryFile::named(text.as_ref());
        assert_eq!(library("a/b.so"), LibraryFile::of_host("a/b.so"));
        assert_eq!(library("win64=a/b.dll"), LibraryFile { platform: Platform::WINDOWS, path: "a/b.dll".into() });
        assert_eq!(library("a=b/c.so"), LibraryFile::of_host("a=b/c.so"));
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
        let problem = |bytes: &[u8]| check_elf(bytes).unwrap_err();
        assert!(problem(b"MZ").contains("ELF") && problem(&own).contains("no fmi2GetTypesPlatform"));
        let cut = problem(&own[..own.len() / 2]);
        assert!(cut.contains("a whole shared library"), "{cut}");
    }

    #[test]
    fn a_platform_has_one_library() {
        let two = ["win64=a", "linux64=b", "win64=c"].map(|text| LibraryFile::named(text.as_ref()));
        let text = check_platforms(&two).unwrap_err().to_string();
        assert_eq!(text, "`library`: two of win64: a and c");
        assert!(check_platforms(&two[..2]).is_ok());
    }
}
