//! The arguments of `report`.

use std::path::PathBuf;

use asperity_study::benchmark::BenchmarkOptions;
use clap::Args;

use super::values::{Set, example};

#[derive(Debug, Args)]
#[command(after_help = example!("asperity report scenes/stiff/stiff.toml --tolerances 1e-3..1e-5 --stress 0 -o report"))]
pub(crate) struct Report {
    /// The scene files. Of several, each has its report in a folder of its name, and one table has the errors of all.
    #[arg(value_name = "SCENE.toml", required = true)]
    pub(crate) scenes: Vec<PathBuf>,
    /// The folder to write to; it is created if it does not exist.
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) options: BenchmarkOptions,
    /// Results of other programs, in the format written by benches/peers/run.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) peers: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) set: Set,
}
