//! A run of a layer: its state, which is all that changes in it, and the workspace of its steps.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::motion::{MethodSwitch, ModeChange, Motion, OutOfRange, Start};
use super::windows::Windows;
use crate::contact::{
    EndCorrection, EventTolerance, decide_modes, free_unloaded, impacts_due, place_layer, stop_reversed,
};
use crate::integrator::{DenseWorkspace, Integrator, LayerState, Pair, StepSpan, Steps, Tolerance, Tracked};
use crate::model::{
    BodyStart, Carrier, CarrierPoint, CarrierPosition, Forces, LinkKind, Mode, Model, Piece, State, Tangents,
    elastic_energy, kinetic_energy,
};
use crate::outputs::{Accounts, Counters, Energies};
use crate::scene::{Axis, Method, Path, Scene, is_possible};

/// The first step to try, as a share of the stiffest period over 2π; the error test corrects it at once.
const FIRST_STEP: f64 = 0.1;
/// The weight of the latest in the mean time between events.
const SPACING_GAIN: f64 = 0.3;
/// The least that this mean falls to, as a share of the step that the error allows: many events at one instant say
/// nothing of later ones.
const MIN_SPACING: f64 = 0.01;
/// Length of a step below which a cut is suspected of a [`Stall`], divided by the stiffest period over 2π.
const STALLED: f64 = 1e-9;
/// Number of such steps after which the shortest cut doubles. Simultaneous events of many masses also take many of them,
/// but modes change at those.
const MAX_STALLED: u32 = 100;

/// All that changes in a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct RunState {
    /// The smooth piece of motion that the carrier is on.
    pub carrier: Carrier,
    /// Time since the start of that piece, s.
    pub s: f64,
    /// The layer, with the rates at the start of the next step.
    pub layer: LayerState,
    /// Whether these rates are valid: not before the first motion, nor where the forces were changed from outside.
    pub rates_valid: bool,
    /// Energies since the start.
    pub energies: Energies,
    /// What the solver counts.
    pub counters: Counters,
    /// The length of the next step to try, s.
    pub step_size: f64,
    /// The running mean of the time between events, s; the largest number where there was none.
    pub event_spacing: f64,
    /// Time since the last event, s.
    pub since_event: f64,
    /// The step that the error allowed right after the last event or kink, s; the largest number before the first.
    pub step_after_event: f64,
    /// The derivatives with respect to the targets of the last motion; 0 before the first.
    pub tangents: Tangents,
    /// u and w at the start of the run, m.
    pub start: [f64; 2],
    /// The layer's temperature, K; 0 where it is no input.
    pub temperature: f64,
    /// Whether time-stepping is active, or the event-driven method.
    pub time_stepping: bool,
    /// The running mean of the mode changes per time step; of the method *auto* alone.
    pub mode_changes_per_step: f64,
}

impl RunState {
    fn new(model: &Model, start: &Start, bodies: &[Option<BodyStart>; 2], time_stepping: bool) -> Self {
        let path = |rate| Path { rate, ..Path::default() };
        let paths = (path(start.u_rate), path(start.w_rate));
        let mut carrier = Carrier::new(start.time, (start.u, start.w), paths, &model.profile);
        for (axis, body) in Axis::ALL.into_iter().zip(bodies) {
            body.iter().for_each(|body| carrier.start_body(axis, body, &model.profile));
        }
        Self {
            start: [carrier.u, carrier.w],
            temperature: start.temperature.unwrap_or(0.0),
            carrier,
            s: 0.0,
            layer: LayerState::new(model),
            rates_valid: false,
            energies: Energies::default(),
            counters: Counters::default(),
            step_size: FIRST_STEP / model.stiffest_frequency(),
            event_spacing: f64::MAX,
            since_event: 0.0,
            step_after_event: f64::MAX,
            tangents: Tangents::default(),
            time_stepping,
            mode_changes_per_step: 0.0,
        }
    }

