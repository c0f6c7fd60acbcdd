//! One run of a scene for a report: its rows, what it took, how long.

use asperity::outputs::{Output, Variable, variables};
use asperity::scene::{Method, OutputGroup, Phase, Scene};
use asperity::simulation::{Simulation, SimulationError};
use cpu_time::ThreadTime;

use super::trace::Trace;
use crate::program::runner::{Rows, Runner};

/// What a run gave.
#[derive(Clone, Debug)]
pub(super) struct Measured {
    /// Its rows.
    pub(super) trace: Trace,
    /// What it took.
    pub(super) counts: Counts,
    /// Processor time, s.
    pub(super) time: f64,
    /// How long each phase took, s.
    pub(super) durations: Vec<f64>,
}

/// What a run took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Counts {
    /// Accepted steps.
    pub(super) steps: u64,
    /// Rejected steps.
    pub(super) rejected: u64,
    /// Mode changes.
    pub(super) events: u64,
    /// Newton's iterations.
    pub(super) iterations: u64,
    /// What the energy balance misses at most, over the largest of the energies in it.
    pub(super) residual: f64,
}

impl Counts {
    /// Steps, accepted and rejected.
    pub(super) fn work(&self) -> u64 {
        self.steps + self.rejected
    }
}

/// What is read at every row, in this order.
const WATCHED: [Output; 10] = [
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
];

/// The scene with the output groups that a report needs and no others: every run pays for the same, and none for an
/// estimate of its error.
pub(super) fn watched(scene: &Scene) -> Scene {
    use OutputGroup::{Dissipation, Energy, Forces};
    Scene { outputs: vec![Forces, Dissipation, Energy], ..scene.clone() }
}

/// The scene at the relative tolerance `tolerance`; an absolute one of its own goes along.
pub(super) fn at_tolerance(scene: &Scene, tolerance: f64) -> Scene {
    let mut scene = scene.clone();
    let ratio = tolerance / scene.solver.relative_tolerance;
    scene.solver.absolute_tolerance = scene.solver.absolute_tolerance.map(|absolute| absolute * ratio);
    scene.solver.relative_tolerance = tolerance;
    scene
}

/// The scene as the reference runs it: every mode change located, no Maxwell element left out.
pub(super) fn exact(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    (scene.solver.method, scene.solver.reduce) = (Method::Event, 0.0);
    scene
}

/// The scene with phases that take `durations` (s) whatever F_z does: the same motion for all runs.
pub(super) fn with_durations(scene: &Scene, durations: &[f64]) -> Scene {
    let phases = scene.excitation.iter().zip(durations);
    let fixed =
        phases.map(|(phase, &duration)| Phase { duration, until_force: None, until_pressure: None, ..phase.clone() });
    Scene { excitation: fixed.collect(), ..scene.clone() }
}

/// Runs `scene` from the carrier at `u` (m); `tick` hears which share of the excitation is done.
pub(super) fn run(scene: &Scene, rows: Rows, u: f64, tick: &dyn Fn(f64)) -> Result<Measured, SimulationError> {
    let duration = scene.duration();
    let mut recorder = Recorder::new(scene);
    let mut run = Runner::new(scene, rows, u)?;
    let clock = ThreadTime::now();
    let durations = run.run(&scene.excitation, |carrier, simulation| {
        recorder.row(simulation);
        tick(carrier.time / duration);
    })?;
    let time = clock.elapsed().as_secs_f64();
    let (values, counts) = recorder.finish(run.simulation());
    Ok(Measured { trace: Trace::new(values, &durations, rows), counts, time, durations })
}

/// Takes the rows of a run.
#[derive(Debug)]
pub(super) struct Recorder {
    variables: Vec<Variable>,
    values: [f64; WATCHED.len()],
    rows: Vec<[f64; 3]>,
    counts: Counts,
    /// The largest of the energies so far, J.
    energy: f64,
    /// The largest residual so far, J.
    residual: f64,
}

impl Recorder {
    /// No rows yet of a run of `scene`, which is [`watched`].
    pub(super) fn new(scene: &Scene) -> Self {
        let mut outputs = scene.outputs.clone();
        outputs.push(OutputGroup::Solver);
        let all = variables(&Scene { outputs, ..scene.clone() });
        let find = |output: &Output| all.iter().find(|variable| variable.output == *output).cloned();
        Self {
            variables: WATCHED.iter().filter_map(find).collect(),
            values: [0.0; WATCHED.len()],
            rows: Vec::new(),
            counts: Counts::default(),
            energy: 0.0,
            residual: 0.0,
        }
    }

    /// Adds a row.
    pub(super) fn row(&mut self, simulation: &mut Simulation) {
        simulation.evaluate(&self.variables, &mut self.values);
        let [x, z, lost, input, kinetic, elastic, residual, steps, rejected, events] = self.values;
        self.rows.push([x, z, lost]);
        self.energy = [input, kinetic, elastic, lost].iter().fold(self.energy, |most, energy| most.max(energy.abs()));
        self.residual = self.residual.max(residual.abs());
        let [steps, rejected, events] = [steps, rejected, events].map(|count| count as u64);
        self.counts = Counts { steps, rejected, events, ..self.counts };
    }

    /// What the run has taken so far, but for Newton's iterations.
    pub(super) fn counts(&self) -> &Counts {
        &self.counts
    }

    /// The rows, and what the run took.
    pub(super) fn finish(self, simulation: &Simulation) -> (Vec<[f64; 3]>, Counts) {
        let residual = if self.energy > 0.0 { self.residual / self.energy } else { 0.0 };
        (self.rows, Counts { iterations: simulation.newton_iterations(), residual, ..self.counts })
    }
}
