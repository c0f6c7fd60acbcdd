//! What settles one step's end: each touch, each stop, and what they change in the energies.
//!
//! A mass that is put right has had impulses that the held step does not know, and so have its neighbours. The energies
//! count each as the impulse times the mean of the velocities before and after it: that closes the account however
//! stiff a damper is and however large a friction.

use super::laws::{collision, decide_mode, energy_at, has_reversed};
use crate::integrator::{Rates, TwoStageDense};
use crate::math::bracketed_root;
use crate::model::{Carrier, CarrierPoint, ChannelEnergies, Forces, LinkKind, Mode, Model, State, SurfacePoint};

/// To which share of a step the instant of a touch is found: what it misses is smaller than the parabola's own error.
const INSTANT: f64 = 1e-4;

/// A step that was tried with its modes held: what settling does not change.
#[derive(Clone, Copy, Debug)]
pub struct FixedModeStep<'a> {
    /// The model.
    pub model: &'a Model,
    /// The carrier's motion.
    pub carrier: &'a Carrier,
    /// Start of the step after the start of the carrier's piece and its length, s.
    pub span: (f64, f64),
    /// State at the start.
    pub start: &'a State,
    /// Rates at the first stage.
    pub first: &'a Rates,
}

/// The end of that step, to be settled.
#[derive(Debug)]
pub struct End<'a> {
    /// The state.
    pub state: &'a mut State,
    /// The forces in it.
    pub forces: &'a mut Forces,
    /// The rates in it.
    pub rates: &'a mut Rates,
}

/// Energies of the mode changes at the end of a step, J.
#[derive(Clone, Copy, Debug, Default)]
pub struct CorrectionEnergies {
    /// Lost in impacts.
    pub impact: f64,
    /// Through the channels, from the instants of the impacts on: what the masses in contact do beyond what free ones
    /// would.
    pub channels: ChannelEnergies,
}

/// A step whose end is being settled.
pub(super) struct Correction<'a> {
    step: FixedModeStep<'a>,
    /// The carrier at the end.
    here: CarrierPoint,
    end: End<'a>,
    settled: CorrectionEnergies,
}

/// What is left of the step for a mass after its impact.
#[derive(Clone, Copy)]
struct Rest {
    /// How long, s.
    time: f64,
    /// Its velocity at the end, as it would have gone on freely, m/s.
    free: (f64, f64),
    /// The neighbours' velocities before they were passed anything on, m/s.
    neighbours: [Option<(f64, f64)>; 2],
}

/// A speed v_t along the profile after an impact, m/s.
#[derive(Clone, Copy)]
struct Speed {
    /// In the mean.
    mean: f64,
    /// As the dampers feel it: implicitly, at the end.
    felt: f64,
}

impl<'a> Correction<'a> {
    /// Begins to settle the end of `step`.
    pub(super) fn new(step: FixedModeStep<'a>, end: End<'a>) -> Self {
        let (s, h) = step.span;
        Self { here: step.carrier.at(s + h), step, end, settled: CorrectionEnergies::default() }
    }

    /// The energies of all that was settled.
    pub(super) fn settled(&self) -> CorrectionEnergies {
        self.settled
    }

