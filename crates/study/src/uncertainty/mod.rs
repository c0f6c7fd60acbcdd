//! What is not known of a scene, scenes drawn from it, and what of it matters.

mod covariance;
mod drawing;
mod indices;
mod sampler;
mod section;
#[cfg(test)]
mod section_tests;
#[cfg(test)]
mod tests;

pub use covariance::{CANNOT_SAY, Covariance, DEGREES_OF_FREEDOM, FittedNumber, Scale};
pub use drawing::{Drawn, DrawnAt, Draws, Group, Refit, Refused, UncertainScene, decade_name};
pub use indices::{Index, Indices, indices};
pub use sampler::{SampleOptions, Sampler, inverse_normal};
pub use section::{Distribution, Spread, UncertainKey, Uncertainty, covariance_file};
