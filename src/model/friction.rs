//! Friction of a mass in contact: the law, and all that follows from it.
//!
//! Friction has four parts: Coulomb's, the hysteresis of the waves that the profile lacks, a constant shear force, and
//! one that depends on the speed,
//!
//!   T(v_t) = (μ + μ_h(F_N, v_t)) F_N + A_r (τ_0 + τ_f(v_t))
//!
//! The last is the shear strength of rubber, τ_f(v) = τ_f0 exp(-c [log10(v/v_0)]²) above a creep speed v_c and constant
//! below it (B. Lorenz et al., J. Phys.: Condens. Matter 25, 2013). Its plateau A τ_f(v_c) acts at rest too and is
//! counted in [`FrictionLaw::shear`]; a contact that slips has the [excess](super::SlipCurve::excess) over it.
//!
//! μ_h and the area A_r that touches are those of the roughness below the profile ([`FineFriction`]); without it A_r is A.
//! At rest both are at v_c.
//!
//! Where friction heats the contacts, speeds are those at the contact's own temperature, v a_T(T + ϑ)/a_T(T), with the
//! [flash temperature](Flash) ϑ that friction itself raises. T(0) does not depend on it.
//!
//! Where contacts have a [memory](super::SpeedMemory), the speed that counts is the one that they remember, in slip and for
//! the limit of what sticks.
//!
//! A law is what [`FrictionLaw`] answers: T(0), and the excess over it [in slip](SlipFriction) (`slip_curve`), with the derivatives; its
//! power, the shares of its parts, and what it takes in an impact.

use std::f64::consts::LN_10;

use super::{ContactQuantity, FineContact, FineFriction, SlipHistory, SpeedShift};
use crate::scene::{self, Scene};

/// The law of friction of one mass in contact.
#[derive(Clone, Debug)]
pub struct FrictionLaw {
    /// Whether a part of it is not zero, so that contacts can stick.
    pub present: bool,
    /// Coulomb's coefficient μ.
    pub coulomb: f64,
    /// Shear force A τ_0 + A τ_f(v_c) at rest or slower than the creep speed, N, where it acts on all of the area.
    pub shear: f64,
    /// Whether the scene tells its parts apart.
    pub(super) has_parts: bool,
    /// The excess over the shear force in slip; `None` where it does not depend on the speed.
    pub(super) rate_shear: Option<RateShearLaw>,
    /// The roughness below the profile; `None`: the shear force acts on all of a contact's area.
    pub(super) fine: Option<FineFriction>,
    /// How speeds count in contacts that friction heats; `None`: they stay at the layer's temperature.
    pub(super) shift: Option<SpeedShift>,
    /// D, m, over which contacts are renewed, where friction depends on the speed that they remember.
    pub memory: Option<f64>,
}

/// The law A τ_f(v) of one mass in contact: its plateau A τ_f(v_c) and its excess over that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateShearLaw {
    /// A τ_f0, N.
    largest: f64,
    /// A τ_f(v_c), N.
    plateau: f64,
    /// 1/v_0, s/m.
    per_reference: f64,
    /// b = c/ln²10, so that τ_f = τ_f0 exp(-b ln²(v/v_0)).
    sharpness: f64,
    /// v_c, m/s.
    creep_speed: f64,
    /// v/v_0 where τ_f falls fastest.
    fastest_fall: f64,
}

impl RateShearLaw {
    /// The law of a scene; `None` where it has no force.
    pub fn new(law: &scene::RateShear) -> Option<Self> {
        let largest = law.force.unwrap_or(0.0);
        let per_reference = 1.0 / law.reference_speed;
        let (sharpness, creep_speed) = (law.sharpness / (LN_10 * LN_10), law.creep_speed());
        let fastest_fall = fastest_fall(sharpness);
        let without_plateau = Self { largest, plateau: 0.0, per_reference, sharpness, creep_speed, fastest_fall };
        (largest > 0.0).then(|| Self { plateau: without_plateau.whole(creep_speed).0, ..without_plateau })
    }

    /// A τ_f(v_c), N.
    pub fn plateau(&self) -> f64 {
        self.plateau
    }

    /// v_c, m/s.
    pub fn creep_speed(&self) -> f64 {
        self.creep_speed
    }

    /// A τ_f(v), N, and -2b ln(v/v_0), the slope of its logarithm over ln v.
    fn whole(&self, speed: f64) -> (f64, f64) {
        let y = (speed * self.per_reference).ln();
        (self.largest * (-self.sharpness * y * y).exp(), -2.0 * self.sharpness * y)
    }

