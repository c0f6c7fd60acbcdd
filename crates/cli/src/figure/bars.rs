//! Bars with names, below each other.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::{
    Backend, Canvas, DrawResult, FINE, Figure, GRID, INK, LINE_WIDTH, TEXT_SIZE, colour, text_style, text_width,
};

/// Height of a bar with the space around it, and of the bar; the space of its number behind the longest one, pixels.
const ROW: u32 = 30;
const BAR: u32 = 16;
const NUMBER: u32 = 110;
const WIDTH: u32 = 800;
const MARGIN: u32 = 12;
const TITLE: u32 = 36;

/// A bar.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bar {
    pub(crate) name: String,
    /// From 0 to 1.
    pub(crate) value: f64,
    /// Its standard error; 0 for none.
    pub(crate) error: f64,
}

/// Bars from 0 to 1, and their numbers in per cent.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bars {
    pub(crate) title: String,
    /// From top to bottom.
    pub(crate) bars: Vec<Bar>,
}

impl Figure for Bars {
    fn size(&self) -> (u32, u32) {
        (WIDTH, TITLE + 2 * MARGIN + ROW * self.bars.len().max(1) as u32)
    }

    fn title(&self) -> &str {
        &self.title
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let widest = self.bars.iter().map(|bar| text_width(&bar.name, TEXT_SIZE)).max().unwrap_or_default();
        let left = (2 * MARGIN * FINE + widest) as i32;
        let length = f64::from(((WIDTH - NUMBER) * FINE) as i32 - left).max(f64::from(FINE));
        let end = |value: f64| left + (length * value.clamp(0.0, 1.0)).round() as i32;
        let bottom = ((MARGIN + ROW * self.bars.len() as u32) * FINE) as i32;
        for tick in [0.0, 0.25, 0.5, 0.75, 1.0] {
            let line = [(end(tick), (MARGIN * FINE) as i32), (end(tick), bottom)];
            canvas.draw(&PathElement::new(line, GRID.stroke_width(FINE)))?;
        }
        let text = |text: String, (x, y): (i32, i32), side: HPos| {
            canvas.draw(&Text::new(text, (x, y), text_style(TEXT_SIZE).pos(Pos::new(side, VPos::Center))))
        };
        for (row, bar) in self.bars.iter().enumerate() {
            let middle = ((MARGIN + ROW * row as u32 + ROW / 2) * FINE) as i32;
            let half = (BAR * FINE / 2) as i32;
            let corners = [(left, middle - half), (end(bar.value), middle + half)];
            canvas.draw(&Rectangle::new(corners, colour(0).mix(0.75).filled()))?;
            let [low, high] = [-1.0, 1.0].map(|sign| end(bar.value + sign * bar.error));
            if bar.error > 0.0 {
                canvas.draw(&PathElement::new([(low, middle), (high, middle)], INK.stroke_width(LINE_WIDTH)))?;
            }
            text(bar.name.clone(), (left - (MARGIN * FINE) as i32, middle), HPos::Right)?;
            let error = if bar.error > 0.0 { format!(" ± {:.0}", 100.0 * bar.error) } else { String::new() };
            let number = format!("{:.0}{error} %", 100.0 * bar.value);
            text(number, (high.max(end(bar.value)) + (8 * FINE) as i32, middle), HPos::Left)?;
        }
        Ok(())
    }
}