    /// Copies `other`, of the same scene, without allocating.
    pub(super) fn copy_from(&mut self, other: &Self) {
        let Self {
            carrier,
            s,
            layer,
            rates_valid,
            energies,
            counters,
            step_size,
            event_spacing,
            since_event,
            step_after_event,
            tangents,
            start,
            temperature,
            time_stepping,
            mode_changes_per_step,
        } = self;
        *temperature = other.temperature;
        (*carrier, *s, *energies, *counters) = (other.carrier, other.s, other.energies, other.counters);
        (*event_spacing, *since_event) = (other.event_spacing, other.since_event);
        (*step_size, *tangents, *rates_valid) = (other.step_size, other.tangents, other.rates_valid);
        (*start, *time_stepping) = (other.start, other.time_stepping);
        *step_after_event = other.step_after_event;
        *mode_changes_per_step = other.mode_changes_per_step;
        layer.copy_from(&other.layer);
    }

    /// The time reached, s.
    pub(super) fn time(&self) -> f64 {
        self.carrier.time + self.s
    }

    /// u and w, m.
    pub(super) fn displacement(&self) -> (f64, f64) {
        self.displacement_at(self.s)
    }

    /// u and w `s` seconds after the start of the carrier's piece, m.
    pub(super) fn displacement_at(&self, s: f64) -> (f64, f64) {
        let point = self.carrier.at(s);
        (self.carrier.u + point.du, self.carrier.w + point.dw)
    }

    /// A step of length `h` (s) from here.
    pub(super) fn span(&self, h: f64) -> StepSpan {
        StepSpan { start: self.s, length: h }
    }

    /// The carrier's position over the profile.
    pub(super) fn carrier_position(&self) -> CarrierPosition {
        self.carrier.position(self.s)
    }

    /// Includes the event that has just come in the mean time between events.
    pub(super) fn record_event(&mut self) {
        // A mean from long ago counts no more than the latest.
        let mean = self.event_spacing.min(self.since_event / SPACING_GAIN);
        let latest = mean + SPACING_GAIN * (self.since_event - mean);
        self.event_spacing = latest.max(MIN_SPACING * self.step_size);
        self.since_event = 0.0;
    }
}

/// What of a scene a run needs beside the model.
#[derive(Clone, Debug)]
pub(super) struct Settings {
    pub tolerance: Tolerance,
    pub events: EventTolerance,
    pub max_steps: u64,
    pub accounts: Accounts,
    pub method: Method,
    /// Whether these are the settings of a window's run.
    pub is_of_window: bool,
}

impl Settings {
    /// The settings of a window of a layer with these.
    pub(super) fn of_window(&self) -> Self {
        let accounts = Accounts { energy: self.accounts.energy, ..Accounts::default() };
        Self { accounts, method: Method::Event, is_of_window: true, ..self.clone() }
    }

    /// What the steps compute in addition to the state.
    pub(super) fn tracked(&self) -> Tracked {
        Tracked { energy: self.accounts.energy, tangents: self.accounts.tangents }
    }

    pub(super) fn new(scene: &Scene, model: &Model) -> Self {
        let tolerance = Tolerance::new(model, scene.solver.relative_tolerance, scene.absolute_tolerance());
        let events = EventTolerance::new(model, &tolerance);
        Self {
            tolerance,
            events,
            max_steps: scene.solver.max_steps,
            accounts: Accounts::new(scene),
            method: scene.solver.method,
            is_of_window: false,
        }
    }
}

/// A run of a layer. Everything but `state` can be made anew from the model and the settings.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) model: Arc<Model>,
    pub(super) settings: Settings,
    pub(super) state: RunState,
    pub(super) workspace: Workspace,
    /// The record of mode changes, where one is kept.
    pub(super) mode_changes: Option<Vec<ModeChange>>,
    /// The record of switches between the methods, where one is kept.
    pub(super) method_switches: Option<Vec<MethodSwitch>>,
}

