//! Work-precision diagrams: errors over their cost, both axes logarithmic. A ladder is a line of such a diagram, a rung
//! one run of it, at one tolerance or communication step.

use plotters::coord::ranged1d::Ranged as _;
use plotters::prelude::*;

use super::axis::{Axis, is_loggable};
use super::chart::{Context, Legend, MARKER, MarkerFill, Stroke, Symbol, context, draw_axes, draw_line, draw_marker};
use super::{Backend, Canvas, DrawResult, FINE, Figure, INK, colour, text_style, text_width};

/// Width and height of a panel, pixels.
const PANEL: (u32, u32) = (400, 400);
const LABEL_SIZE: u32 = 13 * FINE;
/// Space beside and above markers for their labels, as factors.
const BESIDE: f64 = 1.1;
const ABOVE: f64 = 1.6;
const FLOOR: RGBColor = RGBColor(238, 238, 238);
const FLOOR_NAME: &str = "below the reference's own error";
/// Pieces of a line that labels avoid: each about as long as a marker.
const PIECES: i32 = 24;

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rung {
    /// The cost.
    pub(crate) x: f64,
    /// The error.
    pub(crate) y: f64,
    /// Written beside the marker where there is space; empty for nothing.
    pub(crate) label: String,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ladder {
    pub(crate) name: String,
    /// Rings stand for markers too.
    pub(crate) stroke: Stroke,
    /// The number of its colour and marker.
    pub(crate) look: usize,
    pub(crate) rungs: Vec<Rung>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LadderPanel {
    /// The title of the vertical axis.
    pub(crate) title: String,
    /// The reference's own error: errors below it say nothing.
    pub(crate) floor: Option<f64>,
    /// Values of the vertical axis with a line across and their numbers.
    pub(crate) lines: Vec<f64>,
    /// In the order of the legend.
    pub(crate) ladders: Vec<Ladder>,
}

/// Panels side by side, with the same axes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ladders {
    /// The title of the horizontal axes.
    pub(crate) x_title: String,
    pub(crate) panels: Vec<LadderPanel>,
}

impl Figure for Ladders {
    fn size(&self) -> (u32, u32) {
        (self.width(), PANEL.1 + self.legend().height() / FINE)
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let (x, y) = self.axes();
        let legend = self.legend();
        let (above, below) = canvas.split_vertically(legend.height());
        legend.draw(&above)?;
        let canvases = below.split_evenly((1, self.panels.len()));
        let panels = self.panels.iter().zip(&canvases);
        panels.into_iter().try_for_each(|(panel, canvas)| panel.draw(canvas, &x, &y.titled(&panel.title)))
    }
}

impl Ladders {
    fn width(&self) -> u32 {
        PANEL.0 * self.panels.len() as u32
    }

    fn legend(&self) -> Legend {
        let ladders = self.panels.iter().flat_map(|panel| &panel.ladders);
        let named = ladders.map(|ladder| (ladder.name.as_str(), ladder.symbol()));
        let has_floor = self.panels.iter().any(|panel| panel.floor.is_some());
        Legend::new(named.chain(has_floor.then_some((FLOOR_NAME, Symbol::Area(FLOOR)))), self.width() * FINE)
    }

    /// The axes of all panels, the vertical one without a title.
    fn axes(&self) -> (Axis, Axis) {
        let rungs = || self.panels.iter().flat_map(|panel| &panel.ladders).flat_map(|ladder| &ladder.rungs);
        let marked = self.panels.iter().flat_map(|panel| panel.lines.iter().copied().chain(panel.floor));
        let x = rungs().flat_map(|rung| [rung.x / BESIDE, rung.x * BESIDE]);
        let y = rungs().flat_map(|rung| [rung.y, rung.y * ABOVE]);
        (Axis::logarithmic(&self.x_title, x), Axis::logarithmic("", y.chain(marked)))
    }
}

impl LadderPanel {
    fn draw<B: Backend>(&self, canvas: &Canvas<B>, x: &Axis, y: &Axis) -> DrawResult {
        let mut context = context(canvas, "", x, y)?;
        self.draw_floor(&mut context, x, y)?;
        draw_axes(&mut context, x, y)?;
        self.draw_lines(canvas, &mut context, x)?;
        self.ladders.iter().try_for_each(|ladder| ladder.draw(canvas, &mut context, self.floor))?;
        self.draw_labels(canvas, &context)
    }

    fn draw_floor<B: Backend>(&self, context: &mut Context<'_, B>, x: &Axis, y: &Axis) -> DrawResult {
        let Some(floor) = self.floor.and_then(|floor| y.coordinate(floor)) else { return Ok(()) };
        let corners = [(x.range().start, y.range().start), (x.range().end, floor.min(y.range().end))];
        context.draw_series([Rectangle::new(corners, FLOOR.filled())])?;
        Ok(())
    }

    /// Draws the lines across, each with its number beside its right end.
    fn draw_lines<B: Backend>(&self, canvas: &Canvas<B>, context: &mut Context<'_, B>, x: &Axis) -> DrawResult {
        let (left, top) = canvas.get_base_pixel();
        for &value in &self.lines {
            let ends = [(x.range().start, value), (x.range().end, value)];
            context.draw_series([PathElement::new(ends, INK.mix(0.6).stroke_width(FINE))])?;
            let end = context.backend_coord(&ends[1]);
            let corner = (end.0 - left + FINE as i32 * 3, end.1 - top - (LABEL_SIZE / 2) as i32);
            canvas.draw(&Text::new(value.to_string(), corner, text_style(LABEL_SIZE)))?;
        }
        Ok(())
    }

    /// Writes beside the markers, in the order of the ladders, where there is space.
    fn draw_labels<B: Backend>(&self, canvas: &Canvas<B>, context: &Context<'_, B>) -> DrawResult {
        let (across, down) = context.plotting_area().get_pixel_range();
        let (left, top) = canvas.get_base_pixel();
        let mut labels = Labels::new([across.start - left, down.start - top, across.end - left, down.end - top]);
        let points: Vec<_> = self.ladders.iter().map(|ladder| ladder.points(canvas, context)).collect();
        for points in &points {
            points.iter().for_each(|&point| labels.occupy(point, MARKER));
            points.windows(2).for_each(|ends| labels.occupy_line(ends[0], ends[1]));
        }
        for (ladder, points) in self.ladders.iter().zip(points) {
            for (rung, point) in ladder.drawn().zip(points).filter(|(rung, _)| !rung.label.is_empty()) {
                let size = (text_width(&rung.label, LABEL_SIZE) as i32, (LABEL_SIZE + FINE) as i32);
                if let Some(corner) = labels.place(point, MARKER + FINE as i32, size) {
                    let colour = colour(ladder.look);
                    canvas.draw(&Text::new(rung.label.as_str(), corner, text_style(LABEL_SIZE).color(&colour)))?;
                }
            }
        }
        Ok(())
    }
}

impl Ladder {
    fn draw<B: Backend>(&self, canvas: &Canvas<B>, context: &mut Context<'_, B>, floor: Option<f64>) -> DrawResult {
        draw_line(context, self.drawn().map(|rung| (rung.x, rung.y)).collect(), self.stroke, self.look)?;
        if self.stroke == Stroke::Rings {
            return Ok(());
        }
        let rungs = self.drawn().zip(self.points(canvas, context));
        rungs.into_iter().try_for_each(|(rung, point)| {
            let is_hollow = floor.is_some_and(|floor| rung.y < floor);
            draw_marker(canvas, point, self.look, if is_hollow { MarkerFill::Hollow } else { MarkerFill::Full })
        })
    }

    fn symbol(&self) -> Symbol {
        match self.stroke {
            Stroke::Rings => Symbol::Line(Stroke::Rings, colour(self.look)),
            stroke => Symbol::Marker { look: self.look, dashed: stroke == Stroke::Dashed },
        }
    }

    /// The rungs that logarithmic axes can show.
    fn drawn(&self) -> impl Iterator<Item = &Rung> {
        self.rungs.iter().filter(|rung| is_loggable(rung.x) && is_loggable(rung.y))
    }

    fn points<B: Backend>(&self, canvas: &Canvas<B>, context: &Context<'_, B>) -> Vec<(i32, i32)> {
        let (left, top) = canvas.get_base_pixel();
        let positions = self.drawn().map(|rung| context.backend_coord(&(rung.x, rung.y)));
        positions.map(|(x, y)| (x - left, y - top)).collect()
    }
}

/// Left, top, right, bottom.
type Bounds = [i32; 4];

/// Places labels beside markers so that none covers a line, a marker or another label.
#[derive(Debug)]
struct Labels {
    area: Bounds,
    occupied: Vec<Bounds>,
}

impl Labels {
    fn new(area: Bounds) -> Self {
        Self { area, occupied: Vec::new() }
    }

    /// Keeps labels off a square.
    fn occupy(&mut self, (x, y): (i32, i32), radius: i32) {
        self.occupied.push([x - radius, y - radius, x + radius, y + radius]);
    }

    /// Keeps labels off a straight line.
    fn occupy_line(&mut self, from: (i32, i32), to: (i32, i32)) {
        for i in 0..=PIECES {
            let between = |a: i32, b: i32| a + (b - a) * i / PIECES;
            self.occupy((between(from.0, to.0), between(from.1, to.1)), 1);
        }
    }

    /// The upper left corner of a label of `size` beside the marker at `(x, y)`; `None` where there is no space.
    fn place(&mut self, (x, y): (i32, i32), radius: i32, size: (i32, i32)) -> Option<(i32, i32)> {
        let (width, height) = size;
        let [right, left] = [x + radius, x - radius - width];
        let [above, below] = [y - radius - height, y + radius];
        let middle = (x - width / 2, y - height / 2);
        let corners = [
            (right, above),
            (left, above),
            (right, below),
            (left, below),
            (right + radius, middle.1),
            (left - radius, middle.1),
            (middle.0, above - radius),
            (middle.0, below + radius),
        ];
        let corner = corners.into_iter().find(|&corner| self.is_free(corner, size))?;
        self.occupied.push(bounds(corner, size));
        Some(corner)
    }

    fn is_free(&self, corner: (i32, i32), size: (i32, i32)) -> bool {
        let [left, top, right, bottom] = bounds(corner, size);
        let [area_left, area_top, area_right, area_bottom] = self.area;
        let inside = left >= area_left && top >= area_top && right <= area_right && bottom <= area_bottom;
        let apart = |other: &Bounds| other[2] <= left || other[0] >= right || other[3] <= top || other[1] >= bottom;
        inside && self.occupied.iter().all(apart)
    }
}

fn bounds((x, y): (i32, i32), (width, height): (i32, i32)) -> Bounds {
    [x, y, x + width, y + height]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_go_where_there_is_space() {
        let mut labels = Labels::new([0, 0, 200, 100]);
        labels.occupy((50, 50), 5);
        // Above to the right; then, with that occupied, elsewhere; never out of the area.
        assert_eq!(labels.place((50, 50), 5, (40, 10)), Some((55, 35)));
        assert_eq!(labels.place((50, 50), 5, (40, 10)), Some((5, 35)));
        assert_eq!(labels.place((198, 2), 5, (40, 10)), Some((153, 7)));
        assert_eq!(labels.place((50, 50), 5, (300, 10)), None);
    }

    #[test]
    fn no_label_lies_on_a_line() {
        let mut labels = Labels::new([0, 0, 200, 100]);
        labels.occupy_line((50, 50), (100, 0));
        assert_eq!(labels.place((50, 50), 5, (40, 10)), Some((5, 35)));
    }
}
