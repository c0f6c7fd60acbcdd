//! The event-driven method: the modes are held through a step, and its mode changes are located on the dense output.
//! Where local regions take them the step goes on; where not it ends at the first.

use super::context::RunContext;
use super::controller::{ChatterGuard, GROWTH, TrialStep, WorkLimit};
use super::motion::SimulationError;
use super::stepper::{StepMethod, StepTest};
use crate::contact::{first_event, is_due, longest_unstable, mode_changes};
use crate::integrator::{ContactModes, Integrator, Overlay, Polynomials};
use crate::model::{ByAxis, Model};

/// A new step is this fraction of what the error estimate allows, so that few are rejected.
const SAFETY: f64 = 0.9;
/// The largest error over the tolerance with which a step of a wide layer is accepted. New steps aim at 0.6 to 0.7 of
/// the tolerance: where mode changes make some of them err more, that costs less than to try these again.
///
/// Recommended 1 to 2. With 3, errors of whole runs grow.
const MAX_ERROR_IN_WIDE_LAYERS: f64 = 2.0;
/// The least fraction of a step at which it is cut at an event; where there is less, the step is tried again, shorter.
///
/// A mass that a large friction stops in so small a fraction is thrown back that many times as fast by the rest of the
/// step, and the energies up to the event would be the difference of powers as many times squared: with 1e-6 they keep
/// some digits.
const MIN_FRACTION: f64 = 1e-6;
/// Steps up to this multiple of the shortest are not shortened for the sake of energies: what friction or a damper does
/// in less than the resolution of time is over within it.
const RESOLVED: f64 = 5.0;
/// The longest step after one that its local regions cut short, as a multiple of the part that was kept.
///
/// Recommended 1 to 3.
const AFTER_CUT: f64 = 1.5;
/// Fraction of a sine's amplitude by which the dense output may be off it with a quarter of the period in a step.
const UNSEEN: f64 = 2e-2;
/// Cuts of one step at events after which each further cut leaves at most half of it. By rounding, an event can be
/// found at the very end of the shortened step again and again.
pub(super) const MAX_CUTS: u32 = 50;
/// The largest residual of the equations of motion that the dense output may have where a step is cut at an event, as a
/// velocity gained over the step, against the tolerance.
///
/// Recommended 1 to 5: the residual oscillates about 0 through the step, so less of it is left in the velocity; with 5
/// the errors of whole runs are those of 1, and fewer steps are repeated.
pub(super) const MAX_DEFECT: f64 = 5.0;
/// The relative tolerance from which on P_diss within a step comes from the powers at its stages, of order 3 at most,
/// and not from the layer's state there.
///
/// Recommended 1e-4: down to it P_diss is as accurate by both in the median, and below ten tolerances nearly
/// everywhere.
const POWERS_OF_STAGES_FROM: f64 = 1e-4;

/// The event-driven steps of a layer or of a local region.
#[derive(Clone, Debug)]
pub(super) struct EventDriven {
    chatter: ChatterGuard,
    /// Whether local regions may take mode changes in the motion under way.
    pub(super) may_plan: bool,
    /// Whether they are to take those of the step tried last.
    pub(super) planned: bool,
    /// The first mode change of each mass in it, as fraction of the step and mass, in the order of time.
    changes: Vec<(f64, usize)>,
    /// Number of them that have been passed.
    passed: usize,
}

/// A step that was tried and not rejected.
#[derive(Clone, Copy, Debug)]
struct GoodAttempt {
    /// Its error over the tolerance.
    error: f64,
    /// The longest next step, s, that lets unstable contacts move away; the largest number where any error is good.
    longest: f64,
}

impl EventDriven {
    /// The steps of a layer of `model`, whose local regions, if there are any, `may_plan`.
    pub(super) fn new(model: &Model, may_plan: bool) -> Self {
        let changes = Vec::with_capacity(if may_plan { model.masses() } else { 0 });
        Self { chatter: ChatterGuard::new(model), may_plan, planned: false, changes, passed: 0 }
    }