/// Workspace of the steps of one run: nothing in it outlives a motion.
#[derive(Clone, Debug)]
pub(super) struct Workspace {
    /// Forces in the state evaluated last.
    pub forces: Forces,
    pub integrator: Integrator,
    /// The state within the step tried last.
    pub interpolated: State,
    /// At which step length and fraction that is; `None` where it is not of the step tried last.
    pub interpolated_at: Option<(f64, f64)>,
    pub dense: DenseWorkspace,
    pub end_correction: EndCorrection,
    /// The steps of the motion under way that make no progress.
    pub stall: Stall,
    /// The windows of event-driven steps; `None` where they would not be much smaller than the layer.
    pub windows: Option<Box<Windows>>,
    /// Whether the motion under way may open them.
    pub may_open_windows: bool,
    /// The modes before the mode changes under way.
    pub modes_before: Vec<Mode>,
    /// The run before the motion under way; `None` in a window, which is never rolled back.
    checkpoint: Option<Box<RunState>>,
    /// How long its records were then.
    recorded: [usize; 2],
}

impl Run {
    /// A run with the layer placed under the carrier at `start`; on the heap, since threads of hosts may have small stacks.
    pub(super) fn new(
        model: Arc<Model>,
        settings: Settings,
        start: &Start,
        bodies: &[Option<BodyStart>; 2],
    ) -> Box<Self> {
        let state = RunState::new(&model, start, bodies, settings.method == Method::Step);
        let windows = Windows::new(&model, &settings);
        let workspace = Workspace {
            forces: Forces::new(&model),
            integrator: Self::integrator(&model, &settings),
            interpolated: State::new(model.masses(), model.maxwell_variables()),
            interpolated_at: None,
            dense: DenseWorkspace::new(&model),
            end_correction: EndCorrection::new(&model, settings.method != Method::Event),
            stall: Stall::new(&model),
            windows,
            may_open_windows: true,
            modes_before: state.layer.state.mode.clone(),
            checkpoint: (!settings.is_of_window).then(|| Box::new(state.clone())),
            recorded: [0; 2],
        };
        let mut run = Box::new(Self { model, settings, state, workspace, mode_changes: None, method_switches: None });
        run.keep_link_forces();
        run.place_layer();
        run
    }

    /// Puts the masses at their rest positions, or on the profile, and decides the first modes.
    fn place_layer(&mut self) {
        let at = self.state.carrier_position();
        let carrier = self.state.carrier.at(0.0);
        let (model, layer, forces) = (&*self.model, &mut self.state.layer.state, &mut self.workspace.forces);
        place_layer(model, layer, at, &carrier);
        forces.evaluate(model, layer, &carrier);
        free_unloaded(model, layer, at, forces);
        decide_modes(model, layer, forces);
        let of_layer = kinetic_energy(model, layer) + elastic_energy(model, layer);
        self.state.energies.initial = of_layer + self.state.carrier.energy(model, 0.0).total();
    }

    /// Memory in bytes, without some hundreds that do not grow with the layer.
    pub(super) fn bytes(&self) -> usize {
        let layer = &self.state.layer.state;
        let (masses, maxwell) = (layer.mode.len(), layer.maxwell.len());
        // The state, the one within a step, the stage's and the checkpoint.
        let states = 3 + usize::from(self.workspace.checkpoint.is_some());
        let by_mass = 4 * size_of::<f64>() + size_of_val(&layer.surface[0]) + 1;
        states * (masses * by_mass + maxwell * size_of::<f64>())
            + self.workspace.integrator.bytes()
            + 2 * self.workspace.forces.bytes()
            + self.workspace.dense.bytes()
            + self.workspace.windows.as_ref().map_or(0, |windows| windows.bytes())
    }

