//! One chart: lines over an axis, a legend above them. The look of every picture is decided here.

use std::error::Error;

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
const TITLE_SIZE: i32 = 22;
const TEXT_SIZE: i32 = 17;
const TICK_SIZE: i32 = 15;
const INK: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(225, 225, 225);
/// Width of a letter over its height, roughly: an SVG's font is only known where it is shown.
const LETTER_WIDTH: f64 = 0.56;
const LEGEND_HEIGHT: i32 = 30;
const LEFT_MARGIN: u32 = 84;
const SWATCH: i32 = 26;

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

/// Draws a title at the top of `canvas` and returns what is left below it.
pub(crate) fn title<'a>(canvas: &Canvas<'a>, text: &str) -> Result<Canvas<'a>, Box<dyn Error>> {
    Ok(canvas.titled(text, (FONT, TITLE_SIZE).into_font().color(&INK))?)
}

impl Chart {
    /// Draws legend, axes and lines.
    pub(crate) fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        let (legend, plot) = canvas.split_vertically(LEGEND_HEIGHT);
        self.draw_legend(&legend)?;
        let mut context = ChartBuilder::on(&plot)
            .margin(6)
            .margin_right(24)
            .x_label_area_size(44)
            .y_label_area_size(LEFT_MARGIN)
            .build_cartesian_2d(self.x.low..self.x.high, self.y.low..self.y.high)?;
        self.draw_axes(&mut context)?;
        for (i, line) in self.lines.iter().enumerate() {
            context.draw_series(LineSeries::new(self.drawn(line), colour(i).stroke_width(2)))?;
        }
        Ok(())
    }

    fn draw_axes(&self, context: &mut Context<'_, '_>) -> Drawn {
        context
            .configure_mesh()
            .bold_line_style(GRID)
            .light_line_style(TRANSPARENT)
            .axis_style(INK)
            .x_labels(self.x.ticks.max(6))
            .y_labels(self.y.ticks)
            .x_label_formatter(&|x| self.x.label(*x))
            .y_label_formatter(&|y| self.y.label(*y))
            .label_style((FONT, TICK_SIZE).into_font().color(&INK))
            .axis_desc_style((FONT, TEXT_SIZE).into_font().color(&INK))
            .x_desc(&self.x.title)
            .y_desc(&self.y.title)
            .draw()?;
        Ok(())
    }

    fn drawn(&self, line: &Line) -> impl Iterator<Item = (f64, f64)> {
        line.points.iter().map(|&(x, y)| (x * self.x.scale, y * self.y.scale)).filter(|(x, y)| (x + y).is_finite())
    }

    fn draw_legend(&self, canvas: &Canvas<'_>) -> Drawn {
        let mut left = LEFT_MARGIN as i32 + 10;
        let middle = LEGEND_HEIGHT / 2 + 4;
        for (i, line) in self.lines.iter().enumerate() {
            let swatch = vec![(left, middle), (left + SWATCH, middle)];
            canvas.draw(&PathElement::new(swatch, colour(i).stroke_width(3)))?;
            let text_left = left + SWATCH + 7;
            let style = (FONT, TEXT_SIZE).into_font().color(&INK);
            canvas.draw(&Text::new(line.name.clone(), (text_left, middle - TEXT_SIZE / 2), style))?;
            left = text_left + text_width(&line.name) + 22;
        }
        Ok(())
    }
}

type Context<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

fn colour(i: usize) -> RGBColor {
    COLOURS[i % COLOURS.len()]
}

fn text_width(text: &str) -> i32 {
    (text.chars().count() as f64 * f64::from(TEXT_SIZE) * LETTER_WIDTH) as i32
}
