//! Why a sweep stops, or ends without all of its points.

use std::path::PathBuf;

/// Why a sweep stops.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SweepError {
    /// A pressure needs an area.
    #[error(
        "--pressures: the scene is in the direct form, which has no width and so no area: give --forces, F_z of the whole \
         layer in N"
    )]
    NoArea,
    /// No loads at all.
    #[error("expected --pressures or --forces, the loads to sweep over")]
    NoLoad,
    /// Temperatures need a shift.
    #[error("--temperatures: the scene has no material.wlf, so nothing in it depends on the temperature")]
    NoWlf,
    /// The file is something else.
    #[error("{} is no sweep's table: line {line}: expected {expected}{}", .path.display(), advice(*.is_output))]
    NoTable { path: PathBuf, line: usize, expected: String, is_output: bool },
    /// The file is of another sweep.
    #[error(
        "{} is the table of another sweep: its fingerprint is {found}, that of this scene with these settings {expected}; name \
         another -o, or give --force to replace it",
        .path.display()
    )]
    Foreign { path: PathBuf, found: String, expected: String },
    /// The file has points that this sweep has not.
    #[error(
        "{} has points that this sweep has not, the first at {point}: name their values, too, or another -o, or give --force to \
         replace the table",
        .path.display()
    )]
    Outside { path: PathBuf, point: String },
    /// A table to be joined is of another sweep.
    #[error("--merge: {} and {} are of different sweeps: {what}", .first.display(), .other.display())]
    Different { first: PathBuf, other: PathBuf, what: String },
    /// A point has two results.
    #[error("--merge: {} and {} differ at {point}", .first.display(), .other.display())]
    Twice { first: PathBuf, other: PathBuf, point: String },
    /// A joined table has gaps.
    #[error(
        "{} of {total} points are missing: {}; {} has the others, and `asperity sweep` with this -o goes on with it",
        .missing.len(), listed(.missing), .path.display()
    )]
    Missing { missing: Vec<String>, total: usize, path: PathBuf },
    /// Some points have no result to rely on.
    #[error("{failed} of {total} points are not steady or failed: their status in {} says why", .path.display())]
    Failed { failed: usize, total: usize, path: PathBuf },
}

/// What to do about a file in the table's place.
fn advice(is_output: bool) -> &'static str {
    if is_output { "; name another -o, or give --force to replace it" } else { "" }
}

/// The first of `points`, and how many more there are.
fn listed(points: &[String]) -> String {
    const SHOWN: usize = 10;
    let shown = points.iter().take(SHOWN).cloned().collect::<Vec<_>>().join("; ");
    match points.len().saturating_sub(SHOWN) {
        0 => shown,
        more => format!("{shown}; and {more} more"),
    }
}
