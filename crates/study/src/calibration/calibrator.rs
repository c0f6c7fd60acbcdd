//! The course of a calibration: a first fit by the theory, the fit by steady sliding, what to measure next; and what it
//! found.

use std::sync::{Mutex, PoisonError};

use asperity::element::OperatingPoint;
use asperity::scene::Scene;
use serde::Serialize;

use super::fit::{Fitted, Tolerance, map_space, minimise, starts_by_theory};
use super::free_scene::FreeScene;
use super::measurements::{Measurements, in_words};
use super::models::{
    FrictionModel, FrictionParts, LayerModel, Memo, ModelError, NewOutcome, NoSliding, Outcome, SteadyModel, Task,
    TheoryModel,
};
use super::problem::{FreeParameter, FrictionMeasurement, Linearised, Problem};
use super::statistics::{Plan, Statistics, candidates, chi_square_per_degree, plan};
use crate::decimals::{rounded, short};
use crate::implausible::{FoundFriction, implausible};
use crate::sweep::Method;

/// What a calibration does now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CalibrationStage {
    /// It fits, and has come to this χ² per degree of freedom.
    Fitting(f64),
    /// It looks for what to measure next.
    Planning,
}

/// What a calibration is made with.
#[derive(Clone, Copy)]
pub struct Calibrator<'a> {
    free: &'a FreeScene<'a>,
    theory: &'a TheoryModel<'a>,
    model: &'a Memo<'a>,
    /// Told what is done now.
    progress: &'a dyn Fn(CalibrationStage),
}

impl std::fmt::Debug for Calibrator<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Calibrator").field("free", self.free).field("model", self.model).finish_non_exhaustive()
    }
}

impl FreeScene<'_> {
    /// Does `work` with the models of the scene, of which the expensive one has `known` points and hands new ones to
    /// `found`, which says whether to go on; `progress` is told what is done.
    pub fn with_models<T>(
        &self,
        known: Vec<(Task, Outcome)>,
        found: &NewOutcome<'_>,
        progress: &dyn Fn(CalibrationStage),
        work: impl FnOnce(Calibrator<'_>) -> T,
    ) -> T {
        let sliding = self.options.sliding;
        let scene_at = |values: &[f64]| self.at(values);
        let grid_of = |scene: &Scene| sliding.grid(scene);
        let theory = TheoryModel::new(&scene_at);
        let steady = SteadyModel::new(&scene_at, &grid_of);
        let layer = LayerModel { scene_at: &scene_at, area: self.area, bounds: sliding.bounds() };
        let model: &dyn FrictionModel = if self.is_solved() { &steady } else { &layer };
        let model = Memo::new(model, known, found);
        work(Calibrator { free: self, theory: &theory, model: &model, progress })
    }
}

/// How many measurements a plan proposes.
const PLANNED: usize = 3;
/// How many of the fits by the theory are tried as starts.
const TRIED: usize = 4;
/// The layer's friction is known to some 0.5 %.
const OF_LAYER: Tolerance = Tolerance { chi_square: 1e-3, places: 3e-3, steps: 12 };

