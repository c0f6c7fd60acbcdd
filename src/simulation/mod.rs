//! The conductor: joins the integrator and the contact rules into a run.

mod companion;
mod derivatives;
mod handover;
mod relaxation;
mod run;
mod saved;
mod stepping;
#[cfg(test)]
pub(crate) mod tests;
mod time_stepping;
mod within;

use std::sync::Arc;

use crate::contact::{EndCorrection, EventTolerance};
use crate::integrator::{DenseWorkspace, Integrator, Steps, Tolerance, Tracked};
use crate::model::{Forces, Model, State};
use crate::outputs::{self, Accounts, Variable};
use crate::scene::{LARGEST, Method, ParameterError, Path, Scene};
use companion::Companion;
pub use handover::Handover;
use run::{Checkpoint, Run};
pub use saved::{RestoreError, Saved};
use stepping::Crawl;

/// The carrier at the start of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Start {
    /// Time t_0, s.
    pub time: f64,
    /// Displacement along x, m.
    pub u: f64,
    /// Displacement along z, m; negative presses.
    pub w: f64,
    /// u̇ just after the start, m/s: the velocity that the layer starts with.
    pub u_rate: f64,
    /// ẇ just after the start, m/s.
    pub w_rate: f64,
}

/// One smooth piece of the carrier's motion, from where the carrier stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Duration, s.
    pub duration: f64,
    /// Displacement along x.
    pub u: Path,
    /// Displacement along z.
    pub w: Path,
}

/// The carrier's motion is not a number, or larger than [`LARGEST`].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the carrier's motion is out of range: {what} = {value:?}, expected a number up to ±{LARGEST:?}")]
pub struct OutOfRange {
    /// Which quantity.
    pub what: &'static str,
    /// Its value.
    pub value: f64,
}

/// Why a run could not go on; the simulation is as it was before the call.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// The steps allowed were used up.
    #[error("gave up at t = {time} s after {steps} steps, the limit solver.max_steps")]
    TooManySteps {
        /// Where the run stood, s.
        time: f64,
        /// The limit.
        steps: u64,
    },
    /// The step size fell to the resolution of time.
    #[error("the step size fell to {step} s at t = {time} s")]
    StepTooSmall {
        /// Where the run stood, s.
        time: f64,
        /// The step size, s.
        step: f64,
    },
    /// The carrier's motion is out of range.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// Parameters that do not go together, as [`Scene::check`] finds.
    #[error(transparent)]
    Scene(#[from] ParameterError),
}

/// What happened to one mass at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeChange {
    /// When, s.
    pub time: f64,
    /// Which mass, from 0.
    pub mass: usize,
    /// Mode before: 0 free, 1 or -1 slipping, 2 sticking.
    pub from: i8,
    /// Mode after.
    pub to: i8,
}

/// A run of a scene.
///
/// A clone is the whole of it: both go on alike, bit for bit.
#[derive(Clone, Debug)]
pub struct Simulation {
    model: Arc<Model>,
    settings: Settings,
    run: Run,
    /// The run as it was before the motion under way.
    before: Checkpoint,
    integrator: Integrator,
    forces: Forces,
    /// The state within a step, shown to observers.
    within: State,
    /// Of which step and fraction that is, where it is known.
    within_at: Option<(f64, f64)>,
    dense_workspace: DenseWorkspace,
    /// Mode changes at the end of a time step.
    step_end: EndCorrection,
    /// Steps of the motion under way that make no progress.
    crawl: Crawl,
    mode_changes: Option<Vec<ModeChange>>,
    handovers: Option<Vec<Handover>>,
    /// A finer run beside this one, where its error is asked for.
    companion: Option<Companion>,
}

/// What of a scene the conductor needs beside the model.
#[derive(Clone, Debug)]
struct Settings {
    tolerance: Tolerance,
    events: EventTolerance,
    max_steps: u64,
    accounts: Accounts,
    method: Method,
}

