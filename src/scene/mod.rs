//! What one FMU simulates: a scene, read from one TOML file and checked.
//!
//! Every field is in SI units. A feature that the scene does not name is `None` or empty, and costs nothing at run
//! time.

mod allowed;
mod derived;
mod error;
mod excitation;
mod form;
mod layer;
mod link_kind;
mod material;
mod material_reader;
mod parameters;
mod points;
mod profile;
mod prony_file;
mod reader;
mod self_affine;
mod settings;
mod surface;
mod table;
pub mod text_table;
mod unit;
mod warnings;

#[cfg(test)]
mod tests;

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::math::{Numbers, visit_all};

pub use allowed::{LARGEST, SMALLEST, is_possible};
pub use derived::identifier;
pub use error::{Problem, SceneError};
pub use link_kind::LinkKind;
pub use material::{Material, PronyTerm, Wlf, complex_stiffness};
pub use parameters::{MaterialParameter, Parameter, ParameterError, Value};
pub use profile::{Extract, LengthUnit, Line, Missing, ProfileOptions, ThirdColumn, Tilt, UnknownWord};
pub use unit::Unit;

/// A whole scene, checked. Serialised, it is every number of it: what the scene does not name is null or empty.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scene {
    /// The scene's name; becomes the model's name.
    pub name: String,
    /// What the scene is, in a sentence.
    pub description: Option<String>,
    /// The elastic layer.
    pub layer: Layer,
    /// What the layer is made of, in the material form; `None`: its masses and links are given (direct form).
    pub material: Option<Material>,
    /// The rigid surface below it.
    pub surface: Surface,
    /// Friction in the contacts; `None` is frictionless.
    pub friction: Option<Friction>,
    /// The integrator's settings.
    pub solver: Solver,
    /// How the carrier moves on when a master gives no rates.
    pub extrapolation: Extrapolation,
    /// The output groups, in the order of [`OutputGroup::ALL`], each once.
    pub outputs: Vec<OutputGroup>,
    /// The motion of the carrier in runs without a master.
    pub excitation: Vec<Phase>,
    /// The files that the scene reads and an FMU carries: relative to its folder, as the scene names them; a line of an
    /// areal measurement by the name of its extract.
    #[serde(skip)]
    pub files: Vec<PathBuf>,
    /// The lines of areal measurements among them.
    #[serde(skip)]
    pub extracts: Vec<Extract>,
    /// What is worth telling though the scene is valid.
    #[serde(skip)]
    pub warnings: Vec<String>,
}

/// The elastic layer: k point masses and their links.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Layer {
    /// Number of point masses k ≥ 1.
    pub masses: usize,
    /// Distance Δx of the masses at rest, m.
    pub spacing: f64,
    /// Place X_1 of the first mass at rest, m.
    pub origin: f64,
    /// Height of the layer above the profile's datum at w = 0, m.
    pub clearance: f64,
    /// Mass of one point mass, kg; in the direct form alone, see [`Scene::mass`].
    pub mass: Option<f64>,
    /// Thickness H, m; in the material form alone.
    pub thickness: Option<f64>,
    /// Width B, m; in the material form alone.
    pub width: Option<f64>,
    /// How the dashpots start.
    pub initial: Initial,
    /// Heights h_i of the elastic body's roughness, m: k values, or none for a smooth body.
    pub roughness: Vec<f64>,
    /// Carrier to mass, along z. All four in the direct form alone, see [`Scene::link`].
    pub vertical: Option<Link>,
    /// Carrier to mass, along x.
    pub horizontal: Option<Link>,
    /// Mass to mass, along x.
    pub lateral_x: Option<Link>,
    /// Mass to mass, along z.
    pub lateral_z: Option<Link>,
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
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MaxwellElement {
    /// Stiffness c_j of the spring, N/m.
    pub stiffness: f64,
    /// Relaxation time τ_j = d_j/c_j, s.
    pub relaxation_time: f64,
}

/// How the dashpots stand at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Initial {
    /// y_j = e_j: pressed long ago.
    Relaxed,
    /// y_j = 0: pressed just now.
    Undeformed,
}

/// The data points of the rigid profile; the spline through them is the model's business.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Surface {
    /// Places of the data points, m, strictly rising; at least two.
    pub x: Vec<f64>,
    /// Heights of the data points, m. Periodic: the last equals the first.
    pub z: Vec<f64>,
    /// Repeated for ever, or continued along its end tangents.
    pub periodic: bool,
}

