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
//! | `output` | | outputs by their names, and errors of files |
//! | `interrupt` | output, terminal | what is left to do where the program is stopped |
//! | `draft` | interrupt, output | files that take their places whole |
//! | `files` | draft, output, terminal | scenes and other files that commands read and write |
//! | `lock` | interrupt, terminal | a table that one process writes at a time |
//! | `table_file` | draft, files, lock, output, terminal | tables that a stopped command goes on with, which add rows |
//! | `result_file` | draft | results of runs, row by row |
//! | `cli` | files | the command line: commands and their options |
//! | `picture` | files | draws pictures, as SVG or PNG |
//! | `plot` | cli, files, picture, terminal | `plot` |
//! | `elements` | files, npz | the masses of a run as arrays |
//! | `simulate` | cli, elements, files, picture, result_file, terminal | `simulate` of a scene |
//! | `patch` | cli, files, picture, result_file, simulate, terminal | `simulate` of a patch |
//! | `describe` | cli, files, picture, simulate, terminal | `describe` |
//! | `contact` | cli, files, npz, picture, terminal | `contact` |
//! | `sweep` | cli, files, interrupt, output, picture, table_file, terminal | `sweep` |
//! | `rank` | cli, files, picture, terminal | `rank` |
//! | `converge` | cli, files, interrupt, picture, table_file, terminal | `converge` |
//! | `fit` | cli, files, picture, terminal | `fit` |
//! | `calibrate` | cli, files, interrupt, picture, table_file, terminal | `calibrate` |
//! | `compare` | cli, files, picture, terminal | `compare` |
//! | `material` | cli, files, picture, terminal | `material` |
//! | `surface` | cli, files, picture, terminal | `surface` |
//! | `pack` | cli, files, picture, terminal | `pack` |
//! | `report` | cli, files, picture, terminal | `report` |
//! | `reference` | cli, files | the reference page, completions and manual pages |

mod calibrate;
mod cli;
mod compare;
mod contact;
mod converge;
mod describe;
mod draft;
mod elements;
mod files;
mod fit;
mod interrupt;
mod lock;
mod material;
mod npz;
mod output;
mod pack;
mod patch;
pub mod picture;
mod plot;
mod rank;
mod reference;
mod report;
mod result_file;
mod simulate;
mod surface;
mod sweep;
mod table_file;
mod terminal;

use std::error::Error;
use std::ffi::OsString;

use clap::Parser as _;
use cli::{Arguments, Command};

/// Exit status of a command that did what was asked for.
const SUCCESS: u8 = 0;
/// Exit status of one that did not.
const FAILURE: u8 = 1;
/// Exit status of one whose result is written and is to be looked at: it did not converge, or an error is larger than
/// asked for.
const NOT_REACHED: u8 = 3;

/// Exit status of one whose results nobody reads any more: 128 and the number of SIGPIPE.
const BROKEN_PIPE: u8 = 141;

/// Executes a command line, the program's name first; prints its results, and the error that ended it. Returns the exit
/// status. Does not return from `--help` and from a command line that cannot be understood.
pub fn execute(words: impl IntoIterator<Item = OsString>) -> u8 {
    match run(Arguments::parse_from(words)) {
        Ok(status) => status,
        Err(error) => {
            if output::is_broken_pipe(&*error) {
                return BROKEN_PIPE;
            }
            terminal::say(&error.to_string());
            FAILURE
        }
    }
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
        Command::Fit(command) => return Ok(fit::fit(&command)?),
        Command::Material(command) => material::material(&command)?,
        Command::Reference => reference::reference()?,
        Command::Completions(command) => reference::completions(&command)?,
        Command::Manual(command) => reference::manual(&command)?,
        Command::Report(command) => report::report(&command)?,
        Command::Surface(command) => surface::surface(&command)?,
        Command::Sweep(command) => sweep::sweep(&command)?,
    }
    Ok(SUCCESS)
}

/// A scene along its excitation, or a patch along a motion file.
fn run_simulate(command: &cli::Simulate) -> Result<(), Box<dyn Error>> {
    match (&command.scene, &command.patch, &command.motion) {
        (Some(scene), _, _) => simulate::simulate(command, scene)?,
        (None, Some(patch), Some(motion)) => patch::simulate(command, patch, motion)?,
        // The command line has a scene, or a patch and its motion.
        (None, _, _) => (),
    }
    Ok(())
}

/// A scene or a patch.
fn run_describe(command: &cli::Describe) -> Result<(), Box<dyn Error>> {
    match (&command.scene, &command.patch) {
        (Some(scene), _) => describe::describe(command, scene)?,
        (None, Some(patch)) => describe::describe_patch(patch, &command.set)?,
        // The command line has one of them.
        (None, None) => (),
    }
    Ok(())
}
