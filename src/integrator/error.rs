//! The error test of a step: its embedded error estimate (docs/theory.md, section 9).

use std::hint::select_unpredictable;

use super::heat::StageHeat;
use super::maxwell::Maxwell;
use super::scheme::ContactModes;
use super::stage_values::StageValues;
use super::tableau::Tableau;
use super::tolerance::RunningMaxima;
use super::tolerance::{Rod, Tolerance, square};
use crate::math::{Jet, dot, sum_of, sum_of_pairs, sum_of_triples, weighted_sum, with_widest_vectors};
use crate::model::{Axis, BoundaryPowers, ByAxis, CarrierPoint, LinkKind, Mode, Model, State};

/// The shortest step over the stiffest period/2π in which energies are resolved. An enormous friction stops a mass in
/// less, down to below the resolution of time; what it loses there is its kinetic energy.
const SHORTEST_RESOLVED: f64 = 1e-9;

/// The weight of the error that the method would make of the carrier's displacement under masses in contact.
///
/// Recommended 0.1 to 0.5. It is to keep the steps from passing over motion of the carrier that changes modes, and no
/// error of the forces: 1 costs a tenth of the steps of a slide with a changing speed, whose forces err far less than
/// the tolerance.
const CARRIER_WEIGHT: f64 = 0.3;

/// Errors of F_x count this many times as much as those of F_z.
///
/// Recommended 2 to 8. The profile holds the masses in contact along z. Along x they swing together where a slide
/// starts, and the steps through that swing add up their errors: with 1 those of F_x were three to ten times those of
/// F_z.
const WEIGHT_OF_FORCE_X: f64 = 4.0;

/// The relative error of the speed of a mass that slips on roughness below the profile, in relative tolerances, where modes
/// are held and in steps of time-stepping.
///
/// Recommended 3 to 30 and 30 to 300. A mass that breaks loose where friction falls with the speed passes the decades from
/// its creep speed on by growth, and comes late by as much as its speed errs there; the tolerance of velocities is far above
/// these.
const CREEP_SLACK: [f64; 2] = [10.0, 100.0];

/// The relative error of the speed that a mass remembers, in relative tolerances.
///
/// Recommended 3 to 30. Friction changes by some tenths of itself with the logarithm of that speed; with 100 steps of 1e-2
/// know no more than its magnitude.
const MEMORY_SLACK: f64 = 10.0;
/// The same of a mass that slides with the carrier, and by which factor the speeds may differ there.
///
/// Recommended 0.03 to 0.1, and 1.2 to 3. Where contacts remember long enough to slide evenly, errors of that speed make them
/// stick and be flung; what sticks and slips by its own needs no more than the magnitude.
const EVEN_MEMORY_SLACK: f64 = 0.1;
const EVEN: f64 = 1.5;

/// The change of temperature, K, over which friction changes by a part of itself.
const FLASH_SCALE: f64 = 10.0;

/// Speeds of slip below this share of the tolerance of velocities are not resolved: Newton's iterations leave them open.
const UNRESOLVED: f64 = 1e-3;

/// That weight for `model`. Where friction depends on the speed F_x follows the speeds of creeping masses, which are
/// far below the tolerance of velocities: there the weight would triple the steps of a creep and make it no more
/// accurate.
fn weight_of_force_x(model: &Model) -> f64 {
    if model.friction.depends_on_speed() { 1.0 } else { WEIGHT_OF_FORCE_X }
}

/// The errors of an attempted step by its embedded estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// The error estimate over the tolerance.
    pub error: f64,
    /// The error estimate without the energies and the speeds of creep, over the tolerance.
    pub motion_error: f64,
    /// The error estimate of the carrier's displacement over the tolerance, taken over the free masses. It counts only
    /// where one of them may touch.
    pub carrier_error: f64,
}

/// Workspace for the estimated errors of one step.
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
        let zeros = || vec![0.0; model.masses()];
        Self { x: zeros(), z: zeros(), v_x: zeros(), v_z: zeros(), force: zeros() }
    }
}

