//! An axis: its title, and where values lie along it.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

use super::linear::{Fit, Linear};
use super::logarithmic::{Logarithmic, is_drawn};

/// An axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    /// What is written beside it.
    pub(super) title: String,
    scale: Scale,
}

#[derive(Clone, Debug, PartialEq)]
enum Scale {
    Linear(Linear),
    Logarithmic(Logarithmic),
}

impl Axis {
    /// A linear axis for `values` of `quantity` in `unit`; a unit that is empty takes no prefix.
    pub(super) fn linear(quantity: &str, unit: &str, values: impl Iterator<Item = f64>, fit: Fit) -> Self {
        let (linear, prefix) = Linear::around(values, unit, fit);
        let title = if unit.is_empty() { quantity.to_owned() } else { format!("{quantity} in {prefix}{unit}") };
        Self { title, scale: Scale::Linear(linear) }
    }

    /// A logarithmic axis around what can be drawn of `values`.
    pub(super) fn logarithmic(title: &str, values: impl Iterator<Item = f64>) -> Self {
        Self { title: title.to_owned(), scale: Scale::Logarithmic(Logarithmic::around(values)) }
    }

    /// The same axis with another title.
    pub(super) fn titled(&self, title: &str) -> Self {
        Self { title: title.to_owned(), scale: self.scale.clone() }
    }

    /// Where a value is drawn, as the axis counts; `None` where it has no place.
    pub(super) fn place(&self, value: f64) -> Option<f64> {
        match &self.scale {
            Scale::Linear(linear) => Some(value * linear.scale).filter(|drawn| drawn.is_finite()),
            Scale::Logarithmic(_) => Some(value).filter(|&value| is_drawn(value)),
        }
    }

    /// Ticks at most on `length` pixels, where each takes about `each`.
    pub(super) fn ticks(&self, length: u32, each: u32) -> usize {
        match &self.scale {
            Scale::Linear(linear) => linear.ticks,
            Scale::Logarithmic(_) => (length / each) as usize,
        }
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        match &self.scale {
            Scale::Linear(linear) => linear.map(value, limit),
            Scale::Logarithmic(logarithmic) => logarithmic.map(value, limit),
        }
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        match &self.scale {
            Scale::Linear(linear) => linear.key_points(hint),
            Scale::Logarithmic(logarithmic) => logarithmic.key_points(hint),
        }
    }

    fn range(&self) -> Range<f64> {
        match &self.scale {
            Scale::Linear(linear) => linear.range(),
            Scale::Logarithmic(logarithmic) => logarithmic.range(),
        }
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        match &self.scale {
            Scale::Linear(linear) => linear.label(*value),
            Scale::Logarithmic(logarithmic) => logarithmic.label(*value),
        }
    }
}
