//! What lies within a step of two stages.
//!
//! Places run along the parabola through the start and the end that has the velocity of the first stage there;
//! velocities and Maxwell elements, which may have followed a jump in no time, along the two lines through the start,
//! the first stage and the end, which do not swing. Both are of the method's own order.

use super::Rates;
use super::sdirk::{GAMMA, integrated};
use crate::model::{Carrier, CarrierPoint, Mode, Model, State};

/// One step of two stages, seen from within.
#[derive(Clone, Copy, Debug)]
pub struct TwoStageDense<'a> {
    /// The model.
    pub model: &'a Model,
    /// The carrier's motion.
    pub carrier: &'a Carrier,
    /// Start of the step after the start of the carrier's piece and its length, s.
    pub span: (f64, f64),
    /// State at the start.
    pub start: &'a State,
    /// Rates at the first stage.
    pub first: &'a Rates,
    /// State at the end.
    pub end: &'a State,
    /// Rates at the end.
    pub last: &'a Rates,
    /// u as a place on the profile and w at the start, m.
    at_start: (f64, f64),
    /// How far u and w move through the step, m.
    carried: (f64, f64),
}

impl<'a> TwoStageDense<'a> {
    /// The step of length h from `span.0` on, `span` = (s, h).
    pub fn new(
        model: &'a Model,
        carrier: &'a Carrier,
        span: (f64, f64),
        (start, first): (&'a State, &'a Rates),
        (end, last): (&'a State, &'a Rates),
    ) -> Self {
        let at = carrier.at(span.0);
        let at_start = (carrier.profile_position + at.du, carrier.w + at.dw);
        let carried = carrier.moved(span.0, span.1);
        Self { model, carrier, span, start, first, end, last, at_start, carried }
    }

    /// The fraction of the step at which its first stage lies.
    pub const FIRST: f64 = GAMMA;

    /// The place of mass `i` on the profile at the fraction `theta` of the step, m.
    #[inline]
    pub fn place(&self, i: usize, theta: f64) -> f64 {
        let (start, end) = (self.start.elongation_x[i], self.end.elongation_x[i]);
        let middle = GAMMA * self.span.1 * self.first.velocity_x[i];
        self.model.rest_x[i] + (self.at_start.0 + (start + through(theta, middle, self.carried.0 + (end - start))))
    }

    /// The height of mass `i` above the profile's datum at the fraction `theta` of the step, m.
    #[inline]
    pub fn height(&self, i: usize, theta: f64) -> f64 {
        let (start, end) = (self.start.elongation_z[i], self.end.elongation_z[i]);
        let middle = GAMMA * self.span.1 * self.first.velocity_z[i];
        self.model.rest_z[i] + (self.at_start.1 + (start + through(theta, middle, self.carried.1 + (end - start))))
    }

    /// The velocity of mass `i` at the fraction `theta` of the step, m/s.
    pub fn velocity(&self, i: usize, theta: f64) -> (f64, f64) {
        let weights = along(theta);
        let of = |values: [f64; 3]| values.iter().zip(weights).map(|(value, weight)| weight * value).sum();
        (
            of([self.start.velocity_x[i], self.first.velocity_x[i], self.end.velocity_x[i]]),
            of([self.start.velocity_z[i], self.first.velocity_z[i], self.end.velocity_z[i]]),
        )
    }

    /// Writes the state at the fraction `theta` of the step into `state`, which holds the Maxwell elongations of the
    /// first stage.
    pub fn state_at(&self, theta: f64, state: &mut State) {
        let (s, h) = self.span;
        let here = self.carrier.at(s + theta * h);
        let (beta, (u, w), (end_u, end_w)) = (GAMMA * h, self.carrier.moved(s, theta * h), self.carried);
        let (from, to) = (self.start, self.end);
        state.mode.copy_from_slice(&from.mode);
        state.surface.copy_from_slice(&from.surface);
        for i in 0..self.model.masses() {
            let x =
                through(theta, beta * self.first.velocity_x[i], end_u + (to.elongation_x[i] - from.elongation_x[i]));
            let z =
                through(theta, beta * self.first.velocity_z[i], end_w + (to.elongation_z[i] - from.elongation_z[i]));
            state.elongation_x[i] = from.elongation_x[i] + (x - u);
            state.elongation_z[i] = from.elongation_z[i] + (z - w);
            (state.velocity_x[i], state.velocity_z[i]) = self.velocity(i, theta);
            self.constrain(i, &here, state);
        }
        // Which are those at the first stage so far.
        let [of_start, of_first, of_end] = along(theta);
        for (a, (start, end)) in state.maxwell.iter_mut().zip(from.maxwell.iter().zip(&to.maxwell)) {
            *a = of_start * start + of_first * *a + of_end * end;
        }
    }

    /// Puts mass `i`, where it is in contact, on the profile.
    fn constrain(&self, i: usize, here: &CarrierPoint, state: &mut State) {
        let mode = state.mode[i];
        if mode == Mode::Free {
            return;
        }
        if mode.slips() {
            let place = self.model.rest_x[i] + (self.carrier.profile_position + (here.du + state.elongation_x[i]));
            state.surface[i] = self.model.surface_at(place);
        } else {
            state.velocity_x[i] = 0.0;
        }
        state.velocity_z[i] = state.surface[i].slope * state.velocity_x[i];
        state.elongation_z[i] = state.surface[i].height - self.model.rest_z[i] - (self.carrier.w + here.dw);
    }
}

/// The parabola from 0 at the start to `end` with the velocity at the first stage that makes `middle` in the fraction
/// γ: the stages' velocities on a line, integrated.
#[inline]
fn through(theta: f64, middle: f64, end: f64) -> f64 {
    let (first, last) = integrated(theta);
    let velocity = middle / GAMMA;
    first * velocity + last * (end - (1.0 - GAMMA) * velocity) / GAMMA
}

/// The two lines through the values at the start, the first stage and the end: what each of these weighs.
#[inline]
fn along(theta: f64) -> [f64; 3] {
    if theta < GAMMA {
        [1.0 - theta / GAMMA, theta / GAMMA, 0.0]
    } else {
        let share = (theta - GAMMA) / (1.0 - GAMMA);
        [0.0, 1.0 - share, share]
    }
}
