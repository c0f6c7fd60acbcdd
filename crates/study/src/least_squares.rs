//! Least squares of a formula's numbers within bounds, and which of them the data determine.
//!
//! As in a calibration: with J the derivatives of the residuals by the numbers in their scales, the covariance is (JᵀJ)⁻¹
//! times χ² per degree of freedom, and a singular value of J below 1e-3 of the largest is of a direction that the data do
//! not see. A number in it that formulas without it take for some value is held there, the last of them first; others
//! that are part of it are not determined.

use std::fmt::{self, Display, Formatter};

use nalgebra::{DMatrix, DVector};
use rmpfit::{MPConfig, MPFitter, MPPar, MPResult};

use crate::decimals::short;
use crate::error::Error;

/// A singular value below this part of the largest is of a direction that is not determined.
const NOT_DETERMINED: f64 = 1e-3;
/// A smaller component of a direction is none.
const NEXT_TO_NONE: f64 = 0.1;
/// A number nearer than this part of its bounds' distance to one of them is at it.
const AT_BOUND: f64 = 1e-6;

/// A number of a formula.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parameter {
    pub(crate) name: &'static str,
    pub(crate) bounds: (f64, f64),
    /// A change of it that counts.
    pub(crate) scale: f64,
    /// What it is taken for where data do not determine it.
    pub(crate) neutral: Option<f64>,
}

/// What data say of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Determined {
    /// Its value and standard error.
    Fitted(f64, f64),
    /// It is at a bound of what it may be, and has no error.
    AtBound(f64),
    /// Nothing; it is taken for this.
    Taken(f64),
    /// Nothing.
    Not,
}

impl Determined {
    /// Its value and its standard error, where there are any.
    pub fn numbers(self) -> (Option<f64>, Option<f64>) {
        match self {
            Self::Fitted(value, error) => (Some(value), Some(error)),
            Self::AtBound(value) | Self::Taken(value) => (Some(value), None),
            Self::Not => (None, None),
        }
    }

    /// How sure it is, in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Fitted(..) => "fitted",
            Self::AtBound(_) => "at its bound",
            Self::Taken(_) => "not determined, taken for this",
            Self::Not => "not determined",
        }
    }
}

impl Display for Determined {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Fitted(value, error) => write!(f, "{} ± {}", short(value, 5), short(error, 2)),
            Self::AtBound(value) => write!(f, "{} ({})", short(value, 5), self.words()),
            Self::Taken(value) => write!(f, "not determined, taken for {value}"),
            Self::Not => f.write_str(self.words()),
        }
    }
}

/// Numbers at a least square.
#[derive(Clone, Debug)]
pub(crate) struct Fitted {
    /// Those of the formula, whether the data determine them or not.
    pub(crate) values: Vec<f64>,
    /// What the data say of each.
    pub(crate) determined: Vec<Determined>,
    /// χ².
    chi_square: f64,
}

/// The residuals of a formula with these numbers.
pub(crate) type Residuals<'a> = dyn Fn(&[f64]) -> Vec<f64> + 'a;

/// The best of the least squares from some starts.
///
/// # Errors
/// Where there are fewer residuals than numbers, or none of the starts leads to a least square.
pub(crate) fn least_squares(
    parameters: &[Parameter],
    starts: &[Vec<f64>],
    residuals: &Residuals<'_>,
) -> Result<Fitted, Error> {
    let mut held = vec![None; parameters.len()];
    loop {
        let fitted =
            starts.iter().map(|start| minimum(parameters, &held, start, residuals)).collect::<Result<Vec<_>, _>>()?;
        let best = fitted.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
        let (values, chi_square) = best.ok_or_else(|| Error::run("no start of a fit is given"))?;
        let statistics = Statistics::new(parameters, &held, &values, residuals);
        let weak = |i: &usize| parameters[*i].neutral.is_some();
        match statistics.weakest().into_iter().rfind(weak) {
            Some(i) => held[i] = parameters[i].neutral,
            None => {
                let determined = statistics.determined(parameters, &held, &values, chi_square);
                return Ok(Fitted { values, determined, chi_square });
            }
        }
    }
}

impl Fitted {
    /// The root mean square of so many residuals.
    pub(crate) fn rms(&self, count: usize) -> f64 {
        (self.chi_square / count.max(1) as f64).sqrt()
    }
}

/// The least square from a start, those that are held apart, and χ².
fn minimum(
    parameters: &[Parameter],
    held: &[Option<f64>],
    start: &[f64],
    residuals: &Residuals<'_>,
) -> Result<(Vec<f64>, f64), Error> {
    let bounded = |(parameter, held): (&Parameter, &Option<f64>)| {
        let (limit_low, limit_up) = parameter.bounds;
        MPPar { fixed: held.is_some(), limited_low: true, limited_up: true, limit_low, limit_up, ..MPPar::new() }
    };
    let config = MPConfig { ftol: 1e-15, xtol: 1e-12, gtol: 1e-14, max_iter: 500, ..MPConfig::new() };
    let bounds = parameters.iter().zip(held).map(bounded).collect();
    let within = |((start, held), parameter): ((&f64, &Option<f64>), &Parameter)| {
        held.unwrap_or_else(|| start.clamp(parameter.bounds.0, parameter.bounds.1))
    };
    let mut values: Vec<f64> = start.iter().zip(held).zip(parameters).map(within).collect();
    let mut fitter = Fitter { residuals, config, bounds, count: residuals(&values).len() };
    fitter.mpfit(&mut values).map_err(|error| Error::run(format!("the fit cannot go on: {error}")))?;
    let chi_square = residuals(&values).iter().map(|residual| residual * residual).sum();
    Ok((values, chi_square))
}

