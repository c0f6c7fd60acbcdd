//! A window: some masses in a row that take steps of their own within a step of the whole layer.

use std::ops::Range;
use std::sync::Arc;

use super::driver::{TrialStep, WorkLimit};
use super::motion::{SimulationError, Start};
use super::run::{Run, Settings};
use crate::integrator::{DenseWorkspace, Integrator, Pair, STAGES, StepSpan, StepStart, Steps};
use crate::model::{ChannelEnergies, EndForces, LinkKind, Model, State};
use crate::outputs::{Counters, Energies};

/// Some masses in a row within a step of the whole layer, twice: in a run of their own from a mode change on, and as that
/// step, which knows nothing of the change, has them.
#[derive(Clone, Debug)]
pub(super) struct Window {
    /// The run of these masses alone, under the forces that the whole layer's step has in the links to the others.
    pub(super) run: Run,
    /// Whether it runs within the step under way.
    pub(super) open: bool,
    /// The first of its masses in the layer.
    pub(super) first: usize,
    /// The step that its run has tried, and its end, s after the start of the carrier's piece.
    trial: TrialStep,
    trial_end: f64,
    /// The whole layer's step for these masses.
    whole: StepOfPart,
}

/// A step of the whole layer for some of its masses.
#[derive(Clone, Debug)]
struct StepOfPart {
    integrator: Integrator,
    start: StepStart,
    span: StepSpan,
    dense: DenseWorkspace,
    /// Its energies through the channels up to where the window was opened, J.
    opened: ChannelEnergies,
}

impl StepOfPart {
    fn theta(&self, s: f64) -> f64 {
        (s - self.span.start) / self.span.length
    }
}

impl Window {
    /// A window of the masses of `part`, in a layer with these settings.
    pub(super) fn new(part: Model, settings: &Settings) -> Self {
        let (part, settings) = (Arc::new(part), settings.of_window());
        let pair = Pair::in_wide_layer(settings.tolerance.relative);
        let whole = StepOfPart {
            integrator: Integrator::new(&part, settings.tracked(), Steps::Taken(pair)),
            start: StepStart::new(&part),
            span: StepSpan { start: 0.0, length: 0.0 },
            dense: DenseWorkspace::new(&part),
            opened: ChannelEnergies::default(),
        };
        let run = Run::new(part, settings, &Start::default(), &[None, None]);
        Self { run, open: false, first: 0, trial: TrialStep { h: 0.0, share: 1.0 }, trial_end: 0.0, whole }
    }

    /// Changes to another temperature: `model` and `settings` are those of the layer there.
    pub(super) fn heat(&mut self, model: &Model, settings: &Settings) {
        if self.run.model.relaxation_times.len() != model.relaxation_times.len() {
            *self = Self::new(model.part(self.len()), settings);
            return;
        }
        Arc::make_mut(&mut self.run.model).set_temperature_of(model);
        self.run.settings = settings.of_window();
        self.run.workspace.dense.forget();
        self.whole.dense.forget();
    }

    /// Memory in bytes, without some hundreds, at most: the whole layer's step takes less than a run.
    pub(super) fn bytes(&self) -> usize {
        2 * self.run.bytes()
    }

    /// Number of its masses.
    pub(super) fn len(&self) -> usize {
        self.run.model.masses()
    }

    /// Its masses in the layer.
    pub(super) fn masses(&self) -> Range<usize> {
        self.first..self.first + self.len()
    }

    /// The time that its run has reached, s after the start of the carrier's piece.
    pub(super) fn reached(&self) -> f64 {
        self.run.state.s
    }

    /// The end of the step that its run has tried, s after the start of the carrier's piece; infinite where it has tried none
    /// from here.
    pub(super) fn trial_end(&self) -> f64 {
        self.trial_end
    }

    /// Opens it over the masses from `first` on at the time `s` of the step `span` that `run`, of the whole layer, has tried,
    /// as they are there. `nodes` has a workspace for each stage of the step.
    pub(super) fn open_at(
        &mut self,
        run: &Run,
        (span, s): (StepSpan, f64),
        first: usize,
        nodes: &mut [DenseWorkspace],
    ) {
        (self.open, self.first, self.whole.span) = (true, first, span);
        Arc::make_mut(&mut self.run.model).move_part(&run.model, first);
        self.take_step_of(run);
        let ends = self.end_forces(run, nodes);
        let Self { whole: StepOfPart { integrator, start, dense, .. }, run: own, .. } = self;
        let Run { model, state, workspace, .. } = own;
        state.carrier.ends = Some(ends);
        let theta = (s - span.start) / span.length;
        integrator.dense(model, &state.carrier, start, span).state_at(theta, dense, &mut state.layer.state);
        state.s = s;
        state.layer.largest = run.state.layer.largest;
        state.energies = Energies::default();
        (state.step_size, state.step_after_event) = (span.length, run.state.step_after_event);
        (state.event_spacing, state.since_event) = (f64::MAX, 0.0);
        workspace.interpolated_at = None;
        workspace.stall.reset();
        state.counters = Counters::default();
        own.mode_changes = run.mode_changes.as_ref().map(|_| Vec::new());
        if own.settings.accounts.energy {
            self.whole.opened = integrator.energies(&own.model, &start.state, span.length, theta);
        }
    }