/// What the error test of an attempted step needs.
#[derive(Clone, Copy)]
pub(super) struct ErrorTest<'a> {
    pub modes: ContactModes,
    pub tableau: &'static Tableau,
    pub maxwell: &'a Maxwell,
    pub heat: &'a StageHeat,
    pub stages: &'a [StageValues],
    /// The carrier at the stages.
    pub carrier: &'a [CarrierPoint],
    /// The state at the end.
    pub end: &'a State,
    /// The masses in contact.
    pub contacts: &'a [usize],
    /// Those of them that stick at the end.
    pub sticks: &'a [usize],
    /// The powers through the surface and the carrier at the stages, where energies are computed.
    pub exchange: Option<&'a [BoundaryPowers]>,
    /// What the errors of forces and energies are measured by.
    pub largest: RunningMaxima,
}

impl ErrorTest<'_> {
    /// The embedded error estimate of the step, of length `h` (s), in the tolerance's norm.
    ///
    /// The carrier's displacement is known, not integrated. Yet where masses are in contact the steps must resolve it:
    /// the events between the stages depend on it. So the error that the method would make of it counts too, by
    /// [`CARRIER_WEIGHT`]; where every mass sticks there is no other.
    pub(super) fn run(
        &self,
        model: &Model,
        h: f64,
        tolerance: &Tolerance,
        workspace: &mut ErrorWorkspace,
    ) -> ErrorEstimate {
        // The differences from the embedded method: of the carrier, and of positions and velocities of the masses.
        let carrier_error = CarrierQuadrature::new(self.carrier, &self.tableau.error, h);
        self.collect(h, &carrier_error, workspace);
        let (end, rates) = (self.end, &self.carrier[self.tableau.last()]);
        let of_positions = |error: &[f64], elongation: &[f64]| {
            sum_of_pairs(error, elongation, |error, e| error * error / tolerance.position_tolerance_sq(e))
        };
        let of_velocities = |error: &[f64], velocity: &[f64], carrier_rate: f64| {
            sum_of_pairs(error, velocity, |error, v| error * error / tolerance.velocity_tolerance_sq(v - carrier_rate))
        };
        // Their squares over the tolerances.
        let (in_contact, free) = self.carrier_squares(&carrier_error, tolerance);
        let mut sum = of_positions(&workspace.x, &end.elongation_x)
            + of_positions(&workspace.z, &end.elongation_z)
            + of_velocities(&workspace.v_x, &end.velocity_x, rates.x.speed)
            + of_velocities(&workspace.v_z, &end.velocity_z, rates.z.speed)
            + square(CARRIER_WEIGHT) * in_contact
            + self.flash_squares(model, tolerance);
        // Those of the links: stiff ones as rods, Maxwell elements, and the force on the carrier.
        let mut of_forces = 0.0;
        for kind in LinkKind::ALL {
            let rod = tolerance.rod(kind);
            if let Some(rod) = &rod {
                sum += self.rod_squares(kind, rod, h, tolerance, workspace);
            }
            let has_elements = self.maxwell.has_elements(kind);
            if has_elements {
                let force = &mut workspace.force[..kind.count(model.masses())];
                self.maxwell.force_error(kind, self.stages, force);
                sum += self.maxwell_squares(model, kind, tolerance, force);
            }
            if !kind.is_lateral() && rod.is_none() {
                if !has_elements {
                    workspace.force.fill(0.0);
                }
                let weight = if kind.is_along_x() { weight_of_force_x(model) } else { 1.0 };
                of_forces += square(weight) * self.carrier_force_squares(model, kind, tolerance, workspace);
            }
        }
        // Those of the energies, where steps resolve the stiffest oscillation.
        let resolvable = self.exchange.filter(|_| h * model.stiffest_frequency() > SHORTEST_RESOLVED);
        let of_energies = resolvable.map_or(0.0, |exchange| self.energy_square(model, exchange, h, tolerance));
        // Means over the masses; bodies, forces and energies stand beside them.
        let mean = |sum: f64| (sum / tolerance.masses as f64).sqrt();
        let of_bodies = if model.has_bodies() { self.body_squares(model, &carrier_error, tolerance) } else { 0.0 };
        let motion_error = mean(sum).hypot(of_bodies.sqrt()).hypot(self.tableau.force_weight * of_forces.sqrt());
        let creep =
            mean(self.creep_squares(model, tolerance, &workspace.v_x) + self.memory_squares(model, h, tolerance));
        let error = motion_error.hypot(creep).hypot(self.tableau.energy_weight * of_energies.sqrt());
        ErrorEstimate { error, motion_error, carrier_error: mean(free) }
    }

    /// The sum of squares of the errors of the velocities of slipping masses, by what changes the friction of the roughness
    /// below the profile, a function of ln v.
    fn creep_squares(&self, model: &Model, tolerance: &Tolerance, velocity_error: &[f64]) -> f64 {
        let Some(creep_speed) = model.friction.fine_creep_speed() else { return 0.0 };
        let slowest = creep_speed.max(UNRESOLVED * tolerance.velocity);
        let allowed = CREEP_SLACK[self.modes as usize] * tolerance.relative;
        let of = |&i: &usize| {
            let remembered = self.end.memory.get(i).copied().unwrap_or(0.0);
            let speed = self.end.velocity_x[i].abs().max(slowest).max(remembered);
            square(velocity_error[i] / (allowed * speed))
        };
        self.contacts.iter().filter(|&&i| self.end.mode[i].slips()).map(of).sum()
    }

    /// The sum of squares of the errors of the speeds that the masses remember, in a step of length `h` (s), by what changes
    /// friction, a function of ln v. What sticks ages without error.
    fn memory_squares(&self, model: &Model, h: f64, tolerance: &Tolerance) -> f64 {
        if model.friction.memory.is_none() {
            return 0.0;
        }
        let slowest = model.friction.creep_speed();
        let carrier = self.carrier[self.tableau.last()].x.speed.abs();
        let is_even = |speed: f64| speed * EVEN > carrier && speed < carrier * EVEN;
        let of = |i: usize| {
            let error: f64 =
                self.stages.iter().zip(&self.tableau.error).map(|(at, weight)| weight * at.memory_rate[i]).sum();
            let remembered = self.end.memory[i];
            let slack = if is_even(remembered) { EVEN_MEMORY_SLACK } else { MEMORY_SLACK };
            square(h * error / (slack * tolerance.relative * (remembered + slowest)))
        };
        (0..self.end.mode.len()).filter(|&i| self.end.mode[i] != Mode::Stick).map(of).sum()
    }

    /// The sum of squares of the errors of the flash temperatures, by what changes friction.
    fn flash_squares(&self, model: &Model, tolerance: &Tolerance) -> f64 {
        if model.flash.is_none() {
            return 0.0;
        }
        let allowed = |i: usize| tolerance.relative * (FLASH_SCALE + self.end.flash(i).abs());
        self.contacts.iter().map(|&i| square(self.heat.error(i, self.stages) / allowed(i))).sum()
    }

    /// The sum of squares of the errors of the bodies' displacements and speeds over their tolerances, relative to the
    /// way since the start of the segment.
    fn body_squares(&self, model: &Model, error: &CarrierQuadrature, tolerance: &Tolerance) -> f64 {
        let of = |axis: Axis| {
            let Jet { position: way, speed: rate, .. } = self.carrier[self.tableau.last()][axis];
            let (position, velocity) = (error.moved[axis], error.gained[axis]);
            let allowed = tolerance.body_velocity[axis] + tolerance.relative * rate.abs();
            position * position / tolerance.position_tolerance_sq(way) + square(velocity / allowed)
        };
        Axis::ALL.into_iter().filter(|&axis| model.bodies[axis].is_some()).map(of).sum()
    }

    /// The square of the error of the energies through the dampers, those to drives included, the surface and the
    /// carrier over its tolerance.
    ///
    /// Just after a kink the dampers' power falls within times far shorter than the step, which the motion forgets: the
    /// energies alone show that.
    fn energy_square(&self, model: &Model, exchange: &[BoundaryPowers], h: f64, tolerance: &Tolerance) -> f64 {
        let damper = |stage: &StageValues| -> f64 {
            let links = LinkKind::ALL.into_iter().zip(&model.links).filter(|(_, law)| law.damping > 0.0);
            let of = |kind: LinkKind| &stage.elongation_rate[kind][..];
            links.map(|(kind, law)| law.damping * dot(of(kind), of(kind))).sum()
        };
        let (mut errors, mut input) = ([0.0; 3], 0.0);
        let weights = self.tableau.error.iter().zip(self.tableau.weights());
        for (((error, weight), stage), exchange) in weights.zip(self.stages).zip(exchange) {
            let powers = [damper(stage) + exchange.carrier, exchange.friction, exchange.input];
            errors.iter_mut().zip(powers).for_each(|(sum, power)| *sum += h * error * power);
            input += h * weight * exchange.input;
        }
        let carrier = &self.carrier[self.tableau.last()];
        let scale = self.largest.energy_scale(model, tolerance, carrier.x.speed.hypot(carrier.z.speed));
        let allowed = tolerance.relative * scale.max(input.abs());
        errors.iter().map(|error| square(error / allowed)).sum()
    }

    /// The square of the error of F_x or F_z, which the links of `kind` make, over its tolerance: of the sum of their
    /// errors, and of what the sum would be if these were independent, since some of them cancel by chance. Those of
    /// the Maxwell elements are in the workspace.
    fn carrier_force_squares(
        &self,
        model: &Model,
        kind: LinkKind,
        tolerance: &Tolerance,
        workspace: &ErrorWorkspace,
    ) -> f64 {
        let law = &model.links[kind];
        let scale = self.largest.force_scales(model, tolerance);
        let ErrorWorkspace { x, z, v_x, v_z, force } = workspace;
        let (position, velocity, scale) = if kind.is_along_x() { (x, v_x, scale.x) } else { (z, v_z, scale.z) };
        let error =
            |force: f64, position: f64, velocity: f64| force + law.stiffness * position + law.damping * velocity;
        let sum = sum_of_triples(force, position, velocity, error);
        let squares = sum_of_triples(force, position, velocity, |f, x, v| square(error(f, x, v)));
        (sum * sum + squares) / square(tolerance.relative * scale)
    }

    /// The sums of squares of the error of the carrier's displacement, over the masses in contact and over the free
    /// ones.
    fn carrier_squares(&self, error: &CarrierQuadrature, tolerance: &Tolerance) -> (f64, f64) {
        let (position, end) = (error.moved, self.end);
        if position.x == 0.0 && position.z == 0.0 {
            return (0.0, 0.0);
        }
        let of_mass = |x, z| {
            square(position.x) / tolerance.position_tolerance_sq(x)
                + square(position.z) / tolerance.position_tolerance_sq(z)
        };
        let all = sum_of_pairs(&end.elongation_x, &end.elongation_z, of_mass);
        if self.contacts.len() == end.mode.len() {
            return (all, 0.0);
        }
        let in_contact = self.contacts.iter().map(|&i| of_mass(end.elongation_x[i], end.elongation_z[i])).sum::<f64>();
        (in_contact, (all - in_contact).max(0.0))
    }

    /// Collects the errors of positions and velocities relative to the carrier. A mass that sticks through the step has
    /// none along x, and along z those of a contact follow its slope.
    fn collect(&self, h: f64, carrier_error: &CarrierQuadrature, workspace: &mut ErrorWorkspace) {
        let CarrierQuadrature { moved, gained } = carrier_error;
        let weights = &self.tableau.error;
        let sum = |errors: &mut [f64], rate: fn(&StageValues) -> &[f64], of_carrier: f64| {
            let counting = self.stages.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
            weighted_sum(errors, counting.map(|(stage, weight)| (h * weight, rate(stage))));
            errors.iter_mut().for_each(|error| *error -= of_carrier);
        };
        sum(&mut workspace.x, |stage| &stage.velocity_x, moved.x);
        sum(&mut workspace.z, |stage| &stage.velocity_z, moved.z);
        sum(&mut workspace.v_x, |stage| &stage.acceleration_x, gained.x);
        sum(&mut workspace.v_z, |stage| &stage.acceleration_z, gained.z);
        for &i in self.sticks.iter().filter(|&&i| self.stages[1].velocity_x[i] == 0.0) {
            (workspace.x[i], workspace.v_x[i]) = (0.0, 0.0);
        }
        let ErrorWorkspace { x, z, v_x, v_z, .. } = workspace;
        with_widest_vectors(
            #[inline(always)]
            || {
                follow_slopes(z, x, self.end);
                follow_slopes(v_z, v_x, self.end);
            },
        );
    }

    /// The sum of squares of the errors `force` (N) of the Maxwell elements' forces of the links of `kind`.
    fn maxwell_squares(&self, model: &Model, kind: LinkKind, tolerance: &Tolerance, force: &[f64]) -> f64 {
        let e = if kind.is_along_x() { &self.end.elongation_x } else { &self.end.elongation_z };
        if let Some(per_force) = tolerance.per_contact_force(kind) {
            return self.contact_force_squares(model, per_force, tolerance, force);
        }
        let per_force = tolerance.per_force(kind);
        let square = |force: f64, e: f64| square(per_force * force) / tolerance.position_tolerance_sq(e);
        if kind.is_lateral() {
            sum_of_triples(force, e, &e[1..], |force, e, e_next| square(force, e_next - e))
        } else {
            sum_of_pairs(force, e, square)
        }
    }

    /// The sum of squares of the errors `error` (N) of the vertical Maxwell elements' forces where these are far
    /// stiffer than the link in the long term. On a mass in contact the error counts relative to the elements' force
    /// itself, not to the elongation, which the surface imposes.
    fn contact_force_squares(&self, model: &Model, per_force: f64, tolerance: &Tolerance, error: &[f64]) -> f64 {
        let kind = LinkKind::Vertical;
        let (a, e, per_elongation) = (&self.end.maxwell, &self.end.elongation_z, tolerance.per_force(kind));
        sum_of(error.len(), |i| {
            let force = || model.element_force(kind, |row| a[row.range.start + i]);
            let (per_force, size) =
                if self.end.mode[i].in_contact() { (per_force, per_force * force()) } else { (per_elongation, e[i]) };
            (per_force * error[i]).powi(2) / tolerance.position_tolerance_sq(size)
        })
    }

    /// The sum of squares of the errors c δe + d δė of the forces of the links of `kind`, which are rods, for a step of
    /// length `h` (s).
    fn rod_squares(&self, kind: LinkKind, rod: &Rod, h: f64, tolerance: &Tolerance, workspace: &ErrorWorkspace) -> f64 {
        let (end, carrier) = (self.end, &self.carrier[self.tableau.last()]);
        let (errors, e, v, carrier_rate) = if kind.is_along_x() {
            ((&workspace.x, &workspace.v_x), &end.elongation_x, &end.velocity_x, carrier.x.speed)
        } else {
            ((&workspace.z, &workspace.v_z), &end.elongation_z, &end.velocity_z, carrier.z.speed)
        };
        let force = |elongation: &[f64], velocity: &[f64], carrier_rate: f64, i: usize| {
            rod.law.force(kind.difference(elongation, 0.0, i), kind.difference(velocity, carrier_rate, i))
        };
        let (per_force, relative) = (tolerance.per_force(kind), tolerance.relative + rod.transient(h));
        sum_of(kind.count(e.len()), |i| {
            let error = per_force * force(errors.0, errors.1, 0.0, i);
            let allowed = tolerance.position + relative * (per_force * force(e, v, carrier_rate, i)).abs();
            error * error / (allowed * allowed)
        })
    }
}

