//! An axis of a panel: its quantity and unit, its ends, its ticks and their names.

use serde::ser::SerializeStruct as _;
use serde::{Deserialize, Serialize, Serializer};

use crate::decimals::{prefix, short};

/// An axis, or a scale of colours.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Axis {
    /// What it is of; empty for nothing.
    pub quantity: String,
    /// In which values are given; a linear axis shows it with a prefix. Empty for a number.
    pub unit: String,
    /// Whether equal ratios are equally long.
    pub is_logarithmic: bool,
    /// The end at the left or below.
    pub low: f64,
    /// The end at the right or above.
    pub high: f64,
    /// Its ticks where they are not those of its numbers.
    pub named: Vec<Tick>,
}

/// A place of an axis with a name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tick {
    /// In the unit of the axis.
    pub at: f64,
    /// What is written there.
    pub name: String,
}

/// How a linear axis fits its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// From the least to the largest value.
    Tight,
    /// From tick to tick, with 0 between them.
    Round,
}

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

/// With what those who draw it elsewhere need besides: its title, and the factor of the unit's prefix there.
impl Serialize for Axis {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut axis = serializer.serialize_struct("Axis", 8)?;
        axis.serialize_field("quantity", &self.quantity)?;
        axis.serialize_field("unit", &self.unit)?;
        axis.serialize_field("is_logarithmic", &self.is_logarithmic)?;
        axis.serialize_field("low", &self.low)?;
        axis.serialize_field("high", &self.high)?;
        axis.serialize_field("named", &self.named)?;
        axis.serialize_field("title", &self.title())?;
        axis.serialize_field("factor", &self.prefix().1)?;
        axis.end()
    }
}

impl Axis {
    fn new((quantity, unit): (&str, &str), (low, high): (f64, f64), is_logarithmic: bool) -> Self {
        Self { quantity: quantity.into(), unit: unit.into(), is_logarithmic, low, high, named: Vec::new() }
    }

    /// A linear axis of a quantity and its unit for the finite ones of `values`; from 0 to 1 where there are none.
    pub fn linear(of: (&str, &str), values: impl IntoIterator<Item = f64>, fit: Fit) -> Self {
        let finite = values.into_iter().filter(|value| value.is_finite());
        let (mut low, mut high) = range(finite).unwrap_or_default();
        if fit == Fit::Round {
            (low, high) = (low.min(0.0), high.max(0.0));
        }
        if low >= high {
            high = low + prefix(low.abs(), of.1).1;
        }
        if fit == Fit::Round {
            let step = round_step((high - low) / 5.0);
            low = (low / step + PAST_END).floor() * step;
            high = (high / step - PAST_END).ceil() * step;
        }
        Self::new(of, (low, high), false)
    }

    /// A logarithmic axis around those of `values` that it can show, between 1, 2 or 5 times powers of ten; from 0.1 to
    /// 1 where there are none.
    pub fn logarithmic(of: (&str, &str), values: impl IntoIterator<Item = f64>) -> Self {
        let ends = range(values.into_iter().filter(|&value| is_loggable(value))).map_or((0.1, 1.0), round_ends);
        Self::new(of, ends, true)
    }

    /// A logarithmic axis from the least to the largest of `values` that it can show; from 0.1 to 1 where there are no
    /// two.
    pub fn logarithmic_tight(of: (&str, &str), values: impl IntoIterator<Item = f64>) -> Self {
        let ends = range(values.into_iter().filter(|&value| is_loggable(value))).filter(|(low, high)| low < high);
        Self::new(of, ends.unwrap_or((0.1, 1.0)), true)
    }

    /// A vertical axis of names, the first of them at 0 above the others at -1, -2 and so on.
    pub fn names(names: impl IntoIterator<Item = String>) -> Self {
        let named: Vec<Tick> = (0..).zip(names).map(|(row, name)| Tick { at: -f64::from(row), name }).collect();
        Self { named: named.clone(), ..Self::new(("", ""), (0.5 - named.len().max(1) as f64, 0.5), false) }
    }

    /// The same axis of another quantity.
    pub fn titled(&self, quantity: &str) -> Self {
        Self { quantity: quantity.into(), ..self.clone() }
    }

    /// The quantity and its unit.
    pub fn title(&self) -> String {
        if self.unit.is_empty() || self.quantity.is_empty() {
            return self.quantity.clone();
        }
        format!("{} in {}{}", self.quantity, self.prefix().0, self.unit)
    }

