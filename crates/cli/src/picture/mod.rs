//! Draws pictures: laid out as lines, areas and text, which are written as SVG or PNG by the file's name.

mod drawing;
mod font;
mod labels;
mod layout;
mod legend;
mod marks;
mod png;
mod svg;

use std::path::{Path, PathBuf};

use asperity_study::picture::Picture;
use rayon::prelude::*;

use asperity_study::Error;

use crate::files::{self, ends_in};

/// Writes a picture to `path`: as PNG where its name ends so, else as SVG.
pub(crate) fn write(picture: &Picture, path: &Path) -> Result<(), Error> {
    let is_png = ends_in(path, "png");
    let bytes = if is_png { png(picture) } else { svg(picture).map(String::into_bytes) };
    files::write(path, bytes.map_err(|error| files::not_drawn(path, error))?)
}

/// The text of the SVG file.
///
/// # Errors
/// Where the image within it cannot be written, which does not happen in memory.
pub fn svg(picture: &Picture) -> Result<String, ::png::EncodingError> {
    svg::svg(&layout::drawing(picture))
}

/// The PNG file, with two pixels for one of the picture's: sharp on a high-resolution screen and in print.
pub(crate) fn png(picture: &Picture) -> Result<Vec<u8>, ::png::EncodingError> {
    png::png(&layout::drawing(picture), 2.0)
}

/// The PNG file of a picture's one panel alone, at its size.
pub(crate) fn icon(picture: &Picture) -> Result<Vec<u8>, ::png::EncodingError> {
    png::png(&layout::drawing(picture), 1.0)
}

/// Writes `count` pictures, each as a PNG of its own: `OUT-001.png` and so on for `OUT.png`.
pub(crate) fn write_all(count: usize, picture: impl Fn(usize) -> Picture + Sync, path: &Path) -> Result<(), Error> {
    (0..count).into_par_iter().try_for_each(|i| write(&picture(i), &numbered(path, i, count)))
}

fn numbered(path: &Path, i: usize, count: usize) -> PathBuf {
    let digits = count.to_string().len().max(3);
    let mut name = path.file_stem().unwrap_or_default().to_os_string();
    name.push(format!("-{:0digits$}.png", i + 1));
    path.with_file_name(name)
}
