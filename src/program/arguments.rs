//! The command line.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

/// Simulates rubber on a rough surface and packs the simulation as an FMU.
#[derive(Debug, Parser)]
#[command(version, about)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Runs a scene along its excitation and writes a result file.
    Simulate(Simulate),
    /// Draws columns of result files.
    Plot(Plot),
    /// Prints what is in a scene and what is left out.
    Describe(Describe),
    /// Packs a scene as an FMI 2.0 co-simulation FMU.
    Pack(Pack),
}

#[derive(Debug, Args)]
pub(crate) struct Simulate {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// The result file to write.
    #[arg(short, long, value_name = "OUT.csv")]
    pub(crate) output: PathBuf,
    /// Rows per phase of the excitation.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) points: u32,
    /// Overrides a parameter by its name, such as solver.relative_tolerance=1e-9.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    pub(crate) set: Vec<(String, String)>,
    /// Draws forces, contacts and dissipation over time.
    #[arg(long, value_name = "OUT.svg")]
    pub(crate) plot: Option<PathBuf>,
}

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
    /// The picture to write.
    #[arg(short, long, value_name = "OUT.svg")]
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

#[derive(Debug, Args)]
pub(crate) struct Pack {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// The FMU to write.
    #[arg(short, long, value_name = "OUT.fmu")]
    pub(crate) output: PathBuf,
    /// A shared library, of this platform unless another is named, as in win64=PATH; may be given several times.
    /// Default: the one beside this program.
    #[arg(long, value_name = "[PLATFORM=]PATH")]
    pub(crate) library: Vec<OsString>,
}

fn key_and_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => Ok((key.trim().into(), value.trim().into())),
        _ => Err("expected KEY=VALUE, such as solver.relative_tolerance=1e-9".into()),
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_well_formed() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn a_parameter_is_split_at_the_first_equals_sign() {
        assert_eq!(key_and_value("a.b = 1=2"), Ok(("a.b".into(), "1=2".into())));
        assert!(key_and_value("a.b").is_err());
        assert!(key_and_value("=1").is_err());
    }
}
