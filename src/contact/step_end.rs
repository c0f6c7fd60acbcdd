//! Mode changes of the time-stepping driver: what comes about within a step is settled at its end.
//!
//! A step holds its modes, and the state at its end shows which could not last: a free mass is below the profile, a contact has
//! F_N < 0, a slip has reversed, a stick is past T. The step is not repeated with other modes; only the masses concerned
//! are put right. One that fell below the profile goes back to the instant of its touch, has its impact there, and goes on
//! along the profile for what is left of the step; its dashpots follow it, and the dampers pass its way on to the
//! neighbours. A slip that reversed stops. Lifts and breaks begin at the end, as the forces alone went too far. Then the rules of
//! model.md decide on all of them and their neighbours by the forces as they are.
//!
//! So a step takes any number of mode changes, at its own cost. What their lateness leaves falls with the square of the step's
//! length, as the method's error does; it is measured with it, and where it is too large the step is shortened.
//! Repeating the step with the modes of its end would cost the stages again, and put changes too early in place of too late.

use super::rules::{collision, decided};
use crate::integrator::{Rates, Tolerance, Within};
use crate::math::{Bounds, bracketed_root};
use crate::model::{Carrier, CarrierPoint, Forces, LinkKind, Mode, Model, Power, State, SurfacePoint};

/// How much the lateness of mode changes weighs in the error of a step.
///
/// Recommended 3 to 10. With 5, masses that touch and lift at a relative tolerance of 1e-2 add errors of some 1e-2 to the forces of
/// a layer; larger costs rejected steps where many do.
const LATENESS: f64 = 5.0;

/// To which share of a step the instant of a touch is found: what it misses is smaller than the parabola's own error.
const INSTANT: f64 = 1e-4;

/// How many masses to each side feel that one is put right: the neighbours get impulses, and theirs feel these.
const REACH: usize = 2;

/// The masses whose modes could not last through a step, and room for them.
#[derive(Clone, Debug)]
pub struct StepEnd {
    /// Free masses below the profile at the end.
    touches: Vec<usize>,
    /// Contacts past a limit at the end.
    contacts: Vec<usize>,
    /// The masses whose forces these change.
    concerned: Vec<bool>,
    /// The extremes of the profile.
    profile: Bounds,
}

/// A step that was tried with its modes held: what settling does not change.
#[derive(Clone, Copy, Debug)]
pub struct HeldStep<'a> {
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
pub struct Settled {
    /// Lost in impacts.
    pub impact: f64,
    /// Through the channels, from the instants of the impacts on: what the masses in contact do beyond what free ones would.
    pub channels: Power,
}

impl StepEnd {
    /// Room for the mode changes of a step of `model`.
    pub fn new(model: &Model) -> Self {
        let k = model.masses();
        Self {
            touches: Vec::with_capacity(k),
            contacts: Vec::with_capacity(k),
            concerned: vec![false; k],
            profile: model.profile.bounds(),
        }
    }

    /// Finds the modes that could not last; their lateness over the tolerance, in the mean of all masses.
    pub fn find(&mut self, step: &Within<'_>, tolerance: &Tolerance) -> f64 {
        self.touches.clear();
        self.contacts.clear();
        let frequency = step.model.felt_frequency();
        let stiffness = step.model.mass * frequency * frequency;
        let mut sum = 0.0;
        for i in 0..step.model.masses() {
            let late = match step.end.mode[i] {
                Mode::Free => self.find_touch(step, i),
                _ => self.find_limit(step, i, stiffness),
            };
            if let Some(late) = late {
                let error = LATENESS * late.error(frequency);
                sum += error * error / tolerance.of_position(step.end.elongation_x[i]);
            }
        }
        (sum / step.model.masses() as f64).sqrt()
    }

    /// Whether [`find`](Self::find) found nothing.
    pub fn is_settled(&self) -> bool {
        self.touches.is_empty() && self.contacts.is_empty()
    }

