//! Vertical shifts: the factor b_T by which all moduli of a temperature are those of the reference.

use super::error::FitError;
use super::measured::MeasuredModuli;
use super::options::{FitOptions, Vertical};
use super::shift_error::ShiftError;
use super::temperatures::{ROOM, given_factors};
use crate::decimals::{percent, plain, rounded};

/// What is done about the moduli of other temperatures.
#[derive(Debug)]
pub(super) struct VerticalShift {
    kind: Vertical,
    /// The least and the largest b_T.
    range: Option<[f64; 2]>,
}

impl VerticalShift {
    /// Divides the moduli of all points by their b_T, up to what is the same for all.
    pub(super) fn apply(options: &FitOptions, measured: &mut MeasuredModuli) -> Result<Self, FitError> {
        let in_data = |error| FitError::Shift { path: options.data.clone(), error };
        let factors = match options.vertical {
            Vertical::Density(_) if measured.reduced => return Err(in_data(ShiftError::NoDensity)),
            Vertical::Density(expansion) => Some(densities(measured, expansion).map_err(in_data)?),
            Vertical::None => None,
            Vertical::Divide | Vertical::Multiply => of_columns(options, measured)?,
        };
        let has_column = measured.points.iter().any(|point| point.vertical.is_some());
        if options.vertical == Vertical::None && has_column {
            measured.notes.push("the column b_T is left out".into());
        }
        if options.vertical == Vertical::Multiply && factors.is_none() {
            return Err(in_data(ShiftError::NoVertical));
        }
        let Some(factors) = factors else { return Ok(Self { kind: Vertical::None, range: None }) };
        measured.points.iter_mut().zip(&factors).for_each(|(point, b)| point.sample = point.sample.scaled(1.0 / b));
        let least = factors.iter().copied().fold(f64::INFINITY, f64::min);
        let most = factors.iter().copied().fold(0.0, f64::max);
        Ok(Self { kind: options.vertical, range: Some([least, most]) })
    }

    /// Makes b_T 1 at the reference temperature (K) where the factors are not relative to one already, and says what was
    /// done.
    pub(super) fn finish(&mut self, measured: &mut MeasuredModuli, reference: Option<f64>) {
        if let Vertical::Density(expansion) = self.kind {
            let at_reference = density(reference.unwrap_or(ROOM), expansion);
            measured.points.iter_mut().for_each(|point| point.sample = point.sample.scaled(at_reference));
            self.range = self.range.map(|range| range.map(|b| b / at_reference));
        }
        let Some([least, most]) = self.range else { return };
        let how = match self.kind {
            Vertical::Multiply => "multiplied by the column's b_T, that is divided by",
            Vertical::Density(_) => "divided by b_T = ρT/(ρ0 T0),",
            Vertical::Divide | Vertical::None => "divided by the column's b_T (`vertical` multiply: multiplied),",
        };
        let [least, most] = [least, most].map(|b| plain(rounded(b, 4)));
        measured.notes.push(format!("moduli of other temperatures are {how} {least} to {most}"));
    }

    /// A scene shifts times alone.
    pub(super) fn warning(&self) -> Option<String> {
        /// Of the moduli.
        const NEGLIGIBLE: f64 = 0.01;
        let [least, most] = self.range?;
        let largest = (1.0 - least).max(most - 1.0);
        let text = format!(
            "a scene shifts relaxation times with temperature, not moduli: at the temperatures measured it is up to {} off \
             for want of b_T",
            percent(largest, 2)
        );
        (largest > NEGLIGIBLE).then_some(text)
    }
}

/// ρT/(ρ_room T_room): of a volume that grows by `expansion` (1/K).
fn density(temperature: f64, expansion: f64) -> f64 {
    temperature / ROOM / (1.0 + expansion * (temperature - ROOM))
}

fn densities(measured: &MeasuredModuli, expansion: f64) -> Result<Vec<f64>, ShiftError> {
    let of_point = |temperature: Option<f64>| Some(density(temperature?, expansion)).filter(|b| *b > 0.0);
    let factors = measured.points.iter().map(|point| of_point(point.temperature));
    factors.collect::<Option<Vec<f64>>>().ok_or(ShiftError::NoDensity)
}

/// The b_T of all points, by which moduli are divided: of their own rows, or of the table of shift factors.
fn of_columns(options: &FitOptions, measured: &MeasuredModuli) -> Result<Option<Vec<f64>>, FitError> {
    let own: Option<Vec<f64>> = measured.points.iter().map(|point| point.vertical).collect();
    let found = match (own, &options.shifts) {
        (Some(own), _) => Some(own),
        (None, Some(path)) => given_factors(path, measured)?,
        (None, None) => None,
    };
    let multiplies = options.vertical == Vertical::Multiply;
    Ok(found.map(|found| found.into_iter().map(|b| if multiplies { 1.0 / b } else { b }).collect()))
}
