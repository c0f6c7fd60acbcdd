//! The tables as CSV files.

use std::path::Path;

use super::communication;
use super::ladder::Row;
use super::reference::Reference;
use super::trace::{Errors, QUANTITIES};
use crate::program::error::ProgramError;
use crate::program::result_file::real;

const ERRORS: [&str; 15] = [
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
    "rejected",
    "newton_iterations",
    "energy_residual",
    "below_reference",
    "failure",
];

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
    write(path, &ERRORS, records)
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
