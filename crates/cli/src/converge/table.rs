//! The table of a study: rows are added as their runs are done and not computed again.

use std::path::{Path, PathBuf};

use asperity::element::PointStatus;
use asperity::tables;

use super::ConvergeError;
use super::variants::{Dimensions, Parts, Variant};
use super::verdict::Pair;
use crate::files::{FileError, write};
use crate::resumable_table::ResumableTable;
use crate::terminal::warn;
use asperity_study::decimals::real;
use asperity_study::steady::persson::Theory;

/// The first line of a table; its number grows when readers have to know of a change.
const FORMAT: &str = "# asperity converge = 3";

/// The columns; the fifth is called as what it counts.
const COLUMNS: [&str; 25] = [
    "halvings [1]",
    "length_factor [1]",
    "seed_shift [1]",
    "split_factor [1]",
    "masses [1]",
    "spacing [m]",
    "length [m]",
    "seed [1]",
    "split [m]",
    "status",
    "fit_rms [1]",
    "friction [1]",
    "friction_standard_error [1]",
    "friction_change [1]",
    "hysteresis [1]",
    "area [1]",
    "area_standard_error [1]",
    "area_change [1]",
    "persson_area_1d [1]",
    "persson_friction_1d [1]",
    "persson_friction_1d_reduced [1]",
    "persson_area_2d [1]",
    "persson_friction_2d [1]",
    "persson_friction_2d_reduced [1]",
    "run_time [s]",
];

/// What a run measured, with the standard errors of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    pub(super) mean: Pair,
    pub(super) error: Pair,
    /// Part of the friction coefficient that is hysteresis, 1: what Persson's theory gives.
    pub(super) hysteresis: f64,
}

/// A run that was made.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RunRow {
    pub(super) variant: Variant,
    pub(super) dimensions: Dimensions,
    /// Root mean square of r - 1, 1: how far the links miss the surface that they stand for; `None` without links.
    pub(super) fit_rms: Option<f64>,
    /// What was measured, or why nothing was.
    pub(super) outcome: Result<Measured, String>,
    /// Persson's theory of ridges and of an isotropic surface.
    pub(super) theories: [Theory; 2],
    /// Processor time, s.
    pub(super) run_time: f64,
}

impl RunRow {
    /// Friction and area; `None` of a run that did not become steady.
    pub(super) fn mean(&self) -> Option<Pair> {
        self.outcome.as_ref().ok().map(|measured| measured.mean)
    }

    /// The row's line, its end included; `change` is that of the values from another run to this one.
    fn line(&self, change: Option<Pair>) -> String {
        let Dimensions { count, spacing, seed, split: longest } = self.dimensions;
        let status = PointStatus::new(self.outcome.as_ref().err());
        let measured = self.outcome.as_ref().ok();
        let text = |value: Option<f64>| value.map(real).unwrap_or_default();
        let of = |value: fn(&Pair) -> f64| {
            [
                measured.map(|run| value(&run.mean)),
                measured.map(|run| value(&run.error)),
                change.map(|pair| value(&pair)),
            ]
        };
        let Variant { halvings, doubled, seed_shift, split } = self.variant;
        let dimensions = [
            halvings.to_string(),
            if doubled { "2" } else { "1" }.to_owned(),
            seed_shift.to_string(),
            if split { "0.5" } else { "1" }.to_owned(),
            count.to_string(),
            real(spacing),
            real(self.dimensions.length()),
            seed.map(|seed| seed.to_string()).unwrap_or_default(),
            text(longest),
            tables::quoted(status.text()),
            text(self.fit_rms),
        ];
        let [friction, area] = [of(|pair| pair.friction), of(|pair| pair.area)];
        let values = [&friction[..], &[measured.map(|run| run.hysteresis)], &area].concat();
        let theories = self.theories.iter().flat_map(|theory| theory.values().map(Some));
        let numbers = values.into_iter().chain(theories).chain([Some(self.run_time)]).map(text);
        dimensions.into_iter().chain(numbers).collect::<Vec<_>>().join(",") + "\n"
    }

    /// The run of a row; `None` where a field is not what it should be.
    fn from_fields(fields: &[impl AsRef<str>]) -> Option<Self> {
        if fields.len() != COLUMNS.len() {
            return None;
        }
        let text = |i: usize| fields.get(i).map(AsRef::as_ref).unwrap_or_default();
        let number = |i: usize| text(i).parse::<f64>().ok().filter(|number| number.is_finite());
        let theory =
            |i: usize| Some(Theory { area: number(i)?, friction: number(i + 1)?, friction_reduced: number(i + 2)? });
        let whole = |i: usize| text(i).parse::<u64>().ok();
        let small = |i: usize| text(i).parse::<u32>().ok();
        let optional = |i: usize| if text(i).is_empty() { Some(None) } else { Some(Some(number(i)?)) };
        let seed = if text(7).is_empty() { None } else { Some(whole(7)?) };
        let pair = |friction: usize, area: usize| Some(Pair { friction: number(friction)?, area: number(area)? });
        let outcome = match PointStatus::read(text(9)) {
            PointStatus::Steady => Ok(Measured { mean: pair(11, 15)?, error: pair(12, 16)?, hysteresis: number(14)? }),
            PointStatus::Problem(problem) => Err(problem),
        };
        Some(Self {
            variant: Variant {
                halvings: small(0)?,
                doubled: text(1) == "2",
                seed_shift: small(2)?,
                split: text(3) == "0.5",
            },
            dimensions: Dimensions { count: whole(4)?, spacing: number(5)?, seed, split: optional(8)? },
            fit_rms: optional(10)?,
            outcome,
            theories: [theory(18)?, theory(21)?],
            run_time: number(24)?,
        })
    }
}

