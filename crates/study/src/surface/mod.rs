//! Surfaces: their numbers, spectra and power laws; smoothed, split and made periodic.

mod analysis;
mod options;
mod treated;

pub use analysis::{FinerWaves, MapAnalysis, ProfileStatistics, Removed, SurfaceAnalysis};
pub use options::{ProfileReading, SurfaceOptions, Wavelengths};
pub use treated::TreatedSurface;
