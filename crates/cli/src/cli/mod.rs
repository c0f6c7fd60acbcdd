//! The command line: the arguments of every command, by what it is about. [`values`] parses and checks single values.
//!
//! A name means the same in all commands that have it: `points` those of the surface's period, `error` what a study of
//! convergence may leave open, `data` measured friction.

#[macro_use]
mod example;
mod friction;
mod measurements;
mod rank;
mod runs;
mod scenes;
mod shared;
mod sliding;
pub(crate) mod sweep_values;
mod values;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

pub(crate) use friction::{Calibrate, Compare};
pub(crate) use measurements::{Fit, Surface};
pub(crate) use rank::Rank;
pub(crate) use runs::{Plot, Report, Simulate};
pub(crate) use scenes::{Describe, Material, Pack};
pub(crate) use sliding::{Contact, Converge, Sweep};
pub(crate) use values::{Condition, PlotAxis};

/// Simulates rubber on a rough surface and packs the simulation as an FMU.
#[derive(Debug, Parser)]
#[command(name = "asperity", version)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Prints results and warnings alone, neither notes nor progress.
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
    /// Prints every note where only some or their number would be printed.
    #[arg(short, long, global = true, conflicts_with = "quiet")]
    pub(crate) verbose: bool,
}

#[derive(Debug, Subcommand)]
#[command(defer = true)]
pub(crate) enum Command {
    /// Simulates a scene along its excitation and writes a result file.
    Simulate(Simulate),
    /// Plots columns of result files and tables.
    Plot(Plot),
    /// Summarises a scene on a screen: what it contains, what is computed and what is left out; with -v also the constants
    /// derived from it.
    Describe(Describe),
    /// Packs a scene, or a point-contact element or a contact patch from a sweep table, as an FMI 2.0 co-simulation
    /// FMU.
    Pack(Pack),
    /// Fits Prony terms to measured moduli of a compound (DMA data).
    Fit(Fit),
    /// Plots the complex modulus of a scene's compound over frequency, or the complex stiffness of its links.
    Material(Material),
    /// Benchmarks a scene: accuracy, run time and robustness, as tables, plots and an HTML page.
    Report(Report),
    /// Analyses a measured profile or a scene's surface: heights, slopes, spectrum and Hurst exponent.
    Surface(Surface),
    /// Computes the friction coefficient over speed, pressure and temperature, as a table and a plot.
    Sweep(Sweep),
    /// Tests whether friction and contact area depend on a scene's spacing, length and seed. Exit status 0: all within
    /// the error; 3: not all.
    Converge(Converge),
    /// Fits numbers of a scene to measured friction: values, standard errors, what the data cannot tell. Exit status 0:
    /// converged; 3: not converged, or not all identifiable; 1: refused.
    Calibrate(Calibrate),
    /// Compares the table of a sweep with measured friction: curves and points in one picture, and the worst points.
    Compare(Compare),
    /// Ranks scenes by their friction: an index with its band, which is the largest and how surely. Exit status 0: the first
    /// two are told apart with a probability of 0.9; 3: they are not.
    Rank(Rank),
    /// Draws where the rubber touches in steady sliding, and how hard.
    Contact(Contact),
    /// Prints what completes commands and options in a shell: asperity completions bash >>
    /// ~/.local/share/bash-completion/completions/asperity.
    Completions(Completions),
    /// Writes the manual pages, one for each command.
    Manual(Manual),
    /// Prints all keys of scenes and patches, all outputs and options, as Markdown: docs/reference.md.
    #[command(hide = true)]
    Reference,
}

#[derive(Debug, Args)]
#[command(after_help = example!("asperity completions bash"))]
pub(crate) struct Completions {
    /// The shell.
    pub(crate) shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
#[command(after_help = example!("asperity manual -o man"))]
pub(crate) struct Manual {
    /// The folder to write the pages to; it is created if it does not exist.
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_program_says_its_own_name() {
        assert_eq!(Arguments::command().render_version(), concat!("asperity ", env!("CARGO_PKG_VERSION"), "\n"));
    }

    /// Also those that a test cannot run.
    #[test]
    fn examples_are_understood() {
        let mut command = Arguments::command();
        command.build();
        for of in command.get_subcommands().filter(|of| !of.is_hide_set() && of.get_name() != "help") {
            let help = of.get_after_help().map(ToString::to_string).unwrap_or_default();
            let example = help.lines().skip(1).collect::<Vec<_>>().join(" ").replace('\\', " ");
            let parsed = Arguments::try_parse_from(example.split_whitespace());
            assert!(parsed.is_ok() && example.contains(&format!("asperity {}", of.get_name())), "{parsed:?}");
        }
    }

    #[test]
    fn the_command_line_is_well_formed() {
        Arguments::command().debug_assert();
    }
}
