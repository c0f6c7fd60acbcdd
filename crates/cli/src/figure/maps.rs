//! Maps of a patch's face: one moment, and a strip of others, coloured by pressure, with arrows for the traction.
//!
//! Both axes of a face have the same scale, unless one side is more than [`SLENDER`] times as long as the other. All
//! maps of a figure have the same colours and the same scale of arrows.

use asperity::patch::FaceLayout;
use plotters::coord::ranged1d::{Ranged as _, ValueFormatter as _};
use plotters::prelude::*;

use super::axis::{Axis, Fit, rounded_down};
use super::chart::{BELOW, LEFT, LEGEND_LINE, MARGIN, RIGHT_MARGIN, context, draw_axes};
use super::moment::{Detail, Moment, Tile};
use super::{Backend, Canvas, DrawResult, FINE, GRID, INK, TEXT_SIZE, TICK_SIZE, text_style, text_width};
use asperity_study::decimals::with_prefix;

/// Most pixels along and across the face, in the large map and in one of the strip.
const LARGE: (u32, u32) = (620, 420);
const SMALL: (u32, u32) = (172, 240);
/// Most tiles along each axis of these.
const TILES: (usize, usize) = (60, 30);
/// Moments in the strip.
pub(super) const STRIP: usize = 5;
/// A face that is longer than this many times its width is drawn wider than it is.
const SLENDER: f64 = 5.0;

/// The distance of arrows and the length of the longest, pixels; shorter ones than this share of it are left out.
const ARROW: u32 = 30;
const MIN_ARROW: f64 = 0.08;
/// Least pixels of a cell that is drawn with an edge.
const EDGED: i32 = 11 * FINE as i32;
/// Least radius of a point.
const MIN_RADIUS: f64 = 2.5 * FINE as f64;
/// The least height of the colour scale, and its width.
const SCALE: (u32, u32) = (220 * FINE, 16 * FINE);
/// Colours in the scale.
const COLOURS: i32 = 64;
/// Space above the titles of the strip, and below them.
const STRIP_GAP: u32 = 16 * FINE;
const STRIP_TITLE: u32 = 24 * FINE;

/// How the moments of a face are drawn.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Maps {
    plan: FaceLayout,
    /// The face in the large map and in the strip, subpixels.
    large: (u32, u32),
    small: (u32, u32),
}

impl Maps {
    pub(super) fn new(plan: FaceLayout) -> Self {
        let [length, width] = plan.extents.map(|(low, high)| high - low);
        Self { large: fitted(length, width, LARGE), small: fitted(length, width, SMALL), plan }
    }

    pub(super) fn plan(&self) -> &FaceLayout {
        &self.plan
    }

    /// What the large map and one of the strip can show.
    pub(super) fn details(&self) -> [Detail; 2] {
        [(TILES.0, self.large), (TILES.1, self.small)].map(|(tiles, size)| {
            let distance = |axis: usize, pixels: u32| {
                let (low, high) = self.plan.extents[axis];
                f64::from(ARROW * FINE) * (high - low) / f64::from(pixels)
            };
            Detail { tiles, arrows: [distance(0, size.0), distance(1, size.1)] }
        })
    }

    /// The height of both, pixels.
    pub(super) fn height(&self) -> u32 {
        (self.above() + self.below()) / FINE
    }

    fn above(&self) -> u32 {
        2 * LEGEND_LINE + self.large.1.max(SCALE.0) + MARGIN + BELOW
    }

    fn below(&self) -> u32 {
        STRIP_GAP + STRIP_TITLE + self.small.1 + 2 * MARGIN
    }

