//! Figures one after another.

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::Figure;
use crate::files::FileError;

/// Writes `count` pictures, each as a PNG of its own.
pub(crate) fn write_row<F: Figure>(
    count: usize,
    picture: impl Fn(usize) -> F + Sync,
    path: &Path,
) -> Result<(), FileError> {
    (0..count).into_par_iter().try_for_each(|i| picture(i).write(&numbered(path, i, count)))
}

/// The files of a row of `count` pictures: `OUT-001.png` and so on for `OUT.png`.
fn numbered(path: &Path, i: usize, count: usize) -> PathBuf {
    let digits = count.to_string().len().max(3);
    let mut name = path.file_stem().unwrap_or_default().to_os_string();
    name.push(format!("-{:0digits$}.png", i + 1));
    path.with_file_name(name)
}
