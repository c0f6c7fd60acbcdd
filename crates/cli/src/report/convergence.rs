//! Errors against what a run costs: over the tolerances of each method, and over the communication steps of a master.

use asperity::scene::{Method, Scene};
use asperity_study::robustness::{RunFailure, at_tolerance, exact};

use super::reference::{Comparison, Reference};
use super::run::{CompletedRun, MasterInputs, Progress, RunFigures, UNLIMITED, drive, estimated, follow, weight};
use super::trace::{Errors, Trace};
use asperity_study::runner::Rows;

/// The name of this program beside those of its peers.
pub(super) const PROGRAM: &str = "asperity";
/// The name of the reference among the methods.
const REFERENCE: &str = "reference";
/// The methods compared, and their names in `solver.method`.
const METHODS: [(Method, &str); 2] = [(Method::Event, "event"), (Method::Step, "step")];
/// Once a method has taken so many times the Newton iterations of the reference, its tighter runs are left out.
pub(super) const PATIENCE: u64 = 3;
/// Runs are timed again and again until that may have taken about this time, s, ...
const ENOUGH: f64 = 2.0;
/// ... and at least so often.
const MIN_TIMINGS: u32 = 3;
/// A run that estimates its error takes up to so many times what it takes alone.
const ESTIMATED: f64 = 3.0;

/// A row of the table of errors and run times.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ToleranceRow {
    pub(super) program: String,
    pub(super) method: String,
    pub(super) tolerance: f64,
    pub(super) timed: Timed,
    /// Or why there are no figures.
    pub(super) result: Result<RunFigures, String>,
}

/// What a run time is that of. Only times of the same are divided by each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Timed {
    /// The run alone, within this program.
    RunAlone,
    /// A process from its start to its end, this program's or a peer's.
    WholeProcess,
}

impl Timed {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::RunAlone => "run alone",
            Self::WholeProcess => "whole process",
        }
    }
}

impl ToleranceRow {
    /// The method, after the program where that is a process.
    pub(super) fn name(&self) -> String {
        match self.timed {
            Timed::RunAlone => self.method.clone(),
            Timed::WholeProcess => format!("{} {}", self.program, self.method),
        }
    }

    pub(super) fn from_reference(reference: &Reference) -> Self {
        let result = Ok(reference.figures());
        Self::from_run(REFERENCE, reference.tolerance, result)
    }

    fn from_run(method: &str, tolerance: f64, result: Result<RunFigures, String>) -> Self {
        Self { program: PROGRAM.into(), method: method.into(), tolerance, timed: Timed::RunAlone, result }
    }
}

