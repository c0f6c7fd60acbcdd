//! A linear axis: a prefix for the unit, round places for the ticks, short labels.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged};
use plotters::coord::types::RangedCoordf64;

/// An axis in a unit with a prefix, from one round tick to another.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Linear {
    /// What a value is multiplied by to be drawn.
    pub(super) scale: f64,
    /// Number of ticks, both ends included.
    pub(super) ticks: usize,
    /// Lower end, in drawn values.
    low: f64,
    /// Upper end, in drawn values.
    high: f64,
    decimals: usize,
}

/// How tight an axis lies around its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fit {
    /// Ends on the first and last value.
    Tight,
    /// Ends on ticks, 0 among them.
    Round,
}

/// How far a curve may pass the last tick, as a share of the distance between two: a rounding below 0 takes no tick more.
const PAST_END: f64 = 0.01;

/// Ticks asked for of an axis that need not end on them: some fall outside.
const LEAST_TICKS: usize = 6;

const PREFIXES: [(&str, f64); 9] =
    [("G", 1e9), ("M", 1e6), ("k", 1e3), ("", 1.0), ("m", 1e-3), ("µ", 1e-6), ("n", 1e-9), ("p", 1e-12), ("f", 1e-15)];

impl Linear {
    /// An axis for `values` in `unit`, and the unit's prefix; a unit that is empty takes none.
    pub(super) fn around(values: impl Iterator<Item = f64>, unit: &str, fit: Fit) -> (Self, &'static str) {
        let (mut low, mut high) = range(values);
        if fit == Fit::Round {
            (low, high) = (low.min(0.0), high.max(0.0));
        }
        let (prefix, factor) = prefix(low.abs().max(high.abs()), unit);
        (Self::with_range(1.0 / factor, low / factor, high / factor, fit), prefix)
    }

    fn with_range(scale: f64, low: f64, high: f64, fit: Fit) -> Self {
        let (low, high) = if high > low { (low, high) } else { (low, low + 1.0) };
        let step = round_step((high - low) / 5.0);
        let (low, high) = match fit {
            Fit::Tight => (low, high),
            Fit::Round => ((low / step + PAST_END).floor() * step, (high / step - PAST_END).ceil() * step),
        };
        let ticks = ((high - low) / step).round() as usize + 1;
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        Self { scale, ticks: if fit == Fit::Tight { ticks.max(LEAST_TICKS) } else { ticks }, low, high, decimals }
    }

    /// The text at a tick.
    pub(super) fn label(&self, drawn: f64) -> String {
        let text = format!("{drawn:.*}", self.decimals);
        if text.trim_start_matches('-').chars().all(|c| "0.".contains(c)) { "0".into() } else { text }
    }
}

impl Ranged for Linear {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        RangedCoordf64::from(self.low..self.high).map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            return Vec::new();
        }
        RangedCoordf64::from(self.low..self.high).key_points(hint)
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

/// The finite values' range; 0 to 0 where there are none.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let finite = values.filter(|value| value.is_finite());
    let (low, high) = finite.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(value), high.max(value)));
    if low <= high { (low, high) } else { (0.0, 0.0) }
}

/// The largest prefix that leaves `largest` at 1 or more.
fn prefix(largest: f64, unit: &str) -> (&'static str, f64) {
    if unit.is_empty() || largest == 0.0 {
        return ("", 1.0);
    }
    PREFIXES.into_iter().find(|(_, factor)| largest >= 0.999 * factor).unwrap_or(("f", 1e-15))
}

/// The smallest of 1, 2 and 5 times a power of ten that is at least `step`.
fn round_step(step: f64) -> f64 {
    let decade = 10_f64.powf(step.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|factor| factor * decade >= 0.999 * step);
    factor.unwrap_or(10.0) * decade
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_ends_on_round_ticks_in_a_handy_unit() {
        let (axis, prefix) = Linear::around([0.0, 0.0123].into_iter(), "N", Fit::Round);
        assert_eq!(prefix, "m");
        assert!((axis.low, axis.high, axis.ticks) == (0.0, 15.0, 4), "{axis:?}");
        assert_eq!(axis.label(5.0), "5");
        let (axis, _) = Linear::around([-3e-11, 1e-3].into_iter(), "J", Fit::Round);
        assert!(axis.low == 0.0, "{axis:?}");
    }

    #[test]
    fn nothing_to_show_is_an_axis_from_0_to_1() {
        let (axis, _) = Linear::around(std::iter::empty(), "", Fit::Round);
        assert_eq!((axis.low, axis.high), (0.0, 1.0));
        assert_eq!(axis.label(-0.04), "0");
    }
}
