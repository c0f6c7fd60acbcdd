//! The run that all others are compared with, its own error, and whether runs can be compared point by point at all.

use asperity::scene::Scene;
use asperity::simulation::SimulationError;

use super::progress::{Progress, weight};
use super::runs::{Counts, Measured, at_tolerance, exact, run, with_durations};
use super::trace::{Errors, Trace, WINDOWS};
use crate::program::arguments::tenth;
use crate::program::excitation::Rows;

/// How far the start is moved to see whether the motion is sensitive, m: far below what any scene resolves.
pub(super) const DISPLACEMENT: f64 = 1e-12;
/// Runs have parted where the moved start changes a force by more than this share of its largest value: where it does
/// not spread, it changes some 1e-8, and up to 1e-4 where the layer is stiff against the force.
const PARTED: f64 = 1e-3;
/// On a profile so fine that the displacement is no small part of its height, so many times that part.
const OF_HEIGHT: f64 = 100.0;
/// A run that is ten times as tight may take so many times the steps. It is far more than any method needs: where it is
/// used up, rounding has taken over.
const WORK: u64 = 10;
/// Rows of a phase from which means are taken.
const SAMPLES: u32 = 50 * WINDOWS;

/// The run that all others are compared with.
#[derive(Debug)]
pub(super) struct Reference {
    /// Its relative tolerance.
    pub(super) tolerance: f64,
    /// The relative tolerance of the run that tells its error; `None` where no other run came to its end.
    pub(super) check: Option<f64>,
    /// The run.
    pub(super) measured: Measured,
    /// Its own error; errors below say no more.
    pub(super) own: Errors,
    /// What a moved start changes.
    pub(super) sensitivity: Sensitivity,
    /// How runs are compared with it.
    pub(super) comparison: Comparison,
    /// The scene with its motion fixed: phases that a force ends take the time that they took once.
    pub(super) scene: Scene,
}

/// What a start moved by [`DISPLACEMENT`] changes, point by point.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sensitivity {
    /// The largest differences.
    pub(super) differences: Errors,
    /// The difference above which the runs have parted.
    pub(super) limit: f64,
}

/// How two runs are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Comparison {
    /// Row by row.
    Pointwise(Rows),
    /// By means over windows, and the energy lost row by row.
    Means(Rows),
}

impl Sensitivity {
    fn new(scene: &Scene, differences: Errors) -> Self {
        Self { differences, limit: parting(scene) }
    }

    /// Whether the two runs went apart.
    pub(super) fn parted(&self) -> bool {
        self.differences[..2].iter().flatten().any(|&difference| difference > self.limit)
    }
}

/// The difference above which two runs have parted whose starts differ by [`DISPLACEMENT`].
pub(super) fn parting(scene: &Scene) -> f64 {
    (OF_HEIGHT * DISPLACEMENT / scene.height()).max(PARTED)
}

impl Comparison {
    /// The rows that a run needs for it.
    pub(super) fn rows(self) -> Rows {
        match self {
            Self::Pointwise(rows) | Self::Means(rows) => rows,
        }
    }

    /// Whether means are compared.
    pub(super) fn is_of_means(self) -> bool {
        matches!(self, Self::Means(_))
    }

    /// The errors of a run.
    pub(super) fn errors(self, trace: &Trace, reference: &Trace) -> Errors {
        match self {
            Self::Pointwise(_) => trace.largest(reference),
            Self::Means(_) => trace.means(reference),
        }
    }
}

/// What the search for a reference weighs, for a ladder down to `tightest`.
pub(super) fn search_weight(tightest: f64) -> f64 {
    weight(tightest) + 2.0 * weight(tightest / 10.0) + weight(tightest / 100.0)
}