    /// Begins a motion.
    pub(super) fn begin(&mut self) {
        self.chatter.reset();
        self.clear_changes();
    }

    pub(super) fn clear_changes(&mut self) {
        (self.planned, self.passed) = (false, 0);
        self.changes.clear();
    }

    /// The next mode change of a mass that `is_taken` does not say to be in a region already.
    pub(super) fn next_change(&mut self, is_taken: impl Fn(usize) -> bool) -> Option<(f64, usize)> {
        let rest = &self.changes[self.passed..];
        self.passed += rest.iter().take_while(|(_, mass)| is_taken(*mass)).count();
        self.changes.get(self.passed).copied()
    }

    /// Tries a step of length `h`; `None` where it is rejected: the controller's step size is then a better length.
    fn try_step(&mut self, context: &mut RunContext, h: f64, test: StepTest) -> Option<GoodAttempt> {
        self.clear_changes();
        context.interpolated_at = None;
        let RunContext { model, settings, state, integrator, .. } = context;
        let attempt = integrator
            .attempt(ContactModes::Held, (&**model, &state.layer, &state.carrier), state.span(h), &settings.tolerance)
            .ok();
        context.trace_bodies(h);
        // Some steps need no error test.
        let good = |longest| attempt.map(|attempt| GoodAttempt { error: attempt.error, longest });
        if test == StepTest::Solved && attempt.is_some_and(|attempt| attempt.error.is_finite()) {
            return good(f64::MAX);
        }
        // The error of the layer, or where the carrier moves unseen between the stages and a mass may touch, that of
        // its motion.
        let of_layer = attempt.map(|attempt| match test {
            StepTest::Motion => attempt.motion_error,
            StepTest::Full | StepTest::Solved => attempt.error,
        });
        let (mut error, mut allowed) = (of_layer.unwrap_or(f64::NAN), self.allowed_error(context));
        if let Some(attempt) = attempt
            && attempt.carrier_error > error.max(1.0)
            && may_touch(context, h)
        {
            (error, allowed) = (attempt.carrier_error, 1.0);
        }
        // A step must let unstable contacts move away, as they are at its end.
        let integrator = &context.integrator;
        let layer = &context.state.layer.state;
        let longest = longest_unstable(&context.model, layer, integrator.end(), integrator.end_forces());
        if error <= allowed && h <= longest {
            return good(longest);
        }
        let ratio = error.is_finite().then(|| growth(integrator, error).min(SAFETY));
        context.state.counters.rejected += 1;
        context.state.controller.reject(h, ratio, longest);
        None
    }

    /// The largest error over the tolerance with which a step is accepted.
    fn allowed_error(&self, context: &RunContext) -> f64 {
        if self.may_plan || context.settings.is_local { MAX_ERROR_IN_WIDE_LAYERS } else { 1.0 }
    }

    /// Finds the mode changes, if any, of the step of length `h` tried last, for local regions to take. `false` where
    /// these cannot, since the first comes before the fraction `least` of the step or there are no regions.
    fn plan(&mut self, context: &mut RunContext, h: f64, least: f64) -> bool {
        if !self.may_plan {
            return false;
        }
        let events = context.event_tolerance();
        let RunContext { model, state, integrator, dense, .. } = context;
        let step = integrator.dense(model, &state.carrier, &state.layer.state, state.span(h));
        mode_changes(&step, &events, dense, &mut self.changes);
        self.changes.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        self.planned = self.changes.first().is_none_or(|(theta, _)| *theta >= least);
        self.planned
    }

    /// Accepts a step without local regions, which ends at the time `end` of the motion.
    pub(super) fn accept(&mut self, context: &mut RunContext, step: &TrialStep, end: f64) {
        context.state.energies = self.energies(context, step.h, step.fraction);
        accept_motion(context, step, end, None);
    }
}

