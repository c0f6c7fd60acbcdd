//! Prony series from measured moduli.

use std::path::PathBuf;

use asperity_study::fit::{FitOptions, FittedModuli, fit_moduli};
use numpy::{IntoPyArray as _, PyArray1, PyArrayMethods as _};
use pyo3::prelude::*;

use crate::background::in_background;
use crate::errors::Raise as _;
use crate::found::{Numbers, Picture};
use crate::options::Options;

/// A Prony series fitted to measured moduli.
#[pyclass(frozen, module = "asperity._native")]
#[derive(Debug)]
pub(crate) struct Fit(FittedModuli);

/// Of a decade: where it begins (rad/s), rows, E'' over that of E', errors of E' and E''.
type Decade = (f64, usize, f64, f64, f64);

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

    /// The moduli, and how the errors add up.
    fn picture(&self) -> Picture {
        Picture(self.0.picture())
    }

    /// The file of Prony terms.
    fn text(&self) -> String {
        self.0.table().text()
    }
}

/// Fits a Prony series to the moduli in a file.
#[pyfunction]
pub(crate) fn fit(py: Python<'_>, data: PathBuf, options: Options<FitOptions>) -> PyResult<Fit> {
    let fitted = in_background(py, None, move |_| fit_moduli(&data, &options.0))?;
    fitted.map(Fit).map_err(|error| error.raise())
}
