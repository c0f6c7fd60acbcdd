//! What gives friction at values of the free parameters.
//!
//! A model that remembers what it found.
//!
//! Friction by steady sliding, solved as such.
//!
//! Friction of the layer that slides until it is steady: the expensive model of scenes that cannot be solved for.
//!
//! Friction by Persson's theory: what a fit begins with.
//!
//! The waves of the profile touch on the part P of the surface and lose what the theory says
//! ([`ProfileWaves`]). On that part the law of the contacts acts at their mean pressure p/P, at the scene's temperature:
//! heat is none of the theory's.
//!
//! Laws of friction, whose tables are made once: most parameters, and the temperature, leave those as they are.

use std::collections::HashMap;
use std::fmt::{self, Debug, Formatter};
use std::ops::ControlFlow;
use std::sync::{Mutex, MutexGuard, PoisonError};

use asperity::element::{Load, OperatingPoint};
use asperity::model::{FineFriction, FrictionLaw, SlipHistory};
use asperity::scene::{ElasticBody, FineBand, FineRoughness, Material, Scene, Surface};
use rayon::prelude::*;

use crate::error::Error;
use crate::progress::Stopped;
use crate::steady::persson::{ProfileWaves, Theory};
use crate::steady::{SlidingRubber, SteadySlide, SteadySolver, SurfaceGrid};
use crate::sweep::{StopBounds, steady_sliding};

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

/// Why there is no steady sliding at a point, as tables of points have it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NoSliding(String);

impl NoSliding {
    /// For this reason.
    pub fn new(reason: impl ToString) -> Self {
        Self(reason.to_string())
    }

    /// The reason.
    pub fn reason(&self) -> &str {
        &self.0
    }
}

/// Why a model is not fitted.
#[derive(Clone, Debug, thiserror::Error)]
pub enum ModelError {
    /// It has no friction at some values of the parameters, or the least squares cannot go on.
    #[error(transparent)]
    Failed(#[from] Error),
    /// Points of the measurements that cannot be simulated at the parameters tried.
    #[error("{} points cannot be simulated", .0.len())]
    NotSteady(Vec<(OperatingPoint, NoSliding)>),
    /// No measurement is left.
    #[error(
        "{rows} measurements can be simulated, fewer than the {parameters} free parameters{}",
        .left_out.as_ref().map_or_else(String::new, |left_out| format!("; {left_out}"))
    )]
    TooFew {
        /// How many there are.
        rows: usize,
        /// The free parameters.
        parameters: usize,
        /// Which others there are, and why they cannot.
        left_out: Option<String>,
    },
}

impl From<ModelError> for Error {
    fn from(error: ModelError) -> Self {
        match error {
            ModelError::Failed(error) => error,
            error => Self::value(error),
        }
    }
}

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
pub type SceneAt<'a> = dyn Fn(&[f64]) -> Result<Scene, Error> + Sync + 'a;

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

/// What is done with an outcome that was not known before, from any thread; says whether to go on.
pub type NewOutcome<'a> = dyn Fn(&Task, &Outcome) -> ControlFlow<()> + Sync + 'a;

/// The bits of a task.
type Key = (Vec<u64>, [u64; 4]);

/// A model that finds nothing twice; what was found elsewhere can be given to it.
pub struct Memo<'a> {
    model: &'a dyn FrictionModel,
    new: &'a NewOutcome<'a>,
    known: Mutex<HashMap<Key, Outcome>>,
}

impl<'a> Memo<'a> {
    /// A model, what is known of it, and what is done with what is new.
    pub fn new(
        model: &'a dyn FrictionModel,
        known: impl IntoIterator<Item = (Task, Outcome)>,
        new: &'a NewOutcome<'a>,
    ) -> Self {
        let known = known.into_iter().map(|(task, outcome)| (key(&task), outcome)).collect();
        Self { model, new, known: Mutex::new(known) }
    }

    fn known(&self) -> MutexGuard<'_, HashMap<Key, Outcome>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn key(task: &Task) -> Key {
    let OperatingPoint { speed, load, temperature, way } = task.point;
    let point = [speed, load, temperature.unwrap_or(f64::NAN), way.unwrap_or(f64::NAN)];
    (task.parameters.iter().map(|value| value.to_bits()).collect(), point.map(f64::to_bits))
}

