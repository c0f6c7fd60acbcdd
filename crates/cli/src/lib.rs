//! The command line program `asperity`: arguments, what is printed, pictures, and files written safely. What its commands
//! compute is in `asperity-study`.
//!
//! # Modules
//!
//! Each module uses only those named beside it, which stand before it.
//!
//! | module | uses | contents |
//! |---|---|---|
//! | `terminal` | | text for the terminal: aligned lines, warnings, the progress bar |
//! | `npz` | | archives of arrays for numpy |
//! | `output` | | exit statuses, outputs by their names, and errors of files |
//! | `interrupt` | output, terminal | what is left to do where the program is stopped |
//! | `draft` | interrupt, output | files that take their places whole |
//! | `files` | draft, output, terminal | scenes and other files that commands read and write |
//! | `lock` | interrupt, terminal | a table that one process writes at a time |
//! | `table_file` | draft, files, lock, output, terminal | tables that a stopped command goes on with, which add rows |
//! | `result_file` | draft | results of runs, row by row |
//! | `cli` | files | values of options, and options that several commands have |
//! | `picture` | files | draws pictures, as SVG or PNG |
//! | `plot` | cli, files, picture, terminal | `plot` |
//! | `simulate` | cli, files, npz, picture, result_file, terminal | `simulate` of a scene |
//! | `moved` | files, picture, result_file, simulate, terminal | `simulate` of a patch and of a seal |
//! | `describe` | cli, files, picture, simulate, terminal | `describe` |
//! | `contact` | cli, files, npz, picture, terminal | `contact` |
//! | `sweep` | cli, files, interrupt, output, picture, table_file, terminal | `sweep` |
//! | `friction_fit` | files, terminal | `slip` of laws of friction |
//! | `slip` | cli, files, friction_fit, picture, terminal | `slip` |
//! | `tir` | cli, files, terminal | `tir` |
//! | `rank` | cli, files, output, picture, terminal | `rank` |
//! | `converge` | cli, files, interrupt, output, picture, table_file, terminal | `converge` |
//! | `fit` | cli, files, output, picture, terminal | `fit` |
//! | `calibrate` | cli, files, interrupt, output, picture, table_file, terminal | `calibrate` |
//! | `compare` | cli, files, picture, terminal | `compare` |
//! | `material` | cli, files, picture, terminal | `material` |
//! | `surface` | cli, files, picture, terminal | `surface` |
//! | `pack` | cli, files, picture, terminal | `pack` |
//! | `verify` | cli, files, output, terminal | `verify` |
//! | `report` | cli, files, picture, terminal | `report` |
//! | `reference` | cli, files | the reference page, completions and manual pages |

mod calibrate;
mod cli;
mod compare;
mod contact;
mod converge;
mod describe;
mod draft;
mod files;
mod fit;
mod friction_fit;
mod interrupt;
mod lock;
mod material;
mod moved;
mod npz;
mod output;
mod pack;
pub mod picture;
mod plot;
mod rank;
mod reference;
mod report;
mod result_file;
mod simulate;
mod slip;
mod surface;
mod sweep;
mod table_file;
mod terminal;
mod tir;
mod verify;

use std::error::Error;
use std::ffi::OsString;
use std::io::{self, Write as _};