impl StepMethod for EventDriven {
    fn next_step(
        &mut self,
        context: &mut RunContext,
        duration: f64,
        work: &mut WorkLimit,
    ) -> Result<TrialStep, SimulationError> {
        let bounds = context.length_bounds(duration)?;
        // The first length. What follows an event or a kink is likely to be as fast as what followed the one before.
        let controller = &context.state.controller;
        let limit = bounds.longest.min(controller.longest_between_events());
        let starts_anew = controller.since_event == 0.0 || context.state.s == 0.0;
        let first = if starts_anew { limit.min(controller.step_after_event) } else { limit };
        let mut h = bounds.fit(controller.step_size.min(first));
        let events = context.state.counters.events;
        let shortest_cut = self.chatter.shortest_cut(bounds.shortest, events);
        let (mut cuts, mut proposal) = (0, None);
        loop {
            // Try it. The step that an event cuts short says how long the next may be; the shorter ones need no error
            // test.
            work.count(context.state.time(), context.model.work_of_step())?;
            let test = match proposal {
                Some(_) if context.shorter_is_no_worse() => StepTest::Solved,
                _ if h > RESOLVED * bounds.shortest => StepTest::Full,
                _ => StepTest::Motion,
            };
            let Some(tried) = self.try_step(context, h, test) else {
                if h <= bounds.shortest {
                    return Err(context.step_too_small(h));
                }
                h = context.state.controller.step_size.max(bounds.shortest);
                continue;
            };
            // Propose the length of the next.
            let proposed = *proposal.get_or_insert_with(|| {
                let grown = h * growth(&context.integrator, tried.error);
                let controller = &mut context.state.controller;
                if starts_anew {
                    controller.step_after_event = grown;
                }
                controller.propose((h, grown), bounds.remaining.min(limit), tried.longest)
            });
            // It is good up to its first event, or whole where local regions take these.
            let planned = h > shortest_cut && self.plan(context, h, MIN_FRACTION.max(shortest_cut / h));
            let fraction = if planned { 1.0 } else { fraction_before_event(context, h, shortest_cut) };
            if fraction >= 1.0 || (fraction >= MIN_FRACTION && can_resume(context, h, fraction)) {
                context.state.controller.step_size = proposed;
                self.chatter.record_step(fraction * h, cuts > 0, events);
                return Ok(TrialStep { h, fraction });
            }
            // Where the run cannot go on from the event on the dense output, a shorter step has to end there.
            cuts += 1;
            h *= if cuts > MAX_CUTS { fraction.min(0.5) } else { fraction };
        }
    }

    fn try_shorter(&mut self, context: &mut RunContext, h: f64, test: StepTest) -> bool {
        let is_good = self.try_step(context, h, test).is_some();
        if is_good {
            self.plan(context, h, 0.0);
        }
        is_good
    }

    fn on_carrier(&mut self, context: &mut RunContext, h: f64, theta: f64) -> ByAxis<f64> {
        context.on_carrier_within(h, theta)
    }

    fn dissipated_power(&mut self, context: &mut RunContext, h: f64, theta: f64) -> Option<f64> {
        let settings = &context.settings;
        let is_known = settings.accounts.energy && settings.tolerance.relative >= POWERS_OF_STAGES_FROM;
        is_known.then(|| context.dissipated_power_within(h, theta))
    }
}

/// Whether a free mass may have reached the profile in the step of length `h` tried last, which did not see all of
/// the carrier's motion.
fn may_touch(context: &RunContext, h: f64) -> bool {
    let dense = context.dense_output(h);
    let reach = context.model.profile.bounds().z_max + UNSEEN * context.state.carrier.amplitude_w();
    let (motions, modes) = (Polynomials::new(&dense), &context.state.layer.state.mode);
    (0..modes.len()).any(|i| !modes[i].in_contact() && motions.height(i).range().0 <= reach)
}

