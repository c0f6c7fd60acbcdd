//! The rules of mode changes, at the start and during a run: impact, lift, stop, stick, break. They are those of
//! docs/model.md.

use crate::model::{
    CarrierPoint, CarrierPosition, ChannelEnergies, Forces, Mode, Model, State, SurfacePoint, vertical_spring_energy_at,
};
use crate::scene::{ByAxis, Initial};

/// Places every mass at its rest position, moving with the carrier. A mass that would lie under the profile is lifted
/// onto it and keeps its velocity along t. [`decide_modes`] then decides which contacts remain and which stick.
pub fn place_layer(model: &Model, state: &mut State, at: CarrierPosition, carrier: &CarrierPoint) {
    for i in 0..model.masses() {
        let surface = model.surface_at(model.rest_x[i] + at.profile_position);
        let gap = model.rest_z[i] + at.w - surface.height;
        state.elongation_x[i] = 0.0;
        state.elongation_z[i] = 0.0;
        (state.velocity_x[i], state.velocity_z[i]) = (carrier.x.speed, carrier.z.speed);
        let separation = carrier.z.speed - surface.slope * carrier.x.speed;
        if gap < 0.0 {
            let v_x = (carrier.x.speed + surface.slope * carrier.z.speed) / (1.0 + surface.slope * surface.slope);
            touch_down(model, state, i, at.w, &surface, v_x);
            state.mode[i] = Mode::along(v_x);
        } else if gap == 0.0 && separation == 0.0 {
            touch_down(model, state, i, at.w, &surface, carrier.x.speed);
            state.mode[i] = Mode::along(carrier.x.speed);
        } else {
            state.release(i);
        }
        // As if the mass had always moved so.
        let speed = state.tangential_speed(model, i, at.profile_position);
        state.memory.get_mut(i).into_iter().for_each(|remembered| *remembered = speed);
    }
    place_dashpots(model, state);
}

/// Puts mass `i` onto the profile, moving along it.
fn touch_down(model: &Model, state: &mut State, i: usize, w: f64, surface: &SurfacePoint, velocity_x: f64) {
    state.surface[i] = *surface;
    state.elongation_z[i] = surface.height - model.rest_z[i] - w;
    (state.velocity_x[i], state.velocity_z[i]) = (velocity_x, surface.slope * velocity_x);
}

/// Relaxed: y = e, so a = 0. Undeformed: y = 0, so a = e.
fn place_dashpots(model: &Model, state: &mut State) {
    state.maxwell.fill(0.0);
    if model.initial == Initial::Relaxed {
        return;
    }
    for row in &model.rows {
        let e = if row.kind.is_along_x() { &state.elongation_x } else { &state.elongation_z };
        for (i, a) in state.maxwell[row.range.clone()].iter_mut().enumerate() {
            *a = row.kind.difference(e, 0.0, i);
        }
    }
}

/// At the start a mass that just touches the profile is in contact only if F_N > 0.
pub fn free_unloaded(model: &Model, state: &mut State, at: CarrierPosition, forces: &Forces) {
    for i in 0..model.masses() {
        let touches = state.mode[i].in_contact() && model.rest_z[i] + at.w == state.surface[i].height;
        if touches && forces.contact(model, state, i).normal <= 0.0 {
            state.release(i);
        }
    }
}

/// Applies the impacts due: every free mass within `reach` (m) of the profile that moves into it has an impact. Each
/// impact depends on the velocity of its own mass alone, so their order does not matter. Returns the energy lost, J.
///
/// A mass that has gone below the profile is lifted onto it, which raises the energy of its springs. It has lost as
/// much on its way down to its velocity, which the impact takes, and to the dampers, from whose part of `energies` the
/// rest is taken back.
pub fn impacts_due(
    model: &Model,
    state: &mut State,
    at: CarrierPosition,
    reach: f64,
    energies: &mut ChannelEnergies,
) -> f64 {
    let mut lost = 0.0;
    for i in 0..model.masses() {
        if state.mode[i] != Mode::Free {
            continue;
        }
        let surface = model.surface_at(model.rest_x[i] + (at.profile_position + state.elongation_x[i]));
        let gap = model.rest_z[i] + (at.w + state.elongation_z[i]) - surface.height;
        if gap <= reach && state.velocity_z[i] < surface.slope * state.velocity_x[i] {
            let of_impact = impact(model, state, i, at.w, &surface);
            lost += of_impact.max(0.0);
            energies.damper += of_impact.min(0.0);
        }
    }
    lost
}

