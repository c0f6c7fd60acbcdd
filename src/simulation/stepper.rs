//! What the steps of both methods have in common.

use super::context::RunContext;
use super::controller::{TrialStep, WorkLimit};
use super::motion::SimulationError;
use crate::model::ByAxis;
use crate::outputs::Energies;

/// The least fraction of the length asked for at which a shorter step is given up.
const SHORTEST_CUT: f64 = 1e-12;

/// Which errors of a step are tested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StepTest {
    /// Those of the motion and of the energies.
    Full,
    /// Those of the motion: a shorter step would not resolve what changes the energies.
    Motion,
    /// None: its stages have only to be solved.
    Solved,
}

/// The steps of one method. What it says of a step is of the one tried last, of length `h` (s).
pub(super) trait StepMethod {
    /// Tries steps of a motion of `duration` (s) until one is good, up to its first event where events are located.
    ///
    /// # Errors
    /// [`SimulationError::TooManySteps`], [`SimulationError::StepTooSmall`].
    fn next_step(
        &mut self,
        context: &mut RunContext,
        duration: f64,
        work: &mut WorkLimit,
    ) -> Result<TrialStep, SimulationError>;

    /// Tries a step of length `h` in place of a longer, good one. Returns whether it is good, too: where it is
    /// rejected, the controller's step size is a better length.
    fn try_shorter(&mut self, context: &mut RunContext, h: f64, test: StepTest) -> bool;

    /// F_x and F_z at the fraction `theta` of the step, N.
    fn on_carrier(&mut self, context: &mut RunContext, h: f64, theta: f64) -> ByAxis<f64>;

    /// P_diss at the fraction `theta` of the step, W, where the powers at its stages say it.
    fn dissipated_power(&mut self, context: &mut RunContext, h: f64, theta: f64) -> Option<f64>;

    /// Whether the step's dense output is good enough to be shown at its fraction `theta`.
    fn can_show(&self, _context: &RunContext, _h: f64, _theta: f64) -> bool {
        true
    }

    /// Energies since the start at the fraction `theta` of the step.
    fn energies(&mut self, context: &mut RunContext, h: f64, theta: f64) -> Energies {
        let mut energies = context.state.energies;
        if context.settings.accounts.energy {
            energies.channels.add(&context.channel_energies_within(h, theta));
        }
        energies
    }

    /// A step of length `h` in place of a longer, good one: no worse, and without events, or with fewer. A shorter one
    /// where its stages cannot be solved, though those of the longer one could, or have another solution.
    fn cut_step(
        &mut self,
        context: &mut RunContext,
        h: f64,
        work: &mut WorkLimit,
    ) -> Result<TrialStep, SimulationError> {
        let test = if context.shorter_is_no_worse() { StepTest::Solved } else { StepTest::Full };
        let mut length = h;
        while !self.try_shorter(context, length, test) {
            work.count(context.state.time(), context.model.work_of_step())?;
            if length <= SHORTEST_CUT * h {
                return Err(context.step_too_small(length));
            }
            length = context.state.controller.step_size;
        }
        Ok(TrialStep { h: length, fraction: 1.0 })
    }

    /// A step up to the time `s` of a motion of `duration` (s) in place of a good one that goes beyond it, and its end:
    /// before that time where a step of that length is rejected.
    fn cut_step_at(
        &mut self,
        context: &mut RunContext,
        (s, duration): (f64, f64),
        work: &mut WorkLimit,
    ) -> Result<(TrialStep, f64), SimulationError> {
        let start = context.state.s;
        let step = self.cut_step(context, s - start, work)?;
        Ok((step, if step.h == s - start { s } else { step.end(start, duration) }))
    }
}
