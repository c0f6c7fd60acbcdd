//! What is asked of a fit.

use std::path::PathBuf;
use std::str::FromStr;

use asperity::scene::Wlf;
use asperity::tables::{Dimension, Unit};
use clap::{Args, ValueEnum};
use serde::{Deserialize, Deserializer, de};

use crate::files::given_column;
use crate::values::{above_zero, number, temperature};

/// The constants of the equation of Williams, Landel and Ferry, without the temperature.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "[f64; 3]")]
pub struct WlfConstants {
    /// C_1, 1.
    pub c1: f64,
    /// C_2, K.
    pub c2: f64,
    /// T_ref, K.
    pub reference_temperature: f64,
}

impl WlfConstants {
    /// The equation at `temperature` (K).
    pub(super) fn at(&self, temperature: f64) -> Wlf {
        let Self { c1, c2, reference_temperature } = *self;
        Wlf { c1, c2, reference_temperature, temperature }
    }
}

impl TryFrom<[f64; 3]> for WlfConstants {
    type Error = String;

    fn try_from(constants: [f64; 3]) -> Result<Self, String> {
        let [c1, c2, reference_temperature] = constants;
        if !constants.iter().all(|number| *number > 0.0 && number.is_finite()) {
            return Err(CONSTANTS.into());
        }
        if reference_temperature < Wlf::COLDEST {
            let cold = reference_temperature;
            return Err(format!("TREF = {cold} is too cold for rubber: it is in K, 20 °C being 293.15 K"));
        }
        Ok(Self { c1, c2, reference_temperature })
    }
}

/// What constants are expected.
const CONSTANTS: &str = "expected C1,C2,TREF, three numbers above 0, such as 7.52,119.75,293.15 (C2 and TREF in K)";

impl FromStr for WlfConstants {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
        let constants: Result<[f64; 3], _> = numbers.unwrap_or_default().try_into();
        constants.map_err(|_| CONSTANTS.to_owned())?.try_into()
    }
}

/// Which of both moduli a fit counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Weight {
    /// E' alone
    Storage,
    /// E'' alone
    Loss,
    /// Both alike
    #[default]
    Both,
}

impl Weight {
    /// The weights of the relative errors of E' and of E''.
    pub(super) fn factors(self) -> [f64; 2] {
        /// So small that what one modulus says is not changed for the other by more than its digits, and large enough for
        /// what it leaves open.
        const LITTLE: f64 = 0.01;
        match self {
            Self::Storage => [1.0, LITTLE],
            Self::Loss => [LITTLE, 1.0],
            Self::Both => [1.0, 1.0],
        }
    }
}

/// What becomes of the moduli of other temperatures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Vertical {
    /// Divided by a column b_T, where there is one
    #[default]
    Divide,
    /// Multiplied by a column b_T
    Multiply,
    /// Divided by ρT/(ρ0 T0)
    Density,
    /// Nothing, whatever columns there are
    None,
}

