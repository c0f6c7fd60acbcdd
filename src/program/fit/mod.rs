//! `asperity fit`: from measured moduli to the Prony terms of a compound.

mod compound;
mod measured;
mod nnls;
mod quantity;
mod search;
mod shift;
mod tell;

use std::path::PathBuf;

use super::cli::Fit;
use super::figure::Figure as _;
use super::files::{self, FileError, check_outputs, print};
use super::terminal::note;
use compound::{Errors, Sample};
use measured::{Measured, Refusal};
use search::{Wanted, search};
use tell::Told;

/// `asperity fit` failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum FitError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}:{refusal}", .path.display())]
    Moduli { path: PathBuf, refusal: Refusal },
    #[error(
        "the error asked for, {wanted}, cannot be had: {reached} is about the least of any series with moduli of 0 or more, \
         and {} has such a one; for less the data are too uneven, and --error takes what is enough",
        .output.display()
    )]
    NotReached { wanted: String, reached: String, output: PathBuf },
}

/// Reads, shifts, searches; writes the terms and the picture, prints the figures. Where the error asked for cannot be
/// had, the best fit is written all the same, and then the program fails: a script must not take it for what was asked.
pub(crate) fn fit(command: &Fit) -> Result<(), FitError> {
    let picture = command.plot.clone().unwrap_or_else(|| command.output.with_extension("svg"));
    check_outputs([&command.output, &picture], vec![command.data.clone()])?;
    let measured = Measured::read(&command.data, &command.ignore)?;
    measured.notes.iter().for_each(|text| note(text));
    let samples = shift::to_reference(&measured, command.wlf)
        .map_err(|refusal| FitError::Moduli { path: command.data.clone(), refusal })?;
    let told = told(command, &measured, samples);
    files::write(&command.output, told.file())?;
    told.picture().write(&picture)?;
    print(&told.text(&picture))?;
    let reached = told.errors.both.rms;
    if reached > command.error {
        let (wanted, reached) = (tell::share(command.error), tell::share(reached));
        return Err(FitError::NotReached { wanted, reached, output: command.output.clone() });
    }
    Ok(())
}

fn told<'a>(command: &'a Fit, measured: &'a Measured, samples: Vec<Sample>) -> Told<'a> {
    let exact = search(&samples, &Wanted { error: command.error, viscosity: command.viscosity });
    let compound = exact.rounded(Errors::of(&exact, &samples).both.rms);
    let errors = Errors::of(&compound, &samples);
    Told { command, measured, samples, compound, errors }
}
