//! Tight runs, what they may take, and how accurate a run is beside one.

use asperity::scene::{Axis, Method, Scene};
use asperity::simulation::SimulationError;

/// A tight run's tolerance is so many times lower.
pub const TIGHTER: f64 = 100.0;
/// How far the start is moved to find out whether a motion is sensitive, m: far below what any scene resolves.
pub const DISPLACEMENT: f64 = 1e-12;
/// Two runs have diverged where they differ by more than this share of the largest force: a moved start that does not
/// spread changes some 1e-8, and up to 1e-4 where the layer is stiff against the force.
const DIVERGED: f64 = 1e-3;
/// On a profile so fine that the displacement is no small part of its height: so many times that part.
const OF_HEIGHT: f64 = 100.0;

/// The scene at the relative tolerance `tolerance`; an absolute tolerance of its own is scaled with it.
pub fn at_tolerance(scene: &Scene, tolerance: f64) -> Scene {
    let mut scene = scene.clone();
    let ratio = tolerance / scene.solver.relative_tolerance;
    scene.solver.absolute_tolerance = scene.solver.absolute_tolerance.map(|absolute| absolute * ratio);
    scene.solver.relative_tolerance = tolerance;
    scene
}

/// The scene as a reference runs it: every mode change located, no Maxwell element left out.
pub fn exact(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    (scene.solver.method, scene.solver.reduce) = (Method::Event, 0.0);
    scene
}

/// The difference, as a share of the largest force, above which two runs have diverged whose starts differ by
/// [`DISPLACEMENT`].
pub fn divergence(scene: &Scene) -> f64 {
    (OF_HEIGHT * DISPLACEMENT / scene.height()).max(DIVERGED)
}

/// The most steps that a run may try, rejected ones included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget(pub u64);

impl Budget {
    /// The scene with the budget as its limit, unless its own is lower.
    pub fn limit(self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        scene.solver.max_steps = Some(scene.solver.max_steps().min(self.0));
        scene
    }

    /// What an error of a run of [`limit`](Self::limit) means for the scene.
    pub fn failure(self, scene: &Scene, error: &SimulationError) -> RunFailure {
        match error {
            SimulationError::TooManySteps { time, .. } if self.0 <= scene.solver.max_steps() => {
                RunFailure::OverBudget { time: *time }
            }
            error => RunFailure::Stopped(error.to_string()),
        }
    }
}

/// Why a run did not come to its end.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RunFailure {
    /// Its budget was used up.
    #[error("over budget at t = {time:.3e} s")]
    OverBudget {
        /// When, s.
        time: f64,
    },
    /// It stopped with this error.
    #[error("{0}")]
    Stopped(String),
}

/// Errors up to so many tolerances are kept: the tolerance bounds the error of one step, and these add up.
pub const KEPT: f64 = 10.0;
/// Runs with errors of more tolerances are examined for sensitivity.
pub const NOTABLE: f64 = 100.0;
/// Errors of more tolerances are wrong, ...
pub const WRONG: f64 = 1000.0;
/// ... and so are those of more than this share of the largest force.
const WRONG_SHARE: f64 = 0.1;
/// A motion is sensitive where a moved start changes at least this part of the error.
const OF_ERROR: f64 = 0.1;

/// The forces of a run, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ForceHistory {
    /// Times of the rows, s.
    pub times: Vec<f64>,
    /// F_x and F_z, N.
    pub rows: Vec<[f64; 2]>,
}

/// The largest difference of a force between two runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Over the largest force.
    pub share: f64,
    /// Which of F_x and F_z differs so much.
    pub of: Axis,
    /// When, s.
    pub time: f64,
}

impl ForceHistory {
    /// The largest difference of any of `forces` from a reference that has the same rows, over the largest of these
    /// forces in it.
    pub fn difference(&self, reference: &Self, forces: &[Axis]) -> Difference {
        let all = reference.rows.iter().flat_map(|row| forces.iter().map(|&force| row[force as usize]));
        let largest = all.fold(0.0, |most, force| larger(most, force.abs()));
        let mut found = Difference { share: 0.0, of: Axis::Z, time: reference.times.first().copied().unwrap_or(0.0) };
        for ((row, wanted), &time) in self.rows.iter().zip(&reference.rows).zip(&reference.times) {
            for &of in forces {
                let difference = (row[of as usize] - wanted[of as usize]).abs();
                // NaN is infinitely wrong; two runs without forces are alike.
                let share = if difference == 0.0 { 0.0 } else { larger(0.0, difference / largest) };
                if share > found.share {
                    found = Difference { share, of, time };
                }
            }
        }
        found
    }
}

/// The larger; NaN counts as infinite.
pub fn larger(a: f64, b: f64) -> f64 {
    if b.is_nan() { f64::INFINITY } else { a.max(b) }
}

/// How accurate a run is.
#[derive(Clone, Debug, PartialEq)]
pub enum Accuracy {
    /// It differs so much from the tight run.
    Error(Difference),
    /// It does, but a tight run from a start moved by `DISPLACEMENT` differs about as much.
    Sensitive {
        /// The difference from the tight run.
        error: Difference,
        /// What the moved start changes, over the largest force.
        moved: f64,
    },
    /// The tight run did not come to its end, for this reason.
    Unknown(String),
}

