//! Space mapping: an expensive model fitted by a cheap one, which is corrected by their ratio at every point.
//!
//! J. W. Bandler et al., IEEE Trans. Microw. Theory Tech. 52, 2004, 337. At the parameters found so far both models are
//! evaluated, the cheap one times their ratio is fitted, and so on until the parameters stay within a tenth of their
//! standard errors.

use super::error::ModelError;
use super::fit::{Fitted, Tolerance, minimise};
use super::model::{Done, FrictionModel, FrictionParts, Task};
use super::problem::{Linearised, Problem, sum_of_squares};
use super::statistics::Statistics;
use asperity::element::OperatingPoint;

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
