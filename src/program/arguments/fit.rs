//! The command line of `asperity fit`.

use std::path::PathBuf;

use asperity::scene::Wlf;
use clap::Args;

use super::{number, picture};

#[derive(Debug, Args)]
pub(crate) struct Fit {
    /// The measured moduli: columns of frequency, E', E'' or tan delta, and temperature if it changes, with their units
    /// in a header line; parted by comma, semicolon or tab.
    #[arg(value_name = "DMA.csv")]
    pub(crate) data: PathBuf,
    /// The Prony terms to write, as a scene reads them.
    #[arg(short, long, value_name = "OUT.csv")]
    pub(crate) output: PathBuf,
    /// The error that the terms may have: the root mean square of the relative errors of E' and E'' at all points.
    #[arg(long, value_name = "E", default_value_t = 0.02, value_parser = fit_error)]
    pub(crate) error: f64,
    /// The constants by Williams, Landel and Ferry that shift rows of other temperatures to TREF: C1 (1), C2 (K), TREF
    /// (K).
    #[arg(long, value_name = "C1,C2,TREF", value_parser = WlfConstants::parse)]
    pub(crate) wlf: Option<WlfConstants>,
    /// Allows a Kelvin-Voigt viscosity beside the terms.
    #[arg(long)]
    pub(crate) viscosity: bool,
    /// Leaves out a column, named by its header as it is written; may be given several times.
    #[arg(long, value_name = "COLUMN")]
    pub(crate) ignore: Vec<String>,
    /// The picture of data and fit, as SVG or PNG by its name; default: beside the output, as SVG.
    #[arg(long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) plot: Option<PathBuf>,
}

/// Constants of the shift with temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WlfConstants {
    /// C_1, 1.
    pub(crate) c1: f64,
    /// C_2, K.
    pub(crate) c2: f64,
    /// T_ref, K.
    pub(crate) reference_temperature: f64,
}

impl WlfConstants {
    /// The shift at `temperature` (K).
    pub(crate) fn at(&self, temperature: f64) -> Wlf {
        let Self { c1, c2, reference_temperature } = *self;
        Wlf { c1, c2, reference_temperature, temperature }
    }

    fn parse(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
        match numbers.unwrap_or_default()[..] {
            [c1, c2, reference_temperature]
                if [c1, c2, reference_temperature].iter().all(|number| *number > 0.0 && number.is_finite()) =>
            {
                if reference_temperature < Wlf::COLDEST {
                    let cold = reference_temperature;
                    return Err(format!("TREF = {cold} is too cold for rubber: it is in K, 20 °C being 293.15 K"));
                }
                Ok(Self { c1, c2, reference_temperature })
            }
            _ => {
                Err("expected C1,C2,TREF, three numbers above 0, such as 7.52,119.75,293.15 (C2 and TREF in K)".into())
            }
        }
    }
}

fn fit_error(text: &str) -> Result<f64, String> {
    number(text, |error| (1e-12..=0.5).contains(error), "a number from 1e-12 to 0.5, such as 0.02 for 2 %")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wlf_takes_three_positive_numbers() {
        let constants = WlfConstants::parse("7.52, 119.75,293.15").unwrap();
        assert_eq!((constants.c1, constants.c2, constants.reference_temperature), (7.52, 119.75, 293.15));
        for wrong in ["7.52,119.75", "7.52,x,119.75,293.15", "-1,100,300", "1,2,3,4", "7.52,x,119.75,20", ""] {
            assert!(WlfConstants::parse(wrong).unwrap_err().contains("C1,C2,TREF"), "{wrong}");
        }
        assert!(WlfConstants::parse("7.52,119.75,20").unwrap_err().contains("20 °C being 293.15 K"));
    }
}
