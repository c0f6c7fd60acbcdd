//! A logarithmic axis: it ends on 1, 2 or 5 times a power of ten, and its ticks are there or on the powers alone.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

/// A logarithmic axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Logarithmic {
    low: f64,
    high: f64,
}

/// The ends that an axis may have, and the ticks of a short one.
const ROUND: [f64; 3] = [1.0, 2.0, 5.0];
/// A longer axis, in powers of ten, has its ticks on these alone.
const SHORT: f64 = 2.0;
/// A value on an end but for rounding is on it.
const ROUNDING: f64 = 1e-9;

impl Logarithmic {
    /// An axis around what can be drawn of `values`; from 0.1 to 1 where there is nothing.
    pub(super) fn around(values: impl Iterator<Item = f64>) -> Self {
        let drawn = values.filter(|&value| is_drawn(value));
        let (low, high) = drawn.fold((f64::MAX, 0.0), |(low, high), value| (value.min(low), value.max(high)));
        if low > high {
            return Self { low: 0.1, high: 1.0 };
        }
        let round = || powers(low, high).flat_map(|power| ROUND.map(|times| times * power));
        let below = round().filter(|end| *end <= low * (1.0 + ROUNDING)).fold(0.0, f64::max);
        let above = round().filter(|end| *end > below && *end >= high * (1.0 - ROUNDING)).fold(f64::MAX, f64::min);
        Self { low: below, high: above }
    }

    /// What is written at a tick: short numbers as they are, others as powers of ten.
    pub(super) fn label(self, value: f64) -> String {
        if self.is_short() && (1e-3..1e4).contains(&value) {
            return format!("{value:.0$}", (-value.log10() - ROUNDING).ceil().max(0.0) as usize);
        }
        let exponent = (value.log10() + ROUNDING).floor();
        let times = value / 10_f64.powf(exponent);
        let factor = if times < 1.5 { String::new() } else { format!("{times:.0}·") };
        format!("{factor}10{}", raised(exponent))
    }

    fn decades(self) -> f64 {
        (self.high / self.low).log10()
    }

    fn is_short(self) -> bool {
        self.decades() <= SHORT + ROUNDING
    }

    /// The values at some multiples of powers of ten that are on the axis.
    fn ticks(self, multiples: &[f64]) -> Vec<f64> {
        let all = powers(self.low, self.high).flat_map(|power| multiples.iter().map(move |times| times * power));
        all.filter(|&tick| tick >= self.low * (1.0 - ROUNDING) && tick <= self.high * (1.0 + ROUNDING)).collect()
    }
}

/// Whether a logarithmic axis has a place for it.
pub(super) fn is_drawn(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

/// The powers of ten from the one below `low` to the one above `high`.
fn powers(low: f64, high: f64) -> impl Iterator<Item = f64> {
    let exponents = low.log10().floor() as i32 - 1..=high.log10().ceil() as i32 + 1;
    exponents.map(|exponent| 10_f64.powi(exponent))
}

/// A whole number as it is raised by hand.
fn raised(exponent: f64) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let letters = format!("{exponent:.0}");
    letters.chars().map(|letter| letter.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize])).collect()
}

impl Ranged for Logarithmic {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (value / self.low).log10() / self.decades();
        from + (f64::from(to - from) * share).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            return self.ticks(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
        }
        if self.is_short() {
            return self.ticks(&ROUND);
        }
        let ticks = self.ticks(&[1.0]);
        let every = ticks.len().div_ceil(hint.max_num_points().max(1));
        ticks.into_iter().step_by(every).collect()
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Logarithmic {
    fn format_ext(&self, value: &f64) -> String {
        self.label(*value)
    }
}

#[cfg(test)]
mod tests {
    use plotters::coord::ranged1d::BoldPoints;

    use super::*;

    fn around(values: &[f64]) -> (f64, f64) {
        let axis = Logarithmic::around(values.iter().copied());
        (axis.low, axis.high)
    }

    fn labels(axis: Logarithmic) -> Vec<String> {
        axis.key_points(BoldPoints(10)).into_iter().map(|tick| axis.label(tick)).collect()
    }

    #[test]
    fn an_axis_ends_on_round_numbers_around_what_can_be_drawn() {
        assert_eq!(around(&[3e-3, 0.6, 0.0, f64::NAN, f64::INFINITY]), (2e-3, 1.0));
        assert_eq!(around(&[0.01]), (0.01, 0.02));
        assert_eq!(around(&[]), (0.1, 1.0));
    }

    #[test]
    fn a_short_axis_has_plain_numbers_and_a_long_one_powers() {
        assert_eq!(labels(Logarithmic { low: 0.2, high: 10.0 }), ["0.2", "0.5", "1", "2", "5", "10"]);
        assert_eq!(labels(Logarithmic { low: 0.05, high: 5.0 }), ["0.05", "0.1", "0.2", "0.5", "1", "2", "5"]);
        assert_eq!(labels(Logarithmic { low: 2e-5, high: 1e-4 }), ["2·10⁻⁵", "5·10⁻⁵", "10⁻⁴"]);
        assert_eq!(labels(Logarithmic { low: 0.05, high: 200.0 }), ["10⁻¹", "10⁰", "10¹", "10²"]);
        assert_eq!(labels(Logarithmic { low: 1e-12, high: 1.0 })[..2], ["10⁻¹²", "10⁻¹⁰"]);
    }

    #[test]
    fn ends_are_drawn_at_the_ends() {
        let axis = Logarithmic { low: 0.2, high: 20.0 };
        assert_eq!([0.2, 2.0, 20.0].map(|value| axis.map(&value, (100, 500))), [100, 300, 500]);
    }
}
