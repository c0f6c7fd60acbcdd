//! Ladders: an error over what it costs, rung by rung, both axes logarithmic.

use std::error::Error;

use plotters::prelude::*;

use super::chart::{
    Canvas, Drawn, FINE, GAP, GRID, INK, LEGEND_HEIGHT, LINE_WIDTH, SWATCH_LENGTH, TEXT_SIZE, TICK_SIZE, colour, style,
    svg,
};
use super::labels::Labels;
use super::logarithmic::{Logarithmic, is_drawn};

/// Width and height of one panel, pixels.
const PANEL: (u32, u32) = (400, 400);
/// Radius of a marker.
const RADIUS: i32 = 5 * FINE as i32;
const LABEL_SIZE: u32 = 13 * FINE;
/// Room for the ticks and the title of a vertical axis.
pub(super) const LEFT: u32 = 72 * FINE;
/// Room beside and above markers for what is written there.
const BESIDE: f64 = 1.1;
const ABOVE: f64 = 1.6;
/// Ticks at most, so that they do not touch.
const X_TICKS: usize = 7;
const Y_TICKS: usize = 12;
/// Width of a letter over the size of its text, roughly.
const LETTER_WIDTH: f64 = 0.46;
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
pub(crate) struct Panel {
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
    pub(crate) panels: Vec<Panel>,
}

impl Ladders {
    /// The picture as the text of an SVG file.
    pub(crate) fn svg(&self) -> Result<String, Box<dyn Error>> {
        let width = PANEL.0 * self.panels.len() as u32;
        let legend = Legend::new(self, width * FINE);
        let size = (width, PANEL.1 + legend.height() / FINE);
        svg(size, None, |canvas| self.draw(canvas, &legend))
    }

    fn draw(&self, canvas: &Canvas<'_>, legend: &Legend) -> Drawn {
        let (above, below) = canvas.split_vertically(legend.height());
        legend.draw(&above)?;
        let axes = self.axes();
        let canvases = below.split_evenly((1, self.panels.len()));
        self.panels.iter().zip(&canvases).try_for_each(|(panel, canvas)| panel.draw(canvas, &self.x_title, axes))
    }

    /// The axes that all panels have.
    fn axes(&self) -> (Logarithmic, Logarithmic) {
        let rungs = || self.panels.iter().flat_map(|panel| &panel.ladders).flat_map(|ladder| &ladder.rungs);
        let floors = self.panels.iter().filter_map(|panel| panel.floor);
        let x = rungs().flat_map(|rung| [rung.x / BESIDE, rung.x * BESIDE]);
        let y = rungs().flat_map(|rung| [rung.y, rung.y * ABOVE]);
        (Logarithmic::around(x), Logarithmic::around(y.chain(floors)))
    }
}

pub(super) type Context<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Logarithmic, Logarithmic>>;

