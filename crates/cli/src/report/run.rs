//! One run of a scene for a report: along the excitation or driven by a master, within a budget; and what is recorded.

use std::cell::Cell;

use asperity::outputs::{Output, Snapshot, Variable, variables};
use asperity::scene::{Input, OutputGroup, Phase, Scene};
use asperity::simulation::{Inaccuracy, Motion, Simulation, SimulationError};
use asperity_fmi::{CommunicationStep, InputOutOfRange, Inputs, layer_motion, layer_start};
use asperity_study::robustness::{Budget, RunFailure};
use cpu_time::ThreadTime;
use indicatif::ProgressBar;

use super::trace::{Errors, Trace};
use crate::terminal::{bar, warn};
use asperity_study::runner::{InputSample, Rows, Runner};

/// No limit but the scene's own.
pub(super) const UNLIMITED: Budget = Budget(u64::MAX);

/// A run that came to its end.
#[derive(Clone, Debug)]
pub(super) struct CompletedRun {
    pub(super) trace: Trace,
    pub(super) counts: Counts,
    /// Processor time, s.
    pub(super) time: f64,
    /// How long each phase took, s.
    pub(super) durations: Vec<f64>,
    /// What it says of its own error, where the scene is [`estimated`].
    pub(super) estimate: Estimate,
}

/// What a run says of its own error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Estimate {
    /// The larger of the errors of F_x and F_z, each over its largest value.
    pub(super) error: f64,
    /// Whether it warns that the run and the more accurate one beside it do not converge.
    pub(super) warned: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Counts {
    pub(super) steps: u64,
    pub(super) rejected: u64,
    pub(super) events: u64,
    pub(super) iterations: u64,
    /// The largest residual of the energy balance over the largest of its energies.
    pub(super) residual: f64,
}

/// The figures of a run; `None` where they are not known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct RunFigures {
    /// Against the reference.
    pub(super) errors: Errors,
    pub(super) estimate: Option<Estimate>,
    /// Processor time, s: the least of the timings.
    pub(super) time: Option<f64>,
    /// The largest timing over the least, less 1.
    pub(super) spread: Option<f64>,
    /// How many timings there are.
    pub(super) timings: Option<u64>,
    pub(super) steps: Option<u64>,
    pub(super) rejected: Option<u64>,
    pub(super) events: Option<u64>,
    pub(super) iterations: Option<u64>,
    pub(super) residual: Option<f64>,
}

impl Counts {
    /// Steps, accepted and rejected.
    pub(super) fn work(&self) -> u64 {
        self.steps + self.rejected
    }
}

impl CompletedRun {
    pub(super) fn figures(&self, errors: Errors) -> RunFigures {
        let Counts { steps, rejected, events, iterations, residual } = self.counts;
        RunFigures {
            errors,
            time: Some(self.time),
            timings: Some(1),
            steps: Some(steps),
            rejected: Some(rejected),
            events: Some(events),
            iterations: Some(iterations),
            residual: Some(residual),
            ..RunFigures::default()
        }
    }
}

impl RunFigures {
    pub(super) fn error(&self) -> Option<f64> {
        self.errors.into_iter().flatten().reduce(f64::max)
    }

    /// The figures with these timings (s), of which there is one at least.
    pub(super) fn timed(self, times: &[f64]) -> Self {
        let [least, largest] = [f64::min, f64::max].map(|pick| times.iter().copied().reduce(pick));
        let spread = least.zip(largest).map(|(least, largest)| largest / least - 1.0);
        Self { time: least, spread, timings: Some(times.len() as u64), ..self }
    }
}

/// The scene with the output groups that a report needs and no others, so that all runs cost the same: none estimates
/// its error.
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

/// Runs `scene` along its excitation from the carrier at `u` (m); `tick` gets the fraction of the excitation that is
/// done.
pub(super) fn follow(
    scene: &Scene,
    rows: Rows,
    u: f64,
    budget: Budget,
    tick: &dyn Fn(f64),
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
            tick(carrier.time / duration);
        };
        durations.push(runner.run_phase(phase, observe).map_err(failed)?);
        recorder.end_phase();
        recorder.check(budget)?;
    }
    runner.take_warnings().iter().for_each(|warning| warn(warning));
    Ok(recorder.finish(runner.simulation(), clock.elapsed().as_secs_f64(), durations))
}

