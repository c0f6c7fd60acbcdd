//! The contact laws: the normal force of a mass in contact, and its friction.
//!
//! Friction has three parts: Coulomb's, a constant shear force, and a shear force that depends on the speed,
//!
//!   T(v_t) = μ F_N + A τ_0 + A τ_f(v_t)
//!
//! The last is the shear strength of rubber, τ_f(v) = τ_f0 exp(-c [log10(v/v_0)]²) above a creep speed v_c and constant
//! below it (B. Lorenz et al., J. Phys.: Condens. Matter 25, 2013). Its plateau A τ_f(v_c) acts at rest too and is
//! counted in [`Model::shear_force`]; a contact that slips has the [excess](FrictionCurve::excess) over it.
//!
//! With roughness below the profile's the shear forces act on the part A_r/A of the area alone, which depends on F_N and on
//! the speed ([`RealArea`](super::RealArea)): at rest on A_r(F_N, v_c).

use std::f64::consts::LN_10;

use super::{Forces, Mode, Model, RealArea, SurfacePoint};
use crate::math::bracketed_root;
use crate::scene;

/// The forces in one contact, from (6)-(9).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForces {
    /// F_N of the surface on the mass, N.
    pub normal: f64,
    /// f·t = (f_x + s f_z)/q of the links, N.
    pub tangential: f64,
    /// T(0) = μ F_N + A τ_0 + A τ_f(v_c): the largest friction force at rest, N.
    pub limit: f64,
    /// q = √(1 + s²).
    pub q: f64,
}

impl ContactForces {
    /// The contact forces that follow from the links' force on the mass (f_x, f_z), N, its velocity ẋ, m/s, and the
    /// surface under it.
    #[inline]
    pub fn new(model: &Model, forces: (f64, f64), velocity_x: f64, surface: &SurfacePoint) -> Self {
        let contact = Self::without_limit(model.mass, forces, velocity_x, surface);
        let limit = model.friction_coefficient * contact.normal + model.shear_at_rest(contact.normal);
        Self { limit, ..contact }
    }

    /// The same without T(0), of a mass of `mass`, kg.
    #[inline(always)]
    pub fn without_limit(mass: f64, (f_x, f_z): (f64, f64), velocity_x: f64, surface: &SurfacePoint) -> Self {
        let s = surface.slope;
        let q = (1.0 + s * s).sqrt();
        // From (6)-(9): the normal force needs no acceleration.
        let normal = (mass * surface.curvature * velocity_x * velocity_x - f_z + s * f_x) / q;
        Self { normal, tangential: (f_x + s * f_z) / q, limit: 0.0, q }
    }

    /// Those of a slipping mass with a normal force (N) and velocities ẋ ≠ 0 and ż (m/s), but for f·t.
    pub fn in_slip(model: &Model, normal: f64, (velocity_x, velocity_z): (f64, f64)) -> Self {
        let limit = model.friction_coefficient * normal + model.shear_at_rest(normal);
        let slope = velocity_z / velocity_x;
        Self { normal, tangential: 0.0, limit, q: (1.0 + slope * slope).sqrt() }
    }

    /// ∂T/∂F_N, 1, at the `speed` of slip, m/s.
    pub fn limit_by_normal(&self, model: &Model, speed: f64) -> f64 {
        model.friction_coefficient + SlipCurve { model, normal: self.normal }.by_normal(speed)
    }

    /// The part of T(0) that is shear force, 1: what a sticking force is shared out by.
    pub fn shear_share(&self, model: &Model) -> f64 {
        let coulomb = model.friction_coefficient * self.normal.max(0.0);
        if self.limit > coulomb { 1.0 - coulomb / self.limit } else { 0.0 }
    }

    /// The derivative of the [share](Self::shear_share) by F_N, 1/N, where that of T(0) is `limit_by_normal`.
    pub fn shear_share_by_normal(&self, model: &Model, limit_by_normal: f64) -> f64 {
        let mu = model.friction_coefficient;
        let has_share = self.normal > 0.0 && self.limit > mu * self.normal;
        if has_share { mu * (self.normal * limit_by_normal / self.limit - 1.0) / self.limit } else { 0.0 }
    }

    /// F_T on a mass in `mode` at the velocity ẋ, N, positive against +t: f·t of a sticking mass, T(v_t) sign(v_t) of a
    /// slipping one.
    #[inline]
    pub fn friction(&self, model: &Model, mode: Mode, velocity_x: f64) -> f64 {
        match mode {
            Mode::Free => 0.0,
            Mode::Stick => self.tangential,
            Mode::Forward | Mode::Backward => {
                let sigma = mode.direction();
                let excess = model.slip_curve(self.normal).map_or(0.0, |law| law.excess(sigma * velocity_x * self.q));
                sigma * (self.limit + excess)
            }
        }
    }

