//! What one FMU simulates: a scene, read from one TOML file and checked.
//!
//! Every field is in SI units. A feature that the scene does not name is `None` or empty, and costs nothing at run
//! time.
//!
//! A new key is a row in the table of `keys`, which also reads it and makes it a parameter, and a field of the data
//! below.

mod axis;
mod carrier;
mod error;
mod excitation;
mod fine_roughness;
mod fmu;
mod foundation;
mod height_map;
mod keys;
mod link_kind;
mod material;
mod motion_file;
mod parameters;
mod patch_file;
mod profile;
mod prony_file;
mod reader;
mod regular_file;
mod seam;
mod self_affine;
mod spectrum;
mod surface;
mod uncertainty;
mod values;
mod warnings;

#[cfg(test)]
mod tests;

use std::io;
use std::path::{Path as FilePath, PathBuf};

use serde::Serialize;

use crate::tables::ReadingNote;
use fine_roughness::Convention;
use values::Word;

pub use crate::tables::{LARGEST, SMALLEST};
pub use axis::{Axis, ByAxis};
pub use carrier::{CarrierBodies, CarrierBody, CarrierInitial, Input};
pub use error::{ParameterError, Problem, SceneError, did_you_mean};
pub use excitation::{Force, Motion, Path, Phase};
pub use fine_roughness::{
    FineBand, FineRoughness, FineWaves, ModulusFactors, RoughnessSpectrum, Softening, SofteningRow, SplitError,
    SplitSurface, WaveModuli,
};
pub use fmu::{DependencyList, FmuOptions, IntegerType};
pub use foundation::{ElasticBody, Foundation, FoundationKind, Quality, Stiffness, Wave, Waves};
pub use height_map::{HeightMap, MOST_HEIGHTS, MapError};
pub use keys::{Absent, KeyEntry, patch_keys, scene_keys, similar_keys};
pub use link_kind::{ByLink, LinkKind};
pub use material::{Heat, Material, PronyTerm, Wlf, complex_stiffness};
pub use parameters::Parameter;
pub use patch_file::{Backing, FaceHeat, FaceShape, Grid, NotDoubled, PatchFile, PatchGroup, TableExtrapolation};
pub use profile::{
    Areal, Depth, Extract, FileFormats, LengthUnit, LoadedProfile, MeasuredPoints, MeasuredSurface, Missing,
    ProfileOptions, TextAlone, ThirdColumn, Tilt, UnknownWord, line_note,
};
pub use regular_file::{read_file, read_text};
pub use self_affine::SelfAffine;
pub use spectrum::{Band, PowerLaw, Spectrum};
pub use surface::{MeanLine, Surface, peak_to_valley};
pub use uncertainty::{
    Covariance, Distribution, FittedNumber, Scale, SpectrumFactors, Spread, UncertainKey, Uncertainty, decade_of,
};
pub use values::{LOOSEST_TOLERANCE, Unit, Value, is_possible};

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
    /// The links fitted to the material's surface; `None` where they follow from the thickness alone or are given.
    pub foundation: Option<Foundation>,
    /// The rigid surface below it.
    pub surface: Surface,
    /// The axes along which the carrier is a body.
    pub carrier: CarrierBodies,
    /// The roughness below the resolution of the profile; `None`: contacts touch on all of their area.
    pub fine: Option<FineRoughness>,
    /// Friction in the contacts; `None` is frictionless.
    pub friction: Option<Friction>,
    /// The integrator's settings.
    pub solver: Solver,
    /// How the carrier moves on when a master gives no rates.
    pub extrapolation: Extrapolation,
    /// Whether the layer's temperature is an input.
    pub temperature_input: bool,
    /// The output groups, in the order of [`OutputGroup::ALL`], each once.
    pub outputs: Vec<OutputGroup>,
    /// What its FMU's description says for simple importers.
    #[serde(skip)]
    pub fmu: FmuOptions,
    /// The motion of the carrier in runs without a master.
    pub excitation: Vec<Phase>,
    /// What is not known of it; no run depends on that.
    #[serde(skip)]
    pub uncertainty: Uncertainty,
    /// The files that the scene reads and an FMU carries: relative to its folder, as the scene names them; a line of an
    /// areal measurement by the name of its extract.
    #[serde(skip)]
    pub files: Vec<PathBuf>,
    /// The lines of areal measurements among them.
    #[serde(skip)]
    pub extracts: Vec<Extract>,
    /// Warnings: what is probably not meant though the scene is valid.
    #[serde(skip)]
    pub warnings: Vec<String>,
    /// How the tables were read that the scene names: columns and units, found or assumed.
    #[serde(skip)]
    pub notes: Vec<ReadingNote>,
}

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
    /// Mass of one point mass, kg; in the direct form alone, see [`Scene::mass`].
    pub mass: Option<f64>,
    /// How the links follow from the material; in the material form alone.
    pub foundation: Option<FoundationKind>,
    /// Thickness H, m; in the material form alone, and not of a half-space.
    pub thickness: Option<f64>,
    /// Width B, m; in the material form alone.
    pub width: Option<f64>,
    /// How the dashpots start.
    pub initial: Initial,
    /// Heights h_i of the elastic body's roughness, m: k values, or none for a smooth body.
    pub roughness: Vec<f64>,
    /// The links; in the direct form alone, see [`Scene::link`].
    #[serde(flatten, serialize_with = "link_kind::by_name")]
    pub links: ByLink<Option<Link>>,
}

