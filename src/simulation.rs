//! The conductor: joins the integrator and the contact rules into a run.

use crate::outputs::Variable;
use crate::scene::{Path, Scene};

/// The carrier at the start of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Start {
    /// Time t_0, s.
    pub time: f64,
    /// Displacement along x, m.
    pub u: f64,
    /// Displacement along z, m; negative presses.
    pub w: f64,
    /// u̇ just after the start, m/s: the velocity that the layer starts with.
    pub u_rate: f64,
    /// ẇ just after the start, m/s.
    pub w_rate: f64,
}

/// One smooth piece of the carrier's motion, from where the carrier stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Duration, s.
    pub duration: f64,
    /// Displacement along x.
    pub u: Path,
    /// Displacement along z.
    pub w: Path,
}

/// Why a run could not go on; the simulation is as it was before the call.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// The steps allowed were used up.
    #[error("gave up at t = {time} s after {steps} steps, the limit solver.max_steps")]
    TooManySteps {
        /// Where the run stood, s.
        time: f64,
        /// The limit.
        steps: u64,
    },
    /// The step size fell to the resolution of time.
    #[error("the step size fell to {step} s at t = {time} s")]
    StepTooSmall {
        /// Where the run stood, s.
        time: f64,
        /// The step size, s.
        step: f64,
    },
    /// The carrier's motion is not a number, or not finite.
    #[error("the carrier's motion is not finite: {what} = {value}")]
    NotFinite {
        /// Which quantity.
        what: &'static str,
        /// Its value.
        value: f64,
    },
}

/// What happened to one mass at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeChange {
    /// When, s.
    pub time: f64,
    /// Which mass, from 0.
    pub mass: usize,
    /// Mode before: 0 free, 1 or -1 slipping, 2 sticking.
    pub from: i8,
    /// Mode after.
    pub to: i8,
}

/// A run of a scene.
#[derive(Clone, Debug)]
pub struct Simulation {
    time: f64,
}

impl Simulation {
    /// Puts the layer under the carrier at rest or in motion (`model.md` section 5).
    ///
    /// # Errors
    /// [`SimulationError::NotFinite`] where `start` is not finite.
    pub fn new(_scene: &Scene, start: &Start) -> Result<Self, SimulationError> {
        Ok(Self { time: start.time })
    }

    /// The time reached, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Follows `motion` to its end.
    ///
    /// # Errors
    /// [`SimulationError`]; the simulation is then as it was before the call.
    pub fn advance(&mut self, motion: &Motion) -> Result<(), SimulationError> {
        self.advance_observed(motion, &[], |_, _| ())
    }

    /// Follows `motion` to its end and calls `observe` at each of `times`, which rise from 0 to at most the duration:
    /// with the time since the start of the motion (s) and the simulation as it stood then.
    ///
    /// # Errors
    /// [`SimulationError`]; the simulation is then as it was before the call.
    pub fn advance_observed(
        &mut self,
        motion: &Motion,
        times: &[f64],
        mut observe: impl FnMut(f64, &mut Self),
    ) -> Result<(), SimulationError> {
        for &time in times {
            observe(time, self);
        }
        self.time += motion.duration;
        Ok(())
    }

    /// Writes the values of `variables`, in their order, into `values`; Integers as whole numbers.
    pub fn evaluate(&mut self, _variables: &[Variable], values: &mut [f64]) {
        values.fill(0.0);
    }

    /// Keeps a record of mode changes from now on, or stops keeping it.
    pub fn record_mode_changes(&mut self, _on: bool) {}

    /// The mode changes recorded since the last call.
    pub fn take_mode_changes(&mut self) -> Vec<ModeChange> {
        Vec::new()
    }
}
