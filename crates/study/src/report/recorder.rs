//! What is recorded of a run.

use asperity::outputs::{Output, Snapshot, Variable, variables};
use asperity::scene::Scene;
use asperity::simulation::{Inaccuracy, Simulation};

use super::figures::{CompletedRun, Counts, Estimate};
use super::scenes::estimated;
use super::trace::Trace;
use crate::robustness::{Budget, RunFailure};

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
    /// For a run of `scene`, which is [`watched`](super::scenes::watched).
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
