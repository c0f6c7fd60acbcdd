//! How a run goes on: step, event, new modes, step.

use cpu_time::ThreadTime;

use super::{ModeChange, Motion, Simulation, SimulationError};
use crate::contact::{
    decide_modes, first_event, free_unloaded, impacts_due, is_due, longest_unstable, place_layer, stop_reversed,
};
use crate::integrator::{Attempt, METHOD};
use crate::model::{Carrier, CarrierPoint, Model, elastic_energy, kinetic_energy};

/// A new step is this share of what the error estimate allows, so that few are rejected.
const SAFETY: f64 = 0.9;
/// The most by which one step differs from the one before.
const GROWTH: (f64, f64) = (0.2, 5.0);
/// The longest step, as a share of the period of the carrier's sine: a longer one could leap from swing to swing, where
/// all stages see the same and the error estimate nothing.
pub(super) const OF_PERIOD: f64 = 0.25;
/// The least share of a step at which it is cut at an event; where there is less, the step is done again.
///
/// A mass that a large friction stops in so small a share is thrown back that many times as fast by the rest of the
/// step, and the energies up to the event would be what is left of powers as many times squared: with 1e-6 they keep
/// some digits.
const LEAST_SHARE: f64 = 1e-6;
/// The longest step, as a multiple of the mean time between the events of late: a longer one would be cut.
///
/// Recommended 1.5 to 3: shorter ones end before there is an event, longer ones are less accurate where they are cut.
const OF_SPACING: f64 = 2.0;
/// Share of a sine's amplitude by which the quintic of the dense output may be off it: (ωh)⁶/46080 with h a quarter of
/// the period at most, [`OF_PERIOD`].
const UNSEEN: f64 = 5e-4;
/// What is left of a step whose stages could not be solved.
pub(super) const AFTER_FAILURE: f64 = 0.25;

/// The least share of the length asked for at which a shorter step is given up.
const SHORTEST_CUT: f64 = 1e-12;

/// Cuts of one step at events after which each further cut leaves at most half of it. By rounding, an event can be found
/// at the very end of the shortened step again and again.
const MOST_CUTS: u32 = 50;

/// Steps that make no progress because rounding makes events.
///
/// Where a mass is so fast that the rounding of its velocity, divided by the length of a short step, is an inertia force
/// larger than the tolerance of events, an event is found at the start of each such step but is not due at its end. The
/// run would cut every step to the resolution of time. After some of these steps in a row, the shortest length that a
/// step is cut to therefore doubles with each, until a mode changes or no event is found.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Crawl {
    /// Steps cut to this length, s, or less are suspected.
    length: f64,
    /// Number of steps cut so short after which no mode changed, less the number of other steps since.
    steps: u32,
    /// Number of mode changes before the last step, if it was cut so short.
    events_before: Option<u64>,
}

/// Length of a step below which a cut is suspected of a [`Crawl`], divided by the stiffest period over 2π.
const CRAWLING: f64 = 1e-9;
/// Number of such steps after which the shortest cut doubles. Simultaneous events of many masses also take many of them,
/// but modes change at those.
const MOST_CRAWLING: u32 = 100;

impl Crawl {
    pub(super) fn new(model: &Model) -> Self {
        Self { length: CRAWLING / model.stiffest_frequency(), ..Self::default() }
    }

    fn reset(&mut self) {
        (self.steps, self.events_before) = (0, None);
    }

    /// The shortest length, s, that the next step may be cut to; `shortest` (s) is the resolution of time, `events` the
    /// number of mode changes so far.
    fn shortest_cut(&mut self, shortest: f64, events: u64) -> f64 {
        if self.events_before.take() == Some(events) {
            self.steps += 1;
        } else {
            self.steps = self.steps.saturating_sub(1);
        }
        shortest * f64::from(self.steps.saturating_sub(MOST_CRAWLING)).exp2()
    }

    /// Records a step that is about to be taken; `events` is the number of mode changes before it.
    fn note_step(&mut self, cut_short: bool, events: u64) {
        self.events_before = cut_short.then_some(events);
    }
}

/// A step that was tried with the length `h` (s) and is taken up to its fraction `share`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stride {
    pub(super) h: f64,
    pub(super) share: f64,
}

impl Simulation {
    pub(super) fn place_layer(&mut self) {
        let at = self.run.carrier_position();
        let carrier = self.run.carrier.at(0.0);
        let (model, state) = (&*self.model, &mut self.run.state);
        place_layer(model, state, at, &carrier);
        self.forces.evaluate(model, state, &carrier);
        free_unloaded(model, state, at, &self.forces);
        decide_modes(model, state, &self.forces);
        self.run.energies.initial = kinetic_energy(model, state) + elastic_energy(model, state);
    }