/// The word for a choice, as it is given.
pub(super) fn word(choice: impl ValueEnum) -> String {
    choice.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

/// Of the volume of natural rubber, 1/K.
const EXPANSION: f64 = 6.6e-4;

// How moduli are read and fitted. Not a doc comment: that would be the description of the command.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Debug, Deserialize, Args)]
#[serde(default)]
pub struct FitOptions {
    /// The admissible error of the fit: the root mean square of the relative errors of E' and E'' at all points.
    #[arg(long, value_name = "E", default_value_t = FitOptions::default().fit_error, value_parser = fit_error)]
    pub fit_error: f64,
    /// Constants of the Williams-Landel-Ferry equation, which shifts rows at other temperatures to TREF: C1 (1), C2
    /// (K), TREF (K). Default: shift factors are found where the curves overlap, and constants for them.
    #[arg(long, value_name = "C1,C2,TREF")]
    pub wlf: Option<WlfConstants>,
    /// Also fits a Kelvin-Voigt viscosity in parallel to the terms.
    #[arg(long)]
    pub viscosity: bool,
    /// A table of shift factors in place of constants: columns temperature and a_T (or log a_T).
    #[arg(long, value_name = "SHIFTS.csv", conflicts_with = "wlf")]
    pub shifts: Option<PathBuf>,
    /// The temperature in K at which the master curve is made where no constants are given; the measured one that is
    /// nearest. Default: 293.15.
    #[arg(long, value_name = "T", value_parser = temperature, conflicts_with = "wlf")]
    #[arg(allow_hyphen_values = true)]
    pub reference: Option<f64>,
    /// Which modulus the error counts: E' alone, E'' alone (each where the other decides what it leaves open), or both.
    #[arg(long, value_enum, default_value_t)]
    pub weight: Weight,
    /// What becomes of the moduli of other temperatures. Default: divided by b_T where the table, or that of --shifts, has
    /// such a column.
    #[arg(long, value_enum, default_value_t)]
    pub vertical: Vertical,
    /// The coefficient of expansion of the volume in 1/K, for --vertical density. Default: 6.6e-4, that of natural rubber.
    #[arg(long, value_name = "A", value_parser = expansion)]
    pub expansion: Option<f64>,
    /// The frequency of all rows, in rad/s or with its unit, where the table has no column of it.
    #[arg(long, value_name = "F", value_parser = frequency)]
    pub frequency: Option<f64>,
    /// Poisson's ratio, by which moduli of shear become moduli of tension.
    #[arg(long, value_name = "NU", default_value_t = FitOptions::default().poisson_ratio, value_parser = poisson_ratio)]
    pub poisson_ratio: f64,
    /// Storage and loss moduli whose headings have no letter are of shear, G' and G''.
    #[arg(long)]
    pub shear: bool,
    /// The unit of a column, where its heading names none or another one, as in 'Temperature=°C'. May be repeated.
    #[arg(long = "unit", value_name = "COLUMN=UNIT", value_parser = column_unit)]
    #[serde(deserialize_with = "column_units")]
    pub units: Vec<(String, Unit)>,
    /// The sheet of a workbook. Default: the only one with moduli, or all of those named by temperatures: 20C, -10 °C.
    #[arg(long, value_name = "NAME")]
    pub sheet: Option<String>,
    /// Which column is which, by its name or number, as in storage_modulus="E' 1". May be repeated.
    #[arg(long = "column", value_name = "ROLE=COLUMN", value_parser = given_column)]
    pub columns: Vec<(String, String)>,
    /// Ignores the column with this header, written exactly as in the file. May be repeated.
    #[arg(long, value_name = "COLUMN")]
    pub ignore: Vec<String>,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            fit_error: 0.02,
            wlf: None,
            viscosity: false,
            shifts: None,
            reference: None,
            weight: Weight::default(),
            vertical: Vertical::default(),
            expansion: None,
            frequency: None,
            poisson_ratio: 0.5,
            shear: false,
            units: Vec::new(),
            sheet: None,
            columns: Vec::new(),
            ignore: Vec::new(),
        }
    }
}

impl FitOptions {
    /// The coefficient of expansion, 1/K.
    pub(super) fn expansion(&self) -> f64 {
        self.expansion.unwrap_or(EXPANSION)
    }
}

fn fit_error(text: &str) -> Result<f64, String> {
    number(text, |error| (1e-12..=0.5).contains(error), "a number from 1e-12 to 0.5, such as 0.02 for 2 %")
}

fn expansion(text: &str) -> Result<f64, String> {
    number(text, |value| (0.0..=2e-3).contains(value), "a number from 0 to 0.002, in 1/K")
}

/// A frequency above 0 in rad/s, or in the unit behind it.
fn frequency(text: &str) -> Result<f64, String> {
    let found = above_zero(text, Dimension::Frequency).filter(|frequency| (1e-30..=1e30).contains(frequency));
    found.ok_or_else(|| "expected a frequency above 0, such as 10Hz, or 62.8 in rad/s".into())
}

fn poisson_ratio(text: &str) -> Result<f64, String> {
    number(text, |ratio| (0.0..=0.5).contains(ratio), "a number from 0 to 0.5")
}

/// The name of a column and its unit.
fn column_unit(text: &str) -> Result<(String, Unit), String> {
    let parted = text.rsplit_once('=').and_then(|(name, unit)| Some((name.trim().to_owned(), Unit::parse(unit)?)));
    parted
        .filter(|(name, _)| !name.is_empty())
        .ok_or_else(|| "expected COLUMN=UNIT with a known unit, such as 'Temperature=°C'".into())
}

/// Names of columns and their units.
fn column_units<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<(String, Unit)>, D::Error> {
    let unit = |(column, unit): (String, String)| {
        let known = Unit::parse(&unit);
        known.map(|known| (column, known)).ok_or_else(|| de::Error::custom(format!("{unit}: not a known unit")))
    };
    Vec::<(String, String)>::deserialize(from)?.into_iter().map(unit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wlf_takes_three_positive_numbers() {
        let constants: WlfConstants = "7.52, 119.75,293.15".parse().unwrap();
        assert_eq!((constants.c1, constants.c2, constants.reference_temperature), (7.52, 119.75, 293.15));
        let refusal = |text: &str| WlfConstants::from_str(text).unwrap_err();
        for wrong in ["7.52,119.75", "7.52,x,119.75,293.15", "-1,100,300", "1,2,3,4", "7.52,x,119.75,20", ""] {
            assert!(refusal(wrong).contains("C1,C2,TREF"), "{wrong}");
        }
        assert!(refusal("7.52,119.75,20").contains("20 °C being 293.15 K"));
    }
}
