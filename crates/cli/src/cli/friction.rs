//! The arguments of `calibrate` and `compare`.

use std::path::PathBuf;

use asperity::tables::Dimension;
use asperity_study::calibration::FreeParameter;
use asperity_study::files::ColumnOptions;
use asperity_study::sweep::SlidingOptions;
use asperity_study::values::Values;
use clap::Args;

use super::shared::Set;
use super::values::{free_parameter, picture};

#[derive(Debug, Args)]
#[command(after_help = example!(
    "asperity calibrate docs/guide/measured.toml --data docs/guide/measured.csv \\\n\
    \x20     --free friction.rate_shear.strength=1e6..2e7 -o docs/guide/fitted.toml"
))]
pub(crate) struct Calibrate {
    /// The scene file, in the material form; its excitation and outputs are not used.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// The measured friction: columns, by their names and units, of speed, pressure (or force on the whole layer) and
    /// friction; of temperature and of the standard deviation of friction if it has them. Rows of one point are repeats.
    #[arg(long, value_name = "MEASURED.csv")]
    pub(crate) data: PathBuf,
    #[command(flatten)]
    pub(crate) columns: ColumnOptions,
    /// A number of the scene to fit, by its key as for --set, within bounds; its logarithm where they are positive and a
    /// decade apart. May be repeated, up to 12 times.
    #[arg(long, value_name = "KEY=LOW..HIGH", value_parser = free_parameter, required = true)]
    pub(crate) free: Vec<FreeParameter>,
    /// The scene to write with the numbers found, its comments kept; - for standard output. The points found are kept in
    /// a table beside it, from which an interrupted fit goes on. Default: the scene's file with .calibrated.toml.
    #[arg(short, long, value_name = "OUT.toml")]
    pub(crate) output: Option<PathBuf>,
    /// The plot to write, as SVG or PNG according to the file name. Default: the output's name with .svg.
    #[arg(long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) plot: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) sliding: SlidingOptions,
    /// Also proposes three points to measure that would tell most (D-optimal among a grid).
    #[arg(long)]
    pub(crate) plan: bool,
    /// Speeds of that grid in m/s, in the format of asperity sweep. Default: a decade beyond the data's.
    #[arg(long, value_name = "VALUES", value_parser = Values::of(Dimension::Speed), requires = "plan")]
    pub(crate) speeds: Option<Values>,
    /// Pressures of that grid in Pa. Default: a factor of two beyond the data's.
    #[arg(long, value_name = "VALUES", value_parser = Values::of(Dimension::Pressure), requires = "plan")]
    pub(crate) pressures: Option<Values>,
    /// Temperatures of that grid in K. Default: 20 K beyond the data's.
    #[arg(long, value_name = "VALUES", value_parser = Values::of(Dimension::Temperature), requires = "plan")]
    pub(crate) temperatures: Option<Values>,
    /// Replaces an existing table of points instead of going on from it.
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) set: Set,
}

#[derive(Debug, Args)]
#[command(after_help = example!("asperity compare friction.csv --data docs/guide/measured.csv"))]
pub(crate) struct Compare {
    /// The table of asperity sweep, over pressures.
    #[arg(value_name = "TABLE.csv")]
    pub(crate) table: PathBuf,
    /// The measured friction, as for asperity calibrate.
    #[arg(long, value_name = "MEASURED.csv")]
    pub(crate) data: PathBuf,
    #[command(flatten)]
    pub(crate) columns: ColumnOptions,
    /// The plot to write, as SVG or PNG according to the file name. Default: the table's name with .compare.svg.
    #[arg(short, long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) output: Option<PathBuf>,
}
