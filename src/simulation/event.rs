//! The event-driven method: the modes are held through a step, and its mode changes are located on the dense output. Where
//! windows take them (`windows`) the step goes on; where not it ends at the first.

use super::driver::{AFTER_FAILURE, StepBounds, TrialStep, WorkLimit};
use super::motion::SimulationError;
use super::run::{Run, Settings};
use crate::contact::{EventTolerance, first_event, is_due, longest_unstable};
use crate::integrator::{ContactModes, DenseOutput, ErrorEstimate, Motions};

/// A new step is this share of what the error estimate allows, so that few are rejected.
const SAFETY: f64 = 0.9;
/// The least and the most by which one step differs from the one before.
const GROWTH: (f64, f64) = (0.2, 5.0);
/// The largest error over the tolerance with which a step of a wide layer is accepted. New steps aim at 0.6 to 0.7 of the
/// tolerance: where mode changes make some of them err more, that costs less than to try these again.
///
/// Recommended 1 to 2. With 3, errors of whole runs grow.
const MAX_ERROR_IN_WIDE_LAYERS: f64 = 2.0;
/// The least share of a step at which it is cut at an event; where there is less, the step is tried again, shorter.
///
/// A mass that a large friction stops in so small a share is thrown back that many times as fast by the rest of the
/// step, and the energies up to the event would be the difference of powers as many times squared: with 1e-6 they keep
/// some digits.
const MIN_SHARE: f64 = 1e-6;
/// The longest step, as a multiple of the mean time between events: a longer one would be cut, after a search through
/// all of it.
///
/// Recommended 4 to 10: shorter ones end before there is an event, longer ones are less accurate where they are cut.
const OF_SPACING: f64 = 8.0;
/// Steps up to this multiple of the shortest are not shortened for the sake of energies: what friction or a damper does
/// in less than the resolution of time is over within it.
const RESOLVED: f64 = 5.0;
/// The longest step after one that its windows cut short, as a multiple of the part that was kept.
///
/// Recommended 1 to 3.
const AFTER_CUT: f64 = 1.5;
/// Share of a sine's amplitude by which the dense output may be off it with a quarter of the period in a step.
const UNSEEN: f64 = 2e-2;
/// Cuts of one step at events after which each further cut leaves at most half of it. By rounding, an event can be found
/// at the very end of the shortened step again and again.
pub(super) const MAX_CUTS: u32 = 50;

/// An event-driven step that was tried and not rejected.
#[derive(Clone, Copy, Debug)]
pub(super) struct GoodStep {
    /// Its error over the tolerance.
    error: f64,
    /// The longest next one, s, that lets unstable contacts move away; the largest number where any error is good.
    longest: f64,
}

impl Run {
    /// Tries steps until one is good up to its first event.
    pub(super) fn next_event_driven_step(
        &mut self,
        bounds: &StepBounds,
        work: &mut WorkLimit,
    ) -> Result<TrialStep, SimulationError> {
        let limit = bounds.longest.min(OF_SPACING * self.state.event_spacing);
        // What follows an event or a kink is likely to be as fast as what followed the one before.
        let starts_anew = self.state.since_event == 0.0 || self.state.s == 0.0;
        let first = if starts_anew { limit.min(self.state.step_after_event) } else { limit };
        let shortest_cut = self.workspace.stall.shortest_cut(bounds.shortest, self.state.counters.events);
        let mut h = bounds.fit(self.state.step_size.min(first));
        let mut cuts = 0;
        // The step that an event cuts short says how long the next may be; the shorter ones need no error test.
        let mut proposal = None;
        loop {
            self.count_work(work)?;
            let any_error = proposal.is_some() && self.shorter_is_no_worse();
            let resolvable = h > RESOLVED * bounds.shortest;
            let Some(tried) = self.try_event_driven_step(h, any_error, resolvable) else {
                if h <= bounds.shortest {
                    return Err(self.step_too_small(h));
                }
                h = self.state.step_size;
                continue;
            };
            let limit = bounds.remaining.min(limit);
            let proposed = *proposal.get_or_insert_with(|| self.propose(h, limit, &tried, starts_anew));
            let in_windows = h > shortest_cut && self.plan_windows(h, MIN_SHARE.max(shortest_cut / h));
            let share = if in_windows { 1.0 } else { self.share_before_event(h, shortest_cut) };
            if share >= 1.0 || (share >= MIN_SHARE && self.can_resume_within(h, share)) {
                self.state.step_size = proposed;
                self.workspace.stall.record_step(share * h, cuts > 0, self.state.counters.events);
                return Ok(TrialStep { h, share });
            }
            cuts += 1;
            h *= if cuts > MAX_CUTS { share.min(0.5) } else { share };
        }
    }

