//! What lies within a step: dense output.
//!
//! Places are the quintics through place, velocity and acceleration at both ends (order 5), velocities their
//! derivatives. The Maxwell elements follow these velocities by the exact solution of ȧ = ė - a/τ, which holds for
//! every τ; what it misses of the step's own end is laid on linearly.

use super::{Rates, Tolerance};
use crate::math::{Jet, Quintic, Relaxation, weighted_sum};
use crate::model::{Carrier, CarrierPoint, ContactForces, Forces, LinkKind, Mode, Model, State, SurfacePoint};

/// One step, seen from within.
#[derive(Clone, Copy, Debug)]
pub struct DenseOutput<'a> {
    /// The model.
    pub model: &'a Model,
    /// The carrier's motion.
    pub carrier: &'a Carrier,
    /// Start of the step, s after the start of the carrier's piece.
    pub s: f64,
    /// Length of the step, s.
    pub h: f64,
    /// The carrier at the start and at the end.
    pub carriers: [CarrierPoint; 2],
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

impl DenseOutput<'_> {
    /// The place of mass `i` on the profile through the step, m.
    pub fn place(&self, i: usize) -> Quintic {
        let at = |(state, rates): (&State, &Rates), carrier: &CarrierPoint| Jet {
            position: self.model.rest_x[i] + (self.carrier.profile_position + (carrier.du + state.elongation_x[i])),
            speed: rates.velocity_x[i],
            acceleration: rates.acceleration_x[i],
        };
        Quintic::hermite(at(self.start, &self.carriers[0]), at(self.end, &self.carriers[1]), self.h)
    }

    /// The height of mass `i` above the profile's datum through the step, m.
    pub fn height(&self, i: usize) -> Quintic {
        let at = |(state, rates): (&State, &Rates), carrier: &CarrierPoint| Jet {
            position: self.model.rest_z[i] + (self.carrier.w + (carrier.dw + state.elongation_z[i])),
            speed: rates.velocity_z[i],
            acceleration: rates.acceleration_z[i],
        };
        Quintic::hermite(at(self.start, &self.carriers[0]), at(self.end, &self.carriers[1]), self.h)
    }

    /// Writes the state at the fraction `theta` of the step.
    pub fn state_at(&self, theta: f64, workspace: &mut DenseWorkspace, state: &mut State) {
        let carrier = self.carrier.at(self.s + theta * self.h);
        state.mode.copy_from_slice(&self.start.0.mode);
        for i in 0..self.model.masses() {
            let motion = [self.elongation(Axis::X, i), self.elongation(Axis::Z, i)];
            workspace.follow(i, &motion);
            let mass = self.mass_at(theta, i, &motion, &carrier);
            (state.elongation_x[i], state.elongation_z[i]) = mass.elongation;
            (state.velocity_x[i], state.velocity_z[i]) = mass.velocity;
            state.surface[i] = mass.surface;
            (workspace.bend[0][i], workspace.bend[1][i]) = mass.bend;
        }
        workspace.follow_neighbours();
        workspace.relax(self, theta);
        for row in &self.model.rows {
            let weights = &workspace.relaxation[row.time_index];
            let (start, end) = (&self.start.0.maxwell[row.range.clone()], &self.end.0.maxwell[row.range.clone()]);
            let driven =
                workspace.rate[row.kind as usize].iter().zip(weights.driven).map(|(rate, weight)| (weight, &rate[..]));
            let ends = [(weights.decay, start), (theta, end)];
            weighted_sum(&mut state.maxwell[row.range.clone()], ends.into_iter().chain(driven));
        }
    }

    /// What the dense output misses of the equations of motion at the fraction `theta`, whose state stands in `state`
    /// and `workspace`: how far the accelerations that the forces there give are from its own, as a velocity gained over the
    /// step, in the tolerance's norm.
    pub fn defect(
        &self,
        theta: f64,
        (state, forces): (&State, &Forces),
        workspace: &DenseWorkspace,
        tolerance: &Tolerance,
    ) -> f64 {
        let carrier = self.carrier.at(self.s + theta * self.h);
        let per_square = 1.0 / (self.h * self.h);
        let missed = |bend: f64, of_carrier: f64, of_forces: f64, velocity: f64| {
            let gained = theta * self.h * (of_forces - (bend * per_square + of_carrier));
            gained * gained / tolerance.of_velocity(velocity)
        };
        let mut largest = 0.0_f64;
        for i in 0..self.model.masses() {
            let (v_x, v_z) = (state.velocity_x[i] - carrier.u_rate, state.velocity_z[i] - carrier.w_rate);
            let along_x = |acceleration: f64| missed(workspace.bend[0][i], carrier.u_acceleration, acceleration, v_x);
            let along_z = |acceleration: f64| missed(workspace.bend[1][i], carrier.w_acceleration, acceleration, v_z);
            let here = match state.mode[i] {
                Mode::Stick => 0.0,
                Mode::Free => {
                    let m = self.model.mass;
                    along_x(forces.on_mass_x[i] / m).max(along_z(forces.on_mass_z[i] / m))
                }
                mode => {
                    let (v, surface) = (state.velocity_x[i], &state.surface[i]);
                    let contact = forces.contact(self.model, i, v, surface);
                    along_x(contact.acceleration(self.model, mode, v, surface))
                }
            };
            largest = largest.max(here);
        }
        largest.sqrt()
    }

    /// Mass `i` at the fraction `theta`, where the carrier is at `carrier`.
    fn mass_at(&self, theta: f64, i: usize, motion: &[Quintic; 2], carrier: &CarrierPoint) -> MassPoint {
        let x = motion[0].evaluate(theta);
        let mut surface = self.start.0.surface[i];
        let v_x = match self.start.0.mode[i] {
            Mode::Stick => 0.0,
            _ => x.speed / self.h + carrier.u_rate,
        };
        if self.start.0.mode[i] == Mode::Free {
            let z = motion[1].evaluate(theta);
            return MassPoint {
                elongation: (x.position, z.position),
                velocity: (v_x, z.speed / self.h + carrier.w_rate),
                bend: (x.acceleration, z.acceleration),
                surface,
            };
        }
        let place = if self.start.0.mode[i].slips() {
            surface = self
                .model
                .surface_at(self.model.rest_x[i] + (self.carrier.profile_position + (carrier.du + x.position)));
            x.position
        } else {
            // What the polynomial misses of the carrier's swing would move a mass that stands still.
            self.start.0.elongation_x[i] - self.carrier.moved(self.s, theta * self.h).0
        };
        let z = surface.height - self.model.rest_z[i] - (self.carrier.w + carrier.dw);
        MassPoint { elongation: (place, z), velocity: (v_x, surface.slope * v_x), bend: (x.acceleration, 0.0), surface }
    }

    /// ẋ of mass `i` at the fraction `theta`, m/s.
    pub fn velocity_x(&self, i: usize, theta: f64) -> f64 {
        self.elongation(Axis::X, i).evaluate(theta).speed / self.h + self.carrier.at(self.s + theta * self.h).u_rate
    }

    /// What the surface and the links do to mass `i`, in contact, at the fraction `theta`: the same as in the state
    /// there, for this mass alone.
    pub fn contact(&self, i: usize, theta: f64, workspace: &mut DenseWorkspace) -> ContactForces {
        workspace.relax(self, theta);
        let carrier = self.carrier.at(self.s + theta * self.h);
        let motion = |j: usize| [self.elongation(Axis::X, j), self.elongation(Axis::Z, j)];
        let here_motion = motion(i);
        let here = self.mass_at(theta, i, &here_motion, &carrier);
        let relative = |velocity: (f64, f64)| (velocity.0 - carrier.u_rate, velocity.1 - carrier.w_rate);
        let to_carrier = LinkPoint { elongation: here.elongation, rate: relative(here.velocity), motion: here_motion };
        let mut force_x = -self.link_force(LinkKind::Horizontal, i, theta, &to_carrier, workspace);
        let mut force_z = -self.link_force(LinkKind::Vertical, i, theta, &to_carrier, workspace);
        for (j, link, sign) in [(i.wrapping_sub(1), i.wrapping_sub(1), -1.0), (i + 1, i, 1.0)] {
            if j >= self.model.masses() {
                continue;
            }
            let there_motion = motion(j);
            let there = self.mass_at(theta, j, &there_motion, &carrier);
            let between = LinkPoint::between((&here, &here_motion), (&there, &there_motion), sign);
            force_x += sign * self.link_force(LinkKind::LateralX, link, theta, &between, workspace);
            force_z += sign * self.link_force(LinkKind::LateralZ, link, theta, &between, workspace);
        }
        ContactForces::new(self.model, (force_x, force_z), here.velocity.0, &here.surface)
    }

    /// The force of one link at the fraction `theta`, N.
    fn link_force(
        &self,
        kind: LinkKind,
        link: usize,
        theta: f64,
        point: &LinkPoint,
        workspace: &DenseWorkspace,
    ) -> f64 {
        let law = &self.model.links[kind as usize];
        let along_x = kind.is_along_x();
        let of = |(x, z): (f64, f64)| if along_x { x } else { z };
        let mut force = law.stiffness * of(point.elongation) + law.damping * of(point.rate);
        if law.frozen > 0.0 {
            force -= law.frozen * self.model.frozen_dashpot(kind, link);
        }
        let mut rows = self.model.rows_of(kind).peekable();
        if rows.peek().is_none() {
            return force;
        }
        let rate = point.motion[usize::from(!along_x)].derivative_monomials();
        for row in rows {
            let weights = &workspace.relaxation[row.time_index];
            let (start, end) =
                (self.start.0.maxwell[row.range.start + link], self.end.0.maxwell[row.range.start + link]);
            let driven: f64 = weights.driven.iter().zip(rate).map(|(weight, rate)| weight * rate).sum();
            force += row.stiffness * (weights.decay * start + theta * end + driven);
        }
        force
    }

    /// The elongation of a link of mass `i` to the carrier through the step, m.
    fn elongation(&self, axis: Axis, i: usize) -> Quintic {
        let at = |(state, rates): (&State, &Rates), carrier: &CarrierPoint| match axis {
            Axis::X => Jet {
                position: state.elongation_x[i],
                speed: rates.velocity_x[i] - carrier.u_rate,
                acceleration: rates.acceleration_x[i] - carrier.u_acceleration,
            },
            Axis::Z => Jet {
                position: state.elongation_z[i],
                speed: rates.velocity_z[i] - carrier.w_rate,
                acceleration: rates.acceleration_z[i] - carrier.w_acceleration,
            },
        };
        Quintic::hermite(at(self.start, &self.carriers[0]), at(self.end, &self.carriers[1]), self.h)
    }
}