impl Layer {
    /// Position X_i of mass `i` (from 0) at rest, m.
    pub fn rest_position(&self, i: usize) -> f64 {
        self.origin + i as f64 * self.spacing
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
    /// Adhesive shear force A τ_0 of one mass in contact, N; in the direct form alone, see [`Scene::shear_force`].
    pub shear_force: Option<f64>,
    /// Adhesive shear strength τ_0, Pa; in the material form alone.
    pub shear_strength: Option<f64>,
    /// Rate-dependent shear strength.
    pub rate_shear: Option<RateShear>,
    /// The way D over which contacts are renewed, m, 0: at once; `None` see [`Scene::memory_way`].
    pub memory: Option<f64>,
}

/// Shear strength that depends on the speed: A τ_f(v) = A τ_f0 exp(-c [log10(v/v_0)]²) of one mass in contact, constant
/// at A τ_f(v_c) below the creep speed v_c.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
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

/// The creep speed over the reference speed where the scene does not give it.
const CREEP: f64 = 1e-6;

impl RateShear {
    /// The creep speed, m/s: as it was set, or a millionth of the reference speed, but at least [`SMALLEST`].
    pub fn creep_speed(&self) -> f64 {
        self.creep_speed.unwrap_or_else(|| (CREEP * self.reference_speed).max(SMALLEST))
    }
}

/// The integrator's settings. What a scene leaves out is said by the table of keys: the default here is no tolerance.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Solver {
    /// How mode changes are treated.
    pub method: Method,
    /// Relative tolerance of the local error, 1.
    pub relative_tolerance: f64,
    /// Absolute tolerance, m; `None` follows the relative tolerance and the scene's height.
    pub absolute_tolerance: Option<f64>,
    /// The most steps of one communication step or one phase; `None`: [`DEFAULT_MAX_STEPS`](Self::DEFAULT_MAX_STEPS).
    #[serde(serialize_with = "most_steps")]
    pub max_steps: Option<u64>,
    /// Bound on the error of a link's force for leaving Maxwell elements out, as a share of it; 0 leaves none out.
    pub reduce: f64,
}

impl Solver {
    /// The most steps where a scene names no other number.
    pub const DEFAULT_MAX_STEPS: u64 = 10_000_000;

    /// The most steps of one communication step or one phase: as it was set, or the default.
    pub fn max_steps(&self) -> u64 {
        self.max_steps.unwrap_or(Self::DEFAULT_MAX_STEPS)
    }
}

/// Written is the number that counts: fingerprints of sweeps do not depend on whether it is the default.
fn most_steps<S: serde::Serializer>(named: &Option<u64>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_u64(named.unwrap_or(Solver::DEFAULT_MAX_STEPS))
}

