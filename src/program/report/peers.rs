//! Lines of other programs, measured elsewhere: a CSV file with the columns of [`MEASURED`], others ignored.

use std::path::Path;

use super::ladder::{Figures, PROGRAM, Row};
use super::table::MEASURED;
use crate::program::result_file::{CsvFile, ResultFileError};

/// The peers' rows, and the scenes that the file has.
#[derive(Debug, Default)]
pub(super) struct Peers {
    /// The rows of the scene asked for.
    pub(super) rows: Vec<Row>,
    /// All scenes, each once.
    pub(super) scenes: Vec<String>,
}

/// Reads the rows of the scene that goes by one of `names`. Those of this program are left out: its own are measured
/// here.
pub(super) fn read(path: &Path, names: &[&str]) -> Result<Peers, ResultFileError> {
    let file = CsvFile::read(path)?;
    let mut columns = [0; MEASURED.len()];
    for (column, name) in columns.iter_mut().zip(MEASURED) {
        *column = file.column(name)?;
    }
    let mut peers = Peers::default();
    for record in file.records() {
        let fields = columns.map(|column| record.fields[column].as_str());
        if !peers.scenes.iter().any(|scene| scene == fields[0]) {
            peers.scenes.push(fields[0].to_owned());
        }
        if names.contains(&fields[0]) && fields[1] != PROGRAM {
            peers.rows.push(row(fields).map_err(|message| file.error(record, message))?);
        }
    }
    Ok(peers)
}

/// A row without a time is one of a run that did not come to its end.
fn row(
    [_, program, method, tolerance, x, z, lost, time, steps, events]: [&str; MEASURED.len()],
) -> Result<Row, String> {
    let tolerance = number(tolerance)?.ok_or("expected a tolerance, found none")?;
    let time = number(time)?;
    let figures = Figures {
        errors: [number(x)?, number(z)?, number(lost)?],
        time,
        steps: number(steps)?.map(|count| count as u64),
        events: number(events)?.map(|count| count as u64),
        ..Figures::default()
    };
    let result = if time.is_some() { Ok(figures) } else { Err("no run time".into()) };
    Ok(Row { program: program.into(), method: method.into(), tolerance, result })
}

/// A number; empty or not a number where there is none.
fn number(text: &str) -> Result<Option<f64>, String> {
    if text.is_empty() {
        return Ok(None);
    }
    let number: f64 = text.parse().map_err(|_| format!("expected a number, found {text:?}"))?;
    Ok(Some(number).filter(|number| !number.is_nan()))
}
