//! Friction and area of a run.

use asperity::element::{Load, OperatingPoint};
use asperity::scene::Scene;

use super::table::Measured;
use super::verdict::Pair;
use crate::Error;
use crate::steady::{SlidingRubber, SteadySolver};
use crate::sweep::{Method, NotSteady, SlidingOptions, StopBounds, SweepMethod, steady_sliding};

/// Why a run has no friction and area.
#[derive(Debug, thiserror::Error)]
pub(super) enum RunError {
    #[error(transparent)]
    NotSteady(#[from] NotSteady),
    #[error(transparent)]
    Method(#[from] Error),
    #[error("{0} points are too many")]
    TooManyPoints(u64),
    #[error("not to be solved for")]
    NotSolved,
    #[error("the layer has no width")]
    NoWidth,
}

/// A state of steady sliding.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    /// Mean pressure, Pa.
    pub(super) pressure: f64,
    /// Sliding speed, m/s.
    pub(super) speed: f64,
    /// The way that rubber as warm as the scene has slid, m; `None`: its surface is as warm.
    pub(super) way: Option<f64>,
}

/// Friction and area in steady sliding, solved for on so many points along x.
pub(super) fn solve(scene: &Scene, state: State, points: u64) -> Result<Measured, RunError> {
    let few = u32::try_from(points).map_err(|_| RunError::TooManyPoints(points))?;
    let asked = SlidingOptions { method: Some(SweepMethod::Steady), points: Some(few), ..SlidingOptions::default() };
    let (Method::Steady(surface), _) = asked.choose(scene)? else { return Err(RunError::NotSolved) };
    let rubber = SlidingRubber::new(scene).ok_or(RunError::NotSolved)?;
    let slide = SteadySolver::new(surface).slide_over(&rubber, state.speed, state.pressure, state.way);
    if let Some(problem) = slide.problem().filter(|problem| !problem.is_result()) {
        return Err(NotSteady::from(problem).into());
    }
    // It does not jam.
    let friction = slide.friction().unwrap_or_default();
    Ok(Measured {
        mean: Pair { friction, area: slide.area },
        error: Pair { friction: 0.0, area: 0.0 },
        hysteresis: slide.hysteresis.unwrap_or_default(),
    })
}

/// Friction and area of the layer in steady sliding, known to `bounds`.
pub(super) fn slide(scene: &Scene, state: State, bounds: StopBounds) -> Result<Measured, RunError> {
    let area = scene.layer.area().ok_or(RunError::NoWidth)?;
    let point = OperatingPoint { speed: state.speed, load: state.pressure, temperature: None, way: None };
    let sliding = steady_sliding(scene, &point, Load::Pressure { area }, bounds)?;
    Ok(Measured {
        mean: Pair { friction: sliding.friction(), area: sliding.contact_ratio },
        error: Pair { friction: sliding.friction_error, area: sliding.contact_error },
        hysteresis: sliding.hysteresis(),
    })
}
