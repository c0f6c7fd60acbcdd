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
//! A law is what [`FrictionLaw`] answers: T(0), and the excess over it [in slip](SlipFriction), with the derivatives; its
//! power, the shares of its parts, and what it takes in an impact.

use std::f64::consts::LN_10;

use super::{
    ContactForces, ContactQuantity, FineContact, FineFriction, Flash, Forces, Mode, Model, PressedContact, SpeedShift,
    State,
};
use crate::math::{bracketed_root, dot, sum};
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
    has_parts: bool,
    /// The excess over the shear force in slip; `None` where it does not depend on the speed.
    rate_shear: Option<RateShearLaw>,
    /// The roughness below the profile; `None`: the shear force acts on all of a contact's area.
    fine: Option<FineFriction>,
    /// How speeds count in contacts that friction heats; `None`: they stay at the layer's temperature.
    shift: Option<SpeedShift>,
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
        }
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

    /// The excess in slip over T(0) under the normal force F_N (N), at the flash temperature that goes with it; `None` where
    /// friction does not depend on the speed.
    #[inline]
    pub fn slip_curve(&self, normal: f64, flash: Flash) -> Option<SlipCurve<'_>> {
        let fine = self.fine.as_ref().map(|fine| {
            let pressed = fine.under(normal);
            (pressed, pressed.at_rest())
        });
        self.depends_on_speed().then_some(SlipCurve { law: self, fine, normal, flash })
    }

    /// Friction under F_N (N) at the `speed` in the direction of slip, m/s. On roughness below the profile `limit` is then
    /// Coulomb's part alone and `excess` the rest, unless the mass has turned round: their sum is what counts.
    #[inline]
    pub fn slip(&self, normal: f64, speed: f64, flash: Flash) -> SlipFriction {
        let fine = self.fine.as_ref().map(|fine| {
            let pressed = fine.under(normal);
            (pressed, if speed < 0.0 { pressed.at_rest() } else { FineContact::default() })
        });
        match self.depends_on_speed().then_some(SlipCurve { law: self, fine, normal, flash }) {
            Some(curve) => curve.at(speed),
            None => {
                let share = self.fine_contact(normal, speed, flash.known).share;
                SlipFriction {
                    normal,
                    limit: self.limit(normal),
                    by_normal: self.coulomb + self.shear * share.by_normal,
                    share: share.value,
                    flash: flash.known,
                    ..SlipFriction::default()
                }
            }
        }
    }

    /// A correction `by` (m/s) of Newton's method at the `speed` of slip under F_N (N), as
    /// [`SlipCurve::along_curve`] takes it; along the tangent where it is small.
    pub fn along_curve(&self, normal: f64, flash: Flash, (speed, by): (f64, f64), weight: f64) -> f64 {
        if by.abs() <= STRAIGHT * speed.abs() {
            return speed + by;
        }
        self.slip_curve(normal, flash).map_or(speed + by, |curve| curve.along_curve(speed, by, weight))
    }

    /// v_c (m/s), up to which contacts on the roughness below the profile slip as at rest, at the flash temperature
    /// `flash` (K); `None` without it.
    pub fn creep_end(&self, flash: f64) -> Option<f64> {
        let fine = self.fine.as_ref().filter(|fine| fine.depends_on_speed())?;
        Some(fine.creep_speed() / self.shift.map_or(1.0, |shift| shift.ratio(flash).0))
    }

    /// The law without its dependence on the speed, where it is linear in the normal force.
    #[inline(always)]
    pub fn linear(&self) -> LinearFriction {
        LinearFriction { normal: 0.0, coulomb: self.coulomb, shear: self.shear }
    }

    /// What the roughness below the profile does in a contact under F_N (N) at the `speed` (m/s) and the flash temperature
    /// `flash` (K): without it all of the area touches, and no hysteresis is added.
    pub fn fine_contact(&self, normal: f64, speed: f64, flash: f64) -> FineContact {
        let whole = ContactQuantity { value: 1.0, ..ContactQuantity::default() };
        let smooth = FineContact { share: whole, ..FineContact::default() };
        let shift = self.shift.map_or(1.0, |shift| shift.ratio(flash).0);
        self.fine.as_ref().map_or(smooth, |fine| fine.contact(normal, shift * speed))
    }

    /// Bound of the hysteresis of the waves that the profile lacks under F_N (N) at any speed, N.
    pub fn largest_hysteresis(&self, normal: f64) -> f64 {
        self.fine.as_ref().map_or(0.0, |fine| fine.largest_hysteresis(normal))
    }

    /// The parts of T(0) under F_N (N): what a sticking force is shared out by.
    pub fn shares_at_rest(&self, normal: f64) -> FrictionShares {
        let (limit, coulomb) = (self.limit(normal), self.coulomb * normal.max(0.0));
        if limit <= coulomb {
            return FrictionShares::default();
        }
        let fine = self.hysteresis_at_rest(normal).value / limit;
        FrictionShares { shear: 1.0 - coulomb / limit - fine, fine }
    }

    /// The derivatives of the [shares](Self::shares_at_rest) by F_N, 1/N, where that of T(0) is `by_normal`.
    pub fn shares_by_normal(&self, normal: f64, by_normal: f64) -> FrictionShares {
        let (limit, coulomb) = (self.limit(normal), self.coulomb);
        if normal <= 0.0 || limit <= coulomb * normal {
            return FrictionShares::default();
        }
        let hysteresis = self.hysteresis_at_rest(normal);
        let fine = (hysteresis.by_normal - hysteresis.value * by_normal / limit) / limit;
        FrictionShares { shear: coulomb * (normal * by_normal / limit - 1.0) / limit - fine, fine }
    }

    /// μ_h(F_N, v_c) F_N, N.
    fn hysteresis_at_rest(&self, normal: f64) -> ContactQuantity {
        self.fine.as_ref().map_or(ContactQuantity::default(), |fine| fine.at_rest(normal).hysteresis)
    }

    /// v_t (m/s) after an impact with the velocity v_n < 0 (m/s) along the normal: by its impulse J = -m v_n Coulomb's
    /// friction takes μ J, and shear forces, which are finite, nothing.
    pub fn after_impact(&self, v_t: f64, v_n: f64) -> f64 {
        (v_t.abs() + self.coulomb * v_n).max(0.0).copysign(v_t)
    }
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

