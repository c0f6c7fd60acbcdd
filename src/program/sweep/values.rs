//! The values of a sweep and its shards as the command line gives them.

use crate::program::terminal::rounded;

/// Values of a quantity, rising, each once.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Values(pub(crate) Vec<f64>);

/// The spacing of the values of `a..b/n`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Spacing {
    Logarithmic,
    Linear,
}

/// Most values between two ends.
const MOST: usize = 10_000;
/// Significant digits of the values between two ends.
const DIGITS: usize = 6;

impl Values {
    /// Speeds, pressures or forces: `1e-4..10/20` is 20 values evenly spaced in the logarithm, ends included; also a
    /// list, or both separated by commas.
    pub(crate) fn in_logarithm(text: &str) -> Result<Self, String> {
        Self::parse(text, Spacing::Logarithmic)
    }

    /// Temperatures: `273..313/3` is 3 evenly spaced values.
    pub(crate) fn in_value(text: &str) -> Result<Self, String> {
        Self::parse(text, Spacing::Linear)
    }

    fn parse(text: &str, spacing: Spacing) -> Result<Self, String> {
        let parts: Result<Vec<Vec<f64>>, String> = text.split(',').map(|part| values(part.trim(), spacing)).collect();
        let mut all = parts?.concat();
        all.sort_by(f64::total_cmp);
        all.dedup();
        Ok(Self(all))
    }
}

fn values(part: &str, spacing: Spacing) -> Result<Vec<f64>, String> {
    let Some((low, rest)) = part.split_once("..") else { return Ok(vec![number(part)?]) };
    let (high, count) = rest.split_once('/').ok_or_else(|| wrong(part, "a..b/n, such as 1e-4..10/20"))?;
    let (low, high) = (number(low)?, number(high)?);
    let count: usize = count.trim().parse().map_err(|_| wrong(count, "a whole number of values"))?;
    if low >= high || !(2..=MOST).contains(&count) {
        return Err(wrong(part, &format!("a..b/n with a < b and 2 to {MOST} values")));
    }
    let last = count - 1;
    let at = |i: usize| match (i, spacing) {
        (0, _) => low,
        (i, _) if i == last => high,
        (i, Spacing::Logarithmic) => rounded(low * (high / low).powf(i as f64 / last as f64), DIGITS),
        (i, Spacing::Linear) => rounded(low + (high - low) * (i as f64 / last as f64), DIGITS),
    };
    Ok((0..count).map(at).collect())
}

fn number(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|&number| asperity::scene::is_possible(number) && number > 0.0);
    number.ok_or_else(|| wrong(text, "a positive number"))
}

fn wrong(found: &str, expected: &str) -> String {
    format!("expected {expected}, found {found:?}")
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shard {
    /// Counted from 1.
    index: usize,
    count: usize,
}

impl Shard {
    /// `I/N`, I from 1 to N.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(index, count)| Some((index.parse().ok()?, count.parse().ok()?)));
        match parts {
            Some((index, count)) if (1..=count).contains(&index) => Ok(Self { index, count }),
            _ => Err(wrong(text, "I/N with I from 1 to N, such as 3/8")),
        }
    }

    /// Whether the point of this index is in it: every `count`th is, so that all shards have slow and quick points.
    pub(super) fn has(self, index: usize) -> bool {
        index % self.count == self.index - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_lists_ranges_or_both() {
        let logarithm = |text| Values::in_logarithm(text).unwrap().0;
        assert_eq!(logarithm("1e-4..10/6"), [1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0]);
        assert_eq!(logarithm("2, 1,1..100/3,0.5"), [0.5, 1.0, 2.0, 10.0, 100.0]);
        assert_eq!(Values::in_value("273.15..313.15/3").unwrap().0, [273.15, 293.15, 313.15]);
        let even = logarithm("1e-2..10/20");
        // Rounded to six digits.
        let ratio = 10_f64.powf(3.0 / 19.0);
        assert!(even.len() == 20 && even.windows(2).all(|pair| (pair[1] / pair[0] / ratio - 1.0).abs() < 1e-5));
    }

    #[test]
    fn wrong_values_are_refused_with_what_was_expected() {
        for (text, part) in [
            ("", "a positive number"),
            ("1,,2", "a positive number"),
            ("-1", "a positive number"),
            ("0..1/3", "a positive number"),
            ("NaN", "a positive number"),
            ("1e99", "a positive number"),
            ("1..2", "a..b/n"),
            ("2..1/3", "a < b"),
            ("1..2/1", "2 to"),
            ("1..2/x", "a whole number"),
        ] {
            let message = Values::in_logarithm(text).unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
    }

    #[test]
    fn shards_share_all_points() {
        let shards: Vec<Shard> = ["1/3", "2/3", "3/3"].map(|text| Shard::parse(text).unwrap()).into();
        assert!((0..10).all(|number| shards.iter().filter(|shard| shard.has(number)).count() == 1));
        assert!(["0/3", "4/3", "1", "a/2", "1/0"].iter().all(|text| Shard::parse(text).is_err()));
    }
}
