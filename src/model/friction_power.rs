//! The power of friction, and its parts.

use super::{ContactForces, Forces, FrictionLaw, Mode, Model, SlipFriction, State};
use crate::math::{dot, sum};

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
