//! What tests and benchmarks of single steps use of the private modules. It may change with any version.

/// The integrator's.
pub mod integrator {
    pub use crate::integrator::*;
}

/// The contact laws'.
pub mod contact {
    pub use crate::contact::*;
}