impl Calibrator<'_> {
    /// The fit, without the points that do not slide steadily where it leads.
    ///
    /// # Errors
    /// Where the models fail, too few points are left, or it is stopped.
    pub fn calibrate(&self, measurements: &Measurements) -> Result<Calibration, ModelError> {
        let whole = Problem::new(self.free.parameters.clone(), measurements);
        let (mut problem, mut left_out) = (whole, Vec::new());
        loop {
            match self.fit(&problem) {
                Ok((fitted, linearised, way)) => {
                    let statistics = Statistics::new(&problem, &fitted.places, &linearised);
                    let frictions = problem.frictions(self.model, std::slice::from_ref(&fitted.places))?.remove(0);
                    let scene = self.free.scene();
                    let largest = measurements.rows.iter().map(|row| row.point.load).fold(0.0, f64::max);
                    let pressed = scene.hard_pressure("the largest measured pressure", largest, !self.free.is_solved());
                    let implausible = pressed.into_iter().chain(implausible(scene, found_at(&problem, &frictions)));
                    return Ok(Calibration {
                        own: self.free.own.clone(),
                        measurements: measurements.clone(),
                        problem,
                        fitted,
                        linearised,
                        statistics,
                        frictions,
                        left_out,
                        implausible: implausible.collect(),
                        way,
                    });
                }
                Err(ModelError::NotSteady(failed)) => {
                    let points: Vec<OperatingPoint> = failed.iter().map(|(point, _)| *point).collect();
                    problem = problem.without(&points);
                    left_out.extend(failed);
                }
                Err(ModelError::TooFew { rows, parameters, .. }) => {
                    let left_out = measurements.left_out_in_words(&left_out);
                    return Err(ModelError::TooFew { rows, parameters, left_out });
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// A fit of all points: where it ended, what friction does there, and how it came there.
    fn fit(&self, problem: &Problem) -> Result<(Fitted, Linearised, String), ModelError> {
        let start = self.start(problem)?;
        let progress = |chi_square: f64| {
            let degrees = problem.rows.len().saturating_sub(problem.parameters.len());
            (self.progress)(CalibrationStage::Fitting(chi_square_per_degree(chi_square, degrees)));
        };
        if self.free.is_solved() {
            let fitted = minimise(problem, self.model, &start, Tolerance::USUAL, &progress)?;
            let linearised = problem.linearised_to_both_sides(self.model, &fitted.places)?;
            return Ok((fitted, linearised, "steady sliding itself, from a first fit by Persson's theory".to_owned()));
        }
        let mapped = map_space(problem, self.theory, self.model, &start, &progress)?;
        if let Some(mapped) = mapped.as_ref().filter(|mapped| mapped.fitted.has_converged) {
            let way = format!("space mapping: Persson's theory corrected by the layer in {} rounds", mapped.rounds);
            return Ok((mapped.fitted.clone(), mapped.linearised.clone(), way));
        }
        let start = mapped.map_or(start, |mapped| mapped.fitted.places);
        let fitted = minimise(problem, self.model, &start, OF_LAYER, &progress)?;
        let linearised = problem.linearised(self.model, &fitted.places)?;
        Ok((fitted, linearised, "differences of the layer itself: its friction and the theory's part".to_owned()))
    }

    /// The best start of the expensive model among the fits by the theory and the scene's own values; of the layer, which is
    /// too expensive to be tried at several, the best fit by the theory.
    fn start(&self, problem: &Problem) -> Result<Vec<f64>, ModelError> {
        let own = problem.places(&self.free.own);
        let fits = starts_by_theory(problem, self.theory, &own, Tolerance::ROUGH)?;
        if let (Method::Layer, Some(best)) = (&self.free.method, fits.first()) {
            return Ok(best.places.clone());
        }
        let mut starts = vec![own];
        starts.extend(fits.into_iter().take(TRIED).map(|fit| fit.places));
        let outcomes = problem.outcomes(self.model, &starts)?;
        // Those at which most points slide steadily, and of these the one with the least square.
        let worth = |outcomes: &Vec<Outcome>| {
            let residual = |row: &FrictionMeasurement| {
                let friction = outcomes[row.point].as_ref().ok()?.friction();
                Some(((friction - row.friction) / row.sigma).powi(2))
            };
            let failed = outcomes.iter().filter(|outcome| outcome.is_err()).count();
            (failed, problem.rows.iter().filter_map(residual).sum::<f64>())
        };
        let order = |a: &(usize, f64), b: &(usize, f64)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1));
        let best = outcomes.iter().map(worth).zip(&starts).min_by(|a, b| order(&a.0, &b.0));
        Ok(best.map(|(_, places)| places.clone()).unwrap_or_default())
    }

    /// Friction before and after at `points`; of a layer, which is too expensive, at the measured points alone.
    ///
    /// # Errors
    /// Where the model fails, or it is stopped.
    pub fn curves(
        &self,
        calibration: &Calibration,
        points: Vec<OperatingPoint>,
    ) -> Result<[Vec<(OperatingPoint, f64)>; 2], ModelError> {
        let points = if self.free.is_solved() { points } else { calibration.problem.points.clone() };
        let after = calibration.problem.values(&calibration.fitted.places);
        Ok([self.frictions(&self.free.own, &points)?, self.frictions(&after, &points)?])
    }

    /// Friction at those of some points that slide steadily.
    fn frictions(&self, values: &[f64], points: &[OperatingPoint]) -> Result<Vec<(OperatingPoint, f64)>, ModelError> {
        let task = |&point: &OperatingPoint| Task { parameters: values.to_vec(), point };
        let tasks: Vec<Task> = points.iter().map(task).collect();
        let found = Mutex::new(Vec::new());
        self.model.evaluate(&tasks, &|index, outcome| {
            let point = outcome.ok().map(|parts| (tasks[index].point, parts.friction()));
            found.lock().unwrap_or_else(PoisonError::into_inner).extend(point);
            Ok(())
        })?;
        Ok(found.into_inner().unwrap_or_else(PoisonError::into_inner))
    }

    /// What to measure next, among the points that are asked for; `None` where that is not asked for.
    ///
    /// # Errors
    /// Where the model fails, or it is stopped.
    pub fn plan(&self, calibration: &Calibration) -> Result<Option<Plan>, ModelError> {
        let asked = &self.free.options.next;
        if !asked.plan {
            return Ok(None);
        }
        (self.progress)(CalibrationStage::Planning);
        let Calibration { problem, fitted, linearised, statistics, .. } = calibration;
        let candidates = candidates(self.free.scene(), &problem.points, asked);
        // The layer is too expensive for a grid.
        let model: &dyn FrictionModel = if self.free.is_solved() { self.model } else { self.theory };
        plan(problem, model, (&fitted.places, linearised, statistics), &candidates, PLANNED).map(Some)
    }
}

/// What was found at the points of a problem.
fn found_at(problem: &Problem, frictions: &[FrictionParts]) -> Vec<FoundFriction> {
    let found = |(point, parts): (&OperatingPoint, &FrictionParts)| {
        let (place, friction) = (format!("at {}", in_words(point)), parts.friction());
        FoundFriction { place, friction, area: Some(parts.area), rise: None }
    };
    problem.points.iter().zip(frictions).map(found).collect()
}

/// Where a fit led, and what the data say there.
#[derive(Debug)]
pub struct Calibration {
    /// The values that the scene had before.
    pub own: Vec<f64>,
    /// What was measured.
    pub measurements: Measurements,
    /// The measurements that were fitted.
    pub problem: Problem,
    /// Where the fit ended.
    pub fitted: Fitted,
    /// Residuals and derivatives there.
    pub linearised: Linearised,
    /// Errors and identifiability of the parameters.
    pub statistics: Statistics,
    /// Friction of the problem's points.
    pub frictions: Vec<FrictionParts>,
    /// The points that cannot be simulated, and why.
    pub left_out: Vec<(OperatingPoint, NoSliding)>,
    /// A pressure that is too much for the rubber; what of it no rubber has, and why.
    pub implausible: Vec<String>,
    /// How it was fitted.
    pub way: String,
}

/// A number that was fitted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CalibratedParameter {
    /// The path of its key.
    pub key: String,
    /// Its value in the scene.
    pub before: f64,
    /// Its value now.
    pub value: f64,
    /// Its standard error; `None` at a bound, and where the data do not tell it.
    pub standard_error: Option<f64>,
    /// Its 95 % interval; `None` as for the error.
    pub interval: Option<(f64, f64)>,
    /// Whether the data tell it.
    pub is_identifiable: bool,
}

