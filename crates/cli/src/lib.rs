//! The commands of the program, one module each, and what they share.
//!
//! [`execute`] is the program. What its commands compute is in `asperity-study`.

mod calibrate;
mod cli;
mod compare;
mod contact;
mod converge;
mod describe;
mod draft;
mod elements;
mod figure;
mod files;
mod fit;
mod flags;
mod interrupt;
mod lock;
mod material;
mod measured_friction;
mod npz;
mod output;
mod pack;
mod patch;
mod reference;
mod report;
mod result_file;
mod resumable_table;
mod run_summary;
mod simulate;
mod surface;
mod sweep;
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

/// Executes a command line, the program's name first; prints its results, and the error that ended it. Returns the exit
/// status. Does not return from `--help` and from a command line that cannot be understood.
#[expect(clippy::print_stderr, reason = "the one place where the program prints the error that ended it")]
pub fn execute(words: impl IntoIterator<Item = OsString>) -> u8 {
    match run(Arguments::parse_from(words)) {
        Ok(status) => status,
        Err(error) => {
            eprintln!("asperity: {}", flags::with_flags(error));
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
        Command::Plot(command) => figure::plot_files(&command)?,
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