impl Settings {
    fn new(scene: &Scene, model: &Model) -> Self {
        let tolerance = Tolerance::new(model, scene.solver.relative_tolerance, scene.absolute_tolerance());
        let events = EventTolerance::new(model, &tolerance);
        Self {
            tolerance,
            events,
            max_steps: scene.solver.max_steps,
            accounts: Accounts::new(scene),
            method: scene.solver.method,
        }
    }
}

impl Simulation {
    /// Puts the layer under the carrier at rest or in motion; what lies under the profile is lifted onto it.
    ///
    /// # Errors
    /// [`SimulationError::OutOfRange`] where `start` is not finite, [`SimulationError::Scene`] where parameters set one
    /// by one do not go together.
    pub fn new(scene: &Scene, start: &Start) -> Result<Self, SimulationError> {
        start.check()?;
        scene.check()?;
        Ok(Self::started(scene, start))
    }

    fn started(scene: &Scene, start: &Start) -> Self {
        let mut model = Model::new(scene);
        model.freeze_dashpots(model.profile.reduce(start.u), start.w);
        let model = Arc::new(model);
        let settings = Settings::new(scene, &model);
        let finer = settings.accounts.solver.then(|| settings.finer(&model));
        let companion = finer.map(|finer| Companion::new(Self::with(Arc::clone(&model), finer, start)));
        Self { companion, ..Self::with(model, settings, start) }
    }

    fn with(model: Arc<Model>, settings: Settings, start: &Start) -> Self {
        let followed = Tracked { energy: settings.accounts.energy, tangents: settings.accounts.tangents };
        let steps = match settings.method {
            Method::Event => Steps::Accurate,
            Method::Step => Steps::TwoStages,
            Method::Auto => Steps::Both,
        };
        let integrator = Integrator::new(&model, followed, steps);
        let state = State::new(model.masses(), model.maxwell_variables());
        let run = Run::new(&model, state.clone(), start, settings.method == Method::Step);
        let forces = Forces::new(&model);
        let dense_workspace = DenseWorkspace::new(&model);
        let step_end = EndCorrection::new(&model);
        let crawl = Crawl::new(&model);
        let mut simulation = Self {
            model,
            settings,
            before: Checkpoint {
                run: run.clone(),
                rates: integrator.start_rates().clone(),
                exchange: integrator.start_exchange(),
            },
            run,
            integrator,
            forces,
            within: state,
            within_at: None,
            dense_workspace,
            step_end,
            crawl,
            mode_changes: None,
            handovers: None,
            companion: None,
        };
        simulation.place_layer();
        simulation
    }

    /// The time reached, s.
    pub fn time(&self) -> f64 {
        self.run.time()
    }

    /// Where the carrier stands: u and w, m.
    pub fn carrier(&self) -> (f64, f64) {
        self.run.displacement()
    }

    /// Bytes that the run holds, but for some hundreds that do not grow with the layer.
    pub fn bytes(&self) -> usize {
        let masses = self.run.state.mode.len();
        let maxwell = self.run.state.maxwell.len();
        // The run, the one to go back to, the one within a step and the stage's.
        let states = 4 * (masses * (4 * size_of::<f64>() + size_of_val(&self.run.state.surface[0]) + 1));
        states
            + 4 * maxwell * size_of::<f64>()
            + self.integrator.bytes()
            + 2 * self.forces.bytes()
            + self.dense_workspace.bytes()
            + self.companion.as_ref().map_or(0, |companion| companion.finer().bytes())
    }

    /// Follows `motion` to its end.
    ///
    /// # Errors
    /// [`SimulationError`]; the simulation is then as it was before the call.
    pub fn advance(&mut self, motion: &Motion) -> Result<(), SimulationError> {
        self.advance_observed(motion, &[], |_, _| ())
    }

    /// Follows `motion` to its end and calls `observe` at each of `times`, which rise from 0 to at most the duration:
    /// with the time since the start of the motion (s) and the simulation as it stood then.
    ///
    /// # Errors
    /// [`SimulationError`]; the simulation is then as it was before the call.
    pub fn advance_observed(
        &mut self,
        motion: &Motion,
        times: &[f64],
        observe: impl FnMut(f64, &mut Self),
    ) -> Result<(), SimulationError> {
        self.follow_or_go_back(motion, None, times, observe).map(|_| ())
    }

