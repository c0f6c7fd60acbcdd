//! A local region: some masses in a row that take steps of their own within a step of the whole layer.

use std::ops::Range;
use std::sync::Arc;

use crate::integrator::{DenseOutput, DenseWorkspace, LayerStep, LayerSums, MAX_STAGES};
use crate::model::{ByAxis, ChannelEnergies, EndForces, LinkKind, Model, State};
use crate::outputs::{Counters, Energies};
use crate::simulation::context::RunContext;
use crate::simulation::controller::{Controller, TrialStep, WorkLimit};
use crate::simulation::event_driven::EventDriven;
use crate::simulation::motion::{SimulationError, Start};
use crate::simulation::settings::Settings;
use crate::simulation::stepper::StepMethod;

/// Some masses in a row within a step of the whole layer, twice: in event-driven steps of their own from a mode change
/// on, and as that step, which knows nothing of the change, has them.
#[derive(Clone, Debug)]
pub(super) struct LocalRegion {
    /// These masses alone, under the forces that the whole layer's step has in the links to the others.
    pub(super) context: Box<RunContext>,
    stepper: EventDriven,
    /// Whether it takes steps within the step under way.
    pub(super) open: bool,
    /// The step that it has tried.
    trial: TrialStep,
    /// The end of that, s after the start of the carrier's segment; infinite where it has tried none from where it
    /// stands.
    pub(super) trial_end: f64,
    /// Its masses in the whole layer's step.
    whole: LayerSums,
    /// The energies of that through the channels up to where the region was opened, J.
    opened: ChannelEnergies,
}

impl LocalRegion {
    /// A region of the first `masses` of the layer of `model`, with these settings.
    pub(super) fn new(model: &Model, masses: usize, settings: &Settings) -> Self {
        let part = model.part(masses);
        Self {
            whole: LayerSums::new(&part, 0),
            stepper: EventDriven::new(&part, false),
            context: RunContext::new(
                Arc::new(part),
                settings.for_local_region(),
                &Start::default(),
                &ByAxis::default(),
            ),
            open: false,
            trial: TrialStep { h: 0.0, fraction: 1.0 },
            trial_end: 0.0,
            opened: ChannelEnergies::default(),
        }
    }

    /// Changes to another temperature: `model` and `settings` are those of the layer there.
    pub(super) fn set_temperature(&mut self, model: &Model, settings: &Settings) {
        if self.context.model.relaxation_times.len() != model.relaxation_times.len() {
            *self = Self::new(model, self.len(), settings);
            return;
        }
        Arc::make_mut(&mut self.context.model).set_temperature_of(model);
        self.context.settings = settings.for_local_region();
        self.context.dense.invalidate();
    }

    /// Number of its masses.
    pub(super) fn len(&self) -> usize {
        self.context.model.masses()
    }

    /// Its masses in the layer.
    pub(super) fn masses(&self) -> Range<usize> {
        self.whole.masses.clone()
    }

    /// The time that it has reached, s after the start of the carrier's segment.
    pub(super) fn reached(&self) -> f64 {
        self.context.state.s
    }

