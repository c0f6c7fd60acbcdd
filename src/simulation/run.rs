//! Everything of a run that changes.

use super::{Motion, OutOfRange, Start};
use crate::contact::CarrierPosition;
use crate::integrator::Rates;
use crate::math::{Numbers, visit_all};
use crate::model::{Carrier, Exchange, Model, State};
use crate::outputs::{Counters, Energies};
use crate::scene::{Path, is_possible};

/// The run: where it stands and what it has added up.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) carrier: Carrier,
    /// Time since the start of the carrier's piece, s.
    pub(super) s: f64,
    pub(super) state: State,
    pub(super) energies: Energies,
    pub(super) counters: Counters,
    /// The length of the next step to try, s.
    pub(super) step_size: f64,
    /// The mean time between the events of late, s; the largest number where there was none.
    pub(super) event_spacing: f64,
    /// Time since the last event, s.
    pub(super) since_event: f64,
    /// ∂F_x/∂u, ∂F_x/∂w, ∂F_z/∂u, ∂F_z/∂w by the targets of the last motion, N/m; 0 before the first.
    pub(super) tangents: [f64; 4],
    /// Whether the integrator's rates at the start of the next step hold.
    pub(super) rates_hold: bool,
    /// u and w at the start of the run, m.
    pub(super) start: [f64; 2],
    /// Whether the time-stepping driver has the run, or the event-driven one.
    pub(super) stepping: bool,
    /// Mode changes on one time step, in the mean of the last ones; of the method *auto* alone.
    pub(super) crowding: f64,
}

impl Run {
    pub(super) fn new(model: &Model, state: State, start: &Start, stepping: bool) -> Self {
        let path = |rate| Path { rate, ..Path::default() };
        let paths = (path(start.u_rate), path(start.w_rate));
        Self {
            carrier: Carrier::new(start.time, (start.u, start.w), paths, &model.profile),
            s: 0.0,
            state,
            energies: Energies::default(),
            counters: Counters::default(),
            step_size: FIRST_STEP / model.stiffest_frequency(),
            event_spacing: f64::MAX,
            since_event: 0.0,
            tangents: [0.0; 4],
            rates_hold: false,
            start: [start.u, start.w],
            stepping,
            crowding: 0.0,
        }
    }

    /// Takes over `other`, a run of the same scene, without allocating.
    pub(super) fn copy_from(&mut self, other: &Self) {
        let Self {
            carrier,
            s,
            state,
            energies,
            counters,
            step_size,
            event_spacing,
            since_event,
            tangents,
            rates_hold,
            start,
            stepping,
            crowding,
        } = self;
        (*carrier, *s, *energies, *counters) = (other.carrier, other.s, other.energies, other.counters);
        (*event_spacing, *since_event) = (other.event_spacing, other.since_event);
        (*step_size, *tangents, *rates_hold) = (other.step_size, other.tangents, other.rates_hold);
        *start = other.start;
        (*stepping, *crowding) = (other.stepping, other.crowding);
        state.copy_from(&other.state);
    }

    /// Notes that an event has come.
    pub(super) fn note_event(&mut self) {
        // A mean from long ago counts no more than the latest.
        let mean = self.event_spacing.min(self.since_event / SPACING_GAIN);
        let latest = mean + SPACING_GAIN * (self.since_event - mean);
        self.event_spacing = latest.max(LEAST_SPACING * self.step_size);
        self.since_event = 0.0;
    }

    pub(super) fn time(&self) -> f64 {
        self.carrier.time + self.s
    }

    /// u and w, m.
    pub(super) fn displacement(&self) -> (f64, f64) {
        let point = self.carrier.at(self.s);
        (self.carrier.u + point.du, self.carrier.w + point.dw)
    }

    pub(super) fn carrier_position(&self) -> CarrierPosition {
        let point = self.carrier.at(self.s);
        CarrierPosition { profile_position: self.carrier.profile_position + point.du, w: self.carrier.w + point.dw }
    }
}

/// The first step to try, as a share of the stiffest period over 2π; the error test corrects it at once.
const FIRST_STEP: f64 = 0.1;

/// The weight of the latest in the mean time between events.
const SPACING_GAIN: f64 = 0.3;

/// The least that this mean falls to, as a share of the step that the error allows: many events at one instant say
/// nothing of what comes.
const LEAST_SPACING: f64 = 0.01;

/// The run as it was before the motion under way.
#[derive(Clone, Debug)]
pub(super) struct Checkpoint {
    pub(super) run: Run,
    pub(super) rates: Rates,
    pub(super) exchange: Exchange,
}

/// All but the modes, the counts, whether the rates hold and which driver has the run.
impl Numbers for Run {
    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        let Self {
            carrier,
            s,
            state,
            energies,
            counters,
            step_size,
            event_spacing,
            since_event,
            tangents,
            rates_hold: _,
            start,
            stepping: _,
            crowding,
        } = self;
        visit_all([carrier, s, state, energies, counters], visit);
        visit_all([step_size, event_spacing, since_event, tangents, start, crowding], visit);
    }
}

impl Numbers for Checkpoint {
    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        let Self { run, rates, exchange } = self;
        visit_all([run, rates, exchange], visit);
    }
}

impl Start {
    /// Refuses where no run can be.
    pub(crate) fn check(&self) -> Result<(), OutOfRange> {
        let quantities =
            [("time", self.time), ("u", self.u), ("w", self.w), ("rate of u", self.u_rate), ("rate of w", self.w_rate)];
        check_size(&quantities)
    }
}

impl Motion {
    pub(super) fn check(&self) -> Result<(), OutOfRange> {
        let quantities = [
            ("duration", self.duration),
            ("rate of u", self.u.rate),
            ("amplitude of u", self.u.amplitude),
            ("frequency of u", self.u.frequency),
            ("rate of w", self.w.rate),
            ("amplitude of w", self.w.amplitude),
            ("frequency of w", self.w.frequency),
        ];
        check_size(&quantities)
    }
}

fn check_size(quantities: &[(&'static str, f64)]) -> Result<(), OutOfRange> {
    match quantities.iter().find(|(_, value)| !is_possible(*value)) {
        Some(&(what, value)) => Err(OutOfRange { what, value }),
        None => Ok(()),
    }
}
