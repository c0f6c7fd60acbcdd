//! Sweeps: friction, contact and stiffness in steady sliding over speed, load and temperature.

mod convergence;
mod error;
mod load_search;
mod low_end;
mod matters;
mod method;
mod never_steady;
mod not_possible;
mod not_steady;
mod plan;
mod point;
mod quantile;
mod ranking;
mod samples;
mod scene_plan;
mod scenes;
mod search;
mod slide;
mod sliding;
mod solved;
mod swept;
mod table;
#[cfg(test)]
mod tests;
mod window;

pub use convergence::{NotAStudy, verdict};
pub use error::SweepError;
pub use load_search::separation_at_rest;
pub use matters::{Matter, Matters};
pub use method::{Method, MethodError, SlidingOptions, SweepMethod, way_of};
pub use never_steady::NeverSteady;
pub use not_possible::NotPossible;
pub use not_steady::NotSteady;
pub use plan::SweepPlan;
pub use point::steady_sliding;
pub use quantile::quantile_table;
pub use scene_plan::{Loads, SweepOptions};
pub use scenes::relevant;
pub use search::StopBounds;
pub use sliding::{SMALL_FRICTION, SteadySliding};
pub use swept::{Swept, SweptPoint};
pub use table::{StoredRow, SweepTable, SweepTableError, fingerprint};
