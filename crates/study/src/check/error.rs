//! Why something is not compared.

use asperity::element::ElementError;
use asperity::patch::MotionError;
use asperity::scene::ParameterError;
use asperity::simulation::SimulationError;

use crate::progress::Stopped;
use crate::sweep::{NeverSteady, NotSteady, SweepError};

/// An element or a patch cannot be compared with what was swept.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum CheckError {
    #[error("`check`: {0}")]
    Swept(#[from] SweepError),
    #[error("`check`: the table was swept of {table:?}, the scene is {scene:?}: expected the scene that was swept")]
    OtherScene { table: String, scene: String },
    #[error("`check`: {what} is {found} in the scene, {swept} in the table: expected the scene that was swept")]
    OtherLayer { what: &'static str, found: String, swept: String },
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error(
        "`check`: no element of the tilted face stands at a separation of the table: its places are too large to tell them"
    )]
    NoElements,
    #[error("`check`: the patch cannot be dragged: {0}")]
    Motion(#[from] MotionError),
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// A point, or a motion, cannot be compared.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum NotCompared {
    /// What was swept, a layer or a solution, is not steady there.
    #[error("{of} {status}")]
    Swept { of: &'static str, status: NotSteady },
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error(transparent)]
    Element(#[from] ElementError),
    #[error(transparent)]
    Layer(#[from] SimulationError),
    #[error("the layer of element {number}: {source}")]
    LayerOf { number: usize, source: Box<NotCompared> },
    #[error(transparent)]
    NeverSteady(#[from] NeverSteady),
    #[error("no contact, or no friction")]
    NothingSticks,
    #[error("not done, the layer is another model than what was swept")]
    AnotherModel,
}
