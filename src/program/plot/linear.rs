//! Axes: a prefix for the unit, round places for the ticks, short labels.

/// An axis in a unit with a prefix, from one round tick to another.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axis {
    /// What is written beside the axis.
    pub(crate) title: String,
    /// What a value is multiplied by to be drawn.
    pub(crate) scale: f64,
    /// Lower end, in drawn values.
    pub(crate) low: f64,
    /// Upper end, in drawn values.
    pub(crate) high: f64,
    /// Number of ticks, both ends included.
    pub(crate) ticks: usize,
    decimals: usize,
}

/// How tight an axis lies around its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fit {
    /// Ends on the first and last value.
    Tight,
    /// Ends on ticks, 0 among them.
    Round,
}

const PREFIXES: [(&str, f64); 9] =
    [("G", 1e9), ("M", 1e6), ("k", 1e3), ("", 1.0), ("m", 1e-3), ("µ", 1e-6), ("n", 1e-9), ("p", 1e-12), ("f", 1e-15)];

impl Axis {
    /// An axis for `values` of `quantity` in `unit`; a unit that is empty takes no prefix.
    pub(crate) fn new(quantity: &str, unit: &str, values: impl Iterator<Item = f64>, fit: Fit) -> Self {
        let (mut low, mut high) = range(values);
        if fit == Fit::Round {
            (low, high) = (low.min(0.0), high.max(0.0));
        }
        let (prefix, factor) = prefix(low.abs().max(high.abs()), unit);
        let title = if unit.is_empty() { quantity.to_owned() } else { format!("{quantity} in {prefix}{unit}") };
        Self::with_range(title, 1.0 / factor, low / factor, high / factor, fit)
    }

    fn with_range(title: String, scale: f64, low: f64, high: f64, fit: Fit) -> Self {
        let (low, high) = if high > low { (low, high) } else { (low, low + 1.0) };
        let step = round_step((high - low) / 5.0);
        let (low, high) = match fit {
            Fit::Tight => (low, high),
            Fit::Round => ((low / step).floor() * step, (high / step).ceil() * step),
        };
        let ticks = ((high - low) / step).round() as usize + 1;
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        Self { title, scale, low, high, ticks, decimals }
    }

    /// The text at a tick.
    pub(crate) fn label(&self, drawn: f64) -> String {
        let text = format!("{drawn:.*}", self.decimals);
        if text.trim_start_matches('-').chars().all(|c| "0.".contains(c)) { "0".into() } else { text }
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

/// The smallest of 1, 2, 2.5 and 5 times a power of ten that is at least `step`.
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
        let axis = Axis::new("force", "N", [0.0, 0.0123].into_iter(), Fit::Round);
        assert_eq!(axis.title, "force in mN");
        assert!((axis.low, axis.high, axis.ticks) == (0.0, 15.0, 4), "{axis:?}");
        assert_eq!(axis.label(5.0), "5");
    }

    #[test]
    fn nothing_to_show_is_an_axis_from_0_to_1() {
        let axis = Axis::new("masses", "", std::iter::empty(), Fit::Round);
        assert_eq!((axis.low, axis.high), (0.0, 1.0));
        assert_eq!(axis.label(-0.04), "0");
    }
}
