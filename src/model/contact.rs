//! The forces in a contact: the normal force and the tangential one, and the acceleration that they leave.

use super::{ByAxis, Forces, Mode, Model, SlipFriction, SlipHistory, State, SurfacePoint};

/// The forces in one contact, from (6)-(9).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForces {
    /// F_N of the surface on the mass, N.
    pub normal: f64,
    /// f·t = (f_x + s f_z)/q of the links, N.
    pub tangential: f64,
    /// T(0) = μ F_N + A τ_0 + A τ_f(v_c), with memory T(v_s): the largest friction force at rest, N.
    pub limit: f64,
    /// q = √(1 + s²).
    pub q: f64,
}

impl ContactForces {
    /// The contact forces that follow from the links' force on the mass, f_x and f_z, N, its velocity ẋ, m/s, the
    /// surface under it, and what its past has left.
    #[inline]
    pub fn new(
        model: &Model,
        forces: ByAxis<f64>,
        velocity_x: f64,
        surface: &SurfacePoint,
        history: &SlipHistory,
    ) -> Self {
        let contact = Self::without_limit(model.mass, forces, velocity_x, surface);
        Self { limit: model.friction.limit_with(contact.normal, history), ..contact }
    }

    /// The contact forces without T(0) on a mass of `mass`, kg.
    #[inline(always)]
    pub fn without_limit(mass: f64, forces: ByAxis<f64>, velocity_x: f64, surface: &SurfacePoint) -> Self {
        let ByAxis { x: f_x, z: f_z } = forces;
        let s = surface.slope;
        let q = (1.0 + s * s).sqrt();
        // From (6)-(9): the normal force needs no acceleration.
        let normal = (mass * surface.curvature * velocity_x * velocity_x - f_z + s * f_x) / q;
        Self { normal, tangential: (f_x + s * f_z) / q, limit: 0.0, q }
    }

    /// Those of a slipping mass with a normal force (N) and velocities ẋ ≠ 0 and ż (m/s), but for f·t.
    pub fn in_slip(model: &Model, normal: f64, (velocity_x, velocity_z): (f64, f64)) -> Self {
        let slope = velocity_z / velocity_x;
        Self { normal, tangential: 0.0, limit: model.friction.limit(normal), q: (1.0 + slope * slope).sqrt() }
    }

    /// F_T on a mass in `mode` at the velocity ẋ with what the past has left, N, positive against +t: f·t of a sticking
    /// mass, T(v_t) sign(v_t) of a slipping one.
    #[inline]
    pub fn friction(&self, model: &Model, mode: Mode, velocity_x: f64, history: &SlipHistory) -> f64 {
        match mode {
            Mode::Free => 0.0,
            Mode::Stick => self.tangential,
            Mode::Forward | Mode::Backward => {
                let sigma = mode.direction();
                if history.memory.is_some() {
                    return sigma * self.slip(model, mode, velocity_x, history).force();
                }
                let curve = model.friction.slip_curve(self.normal, history);
                let excess = curve.map_or(0.0, |law| law.at(sigma * velocity_x * self.q).excess);
                sigma * (self.limit + excess)
            }
        }
    }

    /// The friction on a mass that slips in `mode` with the velocity ẋ, with what the past has left.
    pub fn slip(&self, model: &Model, mode: Mode, velocity_x: f64, history: &SlipHistory) -> SlipFriction {
        model.friction.slip(self.normal, mode.direction() * velocity_x * self.q, history)
    }

    /// ẍ of a mass in contact in `mode`: m q² ẍ + m s κ ẋ² = f_x + s f_z - F_T q.
    pub fn acceleration(
        &self,
        model: &Model,
        mode: Mode,
        velocity_x: f64,
        surface: &SurfacePoint,
        history: &SlipHistory,
    ) -> f64 {
        if mode == Mode::Stick {
            return 0.0;
        }
        let centripetal = surface.slope * surface.curvature * velocity_x * velocity_x;
        ((self.tangential - self.friction(model, mode, velocity_x, history)) / model.mass - centripetal / self.q)
            / self.q
    }
}

impl Forces {
    /// The contact forces on mass `i`, in contact in `state`.
    #[inline]
    pub fn contact(&self, model: &Model, state: &State, i: usize) -> ContactForces {
        ContactForces::new(model, self.on_mass(i), state.velocity_x[i], &state.surface[i], &state.history(i))
    }
}