    /// Tries a step of length `h`; `None` where it is rejected: the run's step size is then a better length. Energies do not
    /// count unless what changes them is `resolvable` by a shorter step.
    pub(super) fn try_event_driven_step(&mut self, h: f64, any_error: bool, resolvable: bool) -> Option<GoodStep> {
        self.discard_windows();
        let Self { model, settings, state, workspace, .. } = self;
        workspace.interpolated_at = None;
        let start = (&**model, &state.layer, &state.carrier);
        let attempt = workspace.integrator.attempt(ContactModes::Held, start, state.span(h), &settings.tolerance);
        self.trace_bodies(h);
        let of_step = |attempt: ErrorEstimate| if resolvable { attempt.error } else { attempt.motion_error };
        let mut error = attempt.map_or(f64::NAN, of_step);
        let mut allowed = self.allowed_error();
        if attempt.is_ok_and(|attempt| attempt.carrier_error > error.max(1.0)) && self.may_touch(h) {
            error = attempt.map_or(error, |attempt| attempt.carrier_error);
            allowed = 1.0;
        }
        let good = |longest| attempt.ok().map(|attempt| GoodStep { error: attempt.error, longest });
        if any_error && error.is_finite() {
            return good(f64::MAX);
        }
        let longest = self.longest_unstable();
        if error <= allowed && h <= longest {
            return good(longest);
        }
        self.state.counters.rejected += 1;
        self.state.step_size = if error.is_finite() {
            (h * growth(self.order(), error).min(SAFETY)).min(longest)
        } else {
            AFTER_FAILURE * h
        };
        None
    }

    /// The largest error over the tolerance with which a step is accepted.
    fn allowed_error(&self) -> f64 {
        let may_open_windows = self.workspace.may_open_windows && self.workspace.windows.is_some();
        let in_wide_layer = may_open_windows || self.settings.is_of_window;
        if in_wide_layer { MAX_ERROR_IN_WIDE_LAYERS } else { 1.0 }
    }

    /// The length of the next step after a good one of length `h`. One that was cut short to `limit` by the end of a
    /// piece or by the events says nothing; one that `starts_anew` says how long the first after the next event may be.
    fn propose(&mut self, h: f64, limit: f64, tried: &GoodStep, starts_anew: bool) -> f64 {
        let grown = h * growth(self.order(), tried.error);
        if starts_anew {
            self.state.step_after_event = grown;
        }
        let next = if h < limit { grown } else { grown.max(self.state.step_size) };
        next.min(tried.longest)
    }

    /// The share of the step of length `h` tried last that lies before its first event, 1 where there is none. A cut
    /// leaves `shortest_cut` (s) or more of it.
    fn share_before_event(&mut self, h: f64, shortest_cut: f64) -> f64 {
        let event = if h > shortest_cut { self.first_event(h) } else { None };
        event.map_or(1.0, |theta| theta.max(shortest_cut / h))
    }

    /// The longest step, s, that lets unstable contacts move away, as they are at the end of the step tried last.
    fn longest_unstable(&self) -> f64 {
        let integrator = &self.workspace.integrator;
        longest_unstable(&self.model, &self.state.layer.state, integrator.end(), integrator.end_forces())
    }

    /// Whether a free mass may have reached the profile in the step of length `h` tried last, which did not see all of
    /// the carrier's motion.
    fn may_touch(&self, h: f64) -> bool {
        let dense = self.dense_output(h);
        let reach = self.model.profile.bounds().z_max + UNSEEN * self.state.carrier.amplitude_w();
        let (motions, modes) = (Motions::new(&dense), &self.state.layer.state.mode);
        (0..modes.len()).any(|i| !modes[i].in_contact() && motions.height(i).range().0 <= reach)
    }

