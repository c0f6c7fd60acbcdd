//! Ranking: friction of several scenes at the same points, its weighted mean, and how sure their order is.
//!
//! Samples of all scenes are drawn with common numbers ([`UncertainScene::draw_together`](crate::uncertainty)): sample i
//! draws the same for keys of the same name and for a surface's seed, so that what the scenes share drops out of their
//! comparison.

mod measured;
mod picture;
mod plan;
mod ranking;
mod weights;

pub use measured::{MeasuredRanking, MeasuredScene, kendall, measured_ranking};
pub use picture::picture;
pub use plan::{RankFound, RankOptions, RankPlan, RankScene};
pub use ranking::{Band, Mean, Pair, QUANTILES, RankedPoint, RankedScene, Ranking, SURE, table};
pub use weights::{WEIGHTS, Weights};
