//! The longest step where a contact is unstable: on a crest of the profile, and where friction weakens with the speed.

use crate::model::{Forces, LinkKind, Model, SlipHistory, State};

/// Largest product of a step's length and the growth rate of an unstable contact.
///
/// The methods damp motions that are faster than their steps, also unstable ones: a mass would stay on a crest where it
/// cannot. Up to 2 they let it grow nearly as it does (R(2) is 7.4 and 10.7, e² is 7.4); beyond their poles 1/γ, 5 and
/// 3.4, they no longer do.
const MAX_GROWTH: f64 = 2.0;

/// The longest step that resolves the growth of unstable contacts, s; the largest number if there are none. The step
/// went from `start` to `state`.
pub fn longest_unstable(model: &Model, start: &State, state: &State, forces: &Forces) -> f64 {
    let weakening = weakening(model, Some(start), state, forces);
    if model.profile.bounds().curvature_max_abs == 0.0 {
        return longest(weakening);
    }
    let slipping = state.mode.iter().enumerate().filter(|(_, mode)| mode.slips());
    let growths = slipping.map(|(i, _)| growth(model, state, forces, i));
    let fastest = growths.filter(|&growth| growth > 0.0).fold(0.0, f64::max);
    longest(weakening + fastest)
}

/// The longest step that resolves the growth of stick-slip vibrations where friction weakens with the speed, s; the
/// largest number if there are none.
pub fn longest_weakening(model: &Model, state: &State, forces: &Forces) -> f64 {
    longest(weakening(model, None, state, forces))
}

/// The growth rate, 1/s, of vibrations of contacts whose friction weakens with the speed, or up to twice that rate; 0
/// if there are none. Slopes, the vertical links and the other masses only reduce it.
///
/// A step much longer than friction's fall can throw a mass that breaks loose backwards: the implicit equations have
/// that solution too. It would stop at once, break loose again, and so on. There the fall that it has passed over
/// counts.
fn weakening(model: &Model, start: Option<&State>, state: &State, forces: &Forces) -> f64 {
    if !model.friction.depends_on_speed() {
        return 0.0;
    }
    if let Some(way) = model.friction.memory {
        return weakening_with_memory(model, way, state, forces);
    }
    let slope = |i| {
        let thrown_back = start.and_then(|start| fall_passed_over(model, start, state, forces, i));
        thrown_back.unwrap_or_else(|| slope(model, state, forces, i))
    };
    let slipping = (0..model.masses()).filter(|&i| state.mode[i].slips());
    let steepest = slipping.map(slope).fold(0.0, f64::min);
    if steepest >= 0.0 {
        return 0.0;
    }
    let (frequency, damping) = model.horizontal_oscillation();
    let chain = Chain { model, state, slope: &slope, damping };
    let mut rate = -(damping + steepest) / model.mass;
    if rate <= 0.0 || chain.decays(0.0) {
        return 0.0;
    }
    while rate > frequency && chain.decays(0.5 * rate) {
        rate *= 0.5;
    }
    rate.max(frequency)
}

/// The rate, 1/s, at which a contact that remembers its speed over D = `way` (m) can grow unstable where friction falls
/// over the speed: √(v |∂T/∂v|/(m D)), up to which an implicit step has one solution; 0 where the links keep even sliding
/// stable, D |K*(iv/D)| > v |∂T/∂v| (docs/foundation.md, section 7).
fn weakening_with_memory(model: &Model, way: f64, state: &State, forces: &Forces) -> f64 {
    let slipping = (0..model.masses()).filter(|&i| state.mode[i].slips());
    let falls = slipping.map(|i| {
        let (normal, speed) = (forces.contact(model, state, i).normal, state.memory[i]);
        let fall = model.friction.fall(normal, speed, state.flash(i));
        if fall * BOUND_ACCURACY > model.bearable_fall(way, speed) { fall } else { 0.0 }
    });
    (falls.fold(0.0, f64::max) / (model.mass * way)).sqrt()
}

/// How far the bound of the way over which contacts are renewed may be off: the exact one is 0.7 to 1.6 times it.
const BOUND_ACCURACY: f64 = 1.6;

/// The steepest q² ∂T/∂v_t, N s/m, between rest and the speed of mass `i`, where it broke loose at the start of the
/// step and runs backwards at its end; `None` elsewhere.
fn fall_passed_over(model: &Model, start: &State, state: &State, forces: &Forces, i: usize) -> Option<f64> {
    let sigma = state.mode[i].direction();
    let (before, after) = (sigma * start.velocity_x[i], sigma * state.velocity_x[i]);
    if before > 0.0 || after >= 0.0 {
        return None;
    }
    let contact = forces.contact(model, state, i);
    let curve = model.friction.slip_curve(contact.normal, &SlipHistory::even(state.flash(i)))?;
    Some(contact.q * contact.q * curve.steepest_fall(after.abs() * contact.q))
}

