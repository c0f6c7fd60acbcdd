//! The tables as CSV files.

use std::path::Path;

use super::communication;
use super::ladder::Row;
use super::reference::Reference;
use super::stress::{Quantity, Stress};
use super::trace::{Errors, QUANTITIES};
use crate::program::error::ProgramError;
use crate::program::result_file::real;

/// Of errors and run times: errors over the largest value, processor time in s. Other programs' tables begin so too.
pub(super) const MEASURED: [&str; 10] = [
    "scene",
    "program",
    "method",
    "tolerance",
    "error_F_x",
    "error_F_z",
    "error_E_diss",
    "run_time",
    "steps",
    "events",
];

/// What this program adds to them.
const ADDED: [&str; 5] = ["rejected", "newton_iterations", "energy_residual", "below_reference", "failure"];

const COMMUNICATION: [&str; 14] = [
    "scene",
    "given",
    "communication_step",
    "error_F_x",
    "error_F_z",
    "error_E_diss",
    "mean_square_error_F_x",
    "mean_square_error_F_z",
    "mean_square_error_E_diss",
    "run_time",
    "steps",
    "events",
    "below_reference",
    "failure",
];

const STRESS: [&str; 16] = [
    "scene",
    "stiffness",
    "mass",
    "relaxation_times",
    "speed",
    "communication_step",
    "status",
    "reason",
    "error",
    "moved_start_changes",
    "energy_residual",
    "steps",
    "times_the_steps",
    "rejected",
    "events",
    "newton_iterations",
];

/// Writes the rows of errors and run times, the reference's own first.
pub(super) fn write_errors(path: &Path, scene: &str, reference: &Reference, rows: &[Row]) -> Result<(), ProgramError> {
    let own = reference.row();
    let records = std::iter::once(&own).chain(rows).map(|row| {
        let figures = row.result.as_ref().copied().unwrap_or_default();
        let mut fields = vec![scene.to_owned(), row.program.clone(), row.method.clone(), real(row.tolerance)];
        fields.extend(figures.errors.map(optional));
        fields.push(optional(figures.time));
        fields.extend([figures.steps, figures.events, figures.rejected, figures.iterations].map(count));
        fields.extend([optional(figures.residual), below(reference, &figures.errors)]);
        fields.push(row.result.as_ref().err().cloned().unwrap_or_default());
        fields
    });
    write(path, &[&MEASURED[..], &ADDED].concat(), records)
}

/// Writes the rows of errors and communication steps.
pub(super) fn write_communication(
    path: &Path,
    scene: &str,
    reference: &Reference,
    rows: &[communication::Row],
) -> Result<(), ProgramError> {
    let records = rows.iter().map(|row| {
        let (figures, mean_square) = row.result.clone().unwrap_or_default();
        let mut fields = vec![scene.to_owned(), row.given.name().to_owned(), optional(row.step)];
        fields.extend(figures.errors.map(optional));
        fields.extend(mean_square.unwrap_or_default().map(optional));
        fields.push(optional(figures.time));
        fields.extend([figures.steps, figures.events].map(count));
        fields.push(below(reference, &figures.errors));
        fields.push(row.result.as_ref().err().cloned().unwrap_or_default());
        fields
    });
    write(path, &COMMUNICATION, records)
}

/// Writes the cells of the scene under stress: the factors of what is scaled, and what became of each run.
pub(super) fn write_stress(path: &Path, scene: &str, stress: &Stress) -> Result<(), ProgramError> {
    let records = stress.cells().map(|(place, cell)| {
        let mut fields = vec![scene.to_owned()];
        fields.extend(Quantity::ALL.map(|quantity| optional(place.factor(quantity))));
        fields.extend([stress.status(cell).name().to_owned(), stress.reason(cell)]);
        let (error, moved) = cell.check().map_or((None, None), |check| (check.error(), check.moved()));
        let counts = cell.counts();
        let error = error.map(|error| error.share);
        fields.extend([error, moved, counts.map(|counts| counts.residual)].map(optional));
        fields.push(count(counts.map(|counts| counts.steps)));
        fields.push(optional(stress.times_the_steps(cell).map(short)));
        let rest = counts.map(|counts| [counts.rejected, counts.events, counts.iterations]);
        fields.extend([0, 1, 2].map(|i| count(rest.map(|rest| rest[i]))));
        fields
    });
    write(path, &STRESS, records)
}

/// As many digits as a ratio of counts is worth.
fn short(ratio: f64) -> f64 {
    const DIGITS: f64 = 1e4;
    (ratio * DIGITS).round() / DIGITS
}

fn write(path: &Path, head: &[&str], records: impl Iterator<Item = Vec<String>>) -> Result<(), ProgramError> {
    let failed = |error: csv::Error| ProgramError::file("write", path)(error.into());
    let mut writer = csv::Writer::from_path(path).map_err(failed)?;
    writer.write_record(head).map_err(failed)?;
    for record in records {
        writer.write_record(record).map_err(failed)?;
    }
    writer.flush().map_err(ProgramError::file("write", path))
}

fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, real)
}

fn count(value: Option<u64>) -> String {
    value.map_or_else(String::new, |count| count.to_string())
}

/// The quantities whose errors are below the reference's own.
fn below(reference: &Reference, errors: &Errors) -> String {
    let flags = reference.below(errors);
    let names = QUANTITIES.iter().zip(flags).filter(|(_, below)| *below).map(|(name, _)| *name);
    names.collect::<Vec<_>>().join(" ")
}