    fn within(&self) -> TwoStageDense<'_> {
        let FixedModeStep { model, carrier, span, start, first } = self.step;
        TwoStageDense::new(model, carrier, span, (start, first), (self.end.state, self.end.rates))
    }

    /// Mass `i`, free and below the profile, goes back to its touch, has its impact, and goes on along the profile.
    pub(super) fn touch(&mut self, i: usize) {
        let (model, within) = (self.step.model, self.within());
        let theta = touch(&within, i);
        let (x, velocity, end) = (within.place(i, theta), within.velocity(i, theta), within.velocity(i, 1.0));
        let from = (within.place(i, 1.0), within.height(i, 1.0));
        let slope = model.surface_at(x).slope;
        if velocity.1 >= slope * velocity.0 {
            return self.raise(i, from);
        }
        let (v_t, lost) = collision(model, velocity, slope);
        self.settled.impact += lost;
        let neighbours = neighbours(i).map(|j| self.velocity(j));
        let rest = Rest { time: (1.0 - theta) * self.step.span.1, free: end, neighbours };
        let x = x + rest.time * v_t / (1.0 + slope * slope).sqrt();
        self.put(i, from, (x, model.surface_at(x)), rest.time);
        self.end.state.mode[i] = Mode::along(v_t);
        let speed = self.go_on(i, v_t, &rest);
        self.count_dampers(i, speed, &rest);
    }

    /// The velocity of mass `j`, if there is one.
    fn velocity(&self, j: usize) -> Option<(f64, f64)> {
        let state = &*self.end.state;
        (j < self.step.model.masses()).then(|| (state.velocity_x[j], state.velocity_z[j]))
    }

    /// A mass that moves out of the profile already is put on it, and stays free.
    fn raise(&mut self, i: usize, from: (f64, f64)) {
        let surface = self.step.model.surface_at(from.0);
        self.put(i, from, (from.0, surface), self.step.span.1);
        self.end.state.release(i);
    }

    /// Moves mass `i` to the place `x` on `surface`. What it has moved in the last `time` (s) its dashpots have not, and
    /// the lateral dampers have passed on to the neighbours as an impulse.
    fn put(&mut self, i: usize, from: (f64, f64), (x, surface): (f64, SurfacePoint), time: f64) {
        let moved = (x - from.0, surface.height - from.1);
        let state = &mut *self.end.state;
        state.elongation_x[i] += moved.0;
        state.elongation_z[i] = surface.height - self.step.model.rest_z[i] - (self.step.carrier.w + self.here.dw);
        state.surface[i] = surface;
        for row in &self.step.model.rows {
            let along = if row.kind.is_along_x() { moved.0 } else { moved.1 };
            let by = along * row.relaxation_time / (row.relaxation_time + time);
            let a = &mut state.maxwell[row.range.clone()];
            if !row.kind.is_lateral() {
                a[i] += by;
                continue;
            }
            if let Some(a) = a.get_mut(i) {
                *a -= by;
            }
            if i > 0 {
                a[i - 1] += by;
            }
        }
        self.end.forces.refresh(self.step.model, self.end.state, &self.here, i);
        for j in neighbours(i) {
            if j < self.step.model.masses() {
                self.pass_on(j, moved, time);
            }
        }
    }

    /// The impulse d Δ of the lateral dampers on neighbour `j` of a mass that was moved by Δ; `time` (s) bounds the
    /// velocity that it makes where the dampers are faster than that.
    fn pass_on(&mut self, j: usize, moved: (f64, f64), time: f64) {
        let model = self.step.model;
        let gain = |kind| self.passing(kind, time) / model.mass;
        let (x, z) = (moved.0 * gain(LinkKind::LateralX), moved.1 * gain(LinkKind::LateralZ));
        if x == 0.0 && z == 0.0 {
            return;
        }
        let state = &*self.end.state;
        let (mode, slope, v) = (state.mode[j], state.surface[j].slope, (state.velocity_x[j], state.velocity_z[j]));
        if mode == Mode::Free {
            self.set_velocity(j, (v.0 + x, v.1 + z));
        } else if mode.slips() {
            let after = v.0 + (x + slope * z) / (1.0 + slope * slope);
            // Whether a slip reverses is for forces to decide, not for this correction.
            if !model.has_friction || after * v.0 > 0.0 {
                self.set_speed(j, after);
            }
        }
    }

    /// What the forces make of the speed v_t of mass `i` since its impact: an implicit step for it alone.
    fn go_on(&mut self, i: usize, v_t: f64, rest: &Rest) -> Speed {
        let (model, mode, surface) = (self.step.model, self.end.state.mode[i], self.end.state.surface[i]);
        let (s, time) = (surface.slope, rest.time);
        let q = (1.0 + s * s).sqrt();
        self.set_speed(i, v_t / q);
        let contact = self.end.forces.contact(model, i, v_t / q, &surface);
        let held = if contact.normal < 0.0 { 0.0 } else { mode.direction() * contact.limit };
        let damping = |along, lateral| self.damping(along) + 2.0 * self.passing(lateral, time);
        let damping =
            damping(LinkKind::Horizontal, LinkKind::LateralX) + damping(LinkKind::Vertical, LinkKind::LateralZ) * s * s;
        let slowing = time * (damping / (q * q) + time * model.mass_stiffness()) / model.mass;
        // No term in κ: how the profile bends from the touch to here is in v_t already.
        let driving = contact.tangential + self.not_passed(i, rest);
        let beyond =
            if contact.normal < 0.0 { 0.0 } else { beyond_rest(model, mode, v_t, (driving - held, time, slowing)) };
        let friction = held + beyond;
        let acceleration = (driving - friction) / model.mass;
        let after = v_t + time * acceleration / (1.0 + slowing);
        if model.has_friction && contact.normal >= 0.0 && mode.direction() * after < 0.0 {
            let way = -0.5 * v_t * v_t / acceleration;
            self.settled.channels.friction += friction * way;
            self.stop_after(i, (way - v_t * time) / q, time);
            return Speed { mean: way / time, felt: way / time };
        }
        let mean = 0.5 * (v_t + after);
        self.settled.channels.friction += friction * time * mean;
        self.set_speed(i, after / q);
        Speed { mean, felt: after }
    }

    /// d of the links of a kind, N s/m.
    fn damping(&self, kind: LinkKind) -> f64 {
        self.step.model.links[kind as usize].damping
    }

    /// What of a damper d between two masses passes on what one of them moves otherwise than it was tried, N s/m: all
    /// of d, unless it brings them together within the `time` (s).
    fn passing(&self, kind: LinkKind, time: f64) -> f64 {
        let (damping, mass) = (self.damping(kind), self.step.model.mass);
        damping * mass / (mass + 2.0 * time * damping)
    }

    /// The force along t of the lateral dampers on mass `i` that does not pass, N.
    fn not_passed(&self, i: usize, rest: &Rest) -> f64 {
        let [x, z] = [LinkKind::LateralX, LinkKind::LateralZ].map(|kind| {
            let pick = |velocity| along(kind, velocity);
            let otherwise = |j, before| self.velocity(j).map_or(0.0, |after| pick(after) - pick(before));
            let by_neighbours = neighbours(i).into_iter().zip(rest.neighbours);
            let own = otherwise(i, rest.free);
            let sum: f64 = by_neighbours.filter_map(|(j, before)| Some(own - otherwise(j, before?))).sum();
            (self.damping(kind) - self.passing(kind, rest.time)) * sum
        });
        let s = self.end.state.surface[i].slope;
        (x + s * z) / (1.0 + s * s).sqrt()
    }

    /// What the dampers of mass `i` did otherwise in the rest of the step: their loss, and the power of the carrier.
    fn count_dampers(&mut self, i: usize, speed: Speed, rest: &Rest) {
        let s = self.end.state.surface[i].slope;
        let q = (1.0 + s * s).sqrt();
        let [mean, felt] = [speed.mean, speed.felt].map(|v_t| (v_t / q, s * v_t / q));
        let carrier = (self.here.u_rate, self.here.w_rate);
        for kind in LinkKind::ALL {
            let (damping, passing) = (rest.time * self.damping(kind), rest.time * self.passing(kind, rest.time));
            let [free, mean, felt, carrier] = [rest.free, mean, felt, carrier].map(|velocity| along(kind, velocity));
            if !kind.is_lateral() {
                let more = (felt - carrier) * (mean - carrier) - (free - carrier).powi(2);
                self.settled.channels.damper += damping * more;
                self.settled.channels.input -= damping * (felt - free) * carrier;
                continue;
            }
            for (j, before) in neighbours(i).into_iter().zip(rest.neighbours) {
                let (Some(before), Some(after)) = (before, self.velocity(j)) else { continue };
                let (before, after) = (along(kind, before), along(kind, after));
                let trial = free - before;
                let impulse = damping * trial + passing * (felt - after - trial);
                self.settled.channels.damper += impulse * (mean - 0.5 * (before + after)) - damping * trial * trial;
            }
        }
    }

    /// Brings mass `i` to rest `along` (m) further than it is.
    fn stop_after(&mut self, i: usize, along: f64, time: f64) {
        self.set_speed(i, 0.0);
        let model = self.step.model;
        let x =
            model.rest_x[i] + (self.step.carrier.profile_position + (self.here.du + self.end.state.elongation_x[i]));
        let here = (x, self.end.state.surface[i].height);
        self.put(i, here, (x + along, model.surface_at(x + along)), time);
    }

    /// Brings a slip that has reversed to rest, so that the rule for *stop* decides.
    pub(super) fn stop(&mut self, i: usize) {
        let (model, state) = (self.step.model, &*self.end.state);
        let v = state.velocity_x[i];
        if model.has_friction && has_reversed(state.mode[i], v) {
            self.settled.channels.friction += energy_at(model, (v, state.surface[i].slope * v));
            self.set_speed(i, 0.0);
        }
    }

    /// The velocity of mass `i` along the profile, by its ẋ.
    fn set_speed(&mut self, i: usize, v_x: f64) {
        self.set_velocity(i, (v_x, self.end.state.surface[i].slope * v_x));
    }

    fn set_velocity(&mut self, i: usize, (v_x, v_z): (f64, f64)) {
        let state = &mut *self.end.state;
        let change = (v_x - state.velocity_x[i], v_z - state.velocity_z[i]);
        (state.velocity_x[i], state.velocity_z[i]) = (v_x, v_z);
        self.end.forces.add_velocity(self.step.model, i, change);
    }

    /// Decides contact `j` anew by the forces as they are, and finds the rates of mass `j` anew.
    pub(super) fn decide(&mut self, j: usize) {
        decide_mode(self.step.model, self.end.state, self.end.forces, j);
        self.end.rates.refresh(self.step.model, self.end.state, self.end.forces, j, &self.here);
    }
}