    pub(super) fn newton_iterations(&self) -> u64 {
        let in_windows = self.workspace.windows.as_ref().map_or(0, |windows| windows.newton_iterations());
        self.workspace.integrator.iterations() + in_windows
    }

    /// Keeps the run as it stands, to roll back to.
    pub(super) fn keep_checkpoint(&mut self) {
        if let Some(checkpoint) = &mut self.workspace.checkpoint {
            checkpoint.copy_from(&self.state);
        }
        let lengths = (self.mode_changes.as_ref().map(Vec::len), self.method_switches.as_ref().map(Vec::len));
        self.workspace.recorded = [lengths.0.unwrap_or(0), lengths.1.unwrap_or(0)];
    }

    pub(super) fn roll_back(&mut self) {
        let [mode_changes, method_switches] = self.workspace.recorded;
        if let Some(checkpoint) = &self.workspace.checkpoint {
            self.state.copy_from(checkpoint);
        }
        if let Some(record) = &mut self.mode_changes {
            record.truncate(mode_changes);
        }
        if let Some(record) = &mut self.method_switches {
            record.truncate(method_switches);
        }
    }

    /// Begins a smooth piece of the carrier's motion. At a kink the damper forces jump, so all modes are decided anew.
    pub(super) fn enter(&mut self, motion: &Motion) {
        let state = &mut self.state;
        let rates = |carrier: &Carrier, s: f64| (carrier.at(s).u_rate, carrier.at(s).w_rate);
        let before = rates(&state.carrier, state.s);
        let piece = Piece { paths: (motion.u, motion.w), forces: (motion.pull, motion.load) };
        let jumps = state.carrier.begin(state.s, &piece, &self.model);
        state.s = 0.0;
        self.workspace.stall.reset();
        self.forget_windows();
        self.workspace.integrator.begin_tangents(motion.duration);
        if !self.state.rates_valid || rates(&self.state.carrier, 0.0) != before {
            self.change_modes(0.0);
            return;
        }
        if jumps {
            self.accelerate_bodies();
        }
        if self.workspace.integrator.has_tangents() {
            self.evaluate_forces();
            self.refresh_tangents();
        }
    }

    /// The layer's temperature before the motion under way, K; 0 where it is no input.
    pub(super) fn temperature_before(&self) -> f64 {
        self.workspace.checkpoint.as_ref().map_or(self.state.temperature, |before| before.temperature)
    }

    /// Takes over another temperature (K) and the settings for the model there, which is set. The dampers' forces jump, so the
    /// next motion decides all modes anew.
    pub(super) fn heat(&mut self, temperature: f64, settings: Settings) {
        self.settings = settings;
        (self.state.temperature, self.state.rates_valid) = (temperature, false);
        self.workspace.integrator = Self::integrator(&self.model, &self.settings);
        self.workspace.dense = DenseWorkspace::new(&self.model);
        self.keep_link_forces();
        if let Some(windows) = &mut self.workspace.windows {
            windows.heat(&self.model, &self.settings);
        }
    }

    /// Lets the integrator keep what the energies of windows need.
    fn keep_link_forces(&mut self) {
        if self.workspace.windows.is_some() {
            self.workspace.integrator.keep_link_forces(&self.model);
        }
    }

    fn integrator(model: &Model, settings: &Settings) -> Integrator {
        let pair = Pair::at_tolerance(model, settings.tolerance.relative);
        let steps = match settings.method {
            Method::Event => Steps::EventDriven(pair),
            Method::Step => Steps::TwoStages,
            Method::Auto => Steps::Both(pair),
        };
        Integrator::new(model, settings.tracked(), steps)
    }

    /// Computes the bodies' accelerations anew from the forces, of which one from outside has jumped. No force on a mass has.
    fn accelerate_bodies(&mut self) {
        self.evaluate_forces();
        let Self { model, state, workspace, .. } = self;
        state.carrier.accelerate(model, state.s, &workspace.forces);
    }

