//! The samples of a sweep: its points for scenes drawn from what is not known of one, and what of that matters for
//! friction, at each point and in the mean over all.

use asperity::element::{Load, OperatingPoint, Quantity};
use asperity::math::check_memory;
use asperity::simulation::Interrupt;
use asperity::table::{Cell, Column, Header, Table};
use rayon::prelude::*;

use super::options::SweepOptions;
use super::sampled::{SampleHeader, SampleValues, Sampled};
use super::scene_plan::ScenePlan;
use super::table::{SweepHeader, SweepRow};
use crate::Error;
use crate::uncertainty::{Drawn, Group, Index, Indices, Refused, SampleOptions, Sampler, UncertainScene};

/// The samples of a sweep, their points not found yet.
#[derive(Debug)]
pub(super) struct Samples {
    /// What is not known of the scene.
    pub(super) groups: Vec<Group>,
    /// In their order.
    pub(super) all: Vec<Sample>,
    /// How many draws were drawn anew.
    redrawn: usize,
    options: SampleOptions,
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
        Ok(Self { groups: uncertain.groups().to_vec(), all, redrawn: draws.redrawn, options: samples })
    }

    /// What the table's header says of them.
    pub(super) fn header(&self) -> SampleHeader {
        SampleHeader { count: self.all.len(), seed: self.options.seed, redrawn: self.redrawn }
    }

    /// All samples of a point, found on all cores.
    pub(super) fn values(&self, point: &OperatingPoint, interrupt: &Interrupt) -> SampleValues {
        let found = |sample: &Sample| {
            if interrupt.is_wanted() {
                return [None; Sampled::ALL.len()];
            }
            let row = sample.row(point, interrupt);
            let value = |quantity| row.value(quantity).filter(|_| row.is_result());
            [Quantity::Friction, Quantity::Hysteresis, Quantity::ContactRatio].map(value)
        };
        SampleValues::new(&self.all.par_iter().with_max_len(1).map(found).collect::<Vec<_>>())
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
