//! Prony series from measured moduli.

use std::path::PathBuf;

use asperity::tables::Unit;
use asperity_study::fit::{FitOptions, FittedModuli, Vertical, Weight, WlfConstants, fit_moduli};
use numpy::{IntoPyArray as _, PyArray1, PyArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::background::in_background;
use crate::errors::Raise as _;

/// A Prony series fitted to measured moduli.
#[pyclass(frozen, module = "asperity._native")]
#[derive(Debug)]
pub(crate) struct Fit(FittedModuli);

/// Of a decade: where it begins (rad/s), rows, E'' over that of E', errors of E' and E''.
type Decade = (f64, usize, f64, f64, f64);

/// An array of numbers.
type Numbers<'py> = Bound<'py, PyArray1<f64>>;

#[pymethods]
impl Fit {
    #[getter]
    fn equilibrium_modulus(&self) -> f64 {
        self.0.equilibrium_modulus()
    }

    #[getter]
    fn viscosity(&self) -> f64 {
        self.0.viscosity()
    }

    #[getter]
    fn error(&self) -> f64 {
        self.0.error()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.0.notes().to_vec()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.warnings()
    }

    /// C_1, C_2 and T_ref.
    #[getter]
    fn wlf(&self) -> Option<(f64, f64, f64)> {
        self.0.wlf().map(|wlf| (wlf.c1, wlf.c2, wlf.reference_temperature))
    }

    /// How far E' and E'' are apart, the least error of any series, and by decades.
    #[getter]
    fn consistency(&self) -> Option<(f64, f64, Vec<Decade>)> {
        let found = self.0.consistency()?;
        let decades = found.decades.iter().map(|of| (of.from, of.rows, of.ratio, of.storage, of.loss)).collect();
        Some((found.apart(), found.nearest, decades))
    }

    /// Moduli and relaxation times.
    fn terms<'py>(&self, py: Python<'py>) -> (Numbers<'py>, Numbers<'py>) {
        let of = |value: fn(&asperity::scene::PronyTerm) -> f64| {
            self.0.terms().iter().map(value).collect::<Vec<_>>().into_pyarray(py)
        };
        (of(|term| term.modulus), of(|term| term.relaxation_time))
    }

    /// The measured points at the reference temperature, three numbers each.
    fn points<'py>(&self, py: Python<'py>) -> Numbers<'py> {
        let numbers = self.0.samples().iter().flat_map(|sample| [sample.at, sample.storage, sample.loss]);
        numbers.collect::<Vec<_>>().into_pyarray(py)
    }

    /// E' and E'' at frequencies, or E(t) and 0 at times, two numbers each.
    fn response<'py>(&self, py: Python<'py>, at: &Numbers<'py>) -> PyResult<Numbers<'py>> {
        let at = at.readonly();
        let values = at.as_slice()?.iter().flat_map(|&at| {
            let (storage, loss) = self.0.response(at);
            [storage, loss]
        });
        Ok(PyArray1::from_iter(py, values))
    }

    /// The file of Prony terms.
    fn text(&self) -> String {
        self.0.file()
    }
}

/// Fits a Prony series to the moduli in a file.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub(crate) fn fit(
    py: Python<'_>,
    data: PathBuf,
    error: f64,
    viscosity: bool,
    wlf: Option<(f64, f64, f64)>,
    shifts: Option<PathBuf>,
    reference: Option<f64>,
    frequency: Option<f64>,
    poisson_ratio: f64,
    shear: bool,
    units: Vec<(String, String)>,
    sheet: Option<String>,
    columns: Vec<(String, String)>,
    ignored: Vec<String>,
    weight: &str,
    vertical: &str,
    expansion: f64,
) -> PyResult<Fit> {
    let unit = |(column, unit): (String, String)| {
        let known = Unit::parse(&unit);
        known.map(|known| (column, known)).ok_or_else(|| PyValueError::new_err(format!("{unit}: not a known unit")))
    };
    let wlf = wlf.map(|(c1, c2, reference_temperature)| WlfConstants { c1, c2, reference_temperature });
    let options = FitOptions {
        data,
        sheet,
        ignored,
        columns,
        units: units.into_iter().map(unit).collect::<PyResult<_>>()?,
        frequency,
        poisson_ratio,
        shear,
        error,
        viscosity,
        wlf,
        shifts,
        reference,
        weight: match weight {
            "storage" => Weight::Storage,
            "loss" => Weight::Loss,
            "both" => Weight::Both,
            _ => return Err(PyValueError::new_err(format!("weight = {weight:?}: expected storage, loss or both"))),
        },
        vertical: match vertical {
            "divide" => Vertical::Divide,
            "multiply" => Vertical::Multiply,
            "density" => Vertical::Density(expansion),
            "none" => Vertical::None,
            _ => {
                let expected = "expected divide, multiply, density or none";
                return Err(PyValueError::new_err(format!("vertical = {vertical:?}: {expected}")));
            }
        },
    };
    let fitted = in_background(py, None, move |_| fit_moduli(&options))?;
    fitted.map(Fit).map_err(|error| error.raise())
}
