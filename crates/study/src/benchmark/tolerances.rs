//! Errors against what a run costs, over the tolerances of each method.

use std::ops::ControlFlow;

use asperity::scene::{Method, Scene};

use super::reference::Reference;
use super::run::{RunFigures, UNLIMITED, WeighedRuns, estimated, follow, weight};
use crate::progress::{Stopped, Watch};
use crate::robustness::{RunFailure, at_tolerance};
use crate::runner::Rows;

/// The name of the reference among the methods.
const REFERENCE: &str = "reference";
/// The methods compared, and their names in `solver.method`.
const METHODS: [(Method, &str); 2] = [(Method::Event, "event"), (Method::Step, "step")];
/// Once a method has taken so many times the Newton iterations of the reference, its tighter runs are left out.
const PATIENCE: u64 = 3;
/// Runs are timed again and again until that may have taken about this time, s, ...
const ENOUGH: f64 = 2.0;
/// ... and at least so often.
const MIN_TIMINGS: u32 = 3;
/// A run that estimates its error takes up to so many times what it takes alone.
const ESTIMATED: f64 = 3.0;

/// A row of the table of errors and run times.
#[derive(Clone, Debug, PartialEq)]
pub struct ToleranceRow {
    /// The method, as in `solver.method`.
    pub method: &'static str,
    /// The relative tolerance.
    pub tolerance: f64,
    /// Or why there are no figures.
    pub result: Result<RunFigures, String>,
}

impl ToleranceRow {
    /// The row of the reference; its errors are its own.
    pub fn from_reference(reference: &Reference) -> Self {
        let result = Ok(RunFigures::new(&reference.measured, reference.own));
        Self { method: REFERENCE, tolerance: reference.tolerance, result }
    }
}

/// The runs of each method over tolerances.
#[derive(Debug)]
pub(super) struct ToleranceLadder<'a> {
    /// From loose to tight.
    pub tolerances: &'a [f64],
    /// Rows of a phase.
    pub points: u32,
    /// How often each run is timed at most.
    pub repeat: u32,
}

