//! Friction of the layer that slides until it is steady: the expensive model of scenes that cannot be solved for.

use asperity::element::Load;
use rayon::prelude::*;

use super::error::{ModelError, NoSliding};
use super::model::{Done, FrictionModel, FrictionParts, SceneAt, Task};
use crate::sweep::{StopBounds, steady_sliding};

/// The layer over the free parameters.
pub(super) struct LayerModel<'a> {
    pub(super) scene_at: &'a SceneAt<'a>,
    /// The area of the layer, m².
    pub(super) area: f64,
    pub(super) bounds: StopBounds,
}

/// Friction is known to some 0.5 %: a step of this part of the bounds changes it by more.
const STEP: f64 = 0.03;

impl std::fmt::Debug for LayerModel<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LayerModel").field("bounds", &self.bounds).finish_non_exhaustive()
    }
}

impl FrictionModel for LayerModel<'_> {
    fn evaluate(&self, tasks: &[Task], done: &Done<'_>) -> Result<(), ModelError> {
        tasks.par_iter().with_max_len(1).enumerate().try_for_each(|(index, task)| {
            let scene = (self.scene_at)(&task.parameters)?;
            let found = steady_sliding(&scene, &task.point, Load::Pressure { area: self.area }, self.bounds);
            let parts = found.map(|sliding| FrictionParts {
                profile: sliding.hysteresis() - sliding.fine(),
                fine: sliding.fine(),
                shear: sliding.friction() - sliding.hysteresis(),
                area: sliding.real_area.unwrap_or(sliding.contact_ratio),
            });
            done(index, parts.map_err(NoSliding::new))
        })
    }

    fn step(&self) -> f64 {
        STEP
    }
}
