//! A run of an element.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::PointContact;
use super::error::{ElementError, RestoreError};
use super::jenkins::{Jenkins, Listener, Rates};
use super::law::{Contact, Curve, Law};
use super::table_format::Quantity;
use crate::model::Mode;
use crate::scene::is_possible;
use crate::simulation::{ModeChange, Start};

/// Share of the speeds and separations of the table by which the carrier may exceed them: rounding of a master that goes
/// to the very end.
const ROUNDING: f64 = 1e-9;

/// All that changes in a run, SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ElementState {
    time: f64,
    u: f64,
    w: f64,
    u_rate: f64,
    w_rate: f64,
    /// G = -F_x, N.
    force: f64,
    /// As [`Mode::number`] gives it.
    mode: i8,
    /// Lost since the start, J.
    pub(super) lost: f64,
    /// Of that, through the channels, J.
    pub(super) lost_by_channel: [f64; 4],
}

/// A run of an element, as a [`Simulation`](crate::simulation::Simulation) is that of a layer.
///
/// A clone continues as the original does, bit for bit.
#[derive(Clone, Debug)]
pub struct Element {
    law: Arc<Law>,
    /// The law at the present speed.
    pub(super) curve: Curve,
    extrapolates: bool,
    pub(super) state: ElementState,
    pub(super) spring: Jenkins,
    mode_changes: Option<Vec<ModeChange>>,
}

impl Element {
    /// An element under the carrier, its spring relaxed.
    ///
    /// # Errors
    /// [`ElementError`] where the carrier is beyond the table.
    pub fn new(contact: &PointContact, start: &Start) -> Result<Self, ElementError> {
        start.check()?;
        let state = ElementState {
            time: start.time,
            u: start.u,
            w: start.w,
            u_rate: start.u_rate,
            w_rate: start.w_rate,
            ..ElementState::default()
        };
        let mut element = Self::at(contact, state)?;
        element.spring = Jenkins::new(&element.contact());
        element.state.mode = element.spring.mode.number();
        Ok(element)
    }

    /// An element in `state`, its spring not set yet.
    fn at(contact: &PointContact, state: ElementState) -> Result<Self, ElementError> {
        let law = Arc::new(Law::new(contact.table(), contact.temperature()));
        let curve = Curve::new(&law, state.u_rate);
        let spring = Jenkins::new(&Contact::default());
        let extrapolates = contact.extrapolates_table();
        let element = Self { law, curve, extrapolates, state, spring, mode_changes: None };
        element.check_speed(state.u_rate)?;
        element.check_separation(state.w, state.u_rate, false)?;
        Ok(element)
    }

    /// The time reached, s.
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// The carrier's displacements u and w, m.
    pub fn carrier(&self) -> (f64, f64) {
        (self.state.u, self.state.w)
    }

    /// Follows the carrier straight on for `duration` (s) at the rates u̇ and ẇ (m/s).
    ///
    /// # Errors
    /// [`ElementError`] where the carrier leaves the table; the element is then as it was.
    pub fn advance(&mut self, duration: f64, u_rate: f64, w_rate: f64) -> Result<(), ElementError> {
        let ElementState { time, u, w, .. } = self.state;
        let end = Start { time: time + duration, u: u + u_rate * duration, w: w + w_rate * duration, u_rate, w_rate };
        end.check()?;
        self.check_speed(u_rate)?;
        let before = self.curve.speed();
        self.curve.set_speed(&self.law, u_rate);
        let start = self.check_separation(w, u_rate, false);
        if let Err(error) = start.and_then(|()| self.check_separation(end.w, u_rate, true)) {
            self.curve.set_speed(&self.law, before);
            return Err(error);
        }
        self.follow(duration, u_rate, w_rate, end.w);
        let state = &mut self.state;
        (state.u_rate, state.w_rate) = (u_rate, w_rate);
        (state.time, state.u, state.w) = (end.time, end.u, end.w);
        (state.force, state.mode) = (self.spring.force, self.spring.mode.number());
        Ok(())
    }

    fn follow(&mut self, duration: f64, u_rate: f64, w_rate: f64, end: f64) {
        let Self { law, curve, state, spring, mode_changes, .. } = self;
        let mut ledger = Ledger { curve, state, mode_changes, mode: spring.mode };
        let approach = |w: f64| -(law.rest_separation + w);
        let (from, to) = (approach(ledger.state.w), approach(end));
        let here = curve.at(from);
        spring.take_over(&here, from, &mut ledger);
        if from == to {
            return spring.slide(&here, from, u_rate, duration, &mut ledger);
        }
        let rates = Rates { u: u_rate, approach: -w_rate };
        let closer = to > from;
        let mut at = from;
        while at != to {
            let stop = curve.end_of_piece(at, closer);
            let next = if closer { stop.min(to) } else { stop.max(to) };
            spring.cross(curve, at, next, rates, (at - from) / rates.approach, &mut ledger);
            at = next;
        }
    }

