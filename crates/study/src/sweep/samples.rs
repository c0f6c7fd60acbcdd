//! The samples of a sweep: its points for scenes drawn from what is not known of one.

use asperity::element::{OperatingPoint, Quantity, SampleHeader, SampleValues, Sampled, TableRow};
use asperity::math::check_memory;
use asperity::simulation::Interrupt;
use rayon::prelude::*;

use super::error::SweepError;
use super::scene_plan::{ScenePlan, SweepOptions};
use crate::uncertainty::{Drawn, Group, Refused, SampleOptions, Sampler, UncertainScene, UncertaintyError};

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
    ) -> Result<Self, SweepError> {
        let sampler = Sampler::new(uncertain.axes(), samples)?;
        let bytes = own.surface_memory().saturating_mul(samples.count as u64);
        check_memory(bytes, || format!("`samples`: the surfaces of {} samples", samples.count))?;
        let make = |drawn| Sample::new(drawn, uncertain, own, options);
        let draws = uncertain.draw_all(&sampler, make)?;
        let failed = |(sample, made): (usize, Result<Sample, SweepError>)| {
            made.map_err(|error| UncertaintyError::Sample { sample: sample + 1, problem: error.to_string() }.into())
        };
        let all = draws.made.into_iter().enumerate().map(failed).collect::<Result<_, SweepError>>()?;
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
    ) -> Result<Result<Self, SweepError>, Refused> {
        let Drawn { scene, values, normals } = drawn;
        let warmer = uncertain.warmer(&scene);
        match own.drawn(scene, options, warmer) {
            Ok(plan) => Ok(Ok(Self { plan, warmer, values, normals })),
            Err(SweepError::Temperature(error)) => Err(error.into()),
            Err(error) => Ok(Err(error)),
        }
    }

    /// The row of a point.
    pub(super) fn row(&self, point: &OperatingPoint, interrupt: &Interrupt) -> TableRow {
        let temperature = point.temperature.map(|kelvin| kelvin + self.warmer);
        let mut row = self.plan.row(&OperatingPoint { temperature, ..*point }, interrupt);
        row.point = *point;
        row
    }

    /// Separation at w = 0, m.
    pub(super) fn rest_separation(&self) -> f64 {
        self.plan.header.rest_separation
    }

    /// What the loads are.
    pub(super) fn load(&self) -> asperity::element::Load {
        self.plan.header.load
    }
}