/// Accuracy of a speed on the curve, as a difference of ln v.
const SPEED_ACCURACY: f64 = 1e-3;

/// Changes up to this share of the speed are taken along the tangent instead of the curve.
const STRAIGHT: f64 = 0.1;

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

    /// A τ_f(v), N, and -2b ln(v/v_0), the slope of its logarithm over ln v.
    fn whole(&self, speed: f64) -> (f64, f64) {
        let y = (speed * self.per_reference).ln();
        (self.largest * (-self.sharpness * y * y).exp(), -2.0 * self.sharpness * y)
    }

    /// Bounds of the excess over the plateau, N.
    fn bounds(&self) -> (f64, f64) {
        (-self.plateau, self.largest - self.plateau)
    }

    /// The speeds of the largest strength and of the steepest fall, m/s.
    fn marks(&self) -> [f64; 2] {
        [1.0, self.fastest_fall].map(|share| share / self.per_reference)
    }

    /// The excess over the plateau, N, and its derivative by the speed, N s/m.
    fn with_slope(&self, speed: f64) -> (f64, f64) {
        let size = speed.abs();
        if size <= self.creep_speed {
            return (0.0, 0.0);
        }
        let (force, slope) = self.whole(size);
        ((force - self.plateau) * 1.0_f64.copysign(speed), slope * force / size)
    }
}

/// The excess of the friction in slip over that at rest, over the speed in the direction of slip, of one contact under
/// a normal force that is held. It is odd, so that a mass that turns round is braked before its mode changes.
#[derive(Clone, Copy, Debug)]
pub struct SlipCurve<'a> {
    law: &'a FrictionLaw,
    /// The contact on the roughness below the profile, and as it is at rest.
    fine: Option<(PressedContact<'a>, FineContact)>,
    /// F_N, N.
    normal: f64,
    flash: Flash,
}

/// Corrections of a flash temperature below this, K, are the last: friction is taken along its tangent over them, which
/// changes by some hundredths a kelvin.
const FLASH_ACCURACY: f64 = 1e-4;
/// Iterations for a flash temperature. Where they do not end, heat feeds itself so much that the step is refused.
const MAX_FLASH_ITERATIONS: usize = 30;
/// The largest feedback with which a correction of Newton's method is taken.
const MAX_FEEDBACK: f64 = 0.9;

