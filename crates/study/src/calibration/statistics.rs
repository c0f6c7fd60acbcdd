//! What the data say of parameters at a least square: errors, correlations, what cannot be told apart; and which
//! measurements would tell more.
//!
//! With J the derivatives of the weighted residuals by the coordinates (the logarithm, or the value over the distance of
//! the bounds), the covariance is (JᵀJ)⁻¹, times χ² per degree of freedom where the standard deviations are assumed. A
//! singular value of J below 1e-3 of the largest is a direction that the data do not see, and a parameter whose 95 %
//! interval covers its bounds is one that they do not tell.

use asperity::element::OperatingPoint;
use asperity::scene::Scene;
use nalgebra::{DMatrix, DVector};

use super::free_scene::PlanOptions;
use super::measurements::assumed_sigma;
use super::models::{FrictionModel, ModelError};
use super::problem::{FreeParameter, FrictionMeasurement, Linearised, Problem, sum_of_squares};
use crate::decimals::{rounded, short};
use crate::uncertainty::CANNOT_SAY;
use crate::values::Values;

/// A singular value below this part of the largest is of a direction that is not identifiable.
const NOT_IDENTIFIABLE: f64 = 1e-3;
/// A smaller component of a direction is a rounding.
const ROUNDING: f64 = 1e-12;
/// A place nearer than this to a bound is at it.
const AT_BOUND: f64 = 1e-4;

/// A direction in the parameters in which friction hardly changes.
#[derive(Clone, Debug, PartialEq)]
pub struct Direction {
    /// How much each parameter moves, in its coordinate; the squares add to 1.
    pub components: Vec<f64>,
    /// Its singular value over the largest.
    pub share: f64,
}

impl Direction {
    /// The parameters that take part: their indices.
    pub fn parameters(&self) -> impl Iterator<Item = usize> {
        /// Smaller components are none.
        const NEXT_TO_NONE: f64 = 0.1;
        self.components.iter().enumerate().filter(|(_, part)| part.abs() > NEXT_TO_NONE).map(|(index, _)| index)
    }
}

/// Residuals that are larger than the errors of the measurements admit: the model is not that of what was measured, and
/// errors of its parameters by the residuals say nothing.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Misfit {
    /// χ² per degree of freedom, beside given standard deviations.
    #[error(
        "{}: chi square is {} per degree of freedom, which the standard deviations of the measurements admit with less than \
         one in a thousand",
        CANNOT_SAY,
        short(*.0, 3)
    )]
    BeyondErrors(f64),
    /// The root mean square of what friction is off by, over friction, where no deviations are given.
    #[error(
        "{}: friction is off by {:.0} % in the root mean square, more than {:.0} %",
        CANNOT_SAY,
        100.0 * .0,
        100.0 * LARGEST_MISFIT
    )]
    Large(f64),
}

/// More than this of friction is no error of a measurement that says none.
const LARGEST_MISFIT: f64 = 0.2;

impl Misfit {
    /// That of some residuals with so many degrees of freedom, if it is one.
    fn new(problem: &Problem, residuals: &[f64], degrees: usize) -> Option<Self> {
        /// The normal deviate above which one in a thousand lies.
        const RARE: f64 = 3.090_232;
        if problem.has_sigma {
            let per_degree = chi_square_per_degree(sum_of_squares(residuals), degrees);
            // Its cube root is nearly normal (E. B. Wilson, M. M. Hilferty, 1931).
            let variance = 2.0 / (9.0 * degrees.max(1) as f64);
            let deviate = (per_degree.cbrt() - 1.0 + variance) / variance.sqrt();
            return (degrees > 0 && deviate > RARE).then_some(Self::BeyondErrors(per_degree));
        }
        let off = |(row, residual): (&FrictionMeasurement, &f64)| residual * relative_sigma(row);
        let off: Vec<f64> = problem.rows.iter().zip(residuals).map(off).collect();
        let rms = (sum_of_squares(&off) / off.len().max(1) as f64).sqrt();
        (rms > LARGEST_MISFIT).then_some(Self::Large(rms))
    }
}