/// The friction beyond that at rest, N, with which a mass in `mode` goes on for a `time` (s) from v_t (m/s), driven by
/// a force (N) and slowed: at the end of that time, since it is steep at creep speeds.
fn beyond_rest(model: &Model, mode: Mode, v_t: f64, (driving, time, slowing): (f64, f64, f64)) -> f64 {
    let Some(law) = model.rate_shear.filter(|_| time > 0.0) else { return 0.0 };
    let sigma = mode.direction();
    let weight = model.mass * (1.0 + slowing) / time;
    let (from, driving) = (sigma * v_t, sigma * driving);
    sigma * (driving - weight * (law.balance(from, driving, weight) - from))
}

/// The masses beside mass `i`, if there are such.
fn neighbours(i: usize) -> [usize; 2] {
    [i.wrapping_sub(1), i + 1]
}

/// What of (x, z) counts for the links of a kind.
fn along(kind: LinkKind, (x, z): (f64, f64)) -> f64 {
    if kind.is_along_x() { x } else { z }
}

/// The fraction of the step at which free mass `i`, below the profile at the end, came there.
fn touch(within: &TwoStageDense<'_>, i: usize) -> f64 {
    if within.gap(i, 0.0) <= 0.0 { 0.0 } else { bracketed_root(|theta| within.gap(i, theta), (0.0, 1.0), INSTANT) }
}
