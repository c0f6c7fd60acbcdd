//! A simulation: joins the integrator and the contact laws into a run that follows the carrier's motion.
//!
//! - [`Simulation`] is the public face: a `run` and, where the group `solver` asks for its error, an
//!   error-estimation run beside it.
//! - `run` holds all that changes in a run (`RunState`), apart from its workspace; `state` saves and restores it.
//! - `driver` is the skeleton of both methods: step, mode changes, step; `event` and `time_stepping` are where they
//!   differ.
//! - `windows` takes the mode changes of an event-driven step in steps of the masses near them alone, each `window` a run of its
//!   own.
//! - `snapshot` shows the run at an instant, at the end of a step or within it.
//! - `error_run` estimates the run's error.

mod driver;
mod error_run;
mod event;
mod motion;
mod run;
mod snapshot;
mod start;
mod state;
#[cfg(test)]
pub(crate) mod tests;
mod time_stepping;
mod window;
mod windows;

use std::sync::Arc;

use cpu_time::ThreadTime;

use crate::model::Model;
use crate::outputs::{Counters, Output, Snapshot, Variable};
use crate::scene::{Axis, ParameterError, Scene};
use driver::{TrialStep, WorkLimit};
use error_run::ErrorRun;
pub use motion::{Divergence, MethodSwitch, ModeChange, Motion, OutOfRange, SimulationError, Start};
use run::{Run, Settings};
use start::body_starts;
use state::check_length;
pub use state::{RestoreError, SimulationState};

/// A run of a scene.
///
/// A clone goes on exactly as the original, bit for bit.
#[derive(Clone, Debug)]
pub struct Simulation {
    run: Box<Run>,
    /// A more accurate run beside it, where its error is asked for.
    error_run: Option<ErrorRun>,
    /// The scene where its temperature is an input.
    scene: Option<Arc<Scene>>,
    /// Processor time since the start, s. It is not part of the run's state: a run restored from another's state keeps
    /// its own.
    run_time: f64,
}

impl Simulation {
    /// Starts a run of `scene`: the layer hangs under the carrier, at rest or moving with it, and masses that would lie
    /// under the profile are lifted onto it (docs/model.md, section 5).
    ///
    /// # Errors
    /// [`SimulationError::OutOfRange`] where `start` is not finite, [`SimulationError::Scene`] where parameters set one
    /// by one do not go together.
    pub fn new(scene: &Scene, start: &Start) -> Result<Self, SimulationError> {
        start.check()?;
        scene.check()?;
        scene.check_equilibrium(start.load)?;
        let Some(wlf) = scene.material.as_ref().and_then(|material| material.wlf).filter(|_| scene.temperature_input)
        else {
            return Ok(Self::started(scene, &Start { temperature: None, ..*start }));
        };
        let temperature = start.temperature.unwrap_or(wlf.temperature);
        let start = Start { temperature: Some(temperature), ..*start };
        Ok(Self::started(&scene.at_temperature(temperature)?, &start))
    }

    fn started(scene: &Scene, start: &Start) -> Self {
        let mut model = Model::new(scene);
        let bodies = body_starts(scene, &model, start);
        let [u, w] = [(start.u, bodies[0]), (start.w, bodies[1])]
            .map(|(prescribed, body)| body.map_or(prescribed, |body| body.displacement));
        model.freeze_dashpots(u, w);
        let model = Arc::new(model);
        let settings = Settings::new(scene, &model);
        let error_run = settings.accounts.solver.then(|| ErrorRun::new(&model, &settings, start, &bodies));
        Self {
            run: Run::new(model, settings, start, &bodies),
            error_run,
            scene: scene.temperature_input.then(|| Arc::new(scene.clone())),
            run_time: 0.0,
        }
    }

    /// The state of the simulation.
    pub fn state(&self) -> SimulationState {
        let error_run = self.error_run.as_ref().map(|error_run| error_run.run.state.clone());
        SimulationState { run: self.run.state.clone(), error_run }
    }

    /// A simulation of `scene` in `state`: it goes on bit for bit as the one whose state this is.
    ///
    /// # Errors
    /// [`RestoreError`] where `state` is not that of a run of this scene.
    pub fn restore(scene: &Scene, state: &SimulationState) -> Result<Self, RestoreError> {
        scene.check()?;
        let mut simulation = Self::started(scene, &Start::default());
        simulation.set_state(state)?;
        Ok(simulation)
    }