/// A mass at one instant within a step; along x and z.
struct MassPoint {
    elongation: (f64, f64),
    velocity: (f64, f64),
    /// The second derivative of the elongation with respect to the fraction, m; along z of a free mass alone.
    bend: (f64, f64),
    surface: SurfacePoint,
}

/// The links at one place of the layer at one instant within a step, and their motion through it; along x and z.
struct LinkPoint {
    elongation: (f64, f64),
    rate: (f64, f64),
    motion: [Quintic; 2],
}

impl LinkPoint {
    /// The links from a mass to its neighbour at the right (`sign` 1) or at the left (-1).
    fn between(here: (&MassPoint, &[Quintic; 2]), there: (&MassPoint, &[Quintic; 2]), sign: f64) -> Self {
        let difference = |there: (f64, f64), here: (f64, f64)| (sign * (there.0 - here.0), sign * (there.1 - here.1));
        Self {
            elongation: difference(there.0.elongation, here.0.elongation),
            rate: difference(there.0.velocity, here.0.velocity),
            motion: std::array::from_fn(|axis| there.1[axis].less(&here.1[axis], sign)),
        }
    }
}

/// Room for the links' elongation rates through a step.
#[derive(Clone, Debug)]
pub struct DenseWorkspace {
    /// By kind of link: the coefficients of 1, θ, … θ⁴ of h ė; empty where the links have no Maxwell elements.
    rate: [[Vec<f64>; 5]; 4],
    /// Along x and z: the second derivative of each mass's elongation with respect to the fraction, m.
    bend: [Vec<f64>; 2],
    /// By relaxation time: what a at one fraction of the step takes from that at the start and from the rates. The
    /// elements follow the rates exactly; what they miss of the step's own end is laid on linearly.
    relaxation: Vec<Relaxation>,
    /// The fraction, and the length of the step.
    relaxed: (f64, f64),
}

