//! What one computes with scenes.

pub mod calibration;
pub mod robustness;
pub mod steady;
