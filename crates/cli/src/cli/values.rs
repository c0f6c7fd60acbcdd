//! Values of command line options, parsed and checked. An error says what was expected.

use std::f64::consts::TAU;
use std::fmt::{self, Display, Formatter};
use std::ops::RangeInclusive;
use std::path::PathBuf;

use asperity::scene::Wlf;
use asperity::tables::{Dimension, Unit, quantity};
use asperity_study::calibration::FreeParameter;
use asperity_study::decimals::tenth;
use asperity_study::fit::WlfConstants;
use asperity_study::values::{above_zero, number};
pub(super) use asperity_study::values::{count, length, share, temperature};
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

/// A frequency above 0 in rad/s, or in the unit behind it.
pub(super) fn frequency(text: &str) -> Result<f64, String> {
    let found = above_zero(text, Dimension::Frequency).filter(|frequency| (1e-30..=1e30).contains(frequency));
    found.ok_or_else(|| "expected a frequency above 0, such as 10Hz, or 62.8 in rad/s".into())
}

pub(super) fn poisson_ratio(text: &str) -> Result<f64, String> {
    number(text, |ratio| (0.0..=0.5).contains(ratio), "a number from 0 to 0.5")
}

/// The name of a column and its unit.
pub(super) fn column_unit(text: &str) -> Result<(String, Unit), String> {
    let parted = text.rsplit_once('=').and_then(|(name, unit)| Some((name.trim().to_owned(), Unit::parse(unit)?)));
    parted
        .filter(|(name, _)| !name.is_empty())
        .ok_or_else(|| "expected COLUMN=UNIT with a known unit, such as 'Temperature=°C'".into())
}

/// Which modulus the error of a fit counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum FitWeight {
    /// E' alone
    Storage,
    /// E'' alone
    Loss,
    /// Both alike
    Both,
}

/// What becomes of the moduli of other temperatures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum FitVertical {
    /// Divided by a column b_T, where there is one
    Divide,
    /// Multiplied by a column b_T
    Multiply,
    /// Divided by ρT/(ρ0 T0)
    Density,
    /// Nothing, whatever columns there are
    None,
}

/// A coefficient of expansion of the volume, 1/K.
pub(super) fn expansion(text: &str) -> Result<f64, String> {
    number(text, |value| (0.0..=2e-3).contains(value), "a number from 0 to 0.002, in 1/K")
}

pub(super) fn fit_error(text: &str) -> Result<f64, String> {
    number(text, |error| (1e-12..=0.5).contains(error), "a number from 1e-12 to 0.5, such as 0.02 for 2 %")
}

pub(super) fn seconds(text: &str) -> Result<f64, String> {
    let found = quantity(text, Dimension::Time).map(|(seconds, _)| seconds);
    found
        .filter(|seconds| *seconds >= 0.0)
        .ok_or_else(|| format!("expected a time of 0 or more in s, or with its unit, found {text:?}"))
}

/// The two ends of `A..B`.
fn ends(text: &str) -> Option<(f64, f64)> {
    let number = |text: &str| text.trim().parse().ok();
    text.split_once("..").and_then(|(first, last)| Some((number(first)?, number(last)?)))
}

pub(super) fn wavelengths(text: &str) -> Result<RangeInclusive<f64>, String> {
    let allowed = |(shortest, longest): &(f64, f64)| *shortest > 0.0 && shortest < longest && longest.is_finite();
    let message = || "expected SHORTEST..LONGEST in m, such as 1e-5..1e-3".to_owned();
    ends(text).filter(allowed).map(|(shortest, longest)| shortest..=longest).ok_or_else(message)
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

/// The constants of `--wlf`.
pub(super) fn wlf_constants(text: &str) -> Result<WlfConstants, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    match numbers.unwrap_or_default()[..] {
        [c1, c2, reference_temperature]
            if [c1, c2, reference_temperature].iter().all(|number| *number > 0.0 && number.is_finite()) =>
        {
            if reference_temperature < Wlf::COLDEST {
                let cold = reference_temperature;
                return Err(format!("TREF = {cold} is too cold for rubber: it is in K, 20 °C being 293.15 K"));
            }
            Ok(WlfConstants { c1, c2, reference_temperature })
        }
        _ => Err("expected C1,C2,TREF, three numbers above 0, such as 7.52,119.75,293.15 (C2 and TREF in K)".into()),
    }
}

/// A range of angular frequencies, rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frequencies(pub(crate) (f64, f64));

impl Frequencies {
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let (numbers, unit) = text.trim().strip_suffix("Hz").map_or((text, 1.0), |numbers| (numbers, TAU));
        // Hz may be appended to both ends.
        let numbers = numbers.replace("Hz", "");
        let allowed = |(low, high): &(f64, f64)| *low >= 1e-30 && high > low && *high <= 1e30;
        let message =
            || "expected A..B, such as 1..1e5 in rad/s or 0.1..1e4Hz, from 1e-30 to 1e30, A below B".to_owned();
        ends(&numbers).filter(allowed).map(|(low, high)| Self((low * unit, high * unit))).ok_or_else(message)
    }
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
    fn wlf_takes_three_positive_numbers() {
        let constants = wlf_constants("7.52, 119.75,293.15").unwrap();
        assert_eq!((constants.c1, constants.c2, constants.reference_temperature), (7.52, 119.75, 293.15));
        for wrong in ["7.52,119.75", "7.52,x,119.75,293.15", "-1,100,300", "1,2,3,4", "7.52,x,119.75,20", ""] {
            assert!(wlf_constants(wrong).unwrap_err().contains("C1,C2,TREF"), "{wrong}");
        }
        assert!(wlf_constants("7.52,119.75,20").unwrap_err().contains("20 °C being 293.15 K"));
    }

    #[test]
    fn frequencies_are_angular_unless_in_hertz() {
        assert_eq!(Frequencies::parse("1..1e5"), Ok(Frequencies((1.0, 1e5))));
        for hertz in ["0.5..10Hz", "0.5Hz..10 Hz"] {
            assert_eq!(Frequencies::parse(hertz), Ok(Frequencies((0.5 * TAU, 10.0 * TAU))), "{hertz}");
        }
        for wrong in ["1", "2..1", "0..1", "1..inf", "a..b"] {
            assert!(Frequencies::parse(wrong).unwrap_err().contains("1..1e5"), "{wrong}");
        }
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