    /// How late free mass `i` touches.
    fn find_touch(&mut self, step: &Within<'_>, i: usize) -> Option<Late> {
        let height = step.height(i, 1.0);
        if height.min(step.height(i, Within::FIRST)) > self.profile.z_max {
            return None;
        }
        let ground = step.model.ground(step.place(i, 1.0));
        let gap = height - ground.height;
        if gap >= 0.0 {
            return self.find_dip(step, i, gap);
        }
        self.touches.push(i);
        let closing = ground.slope * step.end.velocity_x[i] - step.end.velocity_z[i];
        let time = if closing > 0.0 { (-gap / closing).min(step.span.1) } else { step.span.1 };
        Some(Late { length: -gap, time })
    }

    /// A mass above the profile at the end, by `gap`, that is below at the first stage has gone through an asperity: all of
    /// that is an error.
    fn find_dip(&self, step: &Within<'_>, i: usize, gap: f64) -> Option<Late> {
        let rise = step.height(i, 1.0) - step.height(i, Within::FIRST);
        let way = (step.place(i, 1.0) - step.place(i, Within::FIRST)).abs();
        if gap > rise + way * self.profile.slope_max_abs {
            return None;
        }
        let dip = step.gap(i, Within::FIRST);
        (dip < 0.0).then_some(Late { length: -dip, time: f64::INFINITY })
    }

    /// How far contact `i` is past a limit: by the elongation that makes such a force, or by the way that it slipped back.
    fn find_limit(&mut self, step: &Within<'_>, i: usize, stiffness: f64) -> Option<Late> {
        let (first, last) = (step.first, step.last);
        let late = if last.normal[i] < 0.0 {
            let time = step.time_below(first.normal[i], last.normal[i]);
            Late { length: -last.normal[i] / stiffness, time }
        } else if step.model.has_friction && last.margin[i] < 0.0 {
            let time = step.time_below(first.margin[i], last.margin[i]);
            let unit = if step.end.mode[i] == Mode::Stick { 1.0 / stiffness } else { 0.5 * time };
            Late { length: -last.margin[i] * unit, time }
        } else {
            return None;
        };
        self.contacts.push(i);
        Some(late)
    }

    /// Settles what [`find`](Self::find) found; `None` where that is nothing.
    pub fn settle(&mut self, step: HeldStep<'_>, end: End<'_>) -> Option<Settled> {
        if self.is_settled() {
            return None;
        }
        let (s, h) = step.span;
        let mut settling = Settling { here: step.carrier.at(s + h), step, end, settled: Settled::default() };
        for &i in &self.touches {
            settling.touch(i);
        }
        for &i in &self.contacts {
            settling.stop(i);
        }
        for &i in self.touches.iter().chain(&self.contacts) {
            let end = (i + REACH + 1).min(self.concerned.len());
            self.concerned[i.saturating_sub(REACH)..end].fill(true);
        }
        for (j, concerned) in self.concerned.iter_mut().enumerate().filter(|(_, concerned)| **concerned) {
            settling.decide(j);
            *concerned = false;
        }
        Some(settling.settled)
    }
}

/// How late a mode change is.
#[derive(Clone, Copy, Debug)]
struct Late {
    /// By what length it goes too far, m.
    length: f64,
    /// For how long, s.
    time: f64,
}

impl Late {
    /// The error, m, that is left after it has been put right: in a time that is short against 1/ω of the stiffest frequency ω
    /// the forces that went too far move little.
    fn error(self, frequency: f64) -> f64 {
        self.length * (frequency * self.time).min(1.0)
    }
}

impl Within<'_> {
    fn gap(&self, i: usize, theta: f64) -> f64 {
        self.height(i, theta) - self.model.ground(self.place(i, theta)).height
    }

    /// For how long a quantity that is `first` at the first stage and `last` < 0 at the end has been negative, s, by the line
    /// through them.
    fn time_below(&self, first: f64, last: f64) -> f64 {
        let fall = (first - last) / (1.0 - Self::FIRST);
        self.span.1 * if fall > -last { -last / fall } else { 1.0 }
    }

    /// The fraction of the step at which free mass `i`, below the profile at the end, came there.
    fn touch(&self, i: usize) -> f64 {
        if self.gap(i, 0.0) <= 0.0 { 0.0 } else { bracketed_root(|theta| self.gap(i, theta), (0.0, 1.0), INSTANT) }
    }
}

