//! `asperity fit`: from measured moduli to the Prony terms of a compound.

mod compound;
mod measured;
mod nnls;
mod quantity;
mod search;
mod shift;
mod tell;

use std::fs;

use compound::{Errors, Sample};
use measured::Measured;
pub(crate) use measured::Refusal;
use search::{Wanted, search};

use super::arguments::Fit;
use super::error::ProgramError;
use super::text::print;
use tell::Told;

/// Reads, shifts, searches; writes the terms and the picture, prints the figures. Where the error asked for cannot be
/// had, the best fit is written all the same, and then the program fails: a script must not take it for what was asked.
pub(crate) fn fit(command: &Fit) -> Result<(), ProgramError> {
    let picture = command.plot.clone().unwrap_or_else(|| command.output.with_extension("svg"));
    super::check_output(&command.output, std::slice::from_ref(&command.data))?;
    super::check_output(&picture, &[command.data.clone(), command.output.clone()])?;
    let measured = Measured::read(&command.data, &command.ignore)?;
    measured.notes.iter().for_each(|text| super::note(text));
    let samples = shift::to_reference(&measured, command.wlf)
        .map_err(|refusal| ProgramError::Moduli { path: command.data.clone(), refusal })?;
    let told = told(command, &measured, samples);
    fs::write(&command.output, told.file()).map_err(ProgramError::file("write", &command.output))?;
    told.picture().write(&picture)?;
    print(&told.text(&picture))?;
    let reached = told.errors.both.rms;
    if reached > command.error {
        let (wanted, reached) = (tell::share(command.error), tell::share(reached));
        return Err(ProgramError::FitError { wanted, reached, output: command.output.clone() });
    }
    Ok(())
}

fn told<'a>(command: &'a Fit, measured: &'a Measured, samples: Vec<Sample>) -> Told<'a> {
    let exact = search(&samples, &Wanted { error: command.error, viscosity: command.viscosity });
    let compound = exact.rounded(Errors::of(&exact, &samples).both.rms);
    let errors = Errors::of(&compound, &samples);
    Told { command, measured, samples, compound, errors }
}
