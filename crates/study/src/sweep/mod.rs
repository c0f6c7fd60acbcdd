//! Sweeps: friction, contact and stiffness in steady sliding over speed, load and temperature.

mod convergence;
mod error;
mod load_search;
mod low_end;
mod method;
mod never_steady;
mod plan;
mod point;
mod scenes;
mod slide;
mod solved;
mod swept;
mod table;
mod window;

pub use convergence::verdict;
pub use error::SweepError;
pub use load_search::separation_at_rest;
pub use method::{Method, MethodError, SlidingOptions, SweepMethod};
pub use never_steady::NeverSteady;
pub use plan::{Loads, SweepOptions, SweepPlan};
pub use point::{SMALL_FRICTION, SteadySliding, StopBounds, steady_sliding};
pub use scenes::relevant;
pub use solved::status as solved_status;
pub use swept::{Swept, SweptPoint};
pub use table::{StoredRow, SweepTable, SweepTableError, fingerprint};
