//! Why a table, or a motion over it, is refused.

use std::path::{Path, PathBuf};

use super::grid::Load;
use crate::simulation::OutOfRange;

/// Why a table is refused: where, what was expected and what was found.
///
/// It reads like `table.csv:12: speed [m/s] = "fast": expected a number above 0`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}{}: {problem}", file.display(), line.map_or_else(String::new, |line| format!(":{line}")))]
pub struct TableError {
    file: PathBuf,
    line: Option<usize>,
    problem: String,
}

impl TableError {
    pub(super) fn new(file: &Path, line: Option<usize>, problem: String) -> Self {
        Self { file: file.to_owned(), line, problem }
    }
}

/// Why a motion of an element is refused; the element is then as it was.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ElementError {
    /// The carrier's motion is out of range, whatever the table.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// The carrier comes closer than the table goes.
    #[error(
        "w = {w} m at t = {time} s is a separation of {separation} m, a {} above {largest} {}, where the table ends: at {speed} m/s its \
         separations go down to {least} m (table.extrapolation = \"hold\" goes on beyond)",
        .load.name(), .load.unit()
    )]
    Pressure {
        /// When, s.
        time: f64,
        /// Where the carrier would be, m.
        w: f64,
        /// The separation there, m.
        separation: f64,
        /// The least separation of the table at this speed, m.
        least: f64,
        /// What the table's loads are.
        load: Load,
        /// The largest load of the table, Pa or N.
        largest: f64,
        /// The speed, m/s.
        speed: f64,
        /// Whether the carrier comes there within the step: a shorter one may end before.
        within: bool,
    },
    /// The carrier is faster than the table goes.
    #[error(
        "the speed is {speed} m/s at t = {time} s: the table goes from {least} to {largest} m/s (table.extrapolation = \"hold\" goes \
         on beyond)"
    )]
    Speed {
        /// When, s.
        time: f64,
        /// The speed, m/s.
        speed: f64,
        /// The least speed of the table, m/s.
        least: f64,
        /// The largest speed of the table, m/s.
        largest: f64,
    },
}

/// Why a run cannot be continued from a saved state.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RestoreError {
    /// A number that is not valid in any run.
    #[error("{what} = {value} is not a valid state")]
    Invalid {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The carrier is beyond the table.
    #[error(transparent)]
    BeyondTable(#[from] ElementError),
}
