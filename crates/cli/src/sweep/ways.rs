//! A sweep over the way: the tables of several ways as one, with a column of it, and friction over the way.

use std::path::Path;

use asperity::scene::Scene;
use asperity::table::{Cell, Column, Header, Table};
use asperity_study::Error;
use asperity_study::progress::Stop;
use asperity_study::sweep::{SlidingOptions, SweepOptions, SweepPlan, SweepTable, over_ways};

use crate::files::write;
use crate::picture;
use crate::terminal::{self, warn};

/// Sweeps a scene over `ways` (m), writes table and picture, and returns how many points there are, and have no result.
pub(super) fn sweep(
    scene: &Scene,
    options: &SweepOptions,
    ways: &[f64],
    (output, picture): (&Path, Option<&Path>),
) -> Result<[usize; 2], Error> {
    let plan = |&way: &f64| {
        let sliding = SlidingOptions { way: Some(way), ..options.sliding };
        SweepPlan::new(scene.clone(), &SweepOptions { sliding, ..options.clone() }, None)
    };
    let plans = ways.iter().map(plan).collect::<Result<Vec<_>, _>>()?;
    plans.iter().take(1).filter_map(SweepPlan::warning).for_each(warn);
    let bar = terminal::bar((plans.len() * plans.first().map_or(0, |plan| plan.header().grid.count())) as u64);
    let tables: Vec<SweepTable> = plans.iter().map(|plan| plan.table(&Stop::default(), || bar.inc(1))).collect();
    bar.finish_and_clear();
    for (plan, table) in plans.iter().zip(&tables) {
        plan.warnings(&table.rows).iter().for_each(|warning| warn(warning));
    }
    write(output, whole(ways, &tables).text())?;
    if let Some(path) = picture {
        picture::write(&over_ways(ways, &tables), path)?;
    }
    let rows = || tables.iter().flat_map(|table| &table.rows);
    Ok([rows().count(), rows().filter(|row| !row.is_result()).count()])
}

/// The rows of all ways as one table.
fn whole(ways: &[f64], tables: &[SweepTable]) -> Table {
    let own = tables.first().map(|table| table.header.table().columns().to_vec()).unwrap_or_default();
    let mut whole = Table::new(Header::default(), [Column::numbers("way", "m")].into_iter().chain(own));
    for (way, table) in ways.iter().zip(tables) {
        table.rows.iter().for_each(|row| whole.push([Cell::from(*way)].into_iter().chain(row.cells())));
    }
    whole
}
