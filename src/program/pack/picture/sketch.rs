//! A small picture without text, in pixels from the upper left corner.

use std::error::Error;

use plotters::prelude::*;

use crate::program::plot::{Canvas, Drawn, FINE, png, svg};

/// Pixels: width, height.
pub(super) const SIZE: (u32, u32) = (240, 160);
/// Width of a line, pixels.
const LINE: f64 = 1.4;

/// x to the right, y down.
pub(super) type Point = (f64, f64);

/// What a picture is drawn on, white where nothing is.
pub(super) struct Sketch<'a, 'b>(&'a Canvas<'b>);

impl Sketch<'_, '_> {
    /// The PNG file of what `draw` draws.
    pub(super) fn png(draw: impl FnOnce(&Sketch<'_, '_>) -> Drawn) -> Result<Vec<u8>, Box<dyn Error>> {
        png(&svg(SIZE, None, |canvas| draw(&Sketch(canvas)))?, 1.0)
    }

    /// Fills what lies within corners.
    pub(super) fn fill(&self, corners: impl Iterator<Item = Point>, colour: RGBColor) -> Drawn {
        Ok(self.0.draw(&Polygon::new(corners.map(fine).collect::<Vec<_>>(), colour.filled()))?)
    }

    /// Draws lines from corner to corner.
    pub(super) fn line(&self, corners: impl Iterator<Item = Point>, colour: RGBColor) -> Drawn {
        let width = (LINE * f64::from(FINE)).round() as u32;
        Ok(self.0.draw(&PathElement::new(corners.map(fine).collect::<Vec<_>>(), colour.stroke_width(width)))?)
    }

    /// Fills a disc.
    pub(super) fn disc(&self, centre: Point, radius: f64, colour: RGBColor) -> Drawn {
        Ok(self.0.draw(&Circle::new(fine(centre), radius * f64::from(FINE), colour.filled()))?)
    }
}

/// The nearest place that can be drawn.
fn fine((x, y): Point) -> (i32, i32) {
    let fine = |length: f64| (length * f64::from(FINE)).round() as i32;
    (fine(x), fine(y))
}
