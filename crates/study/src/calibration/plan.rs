//! Which measurements would tell more: a D-optimal addition to those there are.
//!
//! With the information M = JᵀJ of the data, and of the bounds as if each parameter were even between them, those points
//! are added that make det M largest: first one after the other, then by exchanging one at a time (V. V. Fedorov, *Theory
//! of Optimal Experiments*, 1972) until none is better.
//!
//! The points among which those to measure next are chosen.

use asperity::element::OperatingPoint;
use asperity::scene::Scene;
use nalgebra::{DMatrix, DVector};

use super::free_scene::CandidateOptions;
use super::measurements::assumed_sigma;
use super::models::FrictionModel;
use super::models::ModelError;
use super::problem::{FrictionMeasurement, Linearised, Problem};
use super::statistics::{Statistics, by_coordinates};
use crate::decimals::rounded;

/// Points to measure and what they would bring.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The points.
    pub points: Vec<OperatingPoint>,
    /// Standard errors of the parameters in their coordinates now, ...
    pub before: Vec<f64>,
    /// ... and with these points.
    pub after: Vec<f64>,
}

/// The `count` points among `candidates` that tell most beside the measurements, at some places of the parameters.
/// Candidates that cannot be simulated are left out. A new measurement is taken to have the relative deviation that the
/// measurements have.
///
/// # Errors
/// Those of the model.
pub fn plan(
    problem: &Problem,
    model: &dyn FrictionModel,
    (places, linearised, statistics): (&[f64], &Linearised, &Statistics),
    candidates: &[OperatingPoint],
    count: usize,
) -> Result<Plan, ModelError> {
    let scale = statistics.scale.max(f64::MIN_POSITIVE);
    let jacobian = by_coordinates(problem, linearised) / scale.sqrt();
    let mut information = jacobian.transpose() * &jacobian;
    for (index, parameter) in problem.parameters.iter().enumerate() {
        information[(index, index)] += 12.0 / parameter.span().powi(2);
    }
    let relative = relative_deviation(problem) * scale.sqrt();
    let (points, rows) = candidate_rows(problem, model, places, candidates, relative)?;
    let chosen = best(&information, &rows, count);
    let with = chosen.iter().fold(information.clone(), |sum, &index| sum + outer(&rows[index]));
    Ok(Plan {
        points: chosen.iter().map(|&index| points[index]).collect(),
        before: deviations(&information),
        after: deviations(&with),
    })
}

/// The root mean square of sigma over friction.
fn relative_deviation(problem: &Problem) -> f64 {
    let square = |row: &FrictionMeasurement| (row.sigma / row.friction.abs().max(assumed_sigma(0.0))).powi(2);
    (problem.rows.iter().map(square).sum::<f64>() / problem.rows.len().max(1) as f64).sqrt()
}

/// The candidates that slide steadily, and the derivatives of a measurement there over its deviation.
fn candidate_rows(
    problem: &Problem,
    model: &dyn FrictionModel,
    places: &[f64],
    candidates: &[OperatingPoint],
    relative: f64,
) -> Result<(Vec<OperatingPoint>, Vec<DVector<f64>>), ModelError> {
    // Residuals with sigma = 1: frictions.
    let row = |point| FrictionMeasurement { point, friction: 0.0, sigma: 1.0 };
    let mut grid = Problem { points: candidates.to_vec(), ..problem.clone() };
    grid.rows = (0..candidates.len()).map(row).collect();
    let at = loop {
        match grid.linearised_to_both_sides(model, places) {
            Err(ModelError::NotSteady(failed)) => {
                grid = grid.without(&failed.iter().map(|(point, _)| *point).collect::<Vec<_>>());
            }
            found => break found?,
        }
    };
    let jacobian = by_coordinates(&grid, &at);
    let row = |(index, friction): (usize, &f64)| jacobian.row(index).transpose() / (relative * friction).abs();
    Ok((grid.points.clone(), at.residuals.iter().enumerate().map(row).collect()))
}

fn outer(row: &DVector<f64>) -> DMatrix<f64> {
    row * row.transpose()
}

