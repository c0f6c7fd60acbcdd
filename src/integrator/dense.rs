//! Dense output of event-driven steps: the motion and the state within a step (docs/theory.md, section 5).
//!
//! Velocities are combinations of those at the stages ([`StageInterpolation`]), positions their integrals. The Maxwell
//! elements follow these velocities by the exact solution of ȧ = ė - a/τ, for any τ; its difference from the step's own end
//! is distributed linearly over the step.

use std::ops::Range;

use super::carrier_sums::{AxisSums, CarrierSums, ElementWeights, Motion, Placement};
use super::error::Tolerance;
use super::interpolation::StageInterpolation;
use super::rates::Rates;
use super::tableau::STAGES;
use crate::math::{BLOCK, Relaxation, dot, weighted_sum, with_widest_vectors};
use crate::model::{
    ByAxis, ByLink, Carrier, CarrierPoint, ContactForces, Forces, LinkKind, MaxwellRow, Mode, Model, State,
    SurfacePoint,
};

/// Where a step lies in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepSpan {
    /// Start of the step, s after the start of the carrier's piece.
    pub start: f64,
    /// Length of the step, s.
    pub length: f64,
}

impl StepSpan {
    /// The time at the fraction `theta` of the step, s after the start of the carrier's piece.
    pub fn at(&self, theta: f64) -> f64 {
        self.start + theta * self.length
    }
}

/// State and carrier at the start or at the end of a step.
#[derive(Clone, Copy, Debug)]
pub struct StepBoundary<'a> {
    /// The state.
    pub state: &'a State,
    /// The carrier.
    pub carrier: CarrierPoint,
}

/// The interpolant of one step by the values at its stages.
#[derive(Clone, Debug)]
pub struct DenseOutput<'a> {
    /// The model.
    pub model: &'a Model,
    /// The masses whose states, sums and defects are meant: all of the layer, or a part of it.
    pub masses: Range<usize>,
    /// The carrier's motion.
    pub carrier: &'a Carrier,
    /// The step.
    pub span: StepSpan,
    /// Its start.
    pub start: StepBoundary<'a>,
    /// Its end.
    pub end: StepBoundary<'a>,
    /// The rates at its stages.
    pub stages: &'a [Rates],
    /// The carrier at its stages.
    pub carriers: &'a [CarrierPoint],
    /// The weights of its stages.
    pub interpolation: &'a StageInterpolation,
}