/// How mode changes are treated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Every mode change is located.
    #[default]
    Event,
    /// Mode changes are taken at the ends of the steps.
    Step,
    /// Located while there are few in a step; taken at the ends of the steps where there are many.
    Auto,
}

impl Word for Method {
    const WORDS: &'static [(&'static str, Self)] =
        &[("event", Self::Event), ("step", Self::Step), ("auto", Self::Auto)];
}

/// How the carrier moves when a master gives values alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Extrapolation {
    /// At the rate of the communication step before.
    #[default]
    Linear,
    /// To the value given, reached at the end of the communication step.
    Hold,
}

impl Word for Extrapolation {
    const WORDS: &'static [(&'static str, Self)] = &[("linear", Self::Linear), ("hold", Self::Hold)];
}

impl Extrapolation {
    /// The word for it in a scene file.
    pub fn word(self) -> &'static str {
        self.as_word()
    }

    /// What a word stands for.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::parse(word)
    }
}

/// The groups of output variables that a scene may ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum OutputGroup {
    /// F_x, F_z.
    Forces,
    /// Motion of a carrier that is a body, and the force of its drive.
    Carrier,
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
    /// Position, forces and mode of each mass.
    Elements,
}

impl Word for OutputGroup {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("forces", Self::Forces),
        ("carrier", Self::Carrier),
        ("dissipation", Self::Dissipation),
        ("friction", Self::Friction),
        ("contact", Self::Contact),
        ("energy", Self::Energy),
        ("tangent", Self::Tangent),
        ("solver", Self::Solver),
        ("elements", Self::Elements),
    ];
}

impl OutputGroup {
    /// The group's name in a scene file.
    pub fn word(self) -> &'static str {
        self.as_word()
    }

    /// All groups, in the order of the variables.
    pub const ALL: [Self; 9] = [
        Self::Forces,
        Self::Carrier,
        Self::Dissipation,
        Self::Friction,
        Self::Contact,
        Self::Energy,
        Self::Tangent,
        Self::Solver,
        Self::Elements,
    ];
}

impl Scene {
    /// The duration of the excitation if no force ends a phase, s.
    pub fn duration(&self) -> f64 {
        self.excitation.iter().map(|phase| phase.duration).sum()
    }

    /// Paths of the files that the scene was read from; `path` is that of its own.
    pub fn sources(&self, path: &FilePath) -> Vec<PathBuf> {
        let folder = path.parent().unwrap_or(FilePath::new(""));
        let files = self.files.iter().chain(self.extracts.iter().map(|extract| &extract.source));
        std::iter::once(path.to_owned()).chain(files.map(|file| folder.join(file))).collect()
    }

    /// The bytes of one of the scene's [`files`](Self::files) as an FMU carries them; `folder` is the scene's.
    ///
    /// # Errors
    /// Where the file cannot be read.
    pub fn carried(&self, folder: &FilePath, file: &FilePath) -> io::Result<Vec<u8>> {
        match self.extracts.iter().find(|extract| extract.name == file) {
            Some(extract) => Ok(extract.text.clone().into_bytes()),
            None => read_file(&folder.join(file)),
        }
    }

    /// The scene's height, m: the peak-to-valley heights of the profile's data points and of the layer's roughness
    /// together, the spacing of the masses where both are flat.
    pub fn height(&self) -> f64 {
        let height = peak_to_valley(self.surface.z()) + peak_to_valley(&self.layer.roughness);
        if height > 0.0 { height } else { self.layer.spacing }
    }

    /// The absolute tolerance, m: as it was set, or the relative one times the [`height`](Self::height), but at least
    /// [`SMALLEST`].
    pub fn absolute_tolerance(&self) -> f64 {
        let default = || (self.solver.relative_tolerance * self.height()).max(SMALLEST);
        self.solver.absolute_tolerance.unwrap_or_else(default)
    }
}

/// A name as a C identifier: letters, digits and underscores, no digit first.
pub fn identifier(name: &str) -> String {
    let legal = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '_' };
    let identifier: String = name.chars().map(legal).collect();
    if identifier.starts_with(|first: char| first.is_ascii_digit()) { format!("_{identifier}") } else { identifier }
}
