//! What gives friction at values of the free parameters.

use super::error::{ModelError, NoSliding};
use asperity::element::OperatingPoint;
use asperity::scene::Scene;

/// A point at values of the free parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    /// The values, in the order of the parameters.
    pub parameters: Vec<f64>,
    /// Speed, pressure (Pa), temperature.
    pub point: OperatingPoint,
}

/// A friction coefficient and what it rests on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionParts {
    /// By the slopes of the profile, 1.
    pub profile: f64,
    /// By the waves that the profile lacks, 1.
    pub fine: f64,
    /// By what acts in the contacts else: Coulomb's friction and shear, 1.
    pub shear: f64,
    /// The area that touches over the nominal one, 1: with the roughness below the profile where the scene has it, but by
    /// the theory.
    pub area: f64,
}

impl FrictionParts {
    /// The friction coefficient.
    pub fn friction(&self) -> f64 {
        self.profile + self.fine + self.shear
    }
}

/// Friction at a point, or why there is no steady sliding.
pub type Outcome = Result<FrictionParts, NoSliding>;

/// What is done with the outcome of a task, by its index, as soon as it is there; from any thread.
pub type Done<'a> = dyn Fn(usize, Outcome) -> Result<(), ModelError> + Sync + 'a;

/// Friction over the free parameters.
pub trait FrictionModel: Sync {
    /// Finds the outcome of all tasks, in any order and on all cores.
    ///
    /// # Errors
    /// Where the scene is not possible at the values, or `done` fails.
    fn evaluate(&self, tasks: &[Task], done: &Done<'_>) -> Result<(), ModelError>;

    /// The step of finite differences, over the distance of the bounds: small against what friction bends over, large
    /// against its errors.
    fn step(&self) -> f64;
}

/// The scene at values of the free parameters, or why there is none.
pub type SceneAt<'a> = dyn Fn(&[f64]) -> Result<Scene, ModelError> + Sync + 'a;

/// The tasks by their parameters and temperatures: the indices of those that have both alike.
pub(super) fn groups(tasks: &[Task]) -> Vec<(Vec<f64>, Option<f64>, Vec<usize>)> {
    let mut groups: Vec<(Vec<f64>, Option<f64>, Vec<usize>)> = Vec::new();
    for (index, task) in tasks.iter().enumerate() {
        let is_alike = |group: &&mut (Vec<f64>, _, _)| group.0 == task.parameters && group.1 == task.point.temperature;
        match groups.iter_mut().find(is_alike) {
            Some(group) => group.2.push(index),
            None => groups.push((task.parameters.clone(), task.point.temperature, vec![index])),
        }
    }
    groups
}
