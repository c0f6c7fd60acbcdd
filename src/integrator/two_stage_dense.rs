//! Dense output of the method of two stages (docs/theory.md, section 5).
//!
//! Positions are the parabolas through the start and the end with the velocity of the first stage there. Velocities and
//! Maxwell elements, which may have followed a jump in no time, are linear from the start to the first stage and from
//! there to the end, so they do not oscillate. Both are of the method's own order.

use super::carrier_sums::{AxisSums, CarrierSums, Motion};
use super::dense::{MassPoint, StepSpan};
use super::rates::Rates;
use super::tableau::{GAMMA, sdirk2_weights};
use crate::math::{Jet, dot, weighted_sum};
use crate::model::{BodyStep, ByAxis, Carrier, CarrierPoint, Mode, Model, State};

/// The interpolant of one step of the method of two stages.
#[derive(Clone, Copy, Debug)]
pub struct TwoStageDense<'a> {
    /// The model.
    pub model: &'a Model,
    /// The carrier's motion.
    pub carrier: &'a Carrier,
    /// The step.
    pub span: StepSpan,
    /// State at the start.
    pub start: &'a State,
    /// Rates at the first stage.
    pub first: &'a Rates,
    /// State at the end.
    pub end: &'a State,
    /// Rates at the end.
    pub last: &'a Rates,
    /// u as a position on the profile and w at the start, m.
    carrier_start: (f64, f64),
    /// Displacement of the carrier through the step, m.
    carrier_moved: ByAxis<f64>,
    /// u as a position on the profile and w at the end, m.
    carrier_end: (f64, f64),
}

