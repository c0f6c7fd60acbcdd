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

/// How moduli are read and fitted.
#[derive(Clone, Debug)]
pub struct FitOptions {
    /// The file of the moduli: its name stands in messages and in what is written.
    pub data: PathBuf,
    /// The sheet of a workbook; `None`: the only one with moduli.
    pub sheet: Option<String>,
    /// Columns to ignore, by their headings.
    pub ignored: Vec<String>,
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
}

impl Default for FitOptions {
    /// Those of `asperity fit`, of no file.
    fn default() -> Self {
        Self {
            data: PathBuf::new(),
            sheet: None,
            ignored: Vec::new(),
            units: Vec::new(),
            frequency: None,
            poisson_ratio: 0.5,
            shear: false,
            error: 0.02,
            viscosity: false,
            wlf: None,
            shifts: None,
            reference: None,
        }
    }
}
