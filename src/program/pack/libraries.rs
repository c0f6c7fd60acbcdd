//! The shared libraries, one a platform.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::archive::Entry;
use super::read;
use crate::program::error::ProgramError;

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

/// The libraries that `--library` names, as they stand in the archive; by default the one beside this program.
pub(super) fn binaries(identifier: &str, arguments: &[OsString]) -> Result<Vec<Entry>, ProgramError> {
    let mut libraries: Vec<_> = arguments.iter().map(library).collect();
    if libraries.is_empty() {
        libraries.push((HOST, beside_this_program()));
    }
    refuse_two_of_a_platform(&libraries)?;
    libraries.iter().map(|(platform, path)| binary(identifier, platform, path)).collect()
}

/// `PLATFORM=PATH`, or a path alone for this program's platform.
fn library(argument: &OsString) -> (Platform, PathBuf) {
    let named = argument.to_str().and_then(|text| text.split_once('=')).and_then(|(name, path)| {
        let platform = [LINUX, WINDOWS, MACOS].into_iter().find(|platform| platform.folder == name);
        platform.map(|platform| (platform, path.into()))
    });
    named.unwrap_or_else(|| (HOST, argument.into()))
}

/// The library that cargo puts there.
fn beside_this_program() -> PathBuf {
    let name = format!("{}asperity.{}", std::env::consts::DLL_PREFIX, HOST.extension);
    std::env::current_exe().unwrap_or_default().with_file_name(name)
}

fn refuse_two_of_a_platform(libraries: &[(Platform, PathBuf)]) -> Result<(), ProgramError> {
    for (i, (platform, second)) in libraries.iter().enumerate() {
        if let Some((_, first)) = libraries[..i].iter().find(|(other, _)| other == platform) {
            let (first, second) = (first.clone(), second.clone());
            return Err(ProgramError::SamePlatform { platform: platform.folder, first, second });
        }
    }
    Ok(())
}

fn binary(identifier: &str, platform: &Platform, path: &Path) -> Result<Entry, ProgramError> {
    if !path.is_file() {
        return Err(ProgramError::NoLibrary { path: path.to_owned() });
    }
    let name = format!("binaries/{}/{identifier}.{}", platform.folder, platform.extension);
    Ok(Entry { name, bytes: read(path)?, executable: true })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_is_this_platforms_unless_another_is_named() {
        let library = |text: &str| library(&text.into());
        assert_eq!(library("a/b.so"), (HOST, "a/b.so".into()));
        assert_eq!(library("win64=a/b.dll"), (WINDOWS, "a/b.dll".into()));
        assert_eq!(library("a=b/c.so"), (HOST, "a=b/c.so".into()));
    }

    #[test]
    fn a_platform_has_one_library() {
        let two = [(WINDOWS, "a".into()), (LINUX, "b".into()), (WINDOWS, "c".into())];
        let text = refuse_two_of_a_platform(&two).unwrap_err().to_string();
        assert_eq!(text, "--library: two of win64: a and c");
        assert!(refuse_two_of_a_platform(&two[..2]).is_ok());
    }
}