impl DenseOutput<'_> {
    /// Of these masses alone.
    #[must_use]
    pub fn restricted_to(self, masses: Range<usize>) -> Self {
        Self { masses, ..self }
    }

    /// Writes the state at the fraction `theta` of the step.
    pub fn state_at(&self, theta: f64, workspace: &mut DenseWorkspace, state: &mut State) {
        workspace.set_weights(self, theta);
        let (start, masses) = (self.start.state, self.masses.clone());
        state.mode.copy_from_slice(&start.mode[masses.clone()]);
        state.surface.copy_from_slice(&start.surface[masses.clone()]);
        let carrier = self.carrier_at(theta, workspace);
        let DenseWorkspace { values, integral, .. } = &*workspace;
        self.combine(&mut state.velocity_x, values, None, |stage| &stage.velocity_x, carrier.missing_rate.0);
        self.combine(&mut state.velocity_z, values, None, |stage| &stage.velocity_z, carrier.missing_rate.1);
        let (from_x, from_z) = (Some(&start.elongation_x[..]), Some(&start.elongation_z[..]));
        self.combine(&mut state.elongation_x, integral, from_x, |stage| &stage.velocity_x, -carrier.integrated.0);
        self.combine(&mut state.elongation_z, integral, from_z, |stage| &stage.velocity_z, -carrier.integrated.1);
        for i in (0..masses.len()).filter(|&i| state.mode[i].in_contact()) {
            let mass = self.on_profile(masses.start + i, (state.elongation_x[i], state.velocity_x[i]), &carrier);
            (state.elongation_x[i], state.elongation_z[i]) = mass.elongation;
            (state.velocity_x[i], state.velocity_z[i]) = mass.velocity;
            state.surface[i] = mass.surface;
        }
        let mut elements = &mut state.maxwell[..];
        for row in &self.model.rows {
            let (of_row, further) = elements.split_at_mut(row.kind.count(masses.len()));
            elements = further;
            let weights = &workspace.relaxation[row.time_index];
            let ends = [(weights.start, start), (theta, self.end.state)];
            let ends =
                ends.into_iter().map(|(weight, state)| (weight, &state.maxwell[row.range.start + masses.start..]));
            let rates = self.stages.iter().map(|stage| &stage.elongation_rate[row.kind][masses.start..]);
            weighted_sum(of_row, ends.chain(weights.rate.into_iter().zip(rates)));
        }
    }

    /// `from` plus the weighted values of the stages plus `shift`, of the masses that are meant.
    fn combine(
        &self,
        out: &mut [f64],
        weights: &[f64; STAGES],
        from: Option<&[f64]>,
        value: fn(&Rates) -> &[f64],
        shift: f64,
    ) {
        let stages = weights.iter().zip(self.stages).map(|(&weight, stage)| (weight, value(stage)));
        let terms = from.map(|from| (1.0, from)).into_iter().chain(stages);
        weighted_sum(out, terms.map(|(weight, values)| (weight, &values[self.masses.start..])));
        if shift != 0.0 {
            out.iter_mut().for_each(|value| *value += shift);
        }
    }

    /// The defect of the dense output in the equations of motion at the fraction `theta`, in the tolerance's norm: the
    /// difference between the accelerations of the interpolant and those that the `forces` in its `state` give, as the
    /// correction of the velocities, and with them of the positions, that Newton's first iteration of a stage as long as
    /// the step so far would make. The workspace is that with which [`state_at`](Self::state_at) wrote the state.
    pub fn defect(
        &self,
        theta: f64,
        state: &State,
        forces: &Forces,
        workspace: &mut DenseWorkspace,
        tolerance: &Tolerance,
    ) -> f64 {
        let (carrier, h) = (self.carrier.at(self.span.at(theta)), self.span.length);
        workspace.set_accelerations(self, theta, &carrier);
        let settled = InertialFraction::new(self.model, theta * h);
        let missed = |of_forces: f64, of_interpolant: f64, velocity: f64, settled: f64| {
            let gained = settled * theta * h * (of_forces - of_interpolant);
            let moved = theta * h * gained;
            (gained * gained / tolerance.velocity_tolerance_sq(velocity))
                .max(moved * moved / tolerance.position_tolerance_sq(0.0))
        };
        let mut largest = 0.0_f64;
        for i in 0..self.masses.len() {
            let (a_x, a_z) = (workspace.of_masses[0][i], workspace.of_masses[1][i]);
            let (v_x, v_z) = (state.velocity_x[i] - carrier.x.speed, state.velocity_z[i] - carrier.z.speed);
            let here = match state.mode[i] {
                Mode::Stick => 0.0,
                Mode::Free => {
                    let (f_x, f_z) = (forces.on_mass_x[i] / self.model.mass, forces.on_mass_z[i] / self.model.mass);
                    missed(f_x, a_x, v_x, settled.x).max(missed(f_z, a_z, v_z, settled.z))
                }
                mode => {
                    let (v, surface) = (state.velocity_x[i], &state.surface[i]);
                    let contact = forces.contact(self.model, i, v, surface);
                    missed(contact.acceleration(self.model, mode, v, surface), a_x, v_x, settled.x)
                }
            };
            largest = largest.max(here);
        }
        largest.sqrt()
    }

    /// The carrier at the fraction `theta`, for which the weights of `workspace` are set.
    fn carrier_at(&self, theta: f64, workspace: &DenseWorkspace) -> CarrierWithin {
        let now = self.carrier.at(self.span.at(theta));
        let sum = |weights: &[f64; STAGES], rate: fn(&CarrierPoint) -> f64| -> f64 {
            weights.iter().zip(self.carriers).map(|(weight, at)| weight * rate(at)).sum()
        };
        let both = |weights| (sum(weights, |at| at.x.speed), sum(weights, |at| at.z.speed));
        let rate = both(&workspace.values);
        CarrierWithin {
            moved: self.carrier.moved(self.span.start, theta * self.span.length),
            integrated: both(&workspace.integral),
            missing_rate: (now.x.speed - rate.0, now.z.speed - rate.1),
            now,
        }
    }

    /// Mass `i` at the fraction of the step for which the weights of `workspace` are set.
    fn mass_at(&self, i: usize, carrier: &CarrierWithin, workspace: &DenseWorkspace) -> MassPoint {
        let start = self.start.state;
        let sum = |weights: &[f64; STAGES], value: fn(&Rates) -> &[f64]| -> f64 {
            weights.iter().zip(self.stages).map(|(weight, stage)| weight * value(stage)[i]).sum()
        };
        let along_x = |weights| sum(weights, |stage| &stage.velocity_x);
        let x = start.elongation_x[i] + along_x(&workspace.integral) - carrier.integrated.0;
        let v_x = along_x(&workspace.values) + carrier.missing_rate.0;
        if start.mode[i].in_contact() {
            return self.on_profile(i, (x, v_x), carrier);
        }
        let along_z = |weights| sum(weights, |stage| &stage.velocity_z);
        MassPoint {
            elongation: (x, start.elongation_z[i] + along_z(&workspace.integral) - carrier.integrated.1),
            velocity: (v_x, along_z(&workspace.values) + carrier.missing_rate.1),
            surface: start.surface[i],
        }
    }

    /// The sums of the elongations and of the velocities of all masses at the fraction `theta`, from the `sums` of the step.
    pub(super) fn summed_motion(&self, theta: f64, sums: &CarrierSums, workspace: &mut DenseWorkspace) -> Motion {
        workspace.set_weights(self, theta);
        let carrier = self.carrier_at(theta, workspace);
        // Elongations are integrated as differences from the carrier's motion at the stages. But sticks along x and contacts along
        // z are where the surface has them, and the carrier moves away from there on its own path.
        let elongation = |axis: &AxisSums, moving: f64, (integrated, moved): (f64, f64)| {
            let of_masses = axis.elongation[0] + dot(&workspace.integral, &axis.velocity);
            of_masses - moving * integrated - (sums.summed - moving) * moved
        };
        let velocity =
            |axis: &AxisSums, moving: f64, missing: f64| dot(&workspace.values, &axis.velocity) + moving * missing;
        let mut all = Motion {
            elongation: (
                elongation(&sums.x, sums.moving, (carrier.integrated.0, carrier.moved.x)),
                elongation(&sums.z, sums.free, (carrier.integrated.1, carrier.moved.z)),
            ),
            velocity: (
                velocity(&sums.x, sums.moving, carrier.missing_rate.0),
                velocity(&sums.z, sums.free, carrier.missing_rate.1),
            ),
        };
        if sums.has_all() {
            return all;
        }
        let DenseWorkspace { values, integral, of_masses: [x, v_x], .. } = workspace;
        let (x, v_x, start) = (&mut x[..self.masses.len()], &mut v_x[..self.masses.len()], self.start.state);
        if start.mode[self.masses.clone()].iter().any(|mode| mode.slips()) {
            self.combine(x, integral, Some(&start.elongation_x), |stage| &stage.velocity_x, -carrier.integrated.0);
            self.combine(v_x, values, None, |stage| &stage.velocity_x, carrier.missing_rate.0);
        }
        with_widest_vectors(
            #[inline(always)]
            || self.add_contacts(&mut all, (x, v_x), &carrier),
        );
        all
    }

    /// Adds the masses in contact, of which those that slip have the elongations `x` (m) and velocities `v_x` (m/s).
    #[inline(always)]
    fn add_contacts(&self, all: &mut Motion, (x, v_x): (&[f64], &[f64]), carrier: &CarrierWithin) {
        let modes = &self.start.state.mode[self.masses.clone()];
        let (placement, of_layer) = (Placement::new(self.carrier, &carrier.now), self.masses.start);
        let mut first = 0;
        for run in modes.chunk_by(|mode, next| mode.slips() == next.slips()) {
            let masses = first..first + run.len();
            first = masses.end;
            if run[0].slips() {
                for block in masses.clone().step_by(BLOCK) {
                    let block = block..masses.end.min(block + BLOCK);
                    all.add_slips(self.model, of_layer + block.start, (&x[block.clone()], &v_x[block]), &placement);
                }
            } else {
                for i in masses.filter(|&i| modes[i].in_contact()) {
                    all.add(&self.on_profile(of_layer + i, (x[i], v_x[i]), carrier).motion());
                }
            }
        }
    }

    /// Mass `i`, in contact, with the elongation and velocity `along_x` (m, m/s) if it slips.
    #[inline(always)]
    fn on_profile(&self, i: usize, along_x: (f64, f64), carrier: &CarrierWithin) -> MassPoint {
        let start = self.start.state;
        let (elongation_x, v_x, surface) = if start.mode[i].slips() {
            let placement = Placement::new(self.carrier, &carrier.now);
            let at = placement.position(self.model.rest_x[i], along_x.0);
            (along_x.0, along_x.1, self.model.surface_at(at))
        } else {
            (start.elongation_x[i] - carrier.moved.x, 0.0, start.surface[i])
        };
        let elongation_z = surface.height - self.model.rest_z[i] - (self.carrier.start.z + carrier.now.z.position);
        MassPoint { elongation: (elongation_x, elongation_z), velocity: (v_x, surface.slope * v_x), surface }
    }

    /// ẋ of mass `i` at the fraction `theta`, m/s.
    pub fn velocity_x(&self, i: usize, theta: f64) -> f64 {
        let values = self.interpolation.values(theta);
        let relative = values.iter().zip(self.stages).zip(self.carriers);
        let relative = relative.map(|((weight, stage), carrier)| weight * (stage.velocity_x[i] - carrier.x.speed));
        relative.sum::<f64>() + self.carrier.at(self.span.at(theta)).x.speed
    }

    /// The contact forces of mass `i`, in contact, at the fraction `theta`: the same as in the state there, for this mass
    /// alone.
    pub fn contact(&self, i: usize, theta: f64, workspace: &mut DenseWorkspace) -> ContactForces {
        workspace.set_weights(self, theta);
        let carrier = self.carrier_at(theta, workspace);
        let here = self.mass_at(i, &carrier, workspace);
        let rate = (here.velocity.0 - carrier.now.x.speed, here.velocity.1 - carrier.now.z.speed);
        let to_carrier = LinkPoint { elongation: here.elongation, rate };
        let mut force_x = -self.link_force(LinkKind::Horizontal, i, theta, &to_carrier, workspace);
        let mut force_z = -self.link_force(LinkKind::Vertical, i, theta, &to_carrier, workspace);
        for (j, link, sign) in [(i.wrapping_sub(1), i.wrapping_sub(1), -1.0), (i + 1, i, 1.0)] {
            if j >= self.model.masses() {
                continue;
            }
            let between = LinkPoint::between(&here, &self.mass_at(j, &carrier, workspace), sign);
            force_x += sign * self.link_force(LinkKind::LateralX, link, theta, &between, workspace);
            force_z += sign * self.link_force(LinkKind::LateralZ, link, theta, &between, workspace);
        }
        let of_end = carrier.now.on_end(i, self.model.masses());
        (force_x, force_z) = (force_x + of_end.x, force_z + of_end.z);
        ContactForces::new(self.model, (force_x, force_z), here.velocity.0, &here.surface)
    }

    /// The forces along x and z of the lateral links between mass `i` and the next at the fraction `theta`, N.
    pub fn lateral_forces(&self, i: usize, theta: f64, workspace: &mut DenseWorkspace) -> [f64; 2] {
        workspace.set_weights(self, theta);
        let carrier = self.carrier_at(theta, workspace);
        let (here, there) = (self.mass_at(i, &carrier, workspace), self.mass_at(i + 1, &carrier, workspace));
        let between = LinkPoint::between(&here, &there, 1.0);
        [LinkKind::LateralX, LinkKind::LateralZ].map(|kind| {
            let present = self.model.links[kind].present;
            if present { self.link_force(kind, i, theta, &between, workspace) } else { 0.0 }
        })
    }

    /// Elongations of the links of mass `i` to the carrier (m) and its velocities (m/s), along x and z, at the fraction
    /// `theta`.
    pub fn motion(&self, i: usize, theta: f64, workspace: &mut DenseWorkspace) -> [(f64, f64); 2] {
        workspace.set_weights(self, theta);
        let carrier = self.carrier_at(theta, workspace);
        let MassPoint { elongation, velocity, .. } = self.mass_at(i, &carrier, workspace);
        [elongation, velocity]
    }

    /// The force of one link at the fraction `theta`, for which the weights of `workspace` are set, N.
    fn link_force(
        &self,
        kind: LinkKind,
        link: usize,
        theta: f64,
        point: &LinkPoint,
        workspace: &DenseWorkspace,
    ) -> f64 {
        let law = &self.model.links[kind];
        let of = |(x, z): (f64, f64)| if kind.is_along_x() { x } else { z };
        let mut force = law.stiffness * of(point.elongation) + law.damping * of(point.rate);
        if law.frozen > 0.0 {
            force -= law.frozen * self.model.frozen_dashpot(kind, link);
        }
        let mut rows = self.model.rows_of(kind).peekable();
        if rows.peek().is_none() {
            return force;
        }
        for row in rows {
            let (start, end) =
                (self.start.state.maxwell[row.range.start + link], self.end.state.maxwell[row.range.start + link]);
            force += row.stiffness * (workspace.relaxation[row.time_index].start * start + theta * end);
        }
        let rates = self.stages.iter().map(|stage| stage.elongation_rate[kind][link]);
        force + workspace.of_rate[kind].iter().zip(rates).map(|(weight, rate)| weight * rate).sum::<f64>()
    }
}

