//! The end-of-step contact correction of the time-stepping driver: touches and lifts within a step are made at its end.
//!
//! A step finds stops and breaks by itself (`integrator`), but free masses stay free in it and contacts in contact. The
//! state at its end shows where that was wrong: a free mass is below the profile, a contact has F_N < 0; or a mass that
//! stopped on the way is not held by the forces alone. The step is not repeated. Only the masses concerned are
//! corrected:
//!
//! - A mass below the profile goes back to the instant of its touch, has its impact there, and moves along the profile
//!   for the remaining time of the step. Its dashpots follow, and the lateral dampers pass its displacement on to the
//!   neighbours as impulses.
//! - Lifts and such breaks begin at the end of the step, since only the forces went past their limits.
//!
//! Then the rules of docs/model.md decide on these masses and their neighbours by the forces as they are.
//!
//! So a step takes any number of mode changes at its own cost. The error of their instants falls with the square of the
//! step's length, like that of the method; it is estimated together with that one, and where it is too large the step
//! is shortened. Repeating the step with the modes of its end would cost the stages again, and make the changes too
//! early instead of too late.
//!
//! A corrected mass has received impulses that the step as tried does not know, and so have its neighbours. The
//! energies count each impulse with the mean of the velocities before and after it: so the energy balance is closed
//! however strong a damper or the friction is.

use super::touch_correction::{CorrectionEnergies, FixedModeStep, TouchCorrection, forces_of_touch};
use crate::integrator::{OpenEnd, Parabolas, Tolerance};
use crate::math::SplineBounds;
use crate::model::{LinkKind, Mode, Model};
use crate::scene::ByAxis;

/// Weight of the late instants of mode changes in the error of a step of a layer of one mass. It falls with the root of
/// the number of masses k: forces of a layer are sums, of which one mass makes a share of 1/k, and its share in a mean
/// of squares is 1/√k.
///
/// Recommended 20 to 60. With less, single late changes are the largest errors of a layer's forces; with more, steps
/// become shorter where many masses touch and lift.
const EVENT_TIME_WEIGHT: f64 = 30.0;
/// The largest weight.
///
/// Recommended 5 to 20. With more, a layer of few masses takes short steps at every touch.
const MAX_EVENT_TIME_WEIGHT: f64 = 10.0;
/// The relative tolerance below which that weight grows, with the root of its ratio to the tolerance.
///
/// Recommended 3e-4 to 3e-3. The finer the steps, the fewer changes one has, and the less a mean over all masses says
/// of each: with a constant weight, forces just after a change were 10 to 200 tolerances off at 1e-6.
const GROWS_BELOW: f64 = 1e-3;

/// Number of masses to each side that a correction concerns: the neighbours receive impulses, and their neighbours the
/// forces that these change.
const REACH: usize = 2;

/// The end-of-step correction: the masses whose modes were violated in a step, and workspace.
#[derive(Clone, Debug)]
pub struct EndCorrection {
    /// Free masses that are below the profile at the end.
    touches: Vec<usize>,
    /// Contacts whose mode is to be decided anew at the end: F_N < 0, or a stick beyond T(0).
    changed: Vec<usize>,
    /// Bound of the change of the forces on the carrier by the correction, N.
    force: f64,
    /// The fraction of the step up to which all contacts press.
    pressed: f64,
    /// By mass: whether a correction changes its forces.
    concerned: Vec<bool>,
    profile: SplineBounds,
}

impl EndCorrection {
    /// Workspace for the time steps of `model`, if there `may_be` any.
    pub fn new(model: &Model, may_be: bool) -> Self {
        let k = if may_be { model.masses() } else { 0 };
        Self {
            touches: Vec::with_capacity(k),
            changed: Vec::with_capacity(k),
            force: 0.0,
            pressed: 1.0,
            concerned: vec![false; k],
            profile: model.profile.bounds(),
        }
    }

    /// Finds the masses whose modes were violated in `step`. Returns the error of their late instants over the
    /// tolerance, as a mean over all masses.
    pub fn detect(&mut self, step: &Parabolas<'_>, tolerance: &Tolerance) -> f64 {
        self.touches.clear();
        self.changed.clear();
        (self.force, self.pressed) = (0.0, 1.0);
        let frequency = step.model.frequency_without_rods();
        let stiffness = step.model.mass * frequency * frequency;
        let of_layer = (EVENT_TIME_WEIGHT / (step.model.masses() as f64).sqrt()).min(MAX_EVENT_TIME_WEIGHT);
        let weight = of_layer * (GROWS_BELOW / tolerance.relative).sqrt().max(1.0);
        let mut sum = 0.0;
        for i in 0..step.model.masses() {
            let late = match step.end.mode[i] {
                Mode::Free => self.detect_touch(step, i),
                _ => self.detect_lift(step, i, stiffness).or_else(|| self.detect_stop(step, i)),
            };
            if let Some(late) = late {
                let error = weight * late.error(frequency);
                sum += error * error / tolerance.position_tolerance_sq(step.end.elongation_x[i]);
            }
        }
        (sum / step.model.masses() as f64).sqrt()
    }

    /// Bound of the change that the correction of what [`detect`](Self::detect) found makes in the forces on the
    /// carrier, N: the forces of springs and dampers by the penetrations, and those past the limits.
    pub fn uncorrected_force(&self) -> f64 {
        self.force
    }

    /// Whether the touches and lifts that [`detect`](Self::detect) found in `step` come after its fraction `theta`. Of
    /// dips, which the correction leaves alone, and of breaks, which begin at the end, nothing is asked.
    pub fn comes_after(&self, step: &Parabolas<'_>, theta: f64) -> bool {
        theta <= self.pressed && self.touches.iter().all(|&i| step.gap(i, theta) >= 0.0)
    }