/// Finds the reference for a ladder of tolerances, from loose to tight: by the method "event" ten times as tight as the
/// ladder, its error by a run ten times tighter still. Where such a run gives up, the tightest rungs that do not.
pub(super) fn find(
    scene: &Scene,
    ladder: &[f64],
    points: u32,
    progress: &Progress,
) -> Result<Reference, SimulationError> {
    let rows = Rows::PerPhase(points);
    let (rung, base) = tightest(&exact(scene), ladder, rows, progress)?;
    let scene = with_durations(scene, &base.durations);
    let search = Search { scene: &exact(&scene), rows, progress };
    let (run, check) = match search.tighter(ladder[rung], &base.counts) {
        None => ((ladder[rung], base), search.looser(&ladder[..rung])),
        Some((tolerance, run)) => {
            let check = search.tighter(tolerance, &run.counts);
            ((tolerance, run), check.or(Some((ladder[rung], base))))
        }
    };
    let (tolerance, measured) = run;
    let moved = search.run(tolerance, rows, DISPLACEMENT, None)?;
    let sensitivity = Sensitivity::new(&scene, moved.trace.largest(&measured.trace));
    let pointwise = Comparison::Pointwise(rows);
    let own =
        check.as_ref().map_or([Some(f64::INFINITY); 3], |check| pointwise.errors(&check.1.trace, &measured.trace));
    let check = check.map(|check| check.0);
    let found = Reference { tolerance, check, measured, own, sensitivity, comparison: pointwise, scene: scene.clone() };
    if found.sensitivity.parted() { search.by_means(found) } else { Ok(found) }
}

/// The tightest rung whose run does not give up, and that run; `ladder` is not empty.
fn tightest(
    scene: &Scene,
    ladder: &[f64],
    rows: Rows,
    progress: &Progress,
) -> Result<(usize, Measured), SimulationError> {
    let search = Search { scene, rows, progress };
    let mut rung = ladder.len() - 1;
    loop {
        match search.run(ladder[rung], rows, 0.0, None) {
            Ok(measured) => return Ok((rung, measured)),
            Err(error) if rung == 0 => return Err(error),
            Err(_) => rung -= 1,
        }
    }
}

/// What the runs of the search share.
struct Search<'a> {
    scene: &'a Scene,
    rows: Rows,
    progress: &'a Progress,
}

impl Search<'_> {
    /// A run at `tolerance` from the carrier at `u` (m), with so many steps at most where a limit is given.
    fn run(&self, tolerance: f64, rows: Rows, u: f64, limit: Option<u64>) -> Result<Measured, SimulationError> {
        let mut scene = at_tolerance(self.scene, tolerance);
        scene.solver.max_steps = limit.unwrap_or(u64::MAX).min(scene.solver.max_steps);
        let message = format!("reference, tolerance {tolerance:e}");
        self.progress.during(&message, weight(tolerance), |tick| run(&scene, rows, u, tick))
    }

    /// A run ten times as tight as `tolerance`, where one took `counts`; `None` where it gives up.
    fn tighter(&self, tolerance: f64, counts: &Counts) -> Option<(f64, Measured)> {
        let limit = WORK * (counts.steps + counts.rejected + counts.events) + 1000;
        let tolerance = tenth(tolerance);
        self.run(tolerance, self.rows, 0.0, Some(limit)).ok().map(|run| (tolerance, run))
    }

    /// The tightest of the `rungs` whose run does not give up.
    fn looser(&self, rungs: &[f64]) -> Option<(f64, Measured)> {
        rungs.iter().rev().find_map(|&rung| self.run(rung, self.rows, 0.0, None).ok().map(|run| (rung, run)))
    }

    /// The reference with means in place of rows. What a moved start changes in them counts as its error, too: no run
    /// can know better.
    fn by_means(&self, pointwise: Reference) -> Result<Reference, SimulationError> {
        let comparison = Comparison::Means(Rows::PerPhase(SAMPLES));
        let run = |tolerance: f64, u: f64| self.run(tolerance, comparison.rows(), u, None);
        let measured = run(pointwise.tolerance, 0.0)?;
        let mut own = comparison.errors(&run(pointwise.tolerance, DISPLACEMENT)?.trace, &measured.trace);
        if let Some(check) = pointwise.check {
            let errors = comparison.errors(&run(check, 0.0)?.trace, &measured.trace);
            own = [0, 1, 2].map(|i| own[i].zip(errors[i]).map(|(moved, checked)| moved.max(checked)));
        }
        Ok(Reference { measured, own, comparison, ..pointwise })
    }
}
