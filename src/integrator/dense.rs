//! Dense output of both methods: the motion and the state within a step (docs/theory.md, section 5).
//!
//! [`DenseOutput`] belongs to the method of seven stages. Positions are the quintic polynomials through position,
//! velocity and acceleration at both ends (order 5), velocities their derivatives. The Maxwell elements follow these
//! velocities by the exact solution of ȧ = ė - a/τ, for any τ; its difference from the step's own end is distributed
//! linearly over the step.
//!
//! [`TwoStageDense`] belongs to the method of two stages. Positions are the parabolas through the start and the end with
//! the velocity of the first stage there. Velocities and Maxwell elements, which may have followed a jump in no time, are
//! linear from the start to the first stage and from there to the end, so they do not oscillate. Both are of the
//! method's own order.

use super::error::Tolerance;
use super::rates::Rates;
use super::tableau::{GAMMA, sdirk2_weights};
use crate::math::{Jet, Quintic, Relaxation, weighted_sum};
use crate::model::{Carrier, CarrierPoint, ContactForces, Forces, LinkKind, Mode, Model, State, SurfacePoint};

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

/// State, rates and carrier at the start or at the end of a step.
#[derive(Clone, Copy, Debug)]
pub struct StepBoundary<'a> {
    /// The state.
    pub state: &'a State,
    /// The rates.
    pub rates: &'a Rates,
    /// The carrier.
    pub carrier: CarrierPoint,
}

/// The interpolant of one step of the method of seven stages.
#[derive(Clone, Copy, Debug)]
pub struct DenseOutput<'a> {
    /// The model.
    pub model: &'a Model,
    /// The carrier's motion.
    pub carrier: &'a Carrier,
    /// The step.
    pub span: StepSpan,
    /// Its start.
    pub start: StepBoundary<'a>,
    /// Its end.
    pub end: StepBoundary<'a>,
}

#[derive(Clone, Copy, PartialEq)]
enum Direction {
    X,
    Z,
}

