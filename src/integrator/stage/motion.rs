//! What the velocities of a stage make: positions and forces, with the contact constraint z = z_r(x) put in; and once it
//! is solved the accelerations, contact forces and the power of friction.

use std::hint::select_unpredictable;

use super::slipping_mass::StageFriction;
use super::{StagePoint, StageSolver};
use crate::integrator::stage_values::{NO_LIMIT, StageValues};
use crate::math::{BLOCK, Spline, with_widest_vectors};
use crate::model::{
    ByAxis, ContactForces, Forces, FrictionPower, LinkKind, LinkMotion, Mode, Model, SlipHistory, State, SurfacePoint,
};

impl StageSolver {
    /// Computes the positions and the forces from the velocities.
    pub(super) fn evaluate(&mut self, model: &Model, point: &StagePoint) {
        with_widest_vectors(
            #[inline(always)]
            || {
                self.set_positions(model, point);
                self.set_forces(point);
            },
        );
        if let Some(squares) = &self.measured {
            self.forces.measure_stage(model, &self.state, &point.carrier, &squares.energy);
        }
    }

    /// Computes the positions from the velocities and puts the contact constraint in.
    #[inline(always)]
    fn set_positions(&mut self, model: &Model, point: &StagePoint) {
        let (beta, profile_position, w) = (point.beta, point.profile_position(), point.w());
        let (state, history) = (&mut self.state, &self.history);
        set_elongations(&mut state.elongation_x, &history.elongation_x, beta, &state.velocity_x, point.integrated.x);
        set_elongations(&mut state.elongation_z, &history.elongation_z, beta, &state.velocity_z, point.integrated.z);
        for &i in &self.sticks {
            state.elongation_x[i] = history.elongation_x[i] - point.moved;
            state.elongation_z[i] = state.surface[i].height - model.rest_z[i] - w;
        }
        for slips in &self.slip_runs {
            let (surface, e_z) = (&mut state.surface[slips.clone()], &mut state.elongation_z[slips.clone()]);
            let (e_x, v_x) = (&state.elongation_x[slips.clone()], &state.velocity_x[slips.clone()]);
            let (rest_x, rest_z) = (&model.rest_x[slips.clone()], &model.rest_z[slips.clone()]);
            set_surface(surface, &model.profile, rest_x, e_x, profile_position);
            set_on_surface(&mut state.velocity_z[slips.clone()], e_z, surface, v_x, rest_z, w);
        }
    }

    /// Computes the forces of the links and on the masses by the stage's law.
    #[inline(always)]
    fn set_forces(&mut self, point: &StagePoint) {
        let motion = LinkMotion::new(&self.state, &point.carrier);
        self.forces.evaluate_with(&self.laws, &motion, &self.history.force);
    }
}

/// e = e* + β v less the carrier's displacement.
#[inline(always)]
fn set_elongations(elongation: &mut [f64], star: &[f64], beta: f64, velocity: &[f64], moved: f64) {
    for (elongation, (star, velocity)) in elongation.iter_mut().zip(star.iter().zip(velocity)) {
        *elongation = star + beta * velocity - moved;
    }
}

/// A run of slipping masses that is shorter is put on the profile one by one.
const SHORT_RUN: usize = 6;

/// Sets the profile under slipping masses that follow one another.
#[inline(always)]
fn set_surface(surface: &mut [SurfacePoint], profile: &Spline, rest_x: &[f64], e_x: &[f64], profile_position: f64) {
    let place = |rest: &f64, e: &f64| rest + (profile_position + e);
    if surface.len() < SHORT_RUN {
        for (surface, (rest, e)) in surface.iter_mut().zip(rest_x.iter().zip(e_x)) {
            *surface = SurfacePoint::on(profile, place(rest, e));
        }
        return;
    }
    let mut places = [0.0; BLOCK];
    for (surface, (rest_x, e_x)) in surface.chunks_mut(BLOCK).zip(rest_x.chunks(BLOCK).zip(e_x.chunks(BLOCK))) {
        let places = &mut places[..surface.len()];
        for (at, (rest, e)) in places.iter_mut().zip(rest_x.iter().zip(e_x)) {
            *at = place(rest, e);
        }
        profile.evaluate_block(places, surface);
    }
}

/// Sets ż and e_z of slipping masses that follow one another, on the `surface`, under the carrier at `w` (m).
#[inline(always)]
fn set_on_surface(v_z: &mut [f64], e_z: &mut [f64], surface: &[SurfacePoint], v_x: &[f64], rest_z: &[f64], w: f64) {
    let masses = v_z.iter_mut().zip(e_z).zip(v_x.iter().zip(rest_z));
    for (((v_z, e_z), (v_x, rest_z)), surface) in masses.zip(surface) {
        *v_z = surface.slope * v_x;
        *e_z = surface.height - rest_z - w;
    }
}

impl StageSolver {
    /// Writes the rates of the solved stage.
    pub(super) fn write_rates(&mut self, model: &Model, point: &StagePoint, rates: &mut StageValues) {
        with_widest_vectors(
            #[inline(always)]
            || {
                self.set_rates(point, rates);
                if model.friction.is_linear() {
                    let StageValues { acceleration_x, acceleration_z, normal, margin, .. } = rates;
                    set_contact_motion(acceleration_z, normal, acceleration_x, model, &self.state, &self.forces);
                    set_slips(&mut self.slip_speed, margin, model, &self.state);
                }
            },
        );
        if model.friction.is_linear() {
            self.set_stick_rates(model, rates);
            self.friction_power = FrictionPower::from_linear_law(&model.friction, &self.slip_speed, &rates.normal);
        } else {
            self.set_contact_rates(model, rates);
        }
        self.memory.write(model, point.profile_position(), &mut self.state, rates);
    }

