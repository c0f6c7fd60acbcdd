//! The table of a study: rows are added as their runs are done and not computed again.

use asperity::element::PointStatus;
use asperity::tables;

use super::variants::{Dimensions, Parts, Variant};
use super::verdict::Pair;
use crate::decimals::real;
use crate::steady::persson::Theory;

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
pub struct Measured {
    /// Friction and area.
    pub mean: Pair,
    /// Their standard errors.
    pub error: Pair,
    /// Part of the friction coefficient that is hysteresis, 1: what Persson's theory gives.
    pub hysteresis: f64,
}

/// A run that was made.
#[derive(Clone, Debug, PartialEq)]
pub struct RunRow {
    /// What differs from the scene.
    pub variant: Variant,
    /// Its spacing, length and seed.
    pub dimensions: Dimensions,
    /// Root mean square of r - 1, 1: how far the links miss the surface that they stand for; `None` without links.
    pub fit_rms: Option<f64>,
    /// Whether the layer slid steadily, or why not.
    pub status: PointStatus,
    /// What was measured where it did.
    pub measured: Option<Measured>,
    /// Persson's theory of ridges and of an isotropic surface.
    pub theories: [Theory; 2],
    /// Processor time, s.
    pub run_time: f64,
}

impl RunRow {
    /// Friction and area; `None` of a run that did not become steady.
    pub fn mean(&self) -> Option<Pair> {
        self.measured.map(|measured| measured.mean)
    }

    /// The row's line, its end included; `change` is that of the values from another run to this one.
    pub fn line(&self, change: Option<Pair>) -> String {
        let Dimensions { count, spacing, seed, split: longest } = self.dimensions;
        let measured = self.measured.as_ref();
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
            tables::quoted(self.status.text()),
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
        let status = PointStatus::read(text(9));
        let measured = match &status {
            PointStatus::Steady | PointStatus::FullContact => {
                Some(Measured { mean: pair(11, 15)?, error: pair(12, 16)?, hysteresis: number(14)? })
            }
            PointStatus::Problem(_) => None,
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
            status,
            measured,
            theories: [theory(18)?, theory(21)?],
            run_time: number(24)?,
        })
    }
}

/// What a table says before its rows.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyHeader {
    /// The name of the scene.
    pub scene: String,
    /// What tells this study from others.
    pub fingerprint: String,
    /// How steady sliding is found.
    pub method: String,
    /// What is counted.
    pub parts: Parts,
    /// The mean pressure of the runs, Pa.
    pub pressure: f64,
    /// The speed of the runs, m/s.
    pub speed: f64,
    /// The way that rubber as warm as the scene has slid, m; `None`: its surface is as warm.
    pub way: Option<f64>,
    /// The change of friction and area that is small enough, as a share of them.
    pub error: f64,
}

impl StudyHeader {
    /// The lines of the header, the names of the columns included; once there is one, the verdict.
    pub fn text(&self, verdict: Option<&str>) -> String {
        let mut lines = vec![
            FORMAT.to_owned(),
            format!("# scene = {}", self.scene),
            format!("# fingerprint = {}", self.fingerprint),
            format!("# method = {}", self.method),
            format!("# pressure = {} Pa", real(self.pressure)),
            format!("# speed = {} m/s", real(self.speed)),
            format!("# error = {}", real(self.error)),
        ];
        lines.extend(self.way.map(|way| format!("# way = {} m", real(way))));
        lines.extend(verdict.map(|verdict| format!("# verdict = {verdict}")));
        lines.push(self.columns());
        lines.join("\n") + "\n"
    }

    fn columns(&self) -> String {
        COLUMNS.join(",").replace("masses", self.parts.name())
    }
}

/// The runs of a table that was begun.
#[derive(Clone, Debug, PartialEq)]
pub struct RunsDone {
    /// The runs.
    pub runs: Vec<RunRow>,
    /// The lines that are no rows of the study.
    pub corrupt: Vec<usize>,
}

/// A text is not the table of a study.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StudyTableError {
    /// It is no such table.
    #[error("{0}")]
    NotATable(String),
    /// It is of another scene, pressure, speed, error or distance.
    #[error("the table of another study")]
    OtherStudy,
}

impl StudyHeader {
    /// The runs in the `text` of a table of the study.
    ///
    /// # Errors
    /// Where it is not that.
    pub fn runs_done(&self, text: &str) -> Result<RunsDone, StudyTableError> {
        let mut rows = tables::rows(text, Some(','));
        if !text.starts_with(FORMAT) || rows.next().is_none_or(|names| names.fields.len() != COLUMNS.len()) {
            let problem = format!("expected the line `{FORMAT}` and the columns {}", self.columns());
            return Err(StudyTableError::NotATable(problem));
        }
        let key = format!("# fingerprint = {}", self.fingerprint);
        if !text.lines().any(|line| line == key) {
            return Err(StudyTableError::OtherStudy);
        }
        let mut done = RunsDone { runs: Vec::new(), corrupt: Vec::new() };
        for row in rows {
            let is_new = |run: &RunRow| done.runs.iter().all(|other| other.variant != run.variant);
            match RunRow::from_fields(&row.fields).filter(is_new) {
                Some(run) => done.runs.push(run),
                None => done.corrupt.push(row.line),
            }
        }
        Ok(done)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(status: PointStatus, measured: Option<Measured>) -> RunRow {
        let theory = |area: f64| Theory { area, friction: 0.1 / 3.0, friction_reduced: 1e-7 };
        let dimensions = Dimensions { count: 64, spacing: 1e-4 / 3.0, seed: Some(u64::MAX), split: Some(2e-3) };
        let variant = Variant { halvings: 3, doubled: true, seed_shift: 2, split: true };
        RunRow {
            variant,
            dimensions,
            fit_rms: Some(0.25),
            status,
            measured,
            theories: [theory(0.1), theory(0.2)],
            run_time: 12.5,
        }
    }

    #[test]
    fn rows_read_back_as_they_were_written() {
        let pair = |friction: f64, area: f64| Pair { friction, area };
        let (mean, error) = (pair(0.1 + 0.2, 0.125), pair(1e-9, 0.0));
        let steady = run(PointStatus::Steady, Some(Measured { mean, error, hysteresis: 0.1 }));
        let failed = run(PointStatus::Problem("not steady after 0.5 m, at all: \"never\"".into()), None);
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
