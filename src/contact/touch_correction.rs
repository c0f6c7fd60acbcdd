//! What the end-of-step correction does to a single mass (docs/theory.md, section 10): back to its touch, through its
//! impact, and along the profile for the rest of the step, with the energies of all that.

use super::laws::{collision, decide_mode};
use crate::integrator::{OpenEnd, Parabolas, StageValues, TimeSpan};
use crate::math::bracketed_root;
use crate::model::{Carrier, CarrierPoint, ChannelEnergies, LinkKind, Mode, Model, SlipCurve, State, SurfacePoint};
use crate::scene::{Axis, ByAxis};

/// Accuracy of the instant of a touch, as a fraction of the step: the error of the parabola is larger.
const INSTANT: f64 = 1e-4;

/// A step that was tried with its contacts kept: what the correction does not change.
#[derive(Clone, Copy, Debug)]
pub struct FixedModeStep<'a> {
    /// The model.
    pub model: &'a Model,
    /// The carrier's motion.
    pub carrier: &'a Carrier,
    /// Its start and length.
    pub span: TimeSpan,
    /// State at the start.
    pub start: &'a State,
    /// The values at the first stage.
    pub first: &'a StageValues,
}

/// Energies of the mode changes at the end of a step, J.
#[derive(Clone, Copy, Debug, Default)]
pub struct CorrectionEnergies {
    /// Lost in impacts.
    pub impact: f64,
    /// Through the channels from the instants of the impacts on: the difference that contact makes against free motion.
    pub channels: ChannelEnergies,
    /// Impulses on the carrier along x and z, N s, that the step as tried does not know: they change the speeds of
    /// bodies.
    pub impulse: ByAxis<f64>,
}

/// The end of a step of which single masses are corrected.
pub(super) struct TouchCorrection<'a> {
    step: FixedModeStep<'a>,
    /// The carrier at the end.
    carrier: CarrierPoint,
    end: OpenEnd<'a>,
    pub(super) energies: CorrectionEnergies,
}

/// The part of the step that remains for a mass after its impact.
#[derive(Clone, Copy)]
struct Remainder {
    /// Its duration, s.
    time: f64,
    /// Velocity of the mass at the end of the step if it had stayed free, m/s.
    free: ByAxis<f64>,
    /// Velocities of its neighbours at the end of the step before they received impulses, m/s.
    neighbours: [Option<ByAxis<f64>>; 2],
}

/// The speed v_t along the profile in the remaining part of the step, m/s.
#[derive(Clone, Copy)]
struct Speed {
    mean: f64,
    /// As the dampers have it: at the end, as the step is implicit.
    at_end: f64,
}

impl<'a> TouchCorrection<'a> {
    pub(super) fn new(step: FixedModeStep<'a>, end: OpenEnd<'a>) -> Self {
        Self {
            carrier: step.carrier.at(step.span.start + step.span.length),
            step,
            end,
            energies: CorrectionEnergies::default(),
        }
    }