/// The carrier at one instant within a step.
struct CarrierWithin {
    now: CarrierPoint,
    /// Its displacement along x and z since the start of the step, m.
    moved: ByAxis<f64>,
    /// The same as the stages' rates give it, m.
    integrated: (f64, f64),
    /// What the stages' rates miss of u̇ and ẇ, m/s.
    missing_rate: (f64, f64),
}

/// A mass at one instant within a step; along x and z.
pub(super) struct MassPoint {
    pub elongation: (f64, f64),
    pub velocity: (f64, f64),
    pub surface: SurfacePoint,
}

impl MassPoint {
    pub(super) fn motion(&self) -> Motion {
        Motion { elongation: self.elongation, velocity: self.velocity }
    }
}

/// The links at one mass, or between two, at one instant within a step; along x and z.
struct LinkPoint {
    elongation: (f64, f64),
    rate: (f64, f64),
}

impl LinkPoint {
    /// The links from a mass to its neighbour at the right (`sign` 1) or at the left (-1).
    fn between(here: &MassPoint, there: &MassPoint, sign: f64) -> Self {
        let difference = |there: (f64, f64), here: (f64, f64)| (sign * (there.0 - here.0), sign * (there.1 - here.1));
        Self {
            elongation: difference(there.elongation, here.elongation),
            rate: difference(there.velocity, here.velocity),
        }
    }
}

