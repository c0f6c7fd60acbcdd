//! Positions and forces at a stage from its velocities, with the contact constraint z = z_r(x) put in.

use super::{StagePoint, StageSolver};
use crate::math::{BLOCK, Spline, with_widest_vectors};
use crate::model::{LinkMotion, Model, SurfacePoint};

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

// The slices that the following functions write are arguments of their own. By that the compiler knows that they do not
// overlap what is read, and makes vector instructions of the loops.

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
