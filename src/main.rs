//! The command line program `asperity`; its commands are in [`asperity::program`].

use std::process::ExitCode;

fn main() -> ExitCode {
    asperity::program::execute(std::env::args_os(), None).into()
}