/// How much of a force on a mass becomes velocity in a time β, along x and z: (m/β)/(m/β + βc + d + Σ_j c_j βτ_j/(τ_j + β))
/// of the links to the carrier and to neighbours at rest. The rest goes into them: motion that is faster settles.
struct InertialFraction {
    x: f64,
    z: f64,
}

impl InertialFraction {
    fn new(model: &Model, beta: f64) -> Self {
        let weight = |kind: LinkKind| {
            let link = &model.links[kind];
            let relaxing = |row: &MaxwellRow| row.stiffness * beta * row.relaxation_time / (row.relaxation_time + beta);
            beta * link.stiffness + link.damping + model.rows_of(kind).map(relaxing).sum::<f64>()
        };
        let share = |own: LinkKind, lateral: LinkKind| {
            let inertia = model.mass / beta;
            inertia / (inertia + weight(own) + 2.0 * weight(lateral))
        };
        Self { x: share(LinkKind::Horizontal, LinkKind::LateralX), z: share(LinkKind::Vertical, LinkKind::LateralZ) }
    }
}

/// Workspace of [`DenseOutput`]: the weights of the stages at one fraction of a step.
#[derive(Clone, Debug)]
pub struct DenseWorkspace {
    /// The fraction and the length of the step for which the weights are set.
    at: (f64, f64),
    /// Of the stages' values in a value.
    values: [f64; STAGES],
    /// Of the stages' rates in a value's change since the start, s.
    integral: [f64; STAGES],
    /// By relaxation time.
    relaxation: Vec<RelaxationWeights>,
    /// By kind of link: of the stages' elongation rates in the force of all Maxwell elements, N s/m.
    of_rate: ByLink<[f64; STAGES]>,
    /// Of the masses that are meant: their accelerations in the defect, x and v_x in sums.
    of_masses: [Vec<f64>; 2],
}

