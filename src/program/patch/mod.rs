//! Contact patches on the command line.

mod describe;
mod motion;
mod simulate;

pub(crate) use describe::{describe, rows, warn_of_missing_backing};
pub(crate) use simulate::simulate;

use std::path::{Path, PathBuf};

use crate::patch::Patch;

/// The files that a patch is read from.
pub(crate) fn sources(path: &Path, patch: &Patch) -> Vec<PathBuf> {
    let folder = path.parent().unwrap_or(Path::new(""));
    std::iter::once(path.to_owned()).chain(patch.files().iter().map(|file| folder.join(file))).collect()
}
