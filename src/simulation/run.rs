//! A run of a layer: it joins the steppers of both methods and the local regions.

use std::sync::Arc;

use super::context::RunContext;
use super::controller::{TrialStep, WorkLimit};
use super::event_driven::EventDriven;
use super::local_regions::LocalRegions;
use super::motion::{Inaccuracy, MethodSwitch, Motion, SimulationError, Start};
use super::settings::Settings;
use super::state::RunState;
use super::stepper::StepMethod;
use super::time_stepping::TimeStepping;
use crate::math::bracketed_root;
use crate::model::{BodyStart, ByAxis, Model};
use crate::outputs::{Energies, LayerView, Snapshot};
use crate::scene::Method;

/// Mean number of mode changes per time step above which the run switches to time-stepping: 1.5 times the break-even of
/// 1/3, so that a few changes are still located.
const TO_TIME_STEPPING: f64 = 0.5;
/// The number below which it switches back to events: well below the break-even, so that it does not alternate.
const TO_EVENTS: f64 = 0.1;
/// Time steps over which the mean is taken.
const MEMORY: f64 = 8.0;

/// A run of a layer.
///
/// A motion of the carrier ([`Simulation::advance`](super::Simulation::advance)) is a sequence of steps, of either
/// method:
///
/// ```text
/// begin(motion)                     decide the modes anew where the carrier's velocity jumps
/// show the rows due at its start
/// while s < duration:
///     step = next_step()            the stepper tries lengths until the error, the unstable contacts and,
///                                   event-driven, the first mode change allow the step; or local regions
///                                   are to take its mode changes
///     where F_z reaches the force:  cut_step() to end there
///     for each row within step:     advance_regions() up to it; show it on the dense output,
///                                   or cut_step_at() it
///     advance_regions() to the end  they may cut the step, too
///     take_step()                   add the energies; the step's end, or where it is cut, becomes the state;
///                                   write the regions' masses over it; make the mode changes due;
///                                   change the method (auto)
///     show the rows due at its end
/// ```
///
/// Method *auto* goes from events to time-stepping where mode changes come fast, and back where they are few again.
/// What decides is the number of mode changes per time step, in the mean over the last [`MEMORY`] of them. An event
/// costs the event-driven method a step of three or six stages, which is cut there, or of a local region; a time step
/// costs two and takes any number of changes. So time-stepping is cheaper from a third of a change per step on.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) context: Box<RunContext>,
    event_driven: EventDriven,
    time_stepping: TimeStepping,
    /// Of event-driven steps.
    local_regions: LocalRegions,
    /// The state before the motion under way.
    checkpoint: Box<RunState>,
    /// How long the records of mode changes and method switches were then.
    recorded: [usize; 2],
    /// The record of switches between the methods, where one is kept.
    pub(super) method_switches: Option<Vec<MethodSwitch>>,
}

impl Run {
    /// A run with the layer placed under the carrier at `start`.
    pub(super) fn new(
        model: Arc<Model>,
        settings: Settings,
        start: &Start,
        bodies: &ByAxis<Option<BodyStart>>,
    ) -> Self {
        let local_regions = LocalRegions::new(&model, &settings);
        let event_driven = EventDriven::new(&model, !local_regions.is_empty());
        let time_stepping = TimeStepping::new(&model, settings.method != Method::Event);
        let context = RunContext::new(model, settings, start, bodies);
        let checkpoint = Box::new(context.state.clone());
        let (recorded, method_switches) = ([0; 2], None);
        let mut run =
            Self { context, event_driven, time_stepping, local_regions, checkpoint, recorded, method_switches };
        run.keep_link_forces();
        run
    }

    pub(super) fn newton_iterations(&self) -> u64 {
        self.context.integrator.iterations() + self.local_regions.newton_iterations()
    }

    /// Keeps the run as it stands, to roll back to.
    pub(super) fn keep_checkpoint(&mut self) {
        self.checkpoint.copy_from(&self.context.state);
        let mode_changes = self.context.mode_changes.as_ref().map_or(0, Vec::len);
        self.recorded = [mode_changes, self.method_switches.as_ref().map_or(0, Vec::len)];
    }

    pub(super) fn roll_back(&mut self) {
        let [mode_changes, method_switches] = self.recorded;
        self.context.state.copy_from(&self.checkpoint);
        if let Some(record) = &mut self.context.mode_changes {
            record.truncate(mode_changes);
        }
        if let Some(record) = &mut self.method_switches {
            record.truncate(method_switches);
        }
    }

    /// The layer's temperature before the motion under way, K; 0 where it is no input.
    pub(super) fn temperature_before(&self) -> f64 {
        self.checkpoint.temperature
    }

