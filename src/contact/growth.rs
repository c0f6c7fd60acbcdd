//! How long a step may be where a contact is unstable.

use crate::model::{Forces, LinkKind, Model, RateShear, State};

/// The most that a step's length times the rate may be at which an unstable contact leaves its place.
///
/// The methods damp what is faster than their steps: what grows, too, so a mass would stay on a crest where it cannot.
/// Up to 2 they let it grow as it does (R(2) is 7.4 and 10.7, e² is 7.4), beyond 5 and 3.4, their poles 1/γ, they no
/// longer do.
const MOST_GROWTH: f64 = 2.0;

/// The longest step that lets unstable contacts leave their places, s: the largest number where there are none.
pub fn longest_unstable(model: &Model, state: &State, forces: &Forces) -> f64 {
    let weakening = longest_weakening(model, state);
    if model.profile.bounds().curvature_max_abs == 0.0 {
        return weakening;
    }
    let slipping = state.mode.iter().enumerate().filter(|(_, mode)| mode.slips());
    let fastest = slipping.map(|(i, _)| growth(model, state, forces.on_mass_z[i], i)).fold(0.0, f64::max);
    weakening.min(longest(fastest))
}

/// The longest step that lets contacts swing up whose friction falls with their speed, s: the largest number where
/// there are none.
pub fn longest_weakening(model: &Model, state: &State) -> f64 {
    let Some(law) = &model.rate_shear else { return f64::MAX };
    let slipping = (0..model.masses()).filter(|&i| state.mode[i].slips());
    let steepest = slipping.map(|i| slope(law, state, i)).fold(0.0, f64::min);
    longest(if steepest < 0.0 { swinging_up(model, steepest) } else { 0.0 })
}

fn longest(fastest: f64) -> f64 {
    if fastest > 0.0 { MOST_GROWTH / fastest } else { f64::MAX }
}

/// q² A τ_f'(v_t) of slipping mass `i`: what its friction is as a damper along x, N s/m.
fn slope(law: &RateShear, state: &State, i: usize) -> f64 {
    let square = 1.0 + state.ground[i].slope * state.ground[i].slope;
    square * law.with_slope(state.mode[i].direction() * state.velocity_x[i] * square.sqrt()).1
}

/// The rate, 1/s, of a mass on its horizontal link that friction drives as a damper `slope` < 0 (N s/m); 0 where the
/// link's own losses are larger.
///
/// It swings with m ω² = c + Σ c_j ω²τ_j²/(1 + ω²τ_j²) and loses with d + Σ c_j τ_j/(1 + ω²τ_j²). Slopes, the vertical
/// link and the other masses only make it slower.
fn swinging_up(model: &Model, slope: f64) -> f64 {
    let kind = LinkKind::Horizontal;
    let link = &model.links[kind as usize];
    // From above, as if no dashpot yielded, the frequency falls to the largest there is.
    let mut square = (link.stiffness + model.rows_of(kind).map(|row| row.stiffness).sum::<f64>()) / model.mass;
    let mut damping = link.damping;
    for _ in 0..MOST_ROUNDS {
        let (before, mut stiffness) = (square, link.stiffness);
        damping = link.damping;
        for row in model.rows_of(kind) {
            let tau = row.relaxation_time;
            let share = 1.0 / (1.0 + before * tau * tau);
            stiffness += row.stiffness * (1.0 - share);
            damping += row.stiffness * tau * share;
        }
        square = stiffness / model.mass;
        if square >= 0.99 * before {
            break;
        }
    }
    if damping + slope < 0.0 { square.sqrt().max(-(damping + slope) / model.mass) } else { 0.0 }
}

/// Rounds in which the frequency is found: each leaves out the elements that are too fast for it.
const MOST_ROUNDS: usize = 30;

/// The rate λ, 1/s, at which slipping mass `i` leaves the place where it is, moved a little; 0 where it comes back.
///
/// (6)-(9) linear in the way along x, of friction only what depends on the speed: m q² λ² + D λ = K, with
/// D = d_x + s² d_z + q² A τ_f' and K = κ f_z - c_x - s² c_z of the links to the carrier. The other links and the
/// Maxwell elements only make it slower.
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
    let (inertia, links) = (model.mass * (1.0 + square), x.damping + square * z.damping);
    let damping = links + model.rate_shear.map_or(0.0, |law| slope(&law, state, i));
    let root = (damping * damping + 4.0 * inertia * excess).sqrt();
    if damping < 0.0 { (root - damping) / (2.0 * inertia) } else { 2.0 * excess / (damping + root) }
}
