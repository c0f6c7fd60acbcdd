//! The command line of `asperity material`.

use std::f64::consts::TAU;
use std::path::PathBuf;

use clap::Args;

use super::{ends, key_and_value, number, picture_or_table};

#[derive(Debug, Args)]
pub(crate) struct Material {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// A file to write: a table as CSV, a picture as SVG or PNG, by its name; may be given several times. Default: a
    /// picture SCENE-material.svg.
    #[arg(short, long, value_name = "OUT", value_parser = picture_or_table())]
    pub(crate) output: Vec<PathBuf>,
    /// The range of the angular frequency, rad/s, or of the frequency with Hz behind it; default: by the relaxation
    /// times.
    #[arg(long, value_name = "A..B[Hz]", value_parser = Frequencies::parse)]
    pub(crate) frequencies: Option<Frequencies>,
    /// The compound's temperature, K, instead of the scene's.
    #[arg(long, value_name = "T", value_parser = temperature, allow_negative_numbers = true)]
    pub(crate) temperature: Option<f64>,
    /// Overrides a parameter by its name, such as material.poisson_ratio=0.48.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    pub(crate) set: Vec<(String, String)>,
}

/// A range of angular frequencies, rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frequencies(pub(crate) (f64, f64));

impl Frequencies {
    fn parse(text: &str) -> Result<Self, String> {
        let (numbers, unit) = text.trim().strip_suffix("Hz").map_or((text, 1.0), |numbers| (numbers, TAU));
        // Hz may stand behind both.
        let numbers = numbers.replace("Hz", "");
        let possible = |(low, high): &(f64, f64)| *low >= 1e-30 && high > low && *high <= 1e30;
        let message =
            || "expected A..B, such as 1..1e5 in rad/s or 0.1..1e4Hz, from 1e-30 to 1e30, A below B".to_owned();
        ends(&numbers).filter(possible).map(|(low, high)| Self((low * unit, high * unit))).ok_or_else(message)
    }
}

fn temperature(text: &str) -> Result<f64, String> {
    number(text, |kelvin| *kelvin > 0.0 && kelvin.is_finite(), "a temperature above 0 K, such as 293.15")
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
