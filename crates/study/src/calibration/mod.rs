//! Calibration: the few numbers of a scene that nobody measures by themselves, from measured friction.
//!
//! [`Measurements`] are friction coefficients at speeds, pressures and temperatures. A [`FrictionModel`] gives friction
//! at values of the free [`parameters`](FreeParameter): that of [steady sliding](SteadyModel), which is expensive, or that of
//! [Persson's theory](TheoryModel), which is cheap. [`Problem`] is their weighted difference, [`minimise`] its least
//! square within the bounds, [`Statistics`] what the data say of the parameters there, and [`plan`] which measurements
//! would say more. docs/calibrate.md has the formulas.

mod error;
mod fit;
mod known_laws;
mod latin_hypercube;
mod measurements;
mod memo;
mod model;
mod parameter;
mod plan;
mod problem;
mod space_mapping;
mod statistics;
mod steady_model;
mod theory_model;

pub use error::CalibrationError;
pub use fit::{Fitted, Tolerance, minimise, starts_by_theory};
pub use measurements::{Measured, Measurements};
pub use memo::{Memo, NewOutcome};
pub use model::{Done, FrictionModel, FrictionParts, Outcome, SceneAt, Task};
pub use parameter::FreeParameter;
pub use plan::{Plan, plan};
pub use problem::{Linearised, Problem, Row};
pub use space_mapping::{SpaceMapping, map_space};
pub use statistics::{Direction, Statistics, chi_square_per_degree};
pub use steady_model::{GridOf, SteadyModel};
pub use theory_model::TheoryModel;
