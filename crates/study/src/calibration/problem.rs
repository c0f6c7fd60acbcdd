//! Weighted residuals of a model, and their derivatives by the parameters.
//!
//! Free parameters and their scale.

use std::sync::{Mutex, PoisonError};

use asperity::element::OperatingPoint;
use nalgebra::DMatrix;
use serde::Deserialize;

use super::measurements::Measurements;
use super::models::{FrictionModel, FrictionParts, ModelError, NoSliding, Outcome, Task};
use crate::values::ends;

/// A measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionMeasurement {
    /// The index of its point.
    pub point: usize,
    /// Its friction coefficient.
    pub friction: f64,
    /// The standard deviation of that, measured or assumed.
    pub sigma: f64,
}

/// Measurements to be met by free parameters.
///
/// Parameters are given by their [places](FreeParameter::place) between their bounds, from 0 to 1.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The free parameters.
    pub parameters: Vec<FreeParameter>,
    /// The points that were measured, each once.
    pub points: Vec<OperatingPoint>,
    /// The measurements, repeats included.
    pub rows: Vec<FrictionMeasurement>,
    /// Whether the standard deviations were measured.
    pub has_sigma: bool,
}

/// Residuals at some places, and their derivatives by these.
#[derive(Clone, Debug)]
pub struct Linearised {
    /// (model - measured)/sigma of the rows.
    pub residuals: Vec<f64>,
    /// A row for each measurement, a column for each parameter.
    pub jacobian: DMatrix<f64>,
}

/// Sum of squares.
pub(super) fn sum_of_squares(residuals: &[f64]) -> f64 {
    residuals.iter().map(|residual| residual * residual).sum()
}

impl Problem {
    /// The problem of some measurements.
    pub fn new(parameters: Vec<FreeParameter>, measurements: &Measurements) -> Self {
        let has_sigma = measurements.has_sigma();
        let mut problem = Self { parameters, points: Vec::new(), rows: Vec::new(), has_sigma };
        for measured in &measurements.rows {
            problem.add(measured.point, measured.friction, measured.sigma_or_assumed());
        }
        problem
    }

    /// Adds a measurement of friction and its standard deviation at a point.
    pub(super) fn add(&mut self, at: OperatingPoint, friction: f64, sigma: f64) {
        let point = self.points.iter().position(|point| *point == at).unwrap_or_else(|| {
            self.points.push(at);
            self.points.len() - 1
        });
        self.rows.push(FrictionMeasurement { point, friction, sigma });
    }

    /// The values of the parameters at some places.
    pub fn values(&self, places: &[f64]) -> Vec<f64> {
        self.parameters.iter().zip(places).map(|(parameter, place)| parameter.value(*place)).collect()
    }

    /// The places of some values, moved to the bounds where they lie beyond.
    pub fn places(&self, values: &[f64]) -> Vec<f64> {
        let place = |(parameter, value): (&FreeParameter, &f64)| parameter.place(*value).clamp(0.0, 1.0);
        self.parameters.iter().zip(values).map(place).collect()
    }

    /// The outcomes of a model at its points, for the parameters at each of several places.
    ///
    /// # Errors
    /// Those of the model.
    pub fn outcomes(&self, model: &dyn FrictionModel, places: &[Vec<f64>]) -> Result<Vec<Vec<Outcome>>, ModelError> {
        let tasks: Vec<Task> = places
            .iter()
            .flat_map(|places| {
                let parameters = self.values(places);
                self.points.iter().map(move |&point| Task { parameters: parameters.clone(), point })
            })
            .collect();
        let found: Vec<Mutex<Option<Outcome>>> = tasks.iter().map(|_| Mutex::new(None)).collect();
        model.evaluate(&tasks, &|index, outcome| {
            *found[index].lock().unwrap_or_else(PoisonError::into_inner) = Some(outcome);
            Ok(())
        })?;
        let outcome = |found: Mutex<Option<Outcome>>| {
            let found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
            found.unwrap_or_else(|| Err(NoSliding::new("the model gave no friction")))
        };
        let mut found = found.into_iter().map(outcome);
        Ok(places.iter().map(|_| found.by_ref().take(self.points.len()).collect()).collect())
    }

