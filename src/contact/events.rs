//! Which mode change comes first within a step.

use super::gap::first_touch;
use crate::integrator::{Dense, METHOD, Rates, STAGES, Tolerance};
use crate::math::bracketed_root;
use crate::model::{Mode, Model, State};

/// How far a quantity may pass its limit before the mode changes. An event is located where it is half that far past,
/// so that after it the limit is passed without doubt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EventTolerance {
    /// Of the gap, m.
    pub gap: f64,
    /// Of the velocity of a slipping mass, m/s.
    pub velocity: f64,
    /// Of the normal force, and of the tangential force of a sticking mass, N.
    pub force: f64,
}

/// Share of the step tolerances that events may take.
///
/// Recommended 0.01 to 1. The error of a late lift, break or stop grows with the square of its delay, so these are not
/// what limits the accuracy; smaller only costs steps.
const SHARE: f64 = 0.1;

impl EventTolerance {
    /// The tolerances that go with those of the steps.
    pub fn new(model: &Model, tolerance: &Tolerance) -> Self {
        let stiffness = model.glassy_stiffness().max(model.mass * model.stiffest_frequency().powi(2));
        Self {
            gap: SHARE * tolerance.position,
            velocity: SHARE * tolerance.velocity,
            force: SHARE * tolerance.position * stiffness,
        }
    }

    /// The tolerance of [`Rates::margin`] in `mode`.
    fn margin(&self, mode: Mode) -> f64 {
        if mode == Mode::Stick { self.force } else { self.velocity }
    }
}

/// The fraction of the step at which the first mode change is due; `None` where none is.
pub fn first_event(step: &Dense<'_>, stages: &[Rates], tolerance: &EventTolerance) -> Option<f64> {
    let mut first = None;
    for i in 0..step.model.masses() {
        let event = match step.start.0.mode[i] {
            Mode::Free => touch(step, i, tolerance.gap),
            mode => {
                let lift = fall(|stage| stages[stage].normal[i], tolerance.force);
                let change = step
                    .model
                    .has_friction
                    .then(|| fall(|stage| stages[stage].margin[i], tolerance.margin(mode)))
                    .flatten();
                earlier(lift, change)
            }
        };
        first = earlier(first, event);
    }
    first
}

fn earlier(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

fn touch(step: &Dense<'_>, i: usize, tolerance: f64) -> Option<f64> {
    first_touch(&step.model.profile, &step.place(i), &step.height(i), tolerance)
}

/// The stages in the order of time.
const IN_TIME: [usize; STAGES] = in_time();

const fn in_time() -> [usize; STAGES] {
    let mut order = [0; STAGES];
    let mut i = 0;
    while i < STAGES {
        let mut place = i;
        while place > 0 && METHOD.c[order[place - 1]] > METHOD.c[i] {
            order[place] = order[place - 1];
            place -= 1;
        }
        order[place] = i;
        i += 1;
    }
    order
}

/// Where a quantity, known at the stages, first falls below -`tolerance`: on the polynomial through the stages, aimed at
/// -`tolerance`/2.
fn fall(value: impl Fn(usize) -> f64, tolerance: f64) -> Option<f64> {
    let below = IN_TIME.iter().position(|&stage| value(stage) < -tolerance)?;
    let aim = 0.5 * tolerance;
    let before = below.checked_sub(1)?;
    let bracket = (METHOD.c[IN_TIME[before]], METHOD.c[IN_TIME[below]]);
    if value(IN_TIME[before]) <= -aim {
        return Some(bracket.0);
    }
    Some(bracketed_root(|theta| interpolate(&value, theta) + aim, bracket, 1e-15))
}

/// Lagrange's polynomial through the values at the stages.
fn interpolate(value: &impl Fn(usize) -> f64, theta: f64) -> f64 {
    let c = &METHOD.c;
    let mut sum = 0.0;
    for i in 0..STAGES {
        let basis: f64 = (0..STAGES).filter(|&j| j != i).map(|j| (theta - c[j]) / (c[i] - c[j])).product();
        sum += basis * value(i);
    }
    sum
}

/// Share of an event tolerance by which a limit must be passed for the event to have come.
const PASSED: f64 = 0.05;

/// Whether at the end of a step an event has come: `state` and `rates` are those there.
pub fn is_due(model: &Model, state: &State, rates: &Rates, (place, w): (f64, f64), tolerance: &EventTolerance) -> bool {
    (0..model.masses()).any(|i| match state.mode[i] {
        Mode::Free => {
            let ground = model.ground(model.rest_x[i] + (place + state.elongation_x[i]));
            let gap = model.rest_z[i] + (w + state.elongation_z[i]) - ground.height;
            gap < -PASSED * tolerance.gap && state.velocity_z[i] < ground.slope * state.velocity_x[i]
        }
        mode => {
            rates.normal[i] < -PASSED * tolerance.force
                || (model.has_friction && rates.margin[i] < -PASSED * tolerance.margin(mode))
        }
    })
}