fn longest(fastest: f64) -> f64 {
    if fastest > 0.0 { MAX_GROWTH / fastest } else { f64::MAX }
}

/// q² ∂T/∂v_t of slipping mass `i`, N s/m: its friction as a damper along x; 0 where friction does not depend on the
/// speed.
fn slope(model: &Model, state: &State, forces: &Forces, i: usize) -> f64 {
    let normal = forces.contact(model, state, i).normal;
    let Some(curve) = model.friction.slip_curve(normal, &SlipHistory::even(state.flash(i))) else { return 0.0 };
    let square = 1.0 + state.surface[i].slope * state.surface[i].slope;
    square * curve.with_slope(state.mode[i].direction() * state.velocity_x[i] * square.sqrt()).1
}

/// The slipping masses, coupled by dampers: these may take from one mass the energy that friction feeds to another.
struct Chain<'a, S: Fn(usize) -> f64> {
    model: &'a Model,
    state: &'a State,
    /// The friction of a mass as a damper, N s/m.
    slope: &'a S,
    /// Damping of a horizontal link, N s/m.
    damping: f64,
}

impl<S: Fn(usize) -> f64> Chain<'_, S> {
    /// Whether no motion of the masses grows at the `rate` λ (1/s): whether D + λM is positive definite, by Cholesky's
    /// pivots. D is the damping matrix for the velocities ẋ of the slipping masses, friction included; M are their
    /// masses m q².
    fn decays(&self, rate: f64) -> bool {
        let mut pivot = None;
        (0..self.model.masses()).all(|i| {
            let before = pivot.take();
            if !self.state.mode[i].slips() {
                return true;
            }
            let coupled = before.map_or(0.0, |pivot| self.coupling(i - 1, i).powi(2) / pivot);
            let own = self.own(i) + rate * self.model.mass * (1.0 + self.slopes(i, i)) - coupled;
            pivot = Some(own);
            own > 0.0
        })
    }

    fn slopes(&self, i: usize, j: usize) -> f64 {
        self.state.surface[i].slope * self.state.surface[j].slope
    }

    /// The coefficient of ẋ_i ẋ_j by the lateral dampers between two masses, N s/m.
    fn coupling(&self, i: usize, j: usize) -> f64 {
        let [x, z] = [LinkKind::LateralX, LinkKind::LateralZ].map(|kind| self.model.links[kind].damping);
        x + self.slopes(i, j) * z
    }

    /// The coefficient of ẋ_i², N s/m. A free neighbour may move along: the dampers to it do not count.
    fn own(&self, i: usize) -> f64 {
        let vertical = self.model.links[LinkKind::Vertical].damping;
        let neighbours = [i.wrapping_sub(1), i + 1].into_iter().filter_map(|j| self.state.mode.get(j));
        let count = neighbours.filter(|mode| mode.in_contact()).count() as f64;
        self.damping + self.slopes(i, i) * vertical + count * self.coupling(i, i) + (self.slope)(i)
    }
}

/// The growth rate λ, 1/s, of a small displacement of slipping mass `i`; 0 if its position is stable.
///
/// From (6)-(9) linearised in the displacement along x, with the part of friction that depends on the speed: m q² λ² +
/// D λ = K, with D = d_x + s² d_z + q² A τ_f' and K = κ f_z - c_x - s² c_z of the links to the carrier. The other links
/// and the Maxwell elements only reduce the rate. Where D < 0, D counts as 0: [`weakening`] accounts for it.
fn growth(model: &Model, state: &State, forces: &Forces, i: usize) -> f64 {
    let surface = &state.surface[i];
    let [x, z] = [LinkKind::Horizontal, LinkKind::Vertical].map(|kind| &model.links[kind]);
    let beyond_x = surface.curvature * forces.on_mass_z[i] - x.stiffness;
    if beyond_x <= 0.0 {
        return 0.0;
    }
    let square = surface.slope * surface.slope;
    let excess = beyond_x - square * z.stiffness;
    if excess <= 0.0 {
        return 0.0;
    }
    let (inertia, links) = (model.mass * (1.0 + square), x.damping + square * z.damping);
    // Within the growth of a position friction follows no remembered speed.
    let of_friction = if model.friction.memory.is_some() { 0.0 } else { slope(model, state, forces, i) };
    let damping = (links + of_friction).max(0.0);
    2.0 * excess / (damping + (damping * damping + 4.0 * inertia * excess).sqrt())
}
