//! Steady sliding of rubber over a rigid periodic surface, solved as such.
//!
//! The deformation stands still in the frame of the surface: a wave of the wave number q is met with the modulus at the
//! frequency q_x v. On a grid of points, fields as Σ_q a_q e^(iq·x), the rubber slides to +x at v under the mean pressure P,
//!
//!   p ≥ 0,   g = û + d - h ≥ 0,   p g = 0,   mean p = P,   û_q = p_q/(M(q_x v) K(q)) for q ≠ 0,
//!
//! with the plane modulus M, the stiffness K(q) of the body, and the separation d of the mean planes. Every point of the
//! grid is a contact with a pressure, on which the law of friction acts along the surface, and heat moves along with the
//! rubber (docs/steady.md).

mod contact;
mod coupling;
mod flash;
mod flow;
mod heat;
mod krylov;
mod linear;
mod network;
pub mod persson;
mod rubber;
mod slide;
mod surface;
mod transform;

pub use contact::Contact;
pub use flow::FlowGaps;
pub use heat::HeatResponse;
pub use rubber::SlidingRubber;
pub use slide::{SlideProblem, SteadySlide, SteadySolver};
pub use surface::SurfaceGrid;
pub use transform::{Convolution, GridSize};
