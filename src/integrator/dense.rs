//! Dense output: the motion and the state within a step (docs/theory.md, section 5).
//!
//! Velocities are combinations of those at the stages ([`Interpolation`]), positions their integrals; in steps of
//! time-stepping velocities are broken lines and positions the parabolas through the start and the end. The Maxwell
//! elements follow polynomial velocities by the exact solution of ȧ = ė - a/τ, for any τ; its difference from the
//! step's own end is distributed linearly over the step. Where velocities are broken lines, so are the elements'
//! elongations.

use std::ops::Range;

use super::carrier_sums::{AxisSums, CarrierSums, LinkState, Placement};
use super::dense_weights::DenseWorkspace;
use super::interpolation::{Interpolation, Velocities, parabola};
use super::maxwell::by_rate;
use super::memory;
use super::method::{RungeKutta, Stages, TimeSpan};
use super::parabolas::Parabolas;
use super::stage_values::StageValues;
use super::tableau::{GAMMA, StageWeights};
use super::tolerance::Tolerance;
use crate::math::{BLOCK, dot, weighted_sum, with_widest_vectors};
use crate::model::{
    ByAxis, Carrier, CarrierPoint, ContactForces, Flash, Forces, LinkKind, MaxwellRow, Mode, Model, SlipHistory,
    SpeedMemory, State, SurfacePoint,
};

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
    pub span: TimeSpan,
    /// The state at its start.
    pub start: &'a State,
    pub(super) method: &'a RungeKutta,
    pub(super) values: &'a Stages,
}

impl<'a> DenseOutput<'a> {
    /// Of these masses alone.
    #[must_use]
    pub fn restricted_to(&self, masses: Range<usize>) -> Self {
        Self { masses, ..*self }
    }

    /// The fraction of the step at the time `s` after the start of the carrier's segment.
    pub fn theta(&self, s: f64) -> f64 {
        (s - self.span.start) / self.span.length
    }

