//! What one FMU simulates: a scene, read from one TOML file and checked.
//!
//! Every field is in SI units. A feature that the scene does not name is `None` or empty, and costs nothing at run
//! time.
//!
//! A new key is a row in the table of `keys`, which also reads it and makes it a parameter, and a field of the data
//! below.

mod axis;
mod carrier;
mod derived;
mod error;
mod file_values;
mod files;
mod fine_roughness;
mod foundation;
mod height_map;
mod keys;
mod layer;
mod material;
mod motion_file;
mod parameters;
mod patch_file;
mod profile;
mod reader;
mod scaled_spectrum;
mod seal_file;
mod self_affine;
mod settings;
mod spectrum;
mod surface;
mod values;
mod warnings;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use serde::Serialize;

use crate::tables::ReadingNote;

pub use crate::tables::{LARGEST, SMALLEST};
pub use axis::{Axis, ByAxis, ByLink, LinkKind};
pub use carrier::{CarrierBodies, CarrierBody, CarrierInitial, Input};
pub use carrier::{Force, Motion, Path, Phase};
pub use error::{ParameterError, Problem, SceneError, did_you_mean};
pub use file_values::{FileValues, Setting};
pub use files::{
    CanonicalFiles, ElasticConstants, FileFormats, LoadedProfile, SceneFile, line_note, read_file, read_text,
};
pub use fine_roughness::{
    Convention, FineBand, FineRoughness, FineWaves, LEAST_DENSITY, ModulusFactors, RoughnessSpectrum, SOFTENING,
    SPECTRUM, Softening, SofteningRow, SpectrumFactors, SplitError, SplitSurface, WaveModuli, decade_of,
};
pub use foundation::{ContactFit, ElasticBody, Foundation, Quality, Stiffness, Wave, Waves};
pub use height_map::{HeightMap, MOST_HEIGHTS, MapError, peak_to_valley};
pub use keys::{Absent, KeyEntry, patch_keys, scene_keys, seal_keys, similar_keys};
pub use layer::{FoundationKind, Friction, Initial, Kinematics, Layer, Link, MaxwellElement, RateShear};
pub use material::{Heat, Material, PronyTerm, SERIES, Wlf, complex_stiffness};
pub use motion_file::MOTION;
pub use parameters::{KeyNumber, Parameter};
pub use patch_file::{Backing, FaceHeat, FaceShape, Grid, NotDoubled, PatchFile, PatchGroup, TableExtrapolation};
pub use profile::{Depth, LengthUnit, Missing, ProfileOptions, ThirdColumn, Tilt, UnknownWord};
pub use reader::{LIP_PRESSURES, POINTS};
pub use seal_file::{Air, LipSet, RoughSide, SealFile, SealGroup, Viscosity};
pub use self_affine::SelfAffine;
pub use settings::{DependencyList, Extrapolation, FmuOptions, InputRule, IntegerType, Method, OutputGroup, Solver};
pub use spectrum::{PowerLaw, Spectrum, SpectrumBand};
pub use surface::{Coordinate, MeanLine, PointsError, Surface, UnfitPoints, check_points, remove_tilt};
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
    /// The way over which contacts are renewed where `friction.memory` does not say it, m; 0 in the direct form.
    #[serde(skip)]
    pub default_memory: f64,
    /// The integrator's settings.
    pub solver: Solver,
    /// How the carrier moves on when a master gives no rates.
    #[serde(flatten)]
    pub input_rule: InputRule,
    /// Whether the layer's temperature is an input.
    pub temperature_input: bool,
    /// The output groups, in the order of [`OutputGroup::ALL`], each once.
    pub outputs: Vec<OutputGroup>,
    /// What its FMU's description says for simple importers.
    #[serde(skip)]
    pub fmu: FmuOptions,
    /// The motion of the carrier in runs without a master.
    pub excitation: Vec<Phase>,
    /// The files that the scene names, each once.
    #[serde(skip)]
    pub files: Vec<SceneFile>,
    /// Warnings: what is probably not meant though the scene is valid.
    #[serde(skip)]
    pub warnings: Vec<String>,
    /// How the tables were read that the scene names: columns and units, found or assumed.
    #[serde(skip)]
    pub notes: Vec<ReadingNote>,
    /// The values that it was read from.
    #[serde(skip)]
    pub values: Arc<FileValues>,
}

/// A name as a C identifier: letters, digits and underscores, no digit first.
pub fn identifier(name: &str) -> String {
    let legal = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '_' };
    let identifier: String = name.chars().map(legal).collect();
    if identifier.starts_with(|first: char| first.is_ascii_digit()) { format!("_{identifier}") } else { identifier }
}
