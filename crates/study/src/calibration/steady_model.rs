//! Friction by steady sliding, solved as such.

use std::fmt::{self, Debug, Formatter};

use rayon::prelude::*;

use super::error::{ModelError, NoSliding};
use super::known_laws::KnownLaws;
use super::model::{Done, FrictionModel, FrictionParts, Outcome, SceneAt, Task, groups};
use crate::steady::{SlidingRubber, SteadySlide, SteadySolver, SurfaceGrid};
use asperity::scene::Scene;

/// The grid that a scene is solved on, or why it cannot be.
pub type GridOf<'a> = dyn Fn(&Scene) -> Result<SurfaceGrid, ModelError> + Sync + 'a;

/// Steady sliding over the free parameters.
pub struct SteadyModel<'a> {
    scene_at: &'a SceneAt<'a>,
    grid_of: &'a GridOf<'a>,
    laws: KnownLaws,
}

/// Friction is known to some 1e-6, with heat to 1e-5, and bends over a tenth of the bounds.
const STEP: f64 = 1e-3;

impl<'a> SteadyModel<'a> {
    /// The solver on the grids of the scenes.
    pub fn new(scene_at: &'a SceneAt<'a>, grid_of: &'a GridOf<'a>) -> Self {
        Self { scene_at, grid_of, laws: KnownLaws::default() }
    }
}

impl FrictionModel for SteadyModel<'_> {
    fn evaluate(&self, tasks: &[Task], done: &Done<'_>) -> Result<(), ModelError> {
        let groups = groups(tasks);
        let prepared = groups.into_par_iter().map(|(parameters, temperature, indices)| {
            let scene = (self.scene_at)(&parameters)?.with_temperature(temperature);
            let grid = (self.grid_of)(&scene)?;
            let rubber = SlidingRubber::with_friction(&scene, self.laws.law(&scene)).ok_or(ModelError::NotSolvable)?;
            Ok((rubber, grid, indices))
        });
        let prepared: Vec<_> = prepared.collect::<Result<_, ModelError>>()?;
        let points =
            prepared.iter().flat_map(|(rubber, grid, indices)| indices.iter().map(move |i| (rubber, grid, *i)));
        let points: Vec<_> = points.collect();
        // What a solver finds does not depend on what it found before.
        points.par_iter().with_max_len(1).try_for_each_init(
            || None::<SteadySolver>,
            |solver, &(rubber, grid, index)| {
                let point = tasks[index].point;
                let solver = match solver {
                    Some(solver) if solver.surface() == grid => solver,
                    other => other.insert(SteadySolver::new(grid.clone())),
                };
                done(index, outcome(&solver.slide_over(rubber, point.speed, point.load, point.way)))
            },
        )
    }

    fn step(&self) -> f64 {
        STEP
    }
}

/// Full contact has friction; only elements have no use for it.
fn outcome(slide: &SteadySlide) -> Outcome {
    match slide.problem() {
        Some(problem) if !problem.is_result() => Err(NoSliding::new(problem)),
        _ => Ok(FrictionParts {
            profile: slide.profile_hysteresis,
            fine: slide.fine_hysteresis.unwrap_or(0.0),
            shear: slide.adhesion.unwrap_or(0.0),
            area: slide.real_area.unwrap_or(slide.area),
        }),
    }
}

impl Debug for SteadyModel<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("SteadyModel").finish_non_exhaustive()
    }
}