    /// Takes over the step that `run`, of the whole layer, has tried.
    fn take_step_of(&mut self, run: &Run) {
        let Self { whole: StepOfPart { integrator, start, span, .. }, run: own, first, .. } = self;
        let models = (&*own.model, &*run.model);
        start.state.copy_part(models, &run.state.layer.state, *first);
        own.state.carrier = run.state.carrier;
        own.workspace.forces.evaluate(&own.model, &start.state, &run.state.carrier.at(span.start));
        integrator.take_part(models, &run.workspace.integrator, *first, &own.workspace.forces);
    }

    /// What the links to the other masses exert on both ends through the step that `run`, of the whole layer, has tried.
    fn end_forces(&self, run: &Run, nodes: &mut [DenseWorkspace]) -> EndForces {
        let span = self.whole.span;
        let step = run.dense_output(span.length);
        let mut coefficients = [[[0.0; 5]; 2]; 2];
        let (before, after) = (self.first.checked_sub(1), self.masses().end - 1);
        let links = [before.map(|link| (0, link, -1.0)), (after + 1 < run.model.masses()).then_some((1, after, 1.0))];
        for (end, link, sign) in links.into_iter().flatten() {
            let mut values = [[0.0; 2]; STAGES];
            for (stage, (value, workspace)) in values.iter_mut().zip(&mut *nodes).enumerate() {
                *value = step.lateral_forces(link, step.interpolation.node(stage), workspace);
            }
            coefficients[end] = [0, 1].map(|axis| step.interpolation.polynomial(|stage| sign * values[stage][axis]));
        }
        EndForces { span: (span.start, span.length), coefficients }
    }

    /// Whether the whole layer's step resolves the motion of its masses where it was opened: whether the defect of the dense
    /// output there is at most `largest` in the tolerance's norm.
    pub(super) fn is_resolved(&mut self, largest: f64) -> bool {
        let Self { whole, run: Run { model, state, workspace, settings, .. }, .. } = self;
        let theta = whole.theta(state.s);
        let StepOfPart { integrator, start, span, dense, .. } = whole;
        workspace.forces.evaluate(model, &state.layer.state, &state.carrier.at(state.s));
        let step = integrator.dense(model, &state.carrier, start, *span);
        step.defect(theta, &state.layer.state, &workspace.forces, dense, &settings.tolerance) <= largest
    }

    /// Takes over the masses of `other`, all of which it has, at the time `s`, and closes it. Returns the energies in it beyond
    /// those of the whole layer's step, J.
    pub(super) fn absorb(&mut self, other: &mut Self, s: f64) -> Energies {
        let Self { run, first, .. } = self;
        other.write_state((&run.model, *first), &mut run.state.layer.state, s);
        other.open = false;
        other.energies(s)
    }

    /// Makes the mode changes due where it was opened, and tries its first step of those up to the time `end`.
    pub(super) fn start(&mut self, end: f64, work: &mut WorkLimit) -> Result<(), SimulationError> {
        let state = &mut self.run.state;
        if state.s < end {
            state.step_size = state.step_size.min(end - state.s);
        }
        self.run.evaluate_forces();
        self.run.change_modes(self.run.settings.events.gap);
        self.try_next(end, work)
    }

    /// Tries the next of its steps up to the time `end`.
    pub(super) fn try_next(&mut self, end: f64, work: &mut WorkLimit) -> Result<(), SimulationError> {
        self.trial_end = f64::INFINITY;
        if self.reached() < end {
            self.trial = self.run.next_step(end, work)?;
            self.trial_end = self.run.end_of(&self.trial, end);
        }
        Ok(())
    }

    /// Accepts the step that it has tried. Returns whether a mode has changed.
    pub(super) fn accept(&mut self) -> bool {
        let events = self.run.state.counters.events;
        self.run.take_step(&self.trial, self.trial_end);
        self.trial_end = f64::INFINITY;
        self.run.state.counters.events != events
    }

