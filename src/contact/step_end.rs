//! Mode changes of the time-stepping driver: what comes about within a step is settled at its end.
//!
//! A step holds its modes, and the state at its end shows which could not last: a free mass is below the profile, a
//! contact has F_N < 0, a slip has reversed, a stick is past T. The step is not repeated with other modes; only the
//! masses concerned are put right. One that fell below the profile goes back to the instant of its touch, has its
//! impact there, and goes on along the profile for what is left of the step; its dashpots follow it, and the dampers
//! pass its way on to the neighbours. A slip that reversed stops. Lifts and breaks begin at the end, as the forces
//! alone went too far. Then the rules of model.md decide on all of them and their neighbours by the forces as they are.
//!
//! So a step takes any number of mode changes, at its own cost. What their lateness leaves falls with the square of the
//! step's length, as the method's error does; it is measured with it, and where it is too large the step is shortened.
//! Repeating the step with the modes of its end would cost the stages again, and put changes too early in place of too
//! late.

use super::settling::{Correction, CorrectionEnergies, End, FixedModeStep};
use crate::integrator::{Tolerance, TwoStageDense};
use crate::math::Bounds;
use crate::model::{LinkKind, Mode, Model};

/// How much the lateness of mode changes weighs in the error of a step.
///
/// Recommended 3 to 10. With 5, masses that touch and lift at a relative tolerance of 1e-2 add errors of some 1e-2 to
/// the forces of a layer; larger costs rejected steps where many do.
const LATENESS: f64 = 5.0;

/// How many masses to each side feel that one is put right: the neighbours get impulses, and theirs feel these.
const REACH: usize = 2;

/// The masses whose modes could not last through a step, and workspace for them.
#[derive(Clone, Debug)]
pub struct EndCorrection {
    /// Free masses below the profile at the end.
    touches: Vec<usize>,
    /// Contacts past a limit at the end.
    contacts: Vec<usize>,
    /// By how much settling them may change the forces on the carrier, N.
    force: f64,
    /// The masses whose forces these change.
    concerned: Vec<bool>,
    /// The extremes of the profile.
    profile: Bounds,
    /// [`Model::long_term_stiffness`], N/m: what a friction force that went too far counts by.
    lasting: Option<f64>,
}

impl EndCorrection {
    /// Room for the mode changes of a step of `model`.
    pub fn new(model: &Model) -> Self {
        let k = model.masses();
        Self {
            touches: Vec::with_capacity(k),
            contacts: Vec::with_capacity(k),
            force: 0.0,
            concerned: vec![false; k],
            profile: model.profile.bounds(),
            lasting: model.long_term_stiffness(),
        }
    }

    /// Finds the modes that could not last; their lateness over the tolerance, in the mean of all masses.
    pub fn find(&mut self, step: &TwoStageDense<'_>, tolerance: &Tolerance) -> f64 {
        self.touches.clear();
        self.contacts.clear();
        self.force = 0.0;
        let frequency = step.model.frequency_without_rods();
        let stiffness = step.model.mass * frequency * frequency;
        let mut sum = 0.0;
        for i in 0..step.model.masses() {
            let late = match step.end.mode[i] {
                Mode::Free => self.find_touch(step, i),
                _ => self.find_limit(step, i, stiffness),
            };
            if let Some(late) = late {
                let error = LATENESS * late.error(frequency);
                sum += error * error / tolerance.of_position(step.end.elongation_x[i]);
            }
        }
        (sum / step.model.masses() as f64).sqrt()
    }

    fn is_settled(&self) -> bool {
        self.touches.is_empty() && self.contacts.is_empty()
    }

    /// By how much settling what [`find`](Self::find) found may change the forces on the carrier, N: by the springs'
    /// and the dampers' forces of what goes below the profile, and by what goes past the limits.
    pub fn unsettled_force(&self) -> f64 {
        self.force
    }

