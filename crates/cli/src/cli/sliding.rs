//! The arguments of `sweep`, `converge` and `contact`.

use std::path::PathBuf;

use asperity::tables::Dimension;
use asperity_study::contact::SteadyState;
use asperity_study::files::ColumnOptions;
use asperity_study::sweep::{Over, SlidingOptions, SweepOptions};
use asperity_study::values::Values;
use clap::{ArgGroup, Args};

use super::shared::Set;
use super::sweep_values::Shard;
use super::values::{count, picture, seeds, share, table_or_arrays};

/// Options of a sweep that --merge does not take.
const OF_A_SCENE: [&str; 15] = [
    "speeds",
    "pressures",
    "forces",
    "temperatures",
    "method",
    "points",
    "friction_error",
    "distance",
    "shard",
    "master",
    "converged",
    "samples",
    "seed",
    "keep",
    "set",
];

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("input").required(true)))]
#[command(group(ArgGroup::new("speeds_or_merge").required(true).args(["speeds", "merge"])))]
#[command(after_help = example!(
    "asperity sweep scenes/road/road.toml --speeds 1e-4..10/11 --pressures 3bar \\\n      --temperatures 5°C,20°C,40°C -o friction.csv"
))]
pub(crate) struct Sweep {
    /// The scene file; its excitation and outputs are not used.
    #[arg(value_name = "SCENE.toml", group = "input")]
    pub(crate) scene: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) options: SweepOptions,
    /// The table to write, - for standard output; an existing table of the same sweep is continued. Default: the
    /// scene's file name with .sweep.csv.
    #[arg(short, long, value_name = "TABLE.csv")]
    pub(crate) output: Option<PathBuf>,
    /// The plot to write, as SVG or PNG according to the file name. Points that are not steady, or not converged, are
    /// hollow. Default: the table's name with .svg.
    #[arg(long, value_name = "OUT.svg", value_parser = picture(), conflicts_with = "shard")]
    pub(crate) plot: Option<PathBuf>,
    /// Plots a map in place of curves: friction in colours over two of speed, pressure (or force) and temperature, x and y
    /// in this order, a map for each value of the third, with contour lines and where along x friction is largest.
    #[arg(long, value_name = "X,Y", value_parser = Over::parse, conflicts_with_all = ["shard", "ways"])]
    pub(crate) over: Option<Over>,
    /// Measured friction, as for asperity calibrate, drawn in the same colours into the maps of --over.
    #[arg(long, value_name = "MEASURED.csv", requires = "over")]
    pub(crate) data: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) columns: ColumnOptions,
    /// Also plots the master curve: friction over a_T v, the speed at the reference temperature of material.wlf.
    #[arg(long, value_name = "OUT.svg", value_parser = picture(), conflicts_with = "shard")]
    pub(crate) master: Option<PathBuf>,
    /// Several ways in m, in the format of --speeds: the table has a column way [m], and friction is plotted over the way. It
    /// is not to be packed or continued.
    #[arg(long, value_name = "VALUES", value_parser = Values::of(Dimension::Length))]
    #[arg(conflicts_with_all = ["way", "shard", "merge", "master", "converged"])]
    pub(crate) ways: Option<Values>,
    /// Also computes each point for N scenes drawn from what the scene's section [uncertainty] says is not known: quantiles
    /// of friction, hysteresis and area are columns of the table, friction's bands of 50 and 90 % are plotted, and what
    /// matters is written beside the table with .matters.csv and .matters.svg.
    #[arg(long, value_name = "N", value_parser = count, conflicts_with = "ways")]
    pub(crate) samples: Option<u32>,
    /// What scrambles the points of the samples: another seed draws others.
    #[arg(long, value_name = "N", default_value_t = 1, requires = "samples")]
    pub(crate) seed: u64,
    /// Also writes friction, hysteresis and area of every sample at every point, with what was drawn for it.
    #[arg(long, value_name = "SAMPLES.csv", requires = "samples", conflicts_with = "shard")]
    pub(crate) keep: Option<PathBuf>,
    /// Computes only share I of N of the points, I from 1 to N.
    #[arg(long, value_name = "I/N", value_parser = Shard::parse)]
    pub(crate) shard: Option<Shard>,
    /// Merges the tables of shards, and the one at --output if it is of the same sweep.
    #[arg(long, value_name = "TABLE.csv", num_args = 1.., group = "input", requires = "output")]
    #[arg(conflicts_with_all = OF_A_SCENE)]
    pub(crate) merge: Vec<PathBuf>,
    /// The table of an asperity converge of the scene: what it found goes into the header. Default: the scene's file
    /// name with .converge.csv, if there is such a file.
    #[arg(long, value_name = "STUDY.csv")]
    pub(crate) converged: Option<PathBuf>,
    /// Replaces an existing table instead of continuing it.
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) set: Set,
}

#[derive(Debug, Args)]
#[command(after_help = example!("asperity converge scenes/two-maxima/two-maxima.toml --pressure 2bar --speed 0.1 -o study.csv"))]
pub(crate) struct Converge {
    /// The scene file, in the material form; its excitation and outputs are not used.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    #[command(flatten)]
    pub(crate) at: SteadyState,
    /// Admissible change of friction and area, as a share of them, with the spacing halved, the length doubled or
    /// another seed.
    #[arg(long, value_name = "SHARE", default_value_t = 0.05, value_parser = share)]
    pub(crate) error: f64,
    /// Number of seeds of a self-affine surface or roughness, the scene's own included. Default: 4.
    #[arg(long, value_name = "N", value_parser = seeds)]
    pub(crate) seeds: Option<u32>,
    #[command(flatten)]
    pub(crate) sliding: SlidingOptions,
    /// Most masses, or points of the whole surface with --method steady, that the halved spacing may come to; with twice
    /// the length there are twice as many. Default: 4096 masses, 2097152 points.
    #[arg(long, value_name = "N", visible_alias = "most-masses", value_parser = count)]
    pub(crate) most_points: Option<u32>,
    /// The table to write, - for standard output; an existing table of the same study is continued. Default: the
    /// scene's file name with .converge.csv.
    #[arg(short, long, value_name = "TABLE.csv")]
    pub(crate) output: Option<PathBuf>,
    /// The plot to write, as SVG or PNG according to the file name. Default: the table's name with .svg.
    #[arg(long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) plot: Option<PathBuf>,
    /// Replaces an existing table instead of continuing it.
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) set: Set,
}

#[derive(Debug, Args)]
#[command(after_help = example!("asperity contact scenes/two-maxima/two-maxima.toml --pressure 2bar --speed 0.1 -o contact.png"))]
pub(crate) struct Contact {
    /// The scene file, in the material form with a foundation "half_space" or "layer" and a periodic surface; its excitation
    /// and outputs are not used.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    #[command(flatten)]
    pub(crate) at: SteadyState,
    #[command(flatten)]
    pub(crate) sliding: SlidingOptions,
    /// The picture to write, as SVG or PNG according to the file name: along a profile heights and pressure; of a map
    /// pressure, gap and where it is touched.
    #[arg(short, long, value_name = "OUT.png", value_parser = picture())]
    pub(crate) output: PathBuf,
    /// All points to write: x, y, height, pressure, gap, as a table or, with .npz, as arrays of numpy with a row for each y.
    #[arg(long, value_name = "OUT.csv|.npz", value_parser = table_or_arrays())]
    pub(crate) write: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) set: Set,
}
