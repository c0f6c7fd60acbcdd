//! A window: some masses in a row that take steps of their own within a step of the whole layer.

use std::ops::Range;
use std::sync::Arc;

use super::driver::{TrialStep, WorkLimit};
use super::motion::{SimulationError, Start};
use super::run::{Run, Settings};
use crate::integrator::{DenseWorkspace, LayerStep, PartOfStep, STAGES};
use crate::model::{ChannelEnergies, EndForces, LinkKind, Model, State};
use crate::outputs::{Counters, Energies};

/// Some masses in a row within a step of the whole layer, twice: in a run of their own from a mode change on, and as that
/// step, which knows nothing of the change, has them.
#[derive(Clone, Debug)]
pub(super) struct Window {
    /// The run of these masses alone, under the forces that the whole layer's step has in the links to the others.
    pub(super) run: Box<Run>,
    /// Whether it runs within the step under way.
    pub(super) open: bool,
    /// The step that its run has tried, and its end, s after the start of the carrier's piece.
    trial: TrialStep,
    trial_end: f64,
    /// Its masses in the whole layer's step.
    whole: PartOfStep,
    /// The energies of that through the channels up to where the window was opened, J.
    opened: ChannelEnergies,
}

impl Window {
    /// A window of the masses of `part`, in a layer with these settings.
    pub(super) fn new(part: Model, settings: &Settings) -> Self {
        let whole = PartOfStep::new(&part, 0);
        let run = Run::new(Arc::new(part), settings.of_window(), &Start::default(), &[None, None]);
        let trial = TrialStep { h: 0.0, share: 1.0 };
        Self { run, open: false, trial, trial_end: 0.0, whole, opened: ChannelEnergies::default() }
    }

    /// Changes to another temperature: `model` and `settings` are those of the layer there.
    pub(super) fn heat(&mut self, model: &Model, settings: &Settings) {
        if self.run.model.relaxation_times.len() != model.relaxation_times.len() {
            *self = Self::new(model.part(self.len()), settings);
            return;
        }
        Arc::make_mut(&mut self.run.model).set_temperature_of(model);
        self.run.settings = settings.of_window();
        self.run.workspace.dense.invalidate();
    }

    /// Memory in bytes that grows with its masses.
    pub(super) fn bytes(&self) -> usize {
        self.run.bytes()
    }

    /// Number of its masses.
    pub(super) fn len(&self) -> usize {
        self.run.model.masses()
    }

