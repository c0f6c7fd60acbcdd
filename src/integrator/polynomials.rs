//! The motions of masses through an event-driven step as polynomials.

use super::dense::DenseOutput;
use super::stage_values::StageValues;
use super::tableau::MAX_STAGES;
use crate::math::Quintic;
use crate::model::Axis;

/// The motions of the masses by the [`DenseOutput`] of one step.
#[derive(Clone, Debug)]
pub struct Polynomials<'a> {
    step: &'a DenseOutput<'a>,
    /// By stage: the Bernstein coefficients of a position by the rate there, s.
    weights: [[f64; 6]; MAX_STAGES],
    /// The largest distance from the start that rates of 1 m/s at all stages, of any signs, can make, s.
    reach: f64,
    /// The carrier's position on the profile, less its displacement since the start by the stages' rates, m.
    x: Quintic,
    /// The carrier's height, less its displacement since the start by the stages' rates, m.
    z: Quintic,
    /// The least and the largest x, and the least z, m.
    bounds: (f64, f64, f64),
}

impl<'a> Polynomials<'a> {
    /// The motions through `step`.
    pub fn new(step: &'a DenseOutput<'a>) -> Self {
        let weights =
            step.interpolation().bernstein_integral().map(|stage| stage.map(|weight| step.span.length * weight));
        let carriers = step.carriers();
        let (at_start, at_end) = (&carriers[0], &carriers[carriers.len() - 1]);
        let quintic = |axis: Axis, start: f64| {
            if step.carrier.is_body(axis) {
                // Its stages give its motion as those of a mass do: nothing is left of it in the difference.
                return Quintic::constant(start + at_start[axis].position);
            }
            let carrier = Quintic::hermite(at_start[axis], at_end[axis], step.span.length);
            carrier.plus(start, carriers.iter().map(|at| -at[axis].speed).zip(&weights))
        };
        let x = quintic(Axis::X, step.carrier.profile_position);
        let z = quintic(Axis::Z, step.carrier.start.z);
        let reach = (0..6).map(|k| weights.iter().map(|stage| stage[k].abs()).sum()).fold(0.0, f64::max);
        let ((x_low, x_high), (z_low, _)) = (x.range(), z.range());
        Self { step, weights, reach, bounds: (x_low, x_high, z_low), x, z }
    }

    /// Bounds of the position of mass `i` on the profile, m, by its speeds at the stages.
    pub fn position_bounds(&self, i: usize) -> (f64, f64) {
        let start = self.step.model.rest_x[i] + self.step.start.elongation_x[i];
        let distance = self.distance(|stage| stage.velocity_x[i]);
        (self.bounds.0 + start - distance, self.bounds.1 + start + distance)
    }

    /// A bound of the least height of mass `i` above the profile's datum, m, by its speeds at the stages.
    pub fn min_height(&self, i: usize) -> f64 {
        let start = self.step.model.rest_z[i] + self.step.start.elongation_z[i];
        self.bounds.2 + start - self.distance(|stage| stage.velocity_z[i])
    }

    #[inline]
    fn distance(&self, rate: impl Fn(&StageValues) -> f64) -> f64 {
        let speeds = self.step.stages().iter().map(|stage| rate(stage).abs());
        self.reach * speeds.fold(0.0, |most, speed| if speed > most { speed } else { most })
    }

    /// The position of mass `i` on the profile, m.
    pub fn position(&self, i: usize) -> Quintic {
        let start = self.step.model.rest_x[i] + self.step.start.elongation_x[i];
        self.motion(&self.x, start, |stage| stage.velocity_x[i])
    }

    /// The height of mass `i` above the profile's datum, m.
    pub fn height(&self, i: usize) -> Quintic {
        let start = self.step.model.rest_z[i] + self.step.start.elongation_z[i];
        self.motion(&self.z, start, |stage| stage.velocity_z[i])
    }

    #[inline]
    fn motion(&self, carrier: &Quintic, start: f64, rate: impl Fn(&StageValues) -> f64) -> Quintic {
        carrier.plus(start, self.step.stages().iter().map(rate).zip(&self.weights))
    }
}
