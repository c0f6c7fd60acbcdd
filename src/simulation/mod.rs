//! A simulation: joins the integrator and the contact laws into a run that follows the carrier's motion.
//!
//! - [`Simulation`] is the public face: a `run` and, where the group `solver` asks for its error, a reference run. It
//!   shows the rows of a motion by a `sampler`.
//! - `run` joins what a run is made of; the comment on its type has the course of a step.
//! - `context` is what the steps work on: all that changes in a run (`state`), and the workspace that the methods
//!   share.
//! - `stepper` is what the steps of both methods have in common; `event_driven` and `time_stepping` are the two. A
//!   `controller` chooses their lengths.
//! - `local_regions` take the mode changes of an event-driven step in steps of the masses near them alone.
//! - `reference_run` estimates the run's error.
//! - `rows` are those of a run along a scene's own excitation; `passed` warns of phases of it that are left at once.

mod context;
mod controller;
#[cfg(test)]
mod derivative_tests;
mod event_driven;
mod local_regions;
mod motion;
mod passed;
mod reference_run;
mod rows;
mod run;
mod sampler;
mod settings;
mod state;
mod stepper;
#[cfg(test)]
mod tests;
mod time_stepping;

use std::sync::Arc;

use crate::model::Model;
use crate::outputs::{Output, Snapshot, Variable};
use crate::scene::{Axis, ByAxis, ParameterError, Scene};
use context::RunContext;
use controller::{WorkLimit, work_of_step};
pub use motion::Interrupt;
pub use motion::{Inaccuracy, MethodSwitch, ModeChange, Motion, OutOfRange, SimulationError, Start};
pub use passed::{passed_phase, passed_phases};
use reference_run::ReferenceRun;
pub use rows::{ResultRow, ResultRows, run};
use run::Run;
use sampler::RowSampler;
use settings::Settings;
use settings::body_starts;
use state::check_length;
pub use state::{SimulationRestoreError, SimulationState};

/// A run of a scene.
///
/// A clone goes on exactly as the original, bit for bit.
#[derive(Clone, Debug)]
pub struct Simulation {
    run: Run,
    /// A more accurate one, where its error is asked for.
    reference_run: Option<ReferenceRun>,
    /// The scene where its temperature is an input.
    scene: Option<Arc<Scene>>,
    /// Processor time since the start, s. It is not part of the run's state: a run restored from another's state keeps
    /// its own.
    run_time: f64,
    /// What is left to the run, and to the reference run: see [`limit_work`](Self::limit_work).
    max_mass_steps: u64,
    /// What may stop it.
    interrupt: Option<Interrupt>,
}

impl Simulation {
    /// Starts a run of `scene`: the layer hangs under the carrier, at rest or moving with it, and masses that would lie
    /// under the profile are lifted onto it (docs/model.md, section 5).
    ///
    /// # Errors
    /// [`SimulationError::OutOfRange`] where `start` is not finite, [`SimulationError::Scene`] where parameters set one
    /// by one do not go together, [`SimulationError::Memory`] where the machine does not have it.
    pub fn new(scene: &Scene, start: &Start) -> Result<Self, SimulationError> {
        start.check()?;
        scene.check()?;
        settings::check(scene)?;
        scene.check_equilibrium(start.load)?;
        let Some(wlf) = scene.material.as_ref().and_then(|material| material.wlf).filter(|_| scene.temperature_input)
        else {
            return Ok(Self::started(scene, &Start { temperature: None, ..*start }));
        };
        let temperature = start.temperature.unwrap_or(wlf.temperature);
        let start = Start { temperature: Some(temperature), ..*start };
        Ok(Self::started(&scene.at_temperature(temperature)?, &start))
    }

    /// Memory in bytes that a run of `scene` takes. It is an upper bound that tests hold against what runs allocate.
    pub fn memory(scene: &Scene) -> usize {
        settings::of_run(scene)
    }

    fn started(scene: &Scene, start: &Start) -> Self {
        let mut model = Model::new(scene);
        let bodies = body_starts(scene, &model, start);
        let prescribed = ByAxis { x: start.u, z: start.w };
        let at = |axis| bodies[axis].map_or(prescribed[axis], |body| body.displacement);
        model.freeze_dashpots(ByAxis::from_fn(at));
        let model = Arc::new(model);
        let settings = Settings::new(scene, &model);
        let reference_run = settings.accounts.solver.then(|| ReferenceRun::new(&model, &settings, start, &bodies));
        Self {
            run: Run::new(model, settings, start, &bodies),
            reference_run,
            scene: scene.temperature_input.then(|| Arc::new(scene.clone())),
            run_time: 0.0,
            max_mass_steps: u64::MAX,
            interrupt: None,
        }
    }

