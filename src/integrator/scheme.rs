//! The Runge-Kutta schemes: their data, which of them serves a run, and how they differ beyond that.

use std::sync::LazyLock;

use super::interpolation::Interpolation;
use super::tableau::{ContinuousWeights, ESDIRK3, ESDIRK5, MAX_STAGES, SDIRK2, StageWeights, Tableau};
use crate::model::Model;

/// The schemes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// [`ESDIRK3`]: order 3 with three implicit stages, for event-driven steps.
    Esdirk3,
    /// [`ESDIRK5`]: order 5 with six implicit stages, for event-driven steps.
    Esdirk5,
    /// [`SDIRK2`]: order 2 with two implicit stages, for time-stepping.
    Sdirk2,
}

/// What becomes of the contact modes within a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactModes {
    /// They are held: slips go on in their direction, sticks hold, whatever the forces. Steps are event-driven.
    Held,
    /// Set-valued friction decides: a slip that would reverse stops, a stick that would need more than T(0) breaks
    /// loose. Steps are those of time-stepping.
    SetValued,
}

/// Where the heights of the masses in contact come from within a step (docs/theory.md, section 5).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ContactHeights {
    /// From those at the ends of the step and from ż at its stages, as the heights of free masses do.
    Interpolated,
    /// From the profile.
    OfProfile,
}

/// How the velocities from which Newton's iterations of a stage start are guessed.
#[expect(clippy::large_enum_variant, reason = "one a scheme, made once and never moved")]
#[derive(Clone, Copy, Debug)]
pub(super) enum InitialGuess {
    /// The accelerations of slipping masses are extrapolated from the earlier stages with these weights, by stage. Free
    /// masses, whose equations are linear, start from the step's start: a guess far off costs digits.
    Extrapolated([StageWeights; MAX_STAGES]),
    /// The accelerations are those of the stage before. Just after a jump those of a stiff layer are no guide, so no
    /// velocity is guessed to change by more than the velocities in play.
    Limited,
}

/// All numbers of a scheme.
#[derive(Debug)]
pub(super) struct Coefficients {
    pub tableau: &'static Tableau,
    pub continuous_weights: ContinuousWeights,
    pub interpolation: Interpolation,
    pub initial_guess: InitialGuess,
}

/// The relative tolerance from which on the scheme of order 3 is the cheaper one: where mode changes cut the steps
/// short, its fewer stages count for more than longer steps.
///
/// Recommended 2e-3 to 5e-3: on blocks of 200 and 800 masses and a chain of 1000 the two take about equal times there.
const THIRD_FROM: f64 = 4e-3;
/// [`THIRD_FROM`] where friction depends on the speed and no carrier is a body. In the longer steps of the scheme of
/// order 5 masses that creep and slip by turns make F_x err by ten tolerances and more, or keep the steps as short as
/// the slips are. A body swings for long and smoothly: at the lower order its phase is off by tens of tolerances.
const THIRD_FROM_WITH_CREEP: f64 = 1e-5;

impl Scheme {
    /// The cheaper scheme for event-driven steps of `model` at a relative tolerance.
    pub fn event_driven_at(model: &Model, relative: f64) -> Self {
        let creeps = model.friction.depends_on_speed() && !model.has_bodies();
        let third_from = if creeps { THIRD_FROM_WITH_CREEP } else { THIRD_FROM };
        if relative >= third_from { Self::Esdirk3 } else { Self::Esdirk5 }
    }

    /// Its tableau.
    pub fn tableau(self) -> &'static Tableau {
        match self {
            Self::Esdirk3 => &ESDIRK3,
            Self::Esdirk5 => &ESDIRK5,
            Self::Sdirk2 => &SDIRK2,
        }
    }

    /// What becomes of the contact modes within its steps.
    pub fn contact_modes(self) -> ContactModes {
        match self {
            Self::Esdirk3 | Self::Esdirk5 => ContactModes::Held,
            Self::Sdirk2 => ContactModes::SetValued,
        }
    }

    /// Where the heights of the masses in contact come from within its steps.
    pub(super) fn contact_heights(self) -> ContactHeights {
        match self {
            Self::Esdirk3 | Self::Sdirk2 => ContactHeights::Interpolated,
            Self::Esdirk5 => ContactHeights::OfProfile,
        }
    }

    pub(super) fn coefficients(self) -> &'static Coefficients {
        static ALL: [LazyLock<Coefficients>; 3] = [
            LazyLock::new(|| Coefficients::with_stage_order_two(&ESDIRK3)),
            LazyLock::new(|| Coefficients::with_stage_order_two(&ESDIRK5)),
            LazyLock::new(|| Coefficients {
                tableau: &SDIRK2,
                continuous_weights: ContinuousWeights::sdirk2(),
                interpolation: Interpolation::sdirk2(),
                initial_guess: InitialGuess::Limited,
            }),
        ];
        &ALL[self as usize]
    }
}

impl Coefficients {
    fn with_stage_order_two(tableau: &'static Tableau) -> Self {
        Self {
            tableau,
            continuous_weights: ContinuousWeights::new(tableau),
            interpolation: Interpolation::new(tableau),
            initial_guess: InitialGuess::extrapolated(tableau),
        }
    }
}

impl InitialGuess {
    /// With the weights of Lagrange's polynomials through the latest three stages.
    fn extrapolated(tableau: &Tableau) -> Self {
        let (c, mut weights) = (&tableau.c, [[0.0; MAX_STAGES]; MAX_STAGES]);
        for i in 1..tableau.stages {
            let nodes = i.saturating_sub(3)..i;
            for j in nodes.clone() {
                weights[i][j] = nodes.clone().filter(|&m| m != j).map(|m| (c[i] - c[m]) / (c[j] - c[m])).product();
            }
        }
        Self::Extrapolated(weights)
    }
}