    /// The fraction of the step of length `h` tried last at which a mode change is due.
    fn first_event(&mut self, h: f64) -> Option<f64> {
        let events = self.event_tolerance();
        let Self { model, state, workspace, .. } = self;
        let integrator = &workspace.integrator;
        let dense = integrator.dense(model, &state.carrier, &state.layer.state, state.span(h));
        first_event(&dense, &events, &mut workspace.dense)
    }

    /// The order of the scheme of its event-driven steps.
    fn order(&self) -> i32 {
        self.workspace.integrator.event_driven().tableau().embedded_order + 1
    }

    pub(super) fn event_tolerance(&self) -> EventTolerance {
        let Settings { tolerance, events, .. } = &self.settings;
        events.within(self.state.layer.largest.allowed_of_mass(&self.model, tolerance))
    }

    /// The dense output of the step of length `h` tried last.
    pub(super) fn dense_output(&self, h: f64) -> DenseOutput<'_> {
        let state = &self.state;
        self.workspace.integrator.dense(&self.model, &state.carrier, &state.layer.state, state.span(h))
    }

    /// Accepts a step, which ends at the time `end` of the piece, and changes the modes if that is due.
    pub(super) fn accept_event_driven_step(&mut self, step: &TrialStep, end: f64) {
        let TrialStep { h, share } = *step;
        if self.settings.accounts.energy {
            let Self { model, state, workspace, .. } = self;
            let start = (&**model, &state.carrier, &state.layer.state);
            let gain = workspace.integrator.energies(start, state.span(h), share);
            state.energies.channels.add(&gain);
        }
        let in_windows = self.energies_of_windows(end);
        self.state.energies.gain(&in_windows);
        self.state.counters.steps += 1;
        self.state.since_event += share * h;
        if share < 1.0 {
            self.accept_part(step, end);
        } else {
            self.accept_whole(end);
        }
        self.forget_windows();
    }

    /// Accepts a step up to its first event, or to where its windows could not go on.
    fn accept_part(&mut self, step: &TrialStep, end: f64) {
        let TrialStep { h, share } = *step;
        self.state.record_event();
        // The windows have moved on since a row was shown there.
        self.workspace.interpolated_at = None;
        self.interpolate(h, share);
        std::mem::swap(&mut self.state.layer.state, &mut self.workspace.interpolated);
        self.workspace.interpolated_at = None;
        let point = self.state.carrier.at(self.state.s + share * h);
        self.state.carrier.take_step(end, &point);
        self.state.s = end;
        if self.has_windows() {
            self.evaluate_forces();
            let next = (AFTER_CUT * share * h).max(self.state.step_after_event);
            self.state.step_size = self.state.step_size.min(next);
        }
        self.change_modes(self.settings.events.gap);
    }

    fn accept_whole(&mut self, end: f64) {
        let largest = self.state.layer.largest;
        self.state.event_spacing = self.state.event_spacing.max(self.state.since_event);
        self.state.carrier.take_step(end, &self.workspace.integrator.end_carrier());
        self.workspace.integrator.accept(&mut self.state.layer);
        self.state.s = end;
        if self.has_windows() {
            // The forces at its end are without their mode changes.
            self.state.layer.largest = largest;
            self.overlay_windows(end);
            self.evaluate_start();
        }
        self.change_modes_if_due();
    }

    fn change_modes_if_due(&mut self) {
        let (layer, at) = (&self.state.layer, self.state.carrier_position());
        if is_due(&self.model, &layer.state, &layer.rates, at, &self.event_tolerance()) {
            self.change_modes(self.settings.events.gap);
        }
    }
}

/// The ratio of the next step to one with this error over the tolerance, by a method of this order.
fn growth(order: i32, error: f64) -> f64 {
    (SAFETY * error.powf(-1.0 / f64::from(order))).clamp(GROWTH.0, GROWTH.1)
}
