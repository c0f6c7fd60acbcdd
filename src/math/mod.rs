//! Numerical tools that know nothing of the model.

mod spline;

pub use spline::{Bounds, Spline};