impl FrictionModel for Memo<'_> {
    fn evaluate(&self, tasks: &[Task], done: &Done<'_>) -> Result<(), ModelError> {
        // Of the same tasks one is found.
        let mut missing: Vec<usize> = Vec::new();
        let mut asked = std::collections::HashSet::new();
        for (index, task) in tasks.iter().enumerate() {
            let key = key(task);
            if !self.known().contains_key(&key) && asked.insert(key) {
                missing.push(index);
            }
        }
        let wanted: Vec<Task> = missing.iter().map(|&index| tasks[index].clone()).collect();
        self.model.evaluate(&wanted, &|index, outcome| {
            if (self.new)(&wanted[index], &outcome).is_break() {
                return Err(Error::from(Stopped).into());
            }
            self.known().insert(key(&wanted[index]), outcome);
            Ok(())
        })?;
        tasks.iter().enumerate().try_for_each(|(index, task)| {
            let found = self.known().get(&key(task)).cloned();
            let outcome = found.unwrap_or_else(|| Err(NoSliding::new("the model gave no friction")));
            done(index, outcome)
        })
    }

    fn step(&self) -> f64 {
        self.model.step()
    }
}

impl Debug for Memo<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Memo").field("known", &self.known().len()).finish_non_exhaustive()
    }
}

/// The grid that a scene is solved on, or why it cannot be.
pub type GridOf<'a> = dyn Fn(&Scene) -> Result<SurfaceGrid, Error> + Sync + 'a;

/// The error of a scene that a model knows nothing of.
fn needs_material(model: &str) -> Error {
    Error::value(format!("{model} takes a scene in the material form, with layer.width"))
}

/// Steady sliding over the free parameters.
pub struct SteadyModel<'a> {
    scene_at: &'a SceneAt<'a>,
    grid_of: &'a GridOf<'a>,
    laws: KnownLaws,
}

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
            let rubber = SlidingRubber::with_friction(&scene, self.laws.law(&scene))
                .ok_or_else(|| needs_material("steady sliding"))?;
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
        // Friction is known to some 1e-6, with heat to 1e-5, and bends over a tenth of the bounds.
        1e-3
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

/// The layer over the free parameters.
pub(super) struct LayerModel<'a> {
    pub(super) scene_at: &'a SceneAt<'a>,
    /// The area of the layer, m².
    pub(super) area: f64,
    pub(super) bounds: StopBounds,
}

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
        // Friction is known to some 0.5 %: a step of this part of the bounds changes it by more.
        0.03
    }
}

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

/// Profiles that are remembered: more than a table has temperatures.
const MOST_PROFILES: usize = 64;

impl<'a> TheoryModel<'a> {
    /// The theory of the scenes; of one in the direct form every task fails.
    pub fn new(scene_at: &'a SceneAt<'a>) -> Self {
        Self { scene_at, profiles: Mutex::new(Vec::new()), laws: KnownLaws::default() }
    }

    /// Friction at some points of a scene.
    fn friction(&self, scene: &Scene, points: &[OperatingPoint]) -> Result<Vec<FrictionParts>, ModelError> {
        let area = scene.layer.element_area().ok_or_else(|| needs_material("Persson's theory"))?;
        let theories = self.theories(scene, points).ok_or_else(|| needs_material("Persson's theory"))?;
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
        // Friction is known to all digits: differences are good to some six.
        1e-6
    }
}

impl Debug for TheoryModel<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("TheoryModel").finish_non_exhaustive()
    }
}

/// What the tables of the roughness below the profile depend on.
#[derive(Clone, Debug, PartialEq)]
struct Cause {
    fine: FineRoughness,
    bands: Vec<FineBand>,
    /// At the reference temperature, without heat.
    material: Material,
    element_area: Option<f64>,
    creep_speed: f64,
}

/// The laws met last.
#[derive(Debug, Default)]
pub(super) struct KnownLaws {
    known: Mutex<Vec<(Cause, Option<FineFriction>)>>,
}

/// Tables that are remembered: more than there are parameters.
const MOST: usize = 32;

impl KnownLaws {
    /// The law of a scene, the same bits as [`FrictionLaw::new`] has.
    pub(super) fn law(&self, scene: &Scene) -> FrictionLaw {
        let (Some(fine), Some(material)) = (&scene.fine, &scene.material) else { return FrictionLaw::new(scene) };
        let mut at_reference = Material { heat: None, ..material.clone() };
        if let Some(wlf) = &mut at_reference.wlf {
            wlf.temperature = wlf.reference_temperature;
        }
        let creep_speed = scene.fine_creep_speed();
        let cause = Cause {
            fine: fine.clone(),
            bands: scene.fine_bands(),
            material: at_reference,
            element_area: scene.layer.element_area(),
            creep_speed,
        };
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known().iter().find(|(other, _)| *other == cause).map(|(_, found)| found.clone());
        let law = found.unwrap_or_else(|| {
            let law = FineFriction::new(scene);
            let mut known = known();
            known.truncate(MOST - 1);
            known.insert(0, (cause, law.clone()));
            law
        });
        FrictionLaw::with_fine(scene, law.map(|law| law.at_temperature_of(material, creep_speed)))
    }
}