    fn dense(&self) -> Parabolas<'_> {
        let FixedModeStep { model, carrier, span, start, first } = self.step;
        Parabolas::new(model, carrier, span, start, first, self.end.state, self.end.rates)
    }

    /// Takes mass `i`, which is free and below the profile, back to its touch and through its impact, and moves it
    /// along the profile for the remaining time.
    pub(super) fn touch(&mut self, i: usize) {
        let (model, dense) = (self.step.model, self.dense());
        let theta = instant_of_touch(&dense, i);
        let (x, velocity, free) = (dense.position(i, theta), dense.velocity(i, theta), dense.velocity(i, 1.0));
        let from = ByAxis { x: dense.end_position(i), z: dense.end_height(i) };
        let slope = model.surface_at(x).slope;
        if velocity.z >= slope * velocity.x {
            return self.lift_onto_profile(i, from);
        }
        let (v_t, lost) = collision(model, velocity, slope);
        self.energies.impact += lost;
        let neighbours = neighbours(i).map(|j| self.velocity(j));
        let rest = Remainder { time: (1.0 - theta) * self.step.span.length, free, neighbours };
        let x = x + rest.time * v_t / (1.0 + slope * slope).sqrt();
        self.move_to(i, from, x, model.surface_at(x), rest.time);
        self.end.state.mode[i] = Mode::along(v_t);
        let speed = self.advance_along_profile(i, v_t, &rest);
        self.add_damper_energies(i, speed, &rest);
    }

    /// The velocity of mass `j`, m/s; `None` where there is no such mass.
    fn velocity(&self, j: usize) -> Option<ByAxis<f64>> {
        let state = &*self.end.state;
        (j < self.step.model.masses()).then(|| ByAxis { x: state.velocity_x[j], z: state.velocity_z[j] })
    }

    /// Lifts mass `i`, which leaves the profile already, onto it. It stays free.
    fn lift_onto_profile(&mut self, i: usize, from: ByAxis<f64>) {
        let surface = self.step.model.surface_at(from.x);
        self.move_to(i, from, from.x, surface, self.step.span.length);
        self.end.state.release(i);
    }

    /// Moves mass `i` from the position `from` to `x` on `surface`. In the last `time` (s) its dashpots have not
    /// followed that displacement, and the lateral dampers have passed it on to the neighbours as an impulse.
    fn move_to(&mut self, i: usize, from: ByAxis<f64>, x: f64, surface: SurfacePoint, time: f64) {
        let moved = ByAxis { x: x - from.x, z: surface.height - from.z };
        let state = &mut *self.end.state;
        state.displace(self.step.model, i, moved, time);
        state.elongation_z[i] =
            surface.height - self.step.model.rest_z[i] - (self.step.carrier.start.z + self.carrier.z.position);
        state.surface[i] = surface;
        self.end.forces.refresh(self.step.model, self.end.state, &self.carrier, i);
        for axis in Axis::ALL {
            self.pass_impulse_to_body(axis, moved[axis], time);
        }
        for j in neighbours(i) {
            if j < self.step.model.masses() {
                self.pass_impulse_to(j, moved, time);
            }
        }
    }

    /// The impulse d Δ of the damper to the carrier of a mass that was displaced by Δ (m), on a body along `axis`;
    /// `time` (s) bounds the velocity that it makes where the dampers are faster than that.
    fn pass_impulse_to_body(&mut self, axis: Axis, displacement: f64, time: f64) {
        let model = self.step.model;
        let Some(body) = &model.bodies[axis] else { return };
        let damping = self.damping(axis.link());
        let passing = damping * body.mass / (body.mass + time * model.masses() as f64 * damping);
        self.energies.impulse[axis] += passing * displacement;
    }

    /// The impulse d Δ of the lateral dampers on neighbour `j` of a mass that was displaced by Δ (m); `time` (s) bounds
    /// the velocity that it makes where the dampers are faster than that.
    fn pass_impulse_to(&mut self, j: usize, displacement: ByAxis<f64>, time: f64) {
        let model = self.step.model;
        let gained = |axis: Axis| displacement[axis] * (self.passing(axis.lateral(), time) / model.mass);
        let ByAxis { x, z } = ByAxis::from_fn(gained);
        if x == 0.0 && z == 0.0 {
            return;
        }
        let state = &*self.end.state;
        let (mode, slope, v) = (state.mode[j], state.surface[j].slope, state.velocity_x[j]);
        if mode == Mode::Free {
            self.set_velocity(j, ByAxis { x: v + x, z: state.velocity_z[j] + z });
        } else if mode.slips() {
            let after = v + (x + slope * z) / (1.0 + slope * slope);
            // Forces decide whether a slip reverses, not this correction.
            if !model.friction.present || after * v > 0.0 {
                self.set_slip_velocity(j, after);
            }
        }
    }

    /// Integrates the speed v_t of mass `i` from its impact to the end of the step by an implicit step for it alone.
    fn advance_along_profile(&mut self, i: usize, v_t: f64, rest: &Remainder) -> Speed {
        let (model, mode, surface) = (self.step.model, self.end.state.mode[i], self.end.state.surface[i]);
        let (s, time) = (surface.slope, rest.time);
        let q = (1.0 + s * s).sqrt();
        self.set_slip_velocity(i, v_t / q);
        let history = self.end.state.history(i);
        let contact = self.end.forces.contact(model, self.end.state, i);
        let at_rest = if contact.normal < 0.0 { 0.0 } else { mode.direction() * contact.limit };
        let damping = |axis: Axis| self.damping(axis.link()) + 2.0 * self.passing(axis.lateral(), time);
        let damping = damping(Axis::X) + damping(Axis::Z) * s * s;
        let slowing = time * (damping / (q * q) + time * model.mass_stiffness()) / model.mass;
        // No term in κ: v_t contains already how the profile bends from the touch to here.
        let driving = contact.tangential + self.not_passed(i, rest);
        // Under a remembered speed friction is that of the limit.
        let has_curve = history.memory.is_none() && contact.normal >= 0.0 && time > 0.0;
        let curve = model.friction.slip_curve(contact.normal, &history).filter(|_| has_curve);
        let weight = model.mass * (1.0 + slowing) / time;
        let excess = curve.map_or(0.0, |curve| rate_excess(&curve, mode.direction(), v_t, driving - at_rest, weight));
        let friction = at_rest + excess;
        let shares = model.friction.shares_at_rest(contact.normal, &history);
        let acceleration = (driving - friction) / model.mass;
        let after = v_t + time * acceleration / (1.0 + slowing);
        if model.friction.present && contact.normal >= 0.0 && mode.direction() * after < 0.0 {
            let distance = -0.5 * v_t * v_t / acceleration;
            self.energies.channels.add_friction(friction * distance, shares);
            self.stop_after(i, (distance - v_t * time) / q, time);
            return Speed { mean: distance / time, at_end: distance / time };
        }
        let mean = 0.5 * (v_t + after);
        self.energies.channels.add_friction(friction * time * mean, shares);
        self.set_slip_velocity(i, after / q);
        Speed { mean, at_end: after }
    }

    /// d of the links of a kind, N s/m.
    fn damping(&self, kind: LinkKind) -> f64 {
        self.step.model.links[kind].damping
    }

    /// The part of a damper d between two masses, N s/m, by which a correction of one of them within the `time` (s)
    /// acts on the other: all of d, unless the damper makes both velocities equal within that time.
    fn passing(&self, kind: LinkKind, time: f64) -> f64 {
        let (damping, mass) = (self.damping(kind), self.step.model.mass);
        damping * mass / (mass + 2.0 * time * damping)
    }

    /// The force along t of the lateral dampers on mass `i` by the part of them that does not pass impulses, N.
    fn not_passed(&self, i: usize, rest: &Remainder) -> f64 {
        let ByAxis { x, z } = ByAxis::from_fn(|axis| {
            let kind = axis.lateral();
            let change = |j, before: ByAxis<f64>| self.velocity(j).map_or(0.0, |after| after[axis] - before[axis]);
            let by_neighbours = neighbours(i).into_iter().zip(rest.neighbours);
            let own = change(i, rest.free);
            let sum: f64 = by_neighbours.filter_map(|(j, before)| Some(own - change(j, before?))).sum();
            (self.damping(kind) - self.passing(kind, rest.time)) * sum
        });
        let s = self.end.state.surface[i].slope;
        (x + s * z) / (1.0 + s * s).sqrt()
    }

    /// Adds the differences that the correction of mass `i` makes to the losses of its dampers in the remaining part of
    /// the step, and to the work of the carrier.
    fn add_damper_energies(&mut self, i: usize, speed: Speed, rest: &Remainder) {
        let s = self.end.state.surface[i].slope;
        let q = (1.0 + s * s).sqrt();
        let [mean, at_end] = [speed.mean, speed.at_end].map(|v_t| ByAxis { x: v_t / q, z: s * v_t / q });
        let carrier = self.carrier.rates();
        for kind in LinkKind::ALL {
            let (damping, passing) = (rest.time * self.damping(kind), rest.time * self.passing(kind, rest.time));
            let [free, mean, at_end, carrier] =
                [rest.free, mean, at_end, carrier].map(|velocity| velocity[kind.axis()]);
            if !kind.is_lateral() {
                let more = (at_end - carrier) * (mean - carrier) - (free - carrier).powi(2);
                self.energies.channels.damper += damping * more;
                if self.step.model.bodies[kind.axis()].is_none() {
                    self.energies.channels.input -= damping * (at_end - free) * carrier;
                }
                continue;
            }
            for (j, before) in neighbours(i).into_iter().zip(rest.neighbours) {
                let (Some(before), Some(after)) = (before, self.velocity(j)) else { continue };
                let (before, after) = (before[kind.axis()], after[kind.axis()]);
                let trial = free - before;
                let impulse = damping * trial + passing * (at_end - after - trial);
                self.energies.channels.damper += impulse * (mean - 0.5 * (before + after)) - damping * trial * trial;
            }
        }
    }

    /// Stops mass `i` at `distance` (m) along x from where it is.
    fn stop_after(&mut self, i: usize, distance: f64, time: f64) {
        self.set_slip_velocity(i, 0.0);
        let model = self.step.model;
        let x = model.rest_x[i]
            + (self.step.carrier.profile_position + (self.carrier.x.position + self.end.state.elongation_x[i]));
        let from = ByAxis { x, z: self.end.state.surface[i].height };
        self.move_to(i, from, x + distance, model.surface_at(x + distance), time);
    }

    /// Sets ẋ of mass `i`, and ż along the profile.
    fn set_slip_velocity(&mut self, i: usize, v_x: f64) {
        self.set_velocity(i, ByAxis { x: v_x, z: self.end.state.surface[i].slope * v_x });
    }

    fn set_velocity(&mut self, i: usize, velocity: ByAxis<f64>) {
        let state = &mut *self.end.state;
        let change = ByAxis { x: velocity.x - state.velocity_x[i], z: velocity.z - state.velocity_z[i] };
        (state.velocity_x[i], state.velocity_z[i]) = (velocity.x, velocity.z);
        self.end.forces.add_velocity(self.step.model, i, change);
    }

    /// Decides contact `j` anew by the forces as they are, and evaluates the rates of mass `j` anew.
    pub(super) fn decide(&mut self, j: usize) {
        decide_mode(self.step.model, self.end.state, self.end.forces, j);
        let profile_position = self.step.carrier.profile_position + self.carrier.x.position;
        let at = (&self.carrier, profile_position);
        self.end.rates.refresh(self.step.model, self.end.state, self.end.forces, j, at);
    }
}

