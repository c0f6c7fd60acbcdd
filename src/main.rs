//! The command line program: `asperity simulate`, `sweep`, `plot`, `describe`, `pack`, `fit`, `material`, `surface` and
//! `report`.

mod program;

use std::process::ExitCode;

use clap::Parser;

use program::{Arguments, run};

#[expect(clippy::print_stderr, reason = "the one place where the program says why it stopped")]
fn main() -> ExitCode {
    match run(Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("asperity: {error}");
            ExitCode::FAILURE
        }
    }
}