impl DenseWorkspace {
    /// Room for steps of `model`.
    pub fn new(model: &Model) -> Self {
        let has = |kind: LinkKind| model.rows.iter().any(|row| row.kind == kind);
        let rate = LinkKind::ALL.map(|kind| {
            // The links between masses are summed from those to the carrier.
            let needed = has(kind)
                || (!kind.is_lateral()
                    && LinkKind::ALL.into_iter().any(|lateral| {
                        lateral.is_lateral() && lateral.is_along_x() == kind.is_along_x() && has(lateral)
                    }));
            std::array::from_fn(|_| vec![0.0; if needed { kind.count(model.masses()) } else { 0 }])
        });
        let relaxation = vec![Relaxation::default(); model.relaxation_times.len()];
        let bend = [vec![0.0; model.masses()], vec![0.0; model.masses()]];
        Self { rate, bend, relaxation, relaxed: (f64::NAN, f64::NAN) }
    }

    /// Bytes that this holds.
    pub fn bytes(&self) -> usize {
        self.rate.iter().flatten().chain(&self.bend).map(|array| array.len() * size_of::<f64>()).sum()
    }

    /// Finds how the elements relax up to the fraction `theta` of `step`, if that is not known yet.
    fn relax(&mut self, step: &DenseOutput<'_>, theta: f64) {
        if self.relaxed == (theta, step.h) {
            return;
        }
        self.relaxed = (theta, step.h);
        for (relaxation, tau) in self.relaxation.iter_mut().zip(&step.model.relaxation_times) {
            let ratio = step.h / tau;
            let (here, whole) = (Relaxation::new(ratio, theta), Relaxation::new(ratio, 1.0));
            *relaxation = Relaxation {
                decay: here.decay - theta * whole.decay,
                driven: std::array::from_fn(|m| here.driven[m] - theta * whole.driven[m]),
            };
        }
    }

    /// Notes the elongations of the links of mass `i` to the carrier, along x and z.
    fn follow(&mut self, i: usize, elongations: &[Quintic; 2]) {
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
