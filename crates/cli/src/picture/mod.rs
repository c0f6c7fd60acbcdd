//! Draws pictures: laid out as lines, areas and text, which are written as SVG or PNG by the file's name.

mod font;
mod labels;
mod layout;
mod legend;
mod marks;
mod png;
mod svg;

use std::path::{Path, PathBuf};

use asperity_study::picture::{Colour, Picture, Point};
use rayon::prelude::*;

use asperity_study::Error;

use crate::files::{self, ends_in};

/// Text of titles, of axes and legends, of ticks, and beside points, pixels.
const TITLE_SIZE: f64 = 22.0;
const TEXT_SIZE: f64 = 17.0;
const TICK_SIZE: f64 = 15.0;
const LABEL_SIZE: f64 = 13.0;

/// Something of a picture as it is drawn, in pixels from the corner at the upper left.
#[derive(Clone, Debug, PartialEq)]
enum Item {
    /// Straight from point to point.
    Path {
        points: Vec<Point>,
        is_closed: bool,
        fill: Option<Paint>,
        pen: Option<Pen>,
    },
    Circle {
        at: Point,
        radius: f64,
        fill: Option<Paint>,
        pen: Option<Pen>,
    },
    /// `at` is half-way up its capitals.
    Text {
        text: String,
        at: Point,
        side: Side,
        size: f64,
        colour: Colour,
        is_upright: bool,
    },
    /// Colours in rows from the upper left corner on.
    Image {
        corner: Point,
        size: Point,
        columns: usize,
        colours: Vec<Colour>,
    },
}

/// A colour that what is below may show through.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Paint {
    colour: Colour,
    opacity: f64,
}

/// A line's paint, its width, and lengths of dashes and gaps.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pen {
    paint: Paint,
    width: f64,
    dashes: Option<[f64; 2]>,
}

/// Which of its ends a text has at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Start,
    Middle,
    End,
}

/// A picture as it is drawn.
#[derive(Clone, Debug, PartialEq)]
struct Drawing {
    size: Point,
    items: Vec<Item>,
}

impl Paint {
    fn full(colour: Colour) -> Self {
        Self { colour, opacity: 1.0 }
    }
}

impl Pen {
    fn new(colour: Colour, width: f64) -> Self {
        Self { paint: Paint::full(colour), width, dashes: None }
    }
}

impl Item {
    fn line(points: Vec<Point>, pen: Pen) -> Self {
        Self::Path { points, is_closed: false, fill: None, pen: Some(pen) }
    }

    fn area(points: Vec<Point>, fill: Paint) -> Self {
        Self::Path { points, is_closed: true, fill: Some(fill), pen: None }
    }

    /// A rectangle by two opposite corners.
    fn rectangle([x, y]: Point, [to_x, to_y]: Point, fill: Paint) -> Self {
        Self::area(vec![[x, y], [to_x, y], [to_x, to_y], [x, to_y]], fill)
    }

    fn text(text: impl Into<String>, at: Point, side: Side, size: f64) -> Self {
        Self::Text { text: text.into(), at, side, size, colour: Colour::INK, is_upright: false }
    }
}

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
