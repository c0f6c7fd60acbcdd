//! The embedded error estimate of a step.

use super::maxwell::Maxwell;
use super::{Attempt, Rates, Tableau, Tolerance};
use crate::math::{sum_of, weighted_sum};
use crate::model::{CarrierPoint, LinkKind, Model, State};

/// The estimated errors of one step, and room for them.
#[derive(Clone, Debug)]
pub(super) struct ErrorRoom {
    x: Vec<f64>,
    z: Vec<f64>,
    v_x: Vec<f64>,
    v_z: Vec<f64>,
    /// Of the Maxwell elements' forces of one kind of link, N.
    force: Vec<f64>,
}

impl ErrorRoom {
    pub(super) fn new(model: &Model) -> Self {
        let zero = vec![0.0; model.masses()];
        Self { x: zero.clone(), z: zero.clone(), v_x: zero.clone(), v_z: zero.clone(), force: zero }
    }

    /// Room for one number a mass.
    pub(super) fn any(&mut self) -> &mut [f64] {
        &mut self.force
    }
}

/// A step that was tried.
#[derive(Clone, Copy)]
pub(super) struct Tried<'a, const STAGES: usize> {
    pub tableau: &'a Tableau<STAGES>,
    pub maxwell: &'a Maxwell<STAGES>,
    pub stages: &'a [Rates],
    /// The carrier at the stages.
    pub carrier: &'a [CarrierPoint],
    pub end: &'a State,
    /// The masses in contact.
    pub contacts: &'a [usize],
}

impl<const STAGES: usize> Tried<'_, STAGES> {
    /// The embedded estimate of the step, of length `h`, in the tolerance's norm and of F_z.
    ///
    /// The carrier's displacement is known, not integrated; yet a step must be able to see it: the dense output, the
    /// events between the stages and the energies do. So what the method would miss of it counts as an error too: where
    /// every mass sticks, there is no other.
    pub(super) fn error(&self, model: &Model, h: f64, tolerance: &Tolerance, room: &mut ErrorRoom) -> Attempt {
        self.collect(h, room);
        let (end, rates) = (self.end, &self.carrier[STAGES - 1]);
        let (u, w) = self.carrier_error(h);
        let masses = model.masses();
        let along = |(error, carrier_error): (&[f64], f64), elongation: &[f64]| {
            let square = |i: usize| error[i] * error[i] + carrier_error * carrier_error;
            sum_of(masses, |i| square(i) / tolerance.of_position(elongation[i]))
        };
        let speed = |error: &[f64], velocity: &[f64], carrier_rate: f64| {
            sum_of(masses, |i| error[i] * error[i] / tolerance.of_velocity(velocity[i] - carrier_rate))
        };
        let mut sum = along((&room.x, u), &end.elongation_x)
            + along((&room.z, w), &end.elongation_z)
            + speed(&room.v_x, &end.velocity_x, rates.u_rate)
            + speed(&room.v_z, &end.velocity_z, rates.w_rate);
        let vertical = &model.links[LinkKind::Vertical as usize];
        let mut force_error = sum_of(masses, |i| vertical.stiffness * room.z[i] + vertical.damping * room.v_z[i]);
        for kind in LinkKind::ALL {
            if !self.maxwell.has(kind) {
                continue;
            }
            sum += self.maxwell_error(kind, tolerance, room);
            if kind == LinkKind::Vertical {
                force_error += room.force.iter().sum::<f64>();
            }
        }
        Attempt { error: (sum / masses as f64).sqrt(), force_error }
    }

    /// The errors of places and velocities; along z those of a contact follow its slope.
    fn collect(&self, h: f64, room: &mut ErrorRoom) {
        let weights = &self.tableau.error;
        let sum = |errors: &mut [f64], rate: fn(&Rates) -> &[f64]| {
            let counting = self.stages.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
            weighted_sum(errors, counting.map(|(stage, weight)| (h * weight, rate(stage))));
        };
        sum(&mut room.x, |stage| &stage.velocity_x);
        sum(&mut room.z, |stage| &stage.velocity_z);
        sum(&mut room.v_x, |stage| &stage.acceleration_x);
        sum(&mut room.v_z, |stage| &stage.acceleration_z);
        for &i in self.contacts {
            let slope = self.end.ground[i].slope;
            (room.z[i], room.v_z[i]) = (slope * room.x[i], slope * room.v_x[i]);
        }
    }

    /// The sum of squares of the errors of the Maxwell elements' forces of the links of `kind`.
    fn maxwell_error(&self, kind: LinkKind, tolerance: &Tolerance, room: &mut ErrorRoom) -> f64 {
        let e = if kind.is_along_x() { &self.end.elongation_x } else { &self.end.elongation_z };
        let force = &mut room.force[..kind.count(e.len())];
        self.maxwell.force_error(kind, self.stages, force);
        let per_glassy = tolerance.per_glassy(kind);
        let error = |i: usize| per_glassy * force[i];
        if kind.is_lateral() {
            sum_of(force.len(), |i| error(i) * error(i) / tolerance.of_position(e[i + 1] - e[i]))
        } else {
            sum_of(force.len(), |i| error(i) * error(i) / tolerance.of_position(e[i]))
        }
    }

    /// The embedded estimate of u and w, as if their rates were integrated, m.
    fn carrier_error(&self, h: f64) -> (f64, f64) {
        let stages = self.carrier.iter().zip(&self.tableau.error).map(|(at, weight)| (at, h * weight));
        stages.fold((0.0, 0.0), |(u, w), (at, weight)| (u + weight * at.u_rate, w + weight * at.w_rate))
    }
}
