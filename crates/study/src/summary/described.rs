//! What `describe` says of a scene and of a patch; a scene with all constants that follow from it, as JSON.

use std::sync::Arc;

use asperity::patch::Patch;
use asperity::scene::{Friction, Layer, Material, Phase, Scene};
use asperity::simulation::{Simulation, SimulationError};
use asperity_fmi::FmuModel;
use serde::Serialize;

use super::patch::patch_rows;
use super::scene::{scene_rows, short_scene_rows};
use super::{LabelledLine, labelled};
use crate::runner::start;

/// The summary of a scene, with how its tables were read and the memory of its FMU.
///
/// # Errors
/// Where no run can start with it.
pub fn described(scene: &Scene) -> Result<Vec<LabelledLine>, SimulationError> {
    Simulation::new(scene, &start(scene, 0.0))?;
    let bytes = FmuModel::memory(&Arc::new(scene.clone()));
    let memory = ("Memory", format!("at most {} MiB an instance of the FMU", bytes.div_ceil(1 << 20)));
    let tables = labelled("Tables", scene.notes.iter().map(|read| read.text.clone()));
    Ok([vec![title(scene)], scene_rows(scene), tables, vec![memory]].concat())
}

/// The same on one screen: what it is, what is computed and left out, and what was assumed of its tables.
///
/// # Errors
/// As for [`described`].
pub fn described_shortly(scene: &Scene) -> Result<Vec<LabelledLine>, SimulationError> {
    Simulation::new(scene, &start(scene, 0.0))?;
    let assumed = scene.notes.iter().filter(|read| read.assumed).map(|read| read.text.clone());
    Ok([vec![title(scene)], short_scene_rows(scene), labelled("Tables", assumed)].concat())
}

fn title(scene: &Scene) -> LabelledLine {
    let text = scene.description.as_ref().map_or_else(|| scene.name.clone(), |text| format!("{}: {text}", scene.name));
    ("Scene", text)
}

/// The summary of a patch.
pub fn described_patch(patch: &Patch) -> Vec<LabelledLine> {
    [vec![("Name", patch.name().to_owned())], patch_rows(patch)].concat()
}

/// A scene as JSON has it: as read, plus, in the material form, the constants that the direct form would give.
#[derive(Debug, Serialize)]
pub struct DescribedScene {
    #[serde(flatten)]
    scene: Scene,
    /// a_T, 1; null in the direct form.
    shift_factor: Option<f64>,
}

impl DescribedScene {
    /// Of the scene as given.
    pub fn new(given: &Scene) -> Self {
        let direct = given.direct_form();
        let (thickness, width) = (given.layer.thickness, given.layer.width);
        let shear_strength = given.friction.as_ref().and_then(|friction| friction.shear_strength);
        let phases = direct.excitation.into_iter().zip(&given.excitation);
        let scene = Scene {
            material: given.material.clone(),
            foundation: given.foundation.clone(),
            layer: Layer { thickness, width, foundation: given.layer.foundation, ..direct.layer },
            friction: direct.friction.map(|friction| Friction { shear_strength, ..friction }),
            excitation: phases.map(|(phase, given)| Phase { until_pressure: given.until_pressure, ..phase }).collect(),
            ..direct
        };
        Self { scene, shift_factor: given.material.as_ref().map(Material::shift_factor) }
    }
}
