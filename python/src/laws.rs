//! What is found for other programs: property files of tyres, and laws of friction.

use std::fs;
use std::path::PathBuf;

use asperity_study::Error;
use asperity_study::friction_law::{FrictionData, FrictionFit, FrictionLaw};
use asperity_study::least_squares::Determined;
use asperity_study::tyre::ScaledTyre;
use pyo3::prelude::*;

use crate::errors::Raise as _;

/// Of a number that is scaled: its name, what it was, what it is, and why.
type Scaled = (&'static str, f64, f64, String);

/// Scales a property file, and says what is scaled and what stays.
#[pyfunction]
pub(crate) fn scale_tir(
    base: PathBuf,
    from_table: PathBuf,
    to_table: PathBuf,
    output: PathBuf,
    carcass: Vec<f64>,
) -> PyResult<(Vec<Scaled>, Vec<String>)> {
    let scale = || -> Result<_, Error> {
        let found = ScaledTyre::new(&base, &from_table, &to_table, &carcass)?;
        fs::write(&output, found.bytes()?).map_err(Error::io("write", &output))?;
        Ok(found)
    };
    let found = scale().map_err(|error| error.raise())?;
    let scaled = found.scalings.iter().map(|of| (of.key, of.before, of.after(), of.to_string())).collect();
    Ok((scaled, found.notes))
}

/// Of a fit: temperature, misfit (rms), largest friction, and each number's name, value and standard error.
type Fit = (Option<f64>, f64, f64, Vec<(&'static str, Option<f64>, Option<f64>)>);

/// Fits a law of friction to a table, by temperature.
#[pyfunction]
pub(crate) fn fit_friction(table: PathBuf, is_lugre: bool) -> PyResult<Vec<Fit>> {
    let law = if is_lugre { FrictionLaw::LuGre } else { FrictionLaw::Stribeck };
    let fits = FrictionData::read(&table).and_then(|data| data.fit(law)).map_err(|error| error.raise())?;
    let numbers = |fit: &FrictionFit| {
        let number = |(name, _, number): &(&'static str, String, Determined)| {
            let (value, error) = number.numbers();
            (*name, value, error)
        };
        fit.numbers.iter().map(number).collect()
    };
    Ok(fits.iter().map(|fit| (fit.temperature, fit.rms, fit.largest, numbers(fit))).collect())
}