/// The rows, each once, that make the determinant largest beside `information`.
fn best(information: &DMatrix<f64>, rows: &[DVector<f64>], count: usize) -> Vec<usize> {
    let mut chosen: Vec<usize> = Vec::new();
    let gain = |others: &[usize], candidate: usize| {
        let sum = others.iter().fold(information + outer(&rows[candidate]), |sum, &index| sum + outer(&rows[index]));
        log_determinant(&sum)
    };
    let largest = |others: &[usize]| {
        let free = (0..rows.len()).filter(|index| !others.contains(index));
        free.map(|index| (gain(others, index), index)).max_by(|a, b| a.0.total_cmp(&b.0))
    };
    while chosen.len() < count {
        let Some((_, index)) = largest(&chosen) else { return chosen };
        chosen.push(index);
    }
    /// Exchanges that bring less than this end it.
    const NOTHING: f64 = 1e-9;
    loop {
        let mut better = false;
        for place in 0..chosen.len() {
            let others: Vec<usize> = chosen.iter().enumerate().filter(|(i, _)| *i != place).map(|(_, &c)| c).collect();
            if let Some((found, index)) = largest(&others)
                && found > gain(&others, chosen[place]) + NOTHING
            {
                (chosen[place], better) = (index, true);
            }
        }
        if !better {
            chosen.sort_unstable();
            return chosen;
        }
    }
}

fn log_determinant(matrix: &DMatrix<f64>) -> f64 {
    matrix.clone().cholesky().map_or(f64::NEG_INFINITY, |factor| 2.0 * factor.l().diagonal().map(f64::ln).sum())
}

/// Standard errors by an information.
fn deviations(information: &DMatrix<f64>) -> Vec<f64> {
    let inverse = information.clone().cholesky().map(|factor| factor.inverse());
    inverse.map_or_else(
        || vec![f64::INFINITY; information.nrows()],
        |covariance| covariance.diagonal().iter().map(|variance| variance.sqrt()).collect(),
    )
}

/// The grid that is asked for; else one that reaches a decade of speed, a factor of two of pressure and 20 K beyond the
/// measurements.
pub(super) fn candidates(scene: &Scene, measured: &[OperatingPoint], asked: &CandidateOptions) -> Vec<OperatingPoint> {
    let pressures = asked.pressures.clone();
    let pressures = pressures.unwrap_or_else(|| in_logarithm(3, range(measured, |point| Some(point.load)), 2.0));
    let speeds = asked.speeds.clone();
    let speeds = speeds.unwrap_or_else(|| in_logarithm(9, range(measured, |point| Some(point.speed)), 10.0));
    let own =
        range(measured, |point| point.temperature).map(|(low, high)| even(5, (low - 20.0, high + 20.0)).collect());
    let kelvin: Option<Vec<f64>> = asked.temperatures.clone().or(own);
    let is_possible = |kelvin: &f64| scene.with_temperature(*kelvin).check().is_ok();
    let temperatures: Vec<Option<f64>> = match kelvin {
        Some(kelvin) if measured.iter().any(|point| point.temperature.is_some()) => {
            kelvin.into_iter().filter(is_possible).map(|kelvin| Some(rounded(kelvin, 5))).collect()
        }
        _ => vec![None],
    };
    let mut ways: Vec<Option<f64>> = Vec::new();
    for point in measured {
        if !ways.contains(&point.way) {
            ways.push(point.way);
        }
    }
    let mut points = Vec::new();
    for &temperature in &temperatures {
        for &load in &pressures {
            let at = |way| speeds.iter().map(move |&speed| OperatingPoint { speed, load, temperature, way });
            points.extend(ways.iter().flat_map(|&way| at(way)));
        }
    }
    points
}

/// The least and the largest value of the points that have it.
fn range(points: &[OperatingPoint], value: impl Fn(&OperatingPoint) -> Option<f64>) -> Option<(f64, f64)> {
    points.iter().filter_map(value).fold(None, |range, value| {
        Some(range.map_or((value, value), |(low, high): (f64, f64)| (low.min(value), high.max(value))))
    })
}

fn even(count: u32, (low, high): (f64, f64)) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| low + (high - low) * f64::from(i) / f64::from(count - 1))
}

/// Values even in the logarithm, from a factor below the range to one above it.
fn in_logarithm(count: u32, range: Option<(f64, f64)>, factor: f64) -> Vec<f64> {
    let range = range.map(|(low, high)| ((low / factor).ln(), (high * factor).ln()));
    range.map_or_else(Vec::new, |range| even(count, range).map(|value| rounded(value.exp(), 3)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line is known best from its ends, and a parabola from ends and middle.
    #[test]
    fn a_polynomial_is_measured_where_the_book_says() {
        let places: Vec<f64> = (0..=20).map(|i| -1.0 + 0.1 * f64::from(i)).collect();
        let rows = |degree: usize| -> Vec<DVector<f64>> {
            places.iter().map(|x| DVector::from_fn(degree + 1, |power, _| x.powi(power as i32))).collect()
        };
        let nothing = |degree: usize| DMatrix::identity(degree + 1, degree + 1) * 1e-9;
        assert_eq!(best(&nothing(1), &rows(1), 2), [0, 20]);
        assert_eq!(best(&nothing(2), &rows(2), 3), [0, 10, 20]);
    }
}