    /// Puts the simulation in `state`, of the same scene.
    ///
    /// # Errors
    /// [`RestoreError`] where `state` is not that of a run of this scene; the simulation is then as it was.
    pub fn set_state(&mut self, state: &SimulationState) -> Result<(), RestoreError> {
        let expected = usize::from(self.error_run.is_some());
        check_length("error-estimation runs", usize::from(state.error_run.is_some()), expected)?;
        self.run.check_state(&state.run)?;
        if let (Some(error_run), Some(state)) = (&self.error_run, &state.error_run) {
            error_run.run.check_state(state)?;
        }
        if state.run.start != self.run.state.start {
            self.freeze_dashpots(state.run.start);
        }
        if state.run.temperature != self.run.state.temperature {
            self.heat(state.run.temperature)?;
        }
        self.run.set_state(&state.run);
        if let (Some(error_run), Some(state)) = (&mut self.error_run, &state.error_run) {
            error_run.run.set_state(state);
        }
        Ok(())
    }

    /// Makes the model that of a run that started at these u and w, m.
    fn freeze_dashpots(&mut self, [u, w]: [f64; 2]) {
        Arc::make_mut(&mut self.run.model).freeze_dashpots(u, w);
        if let Some(error_run) = &mut self.error_run {
            error_run.run.model = Arc::clone(&self.run.model);
        }
    }

    /// Makes the model that of the layer at another temperature, K.
    fn heat(&mut self, temperature: f64) -> Result<(), ParameterError> {
        let Some(scene) = &self.scene else { return Ok(()) };
        let scene = scene.at_temperature(temperature)?;
        Arc::make_mut(&mut self.run.model).set_temperature(&scene);
        self.run.heat(temperature, Settings::new(&scene, &self.run.model));
        if let Some(error_run) = &mut self.error_run {
            error_run.run.model = Arc::clone(&self.run.model);
            let settings = self.run.settings.tighter(&self.run.model);
            error_run.run.heat(temperature, settings);
        }
        Ok(())
    }

    /// The time reached, s.
    pub fn time(&self) -> f64 {
        self.run.state.time()
    }

    /// Displacement of the carrier: u and w, m.
    pub fn carrier(&self) -> (f64, f64) {
        self.run.state.displacement()
    }

    /// Displacements of the carrier where they are prescribed, of the drive where the carrier is a body: û and ŵ, m.
    pub fn driven(&self) -> (f64, f64) {
        let (carrier, s) = (&self.run.state.carrier, self.run.state.s);
        let (u, w) = self.carrier();
        (carrier.drive(Axis::X, s).unwrap_or(u), carrier.drive(Axis::Z, s).unwrap_or(w))
    }

    /// Memory of the simulation in bytes, without some hundreds that do not grow with the layer.
    pub fn bytes(&self) -> usize {
        self.run.bytes() + self.error_run.as_ref().map_or(0, ErrorRun::bytes)
    }

    /// Follows `motion` to its end.
    ///
    /// # Errors
    /// [`SimulationError`]; the simulation is then as it was before the call.
    pub fn advance(&mut self, motion: &Motion) -> Result<(), SimulationError> {
        self.advance_observed(motion, None, &[], |_, _| ()).map(|_| ())
    }