    /// Draws the moment `largest` with a scale of the colours and, below it, a `strip` of others.
    pub(super) fn draw<B: Backend>(&self, canvas: &Canvas<B>, largest: &Moment, strip: &[Moment]) -> DrawResult {
        let scales = Scales::new(strip.iter().chain([largest]));
        let (above, below) = canvas.split_vertically(self.above() + STRIP_GAP);
        let (title, map) = above.split_vertically(2 * LEGEND_LINE);
        draw_title(&title, largest)?;
        scales.draw_legend(&title)?;
        self.draw_large(&map, largest, &scales)?;
        let width = below.dim_in_pixel().0 / STRIP as u32;
        let places = below.split_evenly((1, STRIP));
        strip.iter().zip(&places).try_for_each(|(moment, canvas)| {
            let left = (width - self.small.0) as i32 / 2;
            let last = strip.last().map_or(0.0, |last| last.time);
            let time = with_prefix(moment.time, last, "s");
            let text = format!("{time}, {}", with_prefix(moment.force, largest.force, "N"));
            canvas.draw(&Text::new(text, (left, 0), text_style(TICK_SIZE)))?;
            let frame = Frame { plan: &self.plan, corner: (left, STRIP_TITLE as i32), size: self.small };
            frame.draw(canvas, moment, &scales)
        })
    }

    fn draw_large<B: Backend>(&self, canvas: &Canvas<B>, moment: &Moment, scales: &Scales) -> DrawResult {
        let (width, height) = (LEFT + self.large.0 + RIGHT_MARGIN, MARGIN + self.large.1 + BELOW + MARGIN);
        let (map, beside) = canvas.split_horizontally(width);
        let map = map.shrink((0, 0), (width, height));
        let [x, y] = [0, 1].map(|axis| {
            let (low, high) = self.plan.extents[axis];
            Axis::linear(self.plan.axes[axis], "m", [low, high].into_iter(), Fit::Tight)
        });
        draw_axes(&mut context(&map, "", &x, &y)?, &x, &y)?;
        let frame = Frame { plan: &self.plan, corner: (LEFT as i32, MARGIN as i32), size: self.large };
        frame.draw(&map, moment, scales)?;
        scales.draw_colours(&beside, self.large.1.max(SCALE.0))
    }
}

/// The size (subpixels) of a face of a length and a width within some pixels.
pub(super) fn fitted(length: f64, width: f64, within: (u32, u32)) -> (u32, u32) {
    let (length, width) = (length.max(width / SLENDER), width.max(length / SLENDER));
    let scale = (f64::from(within.0) / length).min(f64::from(within.1) / width) * f64::from(FINE);
    ((scale * length).round() as u32, (scale * width).round() as u32)
}

fn draw_title<B: Backend>(canvas: &Canvas<B>, moment: &Moment) -> DrawResult {
    let [time, force, pressure] = [(moment.time, "s"), (moment.force, "N"), (moment.pressure, "Pa")]
        .map(|(value, unit)| with_prefix(value, value, unit));
    let text = format!("At {time}, when the force is largest, {force}: pressure up to {pressure}");
    canvas.draw(&Text::new(text, (LEFT as i32, 8 * FINE as i32), text_style(TEXT_SIZE)))?;
    Ok(())
}

/// What colours and lengths stand for.
#[derive(Debug)]
struct Scales {
    /// The largest of the tiles, Pa.
    pressure: f64,
    /// The largest of the arrows, Pa.
    traction: f64,
}

