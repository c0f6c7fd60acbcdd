//! A run of an element: its state, its motion, its outputs.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::grid::Load;
use super::jenkins::{Jenkins, MotionRates, MotionRecorder};
use super::law::{ElementContact, Law, LawAtSpeed};
use super::limits::ROUNDING;
use super::point_contact::{OutputTerms, PointContact, element_output};
use super::quantity::Quantity;
use crate::math::{Expansion, not_finite};
use crate::model::Mode;
use crate::outputs::Variable;
use crate::scene::{TableExtrapolation, is_possible};
use crate::simulation::{ModeChange, OutOfRange, Start};

/// Why a motion of an element is refused; the element is then as it was.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ElementError {
    /// The carrier's motion is out of range, whatever the table.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// The carrier comes closer than the table goes.
    #[error(
        "w = {w} m at t = {time} s is a separation of {separation} m, a {} above {largest} {}, where the table ends: at {speed} m/s its \
         separations go down to {least} m (table.extrapolation = \"hold\" extrapolates)",
        .load.name(), .load.unit()
    )]
    Pressure {
        /// When, s.
        time: f64,
        /// Where the carrier would be, m.
        w: f64,
        /// The separation there, m.
        separation: f64,
        /// The least separation of the table at this speed, m.
        least: f64,
        /// What the table's loads are.
        load: Load,
        /// The largest load of the table, Pa or N.
        largest: f64,
        /// The speed, m/s.
        speed: f64,
        /// Whether the carrier comes there within the step: a shorter one may end before.
        within: bool,
    },
    /// The carrier is faster than the table goes.
    #[error(
        "the speed is {speed} m/s at t = {time} s: the table goes from {least} to {largest} m/s (table.extrapolation = \"hold\" \
         extrapolates)"
    )]
    Speed {
        /// When, s.
        time: f64,
        /// The speed, m/s.
        speed: f64,
        /// The least speed of the table, m/s.
        least: f64,
        /// The largest speed of the table, m/s.
        largest: f64,
    },
}

/// Why a run cannot be continued from a saved state.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ElementRestoreError {
    /// A number that is not valid in any run.
    #[error("invalid state: {what} = {value}")]
    Invalid {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The carrier is beyond the table.
    #[error(transparent)]
    BeyondTable(#[from] ElementError),
}

/// Where in a step a position of the carrier is checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CheckedAt {
    Start,
    End,
}

/// All that changes in a run, SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ElementState {
    time: f64,
    u: f64,
    w: f64,
    u_rate: f64,
    w_rate: f64,
    /// The force in the spring, G = -F_x, N.
    force: f64,
    /// As [`Mode::number`] gives it.
    mode: i8,
    /// Lost since the start, J.
    lost: f64,
    /// Energy lost since the start by channel, J.
    lost_by_channel: [f64; 4],
}

