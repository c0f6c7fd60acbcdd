//! Laws of friction, whose tables are made once: most parameters, and the temperature, leave those as they are.

use std::sync::{Mutex, PoisonError};

use asperity::model::{FineFriction, FrictionLaw};
use asperity::scene::{FineBand, FineRoughness, Material, Scene};

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
