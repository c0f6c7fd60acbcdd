//! Fields over a surface: maps with colour bars and a scale bar, side by side, or below each other where the surface is
//! long.

use plotters::coord::ranged1d::Ranged as _;
use plotters::prelude::*;

use super::axis::{Axis, Fit, rounded_down};
use super::caption::{Way, draw_arrow};
use super::chart::{LEGEND_LINE, MARGIN};
use super::maps::{draw_colour_bar, fitted};
use super::raster::Raster;
use super::{Backend, COLOURS, Canvas, DrawResult, FINE, Figure, GRID, INK, TEXT_SIZE, text_style, text_width};
use asperity_study::decimals::with_prefix;

/// The most pixels of a map, side by side and below each other.
const BESIDE: (u32, u32) = (360, 480);
const BELOW: (u32, u32) = (760, 300);
/// A surface that is so many times as long as wide has its maps below each other.
const LONG: f64 = 1.6;
/// Space for a colour bar and its ticks.
const BAR: u32 = 84 * FINE;
/// The least distance of maps side by side: their titles need it.
const APART: u32 = 270 * FINE;
/// Space between the title of a map and the map, and for the scale bar below them all.
const TITLE: u32 = 2 * LEGEND_LINE + 2 * FINE;
const FOOT: u32 = 40 * FINE;
/// The scale bar is no longer than this share of the length.
const SCALE_BAR: f64 = 0.3;

/// How shares of a range are coloured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Colours {
    /// From dark violet to yellow.
    Viridis,
    /// From white to blue.
    Blues,
    /// From dark grey to white.
    Greys,
}

/// Points of a map that are not coloured by their values.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Marks {
    pub(crate) name: String,
    /// Strongly, or as little as the background.
    pub(crate) stand_out: bool,
    pub(crate) points: Vec<bool>,
}

/// A field over the points of a surface.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FieldMap {
    pub(crate) quantity: &'static str,
    pub(crate) unit: &'static str,
    /// Rows along x, from the lowest y on.
    pub(crate) values: Vec<f64>,
    pub(crate) colours: Colours,
    pub(crate) marks: Option<Marks>,
}

/// Maps of one surface.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SurfaceMaps {
    /// Points along x.
    pub(crate) nx: usize,
    /// Length along x and width, m.
    pub(crate) extents: [f64; 2],
    /// What the arrow along x stands for.
    pub(crate) arrow: &'static str,
    pub(crate) maps: Vec<FieldMap>,
}

impl Colours {
    pub(super) fn at(self, share: f64) -> RGBColor {
        let between = |from: RGBColor, to: RGBColor| {
            let part = |from: u8, to: u8| (f64::from(from) + share * (f64::from(to) - f64::from(from))).round() as u8;
            RGBColor(part(from.0, to.0), part(from.1, to.1), part(from.2, to.2))
        };
        match self {
            Self::Viridis => ViridisRGB.get_color(share),
            Self::Blues => between(WHITE, COLOURS[0]),
            Self::Greys => between(RGBColor(90, 90, 90), WHITE),
        }
    }
}

impl Marks {
    fn colour(&self) -> RGBColor {
        if self.stand_out { COLOURS[1] } else { GRID }
    }
}

impl FieldMap {
    fn axis(&self) -> Axis {
        Axis::linear(self.quantity, self.unit, self.values.iter().copied(), Fit::Tight)
    }

    /// The colours of all points.
    fn coloured(&self) -> Vec<RGBColor> {
        let axis = self.axis();
        let range = axis.range();
        let share = |value: f64| {
            let drawn = axis.coordinate(value).unwrap_or(range.start);
            ((drawn - range.start) / (range.end - range.start)).clamp(0.0, 1.0)
        };
        let colour = |(i, &value): (usize, &f64)| match &self.marks {
            Some(marks) if marks.points[i] => marks.colour(),
            _ => self.colours.at(share(value)),
        };
        self.values.iter().enumerate().map(colour).collect()
    }