    /// Takes over another temperature (K) and the settings for the model there, which is set.
    pub(super) fn set_temperature(&mut self, temperature: f64, settings: Settings) {
        self.context.set_temperature(temperature, settings);
        self.keep_link_forces();
        self.local_regions.set_temperature(&self.context.model, &self.context.settings);
    }

    /// Lets the integrator keep what the energies of local regions need.
    fn keep_link_forces(&mut self) {
        if !self.local_regions.is_empty() {
            self.context.integrator.keep_link_forces(&self.context.model);
        }
    }

    /// Whether local regions, if there are any, may take mode changes in the motions to come.
    pub(super) fn allow_local_regions(&mut self, allowed: bool) {
        self.event_driven.may_plan = allowed && !self.local_regions.is_empty();
    }

    /// Begins a smooth segment of the carrier's motion.
    pub(super) fn begin(&mut self, motion: &Motion) {
        self.event_driven.begin();
        self.local_regions.close();
        self.context.begin(motion);
    }

    /// The steps of the method that has the run now.
    fn stepper(&mut self) -> (&mut dyn StepMethod, &mut RunContext) {
        let Self { context, event_driven, time_stepping, .. } = self;
        let stepper: &mut dyn StepMethod = if context.state.time_stepping { time_stepping } else { event_driven };
        (stepper, context)
    }

    /// See [`StepMethod::next_step`].
    pub(super) fn next_step(&mut self, duration: f64, work: &mut WorkLimit) -> Result<TrialStep, SimulationError> {
        let (stepper, context) = self.stepper();
        stepper.next_step(context, duration, work)
    }

    /// See [`StepMethod::cut_step_at`].
    pub(super) fn cut_step_at(
        &mut self,
        s: f64,
        duration: f64,
        work: &mut WorkLimit,
    ) -> Result<(TrialStep, f64), SimulationError> {
        self.local_regions.discard(&mut self.context);
        let (stepper, context) = self.stepper();
        stepper.cut_step_at(context, (s, duration), work)
    }

    /// Where F_z reaches the force `until` (N) in `step`, a step that ends there in its place, and whether it does;
    /// `None` where it ends below.
    pub(super) fn cut_at_force(
        &mut self,
        step: &TrialStep,
        until: Option<f64>,
        work: &mut WorkLimit,
    ) -> Result<Option<(TrialStep, bool)>, SimulationError> {
        let TrialStep { h, fraction } = *step;
        let Some(force) = until.filter(|&force| self.on_carrier_within(h, fraction).z >= force) else {
            return Ok(None);
        };
        let theta = bracketed_root(|theta| self.on_carrier_within(h, theta).z - force, (0.0, fraction), 1e-14);
        let (stepper, context) = self.stepper();
        let cut = stepper.cut_step(context, theta * h, work)?;
        Ok(Some((cut, cut.h == theta * h)))
    }

    /// Lets local regions follow `step`, which ends at the second of two times, up to the first, s. Returns its end:
    /// where they cannot, it is cut short.
    pub(super) fn advance_regions(
        &mut self,
        step: &mut TrialStep,
        times: (f64, f64),
        work: &mut WorkLimit,
    ) -> Result<f64, SimulationError> {
        self.local_regions.advance((&mut self.context, &mut self.event_driven), step, times, work)
    }

    /// Accepts a step, which ends at the time `end` of the segment, and makes the mode changes due there.
    pub(super) fn take_step(&mut self, step: &TrialStep, end: f64) {
        let Self { context, event_driven, time_stepping, local_regions, .. } = self;
        let auto = context.settings.method == Method::Auto;
        let events = context.state.counters.events - local_regions.mode_changes();
        let mut time_step = step.h;
        if context.state.time_stepping {
            time_stepping.accept(context, step, end);
        } else {
            if auto {
                time_step *= context.integrator.two_stage_length_ratio(step.h, &context.settings.tolerance);
            }
            local_regions.accept((context, event_driven), step, end);
        }
        if auto {
            let state = &mut self.context.state;
            state.mode_changes_per_step *= (-step.fraction * step.h / (MEMORY * time_step)).exp();
            state.mode_changes_per_step += (state.counters.events - events) as f64 / MEMORY;
            self.switch_if_due(time_step);
        }
    }

    /// Changes the method if that is due. A time step with an error of the tolerance has the length `time_step`, s.
    fn switch_if_due(&mut self, time_step: f64) {
        let state = &mut self.context.state;
        let RunState { time_stepping, mode_changes_per_step, .. } = *state;
        let due =
            if time_stepping { mode_changes_per_step < TO_EVENTS } else { mode_changes_per_step > TO_TIME_STEPPING };
        if !due {
            return;
        }
        let to_time_stepping = !time_stepping;
        state.time_stepping = to_time_stepping;
        let time = state.time();
        if to_time_stepping {
            state.controller.limit(time_step);
        } else {
            // The event-driven steps begin with an explicit stage: its rates, and the modes that go with them.
            self.context.change_modes(self.context.settings.events.gap);
        }
        if let Some(record) = &mut self.method_switches {
            record.push(MethodSwitch { time, to_time_stepping, mode_changes_per_step });
        }
    }