    /// Bounds of the excess over the plateau, N.
    pub(super) fn bounds(&self) -> (f64, f64) {
        (-self.plateau, self.largest - self.plateau)
    }

    /// The speeds of the largest strength and of the steepest fall, m/s.
    pub(super) fn marks(&self) -> [f64; 2] {
        [1.0, self.fastest_fall].map(|share| share / self.per_reference)
    }

    /// The excess over the plateau, N, and its derivative by the speed, N s/m.
    pub(super) fn with_slope(&self, speed: f64) -> (f64, f64) {
        let size = speed.abs();
        if size <= self.creep_speed {
            return (0.0, 0.0);
        }
        let (force, slope) = self.whole(size);
        ((force - self.plateau) * 1.0_f64.copysign(speed), slope * force / size)
    }
}

/// v/v_0 at which the strength falls fastest: τ_f'' = 0 beyond v_0 at 2by² + y = 1, y = ln(v/v_0).
fn fastest_fall(sharpness: f64) -> f64 {
    (2.0 / (1.0 + (1.0 + 8.0 * sharpness).sqrt())).exp()
}

/// Friction T of a contact in slip, with what the heat that it makes adds to its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SlipFriction {
    /// F_N, N; 0 under a law that is linear in it.
    pub normal: f64,
    /// T(0), N, at that F_N.
    pub limit: f64,
    /// ∂T/∂F_N, 1.
    pub by_normal: f64,
    /// T - T(0), N; odd in the speed, so that a mass that turns round is braked before its mode changes.
    pub excess: f64,
    /// ∂T/∂v_t, N s/m.
    pub by_speed: f64,
    /// The part of T by the hysteresis of the waves that the profile lacks, N.
    pub hysteresis: f64,
    /// A_r/A, 1.
    pub share: f64,
    /// ϑ, K.
    pub flash: f64,
    /// ∂T/∂ϑ by a change of the known part of ϑ, N/K.
    pub by_flash: f64,
    /// ∂T by the known part of the remembered speed, N s/m; 0 without memory.
    pub by_memory: f64,
    /// The part of a change of ϑ that heat makes of itself: ∂ϑ/∂T ∂T/∂ϑ. Beyond 1/2 a step has other solutions nearby.
    pub feedback: f64,
}

impl SlipFriction {
    /// T, N, at the `speed` in the direction of slip.
    pub fn force(&self) -> f64 {
        self.limit + self.excess
    }

    /// `limit` under another F_N, N.
    pub fn limit_under(&self, normal: f64) -> f64 {
        self.limit + (normal - self.normal) * self.by_normal
    }

    /// The tangent of T(0) + ∂T/∂F_N δF_N.
    #[inline(always)]
    pub fn tangent(&self) -> LinearFriction {
        let Self { normal, limit, by_normal, .. } = *self;
        LinearFriction { normal, coulomb: by_normal, shear: limit - by_normal * normal }
    }
}

/// What parts of friction have in it, 1; Coulomb's has the rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionShares {
    /// The shear force.
    pub shear: f64,
    /// The hysteresis of the waves that the profile lacks.
    pub fine: f64,
}

/// A law of friction that is linear in the normal force, or the tangent of another: T(0) = μ F_N + `shear`.
#[derive(Clone, Copy, Debug)]
pub struct LinearFriction {
    /// F_N at which it is the tangent, N; 0 where the law itself is linear.
    pub normal: f64,
    /// ∂T/∂F_N.
    pub coulomb: f64,
    /// T(0) less that times F_N, N.
    pub shear: f64,
}

impl FrictionLaw {
    /// The law of a scene.
    pub fn new(scene: &Scene) -> Self {
        Self::with_fine(scene, FineFriction::new(scene))
    }

    /// The law of a scene whose roughness below the profile is known to rub so.
    pub fn with_fine(scene: &Scene, fine: Option<FineFriction>) -> Self {
        let coulomb = scene.friction.as_ref().and_then(|friction| friction.coulomb).unwrap_or(0.0);
        let shear = scene.shear_force().unwrap_or(0.0);
        let rate_shear = scene.rate_shear().and_then(|law| RateShearLaw::new(&law));
        let rubs = fine.as_ref().is_some_and(FineFriction::rubs);
        Self {
            present: coulomb > 0.0 || shear > 0.0 || rate_shear.is_some() || rubs,
            coulomb,
            shear: shear + rate_shear.map_or(0.0, |rate_shear| rate_shear.plateau()),
            has_parts: scene.has_friction_parts(),
            rate_shear,
            fine,
            shift: SpeedShift::new(scene),
            memory: None,
        }
        .with_memory(scene.memory_way())
    }