impl DenseOutput<'_> {
    /// The position of mass `i` on the profile through the step, m.
    pub fn position(&self, i: usize) -> Quintic {
        let at = |StepBoundary { state, rates, carrier }: &StepBoundary<'_>| Jet {
            position: self.model.rest_x[i] + (self.carrier.profile_position + (carrier.du + state.elongation_x[i])),
            speed: rates.velocity_x[i],
            acceleration: rates.acceleration_x[i],
        };
        Quintic::hermite(at(&self.start), at(&self.end), self.span.length)
    }

    /// The height of mass `i` above the profile's datum through the step, m.
    pub fn height(&self, i: usize) -> Quintic {
        let at = |StepBoundary { state, rates, carrier }: &StepBoundary<'_>| Jet {
            position: self.model.rest_z[i] + (self.carrier.w + (carrier.dw + state.elongation_z[i])),
            speed: rates.velocity_z[i],
            acceleration: rates.acceleration_z[i],
        };
        Quintic::hermite(at(&self.start), at(&self.end), self.span.length)
    }

    /// Writes the state at the fraction `theta` of the step.
    pub fn state_at(&self, theta: f64, workspace: &mut DenseWorkspace, state: &mut State) {
        let carrier = self.carrier.at(self.span.at(theta));
        state.mode.copy_from_slice(&self.start.state.mode);
        for i in 0..self.model.masses() {
            let mass = self.mass_at(theta, i, &carrier);
            workspace.set_mass(i, &mass);
            (state.elongation_x[i], state.elongation_z[i]) = mass.elongation;
            (state.velocity_x[i], state.velocity_z[i]) = mass.velocity;
            state.surface[i] = mass.surface;
        }
        workspace.set_lateral_rates();
        workspace.relax(self, theta);
        for row in &self.model.rows {
            let weights = &workspace.relaxation[row.time_index];
            let (start, end) =
                (&self.start.state.maxwell[row.range.clone()], &self.end.state.maxwell[row.range.clone()]);
            let driven =
                workspace.rate[row.kind as usize].iter().zip(weights.driven).map(|(rate, weight)| (weight, &rate[..]));
            let ends = [(weights.decay, start), (theta, end)];
            weighted_sum(&mut state.maxwell[row.range.clone()], ends.into_iter().chain(driven));
        }
    }

    /// The defect of the dense output in the equations of motion at the fraction `theta`: the difference between the
    /// accelerations of the interpolant and those that the `forces` in its state give, as the velocity gained over the
    /// step, in the tolerance's norm. The state and the workspace are those that [`state_at`](Self::state_at) wrote.
    pub fn defect(
        &self,
        theta: f64,
        state: &State,
        forces: &Forces,
        workspace: &DenseWorkspace,
        tolerance: &Tolerance,
    ) -> f64 {
        let (carrier, h) = (self.carrier.at(self.span.at(theta)), self.span.length);
        let per_square = 1.0 / (h * h);
        let missed = |bend: f64, of_carrier: f64, of_forces: f64, velocity: f64| {
            let gained = theta * h * (of_forces - (bend * per_square + of_carrier));
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
    fn mass_at(&self, theta: f64, i: usize, carrier: &CarrierPoint) -> MassPoint {
        let motion = [self.elongation(Direction::X, i), self.elongation(Direction::Z, i)];
        let (start, h) = (self.start.state, self.span.length);
        let x = motion[0].evaluate(theta);
        let mut surface = start.surface[i];
        let v_x = match start.mode[i] {
            Mode::Stick => 0.0,
            _ => x.speed / h + carrier.u_rate,
        };
        if start.mode[i] == Mode::Free {
            let z = motion[1].evaluate(theta);
            return MassPoint {
                elongation: (x.position, z.position),
                velocity: (v_x, z.speed / h + carrier.w_rate),
                bend: (x.acceleration, z.acceleration),
                surface,
                motion,
            };
        }
        let elongation_x = if start.mode[i].slips() {
            surface = self
                .model
                .surface_at(self.model.rest_x[i] + (self.carrier.profile_position + (carrier.du + x.position)));
            x.position
        } else {
            // The error of the polynomial for the carrier's displacement would move a mass that sticks.
            start.elongation_x[i] - self.carrier.moved(self.span.start, theta * h).0
        };
        let elongation_z = surface.height - self.model.rest_z[i] - (self.carrier.w + carrier.dw);
        MassPoint {
            elongation: (elongation_x, elongation_z),
            velocity: (v_x, surface.slope * v_x),
            bend: (x.acceleration, 0.0),
            surface,
            motion,
        }
    }

    /// ẋ of mass `i` at the fraction `theta`, m/s.
    pub fn velocity_x(&self, i: usize, theta: f64) -> f64 {
        let carrier = self.carrier.at(self.span.at(theta));
        self.elongation(Direction::X, i).evaluate(theta).speed / self.span.length + carrier.u_rate
    }

    /// The contact forces of mass `i`, in contact, at the fraction `theta`: the same as in the state there, for this mass
    /// alone.
    pub fn contact(&self, i: usize, theta: f64, workspace: &mut DenseWorkspace) -> ContactForces {
        workspace.relax(self, theta);
        let carrier = self.carrier.at(self.span.at(theta));
        let here = self.mass_at(theta, i, &carrier);
        let to_carrier = LinkPoint {
            elongation: here.elongation,
            rate: (here.velocity.0 - carrier.u_rate, here.velocity.1 - carrier.w_rate),
            motion: here.motion,
        };
        let mut force_x = -self.link_force(LinkKind::Horizontal, i, theta, &to_carrier, workspace);
        let mut force_z = -self.link_force(LinkKind::Vertical, i, theta, &to_carrier, workspace);
        for (j, link, sign) in [(i.wrapping_sub(1), i.wrapping_sub(1), -1.0), (i + 1, i, 1.0)] {
            if j >= self.model.masses() {
                continue;
            }
            let between = LinkPoint::between(&here, &self.mass_at(theta, j, &carrier), sign);
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
                (self.start.state.maxwell[row.range.start + link], self.end.state.maxwell[row.range.start + link]);
            let driven: f64 = weights.driven.iter().zip(rate).map(|(weight, rate)| weight * rate).sum();
            force += row.stiffness * (weights.decay * start + theta * end + driven);
        }
        force
    }

    /// The elongation of a link of mass `i` to the carrier through the step, m.
    fn elongation(&self, direction: Direction, i: usize) -> Quintic {
        let at = |StepBoundary { state, rates, carrier }: &StepBoundary<'_>| match direction {
            Direction::X => Jet {
                position: state.elongation_x[i],
                speed: rates.velocity_x[i] - carrier.u_rate,
                acceleration: rates.acceleration_x[i] - carrier.u_acceleration,
            },
            Direction::Z => Jet {
                position: state.elongation_z[i],
                speed: rates.velocity_z[i] - carrier.w_rate,
                acceleration: rates.acceleration_z[i] - carrier.w_acceleration,
            },
        };
        Quintic::hermite(at(&self.start), at(&self.end), self.span.length)
    }
}

