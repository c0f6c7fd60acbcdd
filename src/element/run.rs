//! A run of an element.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::PointContact;
use super::error::{ElementError, RestoreError};
use super::jenkins::{Jenkins, Listener, Rates};
use super::law::{Contact, Curve, Law};
use super::table::Quantity;
use crate::model::Mode;
use crate::scene::is_possible;
use crate::simulation::{ModeChange, Start};

/// Share of the speeds and separations of the table by which the carrier may be beyond: the rounding of a master that
/// goes to the very end.
const ROUNDING: f64 = 1e-9;

/// What changes in a run, SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Saved {
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

/// A run of an element: as a layer's [`Simulation`](crate::simulation::Simulation), but looked up in the table.
///
/// A clone is the whole of it: both go on alike, bit for bit.
#[derive(Clone, Debug)]
pub struct Element {
    law: Arc<Law>,
    /// The law at the present speed.
    pub(super) curve: Curve,
    /// Whether the carrier may go beyond the table.
    goes_beyond: bool,
    pub(super) state: Saved,
    pub(super) spring: Jenkins,
    mode_changes: Option<Vec<ModeChange>>,
}

impl Element {
    /// An element under the carrier, its spring relaxed.
    ///
    /// # Errors
    /// [`ElementError`] where the table does not go.
    pub fn new(contact: &PointContact, start: &Start) -> Result<Self, ElementError> {
        start.check()?;
        let state = Saved {
            time: start.time,
            u: start.u,
            w: start.w,
            u_rate: start.u_rate,
            w_rate: start.w_rate,
            ..Saved::default()
        };
        let mut element = Self::standing(contact, state)?;
        element.spring = Jenkins::new(&element.contact());
        element.state.mode = element.spring.mode.number();
        Ok(element)
    }

    /// An element whose spring is still to be told.
    fn standing(contact: &PointContact, state: Saved) -> Result<Self, ElementError> {
        let law = Arc::new(Law::new(contact.table(), contact.temperature()));
        let curve = Curve::new(&law, state.u_rate);
        let spring = Jenkins::new(&Contact::default());
        let goes_beyond = contact.goes_beyond();
        let element = Self { law, curve, goes_beyond, state, spring, mode_changes: None };
        element.check_speed(state.u_rate)?;
        element.check_separation((state.w, state.u_rate), false)?;
        Ok(element)
    }

    /// The time reached, s.
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// Where the carrier stands: u and w, m.
    pub fn carrier(&self) -> (f64, f64) {
        (self.state.u, self.state.w)
    }

    /// Follows the carrier straight on for `duration` (s) at the rates u̇ and ẇ (m/s).
    ///
    /// # Errors
    /// [`ElementError`] where the table does not go; the element is then as it was.
    pub fn advance(&mut self, duration: f64, (u_rate, w_rate): (f64, f64)) -> Result<(), ElementError> {
        let Saved { time, u, w, .. } = self.state;
        let end = Start { time: time + duration, u: u + u_rate * duration, w: w + w_rate * duration, u_rate, w_rate };
        end.check()?;
        self.check_speed(u_rate)?;
        let before = self.curve.speed();
        self.curve.set_speed(&self.law, u_rate);
        let room = self.check_separation((w, u_rate), false);
        if let Err(error) = room.and_then(|()| self.check_separation((end.w, u_rate), true)) {
            self.curve.set_speed(&self.law, before);
            return Err(error);
        }
        self.follow(duration, (u_rate, w_rate), end.w);
        let state = &mut self.state;
        (state.u_rate, state.w_rate) = (u_rate, w_rate);
        (state.time, state.u, state.w) = (end.time, end.u, end.w);
        (state.force, state.mode) = (self.spring.force, self.spring.mode.number());
        Ok(())
    }

