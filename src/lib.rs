//! Rubber on a rough, hard surface: point masses under a carrier, springs, dampers and Maxwell elements, a rigid
//! cubic-spline profile, stick and slip. The model is that of F. Schulte, J. Neuhaus and W. Sextro, *A mechanical model
//! for the dynamical contact of elastic rough bodies with viscoelastic properties*; equation numbers are that paper's.

pub mod contact;
pub mod fmi;
pub mod integrator;
pub mod math;
pub mod model;
pub mod outputs;
pub mod scene;
pub mod simulation;