    /// The state of the simulation.
    pub fn state(&self) -> SimulationState {
        let reference_run = self.reference_run.as_ref().map(|reference| reference.run.context.state.clone());
        SimulationState { run: self.run.context.state.clone(), reference_run }
    }

    /// As [`state`](Self::state), into a state that there is; allocates nothing where that is of the same scene.
    pub fn save_into(&self, state: &mut SimulationState) {
        state.copy_runs(self.runs().map(|run| &run.context.state));
    }

    /// Counts a communication step of a master that was done again from its start.
    pub fn count_repetition(&mut self) {
        self.run.context.state.counters.repeated += 1;
    }

    /// A simulation of `scene` in `state`: it goes on bit for bit as the one whose state this is.
    ///
    /// # Errors
    /// [`SimulationRestoreError`] where `state` is not that of a run of this scene.
    pub fn restore(scene: &Scene, state: &SimulationState) -> Result<Self, SimulationRestoreError> {
        scene.check()?;
        let mut simulation = Self::started(scene, &Start::default());
        simulation.set_state(state)?;
        Ok(simulation)
    }

    /// Puts the simulation in `state`, of the same scene.
    ///
    /// # Errors
    /// [`SimulationRestoreError`] where `state` is not that of a run of this scene; the simulation is then as it was.
    pub fn set_state(&mut self, state: &SimulationState) -> Result<(), SimulationRestoreError> {
        let expected = usize::from(self.reference_run.is_some());
        check_length("reference runs", usize::from(state.reference_run.is_some()), expected)?;
        for (run, state) in self.runs().zip(state.states()) {
            state.check(&run.context.state, &run.context.model, &run.context.settings)?;
        }
        Ok(self.continue_from(state)?)
    }

    /// Continues from `state`, which a run of the same scene has saved, or which was checked when it was read; allocates
    /// nothing.
    ///
    /// # Errors
    /// [`ParameterError`] where the scene has no model at the state's temperature, which none of its runs reaches.
    pub fn continue_from(&mut self, state: &SimulationState) -> Result<(), ParameterError> {
        if state.run.start != self.run.context.state.start {
            self.freeze_dashpots(state.run.start);
        }
        if state.run.temperature != self.run.context.state.temperature {
            self.set_temperature(state.run.temperature)?;
        }
        for (run, state) in self.runs_mut().zip(state.states()) {
            let RunContext { model, settings, state: present, .. } = &mut *run.context;
            present.restore(state, model, settings.method);
        }
        Ok(())
    }

    /// The run, and the reference run where there is one.
    fn runs(&self) -> impl Iterator<Item = &Run> {
        std::iter::once(&self.run).chain(self.reference_run.as_ref().map(|reference| &reference.run))
    }

    fn runs_mut(&mut self) -> impl Iterator<Item = &mut Run> {
        std::iter::once(&mut self.run).chain(self.reference_run.as_mut().map(|reference| &mut reference.run))
    }

    /// Makes the model that of a run that started at these u and w, m.
    fn freeze_dashpots(&mut self, start: ByAxis<f64>) {
        Arc::make_mut(&mut self.run.context.model).freeze_dashpots(start);
        self.share_model();
    }

    /// Makes the model that of the layer at another temperature, K.
    fn set_temperature(&mut self, temperature: f64) -> Result<(), ParameterError> {
        let Some(scene) = &self.scene else { return Ok(()) };
        let scene = scene.at_temperature(temperature)?;
        Arc::make_mut(&mut self.run.context.model).set_temperature(&scene);
        self.share_model();
        let settings = Settings::new(&scene, &self.run.context.model);
        if let Some(reference) = &mut self.reference_run {
            reference.run.set_temperature(temperature, settings.tighter(&self.run.context.model));
        }
        self.run.set_temperature(temperature, settings);
        Ok(())
    }

    /// Gives the reference run the model of the run, which has changed.
    fn share_model(&mut self) {
        if let Some(reference) = &mut self.reference_run {
            reference.run.context.model = Arc::clone(&self.run.context.model);
        }
    }