/// The weights of a Maxwell element's elongation at the start and of its link's rates at the stages (s). They make the
/// element follow the interpolated rate exactly, less the linear share of the difference at the step's own end.
#[derive(Clone, Copy, Debug, Default)]
struct RelaxationWeights {
    start: f64,
    rate: [f64; STAGES],
    /// The exact solution over the whole step.
    whole: Relaxation,
}

impl DenseWorkspace {
    /// Workspace for steps of `model`.
    pub fn new(model: &Model) -> Self {
        Self {
            at: (f64::NAN, f64::NAN),
            values: [0.0; STAGES],
            integral: [0.0; STAGES],
            relaxation: vec![RelaxationWeights::default(); model.relaxation_times.len()],
            of_rate: ByLink([[0.0; STAGES]; 4]),
            of_masses: [vec![0.0; model.masses()], vec![0.0; model.masses()]],
        }
    }

    /// Workspace for single masses alone, not for [`DenseOutput::defect`] nor for sums over the layer.
    pub fn for_single_masses(model: &Model) -> Self {
        Self { of_masses: [Vec::new(), Vec::new()], ..Self::new(model) }
    }

    /// Forgets the weights: the model has changed.
    pub fn invalidate(&mut self) {
        self.at = (f64::NAN, f64::NAN);
    }

