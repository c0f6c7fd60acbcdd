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
    let weakening = weakening(model, state);
    if model.profile.bounds().curvature_max_abs == 0.0 {
        return longest(weakening);
    }
    let slipping = state.mode.iter().enumerate().filter(|(_, mode)| mode.slips());
    let fastest = slipping.map(|(i, _)| growth(model, state, forces.on_mass_z[i], i)).fold(0.0, f64::max);
    longest(weakening + fastest)
}

/// The longest step that lets contacts swing up whose friction falls with their speed, s: the largest number where
/// there are none.
pub fn longest_weakening(model: &Model, state: &State) -> f64 {
    longest(weakening(model, state))
}

/// The rate, 1/s, at which contacts swing up whose friction falls with their speed, or up to twice that; 0 where they
/// do not.
fn weakening(model: &Model, state: &State) -> f64 {
    let Some(law) = &model.rate_shear else { return 0.0 };
    let slipping = (0..model.masses()).filter(|&i| state.mode[i].slips());
    let steepest = slipping.map(|i| slope(law, state, i)).fold(0.0, f64::min);
    if steepest >= 0.0 {
        return 0.0;
    }
    let (frequency, damping) = swing(model);
    let chain = Chain { model, state, law, damping };
    let mut rate = -(damping + steepest) / model.mass;
    if rate <= 0.0 || chain.loses(0.0) {
        return 0.0;
    }
    while rate > frequency && chain.loses(0.5 * rate) {
        rate *= 0.5;
    }
    rate.max(frequency)
}

fn longest(fastest: f64) -> f64 {
    if fastest > 0.0 { MOST_GROWTH / fastest } else { f64::MAX }
}

/// q² A τ_f'(v_t) of slipping mass `i`: what its friction is as a damper along x, N s/m.
fn slope(law: &RateShear, state: &State, i: usize) -> f64 {
    let square = 1.0 + state.surface[i].slope * state.surface[i].slope;
    square * law.with_slope(state.mode[i].direction() * state.velocity_x[i] * square.sqrt()).1
}

/// The frequency, 1/s, of a mass on its horizontal link, and the damper, N s/m, that the link is at that frequency.
///
/// It swings with m ω² = c + Σ c_j ω²τ_j²/(1 + ω²τ_j²) and loses with d + Σ c_j τ_j/(1 + ω²τ_j²). Slopes, the vertical
/// link and the other masses only make it slower.
fn swing(model: &Model) -> (f64, f64) {
    let kind = LinkKind::Horizontal;
    let link = &model.links[kind as usize];
    // From above, as if no dashpot yielded, the frequency falls to the largest there is.
    let mut square = model.instantaneous_stiffness(kind) / model.mass;
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
    (square.sqrt(), damping)
}

/// Rounds in which the frequency is found: each leaves out the elements that are too fast for it.
const MOST_ROUNDS: usize = 30;

/// The slipping masses between their dampers: what friction gives one of them others may take.
struct Chain<'a> {
    model: &'a Model,
    state: &'a State,
    law: &'a RateShear,
    /// What a horizontal link is as a damper, N s/m.
    damping: f64,
}

impl Chain<'_> {
    /// Whether no motion of the masses grows at the `rate` λ (1/s): whether D + λM is positive definite, D the dampers
    /// by the velocities ẋ of the slipping masses, friction's among them, and M their masses m q². Cholesky's pivots.
    fn loses(&self, rate: f64) -> bool {
        let mut pivot = None;
        (0..self.model.masses()).all(|i| {
            let before = pivot.take();
            if !self.state.mode[i].slips() {
                return true;
            }
            let coupled = before.map_or(0.0, |pivot| self.between(i - 1, i).powi(2) / pivot);
            let own = self.own(i) + rate * self.model.mass * (1.0 + self.square(i, i)) - coupled;
            pivot = Some(own);
            own > 0.0
        })
    }

    /// s_i s_j.
    fn square(&self, i: usize, j: usize) -> f64 {
        self.state.surface[i].slope * self.state.surface[j].slope
    }

    /// The lateral dampers between two masses by ẋ_i ẋ_j, N s/m.
    fn between(&self, i: usize, j: usize) -> f64 {
        let [x, z] = [LinkKind::LateralX, LinkKind::LateralZ].map(|kind| self.model.links[kind as usize].damping);
        x + self.square(i, j) * z
    }

    /// The dampers by ẋ_i², N s/m. A free neighbour may go along, so what is between counts for nothing.
    fn own(&self, i: usize) -> f64 {
        let vertical = self.model.links[LinkKind::Vertical as usize].damping;
        let neighbours = [i.wrapping_sub(1), i + 1].into_iter().filter_map(|j| self.state.mode.get(j));
        let held = neighbours.filter(|mode| mode.in_contact()).count() as f64;
        self.damping + self.square(i, i) * vertical + held * self.between(i, i) + slope(self.law, self.state, i)
    }
}

/// The rate λ, 1/s, at which slipping mass `i` leaves the place where it is, moved a little; 0 where it comes back.
///
/// (6)-(9) linear in the way along x, of friction only what depends on the speed: m q² λ² + D λ = K, with
/// D = d_x + s² d_z + q² A τ_f' and K = κ f_z - c_x - s² c_z of the links to the carrier. The other links and the
/// Maxwell elements only make it slower. Where D < 0 it is what is left without D: that is [`weakening`]'s.
fn growth(model: &Model, state: &State, f_z: f64, i: usize) -> f64 {
    let surface = &state.surface[i];
    let driving = surface.curvature * f_z;
    if driving <= 0.0 {
        return 0.0;
    }
    let square = surface.slope * surface.slope;
    let [x, z] = [LinkKind::Horizontal, LinkKind::Vertical].map(|kind| &model.links[kind as usize]);
    let excess = driving - x.stiffness - square * z.stiffness;
    if excess <= 0.0 {
        return 0.0;
    }
    let (inertia, links) = (model.mass * (1.0 + square), x.damping + square * z.damping);
    let damping = (links + model.rate_shear.map_or(0.0, |law| slope(&law, state, i))).max(0.0);
    2.0 * excess / (damping + (damping * damping + 4.0 * inertia * excess).sqrt())
}