/// What a table says before its rows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StudyHeader {
    /// The name of the scene.
    pub(super) scene: String,
    /// What tells this study from others.
    pub(super) fingerprint: String,
    /// How steady sliding is found.
    pub(super) method: String,
    pub(super) parts: Parts,
    /// The mean pressure of the runs, Pa.
    pub(super) pressure: f64,
    /// The speed of the runs, m/s.
    pub(super) speed: f64,
    pub(super) error: f64,
}

impl StudyHeader {
    /// The lines of the header, the names of the columns included; once there is one, the verdict.
    fn text(&self, verdict: Option<&str>) -> String {
        let mut lines = vec![
            FORMAT.to_owned(),
            format!("# scene = {}", self.scene),
            format!("# fingerprint = {}", self.fingerprint),
            format!("# method = {}", self.method),
            format!("# pressure = {} Pa", real(self.pressure)),
            format!("# speed = {} m/s", real(self.speed)),
            format!("# error = {}", real(self.error)),
        ];
        lines.extend(verdict.map(|verdict| format!("# verdict = {verdict}")));
        lines.push(self.columns());
        lines.join("\n") + "\n"
    }

    fn columns(&self) -> String {
        COLUMNS.join(",").replace("masses", self.parts.name())
    }
}

/// A table to which rows are added.
#[derive(Debug)]
pub(super) struct Table {
    path: PathBuf,
    header: StudyHeader,
    rows: ResumableTable,
}

impl Table {
    /// Begins a table or, unless it is to be replaced, continues the one that is there. Returns the runs that it has.
    pub(super) fn open(path: &Path, header: StudyHeader, force: bool) -> Result<(Self, Vec<RunRow>), ConvergeError> {
        let read = |text: &str| runs_done(text, path, &header);
        let (rows, runs) = ResumableTable::open(path, &header.text(None), force, read, |run| run.line(None))?;
        Ok((Self { path: path.to_owned(), header, rows }, runs))
    }

    /// Adds a row; it is in the file when this returns.
    pub(super) fn add(&self, run: &RunRow) -> Result<(), FileError> {
        self.rows.add(&run.line(None))
    }

    /// Writes the whole table with the changes of the values, which rows that were added do not have.
    pub(super) fn finish(&self, verdict: &str, rows: &[(&RunRow, Option<Pair>)]) -> Result<(), FileError> {
        let rows: String = rows.iter().map(|(run, change)| run.line(*change)).collect();
        write(&self.path, self.header.text(Some(verdict)) + &rows)
    }
}

/// The runs of the table at `path`, which is the `text`, without the corrupt rows, which are named.
fn runs_done(text: &str, path: &Path, header: &StudyHeader) -> Result<Vec<RunRow>, ConvergeError> {
    let not_a_table = |problem: String| ConvergeError::NotATable { path: path.to_owned(), problem };
    let mut rows = tables::rows(text, Some(','));
    if !text.starts_with(FORMAT) || rows.next().is_none_or(|names| names.fields.len() != COLUMNS.len()) {
        return Err(not_a_table(format!("expected the line `{FORMAT}` and the columns {}", header.columns())));
    }
    let key = format!("# fingerprint = {}", header.fingerprint);
    if !text.lines().any(|line| line == key) {
        return Err(ConvergeError::OtherStudy { path: path.to_owned() });
    }
    let mut runs: Vec<RunRow> = Vec::new();
    for row in rows {
        match RunRow::from_fields(&row.fields).filter(|run| runs.iter().all(|other| other.variant != run.variant)) {
            Some(run) => runs.push(run),
            None => warn(&format!("{}:{}: not a row of this study; the run is made again", path.display(), row.line)),
        }
    }
    Ok(runs)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(outcome: Result<Measured, String>) -> RunRow {
        let theory = |area: f64| Theory { area, friction: 0.1 / 3.0, friction_reduced: 1e-7 };
        let dimensions = Dimensions { count: 64, spacing: 1e-4 / 3.0, seed: Some(u64::MAX), split: Some(2e-3) };
        let variant = Variant { halvings: 3, doubled: true, seed_shift: 2, split: true };
        RunRow {
            variant,
            dimensions,
            fit_rms: Some(0.25),
            outcome,
            theories: [theory(0.1), theory(0.2)],
            run_time: 12.5,
        }
    }

    #[test]
    fn rows_read_back_as_they_were_written() {
        let pair = |friction: f64, area: f64| Pair { friction, area };
        let (mean, error) = (pair(0.1 + 0.2, 0.125), pair(1e-9, 0.0));
        let steady = run(Ok(Measured { mean, error, hysteresis: 0.1 }));
        let failed = run(Err("not steady after 0.5 m, at all: \"never\"".into()));
        let seedless = Dimensions { seed: None, split: None, ..steady.dimensions };
        for run in [steady.clone(), failed, RunRow { dimensions: seedless, fit_rms: None, ..steady }] {
            for change in [None, Some(pair(-0.5, 0.25))] {
                let line = run.line(change);
                let row = tables::rows(&line, Some(',')).next().unwrap();
                assert_eq!((row.fields.len(), RunRow::from_fields(&row.fields)), (COLUMNS.len(), Some(run.clone())));
            }
        }
        assert_eq!(RunRow::from_fields(&["64"; COLUMNS.len() - 1]), None);
    }
}