    /// The rates at its stages.
    pub fn stages(&self) -> &'a [StageValues] {
        &self.values.rates[..self.method.coefficients.tableau.stages]
    }

    /// The carrier at its stages, the first of which is the start and the last the end.
    pub fn carriers(&self) -> &'a [CarrierPoint] {
        &self.values.carrier[..self.method.coefficients.tableau.stages]
    }

    /// The state at its end.
    pub fn end(&self) -> &'a State {
        &self.values.solver.state
    }

    /// The forces at its end.
    pub fn end_forces(&self) -> &'a Forces {
        &self.values.solver.forces
    }

    /// The weights of its stages.
    pub fn interpolation(&self) -> &'static Interpolation {
        &self.method.coefficients.interpolation
    }

    /// The motions of single masses in a step of time-stepping.
    pub fn parabolas(&self) -> Parabolas<'a> {
        let rates = &self.values.rates;
        Parabolas::new(self.model, self.carrier, self.span, self.start, &rates[1], self.end(), &rates[2])
    }

    /// Writes the state at the fraction `theta` of the step.
    pub fn state_at(&self, theta: f64, workspace: &mut DenseWorkspace, state: &mut State) {
        self.set_weights(workspace, theta);
        state.surface.copy_from_slice(&self.start.surface[self.masses.clone()]);
        match self.interpolation().velocities() {
            Velocities::Polynomial => self.write_polynomials(theta, workspace, state),
            Velocities::BrokenLine => self.write_parabolas(theta, workspace, state),
        }
        self.method.heat.within(theta, &self.start.flash, self.stages(), &mut state.flash);
        let at = (self.start, self.span.length, theta);
        memory::within(self.model, at, self.stages(), &workspace.integral, &mut state.memory);
        let mut elements = &mut state.maxwell[..];
        for row in &self.model.rows {
            let (of_row, further) = elements.split_at_mut(row.kind.count(self.masses.len()));
            elements = further;
            let weights = workspace.element_weights(row);
            let first = row.range.start + self.masses.start;
            let ends = weights.ends.into_iter().zip([self.start, self.end()]).filter(|(weight, _)| *weight != 0.0);
            let terms = ends.map(|(weight, state)| (weight, &state.maxwell[first..]));
            let rates = by_rate(row.kind, &weights.rates, self.stages());
            weighted_sum(of_row, terms.chain(rates.map(|(weight, rates)| (weight, &rates[self.masses.start..]))));
        }
    }

    /// What follows from the state and the forces at the fraction `theta` where links are in spatial measure; `None`
    /// elsewhere.
    pub(super) fn of_measured_layer<T>(
        &self,
        theta: f64,
        workspace: &mut DenseWorkspace,
        of: impl FnOnce(&State, &Forces) -> T,
    ) -> Option<T> {
        let mut layer = workspace.layer.take()?;
        let (state, forces) = &mut *layer;
        self.state_at(theta, workspace, state);
        forces.evaluate(self.model, state, &self.carrier.at(self.span.at(theta)));
        let found = of(state, forces);
        workspace.layer = Some(layer);
        Some(found)
    }

    /// Writes the masses as the polynomials through the values at the stages have them.
    fn write_polynomials(&self, theta: f64, workspace: &DenseWorkspace, state: &mut State) {
        let (start, masses) = (self.start, self.masses.clone());
        state.mode.copy_from_slice(&start.mode[masses.clone()]);
        let carrier = self.carrier_at(theta, workspace);
        let DenseWorkspace { values, integral, .. } = workspace;
        self.combine(&mut state.velocity_x, values, None, |stage| &stage.velocity_x, carrier.missing_rate.x);
        self.combine(&mut state.velocity_z, values, None, |stage| &stage.velocity_z, carrier.missing_rate.z);
        let (from_x, from_z) = (Some(&start.elongation_x[..]), Some(&start.elongation_z[..]));
        self.combine(&mut state.elongation_x, integral, from_x, |stage| &stage.velocity_x, -carrier.integrated.x);
        self.combine(&mut state.elongation_z, integral, from_z, |stage| &stage.velocity_z, -carrier.integrated.z);
        for i in 0..masses.len() {
            if state.mode[i].in_contact() {
                let along_x = (state.elongation_x[i], state.velocity_x[i]);
                self.in_contact(masses.start + i, along_x, &carrier).write(state, i);
            }
        }
    }

    /// Writes the masses, all of the layer, on parabolas, with velocities on broken lines.
    fn write_parabolas(&self, theta: f64, workspace: &DenseWorkspace, state: &mut State) {
        let TimeSpan { start: s, length: h } = self.span;
        let (from, first, to) = (self.start, &self.stages()[1], self.end());
        let (moved, in_step) = (self.carrier.moved(s, theta * h), self.carrier.moved(s, h));
        // One that stops or breaks loose on the way moves.
        for (mode, (start, end)) in state.mode.iter_mut().zip(from.mode.iter().zip(&to.mode)) {
            *mode = if start.slips() { *start } else { *end };
        }
        let elongations = |out: &mut [f64], start: &[f64], velocity: &[f64], end: &[f64], moved: f64, in_step: f64| {
            for (out, ((start, end), velocity)) in out.iter_mut().zip(start.iter().zip(end).zip(velocity)) {
                *out = start + (parabola(theta, GAMMA * h * velocity, in_step + (end - start)) - moved);
            }
        };
        let (e_x, e_z) = (&mut state.elongation_x, &mut state.elongation_z);
        elongations(e_x, &from.elongation_x, &first.velocity_x, &to.elongation_x, moved.x, in_step.x);
        elongations(e_z, &from.elongation_z, &first.velocity_z, &to.elongation_z, moved.z, in_step.z);
        let velocities = |out: &mut [f64], values: [&[f64]; 3]| {
            weighted_sum(out, workspace.values.into_iter().zip(values).filter(|(weight, _)| *weight != 0.0));
        };
        velocities(&mut state.velocity_x, [&from.velocity_x, &first.velocity_x, &to.velocity_x]);
        velocities(&mut state.velocity_z, [&from.velocity_z, &first.velocity_z, &to.velocity_z]);
        let here = self.carrier.at(self.span.at(theta));
        for i in 0..self.model.masses() {
            let mode = state.mode[i];
            if mode.in_contact() {
                let v_x = if mode.slips() { state.velocity_x[i] } else { 0.0 };
                self.on_profile(i, mode, (state.elongation_x[i], v_x), &here).write(state, i);
            }
        }
    }

    /// `from` plus the weighted values of the stages plus `shift`, of the masses that are meant.
    fn combine(
        &self,
        out: &mut [f64],
        weights: &StageWeights,
        from: Option<&[f64]>,
        value: fn(&StageValues) -> &[f64],
        shift: f64,
    ) {
        let stages = weights.iter().zip(self.stages()).map(|(&weight, stage)| (weight, value(stage)));
        let terms = from.map(|from| (1.0, from)).into_iter().chain(stages);
        weighted_sum(out, terms.map(|(weight, values)| (weight, &values[self.masses.start..])));
        if shift != 0.0 {
            out.iter_mut().for_each(|value| *value += shift);
        }
    }

    /// The defect of the dense output in the equations of motion at the fraction `theta`, in the tolerance's norm: the
    /// difference between the accelerations of the interpolant and those that the `forces` in its `state` give, as the
    /// correction of the velocities, and with them of the positions, that Newton's first iteration of a stage as long
    /// as the step so far would make. The workspace is that with which [`state_at`](Self::state_at) wrote the state.
    pub fn defect(
        &self,
        theta: f64,
        state: &State,
        forces: &Forces,
        workspace: &mut DenseWorkspace,
        tolerance: &Tolerance,
    ) -> f64 {
        let (carrier, h) = (self.carrier.at(self.span.at(theta)), self.span.length);
        self.set_accelerations(workspace, theta, &carrier);
        // What Newton's first correction would make of a difference of accelerations, over the tolerances.
        let inertial = inertial_fraction(self.model, theta * h);
        let missed = |of_forces: f64, of_interpolant: f64, velocity: f64, inertial: f64| {
            let gained = inertial * theta * h * (of_forces - of_interpolant);
            let moved = theta * h * gained;
            (gained * gained / tolerance.velocity_tolerance_sq(velocity))
                .max(moved * moved / tolerance.position_tolerance_sq(0.0))
        };
        // The largest of all masses; a sticking one has no equation.
        let mut largest = 0.0_f64;
        for i in 0..self.masses.len() {
            let (a_x, a_z) = (workspace.of_masses[0][i], workspace.of_masses[1][i]);
            let (v_x, v_z) = (state.velocity_x[i] - carrier.x.speed, state.velocity_z[i] - carrier.z.speed);
            let here = match state.mode[i] {
                Mode::Stick => 0.0,
                Mode::Free => {
                    let ByAxis { x: f_x, z: f_z } = forces.on_mass(i).map(|force| force / self.model.mass);
                    missed(f_x, a_x, v_x, inertial.x).max(missed(f_z, a_z, v_z, inertial.z))
                }
                mode => {
                    let (v, surface) = (state.velocity_x[i], &state.surface[i]);
                    let contact = forces.contact(self.model, state, i);
                    let of_forces = contact.acceleration(self.model, mode, v, surface, &state.history(i));
                    missed(of_forces, a_x, v_x, inertial.x)
                }
            };
            largest = largest.max(here);
        }
        largest.sqrt()
    }

    /// Sets the weights at the fraction `theta` of the step.
    fn set_weights(&self, workspace: &mut DenseWorkspace, theta: f64) {
        workspace.set(self.model, self.method, self.span.length, theta);
    }

    /// Computes the accelerations of the interpolant along x and z (m/s²) at the fraction `theta` of the step, with the
    /// carrier there.
    fn set_accelerations(&self, workspace: &mut DenseWorkspace, theta: f64, carrier: &CarrierPoint) {
        let slope = self.interpolation().slope(theta).map(|weight| weight / self.span.length);
        let missing = |of_carrier: f64, rate: fn(&CarrierPoint) -> f64| {
            of_carrier - slope.iter().zip(self.carriers()).map(|(weight, at)| weight * rate(at)).sum::<f64>()
        };
        let [x, z] = workspace.of_masses.each_mut().map(|values| &mut values[..self.masses.len()]);
        let missing_x = missing(carrier.x.acceleration, |at| at.x.speed);
        self.combine(x, &slope, None, |stage| &stage.velocity_x, missing_x);
        self.combine(z, &slope, None, |stage| &stage.velocity_z, missing(carrier.z.acceleration, |at| at.z.speed));
    }

    /// The carrier at the fraction `theta`, for which the weights of `workspace` are set.
    fn carrier_at(&self, theta: f64, workspace: &DenseWorkspace) -> CarrierMotion {
        let now = self.carrier.at(self.span.at(theta));
        let sum = |weights: &StageWeights, rate: fn(&CarrierPoint) -> f64| -> f64 {
            weights.iter().zip(self.carriers()).map(|(weight, at)| weight * rate(at)).sum()
        };
        let both = |weights| ByAxis { x: sum(weights, |at| at.x.speed), z: sum(weights, |at| at.z.speed) };
        CarrierMotion {
            moved: self.carrier.moved(self.span.start, theta * self.span.length),
            integrated: both(&workspace.integral),
            missing_rate: now.rates() - both(&workspace.values),
            now,
        }
    }

    /// Mass `i` at the fraction of the step for which the weights of `workspace` are set.
    fn mass_at(&self, i: usize, carrier: &CarrierMotion, workspace: &DenseWorkspace) -> MassPoint {
        let start = self.start;
        let sum = |weights: &StageWeights, value: fn(&StageValues) -> &[f64]| -> f64 {
            weights.iter().zip(self.stages()).map(|(weight, stage)| weight * value(stage)[i]).sum()
        };
        let along_x = |weights| sum(weights, |stage| &stage.velocity_x);
        let x = start.elongation_x[i] + along_x(&workspace.integral) - carrier.integrated.x;
        let v_x = along_x(&workspace.values) + carrier.missing_rate.x;
        if start.mode[i].in_contact() {
            return self.in_contact(i, (x, v_x), carrier);
        }
        let along_z = |weights| sum(weights, |stage| &stage.velocity_z);
        let z = start.elongation_z[i] + along_z(&workspace.integral) - carrier.integrated.z;
        let velocity = ByAxis { x: v_x, z: along_z(&workspace.values) + carrier.missing_rate.z };
        MassPoint { links: LinkState { elongation: ByAxis { x, z }, velocity }, surface: start.surface[i] }
    }

    /// The sums of the elongations and of the velocities of all masses at the fraction `theta`, from the `sums` of the
    /// step.
    pub(super) fn summed_motion(&self, theta: f64, sums: &CarrierSums, workspace: &mut DenseWorkspace) -> LinkState {
        self.set_weights(workspace, theta);
        match self.interpolation().velocities() {
            Velocities::Polynomial => self.summed_polynomials(theta, sums, workspace),
            Velocities::BrokenLine => self.summed_parabolas(theta, sums, workspace),
        }
    }

    fn summed_parabolas(&self, theta: f64, sums: &CarrierSums, workspace: &DenseWorkspace) -> LinkState {
        let (n, TimeSpan { start: s, length: h }) = (sums.summed, self.span);
        let (moved, in_step) = (self.carrier.moved(s, theta * h), self.carrier.moved(s, h));
        let elongation = |axis: &AxisSums, moved: f64, in_step: f64| {
            let ([start, end], middle) = (axis.elongation, GAMMA * h * axis.velocity[1]);
            start + (parabola(theta, middle, n * in_step + (end - start)) - n * moved)
        };
        let weights = &workspace.values[..self.stages().len()];
        LinkState {
            elongation: ByAxis {
                x: elongation(&sums.x, moved.x, in_step.x),
                z: elongation(&sums.z, moved.z, in_step.z),
            },
            velocity: ByAxis { x: dot(weights, &sums.x.velocity), z: dot(weights, &sums.z.velocity) },
        }
    }

    fn summed_polynomials(&self, theta: f64, sums: &CarrierSums, workspace: &mut DenseWorkspace) -> LinkState {
        let carrier = self.carrier_at(theta, workspace);
        // Elongations are integrated as differences from the carrier's motion at the stages. But sticks along x and
        // contacts along z are where the surface has them, and the carrier moves away from there on its own path.
        let elongation = |axis: &AxisSums, moving: f64, (integrated, moved): (f64, f64)| {
            let of_masses = axis.elongation[0] + dot(&workspace.integral, &axis.velocity);
            of_masses - moving * integrated - (sums.summed - moving) * moved
        };
        let velocity =
            |axis: &AxisSums, moving: f64, missing: f64| dot(&workspace.values, &axis.velocity) + moving * missing;
        let mut all = LinkState {
            elongation: ByAxis {
                x: elongation(&sums.x, sums.moving, (carrier.integrated.x, carrier.moved.x)),
                z: elongation(&sums.z, sums.free, (carrier.integrated.z, carrier.moved.z)),
            },
            velocity: ByAxis {
                x: velocity(&sums.x, sums.moving, carrier.missing_rate.x),
                z: velocity(&sums.z, sums.free, carrier.missing_rate.z),
            },
        };
        if sums.has_all() {
            return all;
        }
        let DenseWorkspace { values, integral, of_masses: [x, v_x], .. } = workspace;
        let (x, v_x, start) = (&mut x[..self.masses.len()], &mut v_x[..self.masses.len()], self.start);
        if start.mode[self.masses.clone()].iter().any(|mode| mode.slips()) {
            self.combine(x, integral, Some(&start.elongation_x), |stage| &stage.velocity_x, -carrier.integrated.x);
            self.combine(v_x, values, None, |stage| &stage.velocity_x, carrier.missing_rate.x);
        }
        with_widest_vectors(
            #[inline(always)]
            || self.add_contacts(&mut all, (x, v_x), &carrier),
        );
        all
    }

    /// Adds the masses in contact, of which those that slip have the elongations `x` (m) and velocities `v_x` (m/s).
    #[inline(always)]
    fn add_contacts(&self, all: &mut LinkState, (x, v_x): (&[f64], &[f64]), carrier: &CarrierMotion) {
        let modes = &self.start.mode[self.masses.clone()];
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
                    all.add(&self.in_contact(of_layer + i, (x[i], v_x[i]), carrier).links);
                }
            }
        }
    }

    /// Mass `i`, in contact, with the elongation and velocity `along_x` (m, m/s) if it slips; it goes with the carrier
    /// if not.
    #[inline(always)]
    fn in_contact(&self, i: usize, along_x: (f64, f64), carrier: &CarrierMotion) -> MassPoint {
        let (start, mode) = (self.start, self.start.mode[i]);
        let along_x = if mode.slips() { along_x } else { (start.elongation_x[i] - carrier.moved.x, 0.0) };
        self.on_profile(i, mode, along_x, &carrier.now)
    }

    /// Mass `i`, in contact in `mode` with the elongation and velocity `along_x` (m, m/s), under the carrier.
    #[inline(always)]
    fn on_profile(&self, i: usize, mode: Mode, (x, v_x): (f64, f64), carrier: &CarrierPoint) -> MassPoint {
        let placement = Placement::new(self.carrier, carrier);
        let surface = if mode.slips() {
            self.model.surface_at(placement.position(self.model.rest_x[i], x))
        } else {
            self.start.surface[i]
        };
        let z = surface.height - self.model.rest_z[i] - placement.w;
        let velocity = ByAxis { x: v_x, z: surface.slope * v_x };
        MassPoint { links: LinkState { elongation: ByAxis { x, z }, velocity }, surface }
    }

    /// ẋ of mass `i` at the fraction `theta`, m/s.
    pub fn velocity_x(&self, i: usize, theta: f64) -> f64 {
        let values = self.interpolation().values(theta);
        let relative = values.iter().zip(self.stages()).zip(self.carriers());
        let relative = relative.map(|((weight, stage), carrier)| weight * (stage.velocity_x[i] - carrier.x.speed));
        relative.sum::<f64>() + self.carrier.at(self.span.at(theta)).x.speed
    }

    /// The contact forces of mass `i`, in contact, at the fraction `theta`: the same as in the state there, for this
    /// mass alone.
    pub fn contact(&self, i: usize, theta: f64, workspace: &mut DenseWorkspace) -> ContactForces {
        let measured = |state: &State, forces: &Forces| forces.contact(self.model, state, i);
        if let Some(contact) = self.of_measured_layer(theta, workspace, measured) {
            return contact;
        }
        self.set_weights(workspace, theta);
        let carrier = self.carrier_at(theta, workspace);
        let here = self.mass_at(i, &carrier, workspace);
        let to_carrier = LinkState { velocity: here.links.velocity - carrier.now.rates(), ..here.links };
        let mut force = ByAxis {
            x: -self.link_force(LinkKind::Horizontal, i, &to_carrier, workspace),
            z: -self.link_force(LinkKind::Vertical, i, &to_carrier, workspace),
        };
        for (j, link, sign) in [(i.wrapping_sub(1), i.wrapping_sub(1), -1.0), (i + 1, i, 1.0)] {
            if j >= self.model.masses() {
                continue;
            }
            let between = LinkState::between(&here.links, &self.mass_at(j, &carrier, workspace).links, sign);
            force.x += sign * self.link_force(LinkKind::LateralX, link, &between, workspace);
            force.z += sign * self.link_force(LinkKind::LateralZ, link, &between, workspace);
        }
        let force = force + carrier.now.on_end(i, self.model.masses());
        let history = self.slip_history(i, theta, workspace);
        ContactForces::new(self.model, force, here.links.velocity.x, &here.surface, &history)
    }

    /// What the past has left of mass `i` at the fraction `theta`, for which the weights of `workspace` are set, as far as
    /// what sticks depends on it.
    fn slip_history(&self, i: usize, theta: f64, workspace: &DenseWorkspace) -> SlipHistory {
        let at = (self.start, self.span.length, theta);
        match memory::of_mass_within(self.model, at, self.stages(), &workspace.integral, i) {
            None => SlipHistory::default(),
            Some(speed) => SlipHistory {
                flash: Flash::held(self.method.heat.of_mass_within(theta, &self.start.flash, self.stages(), i)),
                memory: Some(SpeedMemory::held(speed)),
            },
        }
    }

    /// The forces along x and z of the lateral links between mass `i` and the next at the fraction `theta`, N.
    pub fn lateral_forces(&self, i: usize, theta: f64, workspace: &mut DenseWorkspace) -> [f64; 2] {
        self.set_weights(workspace, theta);
        let carrier = self.carrier_at(theta, workspace);
        let (here, there) = (self.mass_at(i, &carrier, workspace), self.mass_at(i + 1, &carrier, workspace));
        let between = LinkState::between(&here.links, &there.links, 1.0);
        [LinkKind::LateralX, LinkKind::LateralZ]
            .map(|kind| if self.model.has_link[kind] { self.link_force(kind, i, &between, workspace) } else { 0.0 })
    }

    /// Elongations of the links of mass `i` to the carrier (m) and its velocities (m/s), along x and z, at the fraction
    /// `theta`.
    pub fn motion(&self, i: usize, theta: f64, workspace: &mut DenseWorkspace) -> [ByAxis<f64>; 2] {
        self.set_weights(workspace, theta);
        let carrier = self.carrier_at(theta, workspace);
        let LinkState { elongation, velocity } = self.mass_at(i, &carrier, workspace).links;
        [elongation, velocity]
    }

    /// The force of one link at the fraction for which the weights of `workspace` are set, N.
    fn link_force(&self, kind: LinkKind, link: usize, links: &LinkState, workspace: &DenseWorkspace) -> f64 {
        let (e, rate) = (links.elongation[kind.axis()], links.velocity[kind.axis()]);
        let mut force = self.model.links[kind].force(e, rate);
        force -= self.model.frozen_force(kind, link);
        let mut rows = self.model.rows_of(kind).peekable();
        if rows.peek().is_none() {
            return force;
        }
        for row in rows {
            let (start, end) = (self.start.maxwell[row.range.start + link], self.end().maxwell[row.range.start + link]);
            let [of_start, of_end] = workspace.element_weights(row).ends;
            force += row.stiffness * (of_start * start + of_end * end);
        }
        let rates = self.stages().iter().map(|stage| stage.elongation_rate[kind][link]);
        force + workspace.of_rate[kind].iter().zip(rates).map(|(weight, rate)| weight * rate).sum::<f64>()
    }
}

