//! The time-stepping driver: steps with their modes held, mode changes settled at their ends.

use super::run::Run;
use super::stepping::{AFTER_FAILURE, OF_PERIOD, Stride, fitted};
use super::{Simulation, SimulationError};
use crate::contact::{End, FixedModeStep, longest_weakening};
use crate::integrator::{Attempt, Integrator, TWO_STAGES, TwoStageDense};
use crate::model::{ChannelEnergies, Model};

/// A new step is this share of what the error allows. Mode changes come unforeseen, so it is less than in smooth
/// motion.
const SAFETY: f64 = 0.8;
/// The least and the most by which one step differs from the one before. A step that grows slowly runs into fewer
/// changes that are too late.
const GROWTH: (f64, f64) = (0.2, 2.0);

impl Simulation {
    /// The next step, by the driver whose turn it is.
    pub(super) fn next_step(&mut self, duration: f64, work: &mut u64) -> Result<Stride, SimulationError> {
        if self.run.stepping { self.time_step(duration, work) } else { self.step(duration, work) }
    }

    /// Tries steps until one is good. The shortest is taken whatever its error: the changes at its end are
    /// settled as those of any other.
    fn time_step(&mut self, duration: f64, work: &mut u64) -> Result<Stride, SimulationError> {
        let remaining = duration - self.run.s;
        let shortest = 4.0 * f64::EPSILON * (self.run.s + 1e-3 * duration);
        let longest = OF_PERIOD * self.run.carrier.shortest_period();
        if longest <= shortest {
            return Err(SimulationError::StepTooSmall { time: self.run.time(), step: longest });
        }
        let mut h = fitted(self.run.step_size.min(longest), remaining);
        loop {
            self.count_work(work)?;
            if let Some(attempt) = self.try_time_step(h, h <= shortest) {
                let grown = h * growth(attempt.error);
                let next = if h < remaining { grown } else { grown.max(self.run.step_size) };
                self.run.step_size = next.min(self.longest_weakening());
                return Ok(Stride { h, share: 1.0 });
            }
            if h <= shortest {
                return Err(SimulationError::StepTooSmall { time: self.run.time(), step: h });
            }
            h = self.run.step_size.max(shortest);
        }
    }

    /// The longest step, s, that lets contacts swing up whose friction falls with the speed they have at the end of the
    /// step tried last.
    fn longest_weakening(&self) -> f64 {
        longest_weakening(&self.model, self.integrator.end())
    }

    /// Tries a step of length `h`; `None` where it is no good, and the run's step size is then a better one.
    pub(super) fn try_time_step(&mut self, h: f64, any_error: bool) -> Option<Attempt> {
        self.within_at = None;
        let (run, tolerance) = (&self.run, &self.settings.tolerance);
        let attempt = self.integrator.attempt_two_stages(&self.model, &run.state, &run.carrier, (run.s, h), tolerance);
        let attempt = attempt.ok().map(|attempt| self.with_lateness(h, attempt));
        let error = attempt.map_or(f64::NAN, |attempt| attempt.error);
        if error <= 1.0 || (any_error && error.is_finite()) {
            return attempt;
        }
        self.run.counters.rejected += 1;
        self.run.step_size = h * if error.is_finite() { growth(error).min(SAFETY) } else { AFTER_FAILURE };
        None
    }

    /// The step of length `h` tried last with what the lateness of its mode changes adds to its error.
    fn with_lateness(&mut self, h: f64, attempt: Attempt) -> Attempt {
        let step = within(&self.model, &self.run, &self.integrator, h);
        let late = self.step_end.find(&step, &self.settings.tolerance);
        Attempt { error: attempt.error.hypot(late), ..attempt }
    }

    /// Settles the mode changes of the step of length `h` tried last, and takes it.
    pub(super) fn accept_time_step(&mut self, h: f64, end: f64) {
        let accounts = self.settings.accounts.energy;
        let gain = accounts.then(|| self.integrator.two_stage_energies(&self.model, &self.run.state, h, 1.0));
        let run = &mut self.run;
        self.within_at = None;
        self.within.mode.copy_from_slice(&run.state.mode);
        let (state, forces, rates, first) = self.integrator.open_end();
        let span = (run.s, h);
        let step = FixedModeStep { model: &self.model, carrier: &run.carrier, span, start: &run.state, first };
        let settled = self.step_end.settle(step, End { state, forces, rates });
        if let Some(gain) = gain {
            let energies = &mut run.energies;
            energies.channels.add(&gain);
            energies.channels.add(&settled.map_or_else(ChannelEnergies::default, |settled| settled.channels));
            energies.impact += settled.map_or(0.0, |settled| settled.impact);
        }
        self.integrator.accept_two_stages(&mut run.state);
        run.counters.steps += 1;
        run.s = end;
        if settled.is_some() {
            self.integrator.refresh_tangents_after(&self.model, &run.state, end);
            self.count_mode_changes();
        }
    }

    /// The state at the fraction `theta` of the time step of length `h` tried last, into `within`.
    pub(super) fn look_within_time_step(&mut self, h: f64, theta: f64) {
        self.integrator.first_stage_maxwell(&self.model, &self.run.state, &mut self.within.maxwell);
        within(&self.model, &self.run, &self.integrator, h).state_at(theta, &mut self.within);
    }
}

fn within<'a>(model: &'a Model, run: &'a Run, integrator: &'a Integrator, h: f64) -> TwoStageDense<'a> {
    let stages = integrator.stages();
    let (start, end) = ((&run.state, &stages[1]), (integrator.end(), &stages[TWO_STAGES - 1]));
    TwoStageDense::new(model, &run.carrier, (run.s, h), start, end)
}

/// How much longer or shorter a step may be than one with this error over the tolerance.
fn growth(error: f64) -> f64 {
    (SAFETY / error.sqrt()).clamp(GROWTH.0, GROWTH.1)
}