impl Accuracy {
    /// Judges a run of `scene` by a tight run. `moved` repeats the tight run from a start moved by `DISPLACEMENT`; it
    /// is called only where the error is notable.
    pub fn judge(
        scene: &Scene,
        run: &ForceHistory,
        tight: &ForceHistory,
        moved: impl FnOnce() -> Option<ForceHistory>,
    ) -> Self {
        let error = run.difference(tight, &Axis::ALL);
        if error.share <= NOTABLE * scene.solver.relative_tolerance {
            return Self::Error(error);
        }
        let moved = moved().map_or(0.0, |moved| moved.difference(tight, &Axis::ALL).share);
        let sensitive = moved > divergence(scene).max(OF_ERROR * error.share);
        if sensitive { Self::Sensitive { error, moved } } else { Self::Error(error) }
    }

    /// The difference from the tight run, if there is one.
    pub fn error(&self) -> Option<Difference> {
        match self {
            Self::Error(error) | Self::Sensitive { error, .. } => Some(*error),
            Self::Unknown(_) => None,
        }
    }

    /// What a moved start changes where the motion is sensitive.
    pub fn moved(&self) -> Option<f64> {
        match self {
            Self::Sensitive { moved, .. } => Some(*moved),
            _ => None,
        }
    }

    /// The verdict on a run at this relative tolerance.
    pub fn verdict(&self, tolerance: f64) -> Verdict {
        match self {
            Self::Error(error) => Verdict::from_error(error.share, tolerance),
            Self::Sensitive { .. } => Verdict::Sensitive,
            Self::Unknown(_) => Verdict::Unknown,
        }
    }
}

/// A run at a glance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// An error of at most [`KEPT`] tolerances.
    Kept,
    /// At most [`NOTABLE`].
    Above,
    /// At most [`WRONG`].
    FarAbove,
    /// More.
    Wrong,
    /// Not comparable: a moved start changes about as much.
    Sensitive,
    /// Not comparable: there is no tight run.
    Unknown,
    /// It stopped with an error.
    Stopped,
    /// It needs more than its budget.
    OverBudget,
}

impl Verdict {
    fn from_error(error: f64, tolerance: f64) -> Self {
        match error {
            error if error <= KEPT * tolerance => Self::Kept,
            error if error > WRONG * tolerance || error > WRONG_SHARE || error.is_nan() => Self::Wrong,
            error if error <= NOTABLE * tolerance => Self::Above,
            _ => Self::FarAbove,
        }
    }

    /// The word for it in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kept => "kept",
            Self::Above => "above",
            Self::FarAbove => "far above",
            Self::Wrong => "wrong",
            Self::Sensitive => "sensitive",
            Self::Unknown => "unknown",
            Self::Stopped => "stopped",
            Self::OverBudget => "too expensive",
        }
    }
}

impl From<&RunFailure> for Verdict {
    fn from(failure: &RunFailure) -> Self {
        match failure {
            RunFailure::OverBudget { .. } => Self::OverBudget,
            RunFailure::Stopped(_) => Self::Stopped,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "name = 'a'\nlayer = { masses = 1, spacing = 1.0, mass = 1.0 }\nsurface = { kind = 'flat' }";

    fn history(rows: &[[f64; 2]]) -> ForceHistory {
        ForceHistory { times: (0..rows.len()).map(|i| i as f64).collect(), rows: rows.to_vec() }
    }

    #[test]
    fn a_difference_is_a_share_of_the_largest_force() {
        let wanted = [[0.0, 1.0], [-4.0, 2.0]];
        let between = |rows: &[[f64; 2]], tight: &[[f64; 2]]| history(rows).difference(&history(tight), &Axis::ALL);
        let found = between(&[[0.0, 1.0], [-4.0, 3.0]], &wanted);
        assert_eq!(found, Difference { share: 0.25, of: Axis::Z, time: 1.0 });
        assert_eq!(history(&[[0.0, 1.0], [-4.0, 3.0]]).difference(&history(&wanted), &[Axis::Z]).share, 0.5);
        assert_eq!(between(&wanted, &wanted).share, 0.0);
        assert_eq!(between(&[[0.0; 2]; 2], &[[0.0; 2]; 2]).share, 0.0);
        assert_eq!(between(&[[1.0, 0.0]], &[[0.0; 2]]).share, f64::INFINITY);
        let nowhere = between(&[[f64::NAN, 1.0], wanted[1]], &wanted);
        assert_eq!(nowhere, Difference { share: f64::INFINITY, of: Axis::X, time: 0.0 });
    }

    #[test]
    fn verdicts_follow_the_tolerance() {
        use Verdict::{Above, FarAbove, Kept, Wrong};
        let verdicts = [9e-6, 9e-5, 9e-4, 1e-2, f64::INFINITY, f64::NAN].map(|error| Verdict::from_error(error, 1e-6));
        assert_eq!(verdicts, [Kept, Above, FarAbove, Wrong, Wrong, Wrong]);
        // A loose tolerance asks for little, but not for nothing.
        assert_eq!([0.05, 0.2].map(|error| Verdict::from_error(error, 1e-2)), [Kept, Wrong]);
        assert_eq!([0.05, 0.2].map(|error| Verdict::from_error(error, 3e-3)), [Above, Wrong]);
    }

    #[test]
    fn an_error_is_sensitive_where_a_moved_start_changes_as_much() {
        let scene = Scene::parse(TEXT, "scene.toml".as_ref()).unwrap();
        let judge = |run: f64, moved: f64| {
            let moved = || Some(history(&[[moved, 1.0]]));
            Accuracy::judge(&scene, &history(&[[run, 1.0]]), &history(&[[0.0, 1.0]]), moved)
        };
        let tolerance = scene.solver.relative_tolerance;
        assert_eq!(judge(50.0 * tolerance, 1.0).verdict(tolerance), Verdict::Above);
        assert_eq!(judge(0.5, 0.2).verdict(tolerance), Verdict::Sensitive);
        assert_eq!(judge(0.5, 0.01).verdict(tolerance), Verdict::Wrong);
    }
}