    fn follow(&mut self, duration: f64, (u_rate, w_rate): (f64, f64), end: f64) {
        let Self { law, curve, state, spring, mode_changes, .. } = self;
        let mut ledger = Ledger { curve, state, mode_changes, mode: spring.mode };
        let approach = |w: f64| -(law.rest_separation + w);
        let (from, to) = (approach(ledger.state.w), approach(end));
        let here = curve.at(from);
        spring.take_over(&here, from, &mut ledger);
        if from == to {
            return spring.slide(&here, (from, u_rate), duration, &mut ledger);
        }
        let rates = Rates { u: u_rate, approach: -w_rate };
        let closer = to > from;
        let mut at = from;
        while at != to {
            let stop = curve.end_of_piece(at, closer);
            let next = if closer { stop.min(to) } else { stop.max(to) };
            spring.cross(curve, (at, next), (rates, (at - from) / rates.approach), &mut ledger);
            at = next;
        }
    }

    /// The way over which the spring goes from nothing to its limit where the run stands, m; 0 without contact.
    pub fn slip_way(&self) -> f64 {
        let contact = self.contact();
        if contact.stiffness.value > 0.0 { contact.limit.value / contact.stiffness.value } else { 0.0 }
    }

    /// What the contact bears where the run stands.
    pub(super) fn contact(&self) -> Contact {
        self.curve.at(-(self.law.rest_separation + self.state.w))
    }

    /// The rates of the last motion.
    pub(super) fn rates(&self) -> Rates {
        Rates { u: self.state.u_rate, approach: -self.state.w_rate }
    }

    fn check_speed(&self, speed: f64) -> Result<(), ElementError> {
        let range = self.law.speed_range;
        if self.goes_beyond || speed.abs() <= range.1 * (1.0 + ROUNDING) {
            return Ok(());
        }
        Err(ElementError::Speed { time: self.state.time, speed: speed.abs(), range })
    }

    /// Whether the carrier may be at `w` with the law at the present speed.
    fn check_separation(&self, (w, speed): (f64, f64), within: bool) -> Result<(), ElementError> {
        let (separation, least) = (self.law.rest_separation + w, -self.curve.closest());
        let slack = ROUNDING * (self.curve.closest() - self.curve.touch);
        if self.goes_beyond || separation >= least - slack {
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

    /// Everything that the run has become.
    pub fn save(&self) -> Saved {
        self.state
    }

    /// A run that goes on from `saved`, bit for bit as the run that was saved.
    ///
    /// # Errors
    /// [`RestoreError`] where no run of this contact gets there.
    pub fn restore(contact: &PointContact, saved: &Saved) -> Result<Self, RestoreError> {
        saved.check()?;
        let mut element = Self::standing(contact, *saved)?;
        let here = element.contact();
        let number = |what, value| Err(RestoreError::Number { what, value });
        let mode = match Mode::of_number(saved.mode) {
            Some(mode) if mode.in_contact() == (here.stiffness.value > 0.0) => mode,
            _ => return number("the mode", f64::from(saved.mode)),
        };
        if saved.force.abs() > here.limit.value * (1.0 + ROUNDING) {
            return number("the force in the spring", saved.force);
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

impl Saved {
    fn check(&self) -> Result<(), RestoreError> {
        let Self { time, u, w, u_rate, w_rate, force, mode: _, lost, lost_by_channel } = *self;
        let places = [time, u, w].into_iter().find(|place| !is_possible(*place));
        let others = [u_rate, w_rate, force, lost].into_iter().chain(lost_by_channel).find(|other| !other.is_finite());
        match places.or(others) {
            Some(value) => Err(RestoreError::Number { what: "a number", value }),
            None => Ok(()),
        }
    }
}

/// Adds up what a motion costs and records its turns.
struct Ledger<'a> {
    curve: &'a Curve,
    state: &'a mut Saved,
    mode_changes: &'a mut Option<Vec<ModeChange>>,
    mode: Mode,
}

impl Listener for Ledger<'_> {
    /// By channel in the shares that they have in steady sliding there.
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
    /// The shares of the channels of [`Quantity::CHANNELS`] in what is lost at an approach, m.
    fn channel_shares(&self, approach: f64) -> [f64; 4] {
        let contact = self.at(approach);
        let powers = Quantity::CHANNELS.map(|channel| self.other(channel, &contact).value.max(0.0));
        let sum: f64 = powers.iter().sum();
        powers.map(|power| if sum > 0.0 { power / sum } else { 0.0 })
    }
}
