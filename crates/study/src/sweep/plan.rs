//! What a sweep computes: the row of each of its points, with samples of what is not known of the scene or without.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

use asperity::element::{Load, OperatingPoint};
use asperity::math::check_memory;
use asperity::scene::Scene;
use asperity::simulation::Interrupt;
use asperity::table::{Cell, Column, Header, Table};
use rayon::prelude::*;

use super::options::{Gaps, SlidingOptions, SweepOptions, fingerprint_of};
use super::scene_plan::ScenePlan;
use super::table::{SampleHeader, SampleValues, Sampled, SweepHeader, SweepRow, SweepTable, means, number_at};
use crate::Error;
use crate::progress::Stop;
use crate::uncertainty::{Drawn, Group, Index, Indices, Refused, SampleOptions, Sampler, UncertainScene, indices};
use crate::values::Values;

/// The key of what tells a sweep from others.
const FINGERPRINT: &str = "fingerprint";

/// A sweep of a scene, its points not found yet.
#[derive(Debug)]
pub struct SweepPlan {
    own: ScenePlan,
    header: SweepHeader,
    samples: Option<Samples>,
}

impl SweepPlan {
    /// The sweep of a `scene`, of which a study of convergence found what `convergence` says.
    ///
    /// # Errors
    /// Where the scene does not go with the options, or could never slide steadily.
    pub fn new(scene: Scene, options: &SweepOptions, convergence: Option<String>) -> Result<Self, Error> {
        let own = ScenePlan::new(scene, options, convergence)?;
        let mut header = own.header.clone();
        header.keys.set(FINGERPRINT, &own.fingerprint(options.sliding)?);
        Ok(Self { header, own, samples: None })
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
    ) -> Result<Self, Error> {
        let scene = uncertain.scene();
        let Self { mut own, mut header, .. } = Self::new(scene.clone(), options, convergence)?;
        own.warnings.extend(uncertain.counted_twice());
        let settings = format!("{} {samples:?} {}", header.fingerprint(), uncertain.identity());
        let samples = Samples::new(uncertain, &own, options, samples)?;
        header.keys.set(FINGERPRINT, &fingerprint_of(&settings));
        samples.header().set_in(&mut header);
        Ok(Self { own, header, samples: Some(samples) })
    }

    /// The header of the table, with all points in its grid.
    pub fn header(&self) -> &SweepHeader {
        &self.header
    }

    /// What to look at before the points are found: a load that presses the rubber too hard, and temperatures that are
    /// probably meant in °C.
    pub fn first_warnings(&self) -> &[String] {
        &self.own.warnings
    }

    /// The row of a point; `interrupt` may stop it.
    fn row(&self, point: &OperatingPoint, interrupt: &Interrupt) -> SweepRow {
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
        found: impl Fn(SweepRow) -> ControlFlow<B> + Sync,
    ) -> ControlFlow<B> {
        find(points, stop, |point, interrupt| self.row(point, interrupt), found)
    }

    /// The table of all points, found on all cores, `done` told after each; with rows missing where `stop` says so.
    pub fn table(&self, stop: &Stop, done: impl Fn() + Sync) -> SweepTable {
        table_of(self.header.clone(), stop, |point, interrupt| self.row(point, interrupt), done)
    }

    /// What to look at in the rows: few points of the surface in contact, friction that no rubber has, samples without a
    /// result.
    pub fn warnings(&self, rows: &[SweepRow]) -> Vec<String> {
        let mut warnings = self.own.warnings(rows);
        warnings.extend(self.without_result(rows));
        warnings
    }

    /// The warning where many samples have no result at some of the rows.
    fn without_result(&self, rows: &[SweepRow]) -> Option<String> {
        /// A smaller part of the samples hardly moves a quantile.
        const MANY: f64 = 0.05;
        let missing = |row| {
            let row: &SweepRow = row;
            let samples = row.samples.as_ref()?;
            let count = self.header.samples?.count;
            let missing = count - samples.results();
            (missing as f64 > MANY * count as f64).then_some((row, missing))
        };
        let found: Vec<_> = rows.iter().filter_map(missing).collect();
        let (row, missing) = found.iter().max_by_key(|(_, missing)| *missing)?;
        let why = self.samples.as_ref().and_then(|samples| samples.problems.in_words());
        Some(format!(
            "more than 5 % of the samples have no result at {} of the points of the table and are left out there, {missing} at {}{}",
            found.len(),
            row.point.describe(self.header.load),
            why.map(|why| format!("; most often: {why}")).unwrap_or_default()
        ))
    }