    /// The law where contacts are renewed over the way D = `way`, m; 0: at once.
    fn with_memory(self, way: f64) -> Self {
        let memory = (way > 0.0 && self.depends_on_speed()).then_some(way);
        Self { memory, ..self }
    }

    /// Whether it depends on the speed of slip.
    pub fn depends_on_speed(&self) -> bool {
        self.rate_shear.is_some() || self.fine.as_ref().is_some_and(FineFriction::depends_on_speed)
    }

    /// Whether it is linear in the normal force.
    pub fn is_linear_in_normal(&self) -> bool {
        self.fine.is_none()
    }

    /// Whether it is linear in the normal force and does not depend on the speed.
    pub fn is_linear(&self) -> bool {
        self.rate_shear.is_none() && self.fine.is_none()
    }

    /// T(0) under the normal force F_N (N), (μ + μ_h(F_N, v_c)) F_N + A_r(F_N, v_c) (τ_0 + τ_f(v_c)), N.
    #[inline]
    pub fn limit(&self, normal: f64) -> f64 {
        let rest = match &self.fine {
            None => self.shear,
            Some(fine) => {
                let contact = fine.at_rest(normal);
                contact.share.value * self.shear + contact.hysteresis.value
            }
        };
        self.coulomb * normal + rest
    }

    /// v_c of the roughness below the profile at the layer's temperature, m/s, where friction on it depends on the speed.
    pub fn fine_creep_speed(&self) -> Option<f64> {
        Some(self.fine.as_ref().filter(|fine| fine.depends_on_speed())?.creep_speed())
    }

    /// v_c (m/s), up to which contacts on the roughness below the profile slip as at rest, at the flash temperature
    /// `flash` (K); `None` without it, and where friction follows the remembered speed, which changes over a way.
    pub fn creep_end(&self, flash: f64) -> Option<f64> {
        if self.memory.is_some() {
            return None;
        }
        let fine = self.fine.as_ref().filter(|fine| fine.depends_on_speed())?;
        Some(fine.creep_speed() / self.shift.map_or(1.0, |shift| shift.ratio(flash).0))
    }

    /// v_c at the layer's temperature, up to which friction is that at rest, m/s; 0 where it does not depend on the speed.
    pub fn creep_speed(&self) -> f64 {
        match (&self.rate_shear, &self.fine) {
            (Some(law), _) => law.creep_speed(),
            (None, Some(fine)) => fine.creep_speed(),
            (None, None) => 0.0,
        }
    }

    /// The law without its dependence on the speed, where it is linear in the normal force.
    #[inline(always)]
    pub fn linear(&self) -> LinearFriction {
        LinearFriction { normal: 0.0, coulomb: self.coulomb, shear: self.shear }
    }

    /// What the roughness below the profile does in a contact under F_N (N) at the `speed` (m/s) with what the past has left:
    /// without it all of the area touches, and no hysteresis is added.
    pub fn fine_contact(&self, normal: f64, speed: f64, history: &SlipHistory) -> FineContact {
        let whole = ContactQuantity { value: 1.0, ..ContactQuantity::default() };
        let smooth = FineContact { share: whole, ..FineContact::default() };
        let shift = self.shift.map_or(1.0, |shift| shift.ratio(history.flash.known).0);
        let speed = history.memory.map_or(speed, |memory| memory.at(speed).value);
        self.fine.as_ref().map_or(smooth, |fine| fine.contact(normal, shift * speed))
    }

    /// Bound of the hysteresis of the waves that the profile lacks under F_N (N) at any speed, N.
    pub fn largest_hysteresis(&self, normal: f64) -> f64 {
        self.fine.as_ref().map_or(0.0, |fine| fine.largest_hysteresis(normal))
    }

    /// The hysteresis of the waves that the profile lacks in that friction, N.
    pub(super) fn hysteresis_at_rest(&self, normal: f64, history: &SlipHistory) -> ContactQuantity {
        match (&self.fine, history.memory) {
            (None, _) => ContactQuantity::default(),
            (Some(fine), None) => fine.at_rest(normal).hysteresis,
            (Some(_), Some(_)) => self.fine_contact(normal, 0.0, history).hysteresis,
        }
    }

    /// v_t (m/s) after an impact with the velocity v_n < 0 (m/s) along the normal: by its impulse J = -m v_n Coulomb's
    /// friction takes μ J, and shear forces, which are finite, nothing.
    pub fn after_impact(&self, v_t: f64, v_n: f64) -> f64 {
        (v_t.abs() + self.coulomb * v_n).max(0.0).copysign(v_t)
    }
}
