//! How long a step may be where a contact is unstable.

use crate::model::{Forces, LinkKind, Model, State};

/// The most that a step's length times the rate may be at which an unstable contact leaves its place.
///
/// The methods damp what is faster than their steps: what grows, too, so a mass would stay on a crest where it cannot. Up to 2 they
/// let it grow as it does (R(2) is 7.4 and 10.7, e² is 7.4), beyond 5 and 3.4, their poles 1/γ, they no longer do.
const MOST_GROWTH: f64 = 2.0;

/// The longest step that lets unstable contacts leave their places, s: the largest number where there are none.
pub fn longest_unstable(model: &Model, state: &State, forces: &Forces) -> f64 {
    if model.profile.bounds().curvature_max_abs == 0.0 {
        return f64::MAX;
    }
    let slipping = state.mode.iter().enumerate().filter(|(_, mode)| mode.slips());
    let fastest = slipping.map(|(i, _)| growth(model, state, forces.on_mass_z[i], i)).fold(0.0, f64::max);
    if fastest > 0.0 { MOST_GROWTH / fastest } else { f64::MAX }
}

/// The rate λ, 1/s, at which slipping mass `i` leaves the place where it is, moved a little; 0 where it comes back.
///
/// (6)-(9) without friction, linear in the way along x: m q² λ² + D λ = K, with D = d_x + s² d_z and
/// K = κ f_z - c_x - s² c_z of the links to the carrier. The other links and the Maxwell elements only make it slower.
fn growth(model: &Model, state: &State, f_z: f64, i: usize) -> f64 {
    let ground = &state.ground[i];
    let driving = ground.curvature * f_z;
    if driving <= 0.0 {
        return 0.0;
    }
    let square = ground.slope * ground.slope;
    let [x, z] = [LinkKind::Horizontal, LinkKind::Vertical].map(|kind| &model.links[kind as usize]);
    let excess = driving - x.stiffness - square * z.stiffness;
    if excess <= 0.0 {
        return 0.0;
    }
    let (inertia, damping) = (model.mass * (1.0 + square), x.damping + square * z.damping);
    2.0 * excess / (damping + (damping * damping + 4.0 * inertia * excess).sqrt())
}
