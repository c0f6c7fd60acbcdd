//! The figures of a run.

use super::trace::{Errors, Trace};

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

/// The figures of a run; `None` where they are not known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunFigures {
    /// Against the reference.
    pub errors: Errors,
    /// What it says of its own error.
    pub estimate: Option<Estimate>,
    /// Processor time, s: the least of the timings.
    pub time: Option<f64>,
    /// The largest timing over the least, less 1.
    pub spread: Option<f64>,
    /// How many timings there are.
    pub timings: Option<u64>,
    /// Accepted steps.
    pub steps: Option<u64>,
    /// Rejected steps.
    pub rejected: Option<u64>,
    /// Mode changes located.
    pub events: Option<u64>,
    /// Newton iterations.
    pub iterations: Option<u64>,
    /// The largest residual of the energy balance over the largest of its energies.
    pub residual: Option<f64>,
}

impl Counts {
    /// Steps, accepted and rejected.
    pub fn work(&self) -> u64 {
        self.steps + self.rejected
    }
}

impl CompletedRun {
    /// Its figures, with these errors.
    pub fn figures(&self, errors: Errors) -> RunFigures {
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
    /// The largest of its errors.
    pub fn error(&self) -> Option<f64> {
        self.errors.into_iter().flatten().reduce(f64::max)
    }

    /// The figures with these timings (s), of which there is one at least.
    pub fn timed(self, times: &[f64]) -> Self {
        let [least, largest] = [f64::min, f64::max].map(|pick| times.iter().copied().reduce(pick));
        let spread = least.zip(largest).map(|(least, largest)| largest / least - 1.0);
        Self { time: least, spread, timings: Some(times.len() as u64), ..self }
    }
}
