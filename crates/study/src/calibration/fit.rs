//! Least squares within bounds, by the method of Levenberg and Marquardt.
//!
//! Starting values that fill the bounds.
//!
//! Space mapping: an expensive model fitted by a cheap one, which is corrected by their ratio at every point.
//!
//! J. W. Bandler et al., IEEE Trans. Microw. Theory Tech. 52, 2004, 337. At the parameters found so far both models are
//! evaluated, the cheap one times their ratio is fitted, and so on until the parameters stay within a tenth of their
//! standard errors.

use asperity::element::OperatingPoint;
use asperity::math::SplitMix64;
use rayon::prelude::*;
use rmpfit::{MPConfig, MPError, MPFitter, MPPar, MPResult, MPSide, MPSuccess};

use super::models::{Done, FrictionModel, FrictionParts, ModelError, Task};
use super::problem::{Linearised, Problem, sum_of_squares};
use super::statistics::Statistics;
use crate::Error;

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
    let status = status.map_err(|error| Error::value(format!("the fit cannot go on: {error}")))?;
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

/// `count` places in the unit cube of `dimensions`: along each axis one in every `count`th part (M. D. McKay, R. J.
/// Beckman, W. J. Conover, Technometrics 21, 1979, 239).
pub(super) fn latin_hypercube(count: usize, dimensions: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut random = SplitMix64::new(seed);
    let mut places = vec![vec![0.0; dimensions]; count];
    for axis in 0..dimensions {
        let mut order: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            order.swap(last, (random.unit() * (last + 1) as f64) as usize);
        }
        for (place, part) in places.iter_mut().zip(order) {
            place[axis] = (part as f64 + random.unit()) / count as f64;
        }
    }
    places
}

/// The most rounds.
const ROUNDS: usize = 8;
/// The change of a parameter over its standard error at which the rounds end.
const SMALL_CHANGE: f64 = 0.1;
/// A change of a coordinate that an expensive model of some digits does not tell from none.
const UNRESOLVED: f64 = 2e-3;
/// A parameter that changes the cheap model by less than this part of what the others do is none of its own.
const UNSEEN: f64 = 1e-9;

/// What the rounds came to.
#[derive(Clone, Debug)]
pub struct SpaceMapping {
    /// Where they ended: the best parameters so far, with the expensive model's χ².
    pub fitted: Fitted,
    /// The corrected model there.
    pub linearised: Linearised,
    /// How many rounds there were.
    pub rounds: usize,
}

/// A model times a ratio at each point.
#[derive(Debug)]
struct Corrected<'a> {
    model: &'a dyn FrictionModel,
    ratios: Vec<(OperatingPoint, f64)>,
}

impl std::fmt::Debug for dyn FrictionModel + '_ {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("FrictionModel")
    }
}

impl FrictionModel for Corrected<'_> {
    fn evaluate(&self, tasks: &[Task], done: &Done<'_>) -> Result<(), ModelError> {
        self.model.evaluate(tasks, &|index, outcome| {
            let ratio = self.ratios.iter().find(|(point, _)| *point == tasks[index].point).map_or(1.0, |found| found.1);
            let times = |parts: FrictionParts| FrictionParts {
                profile: ratio * parts.profile,
                fine: ratio * parts.fine,
                shear: ratio * parts.shear,
                ..parts
            };
            done(index, outcome.map(times))
        })
    }

    fn step(&self) -> f64 {
        self.model.step()
    }
}

/// Fits the `expensive` model by the `cheap` one from a start; `progress` is told each χ² of the expensive one. `None`
/// where the cheap model does not depend on one of the parameters, and so cannot find it.
///
/// # Errors
/// Those of the models.
pub fn map_space(
    problem: &Problem,
    cheap: &dyn FrictionModel,
    expensive: &dyn FrictionModel,
    start: &[f64],
    progress: &dyn Fn(f64),
) -> Result<Option<SpaceMapping>, ModelError> {
    let seen = problem.linearised(cheap, start)?.jacobian;
    let sizes: Vec<f64> = seen.column_iter().map(|column| column.norm()).collect();
    let largest = sizes.iter().copied().fold(0.0, f64::max);
    if sizes.iter().any(|size| *size <= UNSEEN * largest) {
        return Ok(None);
    }
    let mut places = start.to_vec();
    let mut best: Option<SpaceMapping> = None;
    for round in 1..=ROUNDS {
        let at = vec![places.clone()];
        let (by_expensive, by_cheap) =
            (problem.frictions(expensive, &at)?.remove(0), problem.frictions(cheap, &at)?.remove(0));
        let chi_square = sum_of_squares(&problem.residuals_of(&by_expensive));
        progress(chi_square);
        let ratio = |(expensive, cheap): (&FrictionParts, &FrictionParts)| expensive.friction() / cheap.friction();
        let ratios = problem.points.iter().copied().zip(by_expensive.iter().zip(&by_cheap).map(ratio)).collect();
        let corrected = Corrected { model: cheap, ratios };
        let next = minimise(problem, &corrected, &places, Tolerance::USUAL, &|_| ())?;
        let linearised = problem.linearised(&corrected, &places)?;
        let statistics = Statistics::new(problem, &places, &linearised);
        let is_small = |index: usize| {
            let change = (next.places[index] - places[index]).abs() * problem.parameters[index].span();
            change <= UNRESOLVED || statistics.errors[index].is_some_and(|error| change <= SMALL_CHANGE * error)
        };
        let has_converged = (0..places.len()).all(is_small);
        if has_converged || best.as_ref().is_none_or(|best| chi_square < best.fitted.chi_square) {
            best =
                Some(SpaceMapping { fitted: Fitted { places, chi_square, has_converged }, linearised, rounds: round });
        }
        if has_converged {
            break;
        }
        places = next.places;
    }
    Ok(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_every_axis_has_one_place() {
        let places = latin_hypercube(12, 5, 3);
        for axis in 0..5 {
            let mut parts: Vec<usize> = places.iter().map(|place| (12.0 * place[axis]) as usize).collect();
            parts.sort_unstable();
            assert_eq!(parts, (0..12).collect::<Vec<_>>());
        }
        assert_ne!(places, latin_hypercube(12, 5, 4));
    }
}
