//! The run that all others are compared with, its own error, and whether runs can be compared row by row at all.

use asperity::scene::Scene;

use super::run::{CompletedRun, Counts, UNLIMITED, WeighedRuns, follow, weight, with_durations};
use super::trace::{Errors, QUANTITIES, Trace, WINDOWS};
use crate::decimals::tenth;
use crate::robustness::{Budget, DISPLACEMENT, RunFailure, at_tolerance, divergence, exact};
use crate::runner::Rows;

/// A run at a tenth of the tolerance may take so many times the steps, far more than any method needs: where they are
/// used up, rounding has taken over.
const WORK: u64 = 10;
/// Rows of a phase from which means are taken.
const SAMPLES: u32 = 50 * WINDOWS;

/// The run that all others are compared with.
#[derive(Debug)]
pub struct Reference {
    /// Its relative tolerance.
    pub tolerance: f64,
    /// The relative tolerance of the run that gives its error; `None` where no other run came to its end.
    pub check: Option<f64>,
    /// The run.
    pub measured: CompletedRun,
    /// Its own error; errors below it are not significant.
    pub own: Errors,
    /// What a moved start changes.
    pub sensitivity: StartSensitivity,
    /// How runs are compared.
    pub comparison: Comparison,
    /// The scene with its motion fixed: phases that a force ends take the time that they took once.
    pub scene: Scene,
    /// Of phases that ended before their force was reached.
    pub warnings: Vec<String>,
}

/// What a start moved by [`DISPLACEMENT`] changes, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct StartSensitivity {
    /// What it changes, each over the largest value.
    pub differences: Errors,
    /// The difference above which the runs have diverged.
    pub limit: f64,
}

/// How runs are compared with the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Comparison {
    /// Row by row.
    Pointwise(Rows),
    /// By means over windows, and the energy lost row by row.
    Means(Rows),
}

impl StartSensitivity {
    fn diverged(&self) -> bool {
        self.differences[..2].iter().flatten().any(|&difference| difference > self.limit)
    }
}

impl Comparison {
    /// The rows that a run needs for it.
    pub fn rows(self) -> Rows {
        match self {
            Self::Pointwise(rows) | Self::Means(rows) => rows,
        }
    }

    /// Whether single rows cannot be compared.
    pub fn is_of_means(self) -> bool {
        matches!(self, Self::Means(_))
    }

    /// The errors of a run.
    pub fn errors(self, trace: &Trace, reference: &Trace) -> Errors {
        match self {
            Self::Pointwise(_) => trace.largest(reference),
            Self::Means(_) => trace.means(reference),
        }
    }
}

impl Reference {
    /// Finds the reference for a ladder of tolerances, from loose to tight: by the method "event" at a tenth of the
    /// tightest, its error by a run at a tenth of that. Where such a run gives up, the tightest of the ladder that do
    /// not.
    pub(super) fn find(
        scene: &Scene,
        ladder: &[f64],
        points: u32,
        progress: &WeighedRuns<'_>,
    ) -> Result<Self, RunFailure> {
        let rows = Rows::PerPhase(points);
        let (rung, base) = ReferenceSearch { scene: &exact(scene), rows, progress }.tightest(ladder)?;
        let (scene, warnings) = (with_durations(scene, &base.durations), base.warnings.clone());
        let search = ReferenceSearch { scene: &exact(&scene), rows, progress };
        let (run, check) = match search.tighter(ladder[rung], &base.counts) {
            None => ((ladder[rung], base), search.looser(&ladder[..rung])),
            Some((tolerance, run)) => {
                let check = search.tighter(tolerance, &run.counts);
                ((tolerance, run), check.or(Some((ladder[rung], base))))
            }
        };
        let (tolerance, measured) = run;
        let moved = search.run(tolerance, rows, DISPLACEMENT, UNLIMITED)?;
        let differences = moved.trace.largest(&measured.trace);
        let sensitivity = StartSensitivity { differences, limit: divergence(&scene) };
        let comparison = Comparison::Pointwise(rows);
        let unknown = [Some(f64::INFINITY); QUANTITIES.len()];
        let own = check.as_ref().map_or(unknown, |(_, check)| comparison.errors(&check.trace, &measured.trace));
        let check = check.map(|(tolerance, _)| tolerance);
        let found = Self { tolerance, check, measured, own, sensitivity, comparison, scene: scene.clone(), warnings };
        if found.sensitivity.diverged() { search.by_means(found) } else { Ok(found) }
    }

    /// What the search weighs, for a ladder down to `tightest`.
    pub(super) fn weight(tightest: f64) -> f64 {
        weight(tightest) + 2.0 * weight(tightest / 10.0) + weight(tightest / 100.0)
    }

    /// Which errors are below the reference's own.
    pub fn below(&self, errors: &Errors) -> [bool; QUANTITIES.len()] {
        std::array::from_fn(|i| errors[i].zip(self.own[i]).is_some_and(|(error, own)| error < own))
    }
}

struct ReferenceSearch<'a> {
    scene: &'a Scene,
    rows: Rows,
    progress: &'a WeighedRuns<'a>,
}

impl ReferenceSearch<'_> {
    fn run(&self, tolerance: f64, rows: Rows, u: f64, budget: Budget) -> Result<CompletedRun, RunFailure> {
        let scene = at_tolerance(self.scene, tolerance);
        let message = format!("reference, tolerance {tolerance:e}");
        self.progress.during(&message, weight(tolerance), |tick| follow(&scene, rows, u, budget, tick))
    }

    /// The tightest rung whose run does not fail, and that run; `ladder` is not empty.
    fn tightest(&self, ladder: &[f64]) -> Result<(usize, CompletedRun), RunFailure> {
        let mut rung = ladder.len() - 1;
        loop {
            match self.run(ladder[rung], self.rows, 0.0, UNLIMITED) {
                Ok(measured) => return Ok((rung, measured)),
                Err(error) if rung == 0 => return Err(error),
                Err(_) => rung -= 1,
            }
        }
    }

    /// A run at a tenth of `tolerance`, where one took `counts`; `None` where it fails.
    fn tighter(&self, tolerance: f64, counts: &Counts) -> Option<(f64, CompletedRun)> {
        let budget = Budget(WORK * (counts.work() + counts.events) + 1000);
        let tolerance = tenth(tolerance);
        self.run(tolerance, self.rows, 0.0, budget).ok().map(|run| (tolerance, run))
    }

    /// The tightest of the `rungs` whose run does not fail.
    fn looser(&self, rungs: &[f64]) -> Option<(f64, CompletedRun)> {
        rungs.iter().rev().find_map(|&rung| self.run(rung, self.rows, 0.0, UNLIMITED).ok().map(|run| (rung, run)))
    }

    /// The reference with means in place of rows. What a moved start changes in them counts as its error too: no run
    /// can know better.
    fn by_means(&self, pointwise: Reference) -> Result<Reference, RunFailure> {
        let comparison = Comparison::Means(Rows::PerPhase(SAMPLES));
        let run = |tolerance: f64, u: f64| self.run(tolerance, comparison.rows(), u, UNLIMITED);
        let measured = run(pointwise.tolerance, 0.0)?;
        let mut own = comparison.errors(&run(pointwise.tolerance, DISPLACEMENT)?.trace, &measured.trace);
        if let Some(check) = pointwise.check {
            let errors = comparison.errors(&run(check, 0.0)?.trace, &measured.trace);
            own = std::array::from_fn(|i| own[i].zip(errors[i]).map(|(moved, checked)| moved.max(checked)));
        }
        Ok(Reference { measured, own, comparison, ..pointwise })
    }
}
