//! An axis of a chart: its title, its range, its ticks and their labels. plotters' own axes have neither prefixes of
//! units nor powers of ten as labels, and do not end on ticks.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::coord::types::RangedCoordf64;

use asperity_study::decimals::{prefix, short};

/// How far a curve may pass the last tick, as a share of the distance between two: a rounding error below 0 adds no
/// tick.
const PAST_END: f64 = 0.01;

/// The leading digits of the ends of a logarithmic axis, and of the ticks of a short one.
const ROUND: [f64; 3] = [1.0, 2.0, 5.0];
const DIGITS: [f64; 9] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
/// A logarithmic axis over more decades has its ticks at powers of ten alone.
const SHORT: f64 = 2.0;
/// A relative difference that counts as rounding.
const ROUNDING: f64 = 1e-9;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    pub(super) title: String,
    scale: Scale,
    /// Both ends, in drawn values.
    low: f64,
    high: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Scale {
    /// A value times `factor` is drawn; ticks are multiples of `step`.
    Linear {
        factor: f64,
        step: f64,
    },
    Logarithmic,
}

/// How a linear axis fits its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fit {
    /// From the least to the largest value.
    Tight,
    /// From tick to tick, with 0 between them.
    Round,
}

impl Axis {
    /// A linear axis for the finite ones of `values` of `quantity` in `unit`, which gets a prefix unless it is empty;
    /// from 0 to 1 where there are none.
    pub(super) fn linear(quantity: &str, unit: &str, values: impl Iterator<Item = f64>, fit: Fit) -> Self {
        let (mut low, mut high) = range(values.filter(|value| value.is_finite())).unwrap_or_default();
        if fit == Fit::Round {
            (low, high) = (low.min(0.0), high.max(0.0));
        }
        let (prefix, unit_size) = prefix(low.abs().max(high.abs()), unit);
        (low, high) = (low / unit_size, high / unit_size);
        if low >= high {
            high = low + 1.0;
        }
        let step = round_step((high - low) / if fit == Fit::Round { 5.0 } else { 6.0 });
        if fit == Fit::Round {
            low = (low / step + PAST_END).floor() * step;
            high = (high / step - PAST_END).ceil() * step;
        }
        let title = if unit.is_empty() { quantity.to_owned() } else { format!("{quantity} in {prefix}{unit}") };
        Self { title, scale: Scale::Linear { factor: 1.0 / unit_size, step }, low, high }
    }

    /// A logarithmic axis around those of `values` that it can show, between 1, 2 or 5 times powers of ten; from 0.1
    /// to 1 where there are none.
    pub(super) fn logarithmic(title: &str, values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = range(values.filter(|&value| is_loggable(value))).map_or((0.1, 1.0), round_ends);
        Self { title: title.to_owned(), scale: Scale::Logarithmic, low, high }
    }

    /// A logarithmic axis from the least to the largest of `values` that it can show; from 0.1 to 1 where there are no two.
    pub(super) fn logarithmic_tight(title: &str, values: impl Iterator<Item = f64>) -> Self {
        let ends = range(values.filter(|&value| is_loggable(value))).filter(|(low, high)| low < high);
        let (low, high) = ends.unwrap_or((0.1, 1.0));
        Self { title: title.to_owned(), scale: Scale::Logarithmic, low, high }
    }

    /// The same axis with another title.
    pub(super) fn titled(&self, title: &str) -> Self {
        Self { title: title.to_owned(), ..self.clone() }
    }

    /// The drawn value of `value`; `None` where the axis cannot show it.
    pub(super) fn coordinate(&self, value: f64) -> Option<f64> {
        match self.scale {
            Scale::Linear { factor, .. } => Some(value * factor).filter(|drawn| drawn.is_finite()),
            Scale::Logarithmic => Some(value).filter(|&value| is_loggable(value)),
        }
    }

