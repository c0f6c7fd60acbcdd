//! Curves over logarithmic axes: what was measured as rings, what was computed as lines, one panel below another.

use std::error::Error;
use std::fs;
use std::path::Path;

use plotters::prelude::*;

use super::chart::{Canvas, Drawn, FINE, GAP, LEGEND_HEIGHT, LINE_WIDTH, SWATCH_LENGTH, TEXT_SIZE, colour, style, svg};
use super::ladders::{LEFT, draw_axes, length};
use super::logarithmic::{Logarithmic, is_drawn};
use super::raster::png;
use crate::program::error::ProgramError;

const WIDTH: u32 = 900;
const PANEL_HEIGHT: u32 = 380;
/// Radius of a ring.
const RADIUS: i32 = 4 * FINE as i32;

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stroke {
    /// A ring at every point.
    Rings,
    /// A line from point to point.
    Line,
}

/// A curve of a panel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Curve {
    /// Its name in the legend.
    pub(crate) name: String,
    /// Its number among the colours.
    pub(crate) look: usize,
    /// How it is drawn.
    pub(crate) stroke: Stroke,
    /// Its points; what has no place on logarithmic axes is left out.
    pub(crate) points: Vec<(f64, f64)>,
}

/// One chart: what is written beside its vertical axis, and its curves in the order of the legend.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CurvePanel {
    pub(crate) title: String,
    pub(crate) curves: Vec<Curve>,
}

/// Panels below each other with the same horizontal axis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Curves {
    /// What is written above the picture.
    pub(crate) title: String,
    /// What is written below the horizontal axes.
    pub(crate) x_title: String,
    pub(crate) panels: Vec<CurvePanel>,
}

impl Curves {
    /// Draws the picture: as PNG where `path` ends so, else as SVG.
    pub(crate) fn write(&self, path: &Path) -> Result<(), ProgramError> {
        self.bytes(path)
            .map_err(|error| ProgramError::picture(path, &*error))
            .and_then(|bytes| fs::write(path, bytes).map_err(ProgramError::file("write", path)))
    }

    fn bytes(&self, path: &Path) -> Result<Vec<u8>, Box<dyn Error>> {
        let size = (WIDTH, PANEL_HEIGHT * self.panels.len() as u32);
        let text = svg(size, Some(&self.title), |canvas| self.draw(canvas))?;
        let raster = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
        if raster { png(&text) } else { Ok(text.into_bytes()) }
    }

    fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        let points = self.panels.iter().flat_map(|panel| &panel.curves).flat_map(|curve| curve.drawn());
        let x = Logarithmic::around(points.map(|(x, _)| x));
        let canvases = canvas.split_evenly((self.panels.len(), 1));
        self.panels.iter().zip(&canvases).try_for_each(|(panel, canvas)| panel.draw(canvas, &self.x_title, x))
    }
}

impl CurvePanel {
    fn draw(&self, canvas: &Canvas<'_>, x_title: &str, x: Logarithmic) -> Drawn {
        let (legend, plot) = canvas.split_vertically(LEGEND_HEIGHT);
        self.draw_legend(&legend)?;
        let y = Logarithmic::around(self.curves.iter().flat_map(|curve| curve.drawn()).map(|(_, y)| y));
        let mut context = ChartBuilder::on(&plot)
            .margin(6 * FINE)
            .margin_right(28 * FINE)
            .x_label_area_size(46 * FINE)
            .y_label_area_size(LEFT)
            .build_cartesian_2d(x, y)?;
        draw_axes(&mut context, x_title, &self.title)?;
        for curve in &self.curves {
            let line = colour(curve.look).stroke_width(LINE_WIDTH);
            match curve.stroke {
                Stroke::Rings => {
                    context.draw_series(curve.drawn().map(|place| Circle::new(place, RADIUS, line)))?;
                }
                Stroke::Line => {
                    context.draw_series(LineSeries::new(curve.drawn(), line))?;
                }
            }
        }
        Ok(())
    }

    fn draw_legend(&self, canvas: &Canvas<'_>) -> Drawn {
        let mut left = LEFT + GAP;
        for curve in &self.curves {
            let right = left + SWATCH_LENGTH;
            curve.draw_swatch(canvas, left as i32, right as i32)?;
            let place = ((right + GAP) as i32, ((LEGEND_HEIGHT - TEXT_SIZE) / 2 + 2 * FINE) as i32);
            canvas.draw(&Text::new(curve.name.clone(), place, style(TEXT_SIZE)))?;
            left = right + GAP + length(&curve.name, TEXT_SIZE) + 4 * GAP;
        }
        Ok(())
    }
}

impl Curve {
    /// The points that have a place on logarithmic axes.
    fn drawn(&self) -> impl Iterator<Item = (f64, f64)> + Clone {
        self.points.iter().copied().filter(|&(x, y)| is_drawn(x) && is_drawn(y))
    }

    fn draw_swatch(&self, canvas: &Canvas<'_>, left: i32, right: i32) -> Drawn {
        let line = colour(self.look).stroke_width(LINE_WIDTH);
        let middle = (LEGEND_HEIGHT / 2 + FINE) as i32;
        match self.stroke {
            Stroke::Rings => canvas.draw(&Circle::new((i32::midpoint(left, right), middle), RADIUS, line))?,
            Stroke::Line => canvas.draw(&PathElement::new([(left, middle), (right, middle)], line))?,
        }
        Ok(())
    }
}