impl SlipCurve<'_> {
    /// The speed up to which there is no excess, m/s, where friction does not heat the contact.
    pub fn creep_speed(&self) -> f64 {
        match (&self.law.rate_shear, &self.law.fine) {
            (Some(law), _) => law.creep_speed,
            (None, Some(fine)) => fine.creep_speed(),
            (None, None) => 0.0,
        }
    }

    /// Bounds of the excess, N.
    fn bounds(&self) -> (f64, f64) {
        let (least, most) = self.law.rate_shear.as_ref().map_or((0.0, 0.0), RateShearLaw::bounds);
        match (&self.law.fine, &self.fine) {
            (Some(fine), Some((_, at_rest))) => {
                let (share, hysteresis) = (at_rest.share.value, at_rest.hysteresis.value);
                let growth = (fine.largest_hysteresis(self.normal) - hysteresis).max(0.0);
                (-share * self.law.shear - hysteresis, share * most + growth)
            }
            _ => (least, most),
        }
    }

    /// Speeds that divide the curve into parts in which it bends one way, m/s.
    fn marks(&self) -> [f64; 2] {
        self.law.rate_shear.as_ref().map_or([self.creep_speed(); 2], RateShearLaw::marks)
    }

    /// Friction at the `speed` in the direction of slip, m/s.
    #[inline]
    pub fn at(&self, speed: f64) -> SlipFriction {
        match &self.law.shift {
            None => self.at_layer_temperature(speed),
            Some(shift) => self.heated(shift, speed),
        }
    }

    /// Friction at the layer's temperature.
    #[inline]
    fn at_layer_temperature(&self, speed: f64) -> SlipFriction {
        let law = self.law;
        let of_rate = law.rate_shear.as_ref().map_or((0.0, 0.0), |law| law.with_slope(speed));
        let Some((pressed, at_rest)) = &self.fine else {
            return SlipFriction {
                normal: self.normal,
                limit: law.limit(self.normal),
                by_normal: law.coulomb,
                excess: of_rate.0,
                by_speed: of_rate.1,
                share: 1.0,
                ..SlipFriction::default()
            };
        };
        let sign = 1.0_f64.copysign(speed);
        let FineContact { share, hysteresis } = pressed.at(speed);
        let force = law.shear + sign * of_rate.0;
        let of_area = share.value * force - at_rest.share.value * law.shear;
        SlipFriction {
            normal: self.normal,
            limit: law.coulomb * self.normal + (at_rest.share.value * law.shear + at_rest.hysteresis.value),
            by_normal: law.coulomb + share.by_normal * force + hysteresis.by_normal,
            excess: sign * (of_area + (hysteresis.value - at_rest.hysteresis.value)),
            by_speed: share.by_speed * sign * force + share.value * of_rate.1 + sign * hysteresis.by_speed,
            hysteresis: hysteresis.value,
            share: share.value,
            ..SlipFriction::default()
        }
    }

    /// Friction and the flash temperature that it raises, ϑ = known + gain T |v|, by Newton's method.
    fn heated(&self, shift: &SpeedShift, speed: f64) -> SlipFriction {
        let Flash { known, gain, guess } = self.flash;
        let (mut flash, size, sign) = (guess, speed.abs(), 1.0_f64.copysign(speed));
        for _ in 0..MAX_FLASH_ITERATIONS {
            // Friction at this temperature is that at the layer's at another speed.
            let (ratio, by_flash) = shift.ratio(flash);
            let at = self.at_layer_temperature(ratio * speed);
            let by_flash = at.by_speed * (ratio * size) * by_flash;
            let friction = at.limit + sign * at.excess;
            let feedback = gain * size * by_flash;
            let correction = (known + gain * size * friction - flash) / (1.0 - feedback.min(MAX_FEEDBACK));
            flash += correction;
            if correction.abs() > FLASH_ACCURACY {
                continue;
            }
            let own = 1.0 / (1.0 - feedback);
            return SlipFriction {
                by_normal: own * at.by_normal,
                excess: at.excess + sign * by_flash * correction,
                by_speed: own * (ratio * at.by_speed + by_flash * gain * friction),
                flash,
                by_flash: own * by_flash,
                feedback,
                ..at
            };
        }
        SlipFriction { excess: f64::NAN, feedback: f64::INFINITY, ..SlipFriction::default() }
    }

    /// The excess, N, and its derivative by the speed, N s/m, at the `speed` in the direction of slip, m/s.
    pub fn with_slope(&self, speed: f64) -> (f64, f64) {
        let friction = self.at(speed);
        (friction.excess, friction.by_speed)
    }

    /// The excess, N.
    pub fn excess(&self, speed: f64) -> f64 {
        self.with_slope(speed).0
    }

    /// A correction `by` (m/s) of Newton's method at `speed`, taken along the curve and not along its tangent: the
    /// speed v, m/s, at which `weight` (v - `speed`) and the change of the excess have the value that the tangent
    /// predicts.
    ///
    /// The curve is nearly a logarithm: at creep speeds its tangent is steep and valid over a short range only, and
    /// corrections along it would alternate between both ends of the decades.
    pub fn along_curve(&self, speed: f64, by: f64, weight: f64) -> f64 {
        let linear = speed + by;
        let constant = linear.abs() <= self.creep_speed() && speed.abs() <= self.creep_speed();
        if constant || weight.is_nan() || weight <= 0.0 {
            return linear;
        }
        let (here, slope) = self.with_slope(speed);
        self.balance(speed, here + (weight + slope) * by, weight)
    }

    /// The speed v, m/s, at which `weight` (v - `from`) and the excess add up to `force` (N). Where friction falls
    /// faster than the weight there may be three: then it is the first one from `from`, as the motion reaches it.
    pub fn balance(&self, from: f64, force: f64, weight: f64) -> f64 {
        let free = from + force / weight;
        if free < 0.0 {
            return -self.balance(-from, -force, weight);
        }
        let creep_speed = self.creep_speed();
        if free <= creep_speed {
            return free;
        }
        let (least, most) = self.bounds();
        let [low, high] = [most, least].map(|excess| (free - excess / weight).max(creep_speed));
        let residual = |v: f64| (v - from) * weight + self.excess(v) - force;
        if residual(low) >= 0.0 || !high.is_finite() {
            return low;
        }
        let (low, high) = first_bracket(self.marks(), residual, from.clamp(low, high), (low, high));
        let speed = |y: f64| creep_speed * y.exp();
        let bracket = [low, high].map(|v| (v / creep_speed).ln());
        speed(bracketed_root(|y| residual(speed(y)), (bracket[0], bracket[1]), SPEED_ACCURACY))
    }

    /// The steepest fall of friction up to the `speed` of slip, m/s, by the real area that shrinks: ∂T/∂v, N s/m, 0
    /// where friction does not fall.
    pub fn steepest_fall(&self, speed: f64) -> f64 {
        let speeds = self.law.fine.iter().flat_map(FineFriction::speeds);
        let falls = speeds.filter(|&at| at >= SLOWEST_FALL * speed).take_while(|&at| at <= speed);
        falls.map(|at| self.with_slope(at).1).fold(0.0, f64::min)
    }
}

