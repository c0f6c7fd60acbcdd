//! Which mode change comes first within a step.

use super::gap::first_touch;
use crate::integrator::{DenseOutput, DenseWorkspace, METHOD, Rates, STAGES, Tolerance};
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

/// How many roundings a force may be off by.
const ROUNDINGS: f64 = 4.0;

impl EventTolerance {
    /// The tolerances that go with those of the steps.
    pub fn new(model: &Model, tolerance: &Tolerance) -> Self {
        let felt = || model.mass_stiffness_without_rods().max(model.mass * model.frequency_without_rods().powi(2));
        let stiffness = model.long_term_stiffness().unwrap_or_else(felt);
        // A rod makes a force of the rounding of its elongation: of the layer's height, the absolute tolerance over the
        // relative one, at most.
        let height = tolerance.position / tolerance.relative;
        let rounding = ROUNDINGS * f64::EPSILON * height * model.rounding_stiffness();
        Self {
            gap: SHARE * tolerance.position,
            velocity: SHARE * tolerance.velocity,
            force: (SHARE * tolerance.position * stiffness).max(rounding),
        }
    }

    /// The tolerance of [`Rates::margin`] in `mode`.
    fn margin(&self, mode: Mode) -> f64 {
        if mode == Mode::Stick { self.force } else { self.velocity }
    }
}

/// The fraction of the step at which the first mode change is due; `None` where none is.
pub fn first_event(
    step: &DenseOutput<'_>,
    stages: &[Rates],
    tolerance: &EventTolerance,
    workspace: &mut DenseWorkspace,
) -> Option<f64> {
    let mut first = Contacts { step, stages, tolerance, workspace }.first_change();
    for i in 0..step.model.masses() {
        if step.start.0.mode[i] == Mode::Free {
            first = earlier(first, first_touch(&step.model.profile, || step.place(i), step.height(i), tolerance.gap));
        }
    }
    first
}

fn earlier(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

/// The contacts through a step: where a stage shows a limit passed, the dense output is asked, which is more accurate
/// than the stages are and from which the run goes on.
struct Contacts<'a> {
    step: &'a DenseOutput<'a>,
    stages: &'a [Rates],
    tolerance: &'a EventTolerance,
    workspace: &'a mut DenseWorkspace,
}

/// What of a contact may pass its limit.
#[derive(Clone, Copy, PartialEq)]
enum Limit {
    /// F_N ≥ 0.
    Normal,
    /// [`Rates::margin`] ≥ 0.
    Margin,
}

impl Contacts<'_> {
    fn first_change(&mut self) -> Option<f64> {
        let mut first = None;
        let force = self.tolerance.force;
        if self.stages[1..].iter().any(|stage| any_below(&stage.normal, -force)) {
            for i in 0..self.step.model.masses() {
                first = self.fall(i, Limit::Normal, force, first);
            }
        }
        let margin = self.tolerance.velocity.min(force);
        if self.stages[1..].iter().any(|stage| any_below(&stage.margin, -margin)) {
            for i in 0..self.step.model.masses() {
                let mode = self.step.start.0.mode[i];
                first = self.fall(i, Limit::Margin, self.tolerance.margin(mode), first);
            }
        }
        first
    }

    /// Where a quantity of mass `i` first falls below -`tolerance`, aimed at -`tolerance`/2; `first` where it does not
    /// before that.
    fn fall(&mut self, i: usize, limit: Limit, tolerance: f64, first: Option<f64>) -> Option<f64> {
        let latest = first.unwrap_or(1.0);
        let place = (1..STAGES).find(|&place| self.at_stage(place, i, limit) < -tolerance);
        let Some(place) = place.filter(|&place| METHOD.c[IN_TIME[place - 1]] < latest) else { return first };
        let falls_until = |contacts: &mut Self, place: usize| {
            let theta = METHOD.c[IN_TIME[place]].min(latest);
            contacts.at_stage(place, i, limit) < -tolerance && contacts.value(i, limit, theta) < -tolerance
        };
        let Some(below) = (place..STAGES).find(|&place| falls_until(self, place)) else { return first };
        let aim = 0.5 * tolerance;
        let bracket = (METHOD.c[IN_TIME[below - 1]].min(latest), METHOD.c[IN_TIME[below]].min(latest));
        if self.value(i, limit, bracket.0) <= -aim {
            return Some(bracket.0);
        }
        Some(bracketed_root(|theta| self.value(i, limit, theta) + aim, bracket, LOCATED))
    }

    /// The quantity at the stage that is `place`-th in time.
    fn at_stage(&self, place: usize, i: usize, limit: Limit) -> f64 {
        let stage = &self.stages[IN_TIME[place]];
        if limit == Limit::Normal { stage.normal[i] } else { stage.margin[i] }
    }

    /// The quantity at the fraction `theta` of the step.
    fn value(&mut self, i: usize, limit: Limit, theta: f64) -> f64 {
        let mode = self.step.start.0.mode[i];
        if limit == Limit::Margin && mode.slips() {
            return mode.direction() * self.step.velocity_x(i, theta);
        }
        let contact = self.step.contact(i, theta, self.workspace);
        if limit == Limit::Normal { contact.normal } else { contact.limit - contact.tangential.abs() }
    }
}

/// Share of a step to which an event is located: far below what the tolerances can tell apart.
const LOCATED: f64 = 1e-12;

fn any_below(values: &[f64], limit: f64) -> bool {
    values.iter().fold(f64::MAX, |least, &value| if value < least { value } else { least }) < limit
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

/// Share of an event tolerance by which a limit must be passed for the event to have come.
const PASSED: f64 = 0.05;

/// Whether at the end of a step an event has come: `state` and `rates` are those there.
pub fn is_due(model: &Model, state: &State, rates: &Rates, (place, w): (f64, f64), tolerance: &EventTolerance) -> bool {
    (0..model.masses()).any(|i| match state.mode[i] {
        Mode::Free => {
            let surface = model.surface_at(model.rest_x[i] + (place + state.elongation_x[i]));
            let gap = model.rest_z[i] + (w + state.elongation_z[i]) - surface.height;
            gap < -PASSED * tolerance.gap && state.velocity_z[i] < surface.slope * state.velocity_x[i]
        }
        mode => {
            rates.normal[i] < -PASSED * tolerance.force
                || (model.has_friction && rates.margin[i] < -PASSED * tolerance.margin(mode))
        }
    })
}
