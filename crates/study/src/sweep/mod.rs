//! Sweeps: friction, contact and stiffness in steady sliding over speed, load and temperature.

mod layer;
mod load_search;
mod options;
mod over;
mod picture;
mod plan;
mod point;
mod scene_plan;
mod search;
mod solved;
mod table;
#[cfg(test)]
mod tests;

pub use layer::relevant;
pub use load_search::separation_at_rest;
pub use options::{Gaps, Method, SlidingOptions, SweepMethod, SweepOptions, check_possible, fingerprint, way_of};
pub use over::{Over, SweptQuantity};
pub use picture::{column_picture, master_picture, matters_picture, over_ways, sweep_picture};
pub(crate) use plan::Problems;
pub use plan::{Matter, Matters};
pub use plan::{SweepPlan, quantile_table};
pub use point::steady_sliding;
pub use search::{NotSteady, SMALL_FRICTION, SteadySliding, StopBounds};
pub use solved::{Swept, SweptPoint};
pub use table::{CONVERGED, SweepColumn, SweepHeader, SweepRow, SweepTable, is_converged, verdict};
pub use table::{SampleHeader, SampleValues, Sampled, quantile};
