//! The ladder of tolerances: each rung run by each method.

use asperity::scene::{Method, Scene};

use super::progress::{Progress, weight};
use super::reference::Reference;
use super::runs::{at_tolerance, run};
use super::trace::Errors;
use crate::program::excitation::Rows;

/// What runs of this program are called, beside those of its peers.
pub(super) const PROGRAM: &str = "asperity";
/// The methods that a report compares, and how solver.method names them.
const METHODS: [(Method, &str); 2] = [(Method::Event, "event"), (Method::Step, "step")];
/// Once a method has taken so many times the reference's work, by Newton's iterations, its tighter rungs are left out.
pub(super) const PATIENCE: u64 = 3;
/// What the reference is called among the methods.
pub(super) const REFERENCE: &str = "reference";

/// A row of the table of errors and run times.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Row {
    /// The program that ran.
    pub(super) program: String,
    /// Its method.
    pub(super) method: String,
    /// Its relative tolerance.
    pub(super) tolerance: f64,
    /// What came of it, or why nothing did.
    pub(super) result: Result<Figures, String>,
}

/// The figures of a run; `None` where nobody knows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Figures {
    /// Errors against the reference.
    pub(super) errors: Errors,
    /// Processor time, s: the median of the repeats.
    pub(super) time: Option<f64>,
    /// Accepted steps.
    pub(super) steps: Option<u64>,
    /// Rejected steps.
    pub(super) rejected: Option<u64>,
    /// Mode changes.
    pub(super) events: Option<u64>,
    /// Newton's iterations.
    pub(super) iterations: Option<u64>,
    /// What the energy balance misses at most, over the largest of the energies in it.
    pub(super) residual: Option<f64>,
}

/// What is run.
#[derive(Debug)]
pub(super) struct Ladder<'a> {
    /// Relative tolerances, from loose to tight.
    pub(super) tolerances: &'a [f64],
    /// Rows of a phase.
    pub(super) points: u32,
    /// How often each run is timed.
    pub(super) repeat: u32,
}

impl Ladder<'_> {
    /// What it weighs.
    pub(super) fn weight(&self) -> f64 {
        let rungs = METHODS.iter().flat_map(|&(method, _)| self.tolerances.iter().map(move |&rung| (method, rung)));
        f64::from(self.repeat) * rungs.map(|(method, rung)| self.rung_weight(method, rung)).sum::<f64>()
    }

    /// What a rung is likely to take, as [`weight`]. The method "step" is of order 2: as quick as the other at a
    /// thousandth, its steps follow the square root, until it is given up.
    fn rung_weight(&self, method: Method, tolerance: f64) -> f64 {
        const EVEN: f64 = 1e-3;
        let most = 3.0 * PATIENCE as f64 * self.tolerances.last().map_or(1.0, |&tightest| weight(tightest));
        match method {
            Method::Step => (weight(EVEN) * (EVEN / tolerance).sqrt()).min(most),
            _ => weight(tolerance),
        }
    }

    /// Runs all rungs against the reference, method by method.
    pub(super) fn run(&self, reference: &Reference, progress: &Progress) -> Vec<Row> {
        METHODS.iter().flat_map(|&(method, name)| self.climb(method, name, reference, progress)).collect()
    }

    /// The rungs of one method, until they take far more work than the reference: a tighter one would tell nobody
    /// anything.
    fn climb(&self, method: Method, name: &str, reference: &Reference, progress: &Progress) -> Vec<Row> {
        let mut scene = reference.scene.clone();
        scene.solver.method = method;
        let most = reference.measured.counts.iterations;
        let mut last = 0;
        let mut row = |&tolerance: &f64| {
            let result = if last > PATIENCE * most {
                Err(format!("left out: a looser one took {last} Newton iterations, the reference {most}"))
            } else {
                self.rung(&at_tolerance(&scene, tolerance), name, reference, progress)
            };
            last = result.as_ref().ok().and_then(|figures| figures.iterations).unwrap_or(last);
            Row { program: PROGRAM.into(), method: name.into(), tolerance, result }
        };
        self.tolerances.iter().map(&mut row).collect()
    }

    fn rung(&self, scene: &Scene, method: &str, reference: &Reference, progress: &Progress) -> Result<Figures, String> {
        let tolerance = scene.solver.relative_tolerance;
        let weight = self.rung_weight(scene.solver.method, tolerance);
        let measure = |rows: Rows, what: &str| {
            let message = format!("{method}, tolerance {tolerance:e}{what}");
            let measured = progress.during(&message, weight, |tick| run(scene, rows, 0.0, tick));
            measured.map_err(|error| error.to_string())
        };
        let mut times = Vec::new();
        let mut first = None;
        for i in 1..=self.repeat {
            let measured = measure(Rows::PerPhase(self.points), &format!(", run {i} of {}", self.repeat))?;
            times.push(measured.time);
            first.get_or_insert(measured);
        }
        let comparison = reference.comparison;
        let run = match first {
            Some(run) if !comparison.is_of_means() => run,
            _ => measure(comparison.rows(), ", means")?,
        };
        Ok(Figures {
            errors: comparison.errors(&run.trace, &reference.measured.trace),
            time: Some(median(times)),
            steps: Some(run.counts.steps),
            rejected: Some(run.counts.rejected),
            events: Some(run.counts.events),
            iterations: Some(run.counts.iterations),
            residual: Some(run.counts.residual),
        })
    }
}

impl Reference {
    /// The reference as a row: its errors are its own.
    pub(super) fn row(&self) -> Row {
        let counts = &self.measured.counts;
        let figures = Figures {
            errors: self.own,
            time: Some(self.measured.time),
            steps: Some(counts.steps),
            rejected: Some(counts.rejected),
            events: Some(counts.events),
            iterations: Some(counts.iterations),
            residual: Some(counts.residual),
        };
        Row { program: PROGRAM.into(), method: REFERENCE.into(), tolerance: self.tolerance, result: Ok(figures) }
    }

    /// Which errors are below the reference's own.
    pub(super) fn below(&self, errors: &Errors) -> [bool; 3] {
        [0, 1, 2].map(|i| errors[i].zip(self.own[i]).is_some_and(|(error, own)| error < own))
    }
}

impl Figures {
    /// The largest of the errors.
    pub(super) fn error(&self) -> Option<f64> {
        self.errors.into_iter().flatten().reduce(f64::max)
    }
}

/// The middle one; of an even number, the mean of the two in the middle.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    if n == 0 { 0.0 } else { f64::midpoint(values[(n - 1) / 2], values[n / 2]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_median_is_the_middle_one() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![3.0, 1.0, 2.0, 10.0]), 2.5);
    }
}