/// What the method asks for.
struct Fitter<'a> {
    residuals: &'a Residuals<'a>,
    config: MPConfig,
    bounds: Vec<MPPar>,
    count: usize,
}

impl MPFitter for Fitter<'_> {
    fn eval(&mut self, values: &[f64], deviates: &mut [f64]) -> MPResult<()> {
        deviates.copy_from_slice(&(self.residuals)(values));
        Ok(())
    }

    fn number_of_points(&self) -> usize {
        self.count
    }

    fn config(&self) -> &MPConfig {
        &self.config
    }

    fn parameters(&self) -> &[MPPar] {
        &self.bounds
    }
}

/// The derivatives by the numbers that are free, taken apart.
struct Statistics {
    /// Which those are.
    free: Vec<usize>,
    rows: usize,
    /// The singular values of J, and their directions in its rows.
    singular: DVector<f64>,
    directions: DMatrix<f64>,
}

impl Statistics {
    fn new(parameters: &[Parameter], held: &[Option<f64>], values: &[f64], residuals: &Residuals<'_>) -> Self {
        let is_free = |&i: &usize| held[i].is_none() && !is_at_bound(&parameters[i], values[i]);
        let free: Vec<usize> = (0..parameters.len()).filter(is_free).collect();
        // The best of central differences: the cube root of rounding.
        const STEP: f64 = 1e-5;
        let column = |&i: &usize| {
            let at = |sign: f64| {
                let mut moved = values.to_vec();
                moved[i] += sign * STEP * parameters[i].scale;
                DVector::from_vec(residuals(&moved))
            };
            (at(1.0) - at(-1.0)) / (2.0 * STEP)
        };
        let columns: Vec<DVector<f64>> = free.iter().map(column).collect();
        let rows = residuals(values).len();
        // Numbers that take no part have no columns, and a matrix without columns no singular values.
        let jacobian = if columns.is_empty() { DMatrix::zeros(rows, 0) } else { DMatrix::from_columns(&columns) };
        let svd = jacobian.svd(false, true);
        let directions = svd.v_t.unwrap_or_else(|| DMatrix::zeros(0, free.len()));
        Self { free, rows, singular: svd.singular_values, directions }
    }

    fn is_weak(&self, direction: usize) -> bool {
        self.singular[direction] <= NOT_DETERMINED * self.singular.max()
    }

    /// The numbers in a direction.
    fn part(&self, direction: usize) -> impl Iterator<Item = usize> {
        let takes_part = move |at: &usize| self.directions[(direction, *at)].abs() > NEXT_TO_NONE;
        (0..self.free.len()).filter(takes_part).map(|at| self.free[at])
    }

    /// The numbers in the direction of the smallest singular value, where that is weak.
    fn weakest(&self) -> Vec<usize> {
        let smallest = (0..self.singular.len()).min_by(|&a, &b| self.singular[a].total_cmp(&self.singular[b]));
        smallest
            .filter(|&direction| self.is_weak(direction))
            .map_or(Vec::new(), |direction| self.part(direction).collect())
    }

    fn determined(
        &self,
        parameters: &[Parameter],
        held: &[Option<f64>],
        values: &[f64],
        chi_square: f64,
    ) -> Vec<Determined> {
        let (weak, strong): (Vec<usize>, Vec<usize>) = (0..self.singular.len()).partition(|&i| self.is_weak(i));
        let lost: Vec<usize> = weak.into_iter().flat_map(|direction| self.part(direction)).collect();
        let scale = chi_square / self.rows.saturating_sub(self.free.len()).max(1) as f64;
        let error = |at: usize| {
            let of = |&direction: &usize| (self.directions[(direction, at)] / self.singular[direction]).powi(2);
            (scale * strong.iter().map(of).sum::<f64>()).sqrt()
        };
        let one = |i: usize| match (held[i], self.free.iter().position(|&free| free == i)) {
            (Some(value), _) => Determined::Taken(value),
            (None, None) => Determined::AtBound(values[i]),
            _ if lost.contains(&i) => Determined::Not,
            (None, Some(at)) => Determined::Fitted(values[i], parameters[i].scale * error(at)),
        };
        (0..parameters.len()).map(one).collect()
    }
}

fn is_at_bound(parameter: &Parameter, value: f64) -> bool {
    let (low, high) = parameter.bounds;
    (value - low).min(high - value) <= AT_BOUND * (high - low)
}
