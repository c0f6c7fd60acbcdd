//! Mathematics that knows nothing of the model.

pub mod polynomial;
pub mod relaxation;
pub mod root;
pub mod spline;
pub mod tridiagonal;