/// A mass at one instant within a step; along x and z.
struct MassPoint {
    elongation: (f64, f64),
    velocity: (f64, f64),
    /// The second derivative of the elongation by the fraction of the step, m; along z of a free mass alone.
    bend: (f64, f64),
    surface: SurfacePoint,
    motion: [Quintic; 2],
}

/// The links at one mass, or between two, at one instant within a step; along x and z.
struct LinkPoint {
    elongation: (f64, f64),
    rate: (f64, f64),
    motion: [Quintic; 2],
}

impl LinkPoint {
    /// The links from a mass to its neighbour at the right (`sign` 1) or at the left (-1).
    fn between(here: &MassPoint, there: &MassPoint, sign: f64) -> Self {
        let difference = |there: (f64, f64), here: (f64, f64)| (sign * (there.0 - here.0), sign * (there.1 - here.1));
        Self {
            elongation: difference(there.elongation, here.elongation),
            rate: difference(there.velocity, here.velocity),
            motion: std::array::from_fn(|axis| there.motion[axis].less(&here.motion[axis], sign)),
        }
    }
}

/// Workspace of [`DenseOutput`] for the links' elongation rates through a step.
#[derive(Clone, Debug)]
pub struct DenseWorkspace {
    /// By kind of link: the coefficients of 1, θ, … θ⁴ of h ė; empty where the links have no Maxwell elements.
    rate: [[Vec<f64>; 5]; 4],
    /// Along x and z: the second derivative of each mass's elongation by the fraction of the step, m.
    bend: [Vec<f64>; 2],
    /// By relaxation time: the weights of a at the start and of the rates in a at the fraction of the step. They make the
    /// elements follow the rates exactly, less the linear share of the difference at the step's own end.
    relaxation: Vec<Relaxation>,
    /// The fraction and the length of the step for which `relaxation` holds.
    relaxed: (f64, f64),
}

