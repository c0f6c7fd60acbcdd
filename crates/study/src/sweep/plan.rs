//! What a sweep computes: the row of each of its points, with samples of what is not known of the scene or without.

use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

use asperity::element::{OperatingPoint, Sampled, TableHeader, TableRow};
use asperity::scene::Scene;
use asperity::simulation::Interrupt;
use rayon::prelude::*;

use super::error::SweepError;
use super::matters::{Matter, Matters};
use super::ranking::{means, number_at};
use super::samples::{Sample, Samples};
use super::scene_plan::{ScenePlan, SweepOptions};
use super::table::{self, SweepTable};
use crate::csv;
use crate::progress::Stop;
use crate::uncertainty::{Group, SampleOptions, UncertainScene, indices};

/// A sweep of a scene, its points not found yet.
#[derive(Debug)]
pub struct SweepPlan {
    own: ScenePlan,
    header: TableHeader,
    samples: Option<Samples>,
}

impl SweepPlan {
    /// The sweep of a `scene`, of which a study of convergence found what `convergence` says.
    ///
    /// # Errors
    /// Where the scene does not go with the options, or could never slide steadily.
    pub fn new(scene: Scene, options: &SweepOptions, convergence: Option<String>) -> Result<Self, SweepError> {
        let own = ScenePlan::new(scene, options, convergence)?;
        Ok(Self { header: own.header.clone(), own, samples: None })
    }

    /// As [`new`](Self::new), with samples of what is not known of the scene at each point.
    ///
    /// # Errors
    /// As for [`new`](Self::new), and where the samples cannot be drawn.
    pub fn with_samples(
        uncertain: &UncertainScene,
        options: &SweepOptions,
        convergence: Option<String>,
        samples: SampleOptions,
    ) -> Result<Self, SweepError> {
        let scene = uncertain.scene();
        let Self { own, mut header, .. } = Self::new(scene.clone(), options, convergence)?;
        let settings = format!("{} {samples:?} {:?}", header.fingerprint, scene.uncertainty);
        let samples = Samples::new(uncertain, &own, options, samples)?;
        header.fingerprint = table::fingerprint_of(&settings);
        header.samples = Some(samples.header());
        Ok(Self { own, header, samples: Some(samples) })
    }

    /// The header of the table, with all points in its grid.
    pub fn header(&self) -> &TableHeader {
        &self.header
    }

    /// What to look at before the points are found: a load that presses the layer harder than its links stand for, or
    /// temperatures that are probably meant in °C.
    pub fn warning(&self) -> Option<&str> {
        self.own.warning.as_deref()
    }

    /// The row of a point; `interrupt` may stop it.
    fn row(&self, point: &OperatingPoint, interrupt: &Interrupt) -> TableRow {
        let samples = self.samples.as_ref().map(|samples| samples.values(point, interrupt));
        let mut row = self.own.row(point, interrupt);
        row.samples = samples;
        row
    }

    /// Finds points on all cores, in any order, and hands each row to `found`; ends where that breaks off or `stop` says
    /// so.
    pub fn find<B: Send>(
        &self,
        points: &[OperatingPoint],
        stop: &Stop,
        found: impl Fn(TableRow) -> ControlFlow<B> + Sync,
    ) -> ControlFlow<B> {
        find(points, stop, |point, interrupt| self.row(point, interrupt), found)
    }

    /// The table of all points, found on all cores, `done` told after each; with rows missing where `stop` says so.
    pub fn table(&self, stop: &Stop, done: impl Fn() + Sync) -> SweepTable {
        table_of(self.header.clone(), stop, |point, interrupt| self.row(point, interrupt), done)
    }

