//! Tight runs, by which others are judged, and what they may take.

use asperity::scene::{Method, Scene};
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