/// Errors and identifiability of the parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistics {
    /// Sum of the squared residuals.
    pub chi_square: f64,
    /// Measurements less free parameters.
    pub degrees: usize,
    /// Where that is more than the errors of the measurements admit.
    pub misfit: Option<Misfit>,
    /// What the squares of errors are multiplied by: 1, or χ² per degree of freedom where the deviations are assumed.
    pub scale: f64,
    /// Which parameters are at a bound: the bound.
    pub at_bound: Vec<Option<f64>>,
    /// Standard errors in the coordinates; `None` at a bound.
    pub errors: Vec<Option<f64>>,
    /// 95 % intervals of the values; `None` at a bound.
    pub intervals: Vec<Option<(f64, f64)>>,
    /// Covariance of the coordinates; 0 of those at a bound.
    pub covariance: DMatrix<f64>,
    /// Correlations; 0 with those at a bound.
    pub correlation: DMatrix<f64>,
    /// The singular values of J, descending, without those at a bound.
    pub singular_values: Vec<f64>,
    /// What cannot be identified.
    pub not_identifiable: Vec<Direction>,
    /// Which parameters have an interval that covers their bounds: the data add nothing to these.
    pub covers_bounds: Vec<bool>,
}

impl Statistics {
    /// Those at some places.
    pub fn new(problem: &Problem, places: &[f64], linearised: &Linearised) -> Self {
        let count = places.len();
        let bound = |(place, parameter): (&f64, &FreeParameter)| match *place {
            place if place < AT_BOUND => Some(parameter.bounds().0),
            place if place > 1.0 - AT_BOUND => Some(parameter.bounds().1),
            _ => None,
        };
        let at_bound: Vec<Option<f64>> = places.iter().zip(&problem.parameters).map(bound).collect();
        let inner: Vec<usize> = (0..count).filter(|&index| at_bound[index].is_none()).collect();
        let degrees = problem.rows.len().saturating_sub(inner.len());
        let chi_square = sum_of_squares(&linearised.residuals);
        let scale = if problem.has_sigma || degrees == 0 { 1.0 } else { chi_square_per_degree(chi_square, degrees) };
        let jacobian = by_coordinates(problem, linearised).select_columns(&inner);
        let mut statistics = Self {
            chi_square,
            degrees,
            misfit: Misfit::new(problem, &linearised.residuals, degrees),
            scale,
            at_bound,
            errors: vec![None; count],
            intervals: vec![None; count],
            covariance: DMatrix::zeros(count, count),
            correlation: DMatrix::identity(count, count),
            singular_values: Vec::new(),
            not_identifiable: Vec::new(),
            covers_bounds: vec![false; count],
        };
        statistics.decompose(jacobian, &inner);
        // Given deviations are known, those of the residuals estimated.
        let factor = if problem.has_sigma { NORMAL } else { student(degrees) };
        for (index, parameter) in problem.parameters.iter().enumerate() {
            let value = parameter.value(places[index]);
            statistics.intervals[index] = statistics.errors[index].map(|error| {
                let end = |sign: f64| parameter.moved(value, sign * factor * error);
                (end(-1.0), end(1.0))
            });
            let (low, high) = parameter.bounds();
            let interval = statistics.intervals[index];
            statistics.covers_bounds[index] = interval.is_some_and(|interval| interval.0 <= low && high <= interval.1);
        }
        statistics
    }

    /// Errors, correlations and directions from the singular values of J over the parameters that are at no bound.
    fn decompose(&mut self, jacobian: DMatrix<f64>, inner: &[usize]) {
        if inner.is_empty() {
            return;
        }
        let decomposed = jacobian.svd(false, true);
        let Some(mut directions) = decomposed.v_t else { return };
        // A rounding over the singular value of what is not seen would be a large variance of what is.
        directions.apply(|component| *component = if component.abs() < ROUNDING { 0.0 } else { *component });
        self.singular_values = decomposed.singular_values.iter().copied().collect();
        let largest = self.singular_values.iter().copied().fold(0.0, f64::max);
        let covariance = |a: usize, b: usize| -> f64 {
            let part = |(k, value): (usize, &f64)| match directions[(k, a)] * directions[(k, b)] {
                0.0 => 0.0,
                product => product / (value * value),
            };
            self.scale * self.singular_values.iter().enumerate().map(part).sum::<f64>()
        };
        let deviations: Vec<f64> = (0..inner.len()).map(|a| covariance(a, a).sqrt()).collect();
        for (a, &row) in inner.iter().enumerate() {
            for (b, &column) in inner.iter().enumerate() {
                self.covariance[(row, column)] = covariance(a, b);
                self.correlation[(row, column)] = covariance(a, b) / (deviations[a] * deviations[b]);
            }
        }
        inner.iter().zip(&deviations).for_each(|(&index, deviation)| self.errors[index] = Some(*deviation));
        for (k, value) in self.singular_values.iter().enumerate() {
            if *value <= NOT_IDENTIFIABLE * largest {
                let mut components = vec![0.0; self.errors.len()];
                inner.iter().enumerate().for_each(|(a, &index)| components[index] = directions[(k, a)]);
                self.not_identifiable.push(Direction { components, share: value / largest });
            }
        }
    }