    /// What explains friction's variance over the samples of these rows, at each and in the mean over all; `None` without
    /// samples.
    pub fn matters(&self, rows: &[SweepRow]) -> Option<Matters> {
        let Samples { groups, all, .. } = self.samples.as_ref()?;
        let normals: Vec<&[f64]> = all.iter().map(|sample| sample.normals.as_slice()).collect();
        let (groups, seeds): (Vec<Group>, Vec<Group>) =
            groups.iter().cloned().partition(|group| !group.axes.is_empty());
        let at = |row: &SweepRow| {
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

    /// All samples of these rows as a table, with what was drawn for each; empty without samples.
    pub fn samples_table(&self, rows: &[SweepRow]) -> Table {
        let all = self.samples.as_ref().map_or(&[][..], |samples| &samples.all);
        let sampled = self.header.samples.map_or(&[][..], SampleHeader::sampled);
        let own = sampled.iter().map(|sampled| Column::numbers(sampled.name(), sampled.unit()));
        let drawn = all.first().into_iter().flat_map(|sample| &sample.values);
        let columns = [Column::numbers("sample", "")].into_iter().chain(OperatingPoint::columns(self.header.load));
        let columns = columns.chain(own).chain(drawn.map(|(name, _)| Column::numbers(name, "")));
        let mut table = Table::new(Header::default(), columns);
        for (index, sample) in all.iter().enumerate() {
            for row in rows {
                let of =
                    |sampled: &Sampled| row.samples.as_ref().and_then(|samples| *samples.of(*sampled).get(index)?);
                let cells = [Cell::from((index + 1) as f64)].into_iter().chain(row.point.cells());
                let cells = cells.chain(sampled.iter().map(|sampled| of(sampled).into()));
                table.push(cells.chain(sample.values.iter().map(|(_, value)| (*value).into())));
            }
        }
        table
    }

    /// The table of the sample that is the quantile of a probability by its mean friction over a `table` of this sweep. Ends
    /// early, with rows missing, where `stop` says so.
    ///
    /// # Errors
    /// Where the table is of another sweep, or not whole.
    pub fn quantile(&self, table: &SweepTable, probability: f64, stop: &Stop) -> Result<SweepTable, Error> {
        let (found, expected) = (table.header.fingerprint(), self.header.fingerprint());
        if found != expected {
            return Err(Error::scene(format!(
                "the table is of another sweep: its fingerprint is {found}, that of this scene with its samples and speeds \
                 {expected}"
            )));
        }
        let ranking = table.ranking();
        let number = number_at(ranking.len(), probability).and_then(|place| ranking.get(place));
        let (Samples { all, .. }, number) = self.samples.as_ref().zip(number).ok_or_else(no_ranking)?;
        let sample = all.get(number - 1).ok_or_else(no_ranking)?;
        let seed = self.header.samples.map_or(0, |samples| samples.seed);
        let header = sample.header(
            &self.header,
            &fingerprint_of(&format!("{expected} sample {number}")),
            &format!(
                "{number} of {}, seed {seed}: quantile {probability} of the mean friction over the table",
                all.len()
            ),
        );
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
    header: SweepHeader,
    stop: &Stop,
    row: impl Fn(&OperatingPoint, &Interrupt) -> SweepRow + Sync,
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
    row: impl Fn(&OperatingPoint, &Interrupt) -> SweepRow + Sync,
    found: impl Fn(SweepRow) -> ControlFlow<B> + Sync,
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

/// The table of one sample of a `table` with samples that was swept from a scene: of the one whose mean friction over the
/// table is its quantile of a probability, so that the whole is a curve that can occur. The sample is drawn and swept again.
/// Ends early, with rows missing, where `stop` says so.
///
/// # Errors
/// Where the table has no samples, is of another sweep or not whole.
pub fn quantile_table(
    uncertain: &UncertainScene,
    table: &SweepTable,
    probability: f64,
    stop: &Stop,
) -> Result<SweepTable, Error> {
    let SweepHeader { samples, grid, load, keys, .. } = &table.header;
    let SampleHeader { count, seed, .. } = samples.ok_or_else(no_ranking)?;
    let loads = Some(Values(grid.loads.clone()));
    let (pressures, forces) = match load {
        Load::Pressure { .. } => (loads, None),
        Load::Force => (None, loads),
    };
    let options = SweepOptions {
        speeds: Some(Values(grid.speeds.clone())),
        pressures,
        forces,
        temperatures: (!grid.temperatures.is_empty()).then(|| Values(grid.temperatures.clone())),
        gaps: Gaps::of_table(keys),
        sliding: SlidingOptions::of_table(keys)?,
    };
    let convergence = keys.text_of("convergence").map(str::to_owned);
    let plan = SweepPlan::with_samples(uncertain, &options, convergence, SampleOptions { count, seed })?;
    plan.quantile(table, probability, stop)
}

fn no_ranking() -> Error {
    Error::scene("`quantile`: expected the whole table of a sweep with samples, which ranks them")
}

/// Why samples have no result, each kind with how often, as far as they were found here.
#[derive(Debug, Default)]
pub(crate) struct Problems(Mutex<BTreeMap<String, usize>>);

impl Problems {
    /// Counts a row that is no result.
    pub(crate) fn count(&self, row: &SweepRow) {
        if row.is_result() {
            return;
        }
        // Of one kind whatever its numbers.
        let word = |word: &str| if word.contains(|c: char| c.is_ascii_digit()) { "some" } else { word }.to_owned();
        let kind = row.status.text().split(' ').map(word).collect::<Vec<_>>().join(" ");
        *self.0.lock().unwrap_or_else(PoisonError::into_inner).entry(kind).or_default() += 1;
    }

    /// The most frequent kinds; `None` where there are none.
    pub(crate) fn in_words(&self) -> Option<String> {
        const MOST: usize = 3;
        let problems = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut all: Vec<(&String, &usize)> = problems.iter().collect();
        all.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
        let said = all.iter().take(MOST).map(|(kind, count)| format!("{kind} ({count} times)"));
        (!all.is_empty()).then(|| said.collect::<Vec<_>>().join(", "))
    }
}

/// The samples of a sweep, their points not found yet.
#[derive(Debug)]
pub(super) struct Samples {
    /// What is not known of the scene.
    pub(super) groups: Vec<Group>,
    /// In their order.
    pub(super) all: Vec<Sample>,
    /// How many draws were drawn anew.
    redrawn: usize,
    /// Whether they have leak gaps.
    has_gaps: bool,
    options: SampleOptions,
    /// Whether a covariance's numbers were fitted anew in each.
    refit: bool,
    problems: Problems,
}

/// A sample.
#[derive(Debug)]
pub(super) struct Sample {
    plan: ScenePlan,
    /// How much warmer than the points it is, K.
    warmer: f64,
    /// What was drawn, by names.
    pub(super) values: Vec<(String, f64)>,
    /// The normal numbers along all axes.
    pub(super) normals: Vec<f64>,
}

impl Samples {
    /// Those of a scene whose own sweep is `own`.
    ///
    /// # Errors
    /// Where they cannot be drawn, or one does not go with the options.
    pub(super) fn new(
        uncertain: &UncertainScene,
        own: &ScenePlan,
        options: &SweepOptions,
        samples: SampleOptions,
    ) -> Result<Self, Error> {
        let sampler = Sampler::new(uncertain.axes(), samples)?;
        let bytes = own.surface_memory().saturating_mul(samples.count as u64);
        check_memory(bytes, || format!("`samples`: the surfaces of {} samples", samples.count))?;
        let make = |drawn| Sample::new(drawn, uncertain, own, options);
        let draws = uncertain.draw_all(&sampler, make)?;
        let failed = |(sample, made): (usize, Result<Sample, Error>)| {
            made.map_err(|error| error.context(format!("sample {}", sample + 1)))
        };
        let all = draws.made.into_iter().enumerate().map(failed).collect::<Result<_, Error>>()?;
        let groups = uncertain.groups().to_vec();
        let (redrawn, refit, has_gaps) = (draws.redrawn, uncertain.is_refitted(), options.gaps.is_some());
        Ok(Self { groups, all, redrawn, has_gaps, options: samples, refit, problems: Problems::default() })
    }

    /// What the table's header says of them.
    pub(super) fn header(&self) -> SampleHeader {
        SampleHeader {
            count: self.all.len(),
            seed: self.options.seed,
            redrawn: self.redrawn,
            refit: self.refit,
            has_gaps: self.has_gaps,
        }
    }

    /// All samples of a point, found on all cores.
    pub(super) fn values(&self, point: &OperatingPoint, interrupt: &Interrupt) -> SampleValues {
        let sampled = self.header().sampled();
        let found = |sample: &Sample| {
            if interrupt.is_wanted() {
                return vec![None; sampled.len()];
            }
            let row = sample.row(point, interrupt);
            self.problems.count(&row);
            let value = |sampled: &Sampled| row.value(sampled.quantity()).filter(|_| row.is_result());
            sampled.iter().map(value).collect()
        };
        SampleValues::new(&self.all.par_iter().with_max_len(1).map(found).collect::<Vec<_>>(), sampled)
    }
}

impl Sample {
    /// A sample that was drawn, refused where it has not the temperatures of the points.
    fn new(
        drawn: Drawn,
        uncertain: &UncertainScene,
        own: &ScenePlan,
        options: &SweepOptions,
    ) -> Result<Result<Self, Error>, Refused> {
        let Drawn { scene, values, normals } = drawn;
        let warmer = uncertain.warmer(&scene);
        own.check_temperatures(&scene, warmer)?;
        Ok(own.drawn(scene, options, warmer).map(|plan| Self { plan, warmer, values, normals }))
    }

    /// The row of a point.
    pub(super) fn row(&self, point: &OperatingPoint, interrupt: &Interrupt) -> SweepRow {
        let temperature = point.temperature.map(|kelvin| kelvin + self.warmer);
        let mut row = self.plan.row(&OperatingPoint { temperature, ..*point }, interrupt);
        row.point = *point;
        row
    }

    /// The header of a table of its own, `of` being that of the sweep with all samples.
    pub(super) fn header(&self, of: &SweepHeader, fingerprint: &str, sample: &str) -> SweepHeader {
        let (own, mut keys) = (&self.plan.header, SampleHeader::removed_from(&of.keys));
        keys.set("fingerprint", fingerprint);
        keys.set("sample", sample);
        SweepHeader::new(keys, own.load, own.rest_separation, of.grid.clone())
    }
}

/// What explains the variance of friction.
#[derive(Clone, Debug, PartialEq)]
pub struct Matters {
    /// The names of the keys and of the file of the covariance.
    pub groups: Vec<String>,
    /// What is left, in words.
    pub rest: &'static str,
    /// At the points where there are indices.
    pub points: Vec<Matter>,
    /// Of the mean friction over all points; `None` where there are too few samples.
    pub mean: Option<Indices>,
}

/// What explains the variance of friction at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Matter {
    /// The point.
    pub point: OperatingPoint,
    /// What each group explains.
    pub indices: Indices,
}

impl Matters {
    /// What no group explains; a surface's seed has no direction, so that none can be told for it.
    pub(super) fn rest(has_seed: bool) -> &'static str {
        if has_seed { "not additive, not monotone or the surface's seed" } else { "not additive or not monotone" }
    }

    /// What explains the variance of the mean over all points, the largest first.
    pub fn largest(&self) -> Vec<(&str, Index)> {
        let of_mean = self.mean.iter().flat_map(|indices| self.groups.iter().zip(&indices.groups));
        let mut all: Vec<(&str, Index)> = of_mean.map(|(name, index)| (name.as_str(), *index)).collect();
        all.sort_by(|(_, one), (_, other)| other.share.total_cmp(&one.share));
        all
    }

    /// As a table: a row for each point and group, those of the mean over all points first, without a point.
    pub fn table(&self, load: Load) -> Table {
        let numbers = [("share", "1"), ("standard_error", "1")].map(|(name, unit)| Column::numbers(name, unit));
        let columns = OperatingPoint::columns(load).into_iter().chain([Column::words("key", "")]).chain(numbers);
        let mut table = Table::new(Header::default(), columns);
        let mean = self.mean.iter().map(|indices| (None, indices));
        let points = self.points.iter().map(|matter| (Some(matter.point), &matter.indices));
        for (point, indices) in mean.chain(points) {
            let place = || point.map_or([(); 3].map(|()| None.into()), |point| point.cells());
            let own = self.groups.iter().zip(&indices.groups);
            let own = own.map(|(name, index)| (name.as_str(), index.share, Some(index.error)));
            for (name, share, error) in own.chain([(self.rest, indices.rest, None)]) {
                table.push(place().into_iter().chain([name.into(), Cell::from(share), error.into()]));
            }
        }
        table
    }
}
