//! The material in a description, and what follows from it.

use asperity::scene::{Friction, Layer, Material, Phase, Scene, Wlf};
use serde::Serialize;

use super::{Row, number, or_left_out, under};

/// The rows on the material; none in the direct form, whose links say all.
pub(super) fn rows(scene: &Scene) -> Vec<Row> {
    let Some(material) = &scene.material else { return Vec::new() };
    let texts = [body(scene, material), series(material), temperature(material)];
    under("Material", texts)
}

fn body(scene: &Scene, material: &Material) -> String {
    let size = |value: Option<f64>| number(value.unwrap_or(0.0));
    format!(
        "{} m thick, {} m wide, density {} kg/m³, Poisson's ratio {}",
        size(scene.layer.thickness),
        size(scene.layer.width),
        number(material.density),
        number(material.poisson_ratio)
    )
}

fn series(material: &Material) -> String {
    let glassy: f64 = material.prony.iter().map(|term| term.modulus).sum();
    format!(
        "E_∞ {} Pa, viscosity {}, {} Prony terms, glassy modulus {:.4e} Pa",
        number(material.equilibrium_modulus),
        or_left_out(material.viscosity, " Pa s"),
        material.prony.len(),
        material.equilibrium_modulus + glassy
    )
}

fn temperature(material: &Material) -> String {
    let shift = |wlf: Wlf| {
        format!(
            "{} K, times given at {} K: a_T = {:.4e} (C_1 {}, C_2 {} K)",
            number(wlf.temperature),
            number(wlf.reference_temperature),
            wlf.shift_factor(),
            number(wlf.c1),
            number(wlf.c2)
        )
    };
    material.wlf.map_or_else(|| "temperature left out: times as given".into(), shift)
}

/// A scene for other programs: as it was read and, in the material form, with the constants that follow from it where
/// the direct form has them.
#[derive(Debug, Serialize)]
pub(super) struct Described {
    #[serde(flatten)]
    scene: Scene,
    /// a_T, 1; null in the direct form.
    shift_factor: Option<f64>,
}

impl Described {
    pub(super) fn new(given: &Scene) -> Self {
        let direct = given.direct_form();
        let (thickness, width) = (given.layer.thickness, given.layer.width);
        let shear_strength = given.friction.as_ref().and_then(|friction| friction.shear_strength);
        let phases = direct.excitation.into_iter().zip(&given.excitation);
        let scene = Scene {
            material: given.material.clone(),
            layer: Layer { thickness, width, ..direct.layer },
            friction: direct.friction.map(|friction| Friction { shear_strength, ..friction }),
            excitation: phases.map(|(phase, given)| Phase { until_pressure: given.until_pressure, ..phase }).collect(),
            ..direct
        };
        Self { scene, shift_factor: given.material.as_ref().map(Material::shift_factor) }
    }
}