    /// The ticks with labels, at most about `most` of them on a logarithmic axis.
    pub(super) fn ticks(&self, most: usize) -> Vec<f64> {
        match self.scale {
            Scale::Linear { step, .. } => {
                let [first, last] = [(self.low / step - ROUNDING).ceil(), (self.high / step + ROUNDING).floor()];
                (first as i64..=last as i64).map(|i| i as f64 * step).collect()
            }
            Scale::Logarithmic if self.is_short() => {
                let ticks = [&ROUND[..], &DIGITS].map(|of| self.multiples(of));
                let found = ticks.into_iter().find(|ticks| ticks.len() > 1);
                found.unwrap_or_else(|| vec![self.low, self.high])
            }
            Scale::Logarithmic => {
                let ticks = self.multiples(&[1.0]);
                let every = ticks.len().div_ceil(most.max(1));
                ticks.into_iter().step_by(every).collect()
            }
        }
    }

    /// Those of a logarithmic axis' values that are multiples of powers of ten.
    fn multiples(&self, of: &[f64]) -> Vec<f64> {
        let all = powers(self.low, self.high).flat_map(|power| of.iter().map(move |times| times * power));
        all.filter(|&tick| tick >= self.low * (1.0 - ROUNDING) && tick <= self.high * (1.0 + ROUNDING)).collect()
    }

    /// Whether a logarithmic axis has ticks between the powers of ten.
    fn is_short(&self) -> bool {
        (self.high / self.low).log10() <= SHORT + ROUNDING
    }

    /// The text at a tick; on a logarithmic axis a short number as it is, others as powers of ten.
    fn label(&self, drawn: f64) -> String {
        match self.scale {
            Scale::Linear { step, .. } => {
                let text = format!("{drawn:.*}", (-step.log10().floor()).max(0.0) as usize);
                if text.trim_start_matches('-').chars().all(|c| "0.".contains(c)) { "0".into() } else { text }
            }
            Scale::Logarithmic if self.is_short() && (1e-3..1e4).contains(&drawn) => short(drawn, 3),
            Scale::Logarithmic => {
                let exponent = (drawn.log10() + ROUNDING).floor();
                let times = drawn / 10_f64.powf(exponent);
                let factor = if times < 1.5 { String::new() } else { format!("{times:.0}·") };
                format!("{factor}10{}", superscript(exponent))
            }
        }
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        match self.scale {
            Scale::Linear { .. } => RangedCoordf64::from(self.low..self.high).map(value, limit),
            Scale::Logarithmic => RangedCoordf64::from(self.low.log10()..self.high.log10()).map(&value.log10(), limit),
        }
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        match (self.scale, hint.weight().allow_light_points()) {
            (Scale::Linear { .. }, true) => Vec::new(),
            (Scale::Logarithmic, true) => self.multiples(&DIGITS),
            (_, false) => self.ticks(hint.max_num_points()),
        }
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        self.label(*value)
    }
}

/// Whether a logarithmic axis can show a value.
pub(super) fn is_loggable(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

/// The least and the largest value.
fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values
        .fold(None, |range, value| Some(range.map_or((value, value), |(low, high)| (value.min(low), value.max(high)))))
}

/// The largest of 1, 2 and 5 times a power of ten that is at most `value`; 0 where that is.
pub(super) fn rounded_down(value: f64) -> f64 {
    let decade = 10_f64.powf(value.log10().floor());
    let round = [5.0, 2.0, 1.0].into_iter().map(|factor| factor * decade);
    round.into_iter().find(|round| *round <= value * (1.0 + ROUNDING)).unwrap_or_default()
}

/// The smallest of 1, 2 and 5 times a power of ten that is at least `step`.
fn round_step(step: f64) -> f64 {
    let decade = 10_f64.powf(step.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|factor| factor * decade >= 0.999 * step);
    factor.unwrap_or(10.0) * decade
}

/// The nearest ends around `low` to `high` that a logarithmic axis may have.
fn round_ends((low, high): (f64, f64)) -> (f64, f64) {
    let round = || powers(low, high).flat_map(|power| ROUND.map(|times| times * power));
    let below = round().filter(|end| *end <= low * (1.0 + ROUNDING)).fold(0.0, f64::max);
    let above = round().filter(|end| *end > below && *end >= high * (1.0 - ROUNDING)).fold(f64::MAX, f64::min);
    (below, above)
}

/// The powers of ten from below `low` to above `high`.
fn powers(low: f64, high: f64) -> impl Iterator<Item = f64> {
    let exponents = low.log10().floor() as i32 - 1..=high.log10().ceil() as i32 + 1;
    exponents.map(|exponent| 10_f64.powi(exponent))
}