    /// Whether F_z has reached the force `until`, N.
    pub(super) fn has_reached(&mut self, until: Option<f64>) -> bool {
        until.is_some_and(|force| self.snapshot().on_carrier.z >= force)
    }

    /// The run as it stands.
    pub(super) fn snapshot(&mut self) -> Snapshot<'_> {
        self.context.evaluate_forces();
        let RunContext { model, state, forces, .. } = &*self.context;
        let on_carrier = ByAxis::from_fn(|axis| forces.on_carrier(axis));
        snapshot_of((model, state), state.s, LayerView::at(&state.layer.state, forces), on_carrier)
    }

    /// Whether the energy balance does not close; `None` where energies are not asked for.
    pub(super) fn energy_inaccuracy(&mut self) -> Option<Inaccuracy> {
        /// Relative tolerances. Runs that keep to their tolerance are off by less than one.
        const OPEN_BALANCE: f64 = 10.0;
        let (tracked, tolerance) = (self.context.settings.accounts.energy, self.context.settings.tolerance.relative);
        let residual = if tracked { self.snapshot().relative_energy_residual() } else { 0.0 };
        (residual > OPEN_BALANCE * tolerance).then_some(Inaccuracy::Energy { residual, tolerance })
    }

    /// The run at the fraction `theta` of the step of length `h` (s) tried last.
    pub(super) fn snapshot_within(&mut self, h: f64, theta: f64) -> Snapshot<'_> {
        let (energies, dissipated_power) = (self.energies_within(h, theta), self.dissipated_power_within(h, theta));
        let on_carrier = self.on_carrier_within(h, theta);
        let Self { context, local_regions, .. } = self;
        let (within, state) = context.within((h, theta), Some(local_regions));
        let model = within.step.dense.model;
        let now = snapshot_of((model, state), state.s + theta * h, LayerView::within(within), on_carrier);
        Snapshot { energies, dissipated_power, ..now }
    }

    /// Energies since the start at the fraction `theta` of the step of length `h` tried last.
    fn energies_within(&mut self, h: f64, theta: f64) -> Energies {
        let (stepper, context) = self.stepper();
        let mut energies = stepper.energies(context, h, theta);
        energies.gain(&self.local_regions.energies(&self.context, self.context.state.s + theta * h));
        energies
    }

    /// F_x and F_z at the fraction `theta` of the step of length `h` tried last, N.
    fn on_carrier_within(&mut self, h: f64, theta: f64) -> ByAxis<f64> {
        let (stepper, context) = self.stepper();
        let without_regions = stepper.on_carrier(context, h, theta);
        without_regions + self.local_regions.forces(&self.context, self.context.state.s + theta * h)
    }

    /// P_diss at the fraction `theta` of the step of length `h` tried last, W, where the powers at its stages say it.
    fn dissipated_power_within(&mut self, h: f64, theta: f64) -> Option<f64> {
        let (stepper, context) = self.stepper();
        let power = stepper.dissipated_power(context, h, theta)?;
        let of_regions = self.local_regions.dissipated_power(&self.context, self.context.state.s + theta * h);
        Some((power + of_regions).max(0.0))
    }

    /// Whether the dense output of `step`, tried last, is good enough to be shown at the time `s` after the start of
    /// the carrier's segment.
    pub(super) fn can_show_within(&mut self, step: &TrialStep, s: f64) -> bool {
        let (stepper, context) = self.stepper();
        stepper.can_show(context, step.h, context.state.fraction_at(s, step.h))
    }
}

/// A run of a model in a state of its own, at the time `s` after the start of the carrier's segment: with the `layer`
/// then, and the forces F_x and F_z, N.
fn snapshot_of<'a>(
    (model, state): (&'a Model, &'a RunState),
    s: f64,
    layer: LayerView<'a>,
    on_carrier: ByAxis<f64>,
) -> Snapshot<'a> {
    Snapshot {
        model,
        time: state.carrier.time + s,
        on_carrier,
        dissipated_power: None,
        layer,
        carrier: state.carrier.at(s),
        motion: (&state.carrier, s),
        displacement: state.displacement_at(s),
        start: state.start,
        energies: state.energies,
        tangents: state.tangents,
        counters: state.counters,
        run_time: 0.0,
    }
}
