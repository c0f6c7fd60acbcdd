//! What error a step may make.

use crate::model::{LinkKind, Model};

/// The tolerances of one step's error. Each quantity weighs as error over (absolute + relative · size).
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerance {
    /// Relative tolerance, 1.
    pub relative: f64,
    /// Absolute tolerance of positions, m.
    pub position: f64,
    /// Absolute tolerance of velocities, m/s: that of positions times the stiffest frequency.
    pub velocity: f64,
    /// c + Σ c_j of each kind of link, N/m: a Maxwell element's error counts by the force that it makes.
    glassy: [f64; 4],
}

/// Newton's iterations are left to this share of the tolerance.
///
/// Recommended 0.001 to 0.1: larger spoils the error estimate, smaller costs iterations.
pub(super) const NEWTON_SHARE: f64 = 0.05;

impl Tolerance {
    /// The tolerances of `model` for a relative and an absolute (m) one.
    pub fn new(model: &Model, relative: f64, absolute: f64) -> Self {
        Self { relative, position: absolute, velocity: absolute * model.stiffest_frequency(), glassy: model.glassy }
    }

    /// The square of the error allowed of a position of this size, m².
    #[inline]
    pub fn of_position(&self, size: f64) -> f64 {
        square(self.position + self.relative * size.abs())
    }

    /// The square of the error allowed of a velocity of this size, m²/s².
    #[inline]
    pub fn of_velocity(&self, size: f64) -> f64 {
        square(self.velocity + self.relative * size.abs())
    }

    /// What turns the error of the force of all Maxwell elements of a link into an elongation, m/N.
    pub fn per_glassy(&self, kind: LinkKind) -> f64 {
        let glassy = self.glassy[kind as usize];
        if glassy > 0.0 { 1.0 / glassy } else { 0.0 }
    }

    /// To what correction of the velocities, m/s, a stage with β = `beta` (s) is solved.
    pub fn newton(&self, beta: f64) -> f64 {
        NEWTON_SHARE * self.velocity.min(self.position / beta)
    }
}

fn square(x: f64) -> f64 {
    x * x
}