/// The parts of the friction law that the scene names.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Friction {
    /// Coulomb's coefficient μ, 1.
    pub coulomb: Option<f64>,
    /// Adhesive shear force A τ_0 of one mass in contact, N; in the direct form alone, see [`Scene::shear_force`].
    pub shear_force: Option<f64>,
    /// Adhesive shear strength τ_0, Pa; in the material form alone.
    pub shear_strength: Option<f64>,
    /// Rate-dependent shear strength.
    pub rate_shear: Option<RateShear>,
}

/// Shear strength that depends on the speed: A τ_f(v) = A τ_f0 exp(-c [log10(v/v_0)]²) of one mass in contact, held at
/// A τ_f(v_c) below the creep speed v_c.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RateShear {
    /// The largest force A τ_f0, of one mass in contact at the reference speed, N; in the direct form alone, see
    /// [`Scene::rate_shear`].
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

/// The integrator's settings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solver {
    /// How mode changes are treated.
    pub method: Method,
    /// Relative tolerance of the local error, 1.
    pub relative_tolerance: f64,
    /// Absolute tolerance, m; `None` follows the relative tolerance and the scene's height.
    pub absolute_tolerance: Option<f64>,
    /// Steps that one communication step or one phase may take.
    pub max_steps: u64,
    /// Bound on the error of a link's force for leaving Maxwell elements out, as a share of it; 0 leaves none out.
    pub reduce: f64,
}

/// How mode changes are treated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Every mode change is located.
    Event,
    /// Mode changes are put at the ends of the steps.
    Step,
    /// Located where they are few, at the ends of the steps where they crowd.
    Auto,
}

/// How the carrier moves when a master gives values alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Extrapolation {
    /// On, as it came.
    #[default]
    Linear,
    /// To the value given, reached at the end of the step.
    Hold,
}

impl Extrapolation {
    /// The word for it in a scene file.
    pub fn word(self) -> &'static str {
        allowed::EXTRAPOLATION.word(self)
    }

    /// What a word stands for.
    pub fn of_word(word: &str) -> Option<Self> {
        allowed::EXTRAPOLATION.find(word, word).ok()
    }
}

/// The groups of output variables that a scene may ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum OutputGroup {
    /// F_x, F_z.
    Forces,
    /// Dissipated power and energy, whole and by channel.
    Dissipation,
    /// The tangential force split at the surface.
    Friction,
    /// Counts and contact forces.
    Contact,
    /// The energy balance.
    Energy,
    /// Change of the forces with the carrier's targets, for masters that iterate.
    Tangent,
    /// Steps, events, estimated error, processor time.
    Solver,
    /// Place, forces and mode of each mass.
    Elements,
}

impl OutputGroup {
    /// All groups, in the order of the variables.
    pub const ALL: [Self; 8] = [
        Self::Forces,
        Self::Dissipation,
        Self::Friction,
        Self::Contact,
        Self::Energy,
        Self::Tangent,
        Self::Solver,
        Self::Elements,
    ];

    /// The group's name in a scene file.
    pub fn name(self) -> &'static str {
        allowed::OUTPUTS.word(self)
    }
}

impl Scene {
    /// How long the excitation takes if no force ends a phase, s.
    pub fn duration(&self) -> f64 {
        self.excitation.iter().map(|phase| phase.duration).sum()
    }
}

/// One phase of the carrier's motion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Phase {
    /// Duration, s.
    pub duration: f64,
    /// Motion along x from the phase's start on.
    pub u: Path,
    /// Motion along z from the phase's start on.
    pub w: Path,
    /// The phase ends when F_z rises to this force, N; in the direct form alone, see [`Phase::end_force`].
    pub until_force: Option<f64>,
    /// The phase ends when F_z over the layer's area rises to this pressure, Pa; in the material form alone.
    pub until_pressure: Option<f64>,
}

/// A displacement from where it stood: rate · s + amplitude · sin(2π frequency s), s the time since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Path {
    /// Constant rate, m/s.
    pub rate: f64,
    /// Amplitude of the sine, m.
    pub amplitude: f64,
    /// Frequency of the sine, Hz.
    pub frequency: f64,
}

impl Numbers for Path {
    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        let Self { rate, amplitude, frequency } = self;
        visit_all([rate, amplitude, frequency], visit);
    }
}