    /// The title in the first line above a map, and what its marks are in the second.
    fn draw_title<B: Backend>(&self, canvas: &Canvas<B>, (left, top): (i32, i32)) -> DrawResult {
        canvas.draw(&Text::new(self.axis().title, (left, top), text_style(TEXT_SIZE)))?;
        let Some(marks) = &self.marks else { return Ok(()) };
        let (top, size) = (top + LEGEND_LINE as i32, TEXT_SIZE as i32);
        canvas.draw(&Rectangle::new([(left, top), (left + size, top + size)], marks.colour().filled()))?;
        let corner = (left + size + size / 2, top);
        canvas.draw(&Text::new(marks.name.clone(), corner, text_style(TEXT_SIZE)))?;
        Ok(())
    }
}

impl SurfaceMaps {
    fn is_long(&self) -> bool {
        self.extents[0] > LONG * self.extents[1]
    }

    /// The size of a map, subpixels.
    fn map_size(&self) -> (u32, u32) {
        fitted(self.extents[0], self.extents[1], if self.is_long() { BELOW } else { BESIDE })
    }

    /// The corner at the upper left of a map, subpixels.
    fn corner(&self, index: usize) -> (u32, u32) {
        let ((width, height), index) = (self.map_size(), index as u32);
        let (column, row) = if self.is_long() { (0, index) } else { (index, 0) };
        let (across, down) = ((2 * MARGIN + width + BAR).max(APART), TITLE + height + 3 * MARGIN);
        (2 * MARGIN + column * across, MARGIN + row * down + TITLE)
    }

    /// The scale bar, and which way the arrow points, below the last map.
    fn draw_foot<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let (width, height) = self.map_size();
        let (left, top) = (self.corner(0).0 as i32, (self.corner(self.maps.len() - 1).1 + height) as i32);
        let y = top + (FOOT / 2) as i32;
        let length = rounded_down(SCALE_BAR * self.extents[0]);
        let end = left + (f64::from(width) * length / self.extents[0]).round() as i32;
        canvas.draw(&Rectangle::new([(left, y - 2 * FINE as i32), (end, y + 2 * FINE as i32)], INK.filled()))?;
        let text_top = y - (TEXT_SIZE / 2) as i32;
        let gap = 3 * MARGIN as i32;
        let name = with_prefix(length, length, "m") + &self.stretched();
        let start = end + gap + text_width(&name, TEXT_SIZE) as i32 + 2 * gap;
        canvas.draw(&Text::new(name, (end + gap, text_top), text_style(TEXT_SIZE)))?;
        draw_arrow(canvas, (start, y), Way::Right, self.arrow)
    }

    /// Of a map that is drawn wider or longer than it is, in what direction the scale bar lies.
    fn stretched(&self) -> String {
        let (width, height) = self.map_size();
        let scales = [f64::from(width) / self.extents[0], f64::from(height) / self.extents[1]];
        if (scales[1] / scales[0] - 1.0).abs() < 0.02 { String::new() } else { " along x, y not to scale".into() }
    }
}

impl Figure for SurfaceMaps {
    fn size(&self) -> (u32, u32) {
        let ((width, height), (left, top)) = (self.map_size(), self.corner(self.maps.len() - 1));
        ((left + (width + BAR).max(APART)).div_ceil(FINE), (top + height + FOOT).div_ceil(FINE))
    }

    fn images(&self) -> Vec<Raster> {
        let image = |(index, map): (usize, &FieldMap)| {
            Raster::new(self.corner(index), self.map_size(), self.nx, &map.coloured())
        };
        self.maps.iter().enumerate().map(image).collect()
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let (width, height) = self.map_size();
        for (index, map) in self.maps.iter().enumerate() {
            let (left, top) = self.corner(index);
            let (left, top, right) = (left as i32, top as i32, (left + width) as i32);
            map.draw_title(canvas, (left, top - TITLE as i32 + FINE as i32))?;
            let frame = [(left, top), (right, top + height as i32)];
            canvas.draw(&Rectangle::new(frame, INK.stroke_width(FINE)))?;
            let bar = (right + 2 * MARGIN as i32, top);
            draw_colour_bar(canvas, bar, height, &map.axis(), |share| map.colours.at(share))?;
        }
        self.draw_foot(canvas)
    }
}