    /// Opens it over the masses from `first` on at the time `s` of the `step` that the layer of `context` has tried, as
    /// they are there. `nodes` has a workspace for each stage of the step.
    pub(super) fn open_at(
        &mut self,
        context: &RunContext,
        (step, s): (&mut LayerStep<'_>, f64),
        first: usize,
        nodes: &mut [DenseWorkspace],
    ) {
        self.open = true;
        // Its place in the layer, and what acts on its ends.
        Arc::make_mut(&mut self.context.model).move_part(&context.model, first);
        self.whole.begin_part(step, &self.context.model, first);
        let ends = self.end_forces(step, nodes);
        // Its masses as they are in the layer's step.
        let (state, of_layer) = (&mut self.context.state, &context.state);
        let theta = step.dense.theta(s);
        let (dense, weights) = step.restricted_to(&self.whole.masses);
        dense.state_at(theta, weights, &mut state.layer.state);
        state.layer.largest = of_layer.layer.largest;
        state.s = s;
        state.carrier = of_layer.carrier;
        state.carrier.ends = Some(ends);
        // Its steps, its counts and its energies begin anew.
        let step_after_event = of_layer.controller.step_after_event;
        state.controller = Controller { step_after_event, ..Controller::new(step.dense.span.length) };
        (state.energies, state.counters) = (Energies::default(), Counters::default());
        self.context.interpolated_at = None;
        self.context.mode_changes = context.mode_changes.as_ref().map(|_| Vec::new());
        self.stepper.begin();
        if self.context.settings.accounts.energy {
            self.opened = self.whole.energies(&step.dense, theta);
        }
    }

    /// What the links to the other masses exert on both ends through `step`.
    fn end_forces(&self, step: &mut LayerStep<'_>, nodes: &mut [DenseWorkspace]) -> EndForces {
        let (masses, span) = (self.masses(), step.dense.span);
        let (dense, _) = step.restricted_to(&masses);
        let mut coefficients = [ByAxis::<[f64; 5]>::default(); 2];
        let (before, after) = (masses.start.checked_sub(1), masses.end - 1);
        let links =
            [before.map(|link| (0, link, -1.0)), (after + 1 < step.dense.model.masses()).then_some((1, after, 1.0))];
        for (end, link, sign) in links.into_iter().flatten() {
            let mut values = [[0.0; 2]; MAX_STAGES];
            for (stage, (value, workspace)) in values.iter_mut().zip(&mut *nodes).enumerate() {
                *value = dense.lateral_forces(link, dense.interpolation().node(stage), workspace);
            }
            let [x, z] = [0, 1].map(|axis| dense.interpolation().polynomial(|stage| sign * values[stage][axis]));
            coefficients[end] = ByAxis { x, z };
        }
        EndForces { span: (span.start, span.length), coefficients }
    }

    /// Whether the whole layer's `step` resolves the motion of its masses where it was opened: whether the defect of
    /// the dense output there is at most `largest` in the tolerance's norm.
    pub(super) fn is_resolved(&mut self, step: &mut LayerStep<'_>, largest: f64) -> bool {
        self.context.evaluate_forces();
        let RunContext { state, forces, settings, .. } = &*self.context;
        let theta = step.dense.theta(state.s);
        let (dense, weights) = step.restricted_to(&self.whole.masses);
        dense.defect(theta, &state.layer.state, forces, weights, &settings.tolerance) <= largest
    }

    /// Takes over the masses of `other`, all of which it has, at the time `s` of the whole layer's `step`, and closes
    /// it. Returns the energies in it beyond those of that step, J.
    pub(super) fn absorb(&mut self, other: &mut Self, (step, s): (&DenseOutput<'_>, f64)) -> Energies {
        let RunContext { model, state, .. } = &mut *self.context;
        other.write_state((model, self.whole.masses.start), &mut state.layer.state, s);
        other.open = false;
        other.energies(step, s)
    }

    /// Makes the mode changes due where it was opened, and tries its first step of those up to the time `end`.
    pub(super) fn start(&mut self, end: f64, work: &mut WorkLimit) -> Result<(), SimulationError> {
        let state = &mut self.context.state;
        if state.s < end {
            state.controller.limit(end - state.s);
        }
        self.context.evaluate_forces();
        self.context.change_modes(self.context.settings.events.gap);
        self.try_next(end, work)
    }

    /// Tries the next of its steps up to the time `end`.
    pub(super) fn try_next(&mut self, end: f64, work: &mut WorkLimit) -> Result<(), SimulationError> {
        self.trial_end = f64::INFINITY;
        if self.reached() < end {
            self.trial = self.stepper.next_step(&mut self.context, end, work)?;
            self.trial_end = self.trial.end(self.reached(), end);
        }
        Ok(())
    }

    /// Accepts the step that it has tried. Returns whether a mode has changed.
    pub(super) fn accept(&mut self) -> bool {
        let events = self.context.state.counters.events;
        self.stepper.accept(&mut self.context, &self.trial, self.trial_end);
        self.trial_end = f64::INFINITY;
        self.context.state.counters.events != events
    }

    /// The fraction of the step that it has tried at the time `s`; `None` where it has tried none from where it stands.
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
        let (before, now) = (&self.context.modes_before, &self.context.state.layer.state.mode);
        let changed = |i: usize| before[i] != now[i];
        self.ends(masses).any(|end| (end.saturating_sub(near)..(end + near + 1).min(self.len())).any(changed))
    }

    /// The largest force, N, by which its masses, as its own steps have them, load a link to others beyond that of the
    /// whole layer's `step`.
    pub(super) fn mismatch(&self, step: &mut LayerStep<'_>) -> f64 {
        let (theta, ends) = (step.dense.theta(self.reached()), self.ends(step.dense.model.masses()));
        let RunContext { model, state, .. } = &*self.context;
        let masses = self.masses();
        let (dense, weights) = step.restricted_to(&masses);
        let layer = &state.layer.state;
        ends.fold(0.0, |largest: f64, end| {
            let [ByAxis { x, z }, ByAxis { x: v_x, z: v_z }] = dense.motion(masses.start + end, theta, weights);
            let force = |kind: LinkKind, off: f64, rate_off: f64| {
                model.glassy[kind] * off.abs() + model.links[kind].damping * rate_off.abs()
            };
            let along_x = force(LinkKind::LateralX, x - layer.elongation_x[end], v_x - layer.velocity_x[end]);
            let along_z = force(LinkKind::LateralZ, z - layer.elongation_z[end], v_z - layer.velocity_z[end]);
            largest.max(along_x).max(along_z)
        })
    }

    /// Energies of its masses up to the time `s`, less those in the whole layer's `step` since it was opened, J.
    pub(super) fn energies(&mut self, step: &DenseOutput<'_>, s: f64) -> Energies {
        let mut energies = match self.theta(s) {
            Some(theta) => self.stepper.energies(&mut self.context, self.trial.h, theta),
            None => self.context.state.energies,
        };
        if self.context.settings.accounts.energy {
            energies.channels.subtract(&self.whole.energies(step, step.theta(s)));
            energies.channels.add(&self.opened);
        }
        energies
    }

    /// P_diss of its masses at the time `s`, less that in the whole layer's `step`, W, where the powers at the stages
    /// say it; 0 elsewhere.
    pub(super) fn dissipated_power(&mut self, step: &DenseOutput<'_>, s: f64) -> f64 {
        let h = self.trial.h;
        let mine = self.theta(s).and_then(|theta| self.stepper.dissipated_power(&mut self.context, h, theta));
        mine.map_or(0.0, |mine| mine.max(0.0) - self.whole.dissipated_power(step, step.theta(s)))
    }

    /// F_x and F_z of its masses at the time `s`, less those in the whole layer's `step`, N.
    pub(super) fn forces(&mut self, step: &mut LayerStep<'_>, s: f64) -> ByAxis<f64> {
        let theta = self.theta(s).unwrap_or(0.0);
        let mine = self.stepper.on_carrier(&mut self.context, self.trial.h, theta);
        mine - self.whole.on_carrier(step, &self.context.model, step.dense.theta(s))
    }

    /// Writes its masses at the time `s` into `state`, that of the layer of `model`, or of a part of it from mass
    /// `first` on.
    pub(super) fn write_state(&mut self, (model, first): (&Model, usize), state: &mut State, s: f64) {
        let theta = self.theta(s);
        if let Some(theta) = theta {
            self.context.within((self.trial.h, theta), None).0.interpolate();
        }
        let RunContext { model: own, state: at_start, interpolated, .. } = &*self.context;
        let mine = if theta.is_some() { interpolated } else { &at_start.layer.state };
        mine.write_part((own, model), state, self.whole.masses.start - first);
    }
}

impl Model {
    /// A layer of the first `masses` of this one.
    #[must_use]
    pub fn part(&self, masses: usize) -> Self {
        let first = |values: &[f64]| values[..masses.min(values.len())].to_vec();
        let (rest_x, rest_z, frozen) = (first(&self.rest_x), first(&self.rest_z), first(&self.frozen));
        let mut part = Self { rest_x, rest_z, frozen, ..self.clone() };
        let mut start = 0;
        for row in &mut part.rows {
            row.range = start..start + row.kind.count(masses);
            start = row.range.end;
        }
        part
    }

