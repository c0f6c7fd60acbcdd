//! The table of a study: rows are added as their runs are done and not computed again.

use asperity::element::PointStatus;
use asperity::table::{Cell, Column, Header, Table, TableError};

use super::plan::Pair;
use super::variants::{Dimensions, Parts, Variant};
use crate::steady::persson::Theory;

/// The kind of the table; its number grows when readers have to know of a change.
const KIND: (&str, u64) = ("asperity converge", 3);

/// The columns with their units; the fifth is called as what it counts.
const COLUMNS: [(&str, &str); 25] = [
    ("halvings", "1"),
    ("length_factor", "1"),
    ("seed_shift", "1"),
    ("split_factor", "1"),
    ("masses", "1"),
    ("spacing", "m"),
    ("length", "m"),
    ("seed", "1"),
    ("split", "m"),
    ("status", ""),
    ("fit_rms", "1"),
    ("friction", "1"),
    ("friction_standard_error", "1"),
    ("friction_change", "1"),
    ("hysteresis", "1"),
    ("area", "1"),
    ("area_standard_error", "1"),
    ("area_change", "1"),
    ("persson_area_1d", "1"),
    ("persson_friction_1d", "1"),
    ("persson_friction_1d_reduced", "1"),
    ("persson_area_2d", "1"),
    ("persson_friction_2d", "1"),
    ("persson_friction_2d_reduced", "1"),
    ("run_time", "s"),
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

    /// The row's cells; `change` is that of the values from another run to this one.
    pub fn cells(&self, change: Option<Pair>) -> Vec<Cell> {
        let Dimensions { count, spacing, seed, split: longest } = self.dimensions;
        let measured = self.measured.as_ref();
        let of = |value: fn(&Pair) -> f64| {
            [
                measured.map(|run| value(&run.mean)),
                measured.map(|run| value(&run.error)),
                change.map(|pair| value(&pair)),
            ]
        };
        let Variant { halvings, doubled, seed_shift, split } = self.variant;
        let dimensions: [Cell; 11] = [
            f64::from(halvings).into(),
            if doubled { 2.0 } else { 1.0 }.into(),
            f64::from(seed_shift).into(),
            if split { 0.5 } else { 1.0 }.into(),
            (count as f64).into(),
            spacing.into(),
            self.dimensions.length().into(),
            // Of 64 bits.
            seed.map(|seed| seed.to_string()).unwrap_or_default().into(),
            longest.into(),
            self.status.text().into(),
            self.fit_rms.into(),
        ];
        let [friction, area] = [of(|pair| pair.friction), of(|pair| pair.area)];
        let values = [&friction[..], &[measured.map(|run| run.hysteresis)], &area].concat();
        let theories = self.theories.iter().flat_map(|theory| theory.values().map(Some));
        let numbers = values.into_iter().chain(theories).chain([Some(self.run_time)]).map(Cell::from);
        dimensions.into_iter().chain(numbers).collect()
    }

    /// The run of a row; `None` where a field is not what it should be.
    fn read(table: &Table, row: usize, parts: Parts) -> Option<Self> {
        let optional = |name: &str, unit: &str| table.number(row, name, unit).ok();
        let number = |name: &str| optional(name, "1")?;
        let whole = |name: &str| number(name).filter(|number| number.fract() == 0.0 && *number >= 0.0);
        let theory = |of: &str| {
            let values = ["area", "friction"].map(|what| number(&format!("persson_{what}_{of}")));
            let [area, friction] = values;
            let friction_reduced = number(&format!("persson_friction_{of}_reduced"))?;
            Some(Theory { area: area?, friction: friction?, friction_reduced })
        };
        let pair = |friction: &str, area: &str| Some(Pair { friction: number(friction)?, area: number(area)? });
        let status = PointStatus::read(&table.word(row, "status", "").ok()?);
        let measured = match &status {
            PointStatus::Steady | PointStatus::FullContact => Some(Measured {
                mean: pair("friction", "area")?,
                error: pair("friction_standard_error", "area_standard_error")?,
                hysteresis: number("hysteresis")?,
            }),
            PointStatus::Problem(_) => None,
        };
        let seed = table.word(row, "seed", "1").ok()?;
        Some(Self {
            variant: Variant {
                halvings: whole("halvings")? as u32,
                doubled: number("length_factor")? == 2.0,
                seed_shift: whole("seed_shift")? as u32,
                split: number("split_factor")? == 0.5,
            },
            dimensions: Dimensions {
                count: whole(parts.name())? as u64,
                spacing: optional("spacing", "m")??,
                seed: if seed.is_empty() { None } else { Some(seed.parse().ok()?) },
                split: optional("split", "m")?,
            },
            fit_rms: optional("fit_rms", "1")?,
            status,
            measured,
            theories: [theory("1d")?, theory("2d")?],
            run_time: optional("run_time", "s")??,
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
    /// The table without rows; once there is one, with the verdict.
    pub fn table(&self, verdict: Option<&str>) -> Table {
        let mut header = Header::new(KIND)
            .with("scene", &self.scene)
            .with("fingerprint", &self.fingerprint)
            .with("method", &self.method)
            .with_number("pressure", self.pressure, "Pa")
            .with_number("speed", self.speed, "m/s")
            .with_number("error", self.error, "");
        if let Some(way) = self.way {
            header = header.with_number("way", way, "m");
        }
        let column = |(name, unit): (&'static str, &'static str)| match name {
            "masses" => Column::numbers(self.parts.name(), unit),
            "status" | "seed" => Column::words(name, unit),
            _ => Column::numbers(name, unit),
        };
        Table::new(header.with_some("verdict", verdict), COLUMNS.map(column))
    }

    /// The runs of a table of the study; the error of a row that is none of it, or that is there already.
    pub fn runs(&self, table: &Table) -> Vec<Result<RunRow, TableError>> {
        let mut variants = Vec::new();
        let run = |row: usize| {
            let new = RunRow::read(table, row, self.parts).filter(|run| !variants.contains(&run.variant));
            let run = new.ok_or_else(|| table.error_in(row, "not a row of this study"))?;
            variants.push(run.variant);
            Ok(run)
        };
        (0..table.len()).map(run).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

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
        let header = StudyHeader {
            scene: "a".into(),
            fingerprint: "f".into(),
            method: "layer".into(),
            parts: Parts::Masses,
            pressure: 1e5,
            speed: 0.1,
            way: None,
            error: 0.01,
        };
        for run in [steady.clone(), failed, RunRow { dimensions: seedless, fit_rms: None, ..steady }] {
            for change in [None, Some(pair(-0.5, 0.25))] {
                let (head, line) = (header.table(None).head(), Table::line(&run.cells(change)));
                let text = format!("{head}{line}64,1\n{line}");
                let (table, corrupt) = header.table(None).begun(&text, Path::new("t.csv")).unwrap();
                let runs = header.runs(&table);
                // One of two fields, and one that is there already.
                assert_eq!((runs.len(), corrupt.len()), (2, 1));
                assert_eq!((runs[0].as_ref(), runs[1].is_err()), (Ok(&run), true));
            }
        }
        let other = StudyHeader { fingerprint: "g".into(), ..header.clone() };
        assert!(other.table(None).begun(&header.table(None).head(), Path::new("t.csv")).is_err());
    }
}
