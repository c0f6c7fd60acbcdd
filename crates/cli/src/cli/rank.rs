//! The arguments of `rank`.

use std::path::PathBuf;

use asperity_study::files::ColumnOptions;
use asperity_study::sweep::SweepOptions;
use clap::{ArgGroup, Args};

use super::shared::Set;
use super::values::{count, picture};

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("over").required(true).args(["speeds"])))]
#[command(group(ArgGroup::new("loads").required(true).args(["pressures", "forces"])))]
#[command(after_help = example!(
    "asperity rank scenes/road/road.toml scenes/two-maxima/two-maxima.toml --speeds 0.1..10/5 --pressures 2bar \\\n\
    \x20     --temperatures 10°C,30°C -o rank.csv"
))]
pub(crate) struct Rank {
    /// The scene files, two or more; the index of the first is 100.
    #[arg(value_name = "SCENE.toml", num_args = 2.., required = true)]
    pub(crate) scenes: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) options: SweepOptions,
    /// The weights of the points in the mean: a table with a column weight and those of speed, pressure and temperature that it
    /// depends on. Default: all the same.
    #[arg(long, value_name = "WEIGHTS.csv")]
    pub(crate) weights: Option<PathBuf>,
    /// Number of samples of what is not known of the scenes, [uncertainty], drawn with common numbers.
    #[arg(long, value_name = "N", default_value_t = 128, value_parser = count)]
    pub(crate) samples: u32,
    /// The seed of the samples.
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Measured friction, as for asperity calibrate, with a column scene of the scenes' names or file names: it is compared
    /// beside, and the order by Kendall's rank correlation.
    #[arg(long, value_name = "MEASURED.csv")]
    pub(crate) data: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) columns: ColumnOptions,
    /// The table to write, a row for each point and scene, - for standard output. Default: rank.csv.
    #[arg(short, long, value_name = "TABLE.csv", default_value = "rank.csv")]
    pub(crate) output: PathBuf,
    /// The picture to write, as SVG or PNG according to the file name: indices with their bands, and which scene has the largest
    /// friction over speed and temperature. Default: the table's name with .svg.
    #[arg(long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) plot: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) set: Set,
}
