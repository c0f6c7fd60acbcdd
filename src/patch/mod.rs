//! A contact patch: many point-contact elements on one rigid face in three dimensions, and their wrench on its body.
//!
//! The ground is the plane z = 0. A body moves in six coordinates; each element of its face has the law of the
//! point-contact element at its own separation and speed, and a spring in two dimensions. A tread may run through the
//! face, as that of a wheel does.
//!
//! A *step* is the caller's. It is cut into *stretches* where cells of the tread begin to enter, these into *substeps*
//! in which the body turns by little, and with heat these into *parts* in which temperatures change by little. An
//! element whose pressure changes much goes through a part in *segments*; where it touches and lifts, one ends.
//!
//! | file | what it holds |
//! |------|---------------|
//! | `motion` | motion of the body and of the tread over a step, its substeps |
//! | `face` | where elements sit, how their face moves through a step, what they go through, counted and limited |
//! | `heat` | elements that slip warms |
//! | `block_contacts` | elements of a block, side by side, at an instant, with their law, and what they add up to |
//! | `block_springs` | their springs |
//! | `segments` | those of them whose pressures change much in a substep |
//! | `block` | a step of a block of elements |
//! | `worker_pool` | a step of all blocks, by several threads |
//! | `definition` | a patch: face, table, parameters |
//! | `state` | motions, errors, what a run holds |
//! | `run` | a run |
//! | `element_sums` | elements one by one, in the plane of their face, and sums over them |
//! | `derivatives` | changes of outputs with the pose and by time |
//! | `variables` | output variables |

mod block;
mod block_contacts;
mod block_springs;
mod definition;
mod derivatives;
mod element_sums;
mod face;
mod heat;
mod motion;
mod run;
mod segments;
mod state;
mod variables;
mod worker_pool;

pub use definition::{Patch, PatchElement, PatchError};
pub use element_sums::{FaceElement, FaceLayout};
pub use run::{PatchRun, ReckonedWork};
pub use state::{MotionError, PatchMotion, PatchRestoreError, PatchStart, PatchState, Pose};
pub use variables::{COORDINATES, PatchKind, PatchOutput, PatchOutputEntry, PatchVariable, catalogue, unit_of};