/// The runs of each method over tolerances.
#[derive(Debug)]
pub(super) struct ToleranceLadder<'a> {
    /// From loose to tight.
    pub(super) tolerances: &'a [f64],
    /// Rows of a phase.
    pub(super) points: u32,
    /// How often each run is timed at most.
    pub(super) repeat: u32,
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
    pub(super) fn run(&self, reference: &Reference, progress: &Progress) -> Vec<ToleranceRow> {
        METHODS.iter().flat_map(|&(method, name)| self.run_method(method, name, reference, progress)).collect()
    }

    /// The runs of one method, until they take far more work than the reference.
    fn run_method(&self, method: Method, name: &str, reference: &Reference, progress: &Progress) -> Vec<ToleranceRow> {
        let scene = with_method(&reference.scene, method);
        let most = reference.measured.counts.iterations;
        let mut last = 0;
        let mut row = |&tolerance: &f64| {
            let result = if last > PATIENCE * most {
                Err(format!("left out: a looser one took {last} Newton iterations, the reference {most}"))
            } else {
                self.rung(&at_tolerance(&scene, tolerance), name, reference, progress).map_err(|why| why.to_string())
            };
            last = result.as_ref().ok().and_then(|figures| figures.iterations).unwrap_or(last);
            ToleranceRow::from_run(name, tolerance, result)
        };
        self.tolerances.iter().map(&mut row).collect()
    }

    /// A run with its estimate of its own error; its time is that of both.
    fn rung(
        &self,
        scene: &Scene,
        method: &str,
        reference: &Reference,
        progress: &Progress,
    ) -> Result<RunFigures, RunFailure> {
        let tolerance = scene.solver.relative_tolerance;
        let message = format!("{method}, tolerance {tolerance:e}, with its estimate");
        let weight = self.rung_weight(scene.solver.method, tolerance);
        let (comparison, scene) = (reference.comparison, estimated(scene));
        let follow = |tick: &dyn Fn(f64)| follow(&scene, comparison.rows(), 0.0, UNLIMITED, tick);
        let run = progress.during(&message, weight, follow)?;
        let errors = comparison.errors(&run.trace, &reference.measured.trace);
        Ok(RunFigures { estimate: Some(run.estimate), ..run.figures(errors) })
    }

    /// Times the runs of `rows` again without their estimates, in rounds: what disturbs the machine for a while does
    /// not meet all timings of one run.
    pub(super) fn time(&self, reference: &Reference, rows: &mut [ToleranceRow]) {
        let mut runs: Vec<TimedRun<'_>> =
            rows.iter_mut().filter_map(|row| TimedRun::new(row, &reference.scene, self.repeat)).collect();
        let progress = Progress::new(runs.iter().map(|run| f64::from(run.repeat) * run.expected).sum());
        for round in 0..self.repeat {
            let due = runs.iter_mut().filter(|run| round < run.repeat);
            due.for_each(|run| run.time(Rows::PerPhase(self.points), &progress));
        }
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
    times: Vec<f64>,
}

impl<'a> TimedRun<'a> {
    /// The timed run of a row whose run came to its end; it is timed `most` times at most.
    fn new(row: &'a mut ToleranceRow, scene: &Scene, most: u32) -> Option<Self> {
        let (method, _) = METHODS.into_iter().find(|(_, name)| *name == row.method)?;
        let scene = with_method(&at_tolerance(scene, row.tolerance), method);
        let message = format!("timing {}, tolerance {:e}", row.method, row.tolerance);
        let figures = row.result.as_mut().ok()?;
        let expected = figures.time?;
        Some(Self { figures, message, scene, expected, repeat: timings(expected, most), times: Vec::new() })
    }

    fn time(&mut self, rows: Rows, progress: &Progress) {
        let run = progress.during(&self.message, self.expected, |tick| follow(&self.scene, rows, 0.0, UNLIMITED, tick));
        self.times.extend(run.ok().map(|run| run.time));
        *self.figures = self.figures.timed(&self.times);
    }
}

/// How often a run is timed that takes up to `time` (s): short ones more often, but none more than `most` times.
fn timings(time: f64, most: u32) -> u32 {
    ((ENOUGH / time).ceil() as u32).max(MIN_TIMINGS).min(most)
}

/// A row of the table of errors and communication steps.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CommunicationRow {
    pub(super) given: MasterInputs,
    /// The communication step, s; `None` without a master.
    pub(super) step: Option<f64>,
    /// Where runs are compared row by row, with the root mean squares of the errors; or why there are no figures.
    pub(super) result: Result<(RunFigures, Option<Errors>), String>,
}

/// The communication steps of a master, at the scene's own tolerance and method. What a user of the FMU meets: its
/// carrier follows the excitation by values, with or without rates.
#[derive(Debug)]
pub(super) struct CommunicationLadder<'a> {
    reference: &'a Reference,
    /// The longest step, s.
    longest: f64,
    progress: &'a Progress,
}

impl<'a> CommunicationLadder<'a> {
    /// The longest communication step is about this part of the excitation.
    const LONGEST: f64 = 1.0 / 64.0;
    /// Each step is half of the one before.
    const STEPS: u32 = 7;
    /// Parts of the longest step that make the shortest.
    const FINEST: u32 = 1 << (Self::STEPS - 1);

    /// What all runs are likely to take, by [`weight`], for a reference and a scene at these tolerances.
    pub(super) fn weight(reference: f64, scene: f64) -> f64 {
        weight(reference) + f64::from(2 * Self::STEPS + 1) * weight(scene)
    }

