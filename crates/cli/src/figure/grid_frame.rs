//! Maps over two quantities, side by side and below each other, all over the same axes: where they stand in a figure,
//! and what is around them.

use asperity::element::SweepGrid;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::{Axis, Fit};
use super::chart::{BELOW, LEFT, LEGEND_LINE, Legend, MARGIN, RIGHT_MARGIN, context, draw_axes_without_lines};
use super::{Backend, Canvas, DrawResult, FINE, TEXT_SIZE, TITLE_SIZE, text_style};
use crate::cli::sweep_values::SweptQuantity;

/// The size of a map alone, and of one of several.
const ALONE: (u32, u32) = (560 * FINE, 420 * FINE);
const ONE_OF: (u32, u32) = (330 * FINE, 270 * FINE);
/// Most maps side by side.
const BESIDE: usize = 3;
/// Space for the title of the figure, and of a map.
const TITLE: u32 = 36 * FINE;
const MAP_TITLE: u32 = LEGEND_LINE;

/// An axis of maps: a quantity at some values.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GridAxis {
    pub(crate) quantity: &'static str,
    pub(crate) unit: &'static str,
    /// Rising.
    pub(crate) values: Vec<f64>,
    pub(crate) is_logarithmic: bool,
}

impl GridAxis {
    /// That of a quantity of a sweep: logarithmic where its values go by decades.
    pub(crate) fn of(quantity: SweptQuantity, grid: &SweepGrid) -> Self {
        /// From this ratio on loads do.
        const DECADE: f64 = 10.0;
        let values = quantity.values(grid).to_vec();
        let spans_decade = values.first().zip(values.last()).is_some_and(|(low, high)| *high >= DECADE * low);
        let is_logarithmic = quantity == SweptQuantity::Speed || (quantity.is_load() && spans_decade);
        Self { quantity: quantity.word(), unit: quantity.unit(), values, is_logarithmic }
    }

    pub(super) fn axis(&self) -> Axis {
        let values = self.values.iter().copied();
        match self.is_logarithmic {
            true => Axis::logarithmic_tight(&format!("{} in {}", self.quantity, self.unit), values),
            false => Axis::linear(self.quantity, self.unit, values, Fit::Tight),
        }
    }

    /// Where a value is drawn, up to a scale and an origin.
    pub(crate) fn coordinate(&self, value: f64) -> f64 {
        if self.is_logarithmic { value.ln() } else { value }
    }

    /// The value at a coordinate.
    pub(crate) fn value(&self, coordinate: f64) -> f64 {
        if self.is_logarithmic { coordinate.exp() } else { coordinate }
    }

    fn ends(&self) -> [f64; 2] {
        [self.values.first(), self.values.last()].map(|end| end.copied().unwrap_or_default())
    }

    /// How far a value is along the axis, from 0 to 1.
    pub(super) fn share(&self, value: f64) -> f64 {
        let [low, high] = self.ends().map(|end| self.coordinate(end));
        (self.coordinate(value) - low) / (high - low)
    }

    pub(super) fn shares(&self) -> Vec<f64> {
        self.values.iter().map(|value| self.share(*value)).collect()
    }

    /// Whether a value is on the axis.
    pub(crate) fn has(&self, value: f64) -> bool {
        let [low, high] = self.ends();
        (low..=high).contains(&value)
    }
}

/// The maps of a figure.
#[derive(Debug)]
pub(super) struct GridFrame<'a> {
    pub(super) title: &'a str,
    /// Below the title; empty for none.
    pub(super) remark: &'a str,
    pub(super) axes: [&'a GridAxis; 2],
    /// The titles of the maps.
    pub(super) titles: Vec<&'a str>,
    pub(super) legend: Legend,
    /// The space on the right of all maps, subpixels.
    pub(super) beside: u32,
}

/// The width of a figure of `count` maps without what is beside them, subpixels: its legend may have that.
pub(super) fn width(count: usize) -> u32 {
    let columns = count.clamp(1, BESIDE) as u32;
    columns * (LEFT + map_size(count).0 + RIGHT_MARGIN)
}