/// The fraction of the step of length `h` tried last that lies before its first event, 1 where there is none. A cut
/// leaves `shortest_cut` (s) or more of it.
fn fraction_before_event(context: &mut RunContext, h: f64, shortest_cut: f64) -> f64 {
    if h <= shortest_cut {
        return 1.0;
    }
    let events = context.event_tolerance();
    let RunContext { model, state, integrator, dense, .. } = context;
    let step = integrator.dense(model, &state.carrier, &state.layer.state, state.span(h));
    first_event(&step, &events, dense).map_or(1.0, |theta| theta.max(shortest_cut / h))
}

/// Whether the run can go on from the fraction `theta` of the step of length `h` tried last, without local regions:
/// whether the residual of the equations of motion in the dense output there is small in the tolerance's norm.
pub(super) fn can_resume(context: &mut RunContext, h: f64, theta: f64) -> bool {
    if context.integrator.has_tangents() {
        return false;
    }
    context.within((h, theta), None).0.evaluate();
    let RunContext { model, settings, state, integrator, dense, interpolated, forces, .. } = context;
    let step = integrator.dense(model, &state.carrier, &state.layer.state, state.span(h));
    step.defect(theta, interpolated, forces, dense, &settings.tolerance) <= MAX_DEFECT
}

/// Accepts the motion of a step, which ends at the time `end` of the carrier's segment, with that of its open local
/// `regions` in place of its own, and changes the modes if that is due.
pub(super) fn accept_motion(context: &mut RunContext, step: &TrialStep, end: f64, regions: Option<&mut dyn Overlay>) {
    context.state.counters.steps += 1;
    let (state, kept) = (&mut context.state, step.fraction * step.h);
    if step.fraction < 1.0 {
        state.controller.record_event(kept);
        accept_part(context, step, end, regions);
    } else {
        state.controller.record_step(kept);
        accept_whole(context, end, regions);
    }
    context.record_largest_energy();
}

/// Accepts a step up to its first event, or to where its local `regions` could not go on.
fn accept_part(context: &mut RunContext, step: &TrialStep, end: f64, regions: Option<&mut dyn Overlay>) {
    let TrialStep { h, fraction } = *step;
    let has_regions = regions.is_some();
    // The regions have moved on since a row was shown there.
    context.interpolated_at = None;
    let regions = regions.map(|regions| regions as &mut dyn Overlay);
    context.within((h, fraction), regions).0.interpolate();
    context.interpolated_at = None;
    let state = &mut context.state;
    std::mem::swap(&mut state.layer.state, &mut context.interpolated);
    let point = state.carrier.at(state.s + fraction * h);
    state.carrier.take_step(end, &point);
    state.s = end;
    if has_regions {
        state.controller.limit((AFTER_CUT * fraction * h).max(state.controller.step_after_event));
        context.evaluate_forces();
    }
    context.change_modes(context.settings.events.gap);
}

/// Accepts a whole step, and the masses of its local `regions` in place of those in it.
fn accept_whole(context: &mut RunContext, end: f64, regions: Option<&mut dyn Overlay>) {
    let RunContext { model, state, integrator, .. } = context;
    let largest = state.layer.largest;
    state.carrier.take_step(end, &integrator.end_carrier());
    integrator.accept(&mut state.layer);
    state.s = end;
    if let Some(regions) = regions {
        // The forces at its end are without their mode changes.
        state.layer.largest = largest;
        regions.write(model, &mut state.layer.state, end);
        context.evaluate_start();
    }
    let (layer, at, events) = (&context.state.layer, context.state.carrier_position(), context.event_tolerance());
    if is_due(&context.model, &layer.state, &layer.rates, at, &events) {
        context.change_modes(context.settings.events.gap);
    }
}

/// The ratio of the next step to one with this error over the tolerance.
fn growth(integrator: &Integrator, error: f64) -> f64 {
    let order = f64::from(integrator.event_driven().tableau().embedded_order + 1);
    (SAFETY * error.powf(-1.0 / order)).clamp(GROWTH.0, GROWTH.1)
}
