//! The table of the sample at a quantile of another table.

use asperity::element::{Load, SampleHeader, TableHeader};

use super::error::SweepError;
use super::method::{SlidingOptions, SweepMethod};
use super::plan::SweepPlan;
use super::scene_plan::{Loads, SweepOptions};
use super::table::SweepTable;
use crate::progress::Stop;
use crate::uncertainty::{SampleOptions, UncertainScene};

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
) -> Result<SweepTable, SweepError> {
    let TableHeader { samples, grid, load, basis, .. } = &table.header;
    let SampleHeader { count, seed, .. } = samples.ok_or(SweepError::NoRanking)?;
    let loads = match load {
        Load::Pressure { .. } => Loads::Pressures(grid.loads.clone()),
        Load::Force => Loads::Forces(grid.loads.clone()),
    };
    let of_layer = SlidingOptions { method: Some(SweepMethod::Layer), ..SlidingOptions::default() };
    let options = SweepOptions {
        speeds: grid.speeds.clone(),
        loads,
        temperatures: (!grid.temperatures.is_empty()).then(|| grid.temperatures.clone()),
        sliding: SlidingOptions::of_table(basis).unwrap_or(of_layer),
    };
    let plan = SweepPlan::with_samples(uncertain, &options, basis.convergence.clone(), SampleOptions { count, seed })?;
    plan.quantile(table, probability, stop)
}
