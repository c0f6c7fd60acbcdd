//! Numbers of several things with their bands, a row for each.

use plotters::coord::ranged1d::{Ranged as _, ValueFormatter as _};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::{Axis, Fit};
use super::chart::MARGIN;
use super::{
    Backend, Canvas, DrawResult, FINE, Figure, GRID, INK, LINE_WIDTH, TEXT_SIZE, TICK_SIZE, colour, text_style,
    text_width,
};

/// The width of the figure, and the height of a row.
const WIDTH: u32 = 900 * FINE;
const ROW: i32 = 40 * FINE as i32;
/// Space below the rows, for ticks and title of the axis.
const BELOW: u32 = 52 * FINE;
/// Half of the height of what is between the quartiles, and of a mark.
const BOX: i32 = 8 * FINE as i32;
const MARK: i32 = 5 * FINE as i32;
/// The space at either end of the axis, as a share of what is drawn.
const ROOM: f64 = 0.06;

/// Numbers with bands, one below the other.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bands {
    pub(crate) title: String,
    /// Of the axis.
    pub(crate) quantity: String,
    pub(crate) rows: Vec<BandRow>,
}

/// One of the numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BandRow {
    pub(crate) name: String,
    /// At the right.
    pub(crate) remark: String,
    /// The number of its colour.
    pub(crate) look: usize,
    pub(crate) value: f64,
    /// Quantiles 0.05, 0.25, 0.5, 0.75 and 0.95.
    pub(crate) band: Option<[f64; 5]>,
}

impl Bands {
    fn axis(&self) -> Axis {
        let values = || self.rows.iter().flat_map(|row| row.band.into_iter().flatten().chain([row.value]));
        let (low, high) = (values().fold(f64::MAX, f64::min), values().fold(f64::MIN, f64::max));
        let room = (ROOM * (high - low)).max(0.01 * high.abs());
        Axis::linear(&self.quantity, "", [low - room, high + room].into_iter(), Fit::Tight)
    }

    /// The widest of some texts.
    fn widest<'a>(texts: impl Iterator<Item = &'a String>) -> u32 {
        texts.map(|text| text_width(text, TEXT_SIZE)).max().unwrap_or_default()
    }

    /// Where the axis begins and ends, subpixels.
    fn ends(&self) -> (i32, i32) {
        let left = 3 * MARGIN + Self::widest(self.rows.iter().map(|row| &row.name));
        let right = WIDTH - 4 * MARGIN - Self::widest(self.rows.iter().map(|row| &row.remark));
        (left as i32, right as i32)
    }
}

impl Figure for Bands {
    fn size(&self) -> (u32, u32) {
        (WIDTH / FINE, 40 + (self.rows.len() as u32 * ROW as u32 + BELOW) / FINE)
    }

    fn title(&self) -> &str {
        &self.title
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let (axis, ends) = (self.axis(), self.ends());
        let bottom = self.rows.len() as i32 * ROW;
        let at = |value: f64| axis.map(&value, ends);
        for tick in axis.ticks(0) {
            canvas.draw(&PathElement::new([(at(tick), 0), (at(tick), bottom)], GRID.stroke_width(FINE)))?;
            let style = text_style(TICK_SIZE).pos(Pos::new(HPos::Center, VPos::Top));
            canvas.draw(&Text::new(axis.format_ext(&tick), (at(tick), bottom + MARGIN as i32), style))?;
        }
        canvas.draw(&PathElement::new([(ends.0, bottom), (ends.1, bottom)], INK.stroke_width(FINE)))?;
        let style = text_style(TEXT_SIZE).pos(Pos::new(HPos::Center, VPos::Top));
        let middle = (i32::midpoint(ends.0, ends.1), bottom + (TICK_SIZE + 2 * MARGIN) as i32);
        canvas.draw(&Text::new(axis.title.clone(), middle, style))?;
        for (row, number) in self.rows.iter().zip(0..) {
            row.draw(canvas, at, (ends, number * ROW + ROW / 2))?;
        }
        Ok(())
    }
}

impl BandRow {
    fn draw<B: Backend>(
        &self,
        canvas: &Canvas<B>,
        at: impl Fn(f64) -> i32,
        ((left, right), y): ((i32, i32), i32),
    ) -> DrawResult {
        let name = text_style(TEXT_SIZE).pos(Pos::new(HPos::Right, VPos::Center));
        canvas.draw(&Text::new(self.name.clone(), (left - 2 * MARGIN as i32, y), name))?;
        let remark = text_style(TEXT_SIZE).pos(Pos::new(HPos::Left, VPos::Center));
        canvas.draw(&Text::new(self.remark.clone(), (right + 2 * MARGIN as i32, y), remark))?;
        let shade = colour(self.look);
        let Some([low, quarter, median, three_quarters, high]) = self.band.map(|band| band.map(at_of(&at))) else {
            canvas.draw(&Circle::new((at(self.value), y), MARK, shade.filled()))?;
            return Ok(());
        };
        let line = |from: (i32, i32), to: (i32, i32), shade: RGBColor| {
            canvas.draw(&PathElement::new([from, to], shade.stroke_width(LINE_WIDTH)))
        };
        line((low, y), (high, y), shade)?;
        for end in [low, high] {
            line((end, y - BOX / 2), (end, y + BOX / 2), shade)?;
        }
        canvas.draw(&Rectangle::new([(quarter, y - BOX), (three_quarters, y + BOX)], shade.filled()))?;
        line((median, y - BOX), (median, y + BOX), WHITE)?;
        canvas.draw(&Circle::new((at(self.value), y), MARK, WHITE.filled()))?;
        canvas.draw(&Circle::new((at(self.value), y), MARK, INK.stroke_width(FINE)))?;
        Ok(())
    }
}

fn at_of(at: &impl Fn(f64) -> i32) -> impl Fn(f64) -> i32 {
    move |value| at(value)
}