    /// How late the touch of free mass `i` is, if there is one.
    fn detect_touch(&mut self, step: &Parabolas<'_>, i: usize) -> Option<EventTimeError> {
        let (height, highest) = (step.end_height(i), self.profile.z_max);
        if height > highest && step.height(i, Parabolas::FIRST_STAGE) > highest {
            return None;
        }
        let x = step.end_position(i);
        let surface = step.model.surface_at(x);
        let gap = height - surface.height;
        if gap >= 0.0 {
            return self.detect_dip(step, i, gap, (x, height));
        }
        self.touches.push(i);
        let closing = surface.slope * step.end.velocity_x[i] - step.end.velocity_z[i];
        self.force += step.model.links[LinkKind::Vertical].force(-gap, closing.max(0.0));
        let time = if closing > 0.0 { (-gap / closing).min(step.span.length) } else { step.span.length };
        Some(EventTimeError { length: -gap, time })
    }

    /// A mass that is above the profile at the end, at `x` and `height` and by `gap`, and below it at the first stage
    /// has passed through an asperity: the whole penetration is an error.
    fn detect_dip(&self, step: &Parabolas<'_>, i: usize, gap: f64, (x, height): (f64, f64)) -> Option<EventTimeError> {
        let rise = height - step.height(i, Parabolas::FIRST_STAGE);
        let distance = (x - step.position(i, Parabolas::FIRST_STAGE)).abs();
        if gap > rise + distance * self.profile.slope_max_abs {
            return None;
        }
        let gap_at_first = step.gap(i, Parabolas::FIRST_STAGE);
        (gap_at_first < 0.0).then_some(EventTimeError { length: -gap_at_first, time: f64::INFINITY })
    }

    /// How late the lift of contact `i` is, if F_N < 0, by the elongation that makes such a force.
    fn detect_lift(&mut self, step: &Parabolas<'_>, i: usize, stiffness: f64) -> Option<EventTimeError> {
        let (first, last) = (step.first.normal[i], step.last.normal[i]);
        if last >= 0.0 {
            return None;
        }
        self.changed.push(i);
        self.force -= last;
        let time = step.time_below(first, last);
        self.pressed = self.pressed.min(1.0 - time / step.span.length);
        Some(EventTimeError { length: -last / stiffness, time })
    }

    /// How late a contact sticks that slipped at the start and sticks at the first stage already: none of the way of
    /// its stop is seen. One that the forces alone would no longer hold breaks loose at the end.
    fn detect_stop(&mut self, step: &Parabolas<'_>, i: usize) -> Option<EventTimeError> {
        if step.end.mode[i] != Mode::Stick {
            return None;
        }
        if step.last.margin[i] < 0.0 {
            self.changed.push(i);
        }
        let speed = step.start.velocity_x[i].hypot(step.start.velocity_z[i]);
        if speed == 0.0 || step.first.velocity_x[i] != 0.0 {
            return None;
        }
        let stopping = step.model.mass * speed / step.first.margin[i];
        let time = if stopping >= 0.0 { stopping.min(step.span.length) } else { step.span.length };
        Some(EventTimeError { length: 0.5 * speed * time, time: f64::INFINITY })
    }

    /// What the touches that [`detect`](Self::detect) found before the fraction `theta` of `step` add to F_x and F_z
    /// there, N: the forces of the links to the carrier of masses that have had their impacts and lie on the profile.
    pub fn forces_of_touches(&self, step: &Parabolas<'_>, theta: f64) -> ByAxis<f64> {
        let forces = self.touches.iter().map(|&i| forces_of_touch(step, i, theta));
        forces.fold(ByAxis::default(), |sum, force| sum + force)
    }

    /// Corrects the masses that [`detect`](Self::detect) found; `None` where there are none.
    pub fn apply(&mut self, step: FixedModeStep<'_>, end: OpenEnd<'_>) -> Option<CorrectionEnergies> {
        if self.touches.is_empty() && self.changed.is_empty() {
            return None;
        }
        let mut correction = TouchCorrection::new(step, end);
        for &i in &self.touches {
            correction.touch(i);
        }
        for &i in self.touches.iter().chain(&self.changed) {
            let end = (i + REACH + 1).min(self.concerned.len());
            self.concerned[i.saturating_sub(REACH)..end].fill(true);
        }
        for (j, concerned) in self.concerned.iter_mut().enumerate().filter(|(_, concerned)| **concerned) {
            correction.decide(j);
            *concerned = false;
        }
        Some(correction.energies)
    }
}

/// How late a mode change is.
#[derive(Clone, Copy, Debug)]
struct EventTimeError {
    /// How far the mass goes past the limit, m.
    length: f64,
    /// For how long, s.
    time: f64,
}

impl EventTimeError {
    /// The error that remains after the correction, m: in a time that is short against 1/ω of the highest frequency ω
    /// the forces past the limit move the mass little.
    fn error(self, frequency: f64) -> f64 {
        self.length * (frequency * self.time).min(1.0)
    }
}

impl Parabolas<'_> {
    /// For how long a quantity with the values `first` at the first stage and `last` < 0 at the end has been negative,
    /// s, by the line through them.
    fn time_below(&self, first: f64, last: f64) -> f64 {
        let fall = (first - last) / (1.0 - Self::FIRST_STAGE);
        self.span.length * if fall > -last { -last / fall } else { 1.0 }
    }
}
