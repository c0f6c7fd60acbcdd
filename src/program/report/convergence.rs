//! Errors against what a run costs: over the tolerances of each method, and over the communication steps of a master.

use asperity::robustness::{RunFailure, at_tolerance, exact};
use asperity::scene::{Method, Scene};

use super::reference::{Comparison, Reference};
use super::run::{Figures, Given, Measured, Progress, UNLIMITED, drive, follow, weight};
use super::trace::{Errors, Trace};
use crate::program::runner::Rows;

/// The name of this program beside those of its peers.
pub(super) const PROGRAM: &str = "asperity";
/// The name of the reference among the methods.
const REFERENCE: &str = "reference";
/// The methods compared, and their names in `solver.method`.
const METHODS: [(Method, &str); 2] = [(Method::Event, "event"), (Method::Step, "step")];
/// Once a method has taken so many times the Newton iterations of the reference, its tighter runs are left out.
pub(super) const PATIENCE: u64 = 3;

/// A row of the table of errors and run times.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ToleranceRow {
    pub(super) program: String,
    pub(super) method: String,
    pub(super) tolerance: f64,
    /// Or why there are no figures.
    pub(super) result: Result<Figures, String>,
}

impl ToleranceRow {
    /// The method, after the program where that is a peer.
    pub(super) fn name(&self) -> String {
        if self.program == PROGRAM { self.method.clone() } else { format!("{} {}", self.program, self.method) }
    }

    pub(super) fn of_reference(reference: &Reference) -> Self {
        let result = Ok(reference.figures());
        Self { program: PROGRAM.into(), method: REFERENCE.into(), tolerance: reference.tolerance, result }
    }
}

/// The runs of each method over tolerances.
#[derive(Debug)]
pub(super) struct ToleranceLadder<'a> {
    /// From loose to tight.
    pub(super) tolerances: &'a [f64],
    /// Rows of a phase.
    pub(super) points: u32,
    /// How often each run is timed.
    pub(super) repeat: u32,
}

impl ToleranceLadder<'_> {
    /// As [`weight`].
    pub(super) fn weight(&self) -> f64 {
        let rungs = METHODS.iter().flat_map(|&(method, _)| self.tolerances.iter().map(move |&rung| (method, rung)));
        f64::from(self.repeat) * rungs.map(|(method, rung)| self.rung_weight(method, rung)).sum::<f64>()
    }

    /// The method "step" is of order 2: as quick as the other at a thousandth, its steps follow the square root, until
    /// it is given up.
    fn rung_weight(&self, method: Method, tolerance: f64) -> f64 {
        const EVEN: f64 = 1e-3;
        let most = 3.0 * PATIENCE as f64 * self.tolerances.last().map_or(1.0, |&tightest| weight(tightest));
        match method {
            Method::Step => (weight(EVEN) * (EVEN / tolerance).sqrt()).min(most),
            _ => weight(tolerance),
        }
    }

    /// Runs all tolerances, method by method.
    pub(super) fn run(&self, reference: &Reference, progress: &Progress) -> Vec<ToleranceRow> {
        METHODS.iter().flat_map(|&(method, name)| self.run_method(method, name, reference, progress)).collect()
    }

    /// The runs of one method, until they take far more work than the reference.
    fn run_method(&self, method: Method, name: &str, reference: &Reference, progress: &Progress) -> Vec<ToleranceRow> {
        let mut scene = reference.scene.clone();
        scene.solver.method = method;
        let most = reference.measured.counts.iterations;
        let mut last = 0;
        let mut row = |&tolerance: &f64| {
            let result = if last > PATIENCE * most {
                Err(format!("left out: a looser one took {last} Newton iterations, the reference {most}"))
            } else {
                self.rung(&at_tolerance(&scene, tolerance), name, reference, progress).map_err(|why| why.to_string())
            };
            last = result.as_ref().ok().and_then(|figures| figures.iterations).unwrap_or(last);
            ToleranceRow { program: PROGRAM.into(), method: name.into(), tolerance, result }
        };
        self.tolerances.iter().map(&mut row).collect()
    }

    fn rung(
        &self,
        scene: &Scene,
        method: &str,
        reference: &Reference,
        progress: &Progress,
    ) -> Result<Figures, RunFailure> {
        let tolerance = scene.solver.relative_tolerance;
        let weight = self.rung_weight(scene.solver.method, tolerance);
        let measure = |rows: Rows, what: &str| {
            let message = format!("{method}, tolerance {tolerance:e}{what}");
            progress.during(&message, weight, |tick| follow(scene, rows, 0.0, UNLIMITED, tick))
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
        let errors = comparison.errors(&run.trace, &reference.measured.trace);
        Ok(Figures { time: Some(median(times)), ..run.figures(errors) })
    }
}