/// The excess of the friction in slip over that at rest, N, of a mass that slips along `sigma`, starts with v_t (m/s)
/// and is driven by a force (N) against its inertia over the time, `weight` (kg/s): at the end of that time, since the
/// law is steep at creep speeds.
fn rate_excess(curve: &SlipCurve<'_>, sigma: f64, v_t: f64, driving: f64, weight: f64) -> f64 {
    let (from, driving) = (sigma * v_t, sigma * driving);
    sigma * (driving - weight * (curve.balance(from, driving, weight) - from))
}

/// The indices beside mass `i`; one of them may be out of range.
fn neighbours(i: usize) -> [usize; 2] {
    [i.wrapping_sub(1), i + 1]
}

/// What the links of free mass `i` would exert on the carrier along x and z beyond what they do, N, if the mass did not
/// pass below the profile but had its impact and went on along it: at the fraction `theta` of the step (docs/theory.md,
/// \[12a\]).
pub(super) fn forces_of_touch(step: &Parabolas<'_>, i: usize, theta: f64) -> ByAxis<f64> {
    let surface = step.model.surface_at(step.position(i, theta));
    let depth = surface.height - step.height(i, theta);
    if depth <= 0.0 {
        return ByAxis::default();
    }
    let (slope, velocity) = (surface.slope, step.velocity(i, theta));
    let (closing, since_start) = (slope * velocity.x - velocity.z, theta * step.span.length);
    let (time, gain) = if closing > 0.0 {
        let v_t = collision(step.model, velocity, slope).0;
        let along = v_t / (1.0 + slope * slope).sqrt();
        ((depth / closing).min(since_start), (along - velocity.x, slope * along - velocity.z))
    } else {
        (since_start, (0.0, 0.0))
    };
    let moved = time * gain.0;
    let force = |kind: LinkKind, displacement: f64, gain: f64| {
        let link = &step.model.links[kind];
        let elements = step.model.element_force(kind, |row| row.left_of(displacement, time));
        link.stiffness * displacement + elements + link.damping * gain
    };
    ByAxis {
        x: force(LinkKind::Horizontal, moved, gain.0),
        z: force(LinkKind::Vertical, depth + slope * moved, gain.1),
    }
}

/// The fraction of the step at which free mass `i`, below the profile at the end, touched it.
fn instant_of_touch(dense: &Parabolas<'_>, i: usize) -> f64 {
    if dense.gap(i, 0.0) <= 0.0 { 0.0 } else { bracketed_root(|theta| dense.gap(i, theta), (0.0, 1.0), INSTANT) }
}

impl Parabolas<'_> {
    /// The height of mass `i` above the profile at the fraction `theta` of the step, m.
    pub(super) fn gap(&self, i: usize, theta: f64) -> f64 {
        self.height(i, theta) - self.model.surface_at(self.position(i, theta)).height
    }
}