use clap::{CommandFactory as _, Parser, Subcommand};

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
    Simulate(simulate::Simulate),
    /// Plots columns of result files and tables.
    Plot(plot::Plot),
    /// Summarises a scene on a screen: what it contains, what is computed and what is left out; with -v also the constants
    /// derived from it.
    Describe(describe::Describe),
    /// Packs a scene, or a point-contact element, a contact patch or a seal from a sweep table, as an FMI 2.0 co-simulation
    /// FMU.
    Pack(pack::Pack),
    /// Verifies an FMU of asperity pack: every file is that which this program packs of its resources (start values, units, names,
    /// parameters), the shared library is a whole file with the functions of FMI 2.0, and the result is what the engine of
    /// this program gets along the experiment. The library is not loaded: what it computes is shown only where it is byte for
    /// byte the one beside this program; asperity.fmi.verify of the Python package runs it. Exit status 0: as packed; 3: not;
    /// 1: refused.
    Verify(verify::Verify),
    /// Fits Prony terms to measured moduli of a compound (DMA data).
    Fit(cli::Fit),
    /// Plots the complex modulus of a scene's compound over frequency, or the complex stiffness of its links.
    Material(material::Material),
    /// Benchmarks a scene: accuracy, run time and robustness, as tables, plots and a summary.
    Report(cli::Report),
    /// Analyses a measured profile or a scene's surface: heights, slopes, spectrum and Hurst exponent.
    Surface(cli::Surface),
    /// Computes the friction coefficient over speed, pressure and temperature, as a table and a plot.
    Sweep(sweep::Sweep),
    /// Tests whether friction and contact area depend on a scene's spacing, length and seed. Exit status 0: all within
    /// the error; 3: not all.
    Converge(converge::Converge),
    /// Fits numbers of a scene to measured friction: values, standard errors, what the data cannot tell. Exit status 0:
    /// converged; 3: not converged, not all identifiable, or no fit; 1: refused.
    Calibrate(calibrate::Calibrate),
    /// Compares the table of a sweep with measured friction: curves and points in one picture, and the worst points.
    Compare(compare::Compare),
    /// Ranks scenes by their friction: an index with its band, which is the largest and how surely. Exit status 0: the first
    /// two are told apart with a probability of 0.9; 3: they are not.
    Rank(rank::Rank),
    /// Computes forces over slip and slip angle of a patch whose tread runs through, and fits tyre models to them.
    Slip(slip::Slip),
    /// Scales a tyre property file to another road, temperature or compound by two tables of asperity slip.
    Tir(tir::Tir),
    /// Draws where the rubber touches in steady sliding, and how hard.
    Contact(contact::Contact),
    /// Prints what completes commands and options in a shell: asperity completions bash >>
    /// ~/.local/share/bash-completion/completions/asperity.
    Completions(reference::Completions),
    /// Writes the manual pages, one for each command.
    Manual(reference::Manual),
    /// Prints all keys of scenes, patches and seals, all outputs and options, as Markdown: docs/reference.md.
    #[command(hide = true)]
    Reference,
}

/// Executes a command line, the program's name first; prints its results, and the error that ended it. Returns the exit
/// status, also of `--help` and of a command line that cannot be understood.
pub fn execute(words: impl IntoIterator<Item = OsString>) -> u8 {
    let done = match Arguments::try_parse_from(words) {
        Ok(arguments) => bound_threads().and_then(|()| run(arguments)),
        Err(told) => tell(&told),
    };
    done.unwrap_or_else(|error| {
        if output::is_broken_pipe(&*error) {
            return output::BROKEN_PIPE;
        }
        terminal::say(&error.to_string());
        output::FAILURE
    })
}

/// Prints what is asked for by `--help`, or what is wrong with a command line.
fn tell(told: &clap::Error) -> Result<u8, Box<dyn Error>> {
    told.print()?;
    io::stdout().flush()?;
    Ok(u8::try_from(told.exit_code()).unwrap_or(output::FAILURE))
}

/// Most threads of a computation: each takes memory and a place among the system's.
const MOST_THREADS: usize = 1024;

/// Starts no more threads than a system can bear, however many `RAYON_NUM_THREADS` asks for.
fn bound_threads() -> Result<(), Box<dyn Error>> {
    let wanted = std::env::var("RAYON_NUM_THREADS").ok().and_then(|text| text.parse::<usize>().ok()).unwrap_or(0);
    if wanted > MOST_THREADS {
        terminal::warn(&format!("RAYON_NUM_THREADS = {wanted}: expected at most {MOST_THREADS}, which are started"));
        rayon::ThreadPoolBuilder::new().num_threads(MOST_THREADS).build_global()?;
    }
    Ok(())
}

