//! One run of a scene along its excitation within a budget, and what is kept of it.

use std::cell::Cell;
use std::ops::ControlFlow;

use asperity::outputs::{Output, Snapshot, Variable, variables};
use asperity::scene::{OutputGroup, Phase, Scene};
use asperity::simulation::{Inaccuracy, Simulation, SimulationError};
use cpu_time::ThreadTime;

use super::trace::{Errors, Trace};
use crate::progress::{Progress, Stop, Stopped, Watch};
use crate::robustness::{Budget, RunFailure};
use crate::runner::{InputSample, Rows, Runner};

/// No limit but the scene's own.
pub(super) const UNLIMITED: Budget = Budget(u64::MAX);

/// The scene with the output groups that are needed and no others, so that all runs cost the same: none estimates its
/// error.
pub(super) fn watched(scene: &Scene) -> Scene {
    use OutputGroup::{Dissipation, Energy, Forces};
    Scene { outputs: vec![Forces, Dissipation, Energy], ..scene.clone() }
}

/// The scene with the estimate of the errors of F_x and F_z: a more accurate run beside each run.
pub(super) fn estimated(scene: &Scene) -> Scene {
    let mut scene = watched(scene);
    scene.outputs.push(OutputGroup::Solver);
    scene
}

/// The scene with phases of these durations (s), whatever F_z does: the same motion for all runs.
pub(super) fn with_durations(scene: &Scene, durations: &[f64]) -> Scene {
    let phases = scene.excitation.iter().zip(durations);
    let fixed =
        phases.map(|(phase, &duration)| Phase { duration, until_force: None, until_pressure: None, ..phase.clone() });
    Scene { excitation: fixed.collect(), ..scene.clone() }
}

/// A run that came to its end.
#[derive(Clone, Debug)]
pub struct CompletedRun {
    /// What it is compared by.
    pub trace: Trace,
    /// What it took.
    pub counts: Counts,
    /// Processor time, s.
    pub time: f64,
    /// How long each phase took, s.
    pub durations: Vec<f64>,
    /// What it says of its own error, where the scene is `estimated`.
    pub estimate: Estimate,
    /// Its warnings.
    pub warnings: Vec<String>,
}

/// What a run says of its own error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The larger of the errors of F_x and F_z, each over its largest value.
    pub error: f64,
    /// Whether it warns that the run and the more accurate one beside it do not converge.
    pub warned: bool,
}

/// What a run took, and its residual.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps.
    pub rejected: u64,
    /// Mode changes located.
    pub events: u64,
    /// Newton iterations.
    pub iterations: u64,
    /// The largest residual of the energy balance over the largest of its energies.
    pub residual: f64,
}

impl Counts {
    /// Steps, accepted and rejected.
    pub fn work(&self) -> u64 {
        self.steps + self.rejected
    }
}

/// The figures of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunFigures {
    /// Against the reference.
    pub errors: Errors,
    /// What it says of its own error; `None` where it was not asked.
    pub estimate: Option<Estimate>,
    /// Processor times, s, each of a run that was timed; none where that would mean nothing.
    pub times: Vec<f64>,
    /// What it took.
    pub counts: Counts,
}

impl RunFigures {
    /// The figures of a run with these errors.
    pub(super) fn new(run: &CompletedRun, errors: Errors) -> Self {
        Self { errors, estimate: None, times: vec![run.time], counts: run.counts }
    }

    /// The largest of its errors.
    pub fn error(&self) -> Option<f64> {
        self.errors.into_iter().flatten().reduce(f64::max)
    }

    /// The least of its times, s.
    pub fn time(&self) -> Option<f64> {
        self.times.iter().copied().reduce(f64::min)
    }

    /// The largest of its times over the least, less 1.
    pub fn spread(&self) -> Option<f64> {
        let largest = self.times.iter().copied().reduce(f64::max);
        Some(largest? / self.time()? - 1.0)
    }
}

/// What is read at every row, in this order.
const WATCHED: [Output; 11] = [
    Output::ForceX,
    Output::ForceZ,
    Output::DissipatedEnergy,
    Output::InputEnergy,
    Output::KineticEnergy,
    Output::ElasticEnergy,
    Output::EnergyResidual,
    Output::Steps,
    Output::Rejected,
    Output::Events,
    Output::ForceError,
];

/// Records the rows of a run.
#[derive(Debug)]
pub(super) struct TraceRecorder {
    variables: Vec<Variable>,
    values: [f64; WATCHED.len()],
    trace: Trace,
    counts: Counts,
    /// The run's own estimate of its error.
    estimate: f64,
    /// The largest of the energies so far, J.
    energy: f64,
    /// The largest residual so far, J.
    residual: f64,
}