    /// Refuses bodies that have left the range of possible numbers.
    pub(super) fn check_bodies(&self) -> Result<(), OutOfRange> {
        if !self.state.carrier.has_bodies() {
            return Ok(());
        }
        let (u, w) = self.state.displacement();
        let point = self.state.carrier.at(self.state.s);
        let numbers = [("u", u), ("w", w), ("rate of u", point.u_rate), ("rate of w", point.w_rate)];
        match numbers.into_iter().find(|(_, value)| !is_possible(*value)) {
            Some((what, value)) => Err(OutOfRange { what, value }),
            None => Ok(()),
        }
    }

    /// Lets the bodies follow the step of length `h` (s) tried last.
    pub(super) fn trace_bodies(&mut self, h: f64) {
        let Self { state, workspace, .. } = self;
        for axis in Axis::ALL {
            if state.carrier.is_body(axis) {
                state.carrier.set_step(axis, workspace.integrator.body_step(axis, h, state.time_stepping));
            }
        }
    }

    /// The impacts due, stops, then every contact decided anew from the forces, which have jumped; and the rates after
    /// that. Masses within `reach` (m) of the profile count as touching.
    pub(super) fn change_modes(&mut self, reach: f64) {
        let carrier = self.state.carrier.at(self.state.s);
        let at = self.state.carrier_position();
        let Self { model, state: run, workspace, .. } = self;
        let (layer, forces) = (&mut run.layer.state, &mut workspace.forces);
        workspace.modes_before.copy_from_slice(&layer.mode);
        run.energies.impact += impacts_due(model, layer, at, reach, &mut run.energies.channels);
        stop_reversed(model, layer, forces, &mut run.energies.channels);
        forces.evaluate(model, layer, &carrier);
        decide_modes(model, layer, forces);
        run.carrier.accelerate(model, run.s, forces);
        workspace.integrator.evaluate_start(model, &mut run.layer, (&run.carrier, run.s), forces, run.step_size);
        run.rates_valid = true;
        self.refresh_tangents();
        self.count_mode_changes();
    }

    /// Counts and records what has changed since the modes before.
    pub(super) fn count_mode_changes(&mut self) {
        let time = self.state.time();
        let modes = self.workspace.modes_before.iter().zip(&self.state.layer.state.mode).enumerate();
        for (mass, (from, to)) in modes.filter(|(_, (from, to))| from != to) {
            self.state.counters.events += 1;
            if let Some(record) = &mut self.mode_changes {
                record.push(ModeChange { time, mass, from: from.number(), to: to.number() });
            }
        }
    }

    /// Computes the rates at the start of the next step from the state alone.
    pub(super) fn evaluate_start(&mut self) {
        self.evaluate_forces();
        let Self { model, state, workspace, .. } = self;
        let (carrier, forces) = ((&state.carrier, state.s), &workspace.forces);
        workspace.integrator.evaluate_start(model, &mut state.layer, carrier, forces, state.step_size);
    }

    /// Evaluates the link forces in the current state and returns the carrier there.
    pub(super) fn evaluate_forces(&mut self) -> CarrierPoint {
        let carrier = self.state.carrier.at(self.state.s);
        self.workspace.forces.evaluate(&self.model, &self.state.layer.state, &carrier);
        carrier
    }

    /// F_z now, N.
    pub(super) fn force_z(&mut self) -> f64 {
        self.evaluate_forces();
        self.workspace.forces.on_carrier_z()
    }

    /// Whether F_z has reached the force `until`, N.
    pub(super) fn has_reached(&mut self, until: Option<f64>) -> bool {
        until.is_some_and(|force| self.force_z() >= force)
    }

