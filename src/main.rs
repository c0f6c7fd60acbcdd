//! The command line program `asperity`; its commands are in [`program`].

mod program;

use std::process::ExitCode;

use clap::Parser;

use program::{Arguments, run};

#[expect(clippy::print_stderr, reason = "the one place where the program prints the error that ended it")]
fn main() -> ExitCode {
    match run(Arguments::parse()) {
        Ok(status) => status,
        Err(error) => {
            eprintln!("asperity: {error}");
            ExitCode::FAILURE
        }
    }
}