/// Of an even number, the mean of the two in the middle.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    if n == 0 { 0.0 } else { f64::midpoint(values[(n - 1) / 2], values[n / 2]) }
}

/// A row of the table of errors and communication steps.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CommunicationRow {
    pub(super) given: Given,
    /// The communication step, s; `None` without a master.
    pub(super) step: Option<f64>,
    /// Where runs are compared row by row, with the root mean squares of the errors; or why there are no figures.
    pub(super) result: Result<(Figures, Option<Errors>), String>,
}

/// The communication steps of a master, at the scene's own tolerance and method. What a user of the FMU meets: its
/// carrier follows the excitation by values, with or without rates.
#[derive(Debug)]
pub(super) struct CommunicationSteps<'a> {
    reference: &'a Reference,
    /// The longest step, s.
    longest: f64,
    progress: &'a Progress,
}

impl<'a> CommunicationSteps<'a> {
    /// The longest communication step is about this part of the excitation.
    const LONGEST: f64 = 1.0 / 64.0;
    /// Each step is half of the one before.
    const STEPS: u32 = 7;
    /// Parts of the longest step that make the shortest.
    const FINEST: u32 = 1 << (Self::STEPS - 1);

    /// As [`weight`], for a reference and a scene at these tolerances.
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
        let alone = follow(Given::Motion.name(), scene);
        let mut table = Vec::new();
        for given in [Given::Rates, Given::Values] {
            for parts in (0..Self::STEPS).map(|step| 1 << step) {
                let result = self.drive(given, parts).map(|run| self.compare(&run, &self.every(&tight, parts)));
                let step = Some(self.longest / f64::from(parts));
                table.push(CommunicationRow { given, step, result: result.map_err(|why| why.to_string()) });
            }
        }
        let result = alone.map(|run| {
            let (figures, mean_squares) = self.compare(&run, &tight.trace);
            // Its time was spent on the rows: there are as many as communication points at the shortest step.
            (Figures { time: None, ..figures }, mean_squares)
        });
        let result = result.map_err(|why| why.to_string());
        table.push(CommunicationRow { given: Given::Motion, step: None, result });
        table
    }

    fn rows(&self, parts: u32) -> Rows {
        Rows::Within { longest: self.longest, parts }
    }

    /// The rows of the finest run at the communication points of a coarser one.
    fn every(&self, finest: &Measured, parts: u32) -> Trace {
        finest.trace.every((Self::FINEST / parts) as usize)
    }

    fn drive(&self, given: Given, parts: u32) -> Result<Measured, RunFailure> {
        let scene = &self.reference.scene;
        let times = |duration: f64| self.rows(parts).times(duration).collect();
        let points: Vec<Vec<f64>> = scene.excitation.iter().map(|phase| times(phase.duration)).collect();
        let step = self.longest / f64::from(parts);
        let message = format!("{}, communication step {step:.3e} s", given.name());
        let weight = weight(scene.solver.relative_tolerance);
        self.progress.during(&message, weight, |tick| drive(scene, given, &points, 0.0, UNLIMITED, tick))
    }

    fn compare(&self, run: &Measured, tight: &Trace) -> (Figures, Option<Errors>) {
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
    fn a_median_is_the_middle_one() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![3.0, 1.0, 2.0, 10.0]), 2.5);
    }

    #[test]
    fn the_longest_step_is_a_round_one() {
        assert_eq!([8.6e-5, 1e-3, 4.9e-2, 3.0].map(round_down), [5e-5, 1e-3, 2e-2, 2.0]);
    }
}