    /// Follows `motion` to its end, or until F_z rises to the force `until`; the time of that. On an error the run
    /// stands anywhere within the motion.
    pub(super) fn follow(
        &mut self,
        motion: &Motion,
        until: Option<f64>,
        times: &[f64],
        mut observe: impl FnMut(f64, &mut Self),
    ) -> Result<Option<f64>, SimulationError> {
        let clock = self.settings.accounts.solver.then(ThreadTime::now);
        let before = self.run.counters.run_time;
        let mut observe = |time: f64, simulation: &mut Self| {
            simulation.note_error();
            simulation.note_run_time(clock.as_ref(), before);
            observe(time, simulation);
        };
        let mut rows = times.iter().copied().peekable();
        while let Some(time) = rows.next_if(|&time| time <= 0.0) {
            observe(time, self);
        }
        if self.has_risen(until) {
            return Ok(Some(0.0));
        }
        self.enter(motion);
        if let Some(companion) = &mut self.companion {
            companion.enter(motion);
        }
        let mut work = 0;
        let mut risen = self.has_risen(until);
        while self.run.s < motion.duration && !risen {
            let mut stride = self.next_step(motion.duration, &mut work)?;
            if let Some(share) = self.rises_within(&stride, until) {
                let h = share * stride.h;
                stride = self.cut_step(h, &mut work)?;
                risen = stride.h == h;
            }
            if let Some(companion) = &mut self.companion {
                companion.note_step(stride.h, work);
            }
            let mut end = self.end_of(&stride, motion.duration);
            while let Some(time) = rows.peek().copied().filter(|&time| time < end) {
                let (elapsed, h) = (time - self.run.s, stride.h);
                if self.can_show_within(h, elapsed / h) {
                    self.show_within(h, elapsed / h, |simulation| observe(time, simulation));
                    rows.next();
                } else {
                    (stride, end) = self.cut_at(time, motion.duration, &mut work)?;
                    risen = false;
                }
            }
            self.take_step(&stride, end);
            risen = risen || self.has_risen(until);
            if risen || end >= motion.duration {
                self.find_tangents();
            }
            while let Some(time) = rows.next_if(|&time| time <= end) {
                observe(time, self);
            }
        }
        self.end_beside();
        self.note_run_time(clock.as_ref(), before);
        Ok(risen.then_some(self.run.s))
    }

    /// The processor time since the start: what the motion under way has taken added to that `before` it, s.
    fn note_run_time(&mut self, clock: Option<&ThreadTime>, before: f64) {
        if let Some(clock) = clock {
            self.run.counters.run_time = before + clock.elapsed().as_secs_f64();
        }
    }

    /// Whether F_z has reached the force `until`.
    fn has_risen(&mut self, until: Option<f64>) -> bool {
        until.is_some_and(|force| self.force_z() >= force)
    }

    /// A step up to the time `s` of the piece in place of a good one that goes beyond it, and its end: before that time
    /// where a step so long is no good.
    pub(super) fn cut_at(&mut self, s: f64, duration: f64, work: &mut u64) -> Result<(Stride, f64), SimulationError> {
        let h = s - self.run.s;
        let stride = self.cut_step(h, work)?;
        Ok((stride, if stride.h == h { s } else { self.end_of(&stride, duration) }))
    }

    /// A step of the length `h` in place of a longer, good one: no worse, and free of events, or with fewer. A shorter
    /// one where its stages cannot be solved, though those of the longer one could, or find another solution.
    fn cut_step(&mut self, h: f64, work: &mut u64) -> Result<Stride, SimulationError> {
        let (mut length, any_error) = (h, self.shorter_is_no_worse());
        loop {
            let good = if self.run.stepping {
                self.try_time_step(length, any_error).is_some()
            } else {
                self.try_step(length, any_error).is_some()
            };
            if good {
                return Ok(Stride { h: length, share: 1.0 });
            }
            self.count_work(work)?;
            if length <= SHORTEST_CUT * h {
                return Err(SimulationError::StepTooSmall { time: self.run.time(), step: length });
            }
            length = self.run.step_size;
        }
    }

    /// Whether a step shorter than a good one needs no test of its error. Where friction falls with the speed the
    /// stages may have several solutions, and the two need not find the same.
    fn shorter_is_no_worse(&self) -> bool {
        self.model.rate_shear.is_none()
    }

    /// F_z now, N.
    pub(super) fn force_z(&mut self) -> f64 {
        self.evaluate_forces();
        self.forces.on_carrier_z()
    }

    /// The forces as the run stands, and the carrier.
    pub(super) fn evaluate_forces(&mut self) -> CarrierPoint {
        let carrier = self.run.carrier.at(self.run.s);
        self.forces.evaluate(&self.model, &self.run.state, &carrier);
        carrier
    }

