//! Reading of files: regular ones alone, since a pipe waits for its writer and a device may have no end.

use std::fs;
use std::io::{Error, Result};
use std::path::Path;

/// The content of the regular file at `path`; links are followed.
///
/// # Errors
/// Where it cannot be read, or is a folder, a pipe or a device.
pub fn read_file(path: &Path) -> Result<Vec<u8>> {
    check(path)?;
    fs::read(path)
}

/// [`read_file`] as text.
///
/// # Errors
/// As for [`read_file`], and where it is not UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    check(path)?;
    fs::read_to_string(path)
}

/// Before it is opened: to open a pipe is to wait for its writer.
fn check(path: &Path) -> Result<()> {
    let kind = fs::metadata(path)?.file_type();
    if kind.is_file() {
        return Ok(());
    }
    let found = if kind.is_dir() { "a folder" } else { "a pipe or a device" };
    Err(Error::other(format!("expected a regular file, found {found}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_regular_file_is_refused() {
        let refused = |path: &str| read_file(Path::new(path)).unwrap_err().to_string();
        assert_eq!(refused(env!("CARGO_MANIFEST_DIR")), "expected a regular file, found a folder");
        #[cfg(unix)]
        assert_eq!(refused("/dev/zero"), "expected a regular file, found a pipe or a device");
        assert!(read_text(&Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml")).is_ok());
    }
}
