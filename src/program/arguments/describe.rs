//! The command line of `asperity describe`.

use std::path::PathBuf;

use clap::Args;

#[derive(Debug, Args)]
pub(crate) struct Describe {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// Prints the whole scene as one JSON object, in SI units: links as constants, the profile as its data points; what
    /// is left out is null or empty.
    #[arg(long)]
    pub(crate) json: bool,
}
