//! The embedded error estimate of a step.

use super::maxwell::Maxwell;
use super::tolerance::Rod;
use super::{Attempt, Rates, Tableau, Tolerance};
use crate::math::{sum_of, sum_of_pairs, weighted_sum};
use crate::model::{CarrierPoint, LinkKind, Mode, Model, State};

/// The estimated errors of one step, and workspace for them.
#[derive(Clone, Debug)]
pub(super) struct ErrorWorkspace {
    x: Vec<f64>,
    z: Vec<f64>,
    v_x: Vec<f64>,
    v_z: Vec<f64>,
    /// Of the Maxwell elements' forces of one kind of link, N.
    force: Vec<f64>,
}

impl ErrorWorkspace {
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
pub(super) struct ErrorTest<'a, const STAGES: usize> {
    pub tableau: &'a Tableau<STAGES>,
    pub maxwell: &'a Maxwell<STAGES>,
    pub stages: &'a [Rates],
    /// The carrier at the stages.
    pub carrier: &'a [CarrierPoint],
    pub end: &'a State,
    /// The masses in contact.
    pub contacts: &'a [usize],
}

impl<const STAGES: usize> ErrorTest<'_, STAGES> {
    /// The embedded estimate of the step, of length `h`, in the tolerance's norm.
    ///
    /// The carrier's displacement is known, not integrated; yet where masses are in contact a step must be able to see
    /// it: the dense output, the events between the stages and the energies do. So what the method would miss of it
    /// counts as an error too: where every mass sticks, there is no other.
    pub(super) fn error(
        &self,
        model: &Model,
        h: f64,
        tolerance: &Tolerance,
        workspace: &mut ErrorWorkspace,
    ) -> Attempt {
        let carrier_error = self.carrier_error(h);
        self.collect(h, &carrier_error, workspace);
        let (end, rates) = (self.end, &self.carrier[STAGES - 1]);
        let place = |error: &[f64], elongation: &[f64]| {
            sum_of_pairs(error, elongation, |error, e| error * error / tolerance.of_position(e))
        };
        let speed = |error: &[f64], velocity: &[f64], carrier_rate: f64| {
            sum_of_pairs(error, velocity, |error, v| error * error / tolerance.of_velocity(v - carrier_rate))
        };
        let (in_contact, unseen) = self.unseen(&carrier_error, tolerance);
        let mut sum = place(&workspace.x, &end.elongation_x)
            + place(&workspace.z, &end.elongation_z)
            + speed(&workspace.v_x, &end.velocity_x, rates.u_rate)
            + speed(&workspace.v_z, &end.velocity_z, rates.w_rate)
            + in_contact;
        for kind in LinkKind::ALL {
            if let Some(rod) = tolerance.rod(kind) {
                sum += self.rod_error(kind, (rod, h), tolerance, workspace);
            }
            if self.maxwell.has(kind) {
                sum += self.maxwell_error(model, kind, tolerance, workspace);
            }
        }
        let mean = |sum: f64| (sum / model.masses() as f64).sqrt();
        Attempt { error: mean(sum), unseen: mean(unseen) }
    }

    /// The squares of what the method misses of the carrier's displacement, over the masses in contact and over the
    /// free ones.
    fn unseen(&self, (position, _): &CarrierErrors, tolerance: &Tolerance) -> (f64, f64) {
        let (mut in_contact, mut free) = (0.0, 0.0);
        if position.0 == 0.0 && position.1 == 0.0 {
            return (in_contact, free);
        }
        let end = self.end;
        for (mode, (x, z)) in end.mode.iter().zip(end.elongation_x.iter().zip(&end.elongation_z)) {
            let square = position.0 * position.0 / tolerance.of_position(*x)
                + position.1 * position.1 / tolerance.of_position(*z);
            if mode.in_contact() { in_contact += square } else { free += square }
        }
        (in_contact, free)
    }

    /// The errors of places and velocities against the carrier. A sticking mass has none, and along z those of a
    /// contact follow its slope.
    fn collect(&self, h: f64, (position, velocity): &CarrierErrors, workspace: &mut ErrorWorkspace) {
        let weights = &self.tableau.error;
        let sum = |errors: &mut [f64], rate: fn(&Rates) -> &[f64], of_carrier: f64| {
            let counting = self.stages.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
            weighted_sum(errors, counting.map(|(stage, weight)| (h * weight, rate(stage))));
            errors.iter_mut().for_each(|error| *error -= of_carrier);
        };
        sum(&mut workspace.x, |stage| &stage.velocity_x, position.0);
        sum(&mut workspace.z, |stage| &stage.velocity_z, position.1);
        sum(&mut workspace.v_x, |stage| &stage.acceleration_x, velocity.0);
        sum(&mut workspace.v_z, |stage| &stage.acceleration_z, velocity.1);
        for &i in self.contacts {
            if self.end.mode[i] == Mode::Stick {
                (workspace.x[i], workspace.v_x[i]) = (0.0, 0.0);
            }
            let slope = self.end.surface[i].slope;
            (workspace.z[i], workspace.v_z[i]) = (slope * workspace.x[i], slope * workspace.v_x[i]);
        }
    }

    /// The sum of squares of the errors of the Maxwell elements' forces of the links of `kind`.
    fn maxwell_error(
        &self,
        model: &Model,
        kind: LinkKind,
        tolerance: &Tolerance,
        workspace: &mut ErrorWorkspace,
    ) -> f64 {
        let e = if kind.is_along_x() { &self.end.elongation_x } else { &self.end.elongation_z };
        let force = &mut workspace.force[..kind.count(e.len())];
        self.maxwell.force_error(kind, self.stages, force);
        if let Some(per_force) = tolerance.per_pressing_force(kind) {
            return self.pressing_error(model, per_force, tolerance, force);
        }
        let per_force = tolerance.per_force(kind);
        let error = |i: usize| per_force * force[i];
        if kind.is_lateral() {
            sum_of(force.len(), |i| error(i) * error(i) / tolerance.of_position(e[i + 1] - e[i]))
        } else {
            sum_of(force.len(), |i| error(i) * error(i) / tolerance.of_position(e[i]))
        }
    }

    /// The sum of squares of the errors `error` (N) of the vertical Maxwell elements' forces where these are far stiffer
    /// than what lasts: on a mass in contact, which they press on, against the force itself, and not against the place,
    /// which is forced on them.
    fn pressing_error(&self, model: &Model, per_force: f64, tolerance: &Tolerance, error: &[f64]) -> f64 {
        let kind = LinkKind::Vertical;
        let (a, e, per_place) = (&self.end.maxwell, &self.end.elongation_z, tolerance.per_force(kind));
        sum_of(error.len(), |i| {
            let force = || model.rows_of(kind).map(|row| row.stiffness * a[row.range.start + i]).sum::<f64>();
            let (per_force, size) =
                if self.end.mode[i].in_contact() { (per_force, per_force * force()) } else { (per_place, e[i]) };
            (per_force * error[i]).powi(2) / tolerance.of_position(size)
        })
    }

    /// The sum of squares of the errors c δe + d δė of the forces of the links of `kind`, which are rods.
    fn rod_error(
        &self,
        kind: LinkKind,
        (rod, h): (Rod, f64),
        tolerance: &Tolerance,
        workspace: &ErrorWorkspace,
    ) -> f64 {
        let (end, carrier) = (self.end, &self.carrier[STAGES - 1]);
        let (errors, e, v, carrier_rate) = if kind.is_along_x() {
            ((&workspace.x, &workspace.v_x), &end.elongation_x, &end.velocity_x, carrier.u_rate)
        } else {
            ((&workspace.z, &workspace.v_z), &end.elongation_z, &end.velocity_z, carrier.w_rate)
        };
        let force = |places: &[f64], speeds: &[f64], carrier_rate: f64, i: usize| {
            if kind.is_lateral() {
                rod.stiffness * (places[i + 1] - places[i]) + rod.damping * (speeds[i + 1] - speeds[i])
            } else {
                rod.stiffness * places[i] + rod.damping * (speeds[i] - carrier_rate)
            }
        };
        let (per_force, relative) = (tolerance.per_force(kind), tolerance.relative + rod.transient(h));
        sum_of(kind.count(e.len()), |i| {
            let error = per_force * force(errors.0, errors.1, 0.0, i);
            let allowed = tolerance.position + relative * (per_force * force(e, v, carrier_rate, i)).abs();
            error * error / (allowed * allowed)
        })
    }

    fn carrier_error(&self, h: f64) -> CarrierErrors {
        let (mut position, mut velocity) = ((0.0, 0.0), (0.0, 0.0));
        for (at, weight) in self.carrier.iter().zip(&self.tableau.error) {
            let step = h * weight;
            position = (position.0 + step * at.u_rate, position.1 + step * at.w_rate);
            velocity = (velocity.0 + step * at.u_acceleration, velocity.1 + step * at.w_acceleration);
        }
        (position, velocity)
    }
}

/// What the method's embedded estimate says of u and w (m), and of u̇ and ẇ (m/s), as if they were integrated.
type CarrierErrors = ((f64, f64), (f64, f64));
