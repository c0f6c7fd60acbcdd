//! Errors against the communication steps of a master.

use asperity::scene::Scene;

use super::figures::{CompletedRun, RunFigures};
use super::master::{MasterInputs, drive};
use super::reference::{Comparison, Reference};
use super::run::{UNLIMITED, follow};
use super::trace::{Errors, Trace};
use super::weighed::{WeighedRuns, weight};
use crate::robustness::{RunFailure, at_tolerance, exact};
use crate::runner::Rows;

/// A row of the table of errors and communication steps.
#[derive(Clone, Debug, PartialEq)]
pub struct CommunicationRow {
    /// What the master gives.
    pub given: MasterInputs,
    /// The communication step, s; `None` without a master.
    pub step: Option<f64>,
    /// Where runs are compared row by row, with the root mean squares of the errors; or why there are no figures.
    pub result: Result<(RunFigures, Option<Errors>), RunFailure>,
}

/// The communication steps of a master, at the scene's own tolerance and method. What a user of the FMU meets: its
/// carrier follows the excitation by values, with or without rates.
pub(super) struct CommunicationLadder<'a> {
    reference: &'a Reference,
    /// The longest step, s.
    longest: f64,
    progress: &'a WeighedRuns<'a>,
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

    pub(super) fn new(reference: &'a Reference, progress: &'a WeighedRuns<'a>) -> Self {
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
                table.push(CommunicationRow { given, step, result });
            }
        }
        let result = alone.map(|run| {
            let (figures, mean_squares) = self.compare(&run, &tight.trace);
            // Its time was spent on the rows: there are as many as communication points at the shortest step.
            (RunFigures { time: None, ..figures }, mean_squares)
        });
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
    fn the_longest_step_is_a_round_one() {
        assert_eq!([8.6e-5, 1e-3, 4.9e-2, 3.0].map(round_down), [5e-5, 1e-3, 2e-2, 2.0]);
    }
}
