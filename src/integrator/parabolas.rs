//! The motions of single masses through a step of time-stepping (docs/theory.md, section 5).

use super::interpolation::parabola;
use super::method::TimeSpan;
use super::scheme::Scheme;
use super::stage_values::StageValues;
use super::tableau::GAMMA;
use crate::model::{ByAxis, Carrier, Model, State};

/// The motions of masses through one step: positions on parabolas, velocities on broken lines, as the dense output has
/// them.
#[derive(Clone, Copy, Debug)]
pub struct Parabolas<'a> {
    /// The model.
    pub model: &'a Model,
    /// The carrier's motion.
    pub carrier: &'a Carrier,
    /// The step.
    pub span: TimeSpan,
    /// State at the start.
    pub start: &'a State,
    /// The values at the first stage.
    pub first: &'a StageValues,
    /// State at the end.
    pub end: &'a State,
    /// The values at the end.
    pub last: &'a StageValues,
    /// u as a position on the profile and w at the start, m.
    carrier_start: (f64, f64),
    /// Displacement of the carrier through the step, m.
    carrier_moved: ByAxis<f64>,
    /// u as a position on the profile and w at the end, m.
    carrier_end: (f64, f64),
}

impl<'a> Parabolas<'a> {
    /// The step over `span`, between the states at its start and its end and with the rates at its first stage and its
    /// end.
    pub fn new(
        model: &'a Model,
        carrier: &'a Carrier,
        span: TimeSpan,
        start: &'a State,
        first: &'a StageValues,
        end: &'a State,
        last: &'a StageValues,
    ) -> Self {
        let at = carrier.at(span.start);
        let carrier_start = (carrier.profile_position + at.x.position, carrier.start.z + at.z.position);
        let carrier_moved = carrier.moved(span.start, span.length);
        let carrier_end = (carrier_start.0 + carrier_moved.x, carrier_start.1 + carrier_moved.z);
        Self { model, carrier, span, start, first, end, last, carrier_start, carrier_moved, carrier_end }
    }

    /// The fraction of the step at which its first stage lies.
    pub const FIRST_STAGE: f64 = GAMMA;

    /// The position of mass `i` on the profile at the fraction `theta` of the step, m.
    #[inline(always)]
    pub fn position(&self, i: usize, theta: f64) -> f64 {
        let (start, end) = (self.start.elongation_x[i], self.end.elongation_x[i]);
        let middle = GAMMA * self.span.length * self.first.velocity_x[i];
        self.model.rest_x[i]
            + (self.carrier_start.0 + (start + parabola(theta, middle, self.carrier_moved.x + (end - start))))
    }

    /// The height of mass `i` above the profile's datum at the fraction `theta` of the step, m.
    #[inline(always)]
    pub fn height(&self, i: usize, theta: f64) -> f64 {
        let (start, end) = (self.start.elongation_z[i], self.end.elongation_z[i]);
        let middle = GAMMA * self.span.length * self.first.velocity_z[i];
        self.model.rest_z[i]
            + (self.carrier_start.1 + (start + parabola(theta, middle, self.carrier_moved.z + (end - start))))
    }

    /// The position of mass `i` on the profile at the end of the step, m.
    #[inline(always)]
    pub fn end_position(&self, i: usize) -> f64 {
        self.model.rest_x[i] + (self.carrier_end.0 + self.end.elongation_x[i])
    }

    /// The height of mass `i` above the profile's datum at the end of the step, m.
    #[inline(always)]
    pub fn end_height(&self, i: usize) -> f64 {
        self.model.rest_z[i] + (self.carrier_end.1 + self.end.elongation_z[i])
    }

    /// The velocity of mass `i` at the fraction `theta` of the step, m/s.
    pub fn velocity(&self, i: usize, theta: f64) -> ByAxis<f64> {
        let weights = Scheme::Sdirk2.coefficients().interpolation.values(theta);
        let of = |values: [f64; 3]| values.iter().zip(weights).map(|(value, weight)| weight * value).sum();
        ByAxis {
            x: of([self.start.velocity_x[i], self.first.velocity_x[i], self.end.velocity_x[i]]),
            z: of([self.start.velocity_z[i], self.first.velocity_z[i], self.end.velocity_z[i]]),
        }
    }
}
