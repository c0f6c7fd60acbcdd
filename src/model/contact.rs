//! The forces in a contact: the normal force and the tangential one, and the acceleration that they leave.

use super::{ByAxis, Forces, FrictionLaw, Mode, Model, SlipFriction, SlipHistory, State, SurfacePoint};
use crate::math::{dot, sum};

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

/// The power of friction, summed mass by mass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionPower {
    /// Of T(0), W.
    at_rest: f64,
    /// Of its part μ F_N, W; 0 where the scene does not tell the parts apart.
    coulomb: f64,
    /// Of the hysteresis of the waves that the profile lacks, in slip, W; likewise.
    fine: f64,
    /// Of A τ_f(v) - A τ_f(v_c), W.
    excess: f64,
}

impl FrictionPower {
    /// Of all masses in `state` with the forces there.
    pub(super) fn evaluate(model: &Model, state: &State, forces: &Forces) -> Self {
        let mut power = Self::default();
        for i in (0..model.masses()).filter(|&i| model.friction.present && state.mode[i].slips()) {
            let (mode, v) = (state.mode[i], state.velocity_x[i]);
            let contact = forces.contact(model, state, i);
            power.add(&model.friction, mode, v, &contact, &contact.slip(model, mode, v, &state.history(i)));
        }
        power
    }

    /// Under a linear law of friction: of masses with these σ v_t (m/s; 0 of those that do not slip) and normal forces
    /// (N).
    pub fn from_linear_law(law: &FrictionLaw, slip_speeds: &[f64], normal: &[f64]) -> Self {
        let coulomb = law.coulomb * dot(slip_speeds, normal);
        let shear = if law.shear > 0.0 { law.shear * sum(slip_speeds) } else { 0.0 };
        Self { at_rest: coulomb + shear, coulomb: if law.has_parts { coulomb } else { 0.0 }, fine: 0.0, excess: 0.0 }
    }

    /// Adds that of a mass which slips in `mode` with the velocity ẋ (m/s) under the forces of `contact`, and with this
    /// friction.
    #[inline]
    pub fn add(
        &mut self,
        law: &FrictionLaw,
        mode: Mode,
        velocity_x: f64,
        contact: &ContactForces,
        friction: &SlipFriction,
    ) {
        let (sigma, v) = (mode.direction(), velocity_x);
        let speed = sigma * v * contact.q;
        self.at_rest += sigma * friction.limit_under(contact.normal) * v * contact.q;
        if law.has_parts {
            self.coulomb += sigma * (law.coulomb * contact.normal) * v * contact.q;
            self.fine += friction.hysteresis * speed;
        }
        if law.depends_on_speed() {
            self.excess += friction.excess * speed;
        }
    }

    /// P_friction, W.
    pub(super) fn friction(&self) -> f64 {
        self.at_rest + self.excess
    }

    /// P_shear, W; 0 where the scene does not tell the parts apart.
    pub(super) fn shear(&self, law: &FrictionLaw) -> f64 {
        if law.has_parts { (self.at_rest - self.coulomb) + self.excess - self.fine } else { 0.0 }
    }

    /// Of the hysteresis of the waves that the profile lacks, W; 0 where the scene does not tell the parts apart.
    pub(super) fn fine(&self) -> f64 {
        self.fine
    }
}
