//! Values of command line options, parsed and checked, and options that several commands have. An error says what was
//! expected.

use std::ops::Deref;
use std::path::PathBuf;

use asperity::scene::Setting;
use asperity::tables::{Dimension, quantity};
pub(crate) use asperity_study::values::count;
use asperity_study::values::number;
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

pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    let found = quantity(text, Dimension::Time).map(|(seconds, _)| seconds);
    found
        .filter(|seconds| *seconds >= 0.0)
        .ok_or_else(|| format!("expected a time of 0 or more in s, or with its unit, found {text:?}"))
}

/// A probability, 0 and 1 included.
pub(crate) fn probability(text: &str) -> Result<f64, String> {
    number(text, |part| (0.0..=1.0).contains(part), "a number from 0 to 1")
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_have_their_ends() {
        assert_eq!(["0", "0.5", "1"].map(probability), [Ok(0.0), Ok(0.5), Ok(1.0)]);
        assert!(["-0.1", "1.1", "nan", "x"].into_iter().all(|text| probability(text).is_err()));
    }
}