/// Falls of friction at less than this share of a speed are over before it is reached.
const SLOWEST_FALL: f64 = 1e-3;

/// The part of the bracket (m/s) with the first zero of `residual` from the speed `from`. The `marks` divide the speeds
/// into three parts: in each there is one zero at most if the signs at its ends differ.
fn first_bracket(
    marks: [f64; 2],
    residual: impl Fn(f64) -> f64,
    from: f64,
    (mut low, mut high): (f64, f64),
) -> (f64, f64) {
    let faster = residual(from) < 0.0;
    *(if faster { &mut low } else { &mut high }) = from;
    for mark in if faster { marks } else { [marks[1], marks[0]] } {
        if !(low < mark && mark < high) {
            continue;
        }
        let above = residual(mark) >= 0.0;
        *(if above { &mut high } else { &mut low }) = mark;
        if above == faster {
            break;
        }
    }
    (low, high)
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
            let v = state.velocity_x[i];
            let contact = forces.contact(model, i, v, &state.surface[i]);
            power.add(
                &model.friction,
                state.mode[i],
                v,
                &contact,
                &contact.slip(model, state.mode[i], v, state.flash(i)),
            );
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

/// v/v_0 at which the strength falls fastest: τ_f'' = 0 beyond v_0 at 2by² + y = 1, y = ln(v/v_0).
fn fastest_fall(sharpness: f64) -> f64 {
    (2.0 / (1.0 + (1.0 + 8.0 * sharpness).sqrt())).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: scene::RateShear = scene::RateShear {
        force: Some(FORCE),
        strength: None,
        reference_speed: 6.0e-3,
        sharpness: 0.1,
        creep_speed: Some(6.0e-9),
    };
    const FORCE: f64 = 3.0e-4;

    fn friction(law: &scene::RateShear) -> FrictionLaw {
        let rate_shear = RateShearLaw::new(law);
        let shear = rate_shear.map_or(0.0, |law| law.plateau);
        FrictionLaw { present: true, coulomb: 0.0, shear, has_parts: false, rate_shear, fine: None, shift: None }
    }

    fn laws() -> [FrictionLaw; 3] {
        let sharp = scene::RateShear { sharpness: 4.0, creep_speed: Some(1.0e-5), ..LAW };
        let level = scene::RateShear { sharpness: 0.0, ..LAW };
        [LAW, sharp, level].map(|law| friction(&law))
    }

    fn curve(law: &FrictionLaw) -> SlipCurve<'_> {
        law.slip_curve(0.0, Flash::default()).unwrap_or_else(|| panic!("no law"))
    }

    /// Speeds over eleven decades, from the creep speed of [`LAW`] on.
    fn speeds() -> impl Iterator<Item = f64> {
        (1..=110).map(|i| 6.0e-9 * 10.0_f64.powf(0.1 * f64::from(i)))
    }

    #[test]
    fn strength_is_what_its_formula_says() {
        for law in [LAW, scene::RateShear { sharpness: 4.0, ..LAW }] {
            let whole = friction(&law);
            let found = curve(&whole);
            let expected = |speed: f64| {
                let decades = (speed / law.reference_speed).log10();
                FORCE * (-law.sharpness * decades * decades).exp()
            };
            // Roundings of an exponent of some hundreds.
            assert!((whole.shear - expected(6.0e-9)).abs() < 1e-12 * FORCE);
            for speed in speeds() {
                let force = whole.shear + found.excess(speed);
                assert!((force - expected(speed)).abs() < 1e-12 * FORCE, "{speed:e}: {force:e}");
            }
            for speed in [6.0e-9, 1.0e-9, 0.0, -6.0e-9] {
                assert_eq!((found.excess(speed), found.with_slope(speed)), (0.0, (0.0, 0.0)));
            }
            for speed in speeds().skip(1) {
                let (force, slope) = found.with_slope(speed);
                assert_eq!(found.with_slope(-speed), (-force, slope));
            }
        }
    }

    #[test]
    fn slope_is_that_of_a_difference_quotient() {
        for law in &laws() {
            let law = curve(law);
            for speed in speeds().filter(|&speed| speed > 1.01 * law.creep_speed()) {
                let h = 1e-4 * speed;
                let quotient = (law.excess(speed + h) - law.excess(speed - h)) / (2.0 * h);
                let (force, slope) = law.with_slope(speed);
                assert_eq!(force, law.excess(speed));
                // The third derivative times h², and roundings over h.
                let scale = FORCE / speed;
                assert!((slope - quotient).abs() < 1e-6 * scale, "{speed:e}: {slope:e} {quotient:e}");
            }
        }
    }

    /// From any speed to any other, in the same direction and in the other.
    #[test]
    fn a_correction_ends_on_the_curve() {
        for law in &laws() {
            let law = curve(law);
            for weight in [1e-3, 1.0, 1e3] {
                let pairs = speeds().flat_map(|from| speeds().map(move |to| (from, to)));
                for (from, to) in pairs.flat_map(|(from, to)| [(from, to), (from, -to)]) {
                    let (here, slope) = law.with_slope(from);
                    let force = weight * (to - from) + law.excess(to) - here;
                    // More than one speed may have this friction where it falls faster than the weight.
                    if law.with_slope(from).1 < -weight || law.with_slope(to).1 < -weight || slope.abs() > 1e12 {
                        continue;
                    }
                    let found = law.along_curve(from, force / (weight + slope), weight);
                    let missed = weight * (found - from) + law.excess(found) - here - force;
                    let (_, there) = law.with_slope(found);
                    // As near as ln v is found, or, for a short way, as the tangent is.
                    let allowed = 0.1 * (weight + slope.abs() + there.abs()) * (found - from).abs()
                        + 2e-3 * (weight + there.abs()) * found.abs();
                    assert!(missed.abs() <= allowed, "{from:e} to {to:e}: {found:e} misses {missed:e} of {force:e}");
                }
            }
            let back = law.along_curve(1e-3, -1.0, 1e-6);
            assert!(back < 0.0, "a large enough force reverses: {back:e}");
        }
    }
}
