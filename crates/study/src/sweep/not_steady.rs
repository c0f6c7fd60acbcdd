//! Why there is no steady sliding at a point.

use asperity::simulation::SimulationError;

use super::window::MIN_WINDOW;
use crate::steady::SlideProblem;

/// Why there is no steady sliding at a point, or its values cannot be relied on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotSteady {
    /// A run of the layer failed.
    #[error(transparent)]
    Run(#[from] SimulationError),
    /// What the solver found cannot be relied on.
    #[error(transparent)]
    Solved(#[from] SlideProblem),
    /// The layer may not slide far enough for means to be judged.
    #[error("not steady: no room for {MIN_WINDOW} blocks of {length} m within {distance} m")]
    NoRoom {
        /// Length of a block, m.
        length: f64,
        /// Longest distance, m.
        distance: f64,
    },
    /// The means of the layer are not known well enough.
    #[error("not steady after {distance:.4} m: standard error of the friction coefficient {:.2} % of it", 100.0 * .error)]
    Scatter {
        /// Distance that the layer slid, m.
        distance: f64,
        /// Standard error of the friction coefficient over it, 1.
        error: f64,
    },
    /// The layer does not bear its load.
    #[error("not pressed after {distance:.4} m: mean F_z is off by {:.2} %", 100.0 * .deviation)]
    NotPressed {
        /// Distance that the layer slid, m.
        distance: f64,
        /// How far F_z is from the load, as a share of it.
        deviation: f64,
    },
    /// The force falls by so much, N/m, as motion starts: the masses at rest do not hold what the load asks of them.
    #[error("tangential stiffness: {0:.4e} N/m, expected a number above 0: refine the layer")]
    Falling(f64),
    /// The run that the tangential stiffness is found by failed.
    #[error("tangential stiffness: {0}")]
    Stiffness(SimulationError),
    /// The table that was swept has no such temperature.
    #[error("no such temperature")]
    NoTemperature,
    /// No pressure was found at this separation, m.
    #[error("no pressure found at the separation {0:.4e} m")]
    NoPressure(f64),
}
