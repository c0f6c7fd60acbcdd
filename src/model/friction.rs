//! The rate-dependent shear strength of rubber: τ_f(v) = τ_f0 exp(-c [log10(v/v_0)]²) above a creep speed v_c, below
//! which it is held (B. Lorenz et al., J. Phys.: Condens. Matter 25, 2013).
//!
//! What is held, A τ_f(v_c), acts on a contact at rest as well: it is a part of [`Model::shear_force`](super::Model).
//! The rest is what a contact that slips has beyond that.

use std::f64::consts::LN_10;

use crate::math::bracketed_root;
use crate::scene;

/// What A τ_f(v) is beyond A τ_f(v_c), of one mass in contact.
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

/// How near to the law's own curve a correction is taken, as a difference of ln v.
const ON_THE_CURVE: f64 = 1e-3;

/// Share of the speed up to which the curve's tangent serves for it.
const STRAIGHT: f64 = 0.1;

impl RateShear {
    /// The law of a scene; `None` where it has no force.
    pub fn new(law: &scene::RateShear) -> Option<Self> {
        let largest = law.force.unwrap_or(0.0);
        let per_reference = 1.0 / law.reference_speed;
        let (sharpness, creep_speed) = (law.sharpness / (LN_10 * LN_10), law.creep_speed());
        let fastest_fall = fastest_fall(sharpness);
        let unheld = Self { largest, plateau: 0.0, per_reference, sharpness, creep_speed, fastest_fall };
        (largest > 0.0).then(|| Self { plateau: unheld.whole(creep_speed).0, ..unheld })
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

    /// A τ_f(v) - A τ_f(v_c), N, at the `speed` in the direction of slip, m/s: 0 at creep and for what goes backwards.
    pub fn excess(&self, speed: f64) -> f64 {
        if speed <= self.creep_speed { 0.0 } else { self.whole(speed).0 - self.plateau }
    }

    /// The same, and its derivative A τ_f'(v), N s/m.
    pub fn with_slope(&self, speed: f64) -> (f64, f64) {
        if speed <= self.creep_speed {
            return (0.0, 0.0);
        }
        let (force, slope) = self.whole(speed);
        (force - self.plateau, slope * force / speed)
    }

    /// The speed at which `weight` (v - `speed`) + A τ_f(v) - A τ_f(`speed`) is the same as on the curve's tangent at
    /// `speed` the change `by` makes it, m/s: a correction of Newton's, taken along the curve.
    ///
    /// The curve is all but a logarithm: at creep its tangent is as steep as it is short, and corrections along it go
    /// from one end of the decades to the other and back.
    pub fn along_curve(&self, speed: f64, by: f64, weight: f64) -> f64 {
        let linear = speed + by;
        let stays = linear <= self.creep_speed && speed <= self.creep_speed;
        if stays || by.abs() <= STRAIGHT * speed || weight.is_nan() || weight <= 0.0 {
            return linear;
        }
        let (here, slope) = self.with_slope(speed);
        self.balance(speed, here + (weight + slope) * by, weight)
    }

    /// The speed v, m/s, at which `weight` (v - `from`) + A τ_f(v) - A τ_f(v_c) is `force` (N). Where friction falls
    /// faster than the weight there may be three: it is the one that comes first from `from`, as motion comes to it.
    pub fn balance(&self, from: f64, force: f64, weight: f64) -> f64 {
        let free = from + force / weight;
        if free <= self.creep_speed {
            return free;
        }
        // A τ_f(v) - A τ_f(v_c) lies between these.
        let (least, most) = (-self.plateau, self.largest - self.plateau);
        let [low, high] = [most, least].map(|beyond| (free - beyond / weight).max(self.creep_speed));
        let excess = |v: f64| (v - from) * weight + self.excess(v) - force;
        if excess(low) >= 0.0 || !high.is_finite() {
            return low;
        }
        let (low, high) = self.first(excess, from.clamp(low, high), (low, high));
        let speed = |y: f64| self.creep_speed * y.exp();
        let bracket = [low, high].map(|v| (v / self.creep_speed).ln());
        speed(bracketed_root(|y| excess(speed(y)), (bracket[0], bracket[1]), ON_THE_CURVE))
    }

    /// The part of the bracket, m/s, of the first zero of `excess` from the speed `from`. Between the largest strength
    /// and where it falls fastest, and on both sides of these, there is one zero at most where the ends differ in sign.
    fn first(&self, excess: impl Fn(f64) -> f64, from: f64, (mut low, mut high): (f64, f64)) -> (f64, f64) {
        let marks = [1.0, self.fastest_fall].map(|share| share / self.per_reference);
        let faster = excess(from) < 0.0;
        *(if faster { &mut low } else { &mut high }) = from;
        for mark in if faster { marks } else { [marks[1], marks[0]] } {
            if !(low < mark && mark < high) {
                continue;
            }
            let above = excess(mark) >= 0.0;
            *(if above { &mut high } else { &mut low }) = mark;
            if above == faster {
                break;
            }
        }
        (low, high)
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
            for speed in [6.0e-9, 1.0e-9, 0.0, -1.0] {
                assert_eq!((found.excess(speed), found.with_slope(speed)), (0.0, (0.0, 0.0)));
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

    /// From any speed to any other, back to rest and beyond it.
    #[test]
    fn a_correction_ends_on_the_curve() {
        for law in laws() {
            for weight in [1e-3, 1.0, 1e3] {
                for (from, to) in speeds().flat_map(|from| speeds().map(move |to| (from, to))) {
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
