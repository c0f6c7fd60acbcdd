//! SidePanels over a logarithmic axis, in panels side by side with the same axes.

use std::error::Error;
use std::path::Path;

use plotters::prelude::*;

use super::axis::{Axis, Fit};
use super::chart::{
    Canvas, Drawn, FINE, GAP, GRID, INK, LEGEND_HEIGHT, LINE_WIDTH, SWATCH_LENGTH, TEXT_SIZE, TICK_SIZE, colour, style,
    svg,
};
use super::logarithmic::{Logarithmic, is_drawn};
use super::raster::png;

/// Width and height of a panel that stands alone, and the width of one of several, pixels.
const ALONE: (u32, u32) = (800, 480);
const SEVERAL: u32 = 460;
const LEFT: u32 = 84 * FINE;
const X_TICKS: usize = 9;
/// Width of a letter over the size of its text, roughly.
const LETTER_WIDTH: f64 = 0.5;
/// A dash and the gap after it; and those of dots.
const DASHES: (u32, u32) = (9 * FINE, 6 * FINE);
const DOTS: (u32, u32) = (2 * FINE, 5 * FINE);

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dash {
    Whole,
    Dashed,
    Dotted,
}

/// One curve.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FrictionCurve {
    /// In the legend: of a whole curve with its colour, of the others with their dashes alone.
    pub(crate) name: String,
    /// Its number among the colours.
    pub(crate) look: usize,
    pub(crate) stroke: Dash,
    /// x > 0.
    pub(crate) points: Vec<(f64, f64)>,
}

/// One chart.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SidePanel {
    /// Above it; empty for none.
    pub(crate) title: String,
    pub(crate) curves: Vec<FrictionCurve>,
}

/// Charts side by side.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SidePanels {
    pub(crate) x_title: String,
    pub(crate) y_title: String,
    pub(crate) panels: Vec<SidePanel>,
}

impl SidePanels {
    /// Writes the picture: PNG where the file is called so, else SVG.
    pub(crate) fn write(&self, path: &Path) -> Drawn {
        let text = self.svg()?;
        let is_png = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
        std::fs::write(path, if is_png { png(&text)? } else { text.into_bytes() })?;
        Ok(())
    }

    fn svg(&self) -> Result<String, Box<dyn Error>> {
        let width = if self.panels.len() == 1 { ALONE.0 } else { SEVERAL * self.panels.len() as u32 };
        let legend = Legend::new(self, width * FINE);
        svg((width, ALONE.1 + legend.height() / FINE), None, |canvas| self.draw(canvas, &legend))
    }

    fn draw(&self, canvas: &Canvas<'_>, legend: &Legend) -> Drawn {
        let (above, below) = canvas.split_vertically(legend.height());
        legend.draw(&above)?;
        let points = || self.panels.iter().flat_map(|panel| &panel.curves).flat_map(|curve| &curve.points);
        let x = Logarithmic::around(points().map(|point| point.0));
        let y = Axis::new(&self.y_title, "", points().map(|point| point.1), Fit::Round);
        let canvases = below.split_evenly((1, self.panels.len()));
        self.panels.iter().zip(&canvases).try_for_each(|(panel, canvas)| panel.draw(canvas, &self.x_title, x, &y))
    }
}

type Context<'a, 'b> =
    ChartContext<'a, SVGBackend<'b>, Cartesian2d<Logarithmic, plotters::coord::types::RangedCoordf64>>;

impl SidePanel {
    fn draw(&self, canvas: &Canvas<'_>, x_title: &str, x: Logarithmic, y: &Axis) -> Drawn {
        let mut builder = ChartBuilder::on(canvas);
        builder.margin(6 * FINE).margin_right(24 * FINE).x_label_area_size(46 * FINE).y_label_area_size(LEFT);
        if !self.title.is_empty() {
            builder.caption(&self.title, style(TEXT_SIZE));
        }
        let mut context = builder.build_cartesian_2d(x, y.low..y.high)?;
        draw_axes(&mut context, x_title, y)?;
        self.curves.iter().try_for_each(|curve| curve.draw(&mut context))
    }
}

