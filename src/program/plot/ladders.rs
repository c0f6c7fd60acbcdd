//! Ladders: an error over what it costs, rung by rung, both axes logarithmic.

use std::error::Error;

use plotters::coord::ranged1d::Ranged as _;
use plotters::prelude::*;

use super::axis::Axis;
use super::chart::{Context, context, draw_axes};
use super::curve::{Stroke, draw_line};
use super::labels::Labels;
use super::legend::{Legend, Swatch};
use super::logarithmic::is_drawn;
use super::marker::{RADIUS, draw_marker};
use super::picture::{Canvas, Drawn, FINE, colour, length, style, svg};

/// Width and height of one panel, pixels.
const PANEL: (u32, u32) = (400, 400);
const LABEL_SIZE: u32 = 13 * FINE;
/// Room beside and above markers for what is written there.
const BESIDE: f64 = 1.1;
const ABOVE: f64 = 1.6;
const BELOW: RGBColor = RGBColor(238, 238, 238);
const BELOW_NAME: &str = "below the reference's own error";

/// One point of a ladder.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rung {
    /// What it costs.
    pub(crate) x: f64,
    /// Its error.
    pub(crate) y: f64,
    /// What is written beside it where there is room; empty for nothing.
    pub(crate) label: String,
}

/// One line: the rungs of one way to run a scene.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ladder {
    /// Its name in the legend.
    pub(crate) name: String,
    /// Dashed, for what is not to be read as the first of its colour.
    pub(crate) dashed: bool,
    /// Its number among the colours and markers.
    pub(crate) look: usize,
    /// Its points.
    pub(crate) rungs: Vec<Rung>,
}

/// One chart: the ladders of one quantity.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LadderPanel {
    /// What is written beside the vertical axis.
    pub(crate) title: String,
    /// What the reference itself may be wrong by: an error below it says no more.
    pub(crate) floor: Option<f64>,
    /// The lines, in the order of the legend.
    pub(crate) ladders: Vec<Ladder>,
}

/// Panels beside each other, with the same axes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ladders {
    /// What is written below the horizontal axes.
    pub(crate) x_title: String,
    /// The charts.
    pub(crate) panels: Vec<LadderPanel>,
}

impl Ladders {
    /// The picture as the text of an SVG file.
    pub(crate) fn svg(&self) -> Result<String, Box<dyn Error>> {
        let (x, y) = self.axes();
        let width = PANEL.0 * self.panels.len() as u32;
        let legend = Legend::new(self.names(), width * FINE);
        svg((width, PANEL.1 + legend.height() / FINE), None, |canvas| {
            let (above, below) = canvas.split_vertically(legend.height());
            legend.draw(&above)?;
            let canvases = below.split_evenly((1, self.panels.len()));
            self.panels
                .iter()
                .zip(&canvases)
                .try_for_each(|(panel, canvas)| panel.draw(canvas, &x, &y.titled(&panel.title)))
        })
    }

    /// The axes that all panels have, the vertical one without a title.
    fn axes(&self) -> (Axis, Axis) {
        let rungs = || self.panels.iter().flat_map(|panel| &panel.ladders).flat_map(|ladder| &ladder.rungs);
        let floors = self.panels.iter().filter_map(|panel| panel.floor);
        let x = rungs().flat_map(|rung| [rung.x / BESIDE, rung.x * BESIDE]);
        let y = rungs().flat_map(|rung| [rung.y, rung.y * ABOVE]);
        (Axis::logarithmic(&self.x_title, x), Axis::logarithmic("", y.chain(floors)))
    }

    fn names(&self) -> impl Iterator<Item = (&str, Swatch)> {
        let ladders = self.panels.iter().flat_map(|panel| &panel.ladders);
        let named =
            ladders.map(|ladder| (ladder.name.as_str(), Swatch::Marker { look: ladder.look, dashed: ladder.dashed }));
        let has_floor = self.panels.iter().any(|panel| panel.floor.is_some());
        named.chain(has_floor.then_some((BELOW_NAME, Swatch::Area(BELOW))))
    }
}

impl LadderPanel {
    fn draw(&self, canvas: &Canvas<'_>, x: &Axis, y: &Axis) -> Drawn {
        let mut context = context(canvas, "", x, y)?;
        self.draw_floor(&mut context, x, y)?;
        draw_axes(&mut context, x, y)?;
        self.ladders.iter().try_for_each(|ladder| ladder.draw(canvas, &mut context, self.floor))?;
        self.draw_labels(canvas, &context)
    }

    /// Writes beside the markers, in the order of the ladders, where there is room.
    fn draw_labels(&self, canvas: &Canvas<'_>, context: &Context<'_, '_>) -> Drawn {
        let (across, down) = context.plotting_area().get_pixel_range();
        let (left, top) = canvas.get_base_pixel();
        let mut labels = Labels::new([across.start - left, down.start - top, across.end - left, down.end - top]);
        let places = |ladder: &Ladder| -> Vec<(i32, i32)> {
            ladder.drawn().map(|rung| pixel(canvas, context, (rung.x, rung.y))).collect()
        };
        for places in self.ladders.iter().map(places) {
            places.iter().for_each(|&place| labels.take_marker(place, RADIUS));
            places.windows(2).for_each(|pair| labels.take_line(pair[0], pair[1]));
        }
        for ladder in &self.ladders {
            for (rung, place) in ladder.drawn().zip(places(ladder)).filter(|(rung, _)| !rung.label.is_empty()) {
                let size = (length(&rung.label, LABEL_SIZE) as i32, (LABEL_SIZE + FINE) as i32);
                if let Some(corner) = labels.place(place, RADIUS + FINE as i32, size) {
                    canvas.draw(&Text::new(
                        rung.label.as_str(),
                        corner,
                        style(LABEL_SIZE).color(&colour(ladder.look)),
                    ))?;
                }
            }
        }
        Ok(())
    }

    /// The part of the panel where errors say no more, shaded.
    fn draw_floor(&self, context: &mut Context<'_, '_>, x: &Axis, y: &Axis) -> Drawn {
        let Some(floor) = self.floor.and_then(|floor| y.place(floor)) else { return Ok(()) };
        let corners = [(x.range().start, y.range().start), (x.range().end, floor.min(y.range().end))];
        context.draw_series([Rectangle::new(corners, BELOW.filled())])?;
        Ok(())
    }
}

impl Ladder {
    fn draw(&self, canvas: &Canvas<'_>, context: &mut Context<'_, '_>, floor: Option<f64>) -> Drawn {
        let places = self.drawn().map(|rung| (rung.x, rung.y)).collect();
        let stroke = if self.dashed { Stroke::Dashed } else { Stroke::Line };
        draw_line(context, places, stroke, self.look)?;
        for rung in self.drawn() {
            let at = pixel(canvas, context, (rung.x, rung.y));
            draw_marker(canvas, at, self.look, floor.is_some_and(|floor| rung.y < floor))?;
        }
        Ok(())
    }

    /// The rungs that have a place on logarithmic axes.
    fn drawn(&self) -> impl Iterator<Item = &Rung> + Clone {
        self.rungs.iter().filter(|rung| is_drawn(rung.x) && is_drawn(rung.y))
    }
}

/// Where a place of the chart is on the canvas that it is drawn on.
fn pixel(canvas: &Canvas<'_>, context: &Context<'_, '_>, place: (f64, f64)) -> (i32, i32) {
    let (x, y) = context.backend_coord(&place);
    let (left, top) = canvas.get_base_pixel();
    (x - left, y - top)
}