    pub(super) fn new(reference: &'a Reference, progress: &'a Progress) -> Self {
        Self { reference, longest: round_down(Self::LONGEST * reference.scene.duration()), progress }
    }

    pub(super) fn run(&self) -> Vec<CommunicationRow> {
        let scene = &self.reference.scene;
        let finest = self.rows(Self::FINEST);
        let tight = exact(&at_tolerance(scene, self.reference.tolerance));
        let follow = |message: &str, scene: &Scene| {
            let weight = weight(scene.solver.relative_tolerance);
            self.progress.during(message, weight, |tick| follow(scene, finest, 0.0, UNLIMITED, tick))
        };
        let Ok(tight) = follow("reference at the communication points", &tight) else { return Vec::new() };
        let alone = follow(MasterInputs::None.name(), scene);
        let mut table = Vec::new();
        for given in [MasterInputs::Rates, MasterInputs::Values] {
            for parts in (0..Self::STEPS).map(|step| 1 << step) {
                let result = self.drive(given, parts).map(|run| self.compare(&run, &self.every(&tight, parts)));
                let step = Some(self.longest / f64::from(parts));
                table.push(CommunicationRow { given, step, result: result.map_err(|why| why.to_string()) });
            }
        }
        let result = alone.map(|run| {
            let (figures, mean_squares) = self.compare(&run, &tight.trace);
            // Its time was spent on the rows: there are as many as communication points at the shortest step.
            (RunFigures { time: None, ..figures }, mean_squares)
        });
        let result = result.map_err(|why| why.to_string());
        table.push(CommunicationRow { given: MasterInputs::None, step: None, result });
        table
    }

    fn rows(&self, parts: u32) -> Rows {
        Rows::Within { longest: self.longest, parts }
    }

    /// The rows of the finest run at the communication points of a coarser one.
    fn every(&self, finest: &CompletedRun, parts: u32) -> Trace {
        finest.trace.every((Self::FINEST / parts) as usize)
    }

    fn drive(&self, given: MasterInputs, parts: u32) -> Result<CompletedRun, RunFailure> {
        let scene = &self.reference.scene;
        let times = |duration: f64| self.rows(parts).times(duration).collect();
        let points: Vec<Vec<f64>> = scene.excitation.iter().map(|phase| times(phase.duration)).collect();
        let step = self.longest / f64::from(parts);
        let message = format!("{}, communication step {step:.3e} s", given.name());
        let weight = weight(scene.solver.relative_tolerance);
        self.progress.during(&message, weight, |tick| drive(scene, given, &points, 0.0, UNLIMITED, tick))
    }

    fn compare(&self, run: &CompletedRun, tight: &Trace) -> (RunFigures, Option<Errors>) {
        let (errors, mean_squares) = match self.reference.comparison {
            Comparison::Pointwise(_) => (run.trace.largest(tight), Some(run.trace.mean_square(tight))),
            Comparison::Means(_) => (run.trace.means(tight), None),
        };
        (run.figures(errors), mean_squares)
    }
}

/// The largest of 1, 2 and 5 times a power of ten that is not above `value`.
fn round_down(value: f64) -> f64 {
    let decade = value.log10().floor();
    let factor = [5.0, 2.0, 1.0].into_iter().find(|factor| factor * 10_f64.powf(decade) <= value * 1.001);
    // Written and read, so that it is the number nearest to what is written.
    let written = format!("{}e{decade}", factor.unwrap_or(1.0));
    written.parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_runs_are_timed_more_often() {
        assert_eq!([1e-4, 0.1, 0.5, 60.0].map(|time| timings(time, 25)), [25, 20, 4, 3]);
        assert_eq!([1e-4, 60.0].map(|time| timings(time, 1)), [1, 1]);
    }

    #[test]
    fn the_longest_step_is_a_round_one() {
        assert_eq!([8.6e-5, 1e-3, 4.9e-2, 3.0].map(round_down), [5e-5, 1e-3, 2e-2, 2.0]);
    }
}