impl DenseWorkspace {
    /// Workspace for steps of `model`.
    pub fn new(model: &Model) -> Self {
        let has = |kind: LinkKind| model.rows.iter().any(|row| row.kind == kind);
        let rate = LinkKind::ALL.map(|kind| {
            // The rates of the lateral links are differences of those of the links to the carrier.
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

    /// Computes the relaxation weights at the fraction `theta` of `step`, unless they are there already.
    fn relax(&mut self, step: &DenseOutput<'_>, theta: f64) {
        if self.relaxed == (theta, step.span.length) {
            return;
        }
        self.relaxed = (theta, step.span.length);
        for (relaxation, tau) in self.relaxation.iter_mut().zip(&step.model.relaxation_times) {
            let ratio = step.span.length / tau;
            let (here, whole) = (Relaxation::new(ratio, theta), Relaxation::new(ratio, 1.0));
            *relaxation = Relaxation {
                decay: here.decay - theta * whole.decay,
                driven: std::array::from_fn(|m| here.driven[m] - theta * whole.driven[m]),
            };
        }
    }

    /// Writes the elongation rates of the links of mass `i` to the carrier, and its second derivatives.
    fn set_mass(&mut self, i: usize, mass: &MassPoint) {
        for (kind, elongation) in [LinkKind::Horizontal, LinkKind::Vertical].into_iter().zip(&mass.motion) {
            let rate = &mut self.rate[kind as usize];
            if !rate[0].is_empty() {
                for (rate, monomial) in rate.iter_mut().zip(elongation.derivative_monomials()) {
                    rate[i] = monomial;
                }
            }
        }
        (self.bend[0][i], self.bend[1][i]) = mass.bend;
    }

    /// Computes the elongation rates of the lateral links from those of the masses.
    fn set_lateral_rates(&mut self) {
        let [vertical, horizontal, lateral_x, lateral_z] = &mut self.rate;
        for (of_masses, lateral) in [(horizontal, lateral_x), (vertical, lateral_z)] {
            for (of_masses, lateral) in of_masses.iter().zip(lateral) {
                for (i, rate) in lateral.iter_mut().enumerate() {
                    *rate = of_masses[i + 1] - of_masses[i];
                }
            }
        }
    }
}

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
    carrier_moved: (f64, f64),
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
        let carrier_start = (carrier.profile_position + at.du, carrier.w + at.dw);
        let carrier_moved = carrier.moved(span.start, span.length);
        Self { model, carrier, span, start, first, end, last, carrier_start, carrier_moved }
    }

    /// The fraction of the step at which its first stage lies.
    pub const FIRST_STAGE: f64 = GAMMA;

    /// The position of mass `i` on the profile at the fraction `theta` of the step, m.
    #[inline]
    pub fn position(&self, i: usize, theta: f64) -> f64 {
        let (start, end) = (self.start.elongation_x[i], self.end.elongation_x[i]);
        let middle = GAMMA * self.span.length * self.first.velocity_x[i];
        self.model.rest_x[i]
            + (self.carrier_start.0 + (start + parabola(theta, middle, self.carrier_moved.0 + (end - start))))
    }

    /// The height of mass `i` above the profile's datum at the fraction `theta` of the step, m.
    #[inline]
    pub fn height(&self, i: usize, theta: f64) -> f64 {
        let (start, end) = (self.start.elongation_z[i], self.end.elongation_z[i]);
        let middle = GAMMA * self.span.length * self.first.velocity_z[i];
        self.model.rest_z[i]
            + (self.carrier_start.1 + (start + parabola(theta, middle, self.carrier_moved.1 + (end - start))))
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

    /// Writes the state at the fraction `theta` of the step into `state`, which holds the Maxwell elongations of the
    /// first stage.
    pub fn state_at(&self, theta: f64, state: &mut State) {
        let StepSpan { start: s, length: h } = self.span;
        let here = self.carrier.at(self.span.at(theta));
        let (beta, (u, w), (end_u, end_w)) = (GAMMA * h, self.carrier.moved(s, theta * h), self.carrier_moved);
        let (from, to) = (self.start, self.end);
        state.mode.copy_from_slice(&from.mode);
        state.surface.copy_from_slice(&from.surface);
        for i in 0..self.model.masses() {
            let (e_x, e_z) = (from.elongation_x[i], from.elongation_z[i]);
            let x = parabola(theta, beta * self.first.velocity_x[i], end_u + (to.elongation_x[i] - e_x));
            let z = parabola(theta, beta * self.first.velocity_z[i], end_w + (to.elongation_z[i] - e_z));
            state.elongation_x[i] = e_x + (x - u);
            state.elongation_z[i] = e_z + (z - w);
            (state.velocity_x[i], state.velocity_z[i]) = self.velocity(i, theta);
            self.constrain(i, &here, state);
        }
        // So far they are those of the first stage.
        let [of_start, of_first, of_end] = piecewise_linear(theta);
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
            let x = self.model.rest_x[i] + (self.carrier.profile_position + (here.du + state.elongation_x[i]));
            state.surface[i] = self.model.surface_at(x);
        } else {
            state.velocity_x[i] = 0.0;
        }
        state.velocity_z[i] = state.surface[i].slope * state.velocity_x[i];
        state.elongation_z[i] = state.surface[i].height - self.model.rest_z[i] - (self.carrier.w + here.dw);
    }
}

/// The parabola from 0 at the start to `end` whose velocity at the first stage makes `middle` in the fraction γ: the
/// integral of the straight line through the velocities at the stages.
#[inline]
fn parabola(theta: f64, middle: f64, end: f64) -> f64 {
    let (first, last) = sdirk2_weights(theta);
    let velocity = middle / GAMMA;
    first * velocity + last * (end - (1.0 - GAMMA) * velocity) / GAMMA
}

/// Weights of the values at the start, at the first stage and at the end in their piecewise linear interpolant.
#[inline]
fn piecewise_linear(theta: f64) -> [f64; 3] {
    if theta < GAMMA {
        [1.0 - theta / GAMMA, theta / GAMMA, 0.0]
    } else {
        let share = (theta - GAMMA) / (1.0 - GAMMA);
        [0.0, 1.0 - share, share]
    }
}
