//! What a sweep says of the low end of its table: a contact patch lives at low pressures.

use asperity::element::{LowEnd, Table};

use crate::decimals::rounded;

/// How far the law reaches below the least load at the least and at the largest speed, the farthest of all
/// temperatures, and how much of a load may lie there.
pub(super) fn low_end(table: &Table) -> String {
    let (grid, unit) = (&table.grid, table.load.unit());
    let (slow, fast) = (grid.speeds[0], grid.speeds[grid.speeds.len() - 1]);
    let mut speeds = vec![slow, fast];
    speeds.dedup();
    let ends: Vec<LowEnd> = speeds.iter().map(|&speed| farthest(table, speed)).collect();
    let reach = |(speed, end): (&f64, &LowEnd)| format!("{} µm farther at {speed} m/s", rounded(1e6 * end.reach, 2));
    let reaches: Vec<String> = speeds.iter().zip(&ends).map(reach).collect();
    let share = ends.iter().map(|end| end.share).fold(0.0, f64::max);
    format!(
        "below {} {unit} the law is a parabola that reaches {}; of an oblique face that presses up to the table's largest {} \
         it bears {} % of the load",
        grid.loads[0],
        reaches.join(" and "),
        table.load.name(),
        rounded(100.0 * share, 2)
    )
}

/// The larger reach and share of all temperatures.
fn farthest(table: &Table, speed: f64) -> LowEnd {
    let temperatures = if table.grid.temperatures.is_empty() { &[0.0][..] } else { &table.grid.temperatures };
    let ends = temperatures.iter().map(|&temperature| table.low_end(speed, temperature));
    ends.fold(LowEnd { reach: 0.0, share: 0.0 }, |far, end| LowEnd {
        reach: far.reach.max(end.reach),
        share: far.share.max(end.share),
    })
}
