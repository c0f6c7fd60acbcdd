//! The elastic layer, its links and the friction of its masses, as a scene gives them.

use serde::Serialize;

use super::axis::by_name;
use super::values::Word;
use super::{ByLink, SMALLEST};

/// The elastic layer: k point masses and their links.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Layer {
    /// Number of point masses k ≥ 1.
    pub masses: usize,
    /// Distance Δx of the masses at rest, m.
    pub spacing: f64,
    /// Position X_1 of the first mass at rest, m.
    pub origin: f64,
    /// Height of the layer above the profile's datum at w = 0, m.
    pub clearance: f64,
    /// Mass of one point mass, kg; in the direct form alone, see [`Scene::mass`](crate::scene::Scene::mass).
    pub mass: Option<f64>,
    /// How the links follow from the material; in the material form alone.
    pub foundation: Option<FoundationKind>,
    /// By what spacing the links along z are measured; `None` see [`Layer::kinematics`].
    pub kinematics: Option<Kinematics>,
    /// Thickness H, m; in the material form alone, and not of a half-space.
    pub thickness: Option<f64>,
    /// Width B, m; in the material form alone.
    pub width: Option<f64>,
    /// How the dashpots start.
    pub initial: Initial,
    /// Heights h_i of the elastic body's roughness, m: k values, or none for a smooth body.
    pub roughness: Vec<f64>,
    /// The links; in the direct form alone, see [`Scene::link`](crate::scene::Scene::link).
    #[serde(flatten, serialize_with = "by_name")]
    pub links: ByLink<Option<Link>>,
}

impl Layer {
    /// Position X_i of mass `i` (from 0) at rest, m.
    pub fn rest_position(&self, i: usize) -> f64 {
        self.origin + i as f64 * self.spacing
    }

    /// By what spacing the links along z are measured: as it was set, or the present one where they stand for a half-space,
    /// for which it is derived.
    pub fn kinematics(&self) -> Kinematics {
        let of_half_space = self.foundation == Some(FoundationKind::HalfSpace);
        self.kinematics.unwrap_or(if of_half_space { Kinematics::Spatial } else { Kinematics::Material })
    }
}

/// A spring, a damper and Maxwell elements in parallel. A key that the scene does not name is `None`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Link {
    /// Stiffness c of the spring, N/m.
    pub stiffness: Option<f64>,
    /// Damping d, N s/m.
    pub damping: Option<f64>,
    /// The Maxwell elements (c_j, τ_j).
    pub maxwell: Vec<MaxwellElement>,
}

/// A spring in series with a dashpot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct MaxwellElement {
    /// Stiffness c_j of the spring, N/m.
    pub stiffness: f64,
    /// Relaxation time τ_j = d_j/c_j, s.
    pub relaxation_time: f64,
}

/// How the dashpots stand at the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Initial {
    /// y_j = e_j: the layer was deformed long ago.
    #[default]
    Relaxed,
    /// y_j = 0: the layer was deformed just now.
    Undeformed,
}

impl Word for Initial {
    const WORDS: &'static [(&'static str, Self)] = &[("relaxed", Self::Relaxed), ("undeformed", Self::Undeformed)];
}

/// The parts of the friction law that the scene names.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Friction {
    /// Coulomb's coefficient μ, 1.
    pub coulomb: Option<f64>,
    /// Adhesive shear force A τ_0 of one mass in contact, N; in the direct form alone, see [`Scene::shear_force`](crate::scene::Scene::shear_force).
    pub shear_force: Option<f64>,
    /// Adhesive shear strength τ_0, Pa; in the material form alone.
    pub shear_strength: Option<f64>,
    /// Rate-dependent shear strength.
    pub rate_shear: Option<RateShear>,
    /// The way D over which contacts are renewed, m, 0: at once; `None` see [`Scene::memory_way`](crate::scene::Scene::memory_way).
    pub memory: Option<f64>,
}

/// Shear strength that depends on the speed: A τ_f(v) = A τ_f0 exp(-c [log10(v/v_0)]²) of one mass in contact, constant
/// at A τ_f(v_c) below the creep speed v_c.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RateShear {
    /// The largest force A τ_f0, of one mass in contact at the reference speed, N; in the direct form alone, see
    /// [`Scene::rate_shear`](crate::scene::Scene::rate_shear).
    pub force: Option<f64>,
    /// The largest shear strength τ_f0, Pa; in the material form alone.
    pub strength: Option<f64>,
    /// Reference speed v_0, m/s.
    pub reference_speed: f64,
    /// Sharpness c, 1.
    pub sharpness: f64,
    /// Creep speed v_c, m/s; `None` follows the reference speed.
    pub creep_speed: Option<f64>,
}

/// The creep speed over the reference speed where the scene does not give it.
const CREEP: f64 = 1e-6;

impl RateShear {
    /// The creep speed, m/s: as it was set, or a millionth of the reference speed, but at least [`SMALLEST`].
    pub fn creep_speed(&self) -> f64 {
        self.creep_speed.unwrap_or_else(|| (CREEP * self.reference_speed).max(SMALLEST))
    }
}

/// How the links follow from the material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FoundationKind {
    /// By the layer's thickness and the spacing alone (docs/model.md, section 7): off by factors but near one wavelength.
    Springs,
    /// Fitted to a half-space.
    HalfSpace,
    /// Fitted to a layer of a thickness, bonded to a rigid base.
    #[default]
    Layer,
}

impl Word for FoundationKind {
    const WORDS: &'static [(&'static str, Self)] =
        &[("springs", Self::Springs), ("half_space", Self::HalfSpace), ("layer", Self::Layer)];
}

/// By what spacing of the masses the links along z are measured (docs/foundation.md, section 8).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kinematics {
    /// That at rest: links are linear in material coordinates.
    Material,
    /// The present one.
    Spatial,
}

impl Word for Kinematics {
    const WORDS: &'static [(&'static str, Self)] = &[("material", Self::Material), ("spatial", Self::Spatial)];
}

impl FoundationKind {
    /// The word for it in a scene file.
    pub fn word(self) -> &'static str {
        self.as_word()
    }
}