/// Executes the command of the command line.
fn run(arguments: Arguments) -> Result<u8, Box<dyn Error>> {
    terminal::set_verbosity(arguments.quiet, arguments.verbose);
    match arguments.command {
        Command::Simulate(command) => run_simulate(&command)?,
        Command::Calibrate(command) => return Ok(calibrate::calibrate(&command)?),
        Command::Compare(command) => compare::compare(&command)?,
        Command::Contact(command) => contact::contact(&command)?,
        Command::Converge(command) => return Ok(converge::converge(&command)?),
        Command::Rank(command) => return Ok(rank::rank(&command)?),
        Command::Plot(command) => plot::plot_files(&command)?,
        Command::Describe(command) => run_describe(&command)?,
        Command::Pack(command) => pack::pack(&command)?,
        Command::Verify(command) => return Ok(verify::verify(&command)?),
        Command::Fit(command) => return Ok(fit::fit(&command)?),
        Command::Material(command) => material::material(&command)?,
        Command::Reference => reference::reference(Arguments::command())?,
        Command::Completions(command) => reference::completions(&command, Arguments::command())?,
        Command::Manual(command) => reference::manual(&command, Arguments::command())?,
        Command::Report(command) => report::report(&command)?,
        Command::Slip(command) => slip::slip(&command)?,
        Command::Tir(command) => tir::tir(&command)?,
        Command::Surface(command) => surface::surface(&command)?,
        Command::Sweep(command) => sweep::sweep(&command)?,
    }
    Ok(output::SUCCESS)
}

/// A scene along its excitation, or a patch or a seal along a motion file.
fn run_simulate(command: &simulate::Simulate) -> Result<(), Box<dyn Error>> {
    match (&command.scene, &command.patch, &command.seal, &command.motion) {
        (Some(scene), ..) => simulate::simulate(command, scene)?,
        (_, Some(patch), _, Some(motion)) => moved::simulate_patch(command, patch, motion)?,
        (_, _, Some(seal), Some(motion)) => moved::simulate_seal(command, seal, motion)?,
        // The command line has a scene, or a patch or a seal with its motion.
        _ => (),
    }
    Ok(())
}

/// A scene, a patch or a seal.
fn run_describe(command: &describe::Describe) -> Result<(), Box<dyn Error>> {
    match (&command.scene, &command.patch, &command.seal) {
        (Some(scene), ..) => describe::describe(command, scene)?,
        (_, Some(patch), _) => describe::describe_patch(patch, &command.set)?,
        (_, _, Some(seal)) => describe::describe_seal(seal, &command.set)?,
        // The command line has one of them.
        _ => (),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
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
    fn usage_fits_a_screen() {
        let mut command = Arguments::command();
        command.build();
        for of in command.get_subcommands_mut() {
            let usage = of.render_usage().to_string();
            assert!(usage.lines().all(|line| line.len() <= 80), "{usage}");
        }
    }

    #[test]
    fn temperatures_below_zero_are_values() {
        for line in [
            "sweep s.toml --speeds 1 --pressures 1bar --temperatures -5°C,20°C",
            "material s.toml --temperature -5°C",
            "fit d.csv --reference -5°C -o c.csv",
        ] {
            let parsed = Arguments::try_parse_from(format!("asperity {line}").split_whitespace());
            assert!(parsed.is_ok(), "{line}: {}", parsed.unwrap_err());
        }
    }

    #[test]
    fn the_command_line_is_well_formed() {
        Arguments::command().debug_assert();
    }

    /// The page in docs is the one that the program makes: asperity reference > docs/reference.md.
    #[test]
    fn the_page_in_docs_is_that_of_the_tables() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/reference.md");
        let committed = std::fs::read_to_string(path).unwrap();
        let made = reference::page(Arguments::command());
        let different = committed.lines().zip(made.lines()).find(|(old, new)| old != new);
        assert!(committed == made, "run asperity reference > docs/reference.md: {different:?}");
    }
}
