//! What one computes with scenes.

pub mod calibration;
pub mod decimals;
pub mod files;
pub mod fit;
pub mod robustness;
pub mod settings;
pub mod steady;