fn draw_axes(context: &mut Context<'_, '_>, x_title: &str, y: &Axis) -> Drawn {
    context
        .configure_mesh()
        .bold_line_style(GRID.stroke_width(FINE))
        .light_line_style(TRANSPARENT)
        .axis_style(INK.stroke_width(FINE))
        .set_all_tick_mark_size(5 * FINE)
        .x_labels(X_TICKS)
        .y_labels(y.ticks)
        .y_label_formatter(&|value| y.label(*value))
        .label_style(style(TICK_SIZE))
        .axis_desc_style(style(TEXT_SIZE))
        .x_desc(x_title)
        .y_desc(&y.title)
        .draw()?;
    Ok(())
}

impl FrictionCurve {
    fn draw(&self, context: &mut Context<'_, '_>) -> Drawn {
        let points = self.points.iter().copied().filter(|(x, y)| is_drawn(*x) && y.is_finite()).collect::<Vec<_>>();
        let line = colour(self.look).stroke_width(LINE_WIDTH);
        match dashes(self.stroke) {
            None => context.draw_series(LineSeries::new(points, line))?,
            Some((dash, gap)) => context.draw_series(DashedLineSeries::new(points, dash, gap, line))?,
        };
        Ok(())
    }
}

/// Dash and gap.
fn dashes(stroke: Dash) -> Option<(u32, u32)> {
    match stroke {
        Dash::Whole => None,
        Dash::Dashed => Some(DASHES),
        Dash::Dotted => Some(DOTS),
    }
}

/// The names of the curves, each once, in as many lines as they need.
#[derive(Debug)]
struct Legend {
    items: Vec<(String, RGBColor, Dash, u32, u32)>,
    lines: u32,
}

impl Legend {
    fn new(curves: &SidePanels, width: u32) -> Self {
        let mut legend = Self { items: Vec::new(), lines: 1 };
        let all = || curves.panels.iter().flat_map(|panel| &panel.curves);
        let whole = all().filter(|curve| curve.stroke == Dash::Whole);
        let parts = all().filter(|curve| curve.stroke != Dash::Whole);
        let mut left = LEFT;
        for curve in whole.chain(parts) {
            if legend.items.iter().any(|item| item.0 == curve.name) {
                continue;
            }
            let letters = curve.name.chars().count() as f64 * f64::from(TEXT_SIZE) * LETTER_WIDTH;
            let room = SWATCH_LENGTH + 4 * GAP + letters as u32;
            if left + room > width && left > LEFT {
                (left, legend.lines) = (LEFT, legend.lines + 1);
            }
            let ink = if curve.stroke == Dash::Whole { colour(curve.look) } else { INK };
            legend.items.push((curve.name.clone(), ink, curve.stroke, left, legend.lines - 1));
            left += room;
        }
        legend
    }

    fn height(&self) -> u32 {
        self.lines * LEGEND_HEIGHT
    }

    fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        for (name, ink, stroke, left, line) in &self.items {
            let (from, to) = (*left as i32, (left + SWATCH_LENGTH) as i32);
            let middle = (line * LEGEND_HEIGHT + LEGEND_HEIGHT / 2 + FINE) as i32;
            let (dash, gap) = dashes(*stroke).map_or((to - from, 1), |(dash, gap)| (dash as i32, gap as i32));
            let mut start = from;
            while start < to {
                let end = (start + dash).min(to);
                canvas.draw(&PathElement::new([(start, middle), (end, middle)], ink.stroke_width(LINE_WIDTH)))?;
                start = end + gap;
            }
            let top = (line * LEGEND_HEIGHT + (LEGEND_HEIGHT - TEXT_SIZE) / 2 + 2 * FINE) as i32;
            canvas.draw(&Text::new(name.clone(), (to + GAP as i32, top), style(TEXT_SIZE)))?;
        }
        Ok(())
    }
}
