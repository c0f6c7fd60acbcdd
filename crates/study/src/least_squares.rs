//! Least squares of a formula of few parameters, by the method of Levenberg and Marquardt, with standard errors.

use rmpfit::{MPConfig, MPError, MPFitter, MPPar, MPResult, MPSide};

use crate::error::Error;

/// A parameter of a formula: where a fit of it begins, and its bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameter {
    /// Where the fit begins, of the size of what is sought.
    pub(crate) start: f64,
    /// The least and the largest that it may be.
    pub(crate) bounds: (f64, f64),
    /// Whether it stays at its start.
    pub(crate) is_fixed: bool,
}

/// What a fit comes to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LeastSquares {
    /// The parameters.
    pub(crate) values: Vec<f64>,
    /// Their standard errors, of the scatter that the residuals have; `None` of those that are fixed, at a bound, or without
    /// effect.
    pub(crate) errors: Vec<Option<f64>>,
    /// Their covariance, row by row; 0 of those without an error.
    covariance: Vec<f64>,
    /// Residuals at the end.
    pub(crate) residuals: Vec<f64>,
}

impl LeastSquares {
    /// Fits parameters to `rows` residuals, which `residuals` gives of values of the parameters.
    ///
    /// # Errors
    /// With fewer rows than free parameters, and where residuals are no numbers.
    pub(crate) fn new(
        parameters: &[Parameter],
        rows: usize,
        residuals: impl Fn(&[f64]) -> Vec<f64>,
    ) -> Result<Self, Error> {
        let free = parameters.iter().filter(|parameter| !parameter.is_fixed).count();
        if rows < free {
            return Err(Error::value(format!("expected {free} rows or more for as many numbers, found {rows}")));
        }
        let bounded = |parameter: &Parameter| MPPar {
            fixed: parameter.is_fixed,
            limited_low: true,
            limited_up: true,
            limit_low: parameter.bounds.0,
            limit_up: parameter.bounds.1,
            side: MPSide::Both,
            ..MPPar::new()
        };
        let config = MPConfig { ftol: TOLERANCE, xtol: TOLERANCE, gtol: TOLERANCE, ..MPConfig::new() };
        let mut fitter = Fitter { residuals, rows, config, bounds: parameters.iter().map(bounded).collect() };
        let mut values: Vec<f64> = parameters.iter().map(|parameter| parameter.start).collect();
        let status = fitter.mpfit(&mut values).map_err(|error| Error::value(format!("no fit: {error}")))?;
        let residuals = (fitter.residuals)(&values);
        let variance = residuals.iter().map(|residual| residual * residual).sum::<f64>() / (rows - free).max(1) as f64;
        let error = |error: &f64| (*error > 0.0 && rows > free).then(|| error * variance.sqrt());
        let errors = status.xerror.iter().map(error).collect();
        let covariance = status.covar.iter().map(|covariance| covariance * variance).collect();
        Ok(Self { values, errors, covariance, residuals })
    }

    /// The standard error of a quantity with these derivatives by the parameters.
    pub(crate) fn error_of(&self, gradient: &[f64]) -> f64 {
        let row = |(row, by): (&[f64], &f64)| by * row.iter().zip(gradient).map(|(of, by)| of * by).sum::<f64>();
        self.covariance.chunks(gradient.len().max(1)).zip(gradient).map(row).sum::<f64>().max(0.0).sqrt()
    }

    /// The sum of the squared residuals.
    pub(crate) fn chi_square(&self) -> f64 {
        self.residuals.iter().map(|residual| residual * residual).sum()
    }
}

/// Relative changes of the sum of squares and of the parameters at which a fit ends.
const TOLERANCE: f64 = 1e-14;

struct Fitter<F> {
    residuals: F,
    rows: usize,
    config: MPConfig,
    bounds: Vec<MPPar>,
}

impl<F: Fn(&[f64]) -> Vec<f64>> MPFitter for Fitter<F> {
    fn eval(&mut self, values: &[f64], deviates: &mut [f64]) -> MPResult<()> {
        let residuals = (self.residuals)(values);
        if residuals.len() != deviates.len() {
            return Err(MPError::Eval);
        }
        deviates.copy_from_slice(&residuals);
        Ok(())
    }

    fn number_of_points(&self) -> usize {
        self.rows
    }

    fn config(&self) -> &MPConfig {
        &self.config
    }

    fn parameters(&self) -> &[MPPar] {
        &self.bounds
    }
}