    /// [`outcomes`](Self::outcomes) of points that all slide steadily.
    ///
    /// # Errors
    /// Those of the model, and [`ModelError::NotSteady`] with the points that do not.
    pub fn frictions(
        &self,
        model: &dyn FrictionModel,
        places: &[Vec<f64>],
    ) -> Result<Vec<Vec<FrictionParts>>, ModelError> {
        let outcomes = self.outcomes(model, places)?;
        let mut failed: Vec<(OperatingPoint, NoSliding)> = Vec::new();
        for outcomes in &outcomes {
            for (point, outcome) in self.points.iter().zip(outcomes) {
                if let Err(why) = outcome
                    && !failed.iter().any(|(known, _)| known == point)
                {
                    failed.push((*point, why.clone()));
                }
            }
        }
        if failed.is_empty() {
            Ok(outcomes.into_iter().map(|outcomes| outcomes.into_iter().flatten().collect()).collect())
        } else {
            Err(ModelError::NotSteady(failed))
        }
    }

    /// (model - measured)/sigma of all rows.
    pub fn residuals_of(&self, frictions: &[FrictionParts]) -> Vec<f64> {
        let residual = |row: &FrictionMeasurement| (frictions[row.point].friction() - row.friction) / row.sigma;
        self.rows.iter().map(residual).collect()
    }

    /// The residuals at some places.
    ///
    /// # Errors
    /// Those of [`frictions`](Self::frictions).
    pub fn residuals(&self, model: &dyn FrictionModel, places: &[f64]) -> Result<Vec<f64>, ModelError> {
        let frictions = self.frictions(model, &[places.to_vec()])?;
        Ok(frictions.iter().flat_map(|frictions| self.residuals_of(frictions)).collect())
    }

    /// The residuals at some places and their derivatives, by differences upwards where the bounds leave room.
    ///
    /// # Errors
    /// Those of [`frictions`](Self::frictions).
    pub fn linearised(&self, model: &dyn FrictionModel, places: &[f64]) -> Result<Linearised, ModelError> {
        self.differences(model, places, model.step())
    }

    /// As [`linearised`](Self::linearised), each derivative the smaller one of the differences to both sides, or zero
    /// where they have opposite signs. Friction jumps where a hot surface has several steady states; across a jump a
    /// difference is as large as its step is short, and the data would seem to tell the parameter exactly.
    ///
    /// # Errors
    /// Those of [`frictions`](Self::frictions).
    pub fn linearised_to_both_sides(
        &self,
        model: &dyn FrictionModel,
        places: &[f64],
    ) -> Result<Linearised, ModelError> {
        let upwards = self.differences(model, places, model.step())?;
        let downwards = self.differences(model, places, -model.step())?;
        let smaller = |a: f64, b: f64| if a * b > 0.0 { a.abs().min(b.abs()).copysign(a) } else { 0.0 };
        Ok(Linearised { jacobian: upwards.jacobian.zip_map(&downwards.jacobian, smaller), ..upwards })
    }

    /// The residuals at some places and their difference quotients by a step, taken the other way where it would leave
    /// the bounds.
    fn differences(&self, model: &dyn FrictionModel, places: &[f64], step: f64) -> Result<Linearised, ModelError> {
        let shifted = |parameter: usize| {
            let mut shifted = places.to_vec();
            let along = shifted[parameter] + step;
            shifted[parameter] = if (0.0..=1.0).contains(&along) { along } else { shifted[parameter] - step };
            shifted
        };
        let all: Vec<Vec<f64>> = std::iter::once(places.to_vec()).chain((0..places.len()).map(shifted)).collect();
        let frictions = self.frictions(model, &all)?;
        let residuals: Vec<Vec<f64>> = frictions.iter().map(|frictions| self.residuals_of(frictions)).collect();
        let derivative = |row: usize, parameter: usize| {
            let change = residuals[1 + parameter][row] - residuals[0][row];
            change / (all[1 + parameter][parameter] - places[parameter])
        };
        let jacobian = DMatrix::from_fn(self.rows.len(), places.len(), derivative);
        Ok(Linearised { residuals: residuals.into_iter().next().unwrap_or_default(), jacobian })
    }

    /// The problem without the measurements at some points.
    pub fn without(&self, left_out: &[OperatingPoint]) -> Self {
        let mut kept = Self { points: Vec::new(), rows: Vec::new(), ..self.clone() };
        for row in &self.rows {
            let point = self.points[row.point];
            if left_out.contains(&point) {
                continue;
            }
            kept.add(point, row.friction, row.sigma);
        }
        kept
    }
}

/// From this ratio of its bounds on the logarithm of a parameter is fitted.
const DECADE: f64 = 10.0;

/// A number of the scene that is fitted, by its key, within bounds.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "(String, f64, f64)")]
pub struct FreeParameter {
    /// The path of its key, as in `friction.rate_shear.strength`.
    pub key: String,
    low: f64,
    high: f64,
}

