//! Values of command line options, parsed and checked, and options that several commands have. An error says what was
//! expected.

use std::ops::{Deref, RangeInclusive};
use std::path::PathBuf;

use asperity::scene::{Setting, Wlf};
use asperity::tables::{Dimension, Unit, quantity};
use asperity_study::fit::WlfConstants;
use asperity_study::values::{above_zero, number};
pub(crate) use asperity_study::values::{count, length, share, temperature};
use clap::Args;
use clap::builder::{PathBufValueParser, TypedValueParser};

use crate::files::{ends_in, is_standard_output};

/// What stands below the help of a command: a line that runs in a checkout of the repository.
macro_rules! example {
    ($line:literal) => {
        concat!("Example, in a checkout of the repository:\n  ", $line)
    };
}
pub(crate) use example;

// Not a doc comment: that would be the description of the commands that have it.
#[derive(Debug, Args)]
pub(crate) struct Set {
    /// Overrides a key of the scene or patch file: solver.relative_tolerance=1e-9,
    /// layer.vertical.maxwell[1].stiffness=0, friction.coulomb=0.5, surface="{ kind = 'flat' }". What the file does not
    /// have is added. May be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<Setting>,
}

impl Deref for Set {
    type Target = [Setting];

    fn deref(&self) -> &Self::Target {
        &self.set
    }
}

/// A frequency above 0 in rad/s, or in the unit behind it.
pub(crate) fn frequency(text: &str) -> Result<f64, String> {
    let found = above_zero(text, Dimension::Frequency).filter(|frequency| (1e-30..=1e30).contains(frequency));
    found.ok_or_else(|| "expected a frequency above 0, such as 10Hz, or 62.8 in rad/s".into())
}

pub(crate) fn poisson_ratio(text: &str) -> Result<f64, String> {
    number(text, |ratio| (0.0..=0.5).contains(ratio), "a number from 0 to 0.5")
}

/// The key of a role, and the name or number of its column.
pub(crate) fn given_column(text: &str) -> Result<(String, String), String> {
    let parted = text.split_once('=').map(|(key, name)| (key.trim().to_owned(), name.trim().to_owned()));
    parted
        .filter(|(key, name)| !key.is_empty() && !name.is_empty())
        .ok_or_else(|| "expected ROLE=COLUMN, such as speed=v2".into())
}

/// The name of a column and its unit.
pub(crate) fn column_unit(text: &str) -> Result<(String, Unit), String> {
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
pub(crate) fn expansion(text: &str) -> Result<f64, String> {
    number(text, |value| (0.0..=2e-3).contains(value), "a number from 0 to 0.002, in 1/K")
}

pub(crate) fn fit_error(text: &str) -> Result<f64, String> {
    number(text, |error| (1e-12..=0.5).contains(error), "a number from 1e-12 to 0.5, such as 0.02 for 2 %")
}

pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    let found = quantity(text, Dimension::Time).map(|(seconds, _)| seconds);
    found
        .filter(|seconds| *seconds >= 0.0)
        .ok_or_else(|| format!("expected a time of 0 or more in s, or with its unit, found {text:?}"))
}

pub(crate) fn wavelengths(text: &str) -> Result<RangeInclusive<f64>, String> {
    let allowed = |(shortest, longest): &(f64, f64)| *shortest > 0.0 && shortest < longest && longest.is_finite();
    let message = || "expected SHORTEST..LONGEST in m, such as 1e-5..1e-3".to_owned();
    ends(text).filter(allowed).map(|(shortest, longest)| shortest..=longest).ok_or_else(message)
}

/// A file for a table or for arrays of numpy.
pub(crate) fn table_or_arrays() -> impl TypedValueParser<Value = PathBuf> {
    ending_in(&["csv", "npz"], "a name that ends in .csv or .npz, or -")
}

/// A file for a plot; its name gives the format.
pub(crate) fn picture() -> impl TypedValueParser<Value = PathBuf> {
    ending_in(&["svg", "png"], "a name that ends in .svg or .png")
}

/// A file for an animation; its name gives the format.
pub(crate) fn animation() -> impl TypedValueParser<Value = PathBuf> {
    ending_in(&["html", "png"], "a name that ends in .html or .png")
}

/// A file for arrays of numpy.
pub(crate) fn arrays() -> impl TypedValueParser<Value = PathBuf> {
    ending_in(&["npz"], "a name that ends in .npz")
}

/// A file for a plot or a table; a table on standard output.
pub(crate) fn picture_or_table() -> impl TypedValueParser<Value = PathBuf> {
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
pub(crate) fn wlf_constants(text: &str) -> Result<WlfConstants, String> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wlf_takes_three_positive_numbers() {
        let constants = wlf_constants("7.52, 119.75,293.15").unwrap();
        assert_eq!((constants.c1, constants.c2, constants.reference_temperature), (7.52, 119.75, 293.15));
        for wrong in ["7.52,119.75", "7.52,x,119.75,293.15", "-1,100,300", "1,2,3,4", "7.52,x,119.75,20", ""] {
            assert!(wlf_constants(wrong).unwrap_err().contains("C1,C2,TREF"), "{wrong}");
        }
        assert!(wlf_constants("7.52,119.75,20").unwrap_err().contains("20 °C being 293.15 K"));
    }
}