impl TraceRecorder {
    /// For a run of `scene`, which is [`watched`].
    pub(super) fn new(scene: &Scene) -> Self {
        let all = variables(&estimated(scene));
        let find = |output: &Output| all.iter().find(|variable| variable.output == *output).cloned();
        Self {
            variables: WATCHED.iter().filter_map(find).collect(),
            values: [0.0; WATCHED.len()],
            trace: Trace::default(),
            counts: Counts::default(),
            estimate: 0.0,
            energy: 0.0,
            residual: 0.0,
        }
    }

    pub(super) fn row(&mut self, snapshot: &Snapshot<'_>) {
        snapshot.evaluate(&self.variables, &mut self.values);
        let [x, z, lost, input, kinetic, elastic, residual, steps, rejected, events, estimate] = self.values;
        let [u, w] = snapshot.ways();
        self.trace.push(snapshot.time, [x, z, lost, u, w]);
        self.energy = [input, kinetic, elastic, lost].iter().fold(self.energy, |most, energy| most.max(energy.abs()));
        self.residual = self.residual.max(residual.abs());
        let [steps, rejected, events] = [steps, rejected, events].map(|count| count as u64);
        self.counts = Counts { steps, rejected, events, ..self.counts };
        self.estimate = estimate;
    }

    pub(super) fn end_phase(&mut self) {
        self.trace.end_phase();
    }

    pub(super) fn check(&self, budget: Budget) -> Result<(), RunFailure> {
        let used_up = self.counts.work() > budget.0;
        if used_up { Err(RunFailure::OverBudget { time: self.trace.end() }) } else { Ok(()) }
    }

    pub(super) fn finish(self, simulation: &mut Simulation, time: f64, durations: Vec<f64>) -> CompletedRun {
        let residual = if self.energy > 0.0 { self.residual / self.energy } else { 0.0 };
        let counts = Counts { iterations: simulation.newton_iterations(), residual, ..self.counts };
        let estimate = Estimate {
            error: self.estimate,
            warned: matches!(simulation.inaccuracy(), Some(Inaccuracy::Divergence { .. })),
        };
        CompletedRun { trace: self.trace, counts, time, durations, estimate, warnings: Vec::new() }
    }
}

/// Runs `scene` along its excitation from the carrier at `u` (m); `tick` gets the fraction of the excitation that is
/// done.
pub(super) fn follow(
    scene: &Scene,
    rows: Rows,
    u: f64,
    budget: Budget,
    tick: &dyn Fn(f64) -> ControlFlow<()>,
) -> Result<CompletedRun, RunFailure> {
    let failed = |error: SimulationError| budget.failure(scene, &error);
    let duration = scene.duration();
    let mut recorder = TraceRecorder::new(scene);
    let mut runner = Runner::new(&budget.limit(scene), rows, u).map_err(failed)?;
    let clock = ThreadTime::now();
    runner.observe_now(|_, snapshot| recorder.row(snapshot));
    let mut durations = Vec::new();
    for phase in &scene.excitation {
        let observe = |carrier: InputSample, snapshot: &Snapshot<'_>| {
            recorder.row(snapshot);
            tick(carrier.time / duration)
        };
        durations.push(runner.run_phase(phase, observe).map_err(failed)?);
        recorder.end_phase();
        recorder.check(budget)?;
    }
    let warnings = runner.take_warnings();
    Ok(CompletedRun { warnings, ..recorder.finish(runner.simulation(), clock.elapsed().as_secs_f64(), durations) })
}

/// Runs of which each is a share of all.
pub(super) struct WeighedRuns<'a> {
    watch: &'a Watch<'a>,
    part: &'a str,
    total: f64,
    done: Cell<f64>,
    stop: Stop,
}

impl<'a> WeighedRuns<'a> {
    /// For runs that weigh `total`.
    pub(super) fn new(watch: &'a Watch<'a>, part: &'a str, total: f64) -> Self {
        Self { watch, part, total, done: Cell::new(0.0), stop: Stop::default() }
    }

    /// Does a run of this weight; it gets what to call with the fraction that is done. Once stopped no run is begun.
    pub(super) fn during<T>(
        &self,
        doing: &str,
        weight: f64,
        run: impl FnOnce(&dyn Fn(f64) -> ControlFlow<()>) -> Result<T, RunFailure>,
    ) -> Result<T, RunFailure> {
        if self.stop.go_on().is_break() {
            return Err(RunFailure::Stopped(Stopped.to_string()));
        }
        let done = self.done.get();
        let show = |fraction: f64| {
            let share = (done + weight * fraction) / self.total;
            self.stop.heed((self.watch)(Progress { part: self.part, doing, share }))
        };
        let _ = show(0.0);
        let result = run(&show);
        let _ = show(1.0);
        self.done.set(done + weight);
        result
    }

    /// Refuses what was stopped.
    pub(super) fn finish(&self) -> Result<(), Stopped> {
        if self.stop.go_on().is_break() { Err(Stopped) } else { Ok(()) }
    }
}

/// What a run at this tolerance is likely to take, over one at 1: the step of a method of order 5 follows the fifth
/// root.
pub(super) fn weight(tolerance: f64) -> f64 {
    tolerance.powf(-0.2)
}
