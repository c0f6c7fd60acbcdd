//! What is asked of a calibration.

use std::path::PathBuf;

use super::parameter::FreeParameter;
use crate::sweep::SlidingOptions;
use asperity::scene::Setting;

/// What is calibrated, and by what.
#[derive(Clone, Debug)]
pub struct CalibrationOptions {
    /// The scene file: files that the scene names are looked for beside it.
    pub scene: PathBuf,
    /// Keys of it that are set, none of them free.
    pub set: Vec<Setting>,
    /// The numbers to fit.
    pub free: Vec<FreeParameter>,
    /// The table of measured friction.
    pub data: PathBuf,
    /// How steady sliding is found.
    pub sliding: SlidingOptions,
}

/// The points among which those to measure next are chosen: where there are none, points beyond the measurements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CandidateOptions {
    /// Speeds, m/s.
    pub speeds: Option<Vec<f64>>,
    /// Pressures, Pa.
    pub pressures: Option<Vec<f64>>,
    /// Temperatures, K.
    pub temperatures: Option<Vec<f64>>,
}
