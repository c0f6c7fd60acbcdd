//! The command line of `asperity plot`.

use std::path::PathBuf;

use clap::Args;

use super::picture;

#[derive(Debug, Args)]
pub(crate) struct Plot {
    /// The result files, one line each for every y.
    #[arg(value_name = "FILE.csv", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// The column along the horizontal axis.
    #[arg(long, value_name = "COLUMN", default_value = "time")]
    pub(crate) x: String,
    /// A column to draw; may be given several times.
    #[arg(long, value_name = "COLUMN", required = true)]
    pub(crate) y: Vec<String>,
    /// The picture to write, SVG or PNG by its name.
    #[arg(short, long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) output: PathBuf,
    /// Names of the lines, one for each file; default: the files' names.
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    pub(crate) labels: Vec<String>,
    /// A line above the picture.
    #[arg(long)]
    pub(crate) title: Option<String>,
    /// Draws -y for y: F_x, the force on the carrier, is negative where the carrier slides towards +x.
    #[arg(long)]
    pub(crate) negate: bool,
    /// Starts each line where x begins to change: leaves out a phase that only presses when x is u.
    #[arg(long)]
    pub(crate) from_motion: bool,
}