impl Scales {
    fn new<'a>(moments: impl Iterator<Item = &'a Moment>) -> Self {
        let mut scales = Self { pressure: 0.0, traction: 0.0 };
        for moment in moments {
            scales.pressure = moment.tiles.iter().map(|tile| tile.pressure).fold(scales.pressure, f64::max);
            scales.traction = moment.arrows.iter().map(size).fold(scales.traction, f64::max);
        }
        scales
    }

    fn colour(&self, pressure: f64) -> RGBColor {
        ViridisRGB.get_color((pressure / self.pressure).clamp(0.0, 1.0))
    }

    /// The length of an arrow, subpixels; none where it could not be seen.
    fn length(&self, traction: f64) -> Option<f64> {
        let share = traction / self.traction;
        (share > MIN_ARROW).then(|| share * f64::from(ARROW * FINE))
    }

    /// What arrows and grey stand for, in the second line of the title.
    fn draw_legend<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let middle = (LEGEND_LINE + LEGEND_LINE / 2) as i32;
        let mut left = LEFT as i32;
        let name = |text: &str, left: &mut i32| {
            let top = middle - (TEXT_SIZE / 2) as i32 + FINE as i32;
            canvas.draw(&Text::new(text.to_owned(), (*left, top), text_style(TEXT_SIZE)))?;
            *left += text_width(text, TEXT_SIZE) as i32 + 20 * FINE as i32;
            DrawResult::Ok(())
        };
        let unit = rounded_down(self.traction);
        if let Some(length) = self.length(unit) {
            for (sticks, what) in [(false, "slip"), (true, "stick")] {
                let tip = (left + length.round() as i32, middle);
                draw_arrow(canvas, (left, middle), tip, sticks)?;
                left = tip.0 + 8 * FINE as i32;
                name(&format!("traction of {}, {what}", with_prefix(unit, unit, "Pa")), &mut left)?;
            }
        }
        let half = (TEXT_SIZE / 2) as i32;
        canvas.draw(&Rectangle::new([(left, middle - half), (left + 2 * half, middle + half)], GRID.filled()))?;
        left += 2 * half + 8 * FINE as i32;
        name("free", &mut left)
    }

    /// The scale of the colours with its ticks.
    fn draw_colours<B: Backend>(&self, canvas: &Canvas<B>, height: u32) -> DrawResult {
        let axis = Axis::linear("pressure", "Pa", [0.0, self.pressure].into_iter(), Fit::Tight);
        let corner = (2 * MARGIN as i32, MARGIN as i32);
        canvas.draw(&Text::new(axis.title.clone(), corner, text_style(TEXT_SIZE)))?;
        let top = corner.1 + LEGEND_LINE as i32;
        draw_colour_bar(canvas, (corner.0, top), height - LEGEND_LINE, &axis, |share| ViridisRGB.get_color(share))
    }
}

/// A bar of the colours from the low end of an axis, below, to its high end, with the ticks on its right.
pub(super) fn draw_colour_bar<B: Backend>(
    canvas: &Canvas<B>,
    (left, top): (i32, i32),
    height: u32,
    axis: &Axis,
    colour: impl Fn(f64) -> RGBColor,
) -> DrawResult {
    let (right, bottom) = (left + SCALE.1 as i32, top + height as i32);
    let at = |i: i32| bottom + (top - bottom) * i / COLOURS;
    for i in 0..COLOURS {
        let colour = colour((f64::from(i) + 0.5) / f64::from(COLOURS));
        canvas.draw(&Rectangle::new([(left, at(i + 1)), (right, at(i))], colour.filled()))?;
    }
    canvas.draw(&Rectangle::new([(left, top), (right, bottom)], INK.stroke_width(FINE)))?;
    for tick in axis.ticks(0) {
        let y = axis.map(&tick, (bottom, top));
        let end = right + 5 * FINE as i32;
        canvas.draw(&PathElement::new([(right, y), (end, y)], INK.stroke_width(FINE)))?;
        let corner = (end + 3 * FINE as i32, y - (TICK_SIZE / 2) as i32);
        canvas.draw(&Text::new(axis.format_ext(&tick), corner, text_style(TICK_SIZE)))?;
    }
    Ok(())
}

fn size(tile: &Tile) -> f64 {
    tile.traction[0].hypot(tile.traction[1])
}

/// Where a face lies on a canvas, subpixels.
struct Frame<'a> {
    plan: &'a FaceLayout,
    corner: (i32, i32),
    size: (u32, u32),
}