    /// Takes over from `whole`, of which this is a part, what depends on the temperature.
    pub fn set_temperature_of(&mut self, whole: &Self) {
        (self.links, self.frozen_stiffness) = (whole.links, whole.frozen_stiffness);
        for (mine, theirs) in self.rows.iter_mut().zip(&whole.rows) {
            (mine.relaxation_time, mine.time_index) = (theirs.relaxation_time, theirs.time_index);
        }
        self.relaxation_times.clone_from(&whole.relaxation_times);
        self.friction.clone_from(&whole.friction);
    }

    /// Makes this part of `whole` the one from mass `first` on.
    pub fn move_part(&mut self, whole: &Self, first: usize) {
        let masses = first..first + self.masses();
        self.rest_x.copy_from_slice(&whole.rest_x[masses.clone()]);
        self.rest_z.copy_from_slice(&whole.rest_z[masses.clone()]);
        if !self.frozen.is_empty() {
            self.frozen.copy_from_slice(&whole.frozen[masses]);
        }
    }
}

impl State {
    /// Writes this state into the part of `whole` from mass `first` on; `models` are those of this state and of
    /// `whole`.
    pub fn write_part(&self, models: (&Model, &Model), whole: &mut Self, first: usize) {
        let masses = first..first + self.mode.len();
        whole.elongation_x[masses.clone()].copy_from_slice(&self.elongation_x);
        whole.elongation_z[masses.clone()].copy_from_slice(&self.elongation_z);
        whole.velocity_x[masses.clone()].copy_from_slice(&self.velocity_x);
        whole.velocity_z[masses.clone()].copy_from_slice(&self.velocity_z);
        whole.mode[masses.clone()].copy_from_slice(&self.mode);
        whole.surface[masses].copy_from_slice(&self.surface);
        for (mine, theirs) in models.0.rows.iter().zip(&models.1.rows) {
            let start = theirs.range.start + first;
            whole.maxwell[start..start + mine.range.len()].copy_from_slice(&self.maxwell[mine.range.clone()]);
        }
    }
}
