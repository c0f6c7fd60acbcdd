//! Why a table, or a motion over it, is refused.

use std::path::{Path, PathBuf};

use super::table::{Load, Place};
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

/// What is wrong with a table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TableProblem {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// The file is no table of a sweep, or of another version.
    #[error("no table of a sweep: expected the line `# asperity sweep = 1`, found {0}")]
    Format(String),
    /// A line at the top that has to be there is not, or says something else.
    #[error("`# {key} = {found}`: expected {expected}")]
    Header {
        /// Its key.
        key: &'static str,
        /// Its value; empty where there is no such line.
        found: String,
        /// What is expected.
        expected: &'static str,
    },
    /// A column that has to be there is not.
    #[error("no column `{0}`")]
    NoColumn(String),
    /// A row with more or fewer fields than there are columns.
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
    Twice(Place),
    /// Points that failed or were never steady.
    #[error("{}; an element needs every point of the table: sweep them again, or leave a speed, a pressure or a \
             temperature out", list(.0.iter().map(|(place, status)| format!("{place} is not steady: {status}"))))]
    NotSteady(Vec<(Place, String)>),
    /// Points that have no row.
    #[error("no row of {}; an element needs every point of the table", list(.0.iter().map(ToString::to_string)))]
    Missing(Vec<Place>),
    /// Too few values of an axis to interpolate along it.
    #[error("{found} values of the {load}, expected at least two: the normal stiffness is the slope between them")]
    Pressures {
        /// Pressure or force.
        load: &'static str,
        /// How many there are.
        found: usize,
    },
    /// The carrier does not come closer as it presses harder.
    #[error("separation = {here} m at {place}, but {before} m at the {load} below: expected a smaller one")]
    Separation {
        /// Pressure or force.
        load: &'static str,
        /// Where.
        place: Place,
        /// The separation there, m.
        here: f64,
        /// The separation at the pressure below, m.
        before: f64,
    },
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

/// The most that a list names.
const NAMED: usize = 6;

fn list(texts: impl ExactSizeIterator<Item = String>) -> String {
    let rest = texts.len().saturating_sub(NAMED);
    let mut named: Vec<String> = texts.take(NAMED).collect();
    if rest > 0 {
        named.push(format!("{rest} more"));
    }
    named.join("; ")
}

/// Why an element cannot be where its carrier would be; it is then as it was.
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
        /// The largest pressure of the table, Pa, or force, N.
        largest: f64,
        /// The speed, m/s.
        speed: f64,
        /// Whether the carrier comes there within the step: a shorter one may end before.
        within: bool,
    },
    /// The carrier is faster than the table goes.
    #[error(
        "the speed is {speed} m/s at t = {time} s: the table goes from {} to {} m/s (table.extrapolation = \"hold\" goes on beyond)",
        range.0, range.1
    )]
    Speed {
        /// When, s.
        time: f64,
        /// The speed, m/s.
        speed: f64,
        /// The least and the largest speed of the table, m/s.
        range: (f64, f64),
    },
}

/// Why a run cannot go on from what was saved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RestoreError {
    /// No run gets to such a number.
    #[error("{what} = {value}, which no run gets to")]
    Number {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The run stands where the table does not go.
    #[error(transparent)]
    Place(#[from] ElementError),
}