fn map_size(count: usize) -> (u32, u32) {
    if count == 1 { ALONE } else { ONE_OF }
}

impl GridFrame<'_> {
    /// The size of a map, subpixels.
    pub(super) fn map(&self) -> (u32, u32) {
        map_size(self.titles.len())
    }

    /// From the top of one row of maps to that of the next.
    fn row(&self) -> u32 {
        MAP_TITLE + MARGIN + self.map().1 + BELOW + MARGIN
    }

    fn above(&self) -> u32 {
        TITLE + if self.remark.is_empty() { 0 } else { LEGEND_LINE } + self.legend.height()
    }

    /// The size of the figure, pixels.
    pub(super) fn size(&self) -> (u32, u32) {
        let rows = self.titles.len().div_ceil(BESIDE) as u32;
        let [width, height] = [width(self.titles.len()) + self.beside, self.above() + rows * self.row()];
        (width.div_ceil(FINE), height.div_ceil(FINE))
    }

    /// The corner at the upper left of a map, subpixels.
    pub(super) fn corner(&self, index: usize) -> (u32, u32) {
        let (column, row) = ((index % BESIDE) as u32, (index / BESIDE) as u32);
        let across = LEFT + self.map().0 + RIGHT_MARGIN;
        (column * across + LEFT, self.above() + row * self.row() + MAP_TITLE + MARGIN)
    }

    /// Where shares of the axes are drawn on a map.
    pub(super) fn place(&self, index: usize, (x, y): (f64, f64)) -> (i32, i32) {
        let ((left, top), (width, height)) = (self.corner(index), self.map());
        let along = |from: u32, size: u32, share: f64| (f64::from(from) + f64::from(size) * share).round() as i32;
        (along(left, width, x), along(top, height, 1.0 - y))
    }

    /// The share of each axis at the middles of so many columns and rows of a map, from the lowest row on.
    pub(super) fn places((columns, rows): (usize, usize)) -> impl Iterator<Item = (f64, f64)> {
        let middle = |i: usize, count: usize| (i as f64 + 0.5) / count as f64;
        (0..rows).flat_map(move |j| (0..columns).map(move |i| (middle(i, columns), middle(j, rows))))
    }

    /// Draws titles, the legend and the axes.
    pub(super) fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let middle = (width(self.titles.len()) / 2) as i32;
        let centred = text_style(TITLE_SIZE).pos(Pos::new(HPos::Center, VPos::Top));
        canvas.draw(&Text::new(self.title, (middle, MARGIN as i32), centred))?;
        if !self.remark.is_empty() {
            canvas.draw(&Text::new(self.remark, (LEFT as i32, (TITLE + MARGIN) as i32), text_style(TEXT_SIZE)))?;
        }
        let (width, height) = canvas.dim_in_pixel();
        let top = self.above() - self.legend.height();
        self.legend.draw(&canvas.clone().shrink((0, top), (width, height - top)))?;
        let [x, y] = self.axes.map(GridAxis::axis);
        for (index, title) in self.titles.iter().enumerate() {
            let (left, top) = self.corner(index);
            let corner = (left as i32, (top - MAP_TITLE) as i32);
            canvas.draw(&Text::new(*title, corner, text_style(TEXT_SIZE)))?;
            let size = (LEFT + self.map().0 + RIGHT_MARGIN, MARGIN + self.map().1 + BELOW + MARGIN);
            let own = canvas.clone().shrink((left - LEFT, top - MARGIN), size);
            draw_axes_without_lines(&mut context(&own, "", &x, &y)?, &x, &y)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_are_logarithmic_from_a_decade_on() {
        let axis = |loads: &[f64]| {
            let grid = SweepGrid { speeds: vec![1.0], loads: loads.to_vec(), temperatures: vec![] };
            GridAxis::of(SweptQuantity::Pressure, &grid).is_logarithmic
        };
        assert!(axis(&[1e5, 1e6]) && !axis(&[1e5, 9e5]));
    }
}