    /// What to look at in the rows: few points of the surface in contact, friction that no rubber has, samples without a
    /// result.
    pub fn warnings<'a>(&self, rows: impl Iterator<Item = &'a TableRow> + Clone) -> Vec<String> {
        let mut warnings = self.own.warnings(rows.clone());
        warnings.extend(self.without_result(rows));
        warnings
    }

    /// The warning where many samples have no result at some of the rows.
    fn without_result<'a>(&self, rows: impl Iterator<Item = &'a TableRow>) -> Option<String> {
        /// A smaller part of the samples hardly moves a quantile.
        const MANY: f64 = 0.05;
        let missing = |row: &'a TableRow| {
            let samples = row.samples.as_ref()?;
            let count = self.header.samples?.count;
            let missing = count - samples.results();
            (missing as f64 > MANY * count as f64).then_some((row, missing))
        };
        let found: Vec<_> = rows.filter_map(missing).collect();
        let (row, missing) = found.iter().max_by_key(|(_, missing)| *missing)?;
        Some(format!(
            "more than 5 % of the samples have no result at {} of the points of the table and are left out there, {missing} at {}",
            found.len(),
            row.point.describe(self.header.load)
        ))
    }

    /// What explains friction's variance over the samples of these rows, at each and in the mean over all; `None` without
    /// samples.
    pub fn matters(&self, rows: &[&TableRow]) -> Option<Matters> {
        let Samples { groups, all, .. } = self.samples.as_ref()?;
        let normals: Vec<&[f64]> = all.iter().map(|sample| sample.normals.as_slice()).collect();
        let (groups, seeds): (Vec<Group>, Vec<Group>) =
            groups.iter().cloned().partition(|group| !group.axes.is_empty());
        let at = |row: &&TableRow| {
            let friction = row.samples.as_ref()?.of(Sampled::Friction);
            Some(Matter { point: row.point, indices: indices(&groups, &normals, friction)? })
        };
        let points = rows.iter().filter_map(at).collect();
        let mean = indices(&groups, &normals, &means(rows));
        let names = groups.into_iter().map(|group| group.name).collect();
        Some(Matters { groups: names, rest: Matters::rest(!seeds.is_empty()), points, mean })
    }

    /// What was drawn, by names: the value of each sample; none without samples.
    pub fn drawn(&self) -> Vec<(String, Vec<f64>)> {
        let all = self.samples.as_ref().map_or(&[][..], |samples| &samples.all);
        let names = all.first().into_iter().flat_map(|sample| &sample.values).map(|(name, _)| name.clone());
        let values = |at: usize| all.iter().map(|sample| sample.values[at].1).collect();
        names.enumerate().map(|(at, name)| (name, values(at))).collect()
    }

    /// All samples of these rows as a table of text, with what was drawn for each; empty without samples.
    pub fn samples_text(&self, rows: &[&TableRow]) -> String {
        let Some(Samples { all, .. }) = &self.samples else { return String::new() };
        let load = self.header.load;
        let mut head: Vec<String> = ["sample", "speed [m/s]"].map(str::to_owned).to_vec();
        head.extend([format!("{} [{}]", load.name(), load.unit()), "temperature [K]".into()]);
        head.extend(Sampled::ALL.map(|sampled| format!("{} [1]", sampled.name())));
        head.extend(all.first().iter().flat_map(|sample| &sample.values).map(|(name, _)| name.clone()));
        let text = |value: Option<f64>| value.map(|value| format!("{value:?}")).unwrap_or_default();
        let line = |(index, sample): (usize, &Sample), row: &TableRow| {
            let point = [Some(row.point.speed), Some(row.point.load), row.point.temperature].map(text);
            let of = |sampled| text(row.samples.as_ref().and_then(|samples| *samples.of(sampled).get(index)?));
            let found = Sampled::ALL.map(of);
            let drawn = sample.values.iter().map(|(_, value)| text(Some(*value)));
            std::iter::once((index + 1).to_string()).chain(point).chain(found).chain(drawn).collect()
        };
        let lines = all.iter().enumerate().flat_map(|sample| rows.iter().map(move |row| (sample, *row)));
        csv::text(head.iter().map(String::as_str), lines.map(|(sample, row)| line(sample, row)))
    }

    /// The table of the sample that is the quantile of a probability by its mean friction over a `table` of this sweep. Ends
    /// early, with rows missing, where `stop` says so.
    ///
    /// # Errors
    /// Where the table is of another sweep, or not whole.
    pub fn quantile(&self, table: &SweepTable, probability: f64, stop: &Stop) -> Result<SweepTable, SweepError> {
        if table.header.fingerprint != self.header.fingerprint {
            let (found, expected) = (table.header.fingerprint.clone(), self.header.fingerprint.clone());
            return Err(SweepError::OtherTable { found, expected });
        }
        let ranking = table.ranking();
        let place = number_at(ranking.len(), probability).ok_or(SweepError::NoRanking)?;
        let Some((samples, number)) = self.samples.as_ref().zip(ranking.get(place)) else {
            return Err(SweepError::NoRanking);
        };
        let sample = samples.all.get(number - 1).ok_or(SweepError::NoRanking)?;
        let mut header = TableHeader {
            samples: None,
            load: sample.load(),
            rest_separation: sample.rest_separation(),
            ..self.header.clone()
        };
        let seed = samples.header().seed;
        header.fingerprint = table::fingerprint_of(&format!("{} sample {number}", header.fingerprint));
        header.basis.sample = Some(format!(
            "{number} of {}, seed {seed}: quantile {probability} of the mean friction over the table",
            samples.all.len()
        ));
        Ok(table_of(header, stop, |point, interrupt| sample.row(point, interrupt), || ()))
    }

    /// How many points were solved for so far on the scene's own surface.
    #[cfg(test)]
    pub(super) fn solutions(&self) -> usize {
        self.own.solutions()
    }
}

/// The table of all points of a header, found on all cores by `row`, `done` told after each.
fn table_of(
    header: TableHeader,
    stop: &Stop,
    row: impl Fn(&OperatingPoint, &Interrupt) -> TableRow + Sync,
    done: impl Fn() + Sync,
) -> SweepTable {
    let points: Vec<OperatingPoint> = header.grid.points().collect();
    let rows = Mutex::new(Vec::new());
    let _: ControlFlow<()> = find(&points, stop, row, |row| {
        rows.lock().unwrap_or_else(PoisonError::into_inner).push(row);
        done();
        ControlFlow::Continue(())
    });
    SweepTable::new(header, rows.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// The rows of points, found on all cores by `row`.
fn find<B: Send>(
    points: &[OperatingPoint],
    stop: &Stop,
    row: impl Fn(&OperatingPoint, &Interrupt) -> TableRow + Sync,
    found: impl Fn(TableRow) -> ControlFlow<B> + Sync,
) -> ControlFlow<B> {
    let interrupt = stop.interrupt();
    let find = |point: &OperatingPoint| {
        stop.go_on().continue_value()?;
        let row = row(point, &interrupt);
        // What was stopped on its way has found nothing.
        stop.go_on().continue_value()?;
        Some(row)
    };
    points.par_iter().with_max_len(1).try_for_each(|point| match find(point) {
        Some(row) => stop.heed(found(row)),
        None => ControlFlow::Continue(()),
    })
}