    /// Follows `motion` to its end or, with `until_force`, until F_z rises to that force (N).
    ///
    /// Calls `observe` at each of `times`, which rise from 0 to at most the duration, with the time since the start of
    /// the motion (s) and the run at that instant. Returns when the force was reached, s after the start of the motion:
    /// 0 if F_z is there already, `None` without a force or if it is not reached within the motion.
    ///
    /// A snapshot within a step is interpolated: it can be looked at, but neither cloned into a simulation nor advanced.
    ///
    /// ```compile_fail,E0308
    /// # use asperity::simulation::{Motion, Simulation};
    /// # fn observed(simulation: &mut Simulation, motion: &Motion, times: &[f64]) {
    /// let mut clones: Vec<Simulation> = Vec::new();
    /// let _ = simulation.advance_observed(motion, None, times, |_, snapshot| clones.push(snapshot.clone()));
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`SimulationError`]; the simulation is then as it was before the call.
    pub fn advance_observed(
        &mut self,
        motion: &Motion,
        until_force: Option<f64>,
        times: &[f64],
        observe: impl FnMut(f64, &Snapshot<'_>),
    ) -> Result<Option<f64>, SimulationError> {
        motion.check()?;
        self.run.keep_checkpoint();
        if let Some(error_run) = &mut self.error_run {
            error_run.keep_checkpoint();
        }
        let run_time = self.run_time;
        let result = self.follow(motion, until_force, times, observe);
        if result.is_err() {
            self.run_time = run_time;
            self.restore_temperature();
            self.run.roll_back();
            if let Some(error_run) = &mut self.error_run {
                error_run.roll_back();
            }
        }
        result
    }

    /// The model at the temperature of the checkpoint, which a motion that fails may have changed.
    fn restore_temperature(&mut self) {
        let before = self.run.temperature_before();
        if before != self.run.state.temperature {
            // It was that of the run before: it is valid.
            let _ = self.heat(before);
        }
    }

    /// [`advance_observed`](Self::advance_observed) without rollback: after an error the run stands anywhere within the
    /// motion.
    fn follow(
        &mut self,
        motion: &Motion,
        until_force: Option<f64>,
        times: &[f64],
        observe: impl FnMut(f64, &Snapshot<'_>),
    ) -> Result<Option<f64>, SimulationError> {
        let clock = self.run.settings.accounts.solver.then(ThreadTime::now);
        let mut observer = Observer { times, clock, run_time: self.run_time, observe };
        self.show_rows(0.0, &mut observer);
        if self.run.has_reached(until_force) {
            return Ok(Some(0.0));
        }
        if let Some(temperature) = motion.temperature.filter(|&temperature| temperature != self.run.state.temperature) {
            self.heat(temperature)?;
        }
        self.run.enter(motion);
        self.run.workspace.may_open_windows = until_force.is_none();
        if let Some(error_run) = &mut self.error_run {
            error_run.enter(motion);
        }
        let mut work = WorkLimit::new(self.run.settings.max_steps);
        let mut reached = self.run.has_reached(until_force);
        while self.run.state.s < motion.duration && !reached {
            let (mut step, at_force) = self.next_step(motion.duration, until_force, &mut work)?;
            let (end, shortened) = self.show_rows_within(&mut step, motion.duration, &mut work, &mut observer)?;
            self.run.take_step(&step, end);
            self.run.check_bodies()?;
            reached = (at_force && !shortened) || self.run.has_reached(until_force);
            if reached || end >= motion.duration {
                self.run.find_tangents();
            }
            self.show_rows(end, &mut observer);
        }
        self.end_error_run();
        self.run_time = observer.run_time_now();
        Ok(reached.then_some(self.run.state.s))
    }

    /// The next good step, and whether it was shortened to end where F_z reaches the force.
    fn next_step(
        &mut self,
        duration: f64,
        until_force: Option<f64>,
        work: &mut WorkLimit,
    ) -> Result<(TrialStep, bool), SimulationError> {
        let mut step = self.run.next_step(duration, work)?;
        let mut at_force = false;
        if let Some(share) = self.run.reaches_within(&step, until_force) {
            let h = share * step.h;
            step = self.run.cut_step(h, work)?;
            at_force = step.h == h;
        }
        if let Some(error_run) = &mut self.error_run {
            error_run.record_step(step.h, work.tried());
        }
        Ok((step, at_force))
    }

    /// Shows the rows that lie within `step`. Where its dense output is not good enough, the step is shortened to end at
    /// the row; where its windows cannot go on, it is cut there. Returns the end of the step, s after the start of the motion, and whether it was shortened.
    fn show_rows_within(
        &mut self,
        step: &mut TrialStep,
        duration: f64,
        work: &mut WorkLimit,
        observer: &mut Observer<'_, impl FnMut(f64, &Snapshot<'_>)>,
    ) -> Result<(f64, bool), SimulationError> {
        let (mut end, mut shortened) = (self.run.end_of(step, duration), false);
        while let Some(time) = observer.next_before(end) {
            if self.run.can_show_within(step, time) {
                end = self.run.advance_windows(step, (time, end), work)?;
                if time < end {
                    let theta = (time - self.run.state.s) / step.h;
                    self.show_within(step, theta, observer);
                }
            } else {
                (*step, end) = self.run.cut_step_at(time, duration, work)?;
                shortened = true;
            }
        }
        end = self.run.advance_windows(step, (end, end), work)?;
        Ok((end, shortened))
    }

    /// Shows the rows up to the time `end` of the motion, where the run stands.
    fn show_rows(&mut self, end: f64, observer: &mut Observer<'_, impl FnMut(f64, &Snapshot<'_>)>) {
        while let Some(time) = observer.next_up_to(end) {
            let s = self.run.state.s;
            let shown = observer.show(time, self.run.snapshot(0.0), s, self.error_run.as_mut());
            (self.run.state.counters, self.run_time) = shown;
        }
    }

    /// Shows the next row, which lies at the fraction `theta` of `step`.
    fn show_within(
        &mut self,
        step: &TrialStep,
        theta: f64,
        observer: &mut Observer<'_, impl FnMut(f64, &Snapshot<'_>)>,
    ) {
        let Some(time) = observer.next() else { return };
        let s = self.run.state.s + theta * step.h;
        let shown = observer.show(time, self.run.snapshot_within(step.h, theta, 0.0), s, self.error_run.as_mut());
        (self.run.state.counters, self.run_time) = shown;
    }

    /// Ends the motion of the error-estimation run where the run stands.
    fn end_error_run(&mut self) {
        if let Some(error_run) = &mut self.error_run {
            let s = self.run.state.s;
            let mut snapshot = self.run.snapshot(0.0);
            error_run.compare(s, &mut snapshot);
            self.run.state.counters = snapshot.counters;
            error_run.end_motion(&self.run.state);
        }
    }

    /// The run as it stands.
    pub fn snapshot(&mut self) -> Snapshot<'_> {
        self.run.snapshot(self.run_time)
    }

    /// Writes the values of `variables`, in their order, into `values`; Integers as whole numbers.
    pub fn evaluate(&mut self, variables: &[Variable], values: &mut [f64]) {
        self.snapshot().evaluate(variables, values);
    }

    /// Writes into `values` the derivatives of `variables` with respect to the carrier's displacement along `direction`
    /// (x and z, m per unit), all states held: positions, velocities, dashpots, modes.
    pub fn directional_derivative(&mut self, variables: &[Variable], direction: (f64, f64), values: &mut [f64]) {
        self.snapshot().differentiate(variables, direction, values);
    }

    /// Ḟ_x and Ḟ_z, N/s, from the left; at the start, from the right.
    pub fn force_rates(&mut self) -> (f64, f64) {
        self.run.force_rates()
    }

    /// The first derivative of F_x, F_z or a variable of the carrier's motion, in its unit over s, from the left; at the
    /// start, from the right. 0 for other outputs.
    pub fn output_rate(&mut self, output: Output) -> f64 {
        let (force_x, force_z) = self.run.force_rates();
        let (carrier, s) = (&self.run.state.carrier, self.run.state.s);
        let point = carrier.at(s);
        match output {
            Output::ForceX => force_x,
            Output::ForceZ => force_z,
            Output::CarrierU => point.u_rate,
            Output::CarrierW => point.w_rate,
            Output::CarrierURate => point.u_acceleration,
            Output::CarrierWRate => point.w_acceleration,
            Output::DriveX => carrier.drive_force_rate(&self.run.model, Axis::X, s),
            Output::DriveZ => carrier.drive_force_rate(&self.run.model, Axis::Z, s),
            _ => 0.0,
        }
    }

    /// a_j = e - y_j of every Maxwell element, m, in the order of [`State::maxwell`](crate::model::State::maxwell).
    pub fn maxwell_elongations(&self) -> &[f64] {
        &self.run.state.layer.state.maxwell
    }

    /// Takes off the elements of the links along z what they miss of steady motion: `means` are those of
    /// [`maxwell_elongations`](Self::maxwell_elongations) over the last `time` s, whole periods of the motion. Returns
    /// what the vertical elements bore in that mean, N: 0 in steady motion.
    ///
    /// In steady motion ẏ = a/τ is 0 in the mean, and so is a = e - y of every Maxwell element. Elements that relax in
    /// minutes take minutes to reach it, a waste where only the steady state is asked for. Where the elongation e is
    /// forced on a link, as by the profile along z, the deviation of an element from its steady motion decays as
    /// D e^{-t/τ}: in the mean over a time T of whole periods it is ā = D (τ/T)(1 - e^{-T/τ}), and at their end
    /// ā x/(eˣ - 1) of it are left, x = T/τ. So much is taken off: all of ā for an element slower than T, nothing for a
    /// fast one. Where masses touch and lift, e follows the dashpots a little, and a second time is needed.
    ///
    /// The energies since the start no longer balance.
    pub fn relax_dashpots(&mut self, means: &[f64], time: f64) -> f64 {
        self.run.relax_dashpots(means, time)
    }

    /// Moves a carrier that is a body along z down by `way`, m, its speed kept and the masses where they are: the vertical
    /// springs in contact bear so much more.
    ///
    /// The energies since the start no longer balance.
    pub fn lower_carrier(&mut self, way: f64) {
        self.run.lower_carrier(way);
    }

    /// Processor time since the start, s; measured where the group `solver` is asked for.
    pub fn run_time(&self) -> f64 {
        self.run_time
    }

    /// Sets the processor time since the start, s.
    pub fn set_run_time(&mut self, time: f64) {
        self.run_time = time;
    }

    /// Why the run so far does not converge; `None` where nothing shows that, or without the group `solver`. Judged best at
    /// the end of a run: early in it the largest forces, which errors are measured by, are still to come.
    pub fn divergence(&self) -> Option<Divergence> {
        self.error_run.as_ref().and_then(|error_run| error_run.divergence(&self.run))
    }

    /// Newton's iterations since the start, those of rejected steps and of motions rolled back included.
    pub fn newton_iterations(&self) -> u64 {
        self.run.newton_iterations()
    }

    /// Whether the time-stepping method has the run now, or the event-driven one.
    pub fn is_time_stepping(&self) -> bool {
        self.run.state.time_stepping
    }

    /// Keeps a record of mode changes from now on, or stops keeping it.
    pub fn record_mode_changes(&mut self, on: bool) {
        self.run.mode_changes = on.then(Vec::new);
    }

    /// The mode changes recorded since the last call.
    pub fn take_mode_changes(&mut self) -> Vec<ModeChange> {
        self.run.mode_changes.as_mut().map(std::mem::take).unwrap_or_default()
    }

    /// Keeps a record of switches between the methods from now on, or stops keeping it.
    pub fn record_method_switches(&mut self, on: bool) {
        self.run.method_switches = on.then(Vec::new);
    }

    /// The switches recorded since the last call.
    pub fn take_method_switches(&mut self) -> Vec<MethodSwitch> {
        self.run.method_switches.as_mut().map(std::mem::take).unwrap_or_default()
    }
}

