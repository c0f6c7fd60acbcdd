//! The command line: each command's in a module of its own, and what several take.

mod describe;
mod fit;
mod material;
mod pack;
mod plot;
mod report;
mod simulate;
mod surface;
mod sweep;

use std::path::PathBuf;

use clap::builder::{PathBufValueParser, TypedValueParser};
use clap::{Parser, Subcommand};

use super::ends_in;

pub(crate) use describe::Describe;
pub(crate) use fit::{Fit, WlfConstants};
pub(crate) use material::Material;
pub(crate) use pack::Pack;
pub(crate) use plot::Plot;
pub(crate) use report::{Report, tenth};
pub(crate) use simulate::Simulate;
pub(crate) use surface::{Reading, Surface};
pub(crate) use sweep::Sweep;

/// Simulates rubber on a rough surface and packs the simulation as an FMU.
#[derive(Debug, Parser)]
#[command(version)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Runs a scene along its excitation and writes a result file.
    Simulate(Simulate),
    /// Draws columns of result files.
    Plot(Plot),
    /// Prints what is in a scene and what is left out.
    Describe(Describe),
    /// Packs a scene, or an element from a sweep's table, as an FMI 2.0 co-simulation FMU.
    Pack(Pack),
    /// Finds the Prony terms of a compound from its measured moduli.
    Fit(Fit),
    /// Draws the moduli of a scene's compound over frequency, or the stiffnesses of its links.
    Material(Material),
    /// Measures how right and how quick a scene's runs are: tables, pictures and a page.
    Report(Report),
    /// Prints heights, slopes and Hurst exponent of a measured profile or a scene's surface, and draws its spectrum.
    Surface(Surface),
    /// Finds the friction coefficient over speed, pressure and temperature: a table and a picture.
    Sweep(Sweep),
}

/// What `--set` gives.
fn key_and_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => Ok((key.trim().into(), value.trim().into())),
        _ => Err("expected KEY=VALUE, such as solver.relative_tolerance=1e-9".into()),
    }
}

/// A whole number of things, at least one.
fn count(text: &str) -> Result<u32, String> {
    let number = text.trim().parse().ok().filter(|&number: &u32| number > 0);
    number.ok_or_else(|| "expected a whole number, 1 or more".into())
}

/// A number that is `possible`; `expected` says which are.
fn number(text: &str, possible: impl Fn(&f64) -> bool, expected: &str) -> Result<f64, String> {
    text.trim().parse().ok().filter(possible).ok_or_else(|| format!("expected {expected}"))
}

fn positive(text: &str) -> Result<f64, String> {
    number(text, |number| *number > 0.0 && number.is_finite(), "a number above 0")
}

/// The two ends of `A..B`.
fn ends(text: &str) -> Option<(f64, f64)> {
    let number = |text: &str| text.trim().parse().ok();
    text.split_once("..").and_then(|(first, last)| Some((number(first)?, number(last)?)))
}

/// A file for a picture, which its name says the kind of.
fn picture() -> impl TypedValueParser<Value = PathBuf> {
    ending_in(&["svg", "png"], "a name that ends in .svg or .png")
}

/// A file for a picture or a table.
fn picture_or_table() -> impl TypedValueParser<Value = PathBuf> {
    ending_in(&["svg", "png", "csv"], "a name that ends in .svg, .png or .csv")
}

fn ending_in(endings: &'static [&str], expected: &'static str) -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(move |path| {
        if endings.iter().any(|ending| ends_in(&path, ending)) { Ok(path) } else { Err(format!("expected {expected}")) }
    })
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_well_formed() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn a_parameter_is_split_at_the_first_equals_sign() {
        assert_eq!(key_and_value("a.b = 1=2"), Ok(("a.b".into(), "1=2".into())));
        assert!(key_and_value("a.b").is_err());
        assert!(key_and_value("=1").is_err());
    }
}
