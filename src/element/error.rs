//! Why a table, or a motion over it, is refused.

use std::path::{Path, PathBuf};

use super::grid::Load;
use crate::simulation::OutOfRange;

/// Why a table is refused: what was expected, what was found, and where.
///
/// It reads like `table.csv:12: speed [m/s] = "fast": expected a number above 0`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}{}: {problem}", file.display(), line.map_or_else(String::new, |line| format!(":{line}")))]
pub struct TableError {
    file: PathBuf,
    line: Option<usize>,
    problem: TableProblem,
}

impl TableError {
    pub(super) fn new(file: &Path, line: Option<usize>, problem: TableProblem) -> Self {
        Self { file: file.to_owned(), line, problem }
    }

    /// What is wrong.
    pub fn problem(&self) -> &TableProblem {
        &self.problem
    }
}

/// What is wrong with a table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TableProblem {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// The file is not the table of a sweep, or is one of another version.
    #[error("not the table of a sweep: expected the line `# asperity sweep = 1`, found {0}")]
    Format(String),
    /// A line of the header is missing or says something else.
    #[error("`# {key} = {found}`: expected {expected}")]
    Header {
        /// Its key.
        key: &'static str,
        /// Its value; empty where there is no such line.
        found: String,
        /// What is expected.
        expected: &'static str,
    },
    /// A column is missing.
    #[error("no column `{0}`")]
    NoColumn(String),
    /// The columns are not those that a sweep writes.
    #[error("expected the columns {0}")]
    Columns(String),
    /// A row has more or fewer fields than there are columns.
    #[error("{found} fields, expected {expected}")]
    Fields {
        /// How many there are.
        found: usize,
        /// How many columns there are.
        expected: usize,
    },
    /// A field is not what its column holds.
    #[error("{column} = \"{found}\": expected {expected}")]
    Field {
        /// The column with its unit.
        column: String,
        /// What stands there.
        found: String,
        /// What is expected.
        expected: &'static str,
    },
    /// Two rows of one point.
    #[error("a second row of {0}")]
    Twice(String),
    /// Points that failed or were never steady.
    #[error("{}; an element needs every point of the table: sweep them again, or leave a speed, a pressure or a \
             temperature out", some_of(.0))]
    NotSteady(Vec<String>),
    /// Points that have no row.
    #[error("no row of {}; an element needs every point of the table", some_of(.0))]
    Missing(Vec<String>),
    /// Too few loads to interpolate between.
    #[error("{found} values of the {load}, expected at least two: the normal stiffness is the slope between them")]
    Loads {
        /// `pressure` or `force`.
        load: &'static str,
        /// How many there are.
        found: usize,
    },
    /// The carrier does not come closer as it presses harder.
    #[error("separation = {here} m at {point}, but {before} m at the {load} below: expected a smaller one")]
    Separation {
        /// `pressure` or `force`.
        load: &'static str,
        /// Where.
        point: String,
        /// The separation there, m.
        here: f64,
        /// The separation at the load below, m.
        before: f64,
    },
}

/// The first of `texts`, and how many more there are.
fn some_of(texts: &[String]) -> String {
    const SHOWN: usize = 6;
    let shown = texts.iter().take(SHOWN).map(String::as_str).collect::<Vec<_>>().join("; ");
    match texts.len().saturating_sub(SHOWN) {
        0 => shown,
        more => format!("{shown}; {more} more"),
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
