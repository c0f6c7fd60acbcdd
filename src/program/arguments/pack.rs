//! The command line of `asperity pack`.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::Args;

#[derive(Debug, Args)]
pub(crate) struct Pack {
    /// The scene file.
    #[arg(value_name = "SCENE.toml", required_unless_present = "table", conflicts_with = "table")]
    pub(crate) scene: Option<PathBuf>,
    /// A sweep's table: packs a point-contact element, which looks the forces up instead of simulating the layer.
    #[arg(long, value_name = "TABLE.csv")]
    pub(crate) table: Option<PathBuf>,
    /// The scene that was swept: compares the element with its layer between the table's points and along a motion to
    /// and fro, and writes tables and pictures of it to a folder beside the FMU.
    #[arg(long, value_name = "SCENE.toml", requires = "table")]
    pub(crate) check: Option<PathBuf>,
    /// Points that --check compares at most.
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) points: u32,
    /// The FMU to write.
    #[arg(short, long, value_name = "OUT.fmu")]
    pub(crate) output: PathBuf,
    /// A shared library, of this platform unless another is named, as in win64=PATH; may be given several times.
    /// Default: the one beside this program.
    #[arg(long, value_name = "[PLATFORM=]PATH")]
    pub(crate) library: Vec<OsString>,
}
