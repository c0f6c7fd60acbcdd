//! `asperity sweep --merge`: the shards of a sweep in one table.

use std::path::{Path, PathBuf};

use super::error::SweepError;
use super::file::{self, describe};
use super::table::{Header, Line, Table};
use crate::program::error::ProgramError;

/// Joins the tables at `paths` into one at `output`. Returns it.
pub(super) fn merge(paths: &[PathBuf], output: &Path) -> Result<Table, ProgramError> {
    let tables: Vec<Table> = paths.iter().map(|path| file::read(path)).collect::<Result<_, _>>()?;
    for (path, table) in paths.iter().zip(&tables) {
        if let Some(what) = difference(&tables[0].header, &table.header) {
            return Err(SweepError::Different { first: paths[0].clone(), other: path.clone(), what }.into());
        }
    }
    let header = tables[0].header.clone();
    let mut found: Vec<(usize, Line)> = Vec::new();
    let (mut lines, mut missing) = (Vec::new(), Vec::new());
    for point in header.grid.points() {
        found.clear();
        for (i, table) in tables.iter().enumerate() {
            found.extend(table.lines.iter().filter(|line| line.point == point).map(|line| (i, line.clone())));
        }
        match found.first() {
            Some((first, line)) => {
                if let Some((other, _)) = found.iter().find(|(_, other)| other.text != line.text) {
                    let (first, other) = (paths[*first].clone(), paths[*other].clone());
                    return Err(SweepError::Twice { first, other, point: describe(&point, &header) }.into());
                }
                lines.push(line.clone());
            }
            None => missing.push(describe(&point, &header)),
        }
    }
    file::write_table(output, &header, lines.iter().map(|line| line.text.as_str()))?;
    if missing.is_empty() {
        return Ok(Table { header, lines });
    }
    let total = lines.len() + missing.len();
    Err(SweepError::Missing { missing, total, path: output.to_owned() }.into())
}

/// What of the headers of two tables differs.
fn difference(first: &Header, other: &Header) -> Option<String> {
    if first.fingerprint != other.fingerprint {
        return Some(format!("fingerprint {} and {}", first.fingerprint, other.fingerprint));
    }
    (first != other).then(|| "their points are not of one list".to_owned())
}
