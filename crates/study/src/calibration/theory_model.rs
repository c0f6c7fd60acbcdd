//! Friction by Persson's theory: what a fit begins with.
//!
//! The waves of the profile touch on the part P of the surface and lose what the theory says
//! ([`ProfileWaves`]). On that part the law of the contacts acts at their mean pressure p/P, at the scene's temperature:
//! heat is none of the theory's.

use std::fmt::{self, Debug, Formatter};
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::error::ModelError;
use super::known_laws::KnownLaws;
use super::model::{Done, FrictionModel, FrictionParts, SceneAt, Task, groups};
use crate::steady::persson::{ProfileWaves, Theory};
use asperity::element::OperatingPoint;
use asperity::model::SlipHistory;
use asperity::scene::{ElasticBody, Material, Scene, Surface};

/// The theory over the free parameters.
pub struct TheoryModel<'a> {
    scene_at: &'a SceneAt<'a>,
    /// What was found of the profiles met last, one for each temperature: most parameters leave them as they are.
    profiles: Mutex<Vec<KnownProfile>>,
    laws: KnownLaws,
}

/// What the waves of a profile do in a rubber.
#[derive(Clone, Debug)]
struct KnownProfile {
    surface: Surface,
    material: Material,
    body: ElasticBody,
    waves: ProfileWaves,
    found: Vec<(OperatingPoint, Theory)>,
}

/// Friction is known to all digits: differences are good to some six.
const STEP: f64 = 1e-6;
/// Profiles that are remembered: more than a table has temperatures.
const MOST_PROFILES: usize = 64;

impl<'a> TheoryModel<'a> {
    /// The theory of the scenes; of one in the direct form every task fails.
    pub fn new(scene_at: &'a SceneAt<'a>) -> Self {
        Self { scene_at, profiles: Mutex::new(Vec::new()), laws: KnownLaws::default() }
    }

    /// Friction at some points of a scene.
    fn friction(&self, scene: &Scene, points: &[OperatingPoint]) -> Result<Vec<FrictionParts>, ModelError> {
        let area = scene.layer.element_area().ok_or(ModelError::NoTheory)?;
        let theories = self.theories(scene, points).ok_or(ModelError::NoTheory)?;
        let law = self.laws.law(scene);
        let parts = |(point, theory): (&OperatingPoint, Theory)| {
            let normal = point.load / theory.area * area;
            let slip = law.slip(normal, point.speed, &SlipHistory::even(0.0));
            let coefficient = |force: f64| force / normal;
            let (fine, all) = (coefficient(slip.hysteresis), coefficient(slip.force()));
            FrictionParts { profile: theory.friction, fine, shear: all - fine, area: theory.area }
        };
        Ok(points.iter().zip(theories).map(parts).collect())
    }

    /// What the profile does at some points.
    fn theories(&self, scene: &Scene, points: &[OperatingPoint]) -> Option<Vec<Theory>> {
        let mut material = scene.material.clone()?;
        material.heat = None;
        let body = scene.layer.body(&material)?;
        let is_it =
            |known: &KnownProfile| known.body == body && known.material == material && known.surface == scene.surface;
        let mut known = {
            let mut profiles = self.profiles.lock().unwrap_or_else(PoisonError::into_inner);
            match profiles.iter().position(is_it) {
                Some(index) => profiles.remove(index),
                None => KnownProfile {
                    waves: ProfileWaves::new(&scene.surface),
                    surface: scene.surface.clone(),
                    material,
                    body,
                    found: Vec::new(),
                },
            }
        };
        let theories = points.iter().map(|point| known.at(point)).collect();
        let mut profiles = self.profiles.lock().unwrap_or_else(PoisonError::into_inner);
        profiles.truncate(MOST_PROFILES);
        profiles.insert(0, known);
        Some(theories)
    }
}

impl KnownProfile {
    fn at(&mut self, point: &OperatingPoint) -> Theory {
        if let Some((_, theory)) = self.found.iter().find(|(found, _)| found == point) {
            return *theory;
        }
        let theory = self.waves.sliding(&self.material, self.body, point.speed, point.load);
        self.found.push((*point, theory));
        theory
    }
}

impl FrictionModel for TheoryModel<'_> {
    fn evaluate(&self, tasks: &[Task], done: &Done<'_>) -> Result<(), ModelError> {
        groups(tasks).into_par_iter().try_for_each(|(parameters, temperature, indices)| {
            let scene = (self.scene_at)(&parameters)?.with_temperature(temperature);
            let points: Vec<OperatingPoint> = indices.iter().map(|&index| tasks[index].point).collect();
            let found = self.friction(&scene, &points)?;
            indices.iter().zip(found).try_for_each(|(&index, parts)| done(index, Ok(parts)))
        })
    }

    fn step(&self) -> f64 {
        STEP
    }
}

impl Debug for TheoryModel<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("TheoryModel").finish_non_exhaustive()
    }
}