    /// As [`advance_observed`](Self::advance_observed), but only until F_z rises to `force` (N). Returns when that was,
    /// s after the start of the motion: 0 if it was there already, `None` if it is not reached within the motion.
    ///
    /// # Errors
    /// [`SimulationError`]; the simulation is then as it was before the call.
    pub fn advance_until_force(
        &mut self,
        motion: &Motion,
        force: f64,
        times: &[f64],
        observe: impl FnMut(f64, &mut Self),
    ) -> Result<Option<f64>, SimulationError> {
        self.follow_or_go_back(motion, Some(force), times, observe)
    }

    fn follow_or_go_back(
        &mut self,
        motion: &Motion,
        until: Option<f64>,
        times: &[f64],
        observe: impl FnMut(f64, &mut Self),
    ) -> Result<Option<f64>, SimulationError> {
        motion.check()?;
        self.keep_checkpoint();
        let recorded = (self.mode_changes.as_ref().map_or(0, Vec::len), self.handovers.as_ref().map_or(0, Vec::len));
        let result = self.follow(motion, until, times, observe);
        if result.is_err() {
            if let Some(record) = &mut self.mode_changes {
                record.truncate(recorded.0);
            }
            if let Some(record) = &mut self.handovers {
                record.truncate(recorded.1);
            }
            self.go_back();
        }
        result
    }

    fn go_back(&mut self) {
        self.run.copy_from(&self.before.run);
        self.integrator.restore(&self.before.rates, self.before.exchange);
        if let Some(companion) = &mut self.companion {
            companion.go_back();
        }
    }

    /// Goes on from where `other`, a run of the same scene, stands.
    fn take_over(&mut self, other: &Self) {
        self.run.copy_from(&other.run);
        self.integrator.restore(other.integrator.start_rates(), other.integrator.start_exchange());
    }

    fn keep_checkpoint(&mut self) {
        self.before.run.copy_from(&self.run);
        self.before.rates.copy_from(self.integrator.start_rates());
        self.before.exchange = self.integrator.start_exchange();
        if let Some(companion) = &mut self.companion {
            companion.keep_checkpoint();
        }
    }

    /// Writes the values of `variables`, in their order, into `values`; Integers as whole numbers.
    pub fn evaluate(&mut self, variables: &[Variable], values: &mut [f64]) {
        self.with_snapshot(|snapshot| snapshot.evaluate(variables, values));
    }

    fn with_snapshot(&mut self, body: impl FnOnce(&outputs::Snapshot<'_>)) {
        let carrier = self.evaluate_forces();
        body(&outputs::Snapshot {
            model: &self.model,
            state: &self.run.state,
            forces: &self.forces,
            carrier: &carrier,
            displacement: self.run.displacement(),
            energies: &self.run.energies,
            tangents: self.run.tangents,
            counters: &self.run.counters,
        });
    }

    /// Processor time since the start, s. It is no part of a run's state: one that is taken up where another stood goes
    /// on from its own.
    pub fn run_time(&self) -> f64 {
        self.run.counters.run_time
    }

    /// Takes over the processor time spent so far.
    pub fn set_run_time(&mut self, time: f64) {
        self.run.counters.run_time = time;
    }

    /// Newton's iterations since the start, those of steps rejected and of motions gone back on included.
    pub fn newton_iterations(&self) -> u64 {
        self.integrator.iterations()
    }

    /// Keeps a record of mode changes from now on, or stops keeping it.
    pub fn record_mode_changes(&mut self, on: bool) {
        self.mode_changes = on.then(Vec::new);
    }

    /// The mode changes recorded since the last call.
    pub fn take_mode_changes(&mut self) -> Vec<ModeChange> {
        self.mode_changes.as_mut().map(std::mem::take).unwrap_or_default()
    }
}
