//! Friction over the speed of slip, of one contact under a normal force that is held.

use std::f64::consts::LN_10;

use super::{
    FineContact, FineFriction, Flash, FrictionLaw, PressedContact, RememberedSpeed, SlipFriction, SlipHistory,
    SpeedShift,
};
use crate::math::bracketed_root;
use crate::scene;

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