    /// ẍ of a mass in contact in `mode`: m q² ẍ + m s κ ẋ² = f_x + s f_z - F_T q.
    pub fn acceleration(&self, model: &Model, mode: Mode, velocity_x: f64, surface: &SurfacePoint) -> f64 {
        if mode == Mode::Stick {
            return 0.0;
        }
        let centripetal = surface.slope * surface.curvature * velocity_x * velocity_x;
        ((self.tangential - self.friction(model, mode, velocity_x)) / model.mass - centripetal / self.q) / self.q
    }
}

impl Forces {
    /// The contact forces on mass `i`, which is in contact with `surface` and has the velocity ẋ.
    #[inline]
    pub fn contact(&self, model: &Model, i: usize, velocity_x: f64, surface: &SurfacePoint) -> ContactForces {
        ContactForces::new(model, (self.on_mass_x[i], self.on_mass_z[i]), velocity_x, surface)
    }
}

/// The law A τ_f(v) of one mass in contact: its plateau A τ_f(v_c) and its excess over that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateShear {
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

impl RateShear {
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
}

/// The excess of the friction in slip over that at rest, over the speed in the direction of slip. It is odd, so that a mass
/// that turns round is braked before its mode changes.
pub trait FrictionCurve {
    /// The speed up to which there is no excess, m/s.
    fn creep_speed(&self) -> f64;

    /// Bounds of the excess, N.
    fn bounds(&self) -> (f64, f64);

    /// Speeds that divide the curve into parts in which it bends one way, m/s.
    fn marks(&self) -> [f64; 2];

    /// The excess, N, and its derivative by the speed, N s/m, at the `speed` in the direction of slip, m/s.
    fn with_slope(&self, speed: f64) -> (f64, f64);

    /// The excess, N.
    fn excess(&self, speed: f64) -> f64 {
        self.with_slope(speed).0
    }

    /// A correction `by` (m/s) of Newton's method at `speed`, taken along the curve and not along its tangent: the speed
    /// v, m/s, at which `weight` (v - `speed`) and the change of the excess have the value that the tangent predicts.
    ///
    /// The curve is nearly a logarithm: at creep speeds its tangent is steep and valid over a short range only, and
    /// corrections along it would alternate between both ends of the decades.
    fn along_curve(&self, speed: f64, by: f64, weight: f64) -> f64 {
        let linear = speed + by;
        let constant = linear.abs() <= self.creep_speed() && speed.abs() <= self.creep_speed();
        if constant || by.abs() <= STRAIGHT * speed.abs() || weight.is_nan() || weight <= 0.0 {
            return linear;
        }
        let (here, slope) = self.with_slope(speed);
        self.balance(speed, here + (weight + slope) * by, weight)
    }

    /// The speed v, m/s, at which `weight` (v - `from`) and the excess add up to `force` (N). Where friction falls faster than
    /// the weight there may be three: then it is the first one from `from`, as the motion reaches it.
    fn balance(&self, from: f64, force: f64, weight: f64) -> f64 {
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
}

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

impl FrictionCurve for RateShear {
    fn creep_speed(&self) -> f64 {
        self.creep_speed
    }

    fn bounds(&self) -> (f64, f64) {
        (-self.plateau, self.largest - self.plateau)
    }

    /// The largest strength and the steepest fall.
    fn marks(&self) -> [f64; 2] {
        [1.0, self.fastest_fall].map(|share| share / self.per_reference)
    }

    fn with_slope(&self, speed: f64) -> (f64, f64) {
        let size = speed.abs();
        if size <= self.creep_speed {
            return (0.0, 0.0);
        }
        let (force, slope) = self.whole(size);
        ((force - self.plateau) * 1.0_f64.copysign(speed), slope * force / size)
    }
}

/// The friction of one contact under a normal force that is held.
#[derive(Clone, Copy, Debug)]
pub struct SlipCurve<'a> {
    model: &'a Model,
    /// F_N, N.
    normal: f64,
}

impl Model {
    /// The curve of a contact under the normal force F_N, N; `None` where friction does not depend on the speed.
    #[inline]
    pub fn slip_curve(&self, normal: f64) -> Option<SlipCurve<'_>> {
        self.friction_depends_on_speed().then_some(SlipCurve { model: self, normal })
    }

    /// Whether friction depends on the speed of slip.
    pub fn friction_depends_on_speed(&self) -> bool {
        self.rate_shear.is_some() || self.real_area.as_ref().is_some_and(RealArea::depends_on_speed)
    }

    /// Whether friction is linear in the normal force and does not depend on the speed.
    pub fn friction_is_linear(&self) -> bool {
        self.rate_shear.is_none() && self.real_area.is_none()
    }

    /// The shear force at rest under F_N (N), A_r(F_N, v_c) (τ_0 + τ_f(v_c)), N.
    #[inline]
    fn shear_at_rest(&self, normal: f64) -> f64 {
        match &self.real_area {
            None => self.shear_force,
            Some(area) => area.share_at_rest(normal) * self.shear_force,
        }
    }
}