/// A step whose end is being settled.
struct Settling<'a> {
    step: HeldStep<'a>,
    /// The carrier at the end.
    here: CarrierPoint,
    end: End<'a>,
    settled: Settled,
}

/// What is left of the step for a mass after its impact, s, and its velocity then.
#[derive(Clone, Copy)]
struct Rest {
    time: f64,
    /// As it would have gone on freely, in the mean.
    free: (f64, f64),
    /// Along the profile.
    held: (f64, f64),
}

impl Settling<'_> {
    fn within(&self) -> Within<'_> {
        let HeldStep { model, carrier, span, start, first } = self.step;
        Within::new(model, carrier, span, (start, first), (self.end.state, self.end.rates))
    }

    /// Mass `i`, free and below the profile, goes back to its touch, has its impact, and goes on along the profile.
    fn touch(&mut self, i: usize) {
        let (model, within) = (self.step.model, self.within());
        let theta = within.touch(i);
        let (x, velocity, end) = (within.place(i, theta), within.velocity(i, theta), within.velocity(i, 1.0));
        let from = (within.place(i, 1.0), within.height(i, 1.0));
        let slope = model.ground(x).slope;
        if velocity.1 >= slope * velocity.0 {
            return self.raise(i, from);
        }
        let (v_t, lost) = collision(model, velocity, slope);
        let v_x = v_t / (1.0 + slope * slope).sqrt();
        let free = (0.5 * (velocity.0 + end.0), 0.5 * (velocity.1 + end.1));
        let rest = Rest { time: (1.0 - theta) * self.step.span.1, free, held: (v_x, slope * v_x) };
        self.settled.impact += lost;
        self.count_dampers(i, &rest);
        let ground = model.ground(x + rest.time * v_x);
        self.put(i, from, (x + rest.time * v_x, ground), rest.time);
        self.end.state.mode[i] = Mode::along(v_t);
        self.set_speed(i, v_t / (1.0 + ground.slope * ground.slope).sqrt());
        self.go_on(i, rest.time);
    }

    /// A mass that moves out of the profile already is put on it, and stays free.
    fn raise(&mut self, i: usize, from: (f64, f64)) {
        let ground = self.step.model.ground(from.0);
        self.put(i, from, (from.0, ground), self.step.span.1);
    }

    /// Moves mass `i` to the place `x` on `ground`. What it has moved in the last `time` (s) its dashpots have not, and the
    /// lateral dampers have passed on to the neighbours as an impulse.
    fn put(&mut self, i: usize, from: (f64, f64), (x, ground): (f64, SurfacePoint), time: f64) {
        let moved = (x - from.0, ground.height - from.1);
        let state = &mut *self.end.state;
        state.elongation_x[i] += moved.0;
        state.elongation_z[i] = ground.height - self.step.model.rest_z[i] - (self.step.carrier.w + self.here.dw);
        state.ground[i] = ground;
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
        for j in [i.wrapping_sub(1), i + 1] {
            if j < self.step.model.masses() {
                self.pass_on(j, moved, time);
            }
        }
    }

    /// The impulse d Δ of the lateral dampers on neighbour `j` of a mass that was moved by Δ; `time` (s) bounds the
    /// velocity that it makes where the dampers are faster than that.
    fn pass_on(&mut self, j: usize, moved: (f64, f64), time: f64) {
        let model = self.step.model;
        let gain = |kind: LinkKind| {
            let damping = model.links[kind as usize].damping;
            damping / (model.mass + 2.0 * time * damping)
        };
        let (x, z) = (moved.0 * gain(LinkKind::LateralX), moved.1 * gain(LinkKind::LateralZ));
        if x == 0.0 && z == 0.0 {
            return;
        }
        let state = &*self.end.state;
        let (mode, slope, v) = (state.mode[j], state.ground[j].slope, (state.velocity_x[j], state.velocity_z[j]));
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

    /// What the dampers of mass `i` did otherwise in the rest of the step: their loss, and the power of the carrier.
    fn count_dampers(&mut self, i: usize, rest: &Rest) {
        let state = &*self.end.state;
        for kind in LinkKind::ALL {
            let damping = self.step.model.links[kind as usize].damping;
            let pick = |(x, z): (f64, f64)| if kind.is_along_x() { x } else { z };
            let (free, held) = (pick(rest.free), pick(rest.held));
            let carrier = pick((self.here.u_rate, self.here.w_rate));
            let velocity = if kind.is_along_x() { &state.velocity_x } else { &state.velocity_z };
            let more = |other: f64| rest.time * damping * ((held - other).powi(2) - (free - other).powi(2));
            let channels = &mut self.settled.channels;
            if kind.is_lateral() {
                let neighbours = [i.wrapping_sub(1), i + 1].map(|j| velocity.get(j).map_or(0.0, |&v| more(v)));
                channels.damper += neighbours[0] + neighbours[1];
            } else {
                channels.damper += more(carrier);
                channels.input -= rest.time * damping * (held - free) * carrier;
            }
        }
    }

    /// What the forces make of the speed of mass `i` in the `time` (s) since its impact: an implicit step for it alone.
    fn go_on(&mut self, i: usize, time: f64) {
        let model = self.step.model;
        let (mode, v, ground) = (self.end.state.mode[i], self.end.state.velocity_x[i], self.end.state.ground[i]);
        let contact = self.end.forces.contact(model, i, v, &ground);
        if contact.normal < 0.0 {
            return;
        }
        self.settled.channels.friction += time * contact.friction(mode) * v * contact.q;
        let damping = model.links[LinkKind::Horizontal as usize].damping
            + 2.0 * model.links[LinkKind::LateralX as usize].damping
            + model.links[LinkKind::Vertical as usize].damping * ground.slope * ground.slope;
        let slowing = time * (damping + time * model.glassy_stiffness()) / model.mass;
        // No term in κ: how the profile bends from the touch to here is in v already.
        let pull = (contact.tangential - contact.friction(mode)) / (model.mass * contact.q);
        let after = v + time * pull / (1.0 + slowing);
        self.set_speed(i, if model.has_friction && mode.direction() * after < 0.0 { 0.0 } else { after });
    }

    /// Brings a slip that has reversed to rest, so that the rule for *stop* decides.
    fn stop(&mut self, i: usize) {
        let (mode, v) = (self.end.state.mode[i], self.end.state.velocity_x[i]);
        if self.step.model.has_friction && mode.slips() && mode.direction() * v < 0.0 {
            self.set_speed(i, 0.0);
        }
    }

    /// The velocity of mass `i` along the profile, by its ẋ.
    fn set_speed(&mut self, i: usize, v_x: f64) {
        self.set_velocity(i, (v_x, self.end.state.ground[i].slope * v_x));
    }

    fn set_velocity(&mut self, i: usize, (v_x, v_z): (f64, f64)) {
        let state = &mut *self.end.state;
        let change = (v_x - state.velocity_x[i], v_z - state.velocity_z[i]);
        (state.velocity_x[i], state.velocity_z[i]) = (v_x, v_z);
        self.end.forces.add_velocity(self.step.model, i, change);
    }

    /// Decides contact `j` anew by the forces as they are, and finds the rates of mass `j` anew.
    fn decide(&mut self, j: usize) {
        if self.end.state.mode[j].in_contact() {
            self.end.state.mode[j] = decided(self.step.model, self.end.state, self.end.forces, j);
        }
        self.end.rates.refresh(self.step.model, self.end.state, self.end.forces, j, &self.here);
    }
}
