//! The line above a contact that is drawn: how many times as high as long it is, and which way it slides.

use plotters::prelude::*;

use super::axis::Axis;
use super::chart::{BELOW, LEFT, LEGEND_LINE, MARGIN, RIGHT_MARGIN};
use super::{Backend, Canvas, DrawResult, INK, LINE_WIDTH, TEXT_SIZE, text_style, text_width};
use asperity_study::decimals::rounded;

/// What the arrow of a contact says.
pub(crate) const RUBBER_SLIDES: &str = "the rubber slides";
/// Above which a ratio of scales is 1 but for rounding.
const TO_SCALE: f64 = 0.02;

/// Which way along the horizontal axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    Right,
    Left,
}

impl Way {
    /// That of a change; `None` of none.
    pub(super) fn of(change: f64) -> Option<Self> {
        if change > 0.0 {
            Some(Self::Right)
        } else if change < 0.0 {
            Some(Self::Left)
        } else {
            None
        }
    }
}

/// How many times as high as long a chart on a canvas draws things, both axes being linear ones of lengths.
pub(super) fn exaggeration<B: Backend>(canvas: &Canvas<B>, x: &Axis, z: &Axis) -> f64 {
    let (width, height) = canvas.dim_in_pixel();
    let scale = |axis: &Axis, size: u32| {
        let range = plotters::coord::ranged1d::Ranged::range(axis);
        axis.coordinate(1.0).unwrap_or(1.0) * f64::from(size) / (range.end - range.start)
    };
    scale(z, height.saturating_sub(2 * MARGIN + BELOW)) / scale(x, width.saturating_sub(LEFT + RIGHT_MARGIN))
}

/// Draws the line: what `exaggeration` says of the heights, and an arrow where something slides.
pub(super) fn draw_caption<B: Backend>(canvas: &Canvas<B>, exaggeration: f64, way: Option<Way>) -> DrawResult {
    let text = in_words(exaggeration);
    let (left, middle) = (LEFT as i32, (LEGEND_LINE / 2) as i32);
    canvas.draw(&Text::new(text.clone(), (left, middle - (TEXT_SIZE / 2) as i32), text_style(TEXT_SIZE)))?;
    let start = left + (text_width(&text, TEXT_SIZE) + 5 * MARGIN) as i32;
    way.map_or(Ok(()), |way| draw_arrow(canvas, (start, middle), way, RUBBER_SLIDES))
}

fn in_words(exaggeration: f64) -> String {
    if (exaggeration - 1.0).abs() < TO_SCALE {
        "heights to scale".into()
    } else {
        format!("heights drawn {} times as large as lengths", rounded(exaggeration, 2))
    }
}

/// Draws an arrow from a place on, and its name behind it.
pub(super) fn draw_arrow<B: Backend>(
    canvas: &Canvas<B>,
    (start, y): (i32, i32),
    way: Way,
    name: &'static str,
) -> DrawResult {
    let (end, head) = (start + 8 * MARGIN as i32, MARGIN as i32);
    let (tail, tip, back) = match way {
        Way::Right => (start, end, -head),
        Way::Left => (end, start, head),
    };
    canvas.draw(&PathElement::new([(tail, y), (tip + back, y)], INK.stroke_width(LINE_WIDTH)))?;
    let corners = [(tip, y), (tip + 2 * back, y - head), (tip + 2 * back, y + head)];
    canvas.draw(&Polygon::new(corners, INK.filled()))?;
    let corner = (end + 3 * MARGIN as i32, y - (TEXT_SIZE / 2) as i32);
    canvas.draw(&Text::new(name, corner, text_style(TEXT_SIZE)))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::axis::Fit;
    use super::super::{FINE, subpixels};
    use super::*;

    /// Of axes that differ in their prefixes: a panel of 100 mm by 10 µm that is as high as wide.
    #[test]
    fn the_exaggeration_is_that_of_metres() {
        let (side, mut text) = (600, String::new());
        let size = subpixels((side + (LEFT + RIGHT_MARGIN) / FINE, side + (2 * MARGIN + BELOW) / FINE));
        let canvas = SVGBackend::with_string(&mut text, size).into_drawing_area();
        let axis = |high: f64| Axis::linear("x", "m", [0.0, high].into_iter(), Fit::Tight);
        let found = exaggeration(&canvas, &axis(0.1), &axis(1e-5));
        assert!((found / 1e4 - 1.0).abs() < 1e-12, "{found}");
        assert_eq!(in_words(found), "heights drawn 10000 times as large as lengths");
        assert_eq!((in_words(1.004), Way::of(-1.0), Way::of(0.0)), ("heights to scale".into(), Some(Way::Left), None));
    }
}