impl SlipCurve<'_> {
    /// The derivative of the whole shear force by F_N, 1, at the `speed` of slip, m/s: 0 where it acts on the whole area.
    pub fn by_normal(&self, speed: f64) -> f64 {
        let strength = |law: &RateShear| law.with_slope(speed.abs()).0;
        let force = self.model.shear_force + self.model.rate_shear.as_ref().map_or(0.0, strength);
        self.model.real_area.as_ref().map_or(0.0, |area| area.share(self.normal, speed).by_normal * force)
    }

    /// The steepest fall of friction up to the `speed` of slip, m/s, by the real area that shrinks: ∂T/∂v, N s/m, 0 where
    /// friction does not fall.
    pub fn steepest_fall(&self, speed: f64) -> f64 {
        let falls = self.model.real_area.iter().flat_map(RealArea::speeds).take_while(|&at| at <= speed);
        falls.map(|at| self.with_slope(at).1).fold(0.0, f64::min)
    }
}

impl FrictionCurve for SlipCurve<'_> {
    fn creep_speed(&self) -> f64 {
        match (&self.model.rate_shear, &self.model.real_area) {
            (Some(law), _) => law.creep_speed,
            (None, Some(area)) => area.creep_speed(),
            (None, None) => 0.0,
        }
    }

    fn bounds(&self) -> (f64, f64) {
        let (least, most) = self.model.rate_shear.as_ref().map_or((0.0, 0.0), RateShear::bounds);
        match &self.model.real_area {
            None => (least, most),
            Some(area) => {
                let (share, at_rest) = (area.at_rest(self.normal).value, self.model.shear_force);
                (-share * at_rest, share * most)
            }
        }
    }

    fn marks(&self) -> [f64; 2] {
        self.model.rate_shear.as_ref().map_or([self.creep_speed(); 2], RateShear::marks)
    }

    fn with_slope(&self, speed: f64) -> (f64, f64) {
        let of_rate = self.model.rate_shear.as_ref().map_or((0.0, 0.0), |law| law.with_slope(speed));
        let Some(area) = &self.model.real_area else { return of_rate };
        let sign = 1.0_f64.copysign(speed);
        let (share, at_rest) = (area.share(self.normal, speed), area.at_rest(self.normal).value);
        let force = self.model.shear_force + sign * of_rate.0;
        let by_size = share.by_speed * sign * force + share.value * of_rate.1;
        (sign * (share.value * force - at_rest * self.model.shear_force), by_size)
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

    fn laws() -> impl Iterator<Item = RateShear> {
        let sharp = scene::RateShear { sharpness: 4.0, creep_speed: Some(1.0e-5), ..LAW };
        let level = scene::RateShear { sharpness: 0.0, ..LAW };
        [LAW, sharp, level].into_iter().filter_map(|law| RateShear::new(&law))
    }

    /// Speeds over eleven decades, from the creep speed of [`LAW`] on.
    fn speeds() -> impl Iterator<Item = f64> {
        (1..=110).map(|i| 6.0e-9 * 10.0_f64.powf(0.1 * f64::from(i)))
    }

    #[test]
    fn strength_is_what_its_formula_says() {
        for law in [LAW, scene::RateShear { sharpness: 4.0, ..LAW }] {
            let found = RateShear::new(&law).unwrap_or_else(|| panic!("no law"));
            let expected = |speed: f64| {
                let decades = (speed / law.reference_speed).log10();
                FORCE * (-law.sharpness * decades * decades).exp()
            };
            // Roundings of an exponent of some hundreds.
            assert!((found.plateau() - expected(6.0e-9)).abs() < 1e-12 * FORCE);
            for speed in speeds() {
                let whole = found.plateau() + found.excess(speed);
                assert!((whole - expected(speed)).abs() < 1e-12 * FORCE, "{speed:e}: {whole:e}");
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
        for law in laws() {
            for speed in speeds().filter(|&speed| speed > 1.01 * law.creep_speed) {
                let h = 1e-4 * speed;
                let quotient = (law.excess(speed + h) - law.excess(speed - h)) / (2.0 * h);
                let (force, slope) = law.with_slope(speed);
                assert_eq!(force, law.excess(speed));
                // The third derivative times h², and roundings over h.
                let scale = law.largest / speed;
                assert!((slope - quotient).abs() < 1e-6 * scale, "{speed:e}: {slope:e} {quotient:e}");
            }
        }
    }

    /// From any speed to any other, in the same direction and in the other.
    #[test]
    fn a_correction_ends_on_the_curve() {
        for law in laws() {
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