/// What a master sets at a communication point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MasterInputs {
    /// Values and rates.
    Rates,
    /// Values alone.
    Values,
    /// Nothing: there is no master, the program follows the excitation itself.
    None,
}

impl MasterInputs {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Rates => "values and rates",
            Self::Values => "values alone",
            Self::None => "no master",
        }
    }
}

/// Drives `scene` as a master drives the FMU, from the carrier at `u` (m). `points` are the communication points of
/// each phase that is run, s after it begins.
pub(super) fn drive(
    scene: &Scene,
    given: MasterInputs,
    points: &[Vec<f64>],
    u: f64,
    budget: Budget,
    tick: &dyn Fn(f64),
) -> Result<CompletedRun, RunFailure> {
    let failed = |error: DriveError| match error {
        DriveError::Run(error) => budget.failure(scene, &error),
        DriveError::Input(error) => RunFailure::Stopped(error.to_string()),
    };
    let limited = budget.limit(scene);
    let duration = scene.duration();
    let mut master = Master::new(&limited, given, u).map_err(|error| failed(error.into()))?;
    let clock = ThreadTime::now();
    for (phase, points) in scene.excitation.iter().zip(points) {
        let (motion, start) = (phase.motion(scene.layer.area()), master.carrier);
        let mut from = 0.0;
        for &to in points {
            master.step(&motion, start, from, to).map_err(failed)?;
            master.recorder.check(budget)?;
            from = to;
            tick(master.carrier.time / duration);
        }
        master.recorder.end_phase();
    }
    let durations = scene.excitation.iter().map(|phase| phase.duration).collect();
    Ok(master.recorder.finish(&mut master.simulation, clock.elapsed().as_secs_f64(), durations))
}

#[derive(Debug, thiserror::Error)]
#[error(transparent)]
enum DriveError {
    Input(#[from] InputOutOfRange),
    Run(#[from] SimulationError),
}

/// A master with the unit that it drives; how inputs become a motion is the FMU's own.
#[derive(Debug)]
struct Master<'a> {
    scene: &'a Scene,
    given: MasterInputs,
    inputs: Inputs,
    simulation: Simulation,
    recorder: TraceRecorder,
    /// On the excitation, at the communication point.
    carrier: InputSample,
}

impl<'a> Master<'a> {
    fn new(scene: &'a Scene, given: MasterInputs, u: f64) -> Result<Self, SimulationError> {
        let mut inputs = Inputs::default();
        inputs.set(Input::Temperature as usize, scene.input_start(Input::Temperature));
        inputs.set(Input::U as usize, u);
        inputs.set(Input::Load as usize, scene.first_load());
        inputs.set(Input::Pull as usize, scene.first_pull());
        if let Some(phase) = scene.excitation.first().filter(|_| given == MasterInputs::Rates) {
            set_rates(&mut inputs, &phase.motion(scene.layer.area()), 0.0);
        }
        let mut simulation = Simulation::new(scene, &layer_start(scene, &inputs, 0.0))?;
        let mut recorder = TraceRecorder::new(scene);
        recorder.row(&simulation.snapshot());
        let carrier = InputSample { u, ..InputSample::default() };
        Ok(Self { scene, given, inputs, simulation, recorder, carrier })
    }

