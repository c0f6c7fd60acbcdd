//! The arguments of `describe`, `material` and `pack`.

use std::ffi::OsString;
use std::path::PathBuf;

use asperity_study::material::MaterialOptions;
use clap::{ArgGroup, Args};

use super::shared::Set;
use super::values::{count, picture, picture_or_table, share};

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("described").required(true).args(["scene", "patch"])))]
#[command(after_help = example!("asperity describe scenes/road/road.toml"))]
pub(crate) struct Describe {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: Option<PathBuf>,
    /// A patch file: summarises a contact patch instead.
    #[arg(long, value_name = "PATCH.toml", conflicts_with_all = ["json", "plot"])]
    pub(crate) patch: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) set: Set,
    /// Prints the whole scene as one JSON object in SI units: links as constants, the profile as data points. Absent
    /// entries are null or empty.
    #[arg(long)]
    pub(crate) json: bool,
    /// Plots the stiffness of the links over that of the material's surface, over wavelength, and the friction below the
    /// profile over speed at three temperatures, as SVG or PNG according to the file name.
    #[arg(long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) plot: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(after_help = example!("asperity material scenes/road/road.toml --temperature 40°C -o moduli.svg"))]
pub(crate) struct Material {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// A file to write: a table as CSV, or a plot as SVG or PNG, according to its name; - for a table on standard
    /// output. May be repeated. Default: a plot SCENE-material.svg.
    #[arg(short, long, value_name = "OUT", value_parser = picture_or_table())]
    pub(crate) output: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) options: MaterialOptions,
    #[command(flatten)]
    pub(crate) set: Set,
}

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("input").required(true).multiple(true)))]
#[command(after_help = example!("asperity pack scenes/tread-block/tread-block.toml -o block.fmu"))]
pub(crate) struct Pack {
    /// The scene file; with --quantile the one that was swept.
    #[arg(value_name = "SCENE.toml", group = "input")]
    pub(crate) scene: Option<PathBuf>,
    /// A sweep table: packs a point-contact element, which interpolates the table instead of simulating the layer.
    #[arg(long, value_name = "TABLE.csv", group = "input")]
    #[arg(conflicts_with = "patch")]
    pub(crate) table: Option<PathBuf>,
    /// A patch file: packs a contact patch of many point-contact elements in three dimensions.
    #[arg(long, value_name = "PATCH.toml", group = "input")]
    pub(crate) patch: Option<PathBuf>,
    /// Of a table with samples, or of a patch with such a table: packs the sample whose mean friction over the table is this
    /// quantile, from 0 to 1. It is drawn from the scene and swept again.
    #[arg(long, value_name = "SHARE", value_parser = share, requires = "scene", conflicts_with = "check")]
    pub(crate) quantile: Option<f64>,
    /// The scene that was swept: compares the element with its layer between the table's points, or elements of the
    /// patch, tilted over the table's pressures, at three speeds; along a to-and-fro motion; and the patch with one of
    /// twice as many elements along and across. Writes tables and plots to a folder beside the FMU.
    #[arg(long, value_name = "SCENE.toml", conflicts_with = "scene")]
    pub(crate) check: Option<PathBuf>,
    /// Maximum number of points, or of elements of a patch, that --check compares with the layer.
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = count, requires = "check")]
    #[arg(conflicts_with = "scene")]
    pub(crate) check_points: u32,
    /// The FMU to write.
    #[arg(short, long, value_name = "OUT.fmu")]
    pub(crate) output: PathBuf,
    /// Gives variables names without structure, as transport_speed for transport.speed, for tools that make buses or
    /// folders of points and brackets in names.
    #[arg(long)]
    pub(crate) flat_names: bool,
    /// Leaves out what shows that the FMU runs as it should, for which its experiment is run: inputs, result and the list of
    /// the files that it carries (FMI-LS-REF).
    #[arg(long)]
    pub(crate) no_references: bool,
    /// A shared library; for this platform unless linux64, win64 or darwin64 is given, as in win64=PATH. May be
    /// repeated. Default: the library beside this program.
    #[arg(long, value_name = "[PLATFORM=]PATH")]
    pub(crate) library: Vec<OsString>,
}