    /// Whether the data tell all parameters.
    pub fn tell_all(&self) -> bool {
        self.not_identifiable.is_empty() && !self.covers_bounds.contains(&true)
    }

    /// Whether the data tell a parameter.
    pub fn is_identifiable(&self, index: usize) -> bool {
        !self.covers_bounds[index]
            && !self.not_identifiable.iter().any(|direction| direction.parameters().any(|part| part == index))
    }
}

/// J by the coordinates of the statistics.
pub(super) fn by_coordinates(problem: &Problem, linearised: &Linearised) -> DMatrix<f64> {
    let mut jacobian = linearised.jacobian.clone();
    for (mut column, parameter) in jacobian.column_iter_mut().zip(&problem.parameters) {
        column /= parameter.span();
    }
    jacobian
}

/// χ² per degree of freedom; χ² itself without any.
pub fn chi_square_per_degree(chi_square: f64, degrees: usize) -> f64 {
    chi_square / degrees.max(1) as f64
}

/// The factor of the standard error in a 95 % interval of the normal distribution.
const NORMAL: f64 = 1.959_963_984_540_054;

/// That of an estimated error: Student's t, by its expansion in the inverse of the degrees of
/// freedom (M. Abramowitz, I. A. Stegun, 26.7.5), to 1 % from three on.
fn student(degrees: usize) -> f64 {
    let (z, inverse) = (NORMAL, 1.0 / degrees.max(1) as f64);
    let square = z * z;
    let first = z * (square + 1.0) / 4.0;
    let second = z * ((5.0 * square + 16.0) * square + 3.0) / 96.0;
    let third = z * (((3.0 * square + 19.0) * square + 17.0) * square - 15.0) / 384.0;
    let fourth = z * ((((79.0 * square + 776.0) * square + 1482.0) * square - 1920.0) * square - 945.0) / 92160.0;
    z + inverse * (first + inverse * (second + inverse * (third + inverse * fourth)))
}

/// Points to measure and what they would bring: a D-optimal addition to the measurements there are.
///
/// With the information M = JᵀJ of the data, and of the bounds as if each parameter were even between them, those points
/// are added that make det M largest: first one after the other, then by exchanging one at a time (V. V. Fedorov, *Theory
/// of Optimal Experiments*, 1972) until none is better.
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

/// Sigma over friction.
fn relative_sigma(row: &FrictionMeasurement) -> f64 {
    row.sigma / row.friction.abs().max(assumed_sigma(0.0))
}