/// The energy that mass `i` loses in its impact on the surface, less what it gains where it is lifted onto it, J.
fn impact(model: &Model, state: &mut State, i: usize, w: f64, surface: &SurfacePoint) -> f64 {
    let velocity = ByAxis { x: state.velocity_x[i], z: state.velocity_z[i] };
    let (after, lost) = collision(model, velocity, surface.slope);
    let before = vertical_spring_energy_at(model, state, i);
    let lift = (surface.height - model.rest_z[i] - w) - state.elongation_z[i];
    let since_touch = (lift / (surface.slope * state.velocity_x[i] - state.velocity_z[i])).abs();
    state.displace(model, i, ByAxis { x: 0.0, z: lift }, since_touch);
    touch_down(model, state, i, w, surface, after / (1.0 + surface.slope * surface.slope).sqrt());
    state.mode[i] = Mode::along(after);
    lost - (vertical_spring_energy_at(model, state, i) - before)
}

/// The law of impact, perfectly inelastic along n with Coulomb's friction along t: v_n⁺ = 0 by the impulse J = -m v_n,
/// and v_t⁺ = sign(v_t) max(|v_t| - μ J/m, 0). `s` is the slope. Returns v_t⁺, m/s, and the energy lost, J.
pub(super) fn collision(model: &Model, ByAxis { x: v_x, z: v_z }: ByAxis<f64>, s: f64) -> (f64, f64) {
    let q = (1.0 + s * s).sqrt();
    let v_n = (v_z - s * v_x) / q;
    let v_t = (v_x + s * v_z) / q;
    let after = model.friction.after_impact(v_t, v_n);
    (after, 0.5 * model.mass * (v_n * v_n + v_t * v_t - after * after))
}

/// Stops slipping masses whose velocity has passed 0, so that the rule for *stop* decides on them. Adds the kinetic
/// energy that this takes from them to the `energies`: friction did that much work on them past the stop.
pub fn stop_reversed(model: &Model, state: &mut State, forces: &Forces, energies: &mut ChannelEnergies) {
    for i in 0..if model.friction.present { model.masses() } else { 0 } {
        let velocity = (state.velocity_x[i], state.velocity_z[i]);
        if has_reversed(state.mode[i], velocity.0) {
            let normal = forces.contact(model, state, i).normal;
            let shares = model.friction.shares_at_rest(normal, &state.history(i));
            energies.add_friction(energy_at(model, velocity), shares);
            (state.velocity_x[i], state.velocity_z[i]) = (0.0, 0.0);
        }
    }
}

/// Whether a slip with ẋ = `v` goes against its direction.
fn has_reversed(mode: Mode, v: f64) -> bool {
    mode.slips() && mode.direction() * v < 0.0
}

/// Kinetic energy of one mass, J.
fn energy_at(model: &Model, (v_x, v_z): (f64, f64)) -> f64 {
    0.5 * model.mass * (v_x * v_x + v_z * v_z)
}

/// Decides the mode of every contact anew from the forces after a jump.
///
/// Neither the forces nor the velocities depend on the modes, so one pass is enough: a second one would change nothing,
/// and a mass that breaks loose does not stick again at once.
pub fn decide_modes(model: &Model, state: &mut State, forces: &Forces) {
    for i in 0..model.masses() {
        decide_mode(model, state, forces, i);
    }
}

/// Decides the mode of mass `i` anew if it is in contact.
pub(super) fn decide_mode(model: &Model, state: &mut State, forces: &Forces, i: usize) {
    if state.mode[i].in_contact() {
        match decided(model, state, forces, i) {
            Mode::Free => state.release(i),
            mode => state.mode[i] = mode,
        }
    }
}

/// Lift where F_N < 0; a mass at rest sticks up to |f·t| = T(0) and breaks loose beyond; a slip goes on.
fn decided(model: &Model, state: &State, forces: &Forces, i: usize) -> Mode {
    let (mode, v) = (state.mode[i], state.velocity_x[i]);
    let contact = forces.contact(model, state, i);
    if contact.normal < 0.0 {
        return Mode::Free;
    }
    if !model.friction.present || (mode.slips() && v != 0.0) {
        return mode;
    }
    if contact.tangential.abs() <= contact.limit { Mode::Stick } else { Mode::along(contact.tangential) }
}
