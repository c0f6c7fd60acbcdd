//! The command line of `asperity pack`.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{ArgGroup, Args};

use super::count;

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("subject").required(true)))]
pub(crate) struct Pack {
    /// The scene file.
    #[arg(value_name = "SCENE.toml", group = "subject")]
    pub(crate) scene: Option<PathBuf>,
    /// A sweep's table: packs a point-contact element, which looks the forces up instead of simulating the layer.
    #[arg(long, value_name = "TABLE.csv", group = "subject")]
    pub(crate) table: Option<PathBuf>,
    /// The scene that was swept: compares the element with its layer between the table's points and along a motion to
    /// and fro, and writes tables and pictures of it to a folder beside the FMU.
    #[arg(long, value_name = "SCENE.toml", requires = "table", conflicts_with = "scene")]
    pub(crate) check: Option<PathBuf>,
    /// Points that --check compares at most.
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = count)]
    pub(crate) points: u32,
    /// The FMU to write.
    #[arg(short, long, value_name = "OUT.fmu")]
    pub(crate) output: PathBuf,
    /// A shared library, of this platform unless linux64, win64 or darwin64 is named, as in win64=PATH; may be given
    /// several times.
    /// Default: the one beside this program.
    #[arg(long, value_name = "[PLATFORM=]PATH")]
    pub(crate) library: Vec<OsString>,
}
