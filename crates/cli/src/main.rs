//! The command line program `asperity`; its commands are in [`asperity_cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    asperity_cli::execute(std::env::args_os()).into()
}