impl Panel {
    fn draw(&self, canvas: &Canvas<'_>, x_title: &str, (x, y): (Logarithmic, Logarithmic)) -> Drawn {
        let mut context = ChartBuilder::on(canvas)
            .margin(6 * FINE)
            .margin_right(28 * FINE)
            .x_label_area_size(46 * FINE)
            .y_label_area_size(LEFT)
            .build_cartesian_2d(x, y)?;
        self.draw_floor(&mut context, x, y)?;
        draw_axes(&mut context, x_title, &self.title)?;
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
    fn draw_floor(&self, context: &mut Context<'_, '_>, x: Logarithmic, y: Logarithmic) -> Drawn {
        let Some(floor) = self.floor.filter(|&floor| is_drawn(floor)) else { return Ok(()) };
        let corners = [(x.range().start, y.range().start), (x.range().end, floor.min(y.range().end))];
        context.draw_series([Rectangle::new(corners, BELOW.filled())])?;
        Ok(())
    }
}

pub(super) fn draw_axes(context: &mut Context<'_, '_>, x_title: &str, y_title: &str) -> Drawn {
    context
        .configure_mesh()
        .bold_line_style(GRID.stroke_width(FINE))
        .light_line_style(GRID.mix(0.45).stroke_width(FINE / 2))
        .axis_style(INK.stroke_width(FINE))
        .set_all_tick_mark_size(5 * FINE)
        .x_labels(X_TICKS)
        .y_labels(Y_TICKS)
        .max_light_lines(10)
        .label_style(style(TICK_SIZE))
        .axis_desc_style(style(TEXT_SIZE))
        .x_desc(x_title)
        .y_desc(y_title)
        .draw()?;
    Ok(())
}

impl Ladder {
    fn draw(&self, canvas: &Canvas<'_>, context: &mut Context<'_, '_>, floor: Option<f64>) -> Drawn {
        let places = self.drawn().map(|rung| (rung.x, rung.y));
        let line = colour(self.look).stroke_width(LINE_WIDTH);
        if self.dashed {
            context.draw_series(DashedLineSeries::new(places, 7 * FINE, 5 * FINE, line))?;
        } else {
            context.draw_series(LineSeries::new(places, line))?;
        }
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

/// A disc, a square, a triangle or a diamond, which tell lines apart without their colours; hollow where the error says
/// no more.
fn draw_marker(canvas: &Canvas<'_>, (x, y): (i32, i32), look: usize, hollow: bool) -> Drawn {
    let (r, edge) = (RADIUS, colour(look).stroke_width(LINE_WIDTH));
    let inside = if hollow { WHITE } else { colour(look) };
    let corners: &[(i32, i32)] = match look % MARKERS {
        0 => {
            canvas.draw(&Circle::new((x, y), r, inside.filled()))?;
            canvas.draw(&Circle::new((x, y), r, edge))?;
            return Ok(());
        }
        1 => &[(-r, -r), (r, -r), (r, r), (-r, r)],
        2 => &[(0, -r * 5 / 4), (r * 5 / 4, r), (-r * 5 / 4, r)],
        _ => &[(0, -r * 4 / 3), (r * 4 / 3, 0), (0, r * 4 / 3), (-r * 4 / 3, 0)],
    };
    let mut corners: Vec<(i32, i32)> = corners.iter().map(|(dx, dy)| (x + dx, y + dy)).collect();
    canvas.draw(&Polygon::new(corners.clone(), inside.filled()))?;
    corners.extend([corners[0], corners[1]]);
    canvas.draw(&PathElement::new(corners, edge))?;
    Ok(())
}

const MARKERS: usize = 4;

/// The names of the ladders, each once, in as many lines as they need.
#[derive(Debug)]
struct Legend {
    items: Vec<Item>,
    lines: u32,
}

#[derive(Debug)]
struct Item {
    name: String,
    /// Number among the colours and whether dashed; `None` for the shaded part.
    look: Option<(usize, bool)>,
    left: u32,
    line: u32,
}

impl Legend {
    fn new(ladders: &Ladders, width: u32) -> Self {
        let mut legend = Self { items: Vec::new(), lines: 1 };
        let mut left = LEFT;
        let named = ladders.panels.iter().flat_map(|panel| &panel.ladders);
        let named = named.map(|ladder| (ladder.name.as_str(), Some((ladder.look, ladder.dashed))));
        let floor = ladders.panels.iter().any(|panel| panel.floor.is_some()).then_some((BELOW_NAME, None));
        for (name, look) in named.chain(floor) {
            if legend.items.iter().any(|item| item.name == name) {
                continue;
            }
            let room = SWATCH_LENGTH + GAP + length(name, TEXT_SIZE) + 3 * GAP;
            if left + room > width && left > LEFT {
                (left, legend.lines) = (LEFT, legend.lines + 1);
            }
            legend.items.push(Item { name: name.to_owned(), look, left, line: legend.lines - 1 });
            left += room;
        }
        legend
    }

    fn height(&self) -> u32 {
        self.lines * LEGEND_HEIGHT
    }

    fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        self.items.iter().try_for_each(|item| item.draw(canvas))
    }
}

pub(super) fn length(text: &str, size: u32) -> u32 {
    (text.chars().count() as f64 * f64::from(size) * LETTER_WIDTH) as u32
}

impl Item {
    fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        let (left, right) = (self.left as i32, (self.left + SWATCH_LENGTH) as i32);
        let top = self.line * LEGEND_HEIGHT;
        let middle = (top + LEGEND_HEIGHT / 2 + FINE) as i32;
        match self.look {
            Some((look, dashed)) => {
                let line = colour(look).stroke_width(LINE_WIDTH);
                let gap = if dashed { 2 * RADIUS } else { 0 };
                let centre = i32::midpoint(left, right);
                canvas.draw(&PathElement::new([(left, middle), (centre - gap, middle)], line))?;
                canvas.draw(&PathElement::new([(centre + gap, middle), (right, middle)], line))?;
                draw_marker(canvas, (centre, middle), look, false)?;
            }
            None => {
                let half = (TEXT_SIZE / 2) as i32;
                canvas.draw(&Rectangle::new([(left, middle - half), (right, middle + half)], BELOW.filled()))?;
                canvas
                    .draw(&Rectangle::new([(left, middle - half), (right, middle + half)], GRID.stroke_width(FINE)))?;
            }
        }
        let place = (right + GAP as i32, (top + (LEGEND_HEIGHT - TEXT_SIZE) / 2 + 2 * FINE) as i32);
        canvas.draw(&Text::new(self.name.clone(), place, style(TEXT_SIZE)))?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A legend that is too long for one line goes on below it.
    #[test]
    fn a_legend_has_each_name_once_and_no_line_too_long() {
        let ladder =
            |i: usize| Ladder { name: format!("ladder number {}", i % 6), dashed: false, look: i, rungs: vec![] };
        let panel = Panel { title: "error".into(), floor: Some(1e-9), ladders: (0..12).map(ladder).collect() };
        let ladders = Ladders { x_title: "time".into(), panels: vec![panel] };
        let width = PANEL.0 * FINE;
        let legend = Legend::new(&ladders, width);
        assert_eq!(legend.items.len(), 7);
        assert!(legend.lines > 1);
        let ends = legend.items.iter().map(|item| item.left + SWATCH_LENGTH + GAP + length(&item.name, TEXT_SIZE));
        assert!(ends.clone().all(|end| end <= width), "{:?}", ends.collect::<Vec<_>>());
    }
}