/// The carrier at one instant within a step.
struct CarrierMotion {
    now: CarrierPoint,
    /// Its displacement along x and z since the start of the step, m.
    moved: ByAxis<f64>,
    /// Its displacement along x and z as the stages' rates give it, m.
    integrated: ByAxis<f64>,
    /// What the stages' rates miss of u̇ and ẇ, m/s.
    missing_rate: ByAxis<f64>,
}

/// A mass at one instant within a step, with its links to the carrier.
struct MassPoint {
    links: LinkState,
    surface: SurfacePoint,
}

impl MassPoint {
    fn write(self, state: &mut State, i: usize) {
        let LinkState { elongation, velocity } = self.links;
        (state.elongation_x[i], state.elongation_z[i]) = (elongation.x, elongation.z);
        (state.velocity_x[i], state.velocity_z[i]) = (velocity.x, velocity.z);
        state.surface[i] = self.surface;
    }
}

/// How much of a force on a mass becomes velocity in a time β, along x and z: (m/β)/(m/β + βc + d + Σ_j c_j βτ_j/(τ_j +
/// β)) of the links to the carrier and to neighbours at rest. The rest goes into them: motion that is faster settles.
fn inertial_fraction(model: &Model, beta: f64) -> ByAxis<f64> {
    let weight = |kind: LinkKind| {
        let relaxing = |row: &MaxwellRow| row.stiffness * beta * row.relaxation_time / (row.relaxation_time + beta);
        model.links[kind].by_velocity(beta) + model.rows_of(kind).map(relaxing).sum::<f64>()
    };
    let inertia = model.mass / beta;
    ByAxis::from_fn(|axis| inertia / (inertia + weight(axis.link()) + 2.0 * weight(axis.lateral())))
}
