//! Least squares within bounds, by the method of Levenberg and Marquardt.

use rayon::prelude::*;
use rmpfit::{MPConfig, MPError, MPFitter, MPPar, MPResult, MPSide, MPSuccess};

use super::error::ModelError;
use super::latin_hypercube::latin_hypercube;
use super::model::{FrictionModel, FrictionParts};
use super::problem::{Problem, sum_of_squares};

/// When a fit ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Relative change of χ² from one step to the next.
    pub chi_square: f64,
    /// Relative change of the places of the parameters.
    pub places: f64,
    /// The most steps.
    pub steps: usize,
}

impl Tolerance {
    /// Of a model that is known to many digits.
    pub const EXACT: Self = Self { chi_square: 1e-14, places: 1e-10, steps: 200 };
    /// Of what is a start for others.
    pub const ROUGH: Self = Self { chi_square: 1e-3, places: 1e-3, steps: 20 };
    /// Of one that is known to some.
    pub const USUAL: Self = Self { chi_square: 1e-6, places: 1e-5, steps: 60 };
}

/// Where a fit ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    /// The parameters' places between their bounds.
    pub places: Vec<f64>,
    /// Sum of the squared residuals.
    pub chi_square: f64,
    /// Whether that is a least square to the tolerance.
    pub has_converged: bool,
}

/// The least square nearest to a start, within the bounds; `progress` is told each χ² that is tried.
///
/// # Errors
/// Those of the model; [`ModelError::TooFew`] measurements.
pub fn minimise(
    problem: &Problem,
    model: &dyn FrictionModel,
    start: &[f64],
    tolerance: Tolerance,
    progress: &dyn Fn(f64),
) -> Result<Fitted, ModelError> {
    let count = start.len();
    if problem.rows.len() < count {
        return Err(ModelError::TooFew { rows: problem.rows.len(), parameters: count, left_out: None });
    }
    let bounded = || MPPar {
        limited_low: true,
        limited_up: true,
        limit_low: 0.0,
        limit_up: 1.0,
        side: MPSide::User,
        ..MPPar::new()
    };
    let config = MPConfig {
        ftol: tolerance.chi_square,
        xtol: tolerance.places,
        gtol: ORTHOGONAL,
        max_iter: tolerance.steps,
        step_factor: FIRST_STEP,
        ..MPConfig::new()
    };
    let bounds = (0..count).map(|_| bounded()).collect();
    let mut fitter = Fitter { problem, model, progress, config, bounds, has_begun: false, error: None };
    let mut places = start.to_vec();
    let status = fitter.mpfit(&mut places);
    if let Some(error) = fitter.error {
        return Err(error);
    }
    let status = status.map_err(ModelError::LeastSquares)?;
    let has_converged = status.success != MPSuccess::MaxIter;
    let chi_square = sum_of_squares(&problem.residuals(model, &places)?);
    Ok(Fitted { places, chi_square, has_converged })
}

/// The cosine between residuals and derivatives at which a fit ends.
const ORTHOGONAL: f64 = 1e-10;
/// The first step is at most this many times the size of the start: not across the whole of the bounds.
const FIRST_STEP: f64 = 1.0;

/// The residuals of a step to where not all points slide steadily: so large that it is taken back.
const REFUSED: f64 = 1e9;

/// What the method asks for.
struct Fitter<'a> {
    problem: &'a Problem,
    model: &'a dyn FrictionModel,
    progress: &'a dyn Fn(f64),
    config: MPConfig,
    bounds: Vec<MPPar>,
    /// Whether the start slides steadily.
    has_begun: bool,
    /// What stopped the model.
    error: Option<ModelError>,
}

impl Fitter<'_> {
    /// What the model gave, or the error that the method knows.
    fn given<T>(&mut self, result: Result<T, ModelError>) -> MPResult<T> {
        result.map_err(|error| {
            self.error = Some(error);
            MPError::Eval
        })
    }
}

impl MPFitter for Fitter<'_> {
    fn eval(&mut self, places: &[f64], deviates: &mut [f64]) -> MPResult<()> {
        let residuals = self.problem.residuals(self.model, places);
        if matches!(residuals, Err(ModelError::NotSteady(_))) && self.has_begun {
            deviates.fill(REFUSED);
            return Ok(());
        }
        deviates.copy_from_slice(&self.given(residuals)?);
        self.has_begun = true;
        (self.progress)(sum_of_squares(deviates));
        Ok(())
    }

    fn number_of_points(&self) -> usize {
        self.problem.rows.len()
    }

    fn config(&self) -> &MPConfig {
        &self.config
    }

    fn parameters(&self) -> &[MPPar] {
        &self.bounds
    }

    fn jacobian(&mut self, places: &[f64], deviates: &mut [f64], derivatives: &mut [Option<Vec<f64>>]) -> MPResult<()> {
        let linearised = self.problem.linearised(self.model, places);
        let linearised = self.given(linearised)?;
        deviates.copy_from_slice(&linearised.residuals);
        for (column, derivatives) in linearised.jacobian.column_iter().zip(derivatives) {
            if let Some(derivatives) = derivatives {
                derivatives.iter_mut().zip(column.iter()).for_each(|(derivative, found)| *derivative = *found);
            }
        }
        Ok(())
    }
}

/// Places that are looked at, ...
const PLACES: usize = 64;
/// ... and those of them that a fit begins at.
const STARTS: usize = 6;
/// The seed of the places.
const SEED: u64 = 46;
/// Fits whose places differ by less than this are one.
const SAME: f64 = 0.02;

/// Fits by a cheap model, the best first: from the best of places that fill the bounds and from some of one's own; of
/// those that end at the same place the best.
///
/// # Errors
/// Those of the model.
pub fn starts_by_theory(
    problem: &Problem,
    theory: &dyn FrictionModel,
    own: &[f64],
    tolerance: Tolerance,
) -> Result<Vec<Fitted>, ModelError> {
    let places = latin_hypercube(PLACES, problem.parameters.len(), SEED);
    let frictions = problem.frictions(theory, &places)?;
    let chi_square = |frictions: &Vec<FrictionParts>| sum_of_squares(&problem.residuals_of(frictions));
    let mut places: Vec<(f64, Vec<f64>)> = frictions.iter().map(chi_square).zip(places).collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let best = places.into_iter().take(STARTS).map(|(_, places)| places);
    let starts: Vec<Vec<f64>> = std::iter::once(own.to_vec()).chain(best).collect();
    let fits: Result<Vec<Fitted>, ModelError> =
        starts.par_iter().map(|start| minimise(problem, theory, start, tolerance, &|_| ())).collect();
    let mut fits = fits?;
    fits.sort_by(|a, b| a.chi_square.total_cmp(&b.chi_square));
    let mut kept: Vec<Fitted> = Vec::new();
    for fit in fits {
        let is_same = |other: &Fitted| other.places.iter().zip(&fit.places).all(|(a, b)| (a - b).abs() < SAME);
        if !kept.iter().any(is_same) {
            kept.push(fit);
        }
    }
    Ok(kept)
}