/// The root mean square of sigma over friction.
fn relative_deviation(problem: &Problem) -> f64 {
    let square = |row: &FrictionMeasurement| relative_sigma(row).powi(2);
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
pub(super) fn candidates(scene: &Scene, measured: &[OperatingPoint], asked: &PlanOptions) -> Vec<OperatingPoint> {
    let given = |values: &Option<Values>| values.clone().map(|values| values.0);
    let pressures = given(&asked.pressures);
    let pressures = pressures.unwrap_or_else(|| in_logarithm(3, range(measured, |point| Some(point.load)), 2.0));
    let speeds = given(&asked.speeds);
    let speeds = speeds.unwrap_or_else(|| in_logarithm(9, range(measured, |point| Some(point.speed)), 10.0));
    let own =
        range(measured, |point| point.temperature).map(|(low, high)| even(5, (low - 20.0, high + 20.0)).collect());
    let kelvin: Option<Vec<f64>> = given(&asked.temperatures).or(own);
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
    use crate::calibration::FrictionMeasurement;

    use super::*;

    /// Quantiles of Student's distribution from tables.
    #[test]
    fn the_factor_of_an_interval_is_that_of_students_tables() {
        for (degrees, factor) in [(3, 3.182), (5, 2.571), (10, 2.228), (30, 2.042), (1000, 1.962)] {
            assert!((student(degrees) / factor - 1.0).abs() < 1e-2, "{degrees}: {}", student(degrees));
        }
    }

    fn problem(rows: usize, parameters: usize, has_sigma: bool) -> Problem {
        // Coordinates and places are one: the bounds are not a decade apart.
        let parameter = |i| FreeParameter::new(format!("p{i}"), 1.0, 2.0).unwrap();
        Problem {
            parameters: (0..parameters).map(parameter).collect(),
            points: Vec::new(),
            rows: vec![FrictionMeasurement { point: 0, friction: 1.0, sigma: 0.1 }; rows],
            has_sigma,
        }
    }

    /// One in a thousand has a χ² of 10 degrees of freedom above 29.59, by tables.
    #[test]
    fn residuals_beyond_the_errors_are_no_fit() {
        let misfit =
            |has_sigma, square: f64| Misfit::new(&problem(11, 1, has_sigma), &[f64::sqrt(square / 11.0); 11], 10);
        assert_eq!(misfit(true, 29.4), None);
        assert!(matches!(misfit(true, 29.8), Some(Misfit::BeyondErrors(_))));
        // Friction of 1 and sigma of 0.1, not given.
        assert_eq!(misfit(false, 11.0 * 1.9_f64.powi(2)), None);
        let large = misfit(false, 11.0 * 5.0_f64.powi(2)).unwrap();
        assert_eq!(
            large.to_string(),
            "the scene cannot say this data: friction is off by 50 % in the root mean square, more than 20 %"
        );
    }

    /// A line through points at -1, 0, 1: its constant has 1/3 of the variance, its slope 1/2.
    #[test]
    fn a_line_has_the_errors_of_the_book() {
        let jacobian = DMatrix::from_row_slice(3, 2, &[1.0, -1.0, 1.0, 0.0, 1.0, 1.0]);
        let linearised = Linearised { residuals: vec![1.0, -2.0, 1.0], jacobian };
        for (has_sigma, scale) in [(true, 1.0), (false, 6.0)] {
            let statistics = Statistics::new(&problem(3, 2, has_sigma), &[0.5, 0.5], &linearised);
            let errors: Vec<f64> = statistics.errors.iter().map(|error| error.unwrap()).collect();
            assert!((errors[0] - f64::sqrt(scale / 3.0)).abs() < 1e-12, "{errors:?}");
            assert!((errors[1] - f64::sqrt(scale / 2.0)).abs() < 1e-12, "{errors:?}");
            assert!(statistics.correlation[(0, 1)].abs() < 1e-12 && statistics.not_identifiable.is_empty());
        }
    }

    /// A line through points at 0, 1, 2, 3: (JᵀJ)⁻¹ by hand is [14, -6; -6, 4]/20.
    #[test]
    fn the_covariance_is_the_inverse_of_the_squares() {
        let jacobian = DMatrix::from_fn(4, 2, |row, column| if column == 0 { 1.0 } else { row as f64 });
        let linearised = Linearised { residuals: vec![1.0, -1.0, -1.0, 1.0], jacobian };
        let statistics = Statistics::new(&problem(4, 2, false), &[0.5, 0.5], &linearised);
        for (at, expected) in [((0, 0), 0.7), ((0, 1), -0.3), ((1, 0), -0.3), ((1, 1), 0.2)] {
            let found = statistics.covariance[at];
            assert!((found - 2.0 * expected).abs() < 1e-12, "{at:?}: {found}");
        }
    }

    #[test]
    fn a_parameter_at_its_bound_has_no_error_and_costs_no_degree() {
        let jacobian = DMatrix::from_row_slice(3, 2, &[1.0, -1.0, 1.0, 0.0, 1.0, 1.0]);
        let linearised = Linearised { residuals: vec![1.0, -2.0, 1.0], jacobian };
        let statistics = Statistics::new(&problem(3, 2, true), &[0.5, 1.0], &linearised);
        assert_eq!((statistics.at_bound[1], statistics.errors[1], statistics.degrees), (Some(2.0), None, 2));
    }

    #[test]
    fn what_counts_only_together_is_named() {
        let jacobian = 100.0 * DMatrix::from_row_slice(3, 3, &[1.0, -1.0, 0.1, 2.0, -2.0, 3.0, 3.0, -3.0, 1.0]);
        let linearised = Linearised { residuals: vec![0.0; 3], jacobian };
        let statistics = Statistics::new(&problem(3, 3, true), &[0.5; 3], &linearised);
        let [direction] = &statistics.not_identifiable[..] else { panic!("{statistics:?}") };
        assert_eq!(direction.parameters().collect::<Vec<_>>(), [0, 1]);
        assert!((direction.components[0] - direction.components[1]).abs() < 1e-12);
        assert!(!statistics.is_identifiable(1) && statistics.is_identifiable(2));
    }

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