/// The rows still to be shown of a motion, and the processor time.
struct Observer<'a, F> {
    times: &'a [f64],
    /// Runs where the processor time is asked for.
    clock: Option<ThreadTime>,
    /// Processor time before the motion, s.
    run_time: f64,
    observe: F,
}

impl<F: FnMut(f64, &Snapshot<'_>)> Observer<'_, F> {
    /// Shows `snapshot`, of the time `s` of the motion, as the row at `time`, compared with the `error_run`. Returns the
    /// counters then, and the processor time since the start, s.
    fn show(
        &mut self,
        time: f64,
        mut snapshot: Snapshot<'_>,
        s: f64,
        error_run: Option<&mut ErrorRun>,
    ) -> (Counters, f64) {
        if let Some(error_run) = error_run {
            error_run.compare(s, &mut snapshot);
        }
        snapshot.run_time = self.run_time_now();
        (self.observe)(time, &snapshot);
        (snapshot.counters, snapshot.run_time)
    }
}

impl<F> Observer<'_, F> {
    fn next(&mut self) -> Option<f64> {
        let (&time, rest) = self.times.split_first()?;
        self.times = rest;
        Some(time)
    }

    fn next_up_to(&mut self, end: f64) -> Option<f64> {
        if self.times.first().is_some_and(|&time| time <= end) { self.next() } else { None }
    }

    /// The time of the next row if it lies before `end`, s; it stays the next one.
    fn next_before(&self, end: f64) -> Option<f64> {
        self.times.first().copied().filter(|&time| time < end)
    }

    fn run_time_now(&self) -> f64 {
        self.run_time + self.clock.as_ref().map_or(0.0, |clock| clock.elapsed().as_secs_f64())
    }
}