/// A run of an element, as a [`Simulation`](crate::simulation::Simulation) is that of a layer.
///
/// A clone continues as the original does, bit for bit.
#[derive(Clone, Debug)]
pub struct Element {
    law: Arc<Law>,
    /// The law at the present speed.
    pub(super) curve: LawAtSpeed,
    /// The law at the speed before: a step that is refused or repeated goes back to it.
    curve_before: LawAtSpeed,
    table_extrapolation: TableExtrapolation,
    damping: f64,
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
        let curve = LawAtSpeed::new(&law, state.u_rate);
        let spring = Jenkins::new(&ElementContact::default());
        let table_extrapolation = contact.table_extrapolation();
        let curve_before = curve.clone();
        let damping = contact.damping();
        let element =
            Self { law, curve, curve_before, table_extrapolation, damping, state, spring, mode_changes: None };
        element.check_speed(state.u_rate)?;
        element.check_separation(state.w, state.u_rate, CheckedAt::Start)?;
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
        let end = Start {
            time: time + duration,
            u: u + u_rate * duration,
            w: w + w_rate * duration,
            u_rate,
            w_rate,
            ..Start::default()
        };
        end.check()?;
        self.check_speed(u_rate)?;
        self.set_speed(u_rate);
        let start = self.check_separation(w, u_rate, CheckedAt::Start);
        if let Err(error) = start.and_then(|()| self.check_separation(end.w, u_rate, CheckedAt::End)) {
            self.set_speed(self.state.u_rate);
            return Err(error);
        }
        self.follow(duration, u_rate, w_rate, end.w);
        let state = &mut self.state;
        (state.u_rate, state.w_rate) = (u_rate, w_rate);
        (state.time, state.u, state.w) = (end.time, end.u, end.w);
        (state.force, state.mode) = (self.spring.force, self.spring.mode.number());
        Ok(())
    }

    /// Takes the spring along with the carrier, which moves to `end` (m) along z.
    fn follow(&mut self, duration: f64, u_rate: f64, w_rate: f64, end: f64) {
        let Self { law, curve, state, spring, mode_changes, damping, .. } = self;
        let mut ledger = Ledger { curve, state, mode_changes, mode: spring.mode };
        let approach = |w: f64| -(law.rest_separation + w);
        let (from, to) = (approach(ledger.state.w), approach(end));
        let here = curve.at(from);
        spring.set_law(&here, from, &mut ledger);
        if from == to {
            if *damping > 0.0 {
                ledger.record_loss(from, spring.damper_loss([&here; 2], u_rate, duration, *damping));
            }
            return spring.slide(&here, from, u_rate, duration, &mut ledger);
        }
        let rates = MotionRates { u: u_rate, approach: -w_rate };
        let mut at = from;
        while at != to {
            let end = curve.end_of_segment(at, to);
            let next = if to > at { end.min(to) } else { end.max(to) };
            if *damping > 0.0 {
                let (contacts, time) = ([&curve.at(at), &curve.at(next)], (next - at) / rates.approach);
                ledger.record_loss(next, spring.damper_loss(contacts, u_rate, time, *damping));
            }
            spring.change_approach(curve, at, next, rates, (at - from) / rates.approach, &mut ledger);
            at = next;
        }
    }

    /// Displacement over which a relaxed spring reaches its limit at the present approach, m; 0 without contact.
    pub fn stick_length(&self) -> f64 {
        let contact = self.contact();
        if contact.stiffness.value > 0.0 { contact.limit.value / contact.stiffness.value } else { 0.0 }
    }

    /// The contact at the present approach.
    pub(super) fn contact(&self) -> ElementContact {
        self.curve.at(-(self.law.rest_separation + self.state.w))
    }

    /// The rates of the last motion.
    pub(super) fn rates(&self) -> MotionRates {
        MotionRates { u: self.state.u_rate, approach: -self.state.w_rate }
    }

    fn check_speed(&self, speed: f64) -> Result<(), ElementError> {
        let range = self.law.speed_range;
        if self.table_extrapolation == TableExtrapolation::Hold || speed.abs() <= range.1 * (1.0 + ROUNDING) {
            return Ok(());
        }
        Err(ElementError::Speed { time: self.state.time, speed: speed.abs(), least: range.0, largest: range.1 })
    }

    /// Refuses a position `w` (m) of the carrier, at the start or the end of a step at the present speed, that is
    /// beyond the table.
    fn check_separation(&self, w: f64, speed: f64, when: CheckedAt) -> Result<(), ElementError> {
        let (separation, least) = (self.law.rest_separation + w, -self.curve.closest());
        let slack = ROUNDING * (self.curve.closest() - self.curve.touch);
        if self.table_extrapolation == TableExtrapolation::Hold || separation >= least - slack {
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
            within: when == CheckedAt::End,
        })
    }

    /// Writes the values of `variables`, in their order, into `values`; 0 for one that an element does not have.
    pub fn evaluate(&self, variables: &[Variable], values: &mut [f64]) {
        let now = self.terms(&self.contact());
        for (variable, value) in variables.iter().zip(values) {
            *value = element_output(variable.output).map_or(0.0, |output| (output.value)(now));
        }
    }

    fn terms(&self, contact: &ElementContact) -> OutputTerms {
        OutputTerms {
            force: self.force(contact),
            normal: contact.normal.value,
            power: self.power(contact) + (self.force(contact) - self.spring.force) * self.state.u_rate,
            hysteresis: self.hysteresis_share(contact).value,
            contact_ratio: self.contact_ratio(contact).value,
            lost: self.state.lost,
            lost_by_channel: self.state.lost_by_channel,
        }
    }

    /// The force on the ground along x, with the damper's part, N.
    fn force(&self, contact: &ElementContact) -> f64 {
        self.spring.damped_force(contact, self.state.u_rate, self.damping)
    }

    /// Writes into `values` how `variables` change as the carrier moves along x and z by `direction` (m per unit), the
    /// modes held.
    ///
    /// The force of a sticking spring follows u with the stiffness. Where w decreases the stiffness, the force
    /// decreases in proportion, else it stays.
    pub fn directional_derivative(&self, variables: &[Variable], direction: (f64, f64), values: &mut [f64]) {
        let contact = self.contact();
        let (now, change) = (self.terms(&contact), self.change(&contact, direction.0, direction.1));
        for (variable, value) in variables.iter().zip(values) {
            *value = element_output(variable.output).map_or(0.0, |output| (output.change)(change, now));
        }
    }

    /// Ḟ_x and Ḟ_z, N/s, at the rates of the last motion.
    pub fn force_rates(&self) -> (f64, f64) {
        let MotionRates { u, approach } = self.rates();
        let change = self.change(&self.contact(), u, -approach);
        (-change.force, change.normal)
    }

    /// How the terms change as the carrier moves by du and dw (m).
    fn change(&self, contact: &ElementContact, du: f64, dw: f64) -> OutputTerms {
        let da = -dw;
        let of_spring = self.force_change(contact, du, da);
        // The damper's part follows the stiffness; at the limit the sum does.
        let viscous = self.damping * self.rates().u;
        let force = if (self.spring.force + viscous * contact.stiffness.value).abs() < contact.limit.value {
            of_spring + viscous * contact.stiffness.slope * da
        } else if viscous != 0.0 {
            self.force(contact).signum() * contact.limit.slope * da
        } else {
            of_spring
        };
        OutputTerms {
            force,
            normal: contact.normal.slope * da,
            power: self.power_change(contact, of_spring, da) + (force - of_spring) * self.rates().u,
            hysteresis: self.hysteresis_share(contact).slope * da,
            contact_ratio: self.contact_ratio(contact).slope * da,
            ..OutputTerms::default()
        }
    }

    fn force_change(&self, contact: &ElementContact, du: f64, da: f64) -> f64 {
        let k = contact.stiffness;
        if k.value <= 0.0 {
            0.0
        } else if self.spring.mode.slips() {
            self.spring.mode.direction() * contact.limit.slope * da
        } else {
            k.value * du + self.spring.force * (k.slope * da / k.value).min(0.0)
        }
    }

    /// Power lost, W: G u̇ - V̇ with V = G²/(2K), so ½ (G/K)² |K̇| while the spring sticks.
    fn power(&self, contact: &ElementContact) -> f64 {
        let (k, l, rates, force) = (contact.stiffness, contact.limit, self.rates(), self.spring.force);
        if k.value <= 0.0 {
            0.0
        } else if self.spring.mode.slips() {
            let stored = (l.slope - l.value * k.slope / (2.0 * k.value)) * l.value / k.value;
            force.signum() * l.value * rates.u - stored * rates.approach
        } else {
            (force / k.value).powi(2) / 2.0 * (k.slope * rates.approach).abs()
        }
    }

    fn power_change(&self, contact: &ElementContact, force_change: f64, da: f64) -> f64 {
        let (k, l, rates, force) = (contact.stiffness, contact.limit, self.rates(), self.spring.force);
        if k.value <= 0.0 {
            0.0
        } else if self.spring.mode.slips() {
            let (share, k_share) = (l.value / k.value, k.slope / k.value);
            let stored = (l.slope * l.slope + l.value * l.curvature) / k.value - 2.0 * share * l.slope * k_share
                + share * share * (k_share * k.slope - k.curvature / 2.0);
            (force.signum() * l.slope * rates.u - stored * rates.approach) * da
        } else {
            let q = force / k.value;
            let speed = rates.approach.abs();
            let by_force = q / k.value * force_change * k.slope.abs();
            let by_stiffness = k.slope.signum() * k.curvature / 2.0 - k.slope.abs() * k.slope / k.value;
            speed * (by_force + q * q * by_stiffness * da)
        }
    }

    /// Hysteresis over friction coefficient; 0 where there is no friction.
    fn hysteresis_share(&self, contact: &ElementContact) -> Expansion {
        let [part, whole] =
            [Quantity::Hysteresis, Quantity::Friction].map(|quantity| self.curve.other(quantity, contact));
        if whole.value <= 0.0 {
            return Expansion::default();
        }
        let value = part.value / whole.value;
        Expansion { value, slope: (part.slope - value * whole.slope) / whole.value, curvature: 0.0 }
    }

    fn contact_ratio(&self, contact: &ElementContact) -> Expansion {
        let at_table = self.curve.other(Quantity::ContactRatio, contact);
        at_table.times(self.curve.share_of_least(contact))
    }

    /// All that changes in the run.
    pub fn save(&self) -> ElementState {
        self.state
    }

    /// A run that continues from `saved`, bit for bit as the run that was saved.
    ///
    /// # Errors
    /// [`ElementRestoreError`] where `saved` is no valid state of a run of this contact.
    pub fn restore(contact: &PointContact, saved: &ElementState) -> Result<Self, ElementRestoreError> {
        saved.check()?;
        let mut element = Self::at(contact, *saved)?;
        let here = element.contact();
        let invalid = |what, value| Err(ElementRestoreError::Invalid { what, value });
        let mode = match Mode::from_number(saved.mode) {
            Some(mode) if mode.in_contact() == (here.stiffness.value > 0.0) => mode,
            _ => return invalid("the mode", f64::from(saved.mode)),
        };
        if saved.force.abs() > here.limit.value * (1.0 + ROUNDING) {
            return invalid("the force in the spring", saved.force);
        }
        element.spring = Jenkins { force: saved.force, stiffness: here.stiffness.value, mode };
        Ok(element)
    }

    /// Continues from `saved`, a state of the same contact that a run has saved or that was checked when it was read;
    /// allocates nothing.
    pub fn continue_from(&mut self, saved: &ElementState) {
        self.set_speed(saved.u_rate);
        self.state = *saved;
        let stiffness = self.contact().stiffness.value;
        let mode = Mode::from_number(saved.mode).unwrap_or(self.spring.mode);
        self.spring = Jenkins { force: saved.force, stiffness, mode };
    }

    /// Takes the law at another speed, m/s; that of the speed before it is kept.
    fn set_speed(&mut self, speed: f64) {
        if !self.curve.is_at(&self.law, speed) {
            std::mem::swap(&mut self.curve, &mut self.curve_before);
            self.curve.set_speed(&self.law, speed);
        }
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
    fn check(&self) -> Result<(), ElementRestoreError> {
        let positions = [("time", self.time), ("u", self.u), ("w", self.w)];
        match not_finite(self).or_else(|| positions.into_iter().find(|(_, position)| !is_possible(*position))) {
            Some((what, value)) => Err(ElementRestoreError::Invalid { what, value }),
            None => Ok(()),
        }
    }
}

