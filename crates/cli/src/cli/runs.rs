//! The arguments of `report`.

use std::path::PathBuf;

use clap::Args;

use super::values::{Set, Tolerances, count, example, powers, seconds};

#[derive(Debug, Args)]
#[command(after_help = example!("asperity report scenes/stiff/stiff.toml --tolerances 1e-3..1e-5 --stress 0 -o report"))]
pub(crate) struct Report {
    /// The scene files. Of several, each has its report in a folder of its name, and one page shows all.
    #[arg(value_name = "SCENE.toml", required = true)]
    pub(crate) scenes: Vec<PathBuf>,
    /// The folder to write to; it is created if it does not exist.
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,
    /// Range of relative tolerances to run at; each is a tenth of the previous one.
    #[arg(long, value_name = "LOOSEST..TIGHTEST", default_value = "1e-2..1e-10", value_parser = Tolerances::parse)]
    pub(crate) tolerances: Tolerances,
    /// Number of rows for each phase of the excitation at which runs are compared.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = count)]
    pub(crate) rows: u32,
    /// Most timings of each run, done for short runs; long ones are timed three times. The least and the spread are
    /// reported.
    #[arg(long, value_name = "N", default_value_t = 25, value_parser = count)]
    pub(crate) repeat: u32,
    /// Robustness test: varies the scene's quantities, singly and in pairs, by up to N powers of ten either way. 0
    /// skips the test.
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = powers)]
    pub(crate) stress: u32,
    /// Approximate time limit in seconds for the pairs of the robustness test; the cheapest pairs run first.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) stress_time: f64,
    /// Results of other programs, in the format written by benches/peers/run.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) peers: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) set: Set,
}
