//! Robustness of the runs of a scene: one catalogue of perturbations, and one judge of the perturbed runs.
//!
//! A run is judged by a tight run: the same perturbed scene at a far lower tolerance. `asperity report` perturbs a
//! user's scene so, `tests/extreme` its base scenes. How a scene is run is up to them.

mod judge;
mod perturbation;

pub use judge::{
    Accuracy, Budget, DISPLACEMENT, Difference, ForceHistory, KEPT, NOTABLE, RunFailure, TIGHTER, Verdict, WRONG,
    at_tolerance, divergence, exact, larger,
};
pub use perturbation::{Perturbation, ScaledQuantity, factor};
