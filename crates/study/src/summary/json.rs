//! A scene with all constants that follow from it.

use asperity::scene::{Friction, Layer, Material, Phase, Scene};
use serde::Serialize;

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
