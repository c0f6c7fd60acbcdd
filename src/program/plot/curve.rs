//! A curve of a chart.

use plotters::prelude::*;

use super::axis::Axis;
use super::chart::Context;
use super::picture::{Drawn, FINE, LINE_WIDTH, colour};

/// Radius of a ring.
pub(super) const RING: i32 = 4 * FINE as i32;

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stroke {
    /// A line from point to point.
    Line,
    Dashed,
    Dotted,
    /// A ring at every point.
    Rings,
}

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Curve {
    /// Its name in the legend.
    pub(crate) name: String,
    /// Its number among the colours.
    pub(crate) look: usize,
    /// How it is drawn.
    pub(crate) stroke: Stroke,
    /// Its points, as they were computed; what has no place on the axes is left out.
    pub(crate) points: Vec<(f64, f64)>,
}

impl Curve {
    pub(super) fn draw(&self, context: &mut Context<'_, '_>, x: &Axis, y: &Axis) -> Drawn {
        let places = self.points.iter().filter_map(|point| Some((x.place(point.0)?, y.place(point.1)?)));
        draw_line(context, places.collect(), self.stroke, self.look)
    }
}

/// Draws from place to place in the colour of some number.
pub(super) fn draw_line(context: &mut Context<'_, '_>, places: Vec<(f64, f64)>, stroke: Stroke, look: usize) -> Drawn {
    let line = colour(look).stroke_width(LINE_WIDTH);
    if stroke == Stroke::Rings {
        context.draw_series(places.into_iter().map(|place| Circle::new(place, RING, ring(colour(look)))))?;
    } else if let Some((dash, gap)) = stroke.dashes() {
        context.draw_series(DashedLineSeries::new(places, dash, gap, line))?;
    } else {
        context.draw_series(LineSeries::new(places, line))?;
    }
    Ok(())
}

/// Pale, so that a line through many is seen.
pub(super) fn ring(colour: RGBColor) -> ShapeStyle {
    colour.mix(0.5).stroke_width(LINE_WIDTH)
}

impl Stroke {
    /// A dash and the gap after it, pixels: a legend's swatch ends with a whole one.
    pub(super) fn dashes(self) -> Option<(u32, u32)> {
        match self {
            Self::Dashed => Some((6 * FINE, 4 * FINE)),
            Self::Dotted => Some((2 * FINE, 4 * FINE)),
            Self::Line | Self::Rings => None,
        }
    }
}
