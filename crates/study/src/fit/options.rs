//! What is asked of a fit.

use std::path::PathBuf;

use asperity::scene::Wlf;
use asperity::tables::Unit;

/// The constants of the equation of Williams, Landel and Ferry, without the temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
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

/// Which of both moduli a fit counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weight {
    /// E' alone: E'' decides what E' leaves open.
    Storage,
    /// E'' alone: E' decides what E'' leaves open, E_∞ among it.
    Loss,
    /// E' and E'' alike.
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

    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Storage => "storage",
            Self::Loss => "loss",
            Self::Both => "both",
        }
    }
}

/// How moduli depend on temperature beside the shift in frequency.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Vertical {
    /// By a column b_T, by which moduli are divided, where the table has one; else not at all.
    #[default]
    Divide,
    /// By a column b_T, by which moduli are multiplied.
    Multiply,
    /// As those of an ideal network: b_T = ρT/(ρ_0 T_0), with this coefficient of expansion of the volume, 1/K.
    Density(f64),
    /// Not at all.
    None,
}

/// How moduli are read and fitted.
#[derive(Clone, Debug)]
pub struct FitOptions {
    /// The file of the moduli: its name stands in messages and in what is written.
    pub data: PathBuf,
    /// The sheet of a workbook; `None`: the only one with moduli.
    pub sheet: Option<String>,
    /// Columns to ignore, by their headings.
    pub ignored: Vec<String>,
    /// Columns that are said to be those of roles: keys, and names or numbers from 1.
    pub columns: Vec<(String, String)>,
    /// Units of columns, by their headings.
    pub units: Vec<(String, Unit)>,
    /// The frequency of all rows where the table has no column of it, rad/s.
    pub frequency: Option<f64>,
    /// Poisson's ratio, by which moduli of shear become moduli of tension.
    pub poisson_ratio: f64,
    /// Whether moduli whose headings have no letter are of shear.
    pub shear: bool,
    /// The admissible root mean square of the relative errors.
    pub error: f64,
    /// Whether a viscosity in parallel to the terms is fitted too.
    pub viscosity: bool,
    /// Constants that shift rows at other temperatures.
    pub wlf: Option<WlfConstants>,
    /// A table of shift factors in their place.
    pub shifts: Option<PathBuf>,
    /// Where the master curve is made without either, K.
    pub reference: Option<f64>,
    /// Which modulus counts.
    pub weight: Weight,
    /// How moduli of other temperatures are scaled.
    pub vertical: Vertical,
}

impl Default for FitOptions {
    /// Those of `asperity fit`, of no file.
    fn default() -> Self {
        Self {
            data: PathBuf::new(),
            sheet: None,
            ignored: Vec::new(),
            columns: Vec::new(),
            units: Vec::new(),
            frequency: None,
            poisson_ratio: 0.5,
            shear: false,
            error: 0.02,
            viscosity: false,
            wlf: None,
            shifts: None,
            reference: None,
            weight: Weight::Both,
            vertical: Vertical::Divide,
        }
    }
}
