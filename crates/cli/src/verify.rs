//! `asperity verify`: whether an FMU is what this program packs.

use std::path::PathBuf;

use asperity_study::Error;
use asperity_study::pack::{self, LibraryFile};
use asperity_study::summary::labelled;
use clap::Args;

use super::cli::values::example;
use super::files::print;
use super::output::{NOT_REACHED, SUCCESS};
use super::terminal::lines;

#[derive(Debug, Args)]
#[command(after_help = example!("asperity verify block.fmu"))]
pub(crate) struct Verify {
    /// The FMU, of asperity pack.
    #[arg(value_name = "MODEL.fmu")]
    pub(crate) fmu: PathBuf,
}

/// Verifies an FMU and says what was found.
pub(crate) fn verify(command: &Verify) -> Result<u8, Error> {
    let own = LibraryFile::beside(&std::env::current_exe().unwrap_or_default());
    let found = pack::verify(&command.fmu, &[own])?;
    let verdict = match &found.carried {
        Ok(_) if found.problems.is_empty() && found.has_own_library => {
            "as this program packs it; its result is what the engine of this program gets"
        }
        Ok(_) if found.problems.is_empty() => {
            "as this program packs it, but for its library: the result is what the engine of this program gets, not shown of \
             that"
        }
        Ok(_) => "NOT as it was packed",
        Err(_) => "NOT shown to run as it should",
    };
    let mut rows = found.facts.clone();
    rows.extend(labelled("Differs", found.problems.iter().cloned()));
    rows.extend(labelled("Lacks", found.carried.as_ref().err().cloned()));
    rows.push(("Verdict", verdict.to_owned()));
    print(&lines(&rows))?;
    Ok(if found.is_as_packed() { SUCCESS } else { NOT_REACHED })
}
