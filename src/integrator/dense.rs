//! What lies within a step: dense output.
//!
//! Places are the quintics through place, velocity and acceleration at both ends (order 5), velocities their derivatives.
//! The Maxwell elements follow these velocities by the exact solution of ȧ = ė - a/τ, which holds for every τ; what it
//! misses of the step's own end is laid on linearly.

use super::Rates;
use crate::math::{Jet, Quintic, Relaxation, weighted_sum};
use crate::model::{Carrier, CarrierPoint, LinkKind, MaxwellRow, Mode, Model, State};

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
    pub fn state_at(&self, theta: f64, room: &mut DenseRoom, state: &mut State) {
        let carrier = self.carrier.at(self.s + theta * self.h);
        state.mode.copy_from_slice(&self.start.0.mode);
        for i in 0..self.model.masses() {
            let along_x = self.elongation(Axis::X, i);
            let x = along_x.evaluate(theta);
            let along_z = self.elongation(Axis::Z, i);
            room.follow(i, [&along_x, &along_z]);
            state.elongation_x[i] = x.place;
            state.velocity_x[i] = x.speed / self.h + carrier.u_rate;
            match state.mode[i] {
                Mode::Free => {
                    let z = along_z.evaluate(theta);
                    state.elongation_z[i] = z.place;
                    state.velocity_z[i] = z.speed / self.h + carrier.w_rate;
                }
                mode => self.put_on_profile(i, mode, &carrier, state),
            }
        }
        room.follow_neighbours();
        for row in &self.model.rows {
            self.maxwell_at(theta, row, room, &mut state.maxwell[row.range.clone()]);
        }
    }

    fn put_on_profile(&self, i: usize, mode: Mode, carrier: &CarrierPoint, state: &mut State) {
        state.ground[i] = self.start.0.ground[i];
        if mode.slips() {
            let place = self.model.rest_x[i] + (self.carrier.place + (carrier.du + state.elongation_x[i]));
            state.ground[i] = self.model.ground(place);
        } else {
            state.velocity_x[i] = 0.0;
        }
        state.velocity_z[i] = state.ground[i].slope * state.velocity_x[i];
        state.elongation_z[i] = state.ground[i].height - self.model.rest_z[i] - (self.carrier.w + carrier.dw);
    }

    /// The elongation of a link of mass `i` to the carrier through the step, m.
    fn elongation(&self, axis: Axis, i: usize) -> Quintic {
        let (start, end) = (self.carrier.at(self.s), self.carrier.at(self.s + self.h));
        let at = |(state, rates): (&State, &Rates), carrier: &CarrierPoint| match axis {
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
        };
        Quintic::hermite(at(self.start, &start), at(self.end, &end), self.h)
    }

    /// The elongations a of one row of Maxwell elements at the fraction `theta`: those that the rates drive from the start,
    /// and the share `theta` of what these miss of the step's own end.
    fn maxwell_at(&self, theta: f64, row: &MaxwellRow, room: &DenseRoom, a: &mut [f64]) {
        let ratio = self.h / row.relaxation_time;
        let (here, whole) = (Relaxation::new(ratio, theta), Relaxation::new(ratio, 1.0));
        let (start, end) = (&self.start.0.maxwell[row.range.clone()], &self.end.0.maxwell[row.range.clone()]);
        let ends = [(here.decay - theta * whole.decay, start), (theta, end)];
        let rates = room.rate[row.kind as usize].iter().zip(here.driven.iter().zip(whole.driven));
        let driven = rates.map(|(rate, (here, whole))| (here - theta * whole, &rate[..]));
        weighted_sum(a, ends.into_iter().chain(driven));
    }
}

/// Room for the links' elongation rates through a step.
#[derive(Clone, Debug)]
pub struct DenseRoom {
    /// By kind of link: the coefficients of 1, θ, … θ⁴ of h ė; empty where the links have no Maxwell elements.
    rate: [[Vec<f64>; 5]; 4],
}

impl DenseRoom {
    /// Room for steps of `model`.
    pub fn new(model: &Model) -> Self {
        let has = |kind: LinkKind| model.rows.iter().any(|row| row.kind == kind);
        let rate = LinkKind::ALL.map(|kind| {
            // The links between masses are summed from those to the carrier.
            let needed = has(kind) || (!kind.is_lateral() && LinkKind::ALL.into_iter().any(|lateral| {
                lateral.is_lateral() && lateral.is_along_x() == kind.is_along_x() && has(lateral)
            }));
            std::array::from_fn(|_| vec![0.0; if needed { kind.count(model.masses()) } else { 0 }])
        });
        Self { rate }
    }

    /// Bytes that this holds.
    pub fn bytes(&self) -> usize {
        self.rate.iter().flatten().map(|rate| rate.len() * size_of::<f64>()).sum()
    }

    /// Notes the elongations of the links of mass `i` to the carrier, along x and z.
    fn follow(&mut self, i: usize, elongations: [&Quintic; 2]) {
        for (kind, elongation) in [LinkKind::Horizontal, LinkKind::Vertical].into_iter().zip(elongations) {
            let rate = &mut self.rate[kind as usize];
            if !rate[0].is_empty() {
                for (rate, monomial) in rate.iter_mut().zip(elongation.derivative_monomials()) {
                    rate[i] = monomial;
                }
            }
        }
    }

    /// The rates of the links between masses from those of the masses.
    fn follow_neighbours(&mut self) {
        let [vertical, horizontal, lateral_x, lateral_z] = &mut self.rate;
        for (of_masses, between) in [(horizontal, lateral_x), (vertical, lateral_z)] {
            for (of_masses, between) in of_masses.iter().zip(between) {
                for (i, rate) in between.iter_mut().enumerate() {
                    *rate = of_masses[i + 1] - of_masses[i];
                }
            }
        }
    }
}