/// A whole number in superscript.
fn superscript(exponent: f64) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let letters = format!("{exponent:.0}");
    letters.chars().map(|letter| letter.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, most: usize) -> Vec<String> {
        axis.ticks(most).into_iter().map(|tick| axis.label(tick)).collect()
    }

    fn logarithmic(low: f64, high: f64) -> Axis {
        Axis { title: String::new(), scale: Scale::Logarithmic, low, high }
    }

    fn around(values: &[f64]) -> (f64, f64) {
        let axis = Axis::logarithmic("", values.iter().copied());
        (axis.low, axis.high)
    }

    #[test]
    fn a_linear_axis_ends_on_round_ticks_and_has_a_prefix() {
        let axis = Axis::linear("force", "N", [0.0, 0.0123].into_iter(), Fit::Round);
        assert_eq!((axis.title.as_str(), axis.low, axis.high), ("force in mN", 0.0, 15.0));
        assert_eq!(labels(&axis, 0), ["0", "5", "10", "15"]);
        assert_eq!(axis.coordinate(0.01), Some(10.0));
        let axis = Axis::linear("energy", "J", [-3e-11, 1e-3].into_iter(), Fit::Round);
        assert!(axis.low == 0.0, "{axis:?}");
        let axis = Axis::linear("time", "s", [0.0, 0.011].into_iter(), Fit::Tight);
        assert_eq!((axis.high, labels(&axis, 0)), (11.0, ["0", "2", "4", "6", "8", "10"].map(String::from).to_vec()));
    }

    #[test]
    fn a_linear_axis_without_values_goes_from_0_to_1() {
        let axis = Axis::linear("", "", [f64::NAN].into_iter(), Fit::Round);
        assert_eq!((axis.low, axis.high), (0.0, 1.0));
        assert_eq!(axis.label(-0.04), "0");
    }

    #[test]
    fn a_logarithmic_axis_ends_on_round_numbers_around_what_it_can_show() {
        assert_eq!(around(&[3e-3, 0.6, 0.0, f64::NAN, f64::INFINITY]), (2e-3, 1.0));
        assert_eq!(around(&[0.01]), (0.01, 0.02));
        assert_eq!(around(&[]), (0.1, 1.0));
    }

    #[test]
    fn a_short_logarithmic_axis_has_plain_numbers_and_a_long_one_powers() {
        assert_eq!(labels(&logarithmic(0.2, 10.0), 10), ["0.2", "0.5", "1", "2", "5", "10"]);
        assert_eq!(labels(&logarithmic(0.05, 5.0), 10), ["0.05", "0.1", "0.2", "0.5", "1", "2", "5"]);
        assert_eq!(labels(&logarithmic(2e-5, 1e-4), 10), ["2·10⁻⁵", "5·10⁻⁵", "10⁻⁴"]);
        assert_eq!(labels(&logarithmic(0.05, 200.0), 10), ["10⁻¹", "10⁰", "10¹", "10²"]);
        assert_eq!(labels(&logarithmic(1e-12, 1.0), 10)[..2], ["10⁻¹²", "10⁻¹⁰"]);
    }

    #[test]
    fn a_tight_logarithmic_axis_has_two_ticks_however_short_it_is() {
        let tight = |low, high| labels(&Axis::logarithmic_tight("", [high, low].into_iter()), 10);
        assert_eq!(tight(3e-4, 0.3), ["10⁻³", "10⁻²", "10⁻¹"]);
        assert_eq!(tight(0.3, 3.0), ["0.5", "1", "2"]);
        assert_eq!(tight(3.0, 4.5), ["3", "4"]);
        assert_eq!(tight(1.25, 1.75), ["1.25", "1.75"]);
        assert_eq!(Axis::logarithmic_tight("", [3.0].into_iter()), logarithmic(0.1, 1.0));
    }

    #[test]
    fn a_round_number_is_at_most_the_value() {
        assert_eq!([0.0, 1.0, 4.99e5, 0.7].map(rounded_down), [0.0, 1.0, 2e5, 0.5]);
    }

    #[test]
    fn ends_are_drawn_at_the_ends() {
        assert_eq!([0.2, 2.0, 20.0].map(|value| logarithmic(0.2, 20.0).map(&value, (100, 500))), [100, 300, 500]);
    }
}
