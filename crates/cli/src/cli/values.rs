//! Values of command line options, parsed and checked. An error says what was expected.

use std::fmt::{self, Display, Formatter};
use std::path::PathBuf;

use asperity::tables::{Dimension, quantity};
use asperity_study::calibration::FreeParameter;
use asperity_study::decimals::tenth;
use asperity_study::values::ends;
pub(super) use asperity_study::values::{count, share};
use clap::builder::{PathBufValueParser, StringValueParser, TypedValueParser};

use crate::files::{ends_in, is_standard_output};

/// The key and the bounds of `--free`.
pub(super) fn free_parameter(text: &str) -> Result<FreeParameter, String> {
    let parted = text.split_once('=').and_then(|(key, bounds)| {
        let (low, high) = ends(bounds)?;
        FreeParameter::new(key.trim().to_owned(), low, high)
    });
    parted.filter(|parameter| !parameter.key.is_empty()).ok_or_else(|| {
        "expected KEY=LOW..HIGH in SI units, LOW below HIGH, such as friction.rate_shear.strength=1e5..2e7".into()
    })
}

/// Which rows `--where` chooses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Condition {
    pub(crate) column: String,
    value: String,
}

impl Condition {
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        match text.split_once('=') {
            Some((column, value)) if !column.trim().is_empty() => {
                Ok(Self { column: column.trim().into(), value: value.trim().into() })
            }
            _ => Err("expected COLUMN=VALUE, such as pressure=2e5".into()),
        }
    }

    /// Whether a field is the value: the same text, or the same number however it is written.
    pub(crate) fn holds_for(&self, field: &str) -> bool {
        /// Relative difference of numbers that count as the same: values are rounded in tables.
        const ROUNDING: f64 = 1e-9;
        let (field, value) = (field.trim(), self.value.as_str());
        let numbers = || Some((field.parse::<f64>().ok()?, value.parse::<f64>().ok()?));
        field == value || numbers().is_some_and(|(a, b)| (a - b).abs() <= ROUNDING * b.abs())
    }
}

impl Display for Condition {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {}", self.column, self.value)
    }
}

/// An axis of a plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum PlotAxis {
    /// The horizontal one.
    X,
    /// The vertical ones.
    Y,
}

pub(super) fn seeds(text: &str) -> Result<u32, String> {
    let number = text.trim().parse().ok().filter(|number| (2..=1000).contains(number));
    number.ok_or_else(|| "expected a whole number from 2 to 1000".into())
}

/// Powers of ten of the robustness test.
pub(super) fn powers(text: &str) -> Result<u32, String> {
    text.trim().parse().ok().filter(|&powers| powers <= 12).ok_or_else(|| "expected a whole number from 0 to 12".into())
}

pub(super) fn seconds(text: &str) -> Result<f64, String> {
    let found = quantity(text, Dimension::Time).map(|(seconds, _)| seconds);
    found
        .filter(|seconds| *seconds >= 0.0)
        .ok_or_else(|| format!("expected a time of 0 or more in s, or with its unit, found {text:?}"))
}

/// A file for a table or for arrays of numpy.
pub(super) fn table_or_arrays() -> impl TypedValueParser<Value = PathBuf> {
    ending_in(&["csv", "npz"], "a name that ends in .csv or .npz, or -")
}

/// A file for a plot; its name gives the format.
pub(super) fn picture() -> impl TypedValueParser<Value = PathBuf> {
    ending_in(&["svg", "png"], "a name that ends in .svg or .png")
}

/// A file for an animation; its name gives the format.
pub(super) fn animation() -> impl TypedValueParser<Value = PathBuf> {
    ending_in(&["html", "png"], "a name that ends in .html or .png")
}

/// A file for arrays of numpy.
pub(super) fn arrays() -> impl TypedValueParser<Value = PathBuf> {
    ending_in(&["npz"], "a name that ends in .npz")
}

/// A time in s, and a file for a plot of that instant.
pub(super) fn moment() -> impl TypedValueParser<Value = (f64, PathBuf)> {
    StringValueParser::new().try_map(|text| {
        let (time, path) = text.split_once('=').ok_or("expected TIME=OUT.svg, such as 2e-3=contact.svg")?;
        let path = PathBuf::from(path);
        let is_picture = ["svg", "png"].into_iter().any(|ending| ends_in(&path, ending));
        if !is_picture {
            return Err("expected a name that ends in .svg or .png after TIME=".to_owned());
        }
        Ok((seconds(time)?, path))
    })
}

/// A file for a plot or a table; a table on standard output.
pub(super) fn picture_or_table() -> impl TypedValueParser<Value = PathBuf> {
    ending_in(&["svg", "png", "csv"], "a name that ends in .svg, .png or .csv, or -")
}

fn ending_in(endings: &'static [&str], expected: &'static str) -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(move |path| {
        let is_table_for_stdout = endings.contains(&"csv") && is_standard_output(&path);
        if is_table_for_stdout || endings.iter().any(|ending| ends_in(&path, ending)) {
            Ok(path)
        } else {
            Err(format!("expected {expected}"))
        }
    })
}

/// Relative tolerances from loose to tight, at least one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tolerances(pub(crate) Vec<f64>);

impl Tolerances {
    /// The largest tolerance that a scene may have.
    const LOOSEST: f64 = 0.1;
    /// Rounding hides any smaller one.
    const TIGHTEST: f64 = 1e-14;

    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let inside = |(loosest, tightest): &(f64, f64)| {
            *loosest <= Self::LOOSEST && tightest <= loosest && *tightest >= Self::TIGHTEST
        };
        let Some((loosest, tightest)) = ends(text).filter(inside) else {
            return Err("expected LOOSEST..TIGHTEST, such as 1e-2..1e-10, from at most 0.1 to at least 1e-14".into());
        };
        let ladder = std::iter::successors(Some(loosest), |&tolerance| Some(tenth(tolerance)));
        /// Relative rounding error of a tolerance.
        const ROUNDING: f64 = 1e-9;
        Ok(Self(ladder.take_while(|&tolerance| tolerance >= tightest * (1.0 - ROUNDING)).collect()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_condition_holds_for_a_text_and_for_a_number_however_it_is_written() {
        let pressure = Condition::parse("pressure = 2e5").unwrap();
        assert_eq!(
            ["200000", "2e5", "2.0e5", "2e4", "steady", ""].map(|field| pressure.holds_for(field)),
            [true, true, true, false, false, false]
        );
        assert!(Condition::parse("status=steady").unwrap().holds_for("steady"));
        assert!(Condition::parse("pressure").is_err() && Condition::parse("=1").is_err());
    }

    #[test]
    fn tolerances_are_decimal_tenths() {
        let ladder = Tolerances::parse("1e-2..1e-10").unwrap().0;
        assert_eq!(ladder, [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10]);
        assert_eq!(Tolerances::parse("0.05..1e-3").unwrap().0, [0.05, 0.005]);
        assert_eq!(Tolerances::parse("1e-3..1e-3").unwrap().0, [1e-3]);
        for wrong in ["1e-3", "1e-10..1e-2", "1..1e-2", "1e-2..0", "1e-2..NaN", "a..b"] {
            assert!(Tolerances::parse(wrong).unwrap_err().contains("1e-2..1e-10"), "{wrong}");
        }
    }
}
