//! Friction of a mass in contact: the law, and all that follows from it.
//!
//! Friction has four parts: Coulomb's, the hysteresis of the waves that the profile lacks, a constant shear force, and
//! one that depends on the speed,
//!
//!   T(v_t) = (μ + μ_h(F_N, v_t)) F_N + A_r (τ_0 + τ_f(v_t))
//!
//! The last is the shear strength of rubber, τ_f(v) = τ_f0 exp(-c [log10(v/v_0)]²) above a creep speed v_c and constant
//! below it (B. Lorenz et al., J. Phys.: Condens. Matter 25, 2013). Its plateau A τ_f(v_c) acts at rest too and is
//! counted in [`FrictionLaw::shear`]; a contact that slips has the [excess](SlipCurve::excess) over it.
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
//! A law is what [`FrictionLaw`] answers: T(0), and the excess over it [in slip](SlipFriction), with the derivatives; its
//! power, the shares of its parts, and what it takes in an impact.

use super::{ContactQuantity, FineContact, FineFriction, RateShearLaw, SlipCurve, SlipHistory, SpeedShift};
use crate::scene::Scene;

/// Changes up to this share of the speed are taken along the tangent instead of the curve.
const STRAIGHT: f64 = 0.1;

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

    /// The largest friction of a contact that sticks under F_N (N) with this history, N: [T(0)](Self::limit), with memory
    /// T at the speed that it remembers.
    #[inline]
    pub fn limit_with(&self, normal: f64, history: &SlipHistory) -> f64 {
        if history.memory.is_none() { self.limit(normal) } else { self.slip(normal, 0.0, history).force() }
    }

    /// The excess in slip over T(0) under the normal force F_N (N), with what the past has left; `None` where friction
    /// does not depend on the speed.
    #[inline]
    pub fn slip_curve(&self, normal: f64, history: &SlipHistory) -> Option<SlipCurve<'_>> {
        let fine = self.fine.as_ref().map(|fine| {
            let pressed = fine.under(normal);
            (pressed, pressed.at_rest())
        });
        self.depends_on_speed().then_some(SlipCurve { law: self, fine, normal, history: *history })
    }

    /// v |∂T/∂v| where friction under F_N (N) falls at the `speed` v (m/s) of even sliding, N, at the flash temperature
    /// `flash`, K; below 0 where it rises, and 0 where it does not depend on the speed.
    pub fn fall(&self, normal: f64, speed: f64, flash: f64) -> f64 {
        let curve = self.slip_curve(normal, &SlipHistory::even(flash));
        -speed * curve.map_or(0.0, |curve| curve.with_slope(speed).1)
    }

    /// Friction under F_N (N) at the `speed` in the direction of slip, m/s. On roughness below the profile `limit` is then
    /// Coulomb's part alone and `excess` the rest, unless the mass has turned round: their sum is what counts.
    #[inline]
    pub fn slip(&self, normal: f64, speed: f64, history: &SlipHistory) -> SlipFriction {
        let is_odd = history.memory.is_none();
        let fine = self.fine.as_ref().map(|fine| {
            let pressed = fine.under(normal);
            (pressed, if speed < 0.0 && is_odd { pressed.at_rest() } else { FineContact::default() })
        });
        match self.depends_on_speed().then_some(SlipCurve { law: self, fine, normal, history: *history }) {
            Some(curve) => curve.at(speed),
            None => {
                let share = self.fine_contact(normal, speed, history).share;
                SlipFriction {
                    normal,
                    limit: self.limit(normal),
                    by_normal: self.coulomb + self.shear * share.by_normal,
                    share: share.value,
                    flash: history.flash.known,
                    ..SlipFriction::default()
                }
            }
        }
    }

    /// A correction `by` (m/s) of Newton's method at the `speed` of slip under F_N (N), as
    /// [`SlipCurve::along_curve`] takes it; along the tangent where it is small, and where a memory makes friction smooth.
    pub fn along_curve(&self, normal: f64, history: &SlipHistory, (speed, by): (f64, f64), weight: f64) -> f64 {
        if by.abs() <= STRAIGHT * speed.abs() || history.memory.is_some() {
            return speed + by;
        }
        self.slip_curve(normal, history).map_or(speed + by, |curve| curve.along_curve(speed, by, weight))
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

    /// The parts of the [largest friction](Self::limit_with) of what sticks under F_N (N): what its force is shared out by.
    pub fn shares_at_rest(&self, normal: f64, history: &SlipHistory) -> FrictionShares {
        let (limit, coulomb) = (self.limit_with(normal, history), self.coulomb * normal.max(0.0));
        if limit <= coulomb {
            return FrictionShares::default();
        }
        let fine = self.hysteresis_at_rest(normal, history).value / limit;
        FrictionShares { shear: 1.0 - coulomb / limit - fine, fine }
    }

    /// The derivatives of the [shares](Self::shares_at_rest) by F_N, 1/N, where that of the largest friction is
    /// `by_normal`.
    pub fn shares_by_normal(&self, normal: f64, by_normal: f64, history: &SlipHistory) -> FrictionShares {
        let (limit, coulomb) = (self.limit_with(normal, history), self.coulomb);
        if normal <= 0.0 || limit <= coulomb * normal {
            return FrictionShares::default();
        }
        let hysteresis = self.hysteresis_at_rest(normal, history);
        let fine = (hysteresis.by_normal - hysteresis.value * by_normal / limit) / limit;
        FrictionShares { shear: coulomb * (normal * by_normal / limit - 1.0) / limit - fine, fine }
    }

    /// The hysteresis of the waves that the profile lacks in that friction, N.
    fn hysteresis_at_rest(&self, normal: f64, history: &SlipHistory) -> ContactQuantity {
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