    /// The fraction of the step that its run has tried at the time `s`; `None` where it has tried none from where it stands.
    fn theta(&self, s: f64) -> Option<f64> {
        (self.trial_end < f64::INFINITY).then(|| (s - self.reached()) / self.trial.h)
    }

    /// The masses at its ends beyond which there are others, in a layer of `masses`.
    fn ends(&self, masses: usize) -> impl Iterator<Item = usize> + use<> {
        let first = (self.first > 0).then_some(0);
        let last = (self.masses().end < masses).then_some(self.len() - 1);
        first.into_iter().chain(last)
    }

    /// Whether the last mode changes were within `near` masses of one of its ends, in a layer of `masses`.
    pub(super) fn has_changed_near_end(&self, near: usize, masses: usize) -> bool {
        let (before, now) = (&self.run.workspace.modes_before, &self.run.state.layer.state.mode);
        let changed = |i: usize| before[i] != now[i];
        self.ends(masses).any(|end| (end.saturating_sub(near)..(end + near + 1).min(self.len())).any(changed))
    }

    /// The largest force, N, by which its masses, as its run has them, load a link to others beyond that of the whole layer's
    /// step, in a layer of `masses`.
    pub(super) fn mismatch(&mut self, masses: usize) -> f64 {
        let (theta, ends) = (self.whole.theta(self.reached()), self.ends(masses));
        let Self { whole: StepOfPart { integrator, start, span, dense, .. }, run: Run { model, state, .. }, .. } = self;
        let step = integrator.dense(model, &state.carrier, start, *span);
        let layer = &state.layer.state;
        ends.fold(0.0, |largest: f64, end| {
            let [(x, z), (v_x, v_z)] = step.motion(end, theta, dense);
            let force = |kind: LinkKind, off: f64, rate_off: f64| {
                model.glassy[kind as usize] * off.abs() + model.links[kind as usize].damping * rate_off.abs()
            };
            let along_x = force(LinkKind::LateralX, x - layer.elongation_x[end], v_x - layer.velocity_x[end]);
            let along_z = force(LinkKind::LateralZ, z - layer.elongation_z[end], v_z - layer.velocity_z[end]);
            largest.max(along_x).max(along_z)
        })
    }

    /// Energies in its run up to the time `s`, less those of the same masses in the whole layer's step since it was opened, J.
    pub(super) fn energies(&mut self, s: f64) -> Energies {
        let mut energies = match self.theta(s) {
            Some(theta) => self.run.energies_within(self.trial.h, theta),
            None => self.run.state.energies,
        };
        if self.run.settings.accounts.energy {
            let theta = self.whole.theta(s);
            let StepOfPart { integrator, start, span, opened, .. } = &mut self.whole;
            energies.channels.subtract(&integrator.energies(&self.run.model, &start.state, span.length, theta));
            energies.channels.add(opened);
        }
        energies
    }

    /// P_diss of its masses in its run at the time `s`, less that in the whole layer's step, W, where the powers at the stages
    /// say it; 0 elsewhere.
    pub(super) fn dissipated_power(&mut self, s: f64) -> f64 {
        let whole_theta = self.whole.theta(s);
        let mine = self.theta(s).and_then(|theta| self.run.dissipated_power_within(self.trial.h, theta));
        let StepOfPart { integrator, start, span, .. } = &mut self.whole;
        let mut theirs = || integrator.dissipated_power(&self.run.model, &start.state, span.length, whole_theta);
        mine.map_or(0.0, |mine| mine - theirs())
    }

    /// F_x and F_z of its masses in its run at the time `s`, less those in the whole layer's step, N.
    pub(super) fn forces(&mut self, s: f64) -> (f64, f64) {
        let (theta, whole_theta) = (self.theta(s).unwrap_or(0.0), self.whole.theta(s));
        let mine = self.run.on_carrier_within(self.trial.h, theta);
        let StepOfPart { integrator, start, span, dense, .. } = &mut self.whole;
        let carrier = &self.run.state.carrier;
        let theirs = integrator.on_carrier(&self.run.model, carrier, start, *span, whole_theta, dense);
        (mine.0 - theirs.0, mine.1 - theirs.1)
    }

    /// Writes its masses at the time `s` into `state`, that of the layer of `model`, or of a part of it from mass `first` on.
    pub(super) fn write_state(&mut self, (model, first): (&Model, usize), state: &mut State, s: f64) {
        let mine = match self.theta(s) {
            Some(theta) => {
                self.run.interpolate(self.trial.h, theta);
                &self.run.workspace.interpolated
            }
            None => &self.run.state.layer.state,
        };
        mine.write_part((&self.run.model, model), state, self.first - first);
    }
}
