//! The command line of `asperity report`.

use std::path::PathBuf;

use clap::Args;

use super::{count, ends, key_and_value, number};

#[derive(Debug, Args)]
pub(crate) struct Report {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// The folder to write to; it is made if need be.
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,
    /// Relative tolerances to run at, each a tenth of the one before.
    #[arg(long, value_name = "LOOSEST..TIGHTEST", default_value = "1e-2..1e-10", value_parser = Tolerances::parse)]
    pub(crate) tolerances: Tolerances,
    /// Rows per phase of the excitation at which runs are compared.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = count)]
    pub(crate) points: u32,
    /// How often each run is timed: the median counts.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = count)]
    pub(crate) repeat: u32,
    /// Powers of ten by which the scene is stressed each way, one quantity by one and in pairs; 0: not at all.
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = powers)]
    pub(crate) stress: u32,
    /// About how long the stressed pairs may take, s: the cheap ones come first.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) stress_time: f64,
    /// Lines of other programs, as benches/peers/run writes them.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) peers: Option<PathBuf>,
    /// Overrides a parameter by its name, such as friction.coulomb=0.5.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    pub(crate) set: Vec<(String, String)>,
}

/// Relative tolerances from loose to tight, at least one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tolerances(pub(crate) Vec<f64>);

impl Tolerances {
    /// The loosest that a scene may have.
    const LOOSEST: f64 = 0.1;
    /// Tighter ones are lost in rounding.
    const TIGHTEST: f64 = 1e-14;

    fn parse(text: &str) -> Result<Self, String> {
        let inside = |(loosest, tightest): &(f64, f64)| {
            *loosest <= Self::LOOSEST && tightest <= loosest && *tightest >= Self::TIGHTEST
        };
        let Some((loosest, tightest)) = ends(text).filter(inside) else {
            return Err("expected LOOSEST..TIGHTEST, such as 1e-2..1e-10, from at most 0.1 to at least 1e-14".into());
        };
        let ladder = std::iter::successors(Some(loosest), |&tolerance| Some(tenth(tolerance)));
        /// What rounding may leave of a rung.
        const ROUNDING: f64 = 1e-9;
        Ok(Self(ladder.take_while(|&tolerance| tolerance >= tightest * (1.0 - ROUNDING)).collect()))
    }
}

/// A tenth, rounded as it is written: of 1e-10, 1e-11.
pub(crate) fn tenth(number: f64) -> f64 {
    let written = format!("{number:e}");
    let parts = written.split_once('e').and_then(|(digits, power)| Some((digits, power.parse::<i32>().ok()?)));
    parts.and_then(|(digits, power)| format!("{digits}e{}", power - 1).parse().ok()).unwrap_or(number / 10.0)
}

fn seconds(text: &str) -> Result<f64, String> {
    number(text, |seconds| (0.0..).contains(seconds), "a number of seconds, 0 or more")
}

fn powers(text: &str) -> Result<u32, String> {
    text.trim().parse().ok().filter(|&powers| powers <= 12).ok_or_else(|| "expected a whole number from 0 to 12".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_are_tenths_as_they_are_written() {
        let ladder = Tolerances::parse("1e-2..1e-10").unwrap().0;
        assert_eq!(ladder, [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10]);
        assert_eq!(Tolerances::parse("0.05..1e-3").unwrap().0, [0.05, 0.005]);
        assert_eq!(Tolerances::parse("1e-3..1e-3").unwrap().0, [1e-3]);
        for wrong in ["1e-3", "1e-10..1e-2", "1..1e-2", "1e-2..0", "1e-2..NaN", "a..b"] {
            assert!(Tolerances::parse(wrong).unwrap_err().contains("1e-2..1e-10"), "{wrong}");
        }
    }
}
