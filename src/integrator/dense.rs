//! What lies within a step: dense output.
//!
//! Places are the quintics through place, velocity and acceleration at both ends (order 5), velocities their derivatives.
//! The Maxwell elements follow these velocities by the exact solution of ȧ = ė - a/τ, which holds for every τ; what it
//! misses of the step's own end is laid on linearly.

use super::Rates;
use crate::math::{Jet, Quintic, Relaxation};
use crate::model::{Carrier, MaxwellRow, Mode, Model, State};

/// One step, seen from within.
#[derive(Clone, Copy, Debug)]
pub struct Dense<'a> {
    /// The model.
    pub model: &'a Model,
    /// The carrier's motion.
    pub carrier: &'a Carrier,
    /// Start of the step, s after the start of the carrier's piece.
    pub s: f64,
    /// Length of the step, s.
    pub h: f64,
    /// State and rates at the start.
    pub start: (&'a State, &'a Rates),
    /// State and rates at the end.
    pub end: (&'a State, &'a Rates),
}

/// A direction of motion.
#[derive(Clone, Copy, PartialEq)]
enum Axis {
    X,
    Z,
}

impl Dense<'_> {
    /// The place of mass `i` on the profile through the step, m.
    pub fn place(&self, i: usize) -> Quintic {
        let at = |(state, rates): (&State, &Rates), s: f64| Jet {
            place: self.model.rest_x[i] + (self.carrier.place + (self.carrier.at(s).du + state.elongation_x[i])),
            speed: rates.velocity_x[i],
            acceleration: rates.acceleration_x[i],
        };
        Quintic::hermite(at(self.start, self.s), at(self.end, self.s + self.h), self.h)
    }

    /// The height of mass `i` above the profile's datum through the step, m.
    pub fn height(&self, i: usize) -> Quintic {
        let at = |(state, rates): (&State, &Rates), s: f64| Jet {
            place: self.model.rest_z[i] + (self.carrier.w + (self.carrier.at(s).dw + state.elongation_z[i])),
            speed: rates.velocity_z[i],
            acceleration: rates.acceleration_z[i],
        };
        Quintic::hermite(at(self.start, self.s), at(self.end, self.s + self.h), self.h)
    }

    /// Writes the state at the fraction `theta` of the step.
    pub fn state_at(&self, theta: f64, state: &mut State) {
        let s = self.s + theta * self.h;
        let carrier = self.carrier.at(s);
        state.mode.copy_from_slice(&self.start.0.mode);
        state.ground.copy_from_slice(&self.start.0.ground);
        for i in 0..self.model.masses() {
            let x = self.elongation(Axis::X, i).evaluate(theta);
            state.elongation_x[i] = x.place;
            state.velocity_x[i] = x.speed / self.h + carrier.u_rate;
            let mode = state.mode[i];
            if mode == Mode::Free {
                let z = self.elongation(Axis::Z, i).evaluate(theta);
                state.elongation_z[i] = z.place;
                state.velocity_z[i] = z.speed / self.h + carrier.w_rate;
                continue;
            }
            if mode.slips() {
                let place = self.model.rest_x[i] + (self.carrier.place + (carrier.du + x.place));
                state.ground[i] = self.model.ground(place);
            } else {
                state.velocity_x[i] = 0.0;
            }
            state.velocity_z[i] = state.ground[i].slope * state.velocity_x[i];
            state.elongation_z[i] = state.ground[i].height - self.model.rest_z[i] - (self.carrier.w + carrier.dw);
        }
        for row in &self.model.rows {
            self.maxwell_at(theta, row, &mut state.maxwell[row.range.clone()]);
        }
    }

    /// The elongation of a link of mass `i` to the carrier through the step, m.
    fn elongation(&self, axis: Axis, i: usize) -> Quintic {
        let at = |(state, rates): (&State, &Rates), s: f64| {
            let carrier = self.carrier.at(s);
            match axis {
                Axis::X => Jet {
                    place: state.elongation_x[i],
                    speed: rates.velocity_x[i] - carrier.u_rate,
                    acceleration: rates.acceleration_x[i] - carrier.u_acceleration,
                },
                Axis::Z => Jet {
                    place: state.elongation_z[i],
                    speed: rates.velocity_z[i] - carrier.w_rate,
                    acceleration: rates.acceleration_z[i] - carrier.w_acceleration,
                },
            }
        };
        Quintic::hermite(at(self.start, self.s), at(self.end, self.s + self.h), self.h)
    }

    /// The elongations a of one row of Maxwell elements at the fraction `theta`.
    fn maxwell_at(&self, theta: f64, row: &MaxwellRow, a: &mut [f64]) {
        let ratio = self.h / row.relaxation_time;
        let (here, whole) = (Relaxation::new(ratio, theta), Relaxation::new(ratio, 1.0));
        let axis = if row.kind.is_along_x() { Axis::X } else { Axis::Z };
        let (start, end) = (&self.start.0.maxwell[row.range.clone()], &self.end.0.maxwell[row.range.clone()]);
        let mut next = self.elongation(axis, 0).derivative_monomials();
        for (i, a) in a.iter_mut().enumerate() {
            let mut rate = next;
            if row.kind.is_lateral() {
                let after = self.elongation(axis, i + 1).derivative_monomials();
                rate = std::array::from_fn(|m| after[m] - next[m]);
                next = after;
            } else if i + 1 < self.model.masses() {
                next = self.elongation(axis, i + 1).derivative_monomials();
            }
            *a = follow(&here, start[i], &rate) + theta * (end[i] - follow(&whole, start[i], &rate));
        }
    }
}

/// a of an element that starts at `start` and is driven by the rate with these coefficients.
fn follow(weights: &Relaxation, start: f64, rate: &[f64; 5]) -> f64 {
    weights.decay * start + weights.driven.iter().zip(rate).map(|(weight, rate)| weight * rate).sum::<f64>()
}