impl<'a> TwoStageDense<'a> {
    /// The step over `span`, between the states at its start and its end and with the rates at its first stage and its
    /// end.
    pub fn new(
        model: &'a Model,
        carrier: &'a Carrier,
        span: StepSpan,
        start: &'a State,
        first: &'a Rates,
        end: &'a State,
        last: &'a Rates,
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
    pub fn velocity(&self, i: usize, theta: f64) -> (f64, f64) {
        let weights = piecewise_linear(theta);
        let of = |values: [f64; 3]| values.iter().zip(weights).map(|(value, weight)| weight * value).sum();
        (
            of([self.start.velocity_x[i], self.first.velocity_x[i], self.end.velocity_x[i]]),
            of([self.start.velocity_z[i], self.first.velocity_z[i], self.end.velocity_z[i]]),
        )
    }

    /// Writes the state at the fraction `theta` of the step into `state`, without the Maxwell elements.
    pub fn state_at(&self, theta: f64, state: &mut State) {
        let StepSpan { start: s, length: h } = self.span;
        let (from, first, to) = (self.start, self.first, self.end);
        let (moved, in_step) = (self.carrier.moved(s, theta * h), self.carrier_moved);
        (0..self.model.masses()).for_each(|i| state.mode[i] = self.mode(i));
        state.surface.copy_from_slice(&from.surface);
        let elongations = |out: &mut [f64], start: &[f64], velocity: &[f64], end: &[f64], moved: f64, in_step: f64| {
            for (out, ((start, end), velocity)) in out.iter_mut().zip(start.iter().zip(end).zip(velocity)) {
                *out = start + (parabola(theta, GAMMA * h * velocity, in_step + (end - start)) - moved);
            }
        };
        let (e_x, e_z) = (&mut state.elongation_x, &mut state.elongation_z);
        elongations(e_x, &from.elongation_x, &first.velocity_x, &to.elongation_x, moved.x, in_step.x);
        elongations(e_z, &from.elongation_z, &first.velocity_z, &to.elongation_z, moved.z, in_step.z);
        let weights = piecewise_linear(theta);
        let velocities = |out: &mut [f64], values: [&[f64]; 3]| {
            weighted_sum(out, weights.into_iter().zip(values).filter(|(weight, _)| *weight != 0.0));
        };
        velocities(&mut state.velocity_x, [&from.velocity_x, &first.velocity_x, &to.velocity_x]);
        velocities(&mut state.velocity_z, [&from.velocity_z, &first.velocity_z, &to.velocity_z]);
        let here = self.carrier.at(self.span.at(theta));
        for i in (0..self.model.masses()).filter(|&i| state.mode[i].in_contact()) {
            let mass = self.on_profile(i, (state.elongation_x[i], state.velocity_x[i]), &here);
            (state.elongation_z[i], state.surface[i]) = (mass.elongation.1, mass.surface);
            (state.velocity_x[i], state.velocity_z[i]) = mass.velocity;
        }
    }

    /// The mode of mass `i` within the step. One that stops or breaks loose on the way moves.
    fn mode(&self, i: usize) -> Mode {
        if self.start.mode[i].slips() { self.start.mode[i] } else { self.end.mode[i] }
    }

    /// Mass `i`, in contact, with the elongation and velocity `along_x` (m, m/s) if it slips.
    #[inline(always)]
    fn on_profile(&self, i: usize, along_x: (f64, f64), here: &CarrierPoint) -> MassPoint {
        let (v_x, surface) = if self.mode(i) == Mode::Stick {
            (0.0, self.start.surface[i])
        } else {
            let x = self.model.rest_x[i] + (self.carrier.profile_position + (here.x.position + along_x.0));
            (along_x.1, self.model.surface_at(x))
        };
        let elongation_z = surface.height - self.model.rest_z[i] - (self.carrier.start.z + here.z.position);
        MassPoint { elongation: (along_x.0, elongation_z), velocity: (v_x, surface.slope * v_x), surface }
    }

    /// The sums of the elongations and of the velocities of all masses at the fraction `theta`, from the `sums` of the step.
    pub(super) fn summed_motion(&self, theta: f64, sums: &CarrierSums) -> Motion {
        let (n, weights) = (sums.summed, piecewise_linear(theta));
        let moved = self.carrier.moved(self.span.start, theta * self.span.length);
        let elongation = |axis: &AxisSums, moved: f64, in_step: f64| {
            let ([start, end], middle) = (axis.elongation, GAMMA * self.span.length * axis.velocity[1]);
            start + (parabola(theta, middle, n * in_step + (end - start)) - n * moved)
        };
        Motion {
            elongation: (
                elongation(&sums.x, moved.x, self.carrier_moved.x),
                elongation(&sums.z, moved.z, self.carrier_moved.z),
            ),
            velocity: (dot(&weights, &sums.x.velocity), dot(&weights, &sums.z.velocity)),
        }
    }
}

/// The parabola from 0 at the start to `end` whose velocity at the first stage makes `middle` in the fraction γ: the
/// integral of the straight line through the velocities at the stages.
#[inline(always)]
fn parabola(theta: f64, middle: f64, end: f64) -> f64 {
    let (first, last) = sdirk2_weights(theta);
    let (of_middle, of_end) = ((first - last * ((1.0 - GAMMA) / GAMMA)) / GAMMA, last / GAMMA);
    of_middle * middle + of_end * end
}

/// The motion of a body through a step of length `h` (s), from its displacement, speed and acceleration at the start, at
/// the first stage and at the end.
pub(super) fn two_stage_body_step(h: f64, [start, first, end]: [Jet; 3]) -> BodyStep {
    let (middle, moved) = (GAMMA * h * first.speed, end.position - start.position);
    let half = parabola(0.5, middle, moved);
    let displacement = [4.0 * half - moved, 2.0 * moved - 4.0 * half];
    BodyStep::TwoStages { length: h, node: GAMMA, displacement, speed: [first.speed, end.speed] }
}

/// Weights of the values at the start, at the first stage and at the end in their piecewise linear interpolant.
#[inline]
pub(super) fn piecewise_linear(theta: f64) -> [f64; 3] {
    if theta < GAMMA {
        [1.0 - theta / GAMMA, theta / GAMMA, 0.0]
    } else {
        let share = (theta - GAMMA) / (1.0 - GAMMA);
        [0.0, 1.0 - share, share]
    }
}