    /// Its masses in the layer.
    pub(super) fn masses(&self) -> Range<usize> {
        self.whole.masses.clone()
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

    /// Opens it over the masses from `first` on at the time `s` of the `step` that `run`, of the whole layer, has tried, as they
    /// are there. `nodes` has a workspace for each stage of the step.
    pub(super) fn open_at(
        &mut self,
        run: &Run,
        (step, s): (&mut LayerStep<'_>, f64),
        first: usize,
        nodes: &mut [DenseWorkspace],
    ) {
        self.open = true;
        Arc::make_mut(&mut self.run.model).move_part(&run.model, first);
        self.whole.begin(step, &self.run.model, first);
        let ends = self.end_forces(step, nodes);
        let Self { whole, run: own, .. } = self;
        let Run { state, workspace, .. } = &mut **own;
        state.carrier = run.state.carrier;
        state.carrier.ends = Some(ends);
        let theta = step.theta(s);
        let (dense, weights) = step.dense(&whole.masses);
        dense.state_at(theta, weights, &mut state.layer.state);
        state.s = s;
        state.layer.largest = run.state.layer.largest;
        state.energies = Energies::default();
        (state.step_size, state.step_after_event) = (step.span.length, run.state.step_after_event);
        (state.event_spacing, state.since_event) = (f64::MAX, 0.0);
        workspace.interpolated_at = None;
        workspace.stall.reset();
        state.counters = Counters::default();
        own.mode_changes = run.mode_changes.as_ref().map(|_| Vec::new());
        if own.settings.accounts.energy {
            self.opened = whole.energies(step, theta);
        }
    }

    /// What the links to the other masses exert on both ends through `step`.
    fn end_forces(&self, step: &mut LayerStep<'_>, nodes: &mut [DenseWorkspace]) -> EndForces {
        let (masses, span) = (self.masses(), step.span);
        let (dense, _) = step.dense(&masses);
        let mut coefficients = [[[0.0; 5]; 2]; 2];
        let (before, after) = (masses.start.checked_sub(1), masses.end - 1);
        let links = [before.map(|link| (0, link, -1.0)), (after + 1 < step.model.masses()).then_some((1, after, 1.0))];
        for (end, link, sign) in links.into_iter().flatten() {
            let mut values = [[0.0; 2]; STAGES];
            for (stage, (value, workspace)) in values.iter_mut().zip(&mut *nodes).enumerate() {
                *value = dense.lateral_forces(link, dense.interpolation.node(stage), workspace);
            }
            coefficients[end] = [0, 1].map(|axis| dense.interpolation.polynomial(|stage| sign * values[stage][axis]));
        }
        EndForces { span: (span.start, span.length), coefficients }
    }

    /// Whether the whole layer's `step` resolves the motion of its masses where it was opened: whether the defect of the dense
    /// output there is at most `largest` in the tolerance's norm.
    pub(super) fn is_resolved(&mut self, step: &mut LayerStep<'_>, largest: f64) -> bool {
        let Run { model, state, workspace, settings, .. } = &mut *self.run;
        let theta = step.theta(state.s);
        workspace.forces.evaluate(model, &state.layer.state, &state.carrier.at(state.s));
        let (dense, weights) = step.dense(&self.whole.masses);
        dense.defect(theta, &state.layer.state, &workspace.forces, weights, &settings.tolerance) <= largest
    }

    /// Takes over the masses of `other`, all of which it has, at the time `s` of the whole layer's `step`, and closes it.
    /// Returns the energies in it beyond those of that step, J.
    pub(super) fn absorb(&mut self, other: &mut Self, (step, s): (&LayerStep<'_>, f64)) -> Energies {
        let Self { run, whole, .. } = self;
        other.write_state((&run.model, whole.masses.start), &mut run.state.layer.state, s);
        other.open = false;
        other.energies(step, s)
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
        let first = (self.masses().start > 0).then_some(0);
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
    /// `step`.
    pub(super) fn mismatch(&self, step: &mut LayerStep<'_>) -> f64 {
        let (theta, ends) = (step.theta(self.reached()), self.ends(step.model.masses()));
        let Run { model, state, .. } = &*self.run;
        let masses = self.masses();
        let (dense, weights) = step.dense(&masses);
        let layer = &state.layer.state;
        ends.fold(0.0, |largest: f64, end| {
            let [(x, z), (v_x, v_z)] = dense.motion(masses.start + end, theta, weights);
            let force = |kind: LinkKind, off: f64, rate_off: f64| {
                model.glassy[kind as usize] * off.abs() + model.links[kind as usize].damping * rate_off.abs()
            };
            let along_x = force(LinkKind::LateralX, x - layer.elongation_x[end], v_x - layer.velocity_x[end]);
            let along_z = force(LinkKind::LateralZ, z - layer.elongation_z[end], v_z - layer.velocity_z[end]);
            largest.max(along_x).max(along_z)
        })
    }

    /// Energies in its run up to the time `s`, less those of the same masses in the whole layer's `step` since it was opened, J.
    pub(super) fn energies(&mut self, step: &LayerStep<'_>, s: f64) -> Energies {
        let mut energies = match self.theta(s) {
            Some(theta) => self.run.energies_within(self.trial.h, theta),
            None => self.run.state.energies,
        };
        if self.run.settings.accounts.energy {
            energies.channels.subtract(&self.whole.energies(step, step.theta(s)));
            energies.channels.add(&self.opened);
        }
        energies
    }

    /// P_diss of its masses in its run at the time `s`, less that in the whole layer's `step`, W, where the powers at the stages
    /// say it; 0 elsewhere.
    pub(super) fn dissipated_power(&mut self, step: &LayerStep<'_>, s: f64) -> f64 {
        let mine = self.theta(s).and_then(|theta| self.run.dissipated_power_within(self.trial.h, theta));
        mine.map_or(0.0, |mine| mine - self.whole.dissipated_power(step, step.theta(s)))
    }

    /// F_x and F_z of its masses in its run at the time `s`, less those in the whole layer's `step`, N.
    pub(super) fn forces(&mut self, step: &mut LayerStep<'_>, s: f64) -> (f64, f64) {
        let (theta, theta_of_layer) = (self.theta(s).unwrap_or(0.0), step.theta(s));
        let mine = self.run.on_carrier_within(self.trial.h, theta);
        let theirs = self.whole.on_carrier(step, &self.run.model, theta_of_layer);
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
        mine.write_part((&self.run.model, model), state, self.whole.masses.start - first);
    }
}