/// Makes the errors along z of masses in contact those along x times the slope under them.
#[inline(always)]
fn follow_slopes(z: &mut [f64], x: &[f64], end: &State) {
    // Slices of one length, so that an index into one of them is one into all.
    let k = z.len();
    let (x, mode, surface) = (&x[..k], &end.mode[..k], &end.surface[..k]);
    for i in 0..k {
        z[i] = select_unpredictable(mode[i].in_contact(), surface[i].slope * x[i], z[i]);
    }
}

/// The carrier's motion through a step by the weights of a quadrature of its rates at the stages; by the weights
/// b_i - b̂_i it is the embedded error estimate of that motion, as if it were integrated.
pub(super) struct CarrierQuadrature {
    /// By which u and w change, m.
    pub moved: ByAxis<f64>,
    /// By which u̇ and ẇ change, m/s.
    pub gained: ByAxis<f64>,
}

impl CarrierQuadrature {
    /// For a step of length `h` (s) with the carrier at its stages.
    pub(super) fn new(carrier: &[CarrierPoint], weights: &[f64], h: f64) -> Self {
        let (mut moved, mut gained) = (ByAxis::default(), ByAxis::default());
        for (at, weight) in carrier.iter().zip(weights) {
            let step = h * weight;
            moved = moved + ByAxis { x: step * at.x.speed, z: step * at.z.speed };
            gained = gained + ByAxis { x: step * at.x.acceleration, z: step * at.z.acceleration };
        }
        Self { moved, gained }
    }
}
