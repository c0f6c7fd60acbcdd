//! Scenes drawn from what is not known of one, and what of it matters.

mod drawing;
mod error;
mod groups;
mod indices;
mod normal;
mod sampler;
#[cfg(test)]
mod tests;

pub use drawing::{Drawn, Draws, Refused, UncertainScene};
pub use error::UncertaintyError;
pub use groups::{Group, decade_name};
pub use indices::{Index, Indices, indices};
pub use normal::inverse_normal;
pub use sampler::{SampleOptions, Sampler};
