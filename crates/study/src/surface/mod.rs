//! Surfaces: their numbers, spectra and power laws; smoothed, split and made periodic.

mod analysis;
mod files;
mod map;
mod periodic;
mod picture;
mod profile;
mod treated;

pub use analysis::{FinerWaves, Removed, SurfaceAnalysis};
pub use files::{matrix, profile_columns, spectrum_columns};
pub use map::MapAnalysis;
pub use profile::ProfileStatistics;
pub use treated::{MadePeriodic, SurfaceError, SurfaceOptions, TreatedSurface};
