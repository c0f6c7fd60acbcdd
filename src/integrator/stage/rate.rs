//! Friction that depends on the speed, in Newton's equations of a stage: σ q A τ_f(v) of a slipping mass at v = σ q ẋ.
//! What is held below the creep speed is in the equations already.

use super::StageSolver;
use crate::model::RateShear;

/// What of a slipping mass's equation depends on its speed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RateSlip {
    /// A τ_f(v) - A τ_f(v_c), N, and its derivative, N s/m.
    excess: (f64, f64),
    /// The derivative of the equation by ẋ without this part, kg/s.
    held: f64,
}

impl StageSolver {
    /// Takes σ q (A τ_f(v) - A τ_f(v_c)) at the velocities as they are from the right sides.
    pub(super) fn add_rate_shear(&mut self, law: &RateShear) {
        for ((rate, slip), &i) in self.rate.iter_mut().zip(&self.slip).zip(&self.slips) {
            let sigma = self.state.mode[i].direction();
            rate.excess = law.with_slope(sigma * slip.speed());
            self.system.right[i].x -= sigma * slip.q() * rate.excess.0;
        }
    }

    /// Adds the derivative of that to the diagonal.
    pub(super) fn assemble_rate_shear(&mut self, beta: f64) {
        for ((rate, slip), &i) in self.rate.iter_mut().zip(&self.slip).zip(&self.slips) {
            let sigma = self.state.mode[i].direction();
            let diagonal = &mut self.system.diagonal[i].m11;
            rate.held = *diagonal;
            *diagonal += slip.rate_derivative(beta, sigma, rate.excess);
        }
    }

    /// Takes the corrections of slipping masses along the curve of their friction in place of its tangent. Returns the
    /// largest of them as the velocity, m/s, that the same force would change if friction were the same at every speed:
    /// where it is steep the velocity says little of what is left of the forces.
    pub(super) fn bend_corrections(&mut self, law: &RateShear) -> f64 {
        let mut largest: f64 = 0.0;
        for ((rate, slip), &i) in self.rate.iter().zip(&self.slip).zip(&self.slips) {
            let right = &mut self.system.right[i].x;
            let per_speed = self.state.mode[i].direction() * slip.q();
            let (speed, by) = (per_speed * self.state.velocity_x[i], per_speed * *right);
            let q2 = slip.q() * slip.q();
            let steepness = 1.0 + (q2 * rate.excess.1 / rate.held).max(0.0);
            let bent = law.along_curve(speed, by, rate.held / q2);
            *right = (bent - speed) / per_speed;
            largest = largest.max(steepness * right.abs());
        }
        largest
    }
}