    /// Begins a smooth piece of the carrier's motion. At a kink the damper forces jump, so all modes are decided anew.
    pub(super) fn enter(&mut self, motion: &Motion) {
        let run = &mut self.run;
        let rates = |carrier: &Carrier, s: f64| (carrier.at(s).u_rate, carrier.at(s).w_rate);
        let before = rates(&run.carrier, run.s);
        run.carrier = Carrier::new(run.time(), run.displacement(), (motion.u, motion.w), &self.model.profile);
        run.s = 0.0;
        self.crawl.reset();
        self.integrator.begin_tangents(motion.duration);
        if !run.rates_hold || rates(&run.carrier, 0.0) != before {
            self.change_modes(0.0);
        } else if self.integrator.has_tangents() {
            self.evaluate_forces();
            self.refresh_tangents();
        }
    }

    /// The tangents of the motion that ends here.
    fn find_tangents(&mut self) {
        if self.integrator.has_tangents() {
            self.run.tangents = self.integrator.tangents(&self.model, self.run.s);
        }
    }

    /// The tangents' rates from the forces just evaluated.
    fn refresh_tangents(&mut self) {
        self.integrator.refresh_tangents(&self.model, &self.run.state, &self.forces, self.run.s);
    }

    /// Impacts due, stops, then every contact decided anew from the forces, which have jumped; and the rates after it.
    /// Masses within `reach` (m) of the profile count as touching.
    pub(super) fn change_modes(&mut self, reach: f64) {
        let carrier = self.run.carrier.at(self.run.s);
        let at = self.run.carrier_position();
        let (model, state) = (&*self.model, &mut self.run.state);
        self.within.mode.copy_from_slice(&state.mode);
        self.run.energies.impact += impacts_due(model, state, at, reach);
        self.run.energies.channels.friction += stop_reversed(model, state);
        self.forces.evaluate(model, state, &carrier);
        decide_modes(model, state, &self.forces);
        self.integrator.begin(model, state, &carrier, &self.forces);
        self.run.rates_hold = true;
        self.refresh_tangents();
        self.count_mode_changes();
    }

    pub(super) fn count_mode_changes(&mut self) {
        let time = self.run.time();
        let modes = self.within.mode.iter().zip(&self.run.state.mode).enumerate();
        for (mass, (from, to)) in modes.filter(|(_, (from, to))| from != to) {
            self.run.counters.events += 1;
            if let Some(record) = &mut self.mode_changes {
                record.push(ModeChange { time, mass, from: from.number(), to: to.number() });
            }
        }
    }

    fn change_modes_if_due(&mut self) {
        let at = self.run.carrier_position();
        let rates = self.integrator.start_rates();
        if is_due(&self.model, &self.run.state, rates, (at.profile_position, at.w), &self.settings.events) {
            self.change_modes(self.settings.events.gap);
        }
    }

    /// Tries steps until one is good up to its first event.
    pub(super) fn step(&mut self, duration: f64, work: &mut u64) -> Result<Stride, SimulationError> {
        let remaining = duration - self.run.s;
        let shortest = 4.0 * f64::EPSILON * (self.run.s + 1e-3 * duration);
        let longest = OF_PERIOD * self.run.carrier.shortest_period();
        if longest <= shortest {
            return Err(SimulationError::StepTooSmall { time: self.run.time(), step: longest });
        }
        let limit = longest.min(OF_SPACING * self.run.event_spacing);
        let shortest_cut = self.crawl.shortest_cut(shortest, self.run.counters.events);
        let mut h = fitted(self.run.step_size.min(limit), remaining);
        let mut cuts = 0;
        // The step that an event cuts short says how long the next may be; the shorter ones need no test of their
        // error.
        let mut proposal = None;
        loop {
            self.count_work(work)?;
            let Some(attempt) = self.try_step(h, proposal.is_some() && self.shorter_is_no_worse()) else {
                if h <= shortest {
                    return Err(SimulationError::StepTooSmall { time: self.run.time(), step: h });
                }
                h = self.run.step_size;
                continue;
            };
            let proposed = *proposal.get_or_insert_with(|| {
                self.proposal(h, remaining.min(limit), attempt.error).min(self.longest_unstable())
            });
            let event = self.first_event(h);
            let share = event.filter(|_| h > shortest_cut).map_or(1.0, |theta| theta.max(shortest_cut / h));
            if share >= 1.0 || (share >= LEAST_SHARE && self.is_good_within(h, share)) {
                self.run.step_size = proposed;
                self.crawl.note_step(cuts > 0 && share * h <= self.crawl.length, self.run.counters.events);
                return Ok(Stride { h, share });
            }
            cuts += 1;
            h *= if cuts > MOST_CUTS { share.min(0.5) } else { share };
        }
    }