    /// Displacement over which a relaxed spring reaches its limit at the present approach, m; 0 without contact.
    pub fn stick_length(&self) -> f64 {
        let contact = self.contact();
        if contact.stiffness.value > 0.0 { contact.limit.value / contact.stiffness.value } else { 0.0 }
    }

    /// The contact at the present approach.
    pub(super) fn contact(&self) -> Contact {
        self.curve.at(-(self.law.rest_separation + self.state.w))
    }

    /// The rates of the last motion.
    pub(super) fn rates(&self) -> Rates {
        Rates { u: self.state.u_rate, approach: -self.state.w_rate }
    }

    fn check_speed(&self, speed: f64) -> Result<(), ElementError> {
        let range = self.law.speed_range;
        if self.extrapolates || speed.abs() <= range.1 * (1.0 + ROUNDING) {
            return Ok(());
        }
        Err(ElementError::Speed { time: self.state.time, speed: speed.abs(), least: range.0, largest: range.1 })
    }

    /// Whether the carrier may be at `w` with the law at the present speed; `within` is the error's.
    fn check_separation(&self, w: f64, speed: f64, within: bool) -> Result<(), ElementError> {
        let (separation, least) = (self.law.rest_separation + w, -self.curve.closest());
        let slack = ROUNDING * (self.curve.closest() - self.curve.touch);
        if self.extrapolates || separation >= least - slack {
            return Ok(());
        }
        Err(ElementError::Pressure {
            time: self.state.time,
            w,
            separation,
            least,
            load: self.law.load,
            largest: self.law.largest_pressure,
            speed: speed.abs(),
            within,
        })
    }

    /// All that changes in the run.
    pub fn save(&self) -> ElementState {
        self.state
    }

    /// A run that continues from `saved`, bit for bit as the run that was saved.
    ///
    /// # Errors
    /// [`RestoreError`] where `saved` is no valid state of a run of this contact.
    pub fn restore(contact: &PointContact, saved: &ElementState) -> Result<Self, RestoreError> {
        saved.check()?;
        let mut element = Self::at(contact, *saved)?;
        let here = element.contact();
        let invalid = |what, value| Err(RestoreError::Invalid { what, value });
        let mode = match Mode::of_number(saved.mode) {
            Some(mode) if mode.in_contact() == (here.stiffness.value > 0.0) => mode,
            _ => return invalid("the mode", f64::from(saved.mode)),
        };
        if saved.force.abs() > here.limit.value * (1.0 + ROUNDING) {
            return invalid("the force in the spring", saved.force);
        }
        element.spring = Jenkins { force: saved.force, stiffness: here.stiffness.value, mode };
        Ok(element)
    }

    /// Keeps a record of mode changes from now on, or stops keeping it.
    pub fn record_mode_changes(&mut self, on: bool) {
        self.mode_changes = on.then(Vec::new);
    }

    /// The mode changes recorded since the last call; the contact as a whole counts as mass 0.
    pub fn take_mode_changes(&mut self) -> Vec<ModeChange> {
        self.mode_changes.as_mut().map(std::mem::take).unwrap_or_default()
    }
}

impl ElementState {
    fn check(&self) -> Result<(), RestoreError> {
        let Self { time, u, w, u_rate, w_rate, force, mode: _, lost, lost_by_channel } = *self;
        let positions = [time, u, w].into_iter().find(|position| !is_possible(*position));
        let others = [u_rate, w_rate, force, lost].into_iter().chain(lost_by_channel).find(|other| !other.is_finite());
        match positions.or(others) {
            Some(value) => Err(RestoreError::Invalid { what: "a number", value }),
            None => Ok(()),
        }
    }
}

/// Adds up the losses of a motion and records its mode changes.
struct Ledger<'a> {
    curve: &'a Curve,
    state: &'a mut ElementState,
    mode_changes: &'a mut Option<Vec<ModeChange>>,
    mode: Mode,
}

impl Listener for Ledger<'_> {
    /// The channels share the loss as in steady sliding at that approach.
    fn lost(&mut self, approach: f64, energy: f64) {
        if energy == 0.0 {
            return;
        }
        self.state.lost += energy;
        let shares = self.curve.channel_shares(approach);
        self.state.lost_by_channel.iter_mut().zip(shares).for_each(|(lost, share)| *lost += share * energy);
    }

    fn changed(&mut self, elapsed: f64, mode: Mode) {
        let before = std::mem::replace(&mut self.mode, mode);
        if let Some(record) = self.mode_changes {
            let time = self.state.time + elapsed;
            record.push(ModeChange { time, mass: 0, from: before.number(), to: mode.number() });
        }
    }
}

impl Curve {
    /// The shares of the channels of [`Quantity::CHANNELS`] in the losses at an approach, m.
    fn channel_shares(&self, approach: f64) -> [f64; 4] {
        let contact = self.at(approach);
        let powers = Quantity::CHANNELS.map(|channel| self.other(channel, &contact).value.max(0.0));
        let sum: f64 = powers.iter().sum();
        powers.map(|power| if sum > 0.0 { power / sum } else { 0.0 })
    }
}
