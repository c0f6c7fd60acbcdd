//! What must hold whatever the scene: properties tested with random ones.
//!
//! PROPTEST_CASES sets how many cases each property is tested with, PROPTEST_RNG_SEED which ones.

mod case;
pub(crate) mod check;
mod contact;
mod energy;
mod found;
mod random;
mod saving;
mod scaling;
mod scene_file;
mod splitting;
mod superposition;
mod symmetry;
mod trust;