    #[inline(always)]
    fn set_rates(&self, point: &StagePoint, rates: &mut StageValues) {
        let per_beta = 1.0 / point.beta;
        let (state, history) = (&self.state, &self.history);
        rates.velocity_x.copy_from_slice(&state.velocity_x);
        rates.velocity_z.copy_from_slice(&state.velocity_z);
        rate_of_change(&mut rates.acceleration_x, &state.velocity_x, &history.velocity_x, per_beta);
        rate_of_change(&mut rates.acceleration_z, &state.velocity_z, &history.velocity_z, per_beta);
        let motion = LinkMotion::new(state, &point.carrier);
        for (kind, rate) in LinkKind::ALL.into_iter().zip(&mut rates.elongation_rate) {
            motion.elongation_rates(kind, rate);
        }
    }

    /// Sets what differs of sticking masses from slipping ones.
    fn set_stick_rates(&self, model: &Model, rates: &mut StageValues) {
        for &i in &self.sticks {
            let surface = &self.state.surface[i];
            let contact = ContactForces::new(model, self.forces.on_mass(i), 0.0, surface, &SlipHistory::default());
            (rates.acceleration_x[i], rates.acceleration_z[i]) = (0.0, 0.0);
            rates.margin[i] = contact.limit - contact.tangential.abs();
        }
    }

    /// Sets the rates of the masses in contact, and the power of friction.
    fn set_contact_rates(&mut self, model: &Model, rates: &mut StageValues) {
        let mut friction_power = FrictionPower::default();
        rates.clear_contacts();
        let state = &self.state;
        let k = state.mode.len();
        let (modes, velocities, surfaces) = (&state.mode[..k], &state.velocity_x[..k], &state.surface[..k]);
        let (f_x, f_z) = (&self.forces.on_mass_x[..k], &self.forces.on_mass_z[..k]);
        let mut slips = self.friction.iter();
        for &i in &self.contacts {
            let (mode, v, surface) = (modes[i], velocities[i], &surfaces[i]);
            let forces = ByAxis { x: f_x[i], z: f_z[i] };
            let slip = if mode.slips() { slips.next() } else { None };
            let Some(StageFriction { friction, .. }) = slip else {
                rates.acceleration_x[i] = 0.0;
                let contact = ContactForces::new(model, forces, v, surface, &self.slip_history(i));
                rates.set_contact(model, i, mode, v, surface, &contact);
                continue;
            };
            let contact = ContactForces::without_limit(model.mass, forces, v, surface);
            rates.set_contact(model, i, mode, v, surface, &contact);
            friction_power.add(&model.friction, mode, v, &contact, friction);
            if let Some(flux) = rates.heat_flux.get_mut(i) {
                *flux = self.flash.heat_flux(friction.force(), v * contact.q);
            }
        }
        self.friction_power = friction_power;
    }
}

/// rate = (now - before) / β.
#[inline(always)]
fn rate_of_change(rate: &mut [f64], now: &[f64], before: &[f64], per_beta: f64) {
    for (rate, (now, before)) in rate.iter_mut().zip(now.iter().zip(before)) {
        *rate = (now - before) * per_beta;
    }
}

// The slices that the following functions write are arguments of their own. By that the compiler knows that they do not
// overlap what is read, and makes vector instructions of the loops.

/// Sets z̈ and F_N of the masses in contact, of sticking ones as of slipping ones, and F_N of free ones.
#[inline(always)]
fn set_contact_motion(
    acceleration_z: &mut [f64],
    normal: &mut [f64],
    acceleration_x: &[f64],
    model: &Model,
    state: &State,
    forces: &Forces,
) {
    // Slices of one length, so that an index into one of them is one into all.
    let k = normal.len();
    let (a_z, a_x) = (&mut acceleration_z[..k], &acceleration_x[..k]);
    let (mode, surface, v_x) = (&state.mode[..k], &state.surface[..k], &state.velocity_x[..k]);
    let (f_x, f_z) = (&forces.on_mass_x[..k], &forces.on_mass_z[..k]);
    let mass = model.mass;
    for i in 0..k {
        let (v, is_free) = (v_x[i], mode[i] == Mode::Free);
        let forces = ByAxis { x: f_x[i], z: f_z[i] };
        let of_contact = ContactForces::without_limit(mass, forces, v, &surface[i]).normal;
        let along_surface = surface[i].slope * a_x[i] + surface[i].curvature * v * v;
        a_z[i] = select_unpredictable(is_free, a_z[i], along_surface);
        normal[i] = select_unpredictable(is_free, NO_LIMIT, of_contact);
    }
}

/// Sets the speeds of slip, and the margins of the slipping masses as those of the others, under a linear law of
/// friction.
#[inline(always)]
fn set_slips(slip_speed: &mut [f64], margin: &mut [f64], model: &Model, state: &State) {
    // Slices of one length, so that an index into one of them is one into all.
    let k = slip_speed.len();
    let (margin, mode) = (&mut margin[..k], &state.mode[..k]);
    let (surface, v_x) = (&state.surface[..k], &state.velocity_x[..k]);
    let has_friction = model.friction.present;
    for i in 0..k {
        let (sigma, s) = (mode[i].direction(), surface[i].slope);
        let along_x = sigma * v_x[i];
        let speed = along_x * (1.0 + s * s).sqrt();
        margin[i] = select_unpredictable(sigma != 0.0 && has_friction, along_x, NO_LIMIT);
        slip_speed[i] = select_unpredictable(sigma != 0.0, speed, 0.0);
    }
}