/// Digits of a fitted number.
const DIGITS: usize = 7;

impl Calibration {
    /// The values of the parameters.
    pub fn values(&self) -> Vec<f64> {
        self.problem.values(&self.fitted.places).iter().map(|value| rounded(*value, DIGITS)).collect()
    }

    /// The parameters with their values and errors.
    pub fn parameters(&self) -> Vec<CalibratedParameter> {
        let (statistics, values) = (&self.statistics, self.values());
        let parameter = |(index, parameter): (usize, &FreeParameter)| {
            let is_identifiable = statistics.is_identifiable(index);
            let error = statistics.errors[index].map(|error| parameter.error_of_value(values[index], error));
            CalibratedParameter {
                key: parameter.key.clone(),
                before: self.own[index],
                value: values[index],
                standard_error: error.filter(|_| is_identifiable),
                interval: statistics.intervals[index].filter(|_| is_identifiable),
                is_identifiable,
            }
        };
        self.problem.parameters.iter().enumerate().map(parameter).collect()
    }

    /// Friction at a point that was measured; `None` where it was left out.
    pub fn friction_at(&self, point: &OperatingPoint) -> Option<f64> {
        let index = self.problem.points.iter().position(|other| other == point)?;
        Some(self.frictions[index].friction())
    }

    /// Whether the fit has converged, all numbers are identifiable, and the scene with them can say the data.
    pub fn is_whole(&self) -> bool {
        self.fitted.has_converged && self.statistics.tell_all() && self.statistics.misfit.is_none()
    }

    /// What is left out, and what is not as it should be.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        warnings.extend(self.measurements.left_out_in_words(&self.left_out));
        warnings.extend(self.implausible.iter().cloned());
        if !self.fitted.has_converged {
            warnings.push("the fit has not converged: other bounds or fewer parameters may help".to_owned());
        }
        warnings.extend(self.statistics.misfit.map(|misfit| misfit.to_string()));
        for (parameter, bound) in self.problem.parameters.iter().zip(&self.statistics.at_bound) {
            if let Some(bound) = bound {
                warnings.push(format!("{} is at its bound {}", parameter.key, short(*bound, 4)));
            }
        }
        if !self.statistics.tell_all() {
            let advice = "measure what tells them apart, or fix one of them";
            warnings.push(format!("not all parameters are identifiable: {advice}"));
        }
        warnings
    }
}
