//! What a calibration found.

use asperity::element::OperatingPoint;

use super::error::NoSliding;
use super::fit::Fitted;
use super::measurements::Measurements;
use super::model::FrictionParts;
use super::parameter::FreeParameter;
use super::problem::{Linearised, Problem};
use super::statistics::Statistics;
use crate::decimals::{rounded, short};

/// Where a fit led, and what the data say there.
#[derive(Debug)]
pub struct Calibration {
    /// The values that the scene had before.
    pub own: Vec<f64>,
    /// What was measured.
    pub measurements: Measurements,
    /// The measurements that were fitted.
    pub problem: Problem,
    /// Where the fit ended.
    pub fitted: Fitted,
    /// Residuals and derivatives there.
    pub linearised: Linearised,
    /// Errors and identifiability of the parameters.
    pub statistics: Statistics,
    /// Friction of the problem's points.
    pub frictions: Vec<FrictionParts>,
    /// The points that cannot be simulated, and why.
    pub left_out: Vec<(OperatingPoint, NoSliding)>,
    /// What of it no rubber has, and why.
    pub implausible: Vec<String>,
    /// How it was fitted.
    pub way: String,
}

/// A number that was fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibratedParameter {
    /// The path of its key.
    pub key: String,
    /// Its value in the scene.
    pub before: f64,
    /// Its value now.
    pub value: f64,
    /// Its standard error; `None` at a bound, and where the data do not tell it.
    pub standard_error: Option<f64>,
    /// Its 95 % interval; `None` as for the error.
    pub interval: Option<(f64, f64)>,
    /// Whether the data tell it.
    pub is_identifiable: bool,
}

/// Digits of a fitted number.
const DIGITS: usize = 7;

impl Calibration {
    /// The values of the parameters.
    pub fn values(&self) -> Vec<f64> {
        self.problem.values(&self.fitted.places).iter().map(|value| rounded(*value, DIGITS)).collect()
    }

    /// The parameters with their values and errors.
    pub fn parameters(&self) -> Vec<CalibratedParameter> {
        let (statistics, values) = (&self.statistics, self.values());
        let parameter = |(index, parameter): (usize, &FreeParameter)| {
            let is_identifiable = statistics.is_identifiable(index);
            let error = statistics.errors[index].map(|error| parameter.error_of_value(values[index], error));
            CalibratedParameter {
                key: parameter.key.clone(),
                before: self.own[index],
                value: values[index],
                standard_error: error.filter(|_| is_identifiable),
                interval: statistics.intervals[index].filter(|_| is_identifiable),
                is_identifiable,
            }
        };
        self.problem.parameters.iter().enumerate().map(parameter).collect()
    }

    /// Friction at a point that was measured; `None` where it was left out.
    pub fn friction_at(&self, point: &OperatingPoint) -> Option<f64> {
        let index = self.problem.points.iter().position(|other| other == point)?;
        Some(self.frictions[index].friction())
    }

    /// Whether the fit has converged, and all numbers are identifiable.
    pub fn is_whole(&self) -> bool {
        self.fitted.has_converged && self.statistics.tell_all()
    }

    /// What is left out, and what is not as it should be.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        warnings.extend(self.measurements.left_out_in_words(&self.left_out));
        warnings.extend(self.implausible.iter().cloned());
        if !self.fitted.has_converged {
            warnings.push("the fit has not converged: other bounds or fewer parameters may help".to_owned());
        }
        for (parameter, bound) in self.problem.parameters.iter().zip(&self.statistics.at_bound) {
            if let Some(bound) = bound {
                warnings.push(format!("{} is at its bound {}", parameter.key, short(*bound, 4)));
            }
        }
        if !self.statistics.tell_all() {
            let advice = "measure what tells them apart, or fix one of them";
            warnings.push(format!("not all parameters are identifiable: {advice}"));
        }
        warnings
    }
}