    /// The share of the step of length `h` tried last after which a mode change is due.
    fn first_event(&mut self, h: f64) -> Option<f64> {
        let dense = self.integrator.dense(&self.model, &self.run.carrier, &self.run.state, (self.run.s, h));
        first_event(&dense, self.integrator.stages(), &self.settings.events, &mut self.dense_workspace)
    }

    /// Tries a step of length `h`; `None` where it is no good, and the run's step size is then a better one.
    pub(super) fn try_step(&mut self, h: f64, any_error: bool) -> Option<Attempt> {
        self.within_at = None;
        let run = &self.run;
        let tolerance = &self.settings.tolerance;
        let attempt = self.integrator.attempt(&self.model, &run.state, &run.carrier, (run.s, h), tolerance);
        let mut error = attempt.map_or(f64::NAN, |attempt| attempt.error);
        if attempt.is_ok_and(|attempt| attempt.unseen > error.max(1.0)) && self.may_touch(h) {
            error = attempt.map_or(error, |attempt| attempt.unseen);
        }
        if any_error && error.is_finite() {
            return attempt.ok();
        }
        let longest = self.longest_unstable();
        if error <= 1.0 && h <= longest {
            return attempt.ok();
        }
        self.run.counters.rejected += 1;
        let shorter = h * if error.is_finite() { growth(error).min(SAFETY) } else { AFTER_FAILURE };
        self.run.step_size = shorter.min(longest);
        None
    }

    /// The longest step, s, that lets unstable contacts leave their places as they are at the end of the step tried
    /// last.
    pub(super) fn longest_unstable(&self) -> f64 {
        longest_unstable(&self.model, self.integrator.end(), self.integrator.end_forces())
    }

    /// Whether a free mass may have come to the profile in the step of length `h` tried last, which did not see all of
    /// the carrier's motion.
    fn may_touch(&self, h: f64) -> bool {
        let dense = self.integrator.dense(&self.model, &self.run.carrier, &self.run.state, (self.run.s, h));
        let reach = self.model.profile.bounds().z_max + UNSEEN * self.run.carrier.swing();
        let modes = self.run.state.mode.iter().enumerate();
        modes.into_iter().any(|(i, mode)| !mode.in_contact() && dense.height(i).range().0 <= reach)
    }

    pub(super) fn count_work(&self, work: &mut u64) -> Result<(), SimulationError> {
        if *work >= self.settings.max_steps {
            return Err(SimulationError::TooManySteps { time: self.run.time(), steps: self.settings.max_steps });
        }
        *work += 1;
        Ok(())
    }

    /// The length of the next step after a good one of length `h`. One that was cut short to `limit` by the end of a
    /// piece or by the events says nothing.
    fn proposal(&self, h: f64, limit: f64, error: f64) -> f64 {
        let grown = h * growth(error);
        if h < limit { grown } else { grown.max(self.run.step_size) }
    }

    /// The end of a stride: exactly that of the piece where it is the last.
    pub(super) fn end_of(&self, stride: &Stride, duration: f64) -> f64 {
        let whole = stride.share >= 1.0 && stride.h >= duration - self.run.s;
        if whole { duration } else { self.run.s + stride.share * stride.h }
    }

    /// Goes to the end of a stride, at the time `end` of the piece, and changes the modes if that is due.
    pub(super) fn accept(&mut self, stride: &Stride, end: f64) {
        let Stride { h, share } = *stride;
        if self.settings.accounts.energy {
            let gain = self.integrator.energies(&self.model, &self.run.state, h, share);
            self.run.energies.channels.add(&gain);
        }
        self.run.counters.steps += 1;
        self.run.since_event += share * h;
        if share < 1.0 {
            self.run.note_event();
            self.look_within(h, share);
            std::mem::swap(&mut self.run.state, &mut self.within);
            self.within_at = None;
            self.run.s = end;
            self.change_modes(self.settings.events.gap);
        } else {
            self.run.event_spacing = self.run.event_spacing.max(self.run.since_event);
            self.integrator.accept(&mut self.run.state);
            self.run.s = end;
            self.change_modes_if_due();
        }
    }
}

/// How much longer or shorter a step may be than one with this error over the tolerance.
fn growth(error: f64) -> f64 {
    let order = f64::from(METHOD.embedded_order + 1);
    (SAFETY * error.powf(-1.0 / order)).clamp(GROWTH.0, GROWTH.1)
}

/// A step that leaves no scrap before the end of the piece.
pub(super) fn fitted(step_size: f64, remaining: f64) -> f64 {
    if step_size >= remaining {
        remaining
    } else if step_size > 0.5 * remaining {
        0.5 * remaining
    } else {
        step_size
    }
}
