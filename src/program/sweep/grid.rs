//! The points of a sweep: values as the command line gives them, their product, its shards.

use std::fmt;

use crate::program::text::rounded;

/// Values of one quantity, rising, each once.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Values(pub(crate) Vec<f64>);

/// How `a..b/n` is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Even {
    InLogarithm,
    InValue,
}

/// The most values of one quantity.
const MOST: usize = 10_000;
/// Digits that a value between two ends keeps: enough to be even, few enough to be read.
const DIGITS: usize = 6;

impl Values {
    /// Speeds, pressures or forces: `1e-4..10/20` is 20 values evenly in the logarithm, ends included; also a list, or
    /// both joined by commas.
    pub(crate) fn in_logarithm(text: &str) -> Result<Self, String> {
        Self::parse(text, Even::InLogarithm)
    }

    /// Temperatures: `273..313/3` is 3 values evenly.
    pub(crate) fn in_value(text: &str) -> Result<Self, String> {
        Self::parse(text, Even::InValue)
    }

    fn parse(text: &str, even: Even) -> Result<Self, String> {
        let parts: Result<Vec<Vec<f64>>, String> = text.split(',').map(|part| values(part.trim(), even)).collect();
        let mut all = parts?.concat();
        all.sort_by(f64::total_cmp);
        all.dedup();
        Ok(Self(all))
    }
}

/// Those of a header: `0.1,1,10`.
impl fmt::Display for Values {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let texts: Vec<String> = self.0.iter().map(|&value| crate::program::result_file::real(value)).collect();
        f.write_str(&texts.join(","))
    }
}

fn values(part: &str, even: Even) -> Result<Vec<f64>, String> {
    let Some((low, rest)) = part.split_once("..") else { return Ok(vec![number(part)?]) };
    let (high, count) = rest.split_once('/').ok_or_else(|| wrong(part, "a..b/n, such as 1e-4..10/20"))?;
    let (low, high) = (number(low)?, number(high)?);
    let count: usize = count.trim().parse().map_err(|_| wrong(count, "a whole number of values"))?;
    if low >= high || !(2..=MOST).contains(&count) {
        return Err(wrong(part, &format!("a..b/n with a < b and 2 to {MOST} values")));
    }
    let last = count - 1;
    let at = |i: usize| match (i, even) {
        (0, _) => low,
        (i, _) if i == last => high,
        (i, Even::InLogarithm) => rounded(low * (high / low).powf(i as f64 / last as f64), DIGITS),
        (i, Even::InValue) => rounded(low + (high - low) * (i as f64 / last as f64), DIGITS),
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

/// One point of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    /// m/s.
    pub(super) speed: f64,
    /// Pressure, Pa, or force, N.
    pub(super) load: f64,
    /// K; `None` where the scene knows no temperature.
    pub(super) temperature: Option<f64>,
}

/// All points: every speed at every load at every temperature.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    pub(super) speeds: Values,
    pub(super) loads: Values,
    /// `None` where the scene knows no temperature.
    pub(super) temperatures: Option<Values>,
}

impl Grid {
    /// The points by temperature, load, speed.
    pub(super) fn points(&self) -> Vec<Point> {
        let temperatures = match &self.temperatures {
            Some(values) => values.0.iter().map(|&value| Some(value)).collect(),
            None => vec![None],
        };
        let at = |temperature: Option<f64>, load: f64| {
            self.speeds.0.iter().map(move |&speed| Point { speed, load, temperature })
        };
        let loads = |temperature| self.loads.0.iter().flat_map(move |&load| at(temperature, load));
        temperatures.into_iter().flat_map(loads).collect()
    }
}

/// One share of a sweep.
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

    /// Whether the point with this number is in it: every `count`th is, so that all shards have slow and quick ones.
    pub(super) fn has(self, number: usize) -> bool {
        number % self.count == self.index - 1
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

    #[test]
    fn points_come_by_temperature_load_and_speed() {
        let values = |list: &[f64]| Values(list.to_vec());
        let grid =
            Grid { speeds: values(&[1.0, 2.0]), loads: values(&[3.0, 4.0]), temperatures: Some(values(&[5.0, 6.0])) };
        let points = grid.points();
        let expected = [(1.0, 3.0, 5.0), (2.0, 3.0, 5.0), (1.0, 4.0, 5.0)];
        assert_eq!(points.len(), 8);
        for (point, (speed, load, temperature)) in points.iter().zip(expected) {
            assert_eq!(*point, Point { speed, load, temperature: Some(temperature) });
        }
    }
}
