//! What one computes with scenes.

pub mod calibration;
pub mod comparison;
pub mod contact;
pub mod csv;
pub mod decimals;
pub mod elements;
pub mod files;
pub mod fit;
pub mod labelled;
pub mod material;
pub mod patch;
pub mod progress;
pub mod robustness;
pub mod runner;
pub mod settings;
pub mod steady;
pub mod summary;
pub mod surface;
pub mod sweep;