impl Frame<'_> {
    fn draw<B: Backend>(&self, canvas: &Canvas<B>, moment: &Moment, scales: &Scales) -> DrawResult {
        for tile in &moment.tiles {
            let colour = if tile.pressure > 0.0 { scales.colour(tile.pressure) } else { GRID };
            if moment.are_points {
                canvas.draw(&Circle::new(self.point(tile.place), self.radius(tile.area), colour.filled()))?;
            } else {
                canvas.draw(&Rectangle::new(self.cell(tile), colour.filled()))?;
            }
        }
        let (left, top) = self.corner;
        let end = (left + self.size.0 as i32, top + self.size.1 as i32);
        canvas.draw(&Rectangle::new([self.corner, end], INK.stroke_width(FINE)))?;
        moment.arrows.iter().try_for_each(|arrow| self.draw_traction(canvas, arrow, scales))
    }

    /// An arrow with its middle at the place.
    fn draw_traction<B: Backend>(&self, canvas: &Canvas<B>, arrow: &Tile, scales: &Scales) -> DrawResult {
        let traction = size(arrow);
        let Some(length) = scales.length(traction) else { return Ok(()) };
        let [x, y] = arrow.traction.map(|part| (0.5 * length * part / traction).round() as i32);
        let middle = self.point(arrow.place);
        draw_arrow(canvas, (middle.0 - x, middle.1 + y), (middle.0 + x, middle.1 - y), arrow.sticks)
    }

    /// Subpixels of a metre along each axis.
    fn scale(&self) -> [f64; 2] {
        let [length, width] = self.plan.extents.map(|(low, high)| high - low);
        [f64::from(self.size.0) / length, f64::from(self.size.1) / width]
    }

    fn point(&self, place: [f64; 2]) -> (i32, i32) {
        let ([x, y], [(left, _), (_, top)]) = (self.scale(), self.plan.extents);
        let [along, down] = [(place[0] - left) * x, (top - place[1]) * y];
        (self.corner.0 + along.round() as i32, self.corner.1 + down.round() as i32)
    }

    /// The corners of a cell, which small ones share with their neighbours.
    fn cell(&self, tile: &Tile) -> [(i32, i32); 2] {
        let ((left, bottom), (right, top)) = (self.point(tile.low), self.point(tile.high));
        let edge = if (right - left).min(bottom - top) >= EDGED { FINE as i32 / 2 } else { 0 };
        [(left + edge, top + edge), (right - edge, bottom - edge)]
    }

    /// The radius of a disc of an area, m².
    fn radius(&self, area: f64) -> i32 {
        let [x, y] = self.scale();
        (area * x * y / std::f64::consts::PI).sqrt().max(MIN_RADIUS).round() as i32
    }
}

/// Draws an arrow that is seen on every colour: white with a dark edge where most sticks, else dark with a white edge.
fn draw_arrow<B: Backend>(canvas: &Canvas<B>, from: (i32, i32), to: (i32, i32), sticks: bool) -> DrawResult {
    let (inside, edge) = if sticks { (WHITE, INK) } else { (INK, WHITE) };
    let (dx, dy) = (f64::from(to.0 - from.0), f64::from(to.1 - from.1));
    let length = dx.hypot(dy);
    let head = (0.5 * length).min(f64::from(9 * FINE));
    let at = |back: f64, aside: f64| {
        let (back, aside) = (back * head / length, aside * head / length);
        (to.0 - (back * dx + aside * dy).round() as i32, to.1 - (back * dy - aside * dx).round() as i32)
    };
    let corners = vec![to, at(1.0, 0.4), at(1.0, -0.4)];
    let outline = [corners.clone(), vec![to, corners[1]]].concat();
    canvas.draw(&PathElement::new([from, at(1.0, 0.0)], edge.stroke_width(7 * FINE / 2)))?;
    canvas.draw(&PathElement::new(outline, edge.stroke_width(2 * FINE)))?;
    canvas.draw(&PathElement::new([from, at(0.9, 0.0)], inside.stroke_width(3 * FINE / 2)))?;
    canvas.draw(&Polygon::new(corners, inside.filled()))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_keeps_its_shape_unless_it_is_slender() {
        assert_eq!(fitted(0.02, 0.01, (600, 400)), (600 * FINE, 300 * FINE));
        assert_eq!(fitted(0.01, 0.01, (600, 400)), (400 * FINE, 400 * FINE));
        assert_eq!(fitted(1.0, 1e-3, (600, 400)), (600 * FINE, 120 * FINE));
    }
}