    /// Ḟ_x and Ḟ_z, N/s, from the left; at the start, from the right.
    pub(super) fn force_rates(&mut self) -> (f64, f64) {
        if !self.state.rates_valid {
            self.accelerate_bodies();
            let Self { model, state, workspace, .. } = self;
            let (carrier, forces) = ((&state.carrier, state.s), &workspace.forces);
            workspace.integrator.evaluate_start(model, &mut state.layer, carrier, forces, state.step_size);
        }
        let (layer, carrier) = (&self.state.layer, self.state.carrier.at(self.state.s));
        layer.rates.on_carrier(&self.model, &layer.state.maxwell, &carrier)
    }

    /// Finds the tangents of the motion that ends here.
    pub(super) fn find_tangents(&mut self) {
        if self.workspace.integrator.has_tangents() {
            self.state.tangents = self.workspace.integrator.tangents(&self.model, self.state.s);
        }
    }

    /// The tangents' rates from the forces evaluated last.
    fn refresh_tangents(&mut self) {
        let Self { model, state, workspace, .. } = self;
        workspace.integrator.refresh_tangents(model, &state.layer, &workspace.forces, state.s);
    }

    /// See [`Simulation::relax_dashpots`](super::Simulation::relax_dashpots).
    pub(super) fn relax_dashpots(&mut self, means: &[f64], time: f64) -> f64 {
        let mut borne = 0.0;
        for row in self.model.rows.iter().filter(|row| !row.kind.is_along_x()) {
            let x = time / row.relaxation_time;
            let left = if x > 0.0 { x / x.exp_m1() } else { 1.0 };
            let elements = &mut self.state.layer.state.maxwell[row.range.clone()];
            for (a, mean) in elements.iter_mut().zip(&means[row.range.clone()]) {
                *a -= left * mean;
            }
            if row.kind == LinkKind::Vertical {
                borne += row.stiffness * means[row.range.clone()].iter().sum::<f64>();
            }
        }
        // The forces have jumped: the next motion decides all contacts anew.
        self.state.rates_valid = false;
        borne
    }

    /// See [`Simulation::lower_carrier`](super::Simulation::lower_carrier).
    pub(super) fn lower_carrier(&mut self, way: f64) {
        self.state.carrier.w -= way;
        let elongations = &mut self.state.layer.state.elongation_z;
        elongations.iter_mut().for_each(|elongation| *elongation += way);
        self.state.rates_valid = false;
    }
}

/// Steps that make no progress because rounding makes events.
///
/// Where a mass is so fast that the rounding of its velocity, divided by the length of a short step, is an inertia force
/// larger than the tolerance of events, an event is found at the start of each such step but is not due at its end. The
/// run would cut every step to the resolution of time. After some of these steps in a row, the shortest length that a
/// step is cut to therefore doubles with each, until a mode changes or no event is found.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stall {
    /// Steps cut to this length, s, or less are suspected.
    length: f64,
    /// Number of steps cut so short after which no mode changed, less the number of other steps since.
    steps: u32,
    /// Number of mode changes before the last step, if it was cut so short.
    events_before: Option<u64>,
}

impl Stall {
    pub(super) fn new(model: &Model) -> Self {
        Self { length: STALLED / model.stiffest_frequency(), ..Self::default() }
    }

    pub(super) fn reset(&mut self) {
        (self.steps, self.events_before) = (0, None);
    }

    /// The shortest length, s, that the next step may be cut to; `shortest` (s) is the resolution of time, `events` the
    /// number of mode changes so far.
    pub(super) fn shortest_cut(&mut self, shortest: f64, events: u64) -> f64 {
        if self.events_before.take() == Some(events) {
            self.steps += 1;
        } else {
            self.steps = self.steps.saturating_sub(1);
        }
        shortest * f64::from(self.steps.saturating_sub(MAX_STALLED)).exp2()
    }

    /// Records a step of length `h` (s) that is about to be accepted, and whether an event has cut it; `events` is the
    /// number of mode changes before it.
    pub(super) fn record_step(&mut self, h: f64, cut: bool, events: u64) {
        self.events_before = (cut && h <= self.length).then_some(events);
    }
}
