//! A picture: what its look is made of, and how it becomes a file.

use std::error::Error;
use std::fs;
use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;

use super::raster::{self, png};
use crate::program::files::{FileError, ends_in};

/// A part of a picture to draw on.
pub(crate) type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Drawing fails only where the picture cannot be written.
pub(crate) type Drawn = Result<(), Box<dyn Error>>;

/// Okabe and Ito's colours, told apart by colour-blind readers too.
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(70, 70, 70),
];
const FONT: &str = "sans-serif";
pub(super) const INK: RGBColor = RGBColor(40, 40, 40);
pub(super) const GRID: RGBColor = RGBColor(225, 225, 225);
/// plotters places every point on a whole pixel; a picture drawn so many times as large and shown smaller has finer
/// ones.
pub(crate) const FINE: u32 = 8;
const TITLE_SIZE: u32 = 22 * FINE;
pub(super) const TEXT_SIZE: u32 = 17 * FINE;
pub(super) const TICK_SIZE: u32 = 15 * FINE;
pub(super) const LINE_WIDTH: u32 = 2 * FINE;
/// Width of a letter over the size of its text, roughly: an SVG's font is only known where it is shown.
const LETTER_WIDTH: f64 = 0.46;

/// Writes a picture of `size` pixels to `path`, as PNG where its name ends so, else as SVG: a title, if there is one,
/// and what `draw` adds below it.
pub(super) fn write(
    path: &Path,
    size: (u32, u32),
    title: Option<&str>,
    draw: impl FnOnce(&Canvas<'_>) -> Drawn,
) -> Result<(), FileError> {
    let is_png = ends_in(path, "png");
    let bytes = svg(size, title, draw)
        .and_then(|text| if is_png { png(&text, raster::SHARP) } else { Ok(text.into_bytes()) })
        .map_err(|error| FileError::picture(path, &*error))?;
    fs::write(path, bytes).map_err(FileError::io("write", path))
}

/// The picture as the text of an SVG file.
pub(crate) fn svg(
    size: (u32, u32),
    title: Option<&str>,
    draw: impl FnOnce(&Canvas<'_>) -> Drawn,
) -> Result<String, Box<dyn Error>> {
    let mut text = String::new();
    let fine = (size.0 * FINE, size.1 * FINE);
    let canvas = SVGBackend::with_string(&mut text, fine).into_drawing_area();
    canvas.fill(&WHITE)?;
    match title {
        Some(title) => draw(&canvas.margin(6 * FINE, 0, 0, 0).titled(title, style(TITLE_SIZE))?)?,
        None => draw(&canvas)?,
    }
    canvas.present()?;
    drop(canvas);
    let (drawn, shown) =
        [fine, size].map(|(width, height)| format!("<svg width=\"{width}\" height=\"{height}\"")).into();
    Ok(text.replacen(&drawn, &shown, 1))
}

/// Text of a size.
pub(super) fn style(size: u32) -> TextStyle<'static> {
    (FONT, size).into_font().color(&INK)
}

/// The colour of a number; they come again after the last.
pub(super) fn colour(i: usize) -> RGBColor {
    COLOURS[i % COLOURS.len()]
}

/// About how long a text of a size is.
pub(super) fn length(text: &str, size: u32) -> u32 {
    (text.chars().count() as f64 * f64::from(size) * LETTER_WIDTH) as u32
}