    /// How late free mass `i` touches.
    fn find_touch(&mut self, step: &TwoStageDense<'_>, i: usize) -> Option<Late> {
        let height = step.height(i, 1.0);
        if height.min(step.height(i, TwoStageDense::FIRST)) > self.profile.z_max {
            return None;
        }
        let surface = step.model.surface_at(step.place(i, 1.0));
        let gap = height - surface.height;
        if gap >= 0.0 {
            return self.find_dip(step, i, gap);
        }
        self.touches.push(i);
        let closing = surface.slope * step.end.velocity_x[i] - step.end.velocity_z[i];
        let link = &step.model.links[LinkKind::Vertical as usize];
        self.force += link.stiffness * -gap + link.damping * closing.max(0.0);
        let time = if closing > 0.0 { (-gap / closing).min(step.span.1) } else { step.span.1 };
        Some(Late { length: -gap, time })
    }

    /// A mass above the profile at the end, by `gap`, that is below at the first stage has gone through an asperity:
    /// all of that is an error.
    fn find_dip(&self, step: &TwoStageDense<'_>, i: usize, gap: f64) -> Option<Late> {
        let rise = step.height(i, 1.0) - step.height(i, TwoStageDense::FIRST);
        let way = (step.place(i, 1.0) - step.place(i, TwoStageDense::FIRST)).abs();
        if gap > rise + way * self.profile.slope_max_abs {
            return None;
        }
        let dip = step.gap(i, TwoStageDense::FIRST);
        (dip < 0.0).then_some(Late { length: -dip, time: f64::INFINITY })
    }

    /// How far contact `i` is past a limit: by the elongation that makes such a force, or by the way that it slipped
    /// back.
    fn find_limit(&mut self, step: &TwoStageDense<'_>, i: usize, stiffness: f64) -> Option<Late> {
        let (first, last) = (step.first, step.last);
        let late = if last.normal[i] < 0.0 {
            let time = step.time_below(first.normal[i], last.normal[i]);
            Late { length: -last.normal[i] / stiffness, time }
        } else if step.model.has_friction && last.margin[i] < 0.0 {
            let time = step.time_below(first.margin[i], last.margin[i]);
            let lasting = self.lasting.unwrap_or(stiffness);
            let unit = if step.end.mode[i] == Mode::Stick { 1.0 / lasting } else { 0.5 * time };
            Late { length: -last.margin[i] * unit, time }
        } else {
            return None;
        };
        self.contacts.push(i);
        self.force += stiffness * late.length;
        Some(late)
    }

    /// Settles what [`find`](Self::find) found; `None` where that is nothing.
    pub fn settle(&mut self, step: FixedModeStep<'_>, end: End<'_>) -> Option<CorrectionEnergies> {
        if self.is_settled() {
            return None;
        }
        let mut settling = Correction::new(step, end);
        for &i in &self.touches {
            settling.touch(i);
        }
        for &i in &self.contacts {
            settling.stop(i);
        }
        for &i in self.touches.iter().chain(&self.contacts) {
            let end = (i + REACH + 1).min(self.concerned.len());
            self.concerned[i.saturating_sub(REACH)..end].fill(true);
        }
        for (j, concerned) in self.concerned.iter_mut().enumerate().filter(|(_, concerned)| **concerned) {
            settling.decide(j);
            *concerned = false;
        }
        Some(settling.settled())
    }
}

/// How late a mode change is.
#[derive(Clone, Copy, Debug)]
struct Late {
    /// By what length it goes too far, m.
    length: f64,
    /// For how long, s.
    time: f64,
}

impl Late {
    /// The error, m, that is left after it has been put right: in a time that is short against 1/ω of the stiffest
    /// frequency ω the forces that went too far move little.
    fn error(self, frequency: f64) -> f64 {
        self.length * (frequency * self.time).min(1.0)
    }
}

impl TwoStageDense<'_> {
    /// The height of mass `i` above the profile at the fraction `theta` of the step, m.
    pub(super) fn gap(&self, i: usize, theta: f64) -> f64 {
        self.height(i, theta) - self.model.surface_at(self.place(i, theta)).height
    }

    /// For how long a quantity that is `first` at the first stage and `last` < 0 at the end has been negative, s, by
    /// the line through them.
    fn time_below(&self, first: f64, last: f64) -> f64 {
        let fall = (first - last) / (1.0 - Self::FIRST);
        self.span.1 * if fall > -last { -last / fall } else { 1.0 }
    }
}