    /// Bytes that this holds.
    pub fn bytes(&self) -> usize {
        self.of_masses.iter().map(|array| array.len() * size_of::<f64>()).sum()
    }

    /// The weights of the elements of one row at the fraction for which the weights are set.
    pub(super) fn of_elements(&self, row: &MaxwellRow) -> ElementWeights {
        let RelaxationWeights { start, rate, .. } = self.relaxation[row.time_index];
        ElementWeights { ends: [start, self.at.0], rates: rate }
    }

    /// Sets the weights at the fraction `theta` of `step`, unless they are there already.
    fn set_weights(&mut self, step: &DenseOutput<'_>, theta: f64) {
        let h = step.span.length;
        if self.at == (theta, h) {
            return;
        }
        let is_other_step = self.at.1 != h;
        self.at = (theta, h);
        self.values = step.interpolation.values(theta);
        self.integral = step.interpolation.integral(theta).map(|weight| h * weight);
        self.of_rate = ByLink([[0.0; STAGES]; 4]);
        for (relaxation, tau) in self.relaxation.iter_mut().zip(&step.model.relaxation_times) {
            if is_other_step {
                relaxation.whole = Relaxation::new(h / tau, 1.0);
            }
            let whole = relaxation.whole;
            let here = if theta == 1.0 { whole } else { Relaxation::new(h / tau, theta) };
            let driven = std::array::from_fn(|power| h * (here.driven[power] - theta * whole.driven[power]));
            relaxation.start = here.decay - theta * whole.decay;
            relaxation.rate = step.interpolation.combined(&driven);
        }
        for row in &step.model.rows {
            let rates = self.relaxation[row.time_index].rate;
            for (weight, rate) in self.of_rate[row.kind].iter_mut().zip(rates) {
                *weight += row.stiffness * rate;
            }
        }
    }

    /// Computes the accelerations of the interpolant along x and z (m/s²) at the fraction `theta` of `step`, with the carrier
    /// there.
    fn set_accelerations(&mut self, step: &DenseOutput<'_>, theta: f64, carrier: &CarrierPoint) {
        let slope = step.interpolation.slope(theta).map(|weight| weight / step.span.length);
        let missing = |of_carrier: f64, rate: fn(&CarrierPoint) -> f64| {
            of_carrier - slope.iter().zip(step.carriers).map(|(weight, at)| weight * rate(at)).sum::<f64>()
        };
        let [x, z] = self.of_masses.each_mut().map(|values| &mut values[..step.masses.len()]);
        let missing_x = missing(carrier.x.acceleration, |at| at.x.speed);
        step.combine(x, &slope, None, |stage| &stage.velocity_x, missing_x);
        step.combine(z, &slope, None, |stage| &stage.velocity_z, missing(carrier.z.acceleration, |at| at.z.speed));
    }
}