    /// Lets `interrupt` stop motions from now on, those of clones too; `None`: nothing does.
    pub fn set_interrupt(&mut self, interrupt: Option<Interrupt>) {
        self.interrupt = interrupt;
    }

    /// The time reached, s.
    pub fn time(&self) -> f64 {
        self.run.context.state.time()
    }

    /// The layer's temperature, K; `None` where it is no input.
    pub fn temperature(&self) -> Option<f64> {
        self.scene.as_ref().map(|_| self.run.context.state.temperature)
    }

    /// Displacement of the carrier: u and w, m.
    pub fn carrier(&self) -> (f64, f64) {
        let ByAxis { x: u, z: w } = self.run.context.state.displacement();
        (u, w)
    }

    /// Displacements of the carrier where they are prescribed, of the drive where the carrier is a body: û and ŵ, m.
    pub fn driven(&self) -> (f64, f64) {
        let (carrier, s) = (&self.run.context.state.carrier, self.run.context.state.s);
        let (u, w) = self.carrier();
        (carrier.drive(Axis::X, s).unwrap_or(u), carrier.drive(Axis::Z, s).unwrap_or(w))
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
    /// A snapshot within a step is interpolated: it can be looked at, but neither cloned into a simulation nor
    /// advanced.
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
        self.runs_mut().for_each(Run::keep_checkpoint);
        let mut sampler = RowSampler::new(times, (self.run_time, self.reference_run.is_some()), observe);
        let result = self.follow(motion, until_force, &mut sampler);
        if result.is_ok() {
            self.run_time = sampler.run_time();
        } else {
            self.restore_temperature();
            self.runs_mut().for_each(Run::roll_back);
            self.reference_run.iter_mut().for_each(ReferenceRun::discard_pending);
        }
        result
    }

    /// The model at the temperature of the checkpoint, which a motion that fails may have changed.
    fn restore_temperature(&mut self) {
        let before = self.run.temperature_before();
        if before != self.run.context.state.temperature {
            // It was that of the run before: it is valid.
            let _ = self.set_temperature(before);
        }
    }

