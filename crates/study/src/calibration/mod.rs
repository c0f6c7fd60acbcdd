//! Calibration: the few numbers of a scene that nobody measures by themselves, from measured friction.
//!
//! [`Measurements`] are friction coefficients at speeds, pressures and temperatures. A [`FrictionModel`] gives friction
//! at values of the free [`parameters`](FreeParameter): that of [steady sliding](SteadyModel), which is expensive, or that of
//! [Persson's theory](TheoryModel), which is cheap. [`Problem`] is their weighted difference, [`Fitted`] its least
//! square within the bounds, [`Statistics`] what the data say of the parameters there, and [`Plan`] which measurements
//! would say more. [`calibrate_scene`] does it for a [scene](FreeScene); a [`Calibrator`] does it step by step. docs/calibrate.md has the formulas.

mod calibrator;
mod curves;
mod fit;
mod free_scene;
mod measurements;
mod models;
mod problem;
mod refit;
mod statistics;
mod written;

pub use calibrator::{CalibratedParameter, Calibration, CalibrationStage, Calibrator};
pub use curves::{Cluster, Condition, CurveGrid, ModelCurves, picture};
pub use fit::{Fitted, SpaceMapping, Tolerance, map_space, minimise, starts_by_theory};
pub use free_scene::{CalibrationOptions, FreeScene, PlanOptions};
pub use measurements::{FRICTION, Measured, Measurements, in_words, left_out_in_words};
pub use models::{
    Done, FrictionModel, FrictionParts, GridOf, Memo, ModelError, NewOutcome, NoSliding, Outcome, SceneAt, SteadyModel,
    Task, TheoryModel,
};
pub use problem::{FreeParameter, FrictionMeasurement, Linearised, Problem};
pub use refit::uncertain_scene;
pub use statistics::{Direction, Misfit, Plan, Statistics, chi_square_per_degree, plan};
pub use written::{
    FitCovariance, NotInCovariance, PointsTable, calibrate_scene, calibrated_text, named_covariance, with_covariance,
};
