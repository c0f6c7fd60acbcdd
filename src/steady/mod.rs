//! Steady sliding of rubber over a rigid periodic surface.

mod compliance;
mod contact;
mod linear;
mod surface;
mod transform;

pub use compliance::Compliance;
pub use contact::{Contact, ContactSolver};
pub use surface::SurfaceGrid;
pub use transform::{Convolution, GridSize};