    /// [`advance_observed`](Self::advance_observed) without rollback: after an error the run stands anywhere within the
    /// motion. The course of a step is at [`Run`].
    fn follow(
        &mut self,
        motion: &Motion,
        until_force: Option<f64>,
        sampler: &mut RowSampler<'_, impl FnMut(f64, &Snapshot<'_>)>,
    ) -> Result<Option<f64>, SimulationError> {
        sampler.show(&mut self.run, &mut self.reference_run, 0.0);
        if self.run.has_reached(until_force) {
            return Ok(Some(0.0));
        }
        if let Some(kelvin) = motion.temperature.filter(|&kelvin| kelvin != self.run.context.state.temperature) {
            self.set_temperature(kelvin)?;
        }
        self.run.begin(motion);
        self.run.allow_local_regions(until_force.is_none());
        self.reference_run.iter_mut().for_each(|reference| reference.begin(motion, self.max_mass_steps));
        let mut work = WorkLimit::new(self.run.context.settings.max_steps, self.max_mass_steps);
        let mut reached = self.run.has_reached(until_force);
        while self.run.context.state.s < motion.duration && !reached {
            if self.interrupt.as_ref().is_some_and(Interrupt::is_wanted) {
                return Err(SimulationError::Interrupted { time: self.time() });
            }
            // A good step, which may end where F_z reaches the force.
            let step = self.run.next_step(motion.duration, &mut work)?;
            let at_force = self.run.cut_at_force(&step, until_force, &mut work)?;
            let (mut step, ends_at_force) = at_force.unwrap_or((step, false));
            if let Some(reference) = &mut self.reference_run {
                reference.record_step(step.h, work.tried);
            }
            // The rows within it, and its local regions.
            let (run, reference) = (&mut self.run, &mut self.reference_run);
            let (end, shortened) = sampler.show_within(run, reference, &mut step, motion.duration, &mut work)?;
            // It is accepted.
            run.take_step(&step, end);
            run.context.state.check_bodies()?;
            reached = (ends_at_force && !shortened) || run.has_reached(until_force);
            if reached || end >= motion.duration {
                run.context.find_tangents();
            }
            sampler.show(run, reference, end);
        }
        self.end_reference_run();
        self.max_mass_steps = work.mass_steps;
        Ok(reached.then_some(self.run.context.state.s))
    }

    /// Ends the motion of the reference run where the run stands.
    fn end_reference_run(&mut self) {
        if let Some(reference) = &mut self.reference_run {
            let s = self.run.context.state.s;
            let mut snapshot = self.run.snapshot();
            reference.compare(s, &mut snapshot);
            self.run.context.state.counters = snapshot.counters;
            reference.end_motion(&self.run.context.state);
        }
    }

    /// The run as it stands.
    pub fn snapshot(&mut self) -> Snapshot<'_> {
        Snapshot { run_time: self.run_time, ..self.run.snapshot() }
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
    pub fn force_rates(&mut self) -> ByAxis<f64> {
        self.run.context.force_rates()
    }

    /// The first derivative of F_x, F_z or a variable of the carrier's motion, in its unit over s, from the left; at
    /// the start, from the right. 0 for other outputs.
    pub fn output_rate(&mut self, output: Output) -> f64 {
        let force_rates = self.run.context.force_rates();
        let (carrier, s) = (&self.run.context.state.carrier, self.run.context.state.s);
        let point = carrier.at(s);
        let drive = |axis| {
            let model = &self.run.context.model;
            carrier.outside(model, axis, s).map_or(0.0, |(body, outside)| outside.drive_force_rate(body))
        };
        match output {
            Output::ForceX => force_rates.x,
            Output::ForceZ => force_rates.z,
            Output::CarrierU => point.x.speed,
            Output::CarrierW => point.z.speed,
            Output::CarrierURate => point.x.acceleration,
            Output::CarrierWRate => point.z.acceleration,
            Output::DriveX => drive(Axis::X),
            Output::DriveZ => drive(Axis::Z),
            _ => 0.0,
        }
    }

    /// a_j = e - y_j of every Maxwell element, m, in the order of [`State::maxwell`](crate::model::State::maxwell).
    pub fn maxwell_elongations(&self) -> &[f64] {
        &self.run.context.state.layer.state.maxwell
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
        self.run.context.relax_dashpots(means, time)
    }

    /// Moves a carrier that is a body along z down by `way`, m, its speed kept and the masses where they are: the
    /// vertical springs in contact bear so much more.
    ///
    /// The energies since the start no longer balance.
    pub fn lower_carrier(&mut self, way: f64) {
        self.run.context.lower_carrier(way);
    }

    /// Processor time since the start, s; measured where the group `solver` is asked for.
    pub fn run_time(&self) -> f64 {
        self.run_time
    }

    /// Limits the work of the motions that follow, beside `solver.max_steps`: the steps that are tried times the masses that
    /// take them, and a little for each step.
    pub fn limit_work(&mut self, max_mass_steps: u64) {
        self.max_mass_steps = max_mass_steps;
    }

    /// The steps of all masses that so much work allows.
    pub fn steps_within(scene: &Scene, max_mass_steps: u64) -> u64 {
        (max_mass_steps / work_of_step(scene.layer.masses)).max(1)
    }

    /// Sets the processor time since the start, s.
    pub fn set_run_time(&mut self, time: f64) {
        self.run_time = time;
    }

    /// What shows that the run so far is inaccurate: its forces, with the group `solver`, or its energies where they are
    /// asked for. Judged best at the end of a run: early in it the largest values, which errors are measured by, are still to
    /// come.
    pub fn inaccuracy(&mut self) -> Option<Inaccuracy> {
        let of_forces = self.reference_run.as_ref().and_then(|reference| reference.inaccuracy(&self.run));
        of_forces.or_else(|| self.run.energy_inaccuracy())
    }

    /// Newton's iterations since the start, those of rejected steps and of motions rolled back included.
    pub fn newton_iterations(&self) -> u64 {
        self.run.newton_iterations()
    }

    /// Whether the time-stepping method has the run now, or the event-driven one.
    pub fn is_time_stepping(&self) -> bool {
        self.run.context.state.time_stepping
    }

    /// Keeps a record of mode changes from now on, or stops keeping it.
    pub fn record_mode_changes(&mut self, on: bool) {
        self.run.context.mode_changes = on.then(Vec::new);
    }

    /// The mode changes recorded since the last call.
    pub fn take_mode_changes(&mut self) -> Vec<ModeChange> {
        self.run.context.mode_changes.as_mut().map(std::mem::take).unwrap_or_default()
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
