//! A contact patch: many point-contact elements on one rigid face in three dimensions, and their wrench on its body.
//!
//! The ground is the plane z = 0. A body moves in six coordinates; each element of its face has the law of the
//! point-contact element at its own separation and speed, and a spring in two dimensions. A tread may run through the
//! face, as that of a wheel does.
//!
//! | file | what it holds |
//! |------|---------------|
//! | `motion` | path of the body and of the tread over a step, parts of a step |
//! | `face` | where elements sit |
//! | `cut` | an element that touches or lifts |
//! | `block` | a step of a block of elements |
//! | `pool` | a step of all blocks, by several threads |
//! | `definition` | a patch: face, table, parameters |
//! | `state` | motions, errors, what a run holds |
//! | `run` | a run |
//! | `survey` | elements one by one, and sums over them |
//! | `plan` | elements in the plane of their face, for pictures |
//! | `derivatives` | changes of outputs with the pose and by time |
//! | `variables` | output variables |

mod block;
mod contact_times;
mod definition;
mod derivatives;
mod face;
mod motion;
mod plan;
mod run;
mod state;
mod survey;
mod variables;
mod worker_pool;

pub use definition::{Patch, PatchElement, PatchError};
pub use plan::{FaceElement, FacePlan};
pub use run::PatchRun;
pub use state::{MotionError, PatchMotion, PatchStart, PatchState, Pose, RestoreError};
pub use variables::{COORDINATES, PatchOutput, PatchVariable};
