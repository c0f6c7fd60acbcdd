//! The command line of `asperity simulate`.

use std::path::PathBuf;

use clap::Args;

use super::{count, key_and_value, picture};

#[derive(Debug, Args)]
pub(crate) struct Simulate {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// The result file to write.
    #[arg(short, long, value_name = "OUT.csv")]
    pub(crate) output: PathBuf,
    /// Rows per phase of the excitation.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = count)]
    pub(crate) points: u32,
    /// Overrides a parameter by its name, such as solver.relative_tolerance=1e-9.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    pub(crate) set: Vec<(String, String)>,
    /// Draws forces, contacts and dissipation over time, as SVG or PNG by the name.
    #[arg(long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) plot: Option<PathBuf>,
}
