//! Runs against results known exactly: each test derives what it expects from the equations of the model, not from the
//! program.
//!
//! Symbols: a link is F = c e + d ė + Σ_j c_j (e - y_j) with ẏ_j = (e - y_j)/τ_j; its complex stiffness is K*(ω) = c +
//! iωd + Σ_j c_j iωτ_j/(1 + iωτ_j). The carrier stands at (u, w), a mass m over the profile z_r(x) of slope s and
//! curvature κ, with n and t normal and tangent to the profile.

mod carrier;
mod energy;
mod free;
mod friction;
mod hysteresis;
mod material;
mod mode_changes;
mod modulus;
mod rate_shear;
mod real_area;
mod run;
mod start;
mod symmetry;
mod unstable;
