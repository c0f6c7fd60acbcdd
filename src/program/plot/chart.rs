//! One chart: lines over an axis, a legend above them. The look of every picture is decided here.

use std::error::Error;
use std::fs;
use std::path::Path;

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::axis::Axis;

/// A part of a picture to draw on.
pub(crate) type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Drawing fails only where the file cannot be written.
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
pub(super) const FINE: u32 = 8;
const TITLE_SIZE: u32 = 22 * FINE;
pub(super) const TEXT_SIZE: u32 = 17 * FINE;
pub(super) const TICK_SIZE: u32 = 15 * FINE;
pub(super) const LINE_WIDTH: u32 = 2 * FINE;
pub(super) const SWATCH_LENGTH: u32 = 26 * FINE;
pub(super) const GAP: u32 = 7 * FINE;
pub(super) const LEGEND_HEIGHT: u32 = 30 * FINE;
const LEFT_MARGIN: u32 = 84 * FINE;
/// Width of a letter over its height, roughly: an SVG's font is only known where it is shown.
const LETTER_WIDTH: f64 = 0.58;

/// One line of a chart.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    /// Its name in the legend.
    pub(crate) name: String,
    /// Its points, as they were computed.
    pub(crate) points: Vec<(f64, f64)>,
}

/// Lines over axes.
#[derive(Clone, Debug)]
pub(crate) struct Chart {
    /// The horizontal axis.
    pub(crate) x: Axis,
    /// The vertical axis.
    pub(crate) y: Axis,
    /// The lines, in the order of the legend.
    pub(crate) lines: Vec<Line>,
}

/// Writes a picture of `size` pixels to `path`: a title, if there is one, and what `draw` adds below it.
pub(crate) fn write(
    path: &Path,
    size: (u32, u32),
    title: Option<&str>,
    draw: impl FnOnce(&Canvas<'_>) -> Drawn,
) -> Drawn {
    Ok(fs::write(path, svg(size, title, draw)?)?)
}

/// The picture as the text of an SVG file.
pub(super) fn svg(
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

pub(super) fn style(size: u32) -> TextStyle<'static> {
    (FONT, size).into_font().color(&INK)
}

impl Chart {
    /// Draws legend, axes and lines.
    pub(crate) fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        let (legend, plot) = canvas.split_vertically(LEGEND_HEIGHT);
        self.draw_legend(&legend)?;
        let mut context = ChartBuilder::on(&plot)
            .margin(6 * FINE)
            .margin_right(24 * FINE)
            .x_label_area_size(44 * FINE)
            .y_label_area_size(LEFT_MARGIN)
            .build_cartesian_2d(self.x.low..self.x.high, self.y.low..self.y.high)?;
        self.draw_axes(&mut context)?;
        for (i, line) in self.lines.iter().enumerate() {
            context.draw_series(LineSeries::new(self.drawn(line), colour(i).stroke_width(LINE_WIDTH)))?;
        }
        Ok(())
    }

    fn draw_axes(&self, context: &mut Context<'_, '_>) -> Drawn {
        context
            .configure_mesh()
            .bold_line_style(GRID.stroke_width(FINE))
            .light_line_style(TRANSPARENT)
            .axis_style(INK.stroke_width(FINE))
            .set_all_tick_mark_size(5 * FINE)
            .x_labels(self.x.ticks.max(6))
            .y_labels(self.y.ticks)
            .x_label_formatter(&|x| self.x.label(*x))
            .y_label_formatter(&|y| self.y.label(*y))
            .label_style(style(TICK_SIZE))
            .axis_desc_style(style(TEXT_SIZE))
            .x_desc(&self.x.title)
            .y_desc(&self.y.title)
            .draw()?;
        Ok(())
    }

    fn drawn(&self, line: &Line) -> impl Iterator<Item = (f64, f64)> {
        line.points.iter().map(|&(x, y)| (x * self.x.scale, y * self.y.scale)).filter(|(x, y)| (x + y).is_finite())
    }

    fn draw_legend(&self, canvas: &Canvas<'_>) -> Drawn {
        let mut left = LEFT_MARGIN + GAP;
        for (i, line) in self.lines.iter().enumerate() {
            let text_left = left + SWATCH_LENGTH + GAP;
            let swatch = [left, left + SWATCH_LENGTH].map(|x| (x as i32, (LEGEND_HEIGHT / 2 + FINE) as i32));
            canvas.draw(&PathElement::new(swatch, colour(i).stroke_width(LINE_WIDTH + FINE)))?;
            let place = (text_left as i32, ((LEGEND_HEIGHT - TEXT_SIZE) / 2 + 2 * FINE) as i32);
            canvas.draw(&Text::new(line.name.clone(), place, style(TEXT_SIZE)))?;
            left = text_left + text_width(&line.name) + 3 * GAP;
        }
        Ok(())
    }
}

type Context<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

pub(super) fn colour(i: usize) -> RGBColor {
    COLOURS[i % COLOURS.len()]
}

fn text_width(text: &str) -> u32 {
    (text.chars().count() as f64 * f64::from(TEXT_SIZE) * LETTER_WIDTH) as u32
}
