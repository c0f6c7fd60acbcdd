//! Surfaces: their numbers, spectra and power laws; smoothed, split and made periodic.

mod analysis;
mod options;
mod roughness;
mod treated;

pub use analysis::{FinerWaves, MapAnalysis, ProfileStatistics, Removed, SurfaceAnalysis};
pub use options::{ProfileReading, SurfaceOptions, Wavelengths};
pub use roughness::{CutOff, Roughness};
pub use treated::TreatedSurface;
