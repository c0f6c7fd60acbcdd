//! Calibration: the few numbers of a scene that nobody measures by themselves, from measured friction.
//!
//! [`Measurements`] are friction coefficients at speeds, pressures and temperatures. A [`FrictionModel`] gives friction
//! at values of the free [`parameters`](FreeParameter): that of [steady sliding](SteadyModel), which is expensive, or that of
//! [Persson's theory](TheoryModel), which is cheap. [`Problem`] is their weighted difference, [`Fitted`] its least
//! square within the bounds, [`Statistics`] what the data say of the parameters there, and [`Plan`] which measurements
//! would say more. [`calibrate_scene`] does it for a [scene](FreeScene); a [`Calibrator`] does it step by step. docs/calibrate.md has the formulas.

mod calibrated;
mod calibrator;
mod candidates;
mod covariance;
mod curve_grid;
mod error;
mod fit;
mod free_scene;
mod known_laws;
mod latin_hypercube;
mod layer_model;
mod measurements;
mod memo;
mod model;
mod options;
mod parameter;
mod picture;
mod plan;
pub mod points_table;
mod problem;
mod scene_text;
mod space_mapping;
mod statistics;
mod steady_model;
mod theory_model;

pub use calibrated::{CalibratedParameter, Calibration};
pub use calibrator::{CalibrationStage, Calibrator, calibrate_scene};
pub use covariance::{FitCovariance, FittedNumber, NotInCovariance, named_covariance, with_covariance};
pub use curve_grid::{Cluster, Condition, CurveGrid, in_words, left_out_in_words};
pub use error::{CalibrationError, FreeParameterError, MeasuredFrictionError, ModelError, NoSliding};
pub use fit::{Fitted, Tolerance, minimise, starts_by_theory};
pub use free_scene::FreeScene;
pub use measurements::{Measured, Measurements};
pub use memo::{Memo, NewOutcome};
pub use model::{Done, FrictionModel, FrictionParts, Outcome, SceneAt, Task};
pub use options::{CalibrationOptions, CandidateOptions};
pub use parameter::FreeParameter;
pub use picture::{ModelCurves, picture};
pub use plan::{Plan, plan};
pub use problem::{FrictionMeasurement, Linearised, Problem};
pub use scene_text::calibrated_text;
pub use space_mapping::{SpaceMapping, map_space};
pub use statistics::{Direction, Statistics, chi_square_per_degree};
pub use steady_model::{GridOf, SteadyModel};
pub use theory_model::TheoryModel;