impl TryFrom<(String, f64, f64)> for FreeParameter {
    type Error = String;

    fn try_from((key, low, high): (String, f64, f64)) -> Result<Self, String> {
        let refused = format!("{key}: expected bounds (low, high), low below high, found ({low}, {high})");
        Self::new(key, low, high).ok_or(refused)
    }
}

impl FreeParameter {
    /// The parameter of a key within bounds; `None` where these are not finite and in their order.
    pub fn new(key: String, low: f64, high: f64) -> Option<Self> {
        (low.is_finite() && high.is_finite() && low < high).then_some(Self { key, low, high })
    }

    /// The parameter of a text `KEY=LOW..HIGH`.
    ///
    /// # Errors
    /// What was expected of the text.
    pub fn parse(text: &str) -> Result<Self, String> {
        let parted = text.split_once('=').and_then(|(key, bounds)| {
            let (low, high) = ends(bounds)?;
            Self::new(key.trim().to_owned(), low, high)
        });
        parted.filter(|parameter| !parameter.key.is_empty()).ok_or_else(|| {
            "expected KEY=LOW..HIGH in SI units, LOW below HIGH, such as friction.rate_shear.strength=1e5..2e7".into()
        })
    }

    /// The bounds.
    pub fn bounds(&self) -> (f64, f64) {
        (self.low, self.high)
    }

    /// Whether the logarithm is fitted: where the bounds are positive and a decade apart or more.
    pub fn is_logarithmic(&self) -> bool {
        // Of bounds that are a decade apart but for rounding.
        self.low > 0.0 && self.high >= DECADE * self.low * (1.0 - 1e-12)
    }

    /// The value at a place between the bounds, 0 to 1: even in the logarithm or in the value. The ends are the bounds
    /// to the last bit.
    pub fn value(&self, place: f64) -> f64 {
        if place <= 0.0 {
            return self.low;
        }
        if place >= 1.0 {
            return self.high;
        }
        let between = if self.is_logarithmic() {
            (self.low.ln() + place * (self.high / self.low).ln()).exp()
        } else {
            self.low + place * (self.high - self.low)
        };
        between.clamp(self.low, self.high)
    }

    /// The place of a value.
    pub fn place(&self, value: f64) -> f64 {
        if self.is_logarithmic() {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// How much the coordinate of the statistics changes from one bound to the other: the logarithm, or the value over
    /// the distance of the bounds.
    pub fn span(&self) -> f64 {
        if self.is_logarithmic() { (self.high / self.low).ln() } else { 1.0 }
    }

    /// The standard error in the parameter's own unit of one in the coordinate of the statistics, at a value.
    pub fn error_of_value(&self, value: f64, error: f64) -> f64 {
        let error = self.error_of_coordinate(error);
        if self.is_logarithmic() { value * error } else { error }
    }

    /// An error in the coordinate of the statistics as one of the logarithm or, where that is not fitted, of the value.
    pub fn error_of_coordinate(&self, error: f64) -> f64 {
        if self.is_logarithmic() { error } else { (self.high - self.low) * error }
    }

    /// The value that is `by` away from another in the coordinate of the statistics; it may lie beyond the bounds.
    pub fn moved(&self, value: f64, by: f64) -> f64 {
        if self.is_logarithmic() { value * by.exp() } else { value + (self.high - self.low) * by }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_logarithm_is_fitted_from_a_decade_on() {
        let is_logarithmic = |low, high| FreeParameter::new("a".into(), low, high).unwrap().is_logarithmic();
        assert!(is_logarithmic(1e-6, 1e-5) && is_logarithmic(0.3, 40.0));
        assert!(!is_logarithmic(0.1, 0.9) && !is_logarithmic(0.0, 10.0) && !is_logarithmic(-1.0, 1.0));
        for (low, high) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            assert_eq!(FreeParameter::new("a".into(), low, high), None);
        }
    }

    #[test]
    fn a_place_and_its_value_go_back_and_forth() {
        for (low, high) in [(1e-6, 1e-4), (0.2, 0.9), (-3.0, 5.0)] {
            let parameter = FreeParameter::new("a".into(), low, high).unwrap();
            assert_eq!((parameter.value(0.0), parameter.value(1.0)), (low, high));
            for place in [0.1, 0.5, 0.93] {
                assert!((parameter.place(parameter.value(place)) - place).abs() < 1e-14);
            }
            let moved = parameter.moved(parameter.value(0.25), 0.5 * parameter.span());
            assert!((moved / parameter.value(0.75) - 1.0).abs() < 1e-14);
        }
    }
}
