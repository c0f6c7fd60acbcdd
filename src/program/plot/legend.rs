//! A legend: names, each once, in as many lines as they need.

use plotters::prelude::*;

use super::chart::LEFT;
use super::curve::{Curve, RING, Stroke, ring};
use super::marker::{self, draw_marker};
use super::picture::{Canvas, Drawn, FINE, GRID, INK, LINE_WIDTH, TEXT_SIZE, colour, length, style};

const HEIGHT: u32 = 30 * FINE;
const SWATCH: u32 = 26 * FINE;
/// Between a swatch and its name, and three of them from there to the next swatch.
const GAP: u32 = 7 * FINE;

/// What stands before a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Swatch {
    /// A piece of a curve.
    Piece(Stroke, RGBColor),
    /// A marker, its number among colours and markers, on a line that may be dashed.
    Marker { look: usize, dashed: bool },
    /// A shaded part.
    Area(RGBColor),
}

/// The names and where they stand.
#[derive(Debug)]
pub(super) struct Legend {
    items: Vec<Item>,
    lines: u32,
}

#[derive(Debug)]
struct Item {
    name: String,
    swatch: Swatch,
    left: u32,
    line: u32,
}

impl Legend {
    /// The legend of `names` on a canvas of some width, pixels.
    pub(super) fn new<'a>(names: impl Iterator<Item = (&'a str, Swatch)>, width: u32) -> Self {
        let mut legend = Self { items: Vec::new(), lines: 1 };
        let mut left = LEFT;
        for (name, swatch) in names.filter(|(name, _)| !name.is_empty()) {
            if legend.items.iter().any(|item| item.name == name) {
                continue;
            }
            let room = SWATCH + GAP + length(name, TEXT_SIZE) + 3 * GAP;
            if left + room > width && left > LEFT {
                (left, legend.lines) = (LEFT, legend.lines + 1);
            }
            legend.items.push(Item { name: name.to_owned(), swatch, left, line: legend.lines - 1 });
            left += room;
        }
        legend
    }

    pub(super) fn height(&self) -> u32 {
        self.lines * HEIGHT
    }

    pub(super) fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        self.items.iter().try_for_each(|item| item.draw(canvas))
    }
}

impl Item {
    fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        let (left, right) = (self.left as i32, (self.left + SWATCH) as i32);
        let top = self.line * HEIGHT;
        self.swatch.draw(canvas, (left, right), (top + HEIGHT / 2 + FINE) as i32)?;
        let place = (right + GAP as i32, (top + (HEIGHT - TEXT_SIZE) / 2 + 2 * FINE) as i32);
        canvas.draw(&Text::new(self.name.as_str(), place, style(TEXT_SIZE)))?;
        Ok(())
    }
}

impl Swatch {
    /// A curve's, in its colour.
    pub(super) fn of(curve: &Curve) -> Self {
        Self::Piece(curve.stroke, colour(curve.look))
    }

    /// A stroke's, whatever the colour.
    pub(super) fn of_stroke(stroke: Stroke) -> Self {
        Self::Piece(stroke, INK)
    }

    fn draw(self, canvas: &Canvas<'_>, (left, right): (i32, i32), middle: i32) -> Drawn {
        let centre = i32::midpoint(left, right);
        let line = |from: i32, to: i32, colour: RGBColor| {
            canvas.draw(&PathElement::new([(from, middle), (to, middle)], colour.stroke_width(LINE_WIDTH)))
        };
        match self {
            Self::Piece(Stroke::Rings, colour) => {
                canvas.draw(&Circle::new((centre, middle), RING, ring(colour)))?;
            }
            Self::Piece(stroke, colour) => {
                let (dash, gap) = stroke.dashes().unwrap_or((SWATCH, 1));
                let starts = (left..right).step_by((dash + gap) as usize);
                starts.into_iter().try_for_each(|start| line(start, (start + dash as i32).min(right), colour))?;
            }
            Self::Marker { look, dashed } => {
                let gap = if dashed { 2 * marker::RADIUS } else { 0 };
                line(left, centre - gap, colour(look))?;
                line(centre + gap, right, colour(look))?;
                draw_marker(canvas, (centre, middle), look, false)?;
            }
            Self::Area(shade) => {
                let half = (TEXT_SIZE / 2) as i32;
                let corners = [(left, middle - half), (right, middle + half)];
                canvas.draw(&Rectangle::new(corners, shade.filled()))?;
                canvas.draw(&Rectangle::new(corners, GRID.stroke_width(FINE)))?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A legend that is too long for one line goes on below it.
    #[test]
    fn a_legend_has_each_name_once_and_no_line_too_long() {
        let names: Vec<String> = (0..12).map(|i| format!("ladder number {}", i % 6)).collect();
        let width = 400 * FINE;
        let swatch = Swatch::Area(GRID);
        let legend = Legend::new(names.iter().map(|name| (name.as_str(), swatch)), width);
        assert_eq!(legend.items.len(), 6);
        assert!(legend.lines > 1);
        let ends = legend.items.iter().map(|item| item.left + SWATCH + GAP + length(&item.name, TEXT_SIZE));
        assert!(ends.clone().all(|end| end <= width), "{:?}", ends.collect::<Vec<_>>());
    }
}
