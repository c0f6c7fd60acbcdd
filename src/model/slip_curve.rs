//! Friction over the speed of slip, of one contact under a normal force that is held.

use super::{
    FineContact, FineFriction, Flash, FrictionLaw, FrictionShares, PressedContact, RateShearLaw, RememberedSpeed,
    SlipFriction, SlipHistory, SpeedShift,
};
use crate::math::bracketed_root;

/// Accuracy of a speed on the curve, as a difference of ln v.
const SPEED_ACCURACY: f64 = 1e-3;

/// The excess of the friction in slip over that at rest, over the speed in the direction of slip, of one contact under
/// a normal force that is held. It is odd, so that a mass that turns round is braked before its mode changes; with memory
/// it is even, as there friction has its value at rest, too.
#[derive(Clone, Copy, Debug)]
pub struct SlipCurve<'a> {
    pub(super) law: &'a FrictionLaw,
    /// The contact on the roughness below the profile, and as it is at rest.
    pub(super) fine: Option<(PressedContact<'a>, FineContact)>,
    /// F_N, N.
    pub(super) normal: f64,
    pub(super) history: SlipHistory,
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
        self.law.creep_speed()
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
        match (&self.law.shift, &self.history.memory) {
            (None, None) => self.at_layer_temperature(speed),
            (None, Some(memory)) => {
                let RememberedSpeed { value, by_speed, by_base } = memory.at(speed);
                let at = self.at_layer_temperature(value);
                SlipFriction { by_speed: at.by_speed * by_speed, by_memory: at.by_speed * by_base, ..at }
            }
            (Some(shift), None) => {
                let itself = RememberedSpeed { value: speed, by_speed: 1.0, by_base: 0.0 };
                self.heated(shift, speed.abs(), 1.0, itself)
            }
            (Some(shift), Some(memory)) => self.heated(shift, speed.abs(), 1.0_f64.copysign(speed), memory.at(speed)),
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

    /// Friction at the speed that `counts`, and the flash temperature that it raises with `size` = |v_t| (m/s), whose
    /// derivative by the speed is `of_size`: ϑ = known + gain T |v_t|, by Newton's method.
    fn heated(&self, shift: &SpeedShift, size: f64, of_size: f64, counts: RememberedSpeed) -> SlipFriction {
        let Flash { known, gain, guess } = self.history.flash;
        let (mut flash, sign) = (guess, 1.0_f64.copysign(counts.value));
        for _ in 0..MAX_FLASH_ITERATIONS {
            // Friction at this temperature is that at the layer's at another speed.
            let (ratio, by_flash) = shift.ratio(flash);
            let at = self.at_layer_temperature(ratio * counts.value);
            let by_flash = at.by_speed * (ratio * counts.value.abs()) * by_flash;
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
                by_speed: own * (ratio * at.by_speed * counts.by_speed + by_flash * gain * friction * of_size),
                by_memory: own * (ratio * at.by_speed * counts.by_base),
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

impl FrictionLaw {
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
}

/// Changes up to this share of the speed are taken along the tangent instead of the curve.
const STRAIGHT: f64 = 0.1;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;

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
        let shear = rate_shear.map_or(0.0, |law| law.plateau());
        FrictionLaw {
            present: true,
            coulomb: 0.0,
            shear,
            has_parts: false,
            rate_shear,
            fine: None,
            shift: None,
            memory: None,
        }
    }

    fn laws() -> [FrictionLaw; 3] {
        let sharp = scene::RateShear { sharpness: 4.0, creep_speed: Some(1.0e-5), ..LAW };
        let level = scene::RateShear { sharpness: 0.0, ..LAW };
        [LAW, sharp, level].map(|law| friction(&law))
    }

    fn curve(law: &FrictionLaw) -> SlipCurve<'_> {
        law.slip_curve(0.0, &SlipHistory::default()).unwrap_or_else(|| panic!("no law"))
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
