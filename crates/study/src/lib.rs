//! What one computes with scenes.

pub mod calibration;
pub mod check;
pub mod contact;
pub mod csv;
pub mod decimals;
pub mod elements;
pub mod files;
pub mod fit;
pub mod html;
pub mod labelled;
pub mod pack;
pub mod patch;
pub mod progress;
pub mod report;
pub mod robustness;
pub mod runner;
pub mod settings;
pub mod steady;
pub mod summary;
pub mod sweep;
