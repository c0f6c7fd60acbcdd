//! The Runge-Kutta pair of event-driven steps.

use std::sync::LazyLock;

use super::carrier_sums::ContactHeights;
use super::energy::SummedStep;
use super::error::{ErrorWorkspace, StepAttempt, Tolerance};
use super::interpolation::StageInterpolation;
use super::maxwell::Maxwell;
use super::method::{InitialGuess, RungeKutta, Stages, StepInput};
use super::stage::{ConvergenceTest, Friction, NoConvergence};
use super::tableau::{ContinuousWeights, ESDIRK3, ESDIRK5, FOUR_STAGES, STAGES, Tableau};
use crate::model::{ChannelEnergies, Model};

/// The pairs of event-driven steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pair {
    /// [`ESDIRK3`]: order 3 with three implicit stages.
    Third,
    /// [`ESDIRK5`]: order 5 with six implicit stages.
    Fifth,
}

/// The relative tolerance from which on the pair of order 3 is the cheaper one: where mode changes cut the steps short,
/// its fewer stages count for more than longer steps.
///
/// Recommended 2e-3 to 5e-3: on blocks of 200 and 800 masses and a chain of 1000 the two pairs take about equal times there.
const THIRD_FROM: f64 = 4e-3;
/// The same where friction depends on the speed and no carrier is a body. In the longer steps of the pair of order 5 masses that
/// creep and slip by turns make F_x err by ten tolerances and more, or keep the steps as short as the slips are. A body swings
/// for long and smoothly: at the lower order its phase is off by tens of tolerances.
const THIRD_FROM_WITH_CREEP: f64 = 1e-5;

impl Pair {
    /// The cheaper pair for `model` at a relative tolerance.
    pub fn at_tolerance(model: &Model, relative: f64) -> Self {
        let creeps = model.friction.depends_on_speed() && !model.has_bodies();
        let third_from = if creeps { THIRD_FROM_WITH_CREEP } else { THIRD_FROM };
        if relative >= third_from { Self::Third } else { Self::Fifth }
    }

    /// Where the heights of the masses in contact come from within a step.
    pub(super) fn contact_heights(self) -> ContactHeights {
        match self {
            Self::Third => ContactHeights::Interpolated,
            Self::Fifth => ContactHeights::OfProfile,
        }
    }

    /// Number of stages, the explicit one included.
    pub fn stages(self) -> usize {
        match self {
            Self::Third => FOUR_STAGES,
            Self::Fifth => STAGES,
        }
    }

    /// Order of the embedded method. That of the method itself is one higher.
    pub fn embedded_order(self) -> i32 {
        match self {
            Self::Third => ESDIRK3.embedded_order,
            Self::Fifth => ESDIRK5.embedded_order,
        }
    }

    pub(super) fn interpolation(self) -> &'static StageInterpolation {
        static THIRD: LazyLock<StageInterpolation> = LazyLock::new(|| StageInterpolation::new(&ESDIRK3));
        static FIFTH: LazyLock<StageInterpolation> = LazyLock::new(|| StageInterpolation::new(&ESDIRK5));
        match self {
            Self::Third => &THIRD,
            Self::Fifth => &FIFTH,
        }
    }
}

/// The pair of a run with its workspace.
#[derive(Clone, Debug)]
pub(super) enum EventMethod {
    Third(Box<RungeKutta<FOUR_STAGES>>),
    Fifth(Box<RungeKutta<STAGES>>),
}

impl EventMethod {
    /// A pair for `model`, if it `is_used`.
    pub(super) fn new(pair: Pair, model: &Model, is_used: bool) -> Self {
        static THIRD: LazyLock<ContinuousWeights<FOUR_STAGES>> = LazyLock::new(|| ContinuousWeights::new(&ESDIRK3));
        static FIFTH: LazyLock<ContinuousWeights<STAGES>> = LazyLock::new(|| ContinuousWeights::new(&ESDIRK5));
        match pair {
            Pair::Third => Self::Third(Box::new(runge_kutta((&ESDIRK3, &THIRD), model, is_used))),
            Pair::Fifth => Self::Fifth(Box::new(runge_kutta((&ESDIRK5, &FIFTH), model, is_used))),
        }
    }

    /// γ of every implicit stage.
    pub(super) fn gamma(&self) -> f64 {
        match self {
            Self::Third(method) => method.tableau.gamma(),
            Self::Fifth(method) => method.tableau.gamma(),
        }
    }

    /// Solves all stages of a step.
    pub(super) fn attempt(
        &mut self,
        stages: &mut Stages,
        step: &StepInput<'_>,
        convergence: ConvergenceTest,
    ) -> Result<(), NoConvergence> {
        match self {
            Self::Third(method) => method.attempt(stages, step, convergence),
            Self::Fifth(method) => method.attempt(stages, step, convergence),
        }
    }

    /// The error test of the step whose stages are solved.
    pub(super) fn test(
        &self,
        stages: &Stages,
        step: &StepInput<'_>,
        tolerance: &Tolerance,
        workspace: &mut ErrorWorkspace,
    ) -> StepAttempt {
        match self {
            Self::Third(method) => method.test(stages, step, tolerance, workspace),
            Self::Fifth(method) => method.test(stages, step, tolerance, workspace),
        }
    }

    /// Energies through the channels over `step` up to its fraction `theta`, J.
    pub(super) fn energies(&self, step: SummedStep<'_>, theta: f64) -> ChannelEnergies {
        match self {
            Self::Third(method) => method.energies(step, theta),
            Self::Fifth(method) => method.energies(step, theta),
        }
    }

    /// P_diss at the fraction `theta` of `step`, W; the values at the stages have these `weights`.
    pub(super) fn dissipated_power(&self, step: SummedStep<'_>, theta: f64, weights: &[f64; STAGES]) -> f64 {
        match self {
            Self::Third(method) => {
                let weights = std::array::from_fn(|stage| weights[stage]);
                method.dissipated_power(step, theta, &weights)
            }
            Self::Fifth(method) => method.dissipated_power(step, theta, weights),
        }
    }

    pub(super) fn floats(&self) -> usize {
        match self {
            Self::Third(method) => method.maxwell.floats(),
            Self::Fifth(method) => method.maxwell.floats(),
        }
    }
}

fn runge_kutta<const N: usize>(
    (tableau, continuous_weights): (&'static Tableau<N>, &'static ContinuousWeights<N>),
    model: &Model,
    is_used: bool,
) -> RungeKutta<N> {
    RungeKutta {
        tableau,
        continuous_weights,
        initial_guess: InitialGuess::extrapolated(&tableau.c),
        maxwell: Maxwell::new(model, is_used),
        friction: Friction::Held,
    }
}