    /// The prefix of the unit and its factor.
    fn prefix(&self) -> (&'static str, f64) {
        if self.is_logarithmic { ("", 1.0) } else { prefix(self.low.abs().max(self.high.abs()), &self.unit) }
    }

    /// Where a value is drawn, up to a scale and an origin; `None` where the axis cannot show it.
    pub fn coordinate(&self, value: f64) -> Option<f64> {
        match self.is_logarithmic {
            true => is_loggable(value).then(|| value.ln()),
            false => Some(value).filter(|value| value.is_finite()),
        }
    }

    /// How far a value is along the axis, from 0 to 1.
    pub fn share(&self, value: f64) -> Option<f64> {
        let [low, high, at] = [self.low, self.high, value].map(|value| self.coordinate(value));
        Some((at? - low?) / (high? - low?))
    }

    /// The value so far along the axis.
    pub fn value(&self, share: f64) -> f64 {
        match self.is_logarithmic {
            true => (self.low.ln() + share * (self.high / self.low).ln()).exp(),
            false => self.low + share * (self.high - self.low),
        }
    }

    /// Whether a value is between its ends.
    pub fn has(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// The ticks with their names, at most about `most` of them on a logarithmic axis.
    pub fn ticks(&self, most: usize) -> Vec<Tick> {
        if !self.named.is_empty() {
            return self.named.clone();
        }
        let (places, step) = match self.is_logarithmic {
            true => (self.powers_of_ten(most), 0.0),
            false => {
                let step = round_step((self.high - self.low) / 7.0);
                let [first, last] = [(self.low / step - ROUNDING).ceil(), (self.high / step + ROUNDING).floor()];
                ((first as i64..=last as i64).map(|i| i as f64 * step).collect(), step)
            }
        };
        places.into_iter().map(|at| Tick { at, name: self.name(at, step) }).collect()
    }

    /// The places of ticks without names, of a logarithmic axis alone.
    pub fn fine_ticks(&self) -> Vec<f64> {
        if self.is_logarithmic { self.multiples(&DIGITS) } else { Vec::new() }
    }

    fn powers_of_ten(&self, most: usize) -> Vec<f64> {
        if self.is_short() {
            let ticks = [&ROUND[..], &DIGITS].map(|of| self.multiples(of));
            return ticks.into_iter().find(|ticks| ticks.len() > 1).unwrap_or_else(|| vec![self.low, self.high]);
        }
        let ticks = self.multiples(&[1.0]);
        let every = ticks.len().div_ceil(most.max(1));
        ticks.into_iter().step_by(every).collect()
    }

    /// Those values of a logarithmic axis that are multiples of powers of ten.
    fn multiples(&self, of: &[f64]) -> Vec<f64> {
        let all = powers(self.low, self.high).flat_map(|power| of.iter().map(move |times| times * power));
        all.filter(|&tick| tick >= self.low * (1.0 - ROUNDING) && tick <= self.high * (1.0 + ROUNDING)).collect()
    }

    /// Whether a logarithmic axis has ticks between the powers of ten.
    fn is_short(&self) -> bool {
        (self.high / self.low).log10() <= SHORT + ROUNDING
    }

    /// The text at a tick among others that are a `step` apart; on a logarithmic axis a short number as it is, others as
    /// powers of ten.
    fn name(&self, at: f64, step: f64) -> String {
        if !self.is_logarithmic {
            let unit = self.prefix().1;
            let digits = (-(step / unit * (1.0 + ROUNDING)).log10().floor()).max(0.0) as usize;
            let text = format!("{:.digits$}", at / unit);
            return if text.trim_start_matches('-').chars().all(|c| "0.".contains(c)) { "0".into() } else { text };
        }
        if self.is_short() && (1e-3..1e4).contains(&at) {
            return short(at, 3);
        }
        let exponent = (at.log10() + ROUNDING).floor();
        let times = at / 10_f64.powf(exponent);
        let factor = if times < 1.5 { String::new() } else { format!("{times:.0}·") };
        format!("{factor}{}", power_of_ten(exponent as i32))
    }
}

/// Whether a logarithmic axis can show a value.
pub fn is_loggable(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

/// A power of ten as it is written by hand.
pub fn power_of_ten(exponent: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digits = exponent.to_string();
    let raised = digits.chars().map(|digit| digit.to_digit(10).map_or('⁻', |digit| RAISED[digit as usize]));
    format!("10{}", raised.collect::<String>())
}

/// The largest of 1, 2 and 5 times a power of ten that is at most `value`; 0 where that is.
pub fn rounded_down(value: f64) -> f64 {
    let decade = 10_f64.powf(value.log10().floor());
    let round = [5.0, 2.0, 1.0].into_iter().map(|factor| factor * decade);
    round.into_iter().find(|round| *round <= value * (1.0 + ROUNDING)).unwrap_or_default()
}

/// The least and the largest value.
fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values
        .fold(None, |range, value| Some(range.map_or((value, value), |(low, high)| (value.min(low), value.max(high)))))
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

#[cfg(test)]
mod tests {
    use super::*;

    fn names(axis: &Axis) -> Vec<String> {
        axis.ticks(10).into_iter().map(|tick| tick.name).collect()
    }

    fn logarithmic(low: f64, high: f64) -> Axis {
        Axis::new(("", ""), (low, high), true)
    }

    fn around(values: &[f64]) -> (f64, f64) {
        let axis = Axis::logarithmic(("", ""), values.iter().copied());
        (axis.low, axis.high)
    }

    #[test]
    fn a_linear_axis_ends_on_round_ticks_and_has_a_prefix() {
        let axis = Axis::linear(("force", "N"), [0.0, 0.0123], Fit::Round);
        assert_eq!((axis.title().as_str(), axis.low, axis.high), ("force in mN", 0.0, 0.015));
        assert_eq!(names(&axis), ["0", "5", "10", "15"]);
        let axis = Axis::linear(("energy", "J"), [-3e-11, 1e-3], Fit::Round);
        assert!(axis.low == 0.0, "{axis:?}");
        let axis = Axis::linear(("time", "s"), [0.0, 0.011], Fit::Tight);
        assert_eq!((axis.high, names(&axis)), (0.011, ["0", "2", "4", "6", "8", "10"].map(String::from).to_vec()));
    }

    #[test]
    fn a_linear_axis_without_values_goes_from_0_to_1() {
        let axis = Axis::linear(("", ""), [f64::NAN], Fit::Round);
        assert_eq!((axis.low, axis.high), (0.0, 1.0));
        assert_eq!(axis.name(-0.04, 0.2), "0");
    }

    #[test]
    fn a_logarithmic_axis_ends_on_round_numbers_around_what_it_can_show() {
        assert_eq!(around(&[3e-3, 0.6, 0.0, f64::NAN, f64::INFINITY]), (2e-3, 1.0));
        assert_eq!(around(&[0.01]), (0.01, 0.02));
        assert_eq!(around(&[]), (0.1, 1.0));
    }

    #[test]
    fn a_short_logarithmic_axis_has_plain_numbers_and_a_long_one_powers() {
        assert_eq!(names(&logarithmic(0.2, 10.0)), ["0.2", "0.5", "1", "2", "5", "10"]);
        assert_eq!(names(&logarithmic(2e-5, 1e-4)), ["2·10⁻⁵", "5·10⁻⁵", "10⁻⁴"]);
        assert_eq!(names(&logarithmic(0.05, 200.0)), ["10⁻¹", "10⁰", "10¹", "10²"]);
        assert_eq!(names(&logarithmic(1e-12, 1.0))[..2], ["10⁻¹²", "10⁻¹⁰"]);
    }

    #[test]
    fn a_tight_logarithmic_axis_has_two_ticks_however_short_it_is() {
        let tight = |low, high| names(&Axis::logarithmic_tight(("", ""), [high, low]));
        assert_eq!(tight(3e-4, 0.3), ["10⁻³", "10⁻²", "10⁻¹"]);
        assert_eq!(tight(0.3, 3.0), ["0.5", "1", "2"]);
        assert_eq!(tight(3.0, 4.5), ["3", "4"]);
        assert_eq!(tight(1.25, 1.75), ["1.25", "1.75"]);
        assert_eq!(Axis::logarithmic_tight(("", ""), [3.0]), logarithmic(0.1, 1.0));
    }

    #[test]
    fn a_share_of_an_axis_is_that_of_its_value() {
        let axis = logarithmic(0.2, 20.0);
        assert_eq!([0.2, 20.0, -1.0].map(|value| axis.share(value)), [Some(0.0), Some(1.0), None]);
        assert!((axis.value(0.5) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_round_number_is_at_most_the_value() {
        assert_eq!([0.0, 1.0, 4.99e5, 0.7].map(rounded_down), [0.0, 1.0, 2e5, 0.5]);
    }
}