/// Adds up the losses of a motion and records its mode changes.
struct Ledger<'a> {
    curve: &'a LawAtSpeed,
    state: &'a mut ElementState,
    mode_changes: &'a mut Option<Vec<ModeChange>>,
    mode: Mode,
}

impl MotionRecorder for Ledger<'_> {
    /// The channels share the loss as in steady sliding at that approach.
    fn record_loss(&mut self, approach: f64, energy: f64) {
        if energy == 0.0 {
            return;
        }
        self.state.lost += energy;
        let shares = self.curve.channel_shares(approach);
        self.state.lost_by_channel.iter_mut().zip(shares).for_each(|(lost, share)| *lost += share * energy);
    }

    fn record_mode(&mut self, elapsed: f64, mode: Mode) {
        let before = std::mem::replace(&mut self.mode, mode);
        if let Some(record) = self.mode_changes {
            let time = self.state.time + elapsed;
            record.push(ModeChange { time, mass: 0, from: before.number(), to: mode.number() });
        }
    }
}

impl LawAtSpeed {
    /// The shares of the channels of [`Quantity::CHANNELS`] in the losses at an approach, m.
    fn channel_shares(&self, approach: f64) -> [f64; 4] {
        let contact = self.at(approach);
        let powers = Quantity::CHANNELS.map(|channel| self.other(channel, &contact).value.max(0.0));
        let sum: f64 = powers.iter().sum();
        powers.map(|power| if sum > 0.0 { power / sum } else { 0.0 })
    }
}