    /// Does the communication step between two times (s) of the `motion` that began at `start`.
    fn step(&mut self, motion: &Motion, start: InputSample, from: f64, to: f64) -> Result<(), DriveError> {
        // A force jumps at the start of a phase.
        let at_start = if from == 0.0 { start.after(motion, 0.0) } else { self.carrier };
        for input in Input::MECHANICAL {
            self.inputs.set(input as usize, at_start.input(input));
        }
        if self.given == MasterInputs::Rates {
            set_rates(&mut self.inputs, motion, from);
        }
        let step = CommunicationStep { time: self.carrier.time, h: to - from, extrapolation: self.scene.extrapolation };
        self.simulation.advance(&layer_motion(self.scene, &self.inputs, self.simulation.driven(), &step)?)?;
        self.inputs.complete_step(step.h);
        self.recorder.row(&self.simulation.snapshot());
        self.carrier = start.after(motion, to);
        Ok(())
    }
}

fn set_rates(inputs: &mut Inputs, motion: &Motion, s: f64) {
    inputs.set_rate(Input::U as usize, motion.u.at(s).speed);
    inputs.set_rate(Input::W as usize, motion.w.at(s).speed);
    inputs.set_rate(Input::Load as usize, motion.load.change.at(s).speed);
    inputs.set_rate(Input::Pull as usize, motion.pull.change.at(s).speed);
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
struct TraceRecorder {
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
    fn new(scene: &Scene) -> Self {
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

    fn row(&mut self, snapshot: &Snapshot<'_>) {
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

    fn end_phase(&mut self) {
        self.trace.end_phase();
    }

    fn check(&self, budget: Budget) -> Result<(), RunFailure> {
        let used_up = self.counts.work() > budget.0;
        if used_up { Err(RunFailure::OverBudget { time: self.trace.end() }) } else { Ok(()) }
    }

    fn finish(self, simulation: &mut Simulation, time: f64, durations: Vec<f64>) -> CompletedRun {
        let residual = if self.energy > 0.0 { self.residual / self.energy } else { 0.0 };
        let counts = Counts { iterations: simulation.newton_iterations(), residual, ..self.counts };
        let estimate = Estimate {
            error: self.estimate,
            warned: matches!(simulation.inaccuracy(), Some(Inaccuracy::Divergence { .. })),
        };
        CompletedRun { trace: self.trace, counts, time, durations, estimate }
    }
}

/// The progress bar over the runs of a report, weighed by what they are likely to take.
#[derive(Debug)]
pub(super) struct Progress {
    bar: ProgressBar,
    total: f64,
    done: Cell<f64>,
}

impl Progress {
    const POSITIONS: f64 = 1000.0;

    /// For runs that weigh `total`.
    pub(super) fn new(total: f64) -> Self {
        Self { bar: bar(Self::POSITIONS as u64), total, done: Cell::new(0.0) }
    }

    /// Does a run of this weight; it gets what to call with the fraction that is done.
    pub(super) fn during<T>(&self, message: &str, weight: f64, run: impl FnOnce(&dyn Fn(f64)) -> T) -> T {
        self.bar.set_message(message.to_owned());
        let done = self.done.get();
        let show =
            |fraction: f64| self.bar.set_position((Self::POSITIONS * (done + weight * fraction) / self.total) as u64);
        let result = run(&show);
        show(1.0);
        self.done.set(done + weight);
        result
    }
}

impl Drop for Progress {
    /// Takes the bar off the terminal.
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// What a run at this tolerance is likely to take, over one at 1: the step of a method of order 5 follows the fifth
/// root.
pub(super) fn weight(tolerance: f64) -> f64 {
    tolerance.powf(-0.2)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "
name = 'pressed'
[layer]
masses = 2
spacing = 1e-4
mass = 1e-7
[layer.vertical]
stiffness = 1e3
[surface]
kind = 'flat'
[fmu]
outputs = ['forces', 'dissipation', 'energy', 'solver']
[[excitation]]
duration = 1e-3
w_rate = -0.01
[[excitation]]
duration = 1e-3
u_rate = 0.01
";

    #[test]
    fn a_run_ends_at_its_budget_or_stops_at_the_scenes_own_limit() {
        let mut scene = Scene::parse(TEXT, "scene.toml".as_ref()).unwrap();
        let along = |scene: &Scene, budget| follow(scene, Rows::PerPhase(4), 0.0, Budget(budget), &|_| ());
        let points = vec![(1..=10).map(|i| 1e-4 * f64::from(i)).collect::<Vec<_>>(); 2];
        let driven = |scene: &Scene, budget| drive(scene, MasterInputs::Rates, &points, 0.0, Budget(budget), &|_| ());
        for (run, rows) in [(&along as &dyn Fn(&Scene, u64) -> _, 9), (&driven, 21)] {
            let measured = run(&scene, 10_000).unwrap();
            assert_eq!(measured.trace.forces().rows.len(), rows);
            assert!((measured.trace.end() - 2e-3).abs() < 1e-15, "{:e}", measured.trace.end());
            let failure = run(&scene, measured.counts.work() - 1).unwrap_err();
            assert!(matches!(failure, RunFailure::OverBudget { time } if time > 1e-3), "{failure:?}");
        }
        scene.solver.max_steps = Some(2);
        let failure = along(&scene, 10_000).unwrap_err();
        assert!(matches!(&failure, RunFailure::Stopped(reason) if reason.contains("solver.max_steps")), "{failure:?}");
    }
}
