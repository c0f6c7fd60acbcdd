//! What one computes with scenes.

pub mod calibration;
pub mod contact;
pub mod converge;
pub mod csv;
pub mod decimals;
pub mod elements;
pub mod files;
pub mod fit;
pub mod labelled;
pub mod patch;
pub mod progress;
pub mod robustness;
pub mod run_figures;
pub mod runner;
pub mod settings;
pub mod steady;
pub mod summary;
pub mod sweep;