impl ToleranceLadder<'_> {
    /// What all runs are likely to take, by [`weight`], without the timings.
    pub(super) fn weight(&self) -> f64 {
        let rungs = METHODS.iter().flat_map(|&(method, _)| self.tolerances.iter().map(move |&rung| (method, rung)));
        rungs.map(|(method, rung)| self.rung_weight(method, rung)).sum()
    }

    /// The method "step" is of order 2: as quick as the other at a thousandth, its steps follow the square root, until
    /// it is given up.
    fn rung_weight(&self, method: Method, tolerance: f64) -> f64 {
        const EVEN: f64 = 1e-3;
        let most = 3.0 * PATIENCE as f64 * self.tolerances.last().map_or(1.0, |&tightest| weight(tightest));
        let alone = match method {
            Method::Step => (weight(EVEN) * (EVEN / tolerance).sqrt()).min(most),
            _ => weight(tolerance),
        };
        ESTIMATED * alone
    }

    /// Runs all tolerances, method by method, without timing them.
    pub(super) fn run(&self, reference: &Reference, progress: &WeighedRuns<'_>) -> Vec<ToleranceRow> {
        METHODS.iter().flat_map(|&(method, name)| self.run_method(method, name, reference, progress)).collect()
    }

    /// The runs of one method, until they take far more work than the reference.
    fn run_method(
        &self,
        method: Method,
        name: &'static str,
        reference: &Reference,
        progress: &WeighedRuns<'_>,
    ) -> Vec<ToleranceRow> {
        let scene = with_method(&reference.scene, method);
        let most = reference.measured.counts.iterations;
        let mut last = 0;
        let mut row = |&tolerance: &f64| {
            let result = if last > PATIENCE * most {
                Err(format!("left out: a looser one took {last} Newton iterations, the reference {most}"))
            } else {
                let rung = self.rung(&at_tolerance(&scene, tolerance), name, reference, progress);
                rung.map_err(|failure| failure.to_string())
            };
            last = result.as_ref().map_or(last, |figures| figures.counts.iterations);
            ToleranceRow { method: name, tolerance, result }
        };
        self.tolerances.iter().map(&mut row).collect()
    }

    /// A run with its estimate of its own error; its time is that of both.
    fn rung(
        &self,
        scene: &Scene,
        method: &str,
        reference: &Reference,
        progress: &WeighedRuns<'_>,
    ) -> Result<RunFigures, RunFailure> {
        let tolerance = scene.solver.relative_tolerance;
        let message = format!("{method}, tolerance {tolerance:e}, with its estimate");
        let weight = self.rung_weight(scene.solver.method, tolerance);
        let (comparison, scene) = (reference.comparison, estimated(scene));
        let follow = |tick: &dyn Fn(f64) -> ControlFlow<()>| follow(&scene, comparison.rows(), 0.0, UNLIMITED, tick);
        let run = progress.during(&message, weight, follow)?;
        let errors = comparison.errors(&run.trace, &reference.measured.trace);
        Ok(RunFigures { estimate: Some(run.estimate), ..RunFigures::new(&run, errors) })
    }

    /// Times the runs of `rows` again without their estimates, in rounds: what disturbs the machine for a while does
    /// not meet all timings of one run.
    pub(super) fn time(
        &self,
        reference: &Reference,
        rows: &mut [ToleranceRow],
        watch: &Watch<'_>,
    ) -> Result<(), Stopped> {
        let mut runs: Vec<TimedRun<'_>> =
            rows.iter_mut().filter_map(|row| TimedRun::new(row, &reference.scene, self.repeat)).collect();
        let total = runs.iter().map(|run| f64::from(run.repeat) * run.expected).sum();
        let progress = WeighedRuns::new(watch, "timings", total);
        for round in 0..self.repeat {
            let due = runs.iter_mut().filter(|run| round < run.repeat);
            due.for_each(|run| run.time(Rows::PerPhase(self.points), &progress));
        }
        progress.finish()
    }
}

fn with_method(scene: &Scene, method: Method) -> Scene {
    let mut scene = scene.clone();
    scene.solver.method = method;
    scene
}

/// A run that is timed several times.
#[derive(Debug)]
struct TimedRun<'a> {
    figures: &'a mut RunFigures,
    message: String,
    scene: Scene,
    /// What it may take, s.
    expected: f64,
    /// How often it is timed.
    repeat: u32,
}

impl<'a> TimedRun<'a> {
    /// The timed run of a row whose run came to its end; it is timed `most` times at most.
    fn new(row: &'a mut ToleranceRow, scene: &Scene, most: u32) -> Option<Self> {
        let (method, _) = METHODS.into_iter().find(|(_, name)| *name == row.method)?;
        let scene = with_method(&at_tolerance(scene, row.tolerance), method);
        let message = format!("timing {}, tolerance {:e}", row.method, row.tolerance);
        let figures = row.result.as_mut().ok()?;
        let expected = figures.time()?;
        figures.times.clear();
        Some(Self { figures, message, scene, expected, repeat: timings(expected, most) })
    }

    fn time(&mut self, rows: Rows, progress: &WeighedRuns<'_>) {
        let run = progress.during(&self.message, self.expected, |tick| follow(&self.scene, rows, 0.0, UNLIMITED, tick));
        self.figures.times.extend(run.ok().map(|run| run.time));
    }
}

/// How often a run is timed that takes up to `time` (s): short ones more often, but none more than `most` times.
fn timings(time: f64, most: u32) -> u32 {
    ((ENOUGH / time).ceil() as u32).max(MIN_TIMINGS).min(most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_runs_are_timed_more_often() {
        assert_eq!([1e-4, 0.1, 0.5, 60.0].map(|time| timings(time, 25)), [25, 20, 4, 3]);
        assert_eq!([1e-4, 60.0].map(|time| timings(time, 1)), [1, 1]);
    }
}
