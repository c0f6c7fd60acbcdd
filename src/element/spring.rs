//! The spring and slider of an element, in the plane or along a line of it: its passage through a segment of a motion,
//! in closed form.
//!
//! G is the force of the spring on the ground, K its stiffness, L the limit, Δ the displacement of the face along the
//! plane, e = G/K. While the stiffness grows, contacts that are made carry no force yet; while it falls, contacts that
//! are lost take their share along. In slip G follows the motion: with α the angle from the displacement to G,
//! tan(α/2) falls as e^-λ with λ the displacement over the radius L/K.

use crate::math::Number;

/// Keeps quotients of numbers that vanish together finite.
const TINY: f64 = 1e-300;
/// Share of a stiffness by which it may change and stay the same.
const ROUNDING: f64 = 1e-9;
/// A displacement below this share of L/K counts as none.
const STANDING: f64 = 1e-12;
/// Below this λ the series of [`lag`] serves.
const SHORT: f64 = 1e-2;
/// Beyond this λ nothing is left of e^-λ.
const LONG: f64 = 300.0;

/// What an element's spring is held by; both 0 without contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpringLaw<T> {
    /// The stiffness K, N/m.
    pub(crate) stiffness: T,
    /// The limit L, N.
    pub(crate) limit: T,
}

/// A segment of a motion as an element sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment<T> {
    /// The law where it begins.
    pub(crate) begin: SpringLaw<T>,
    /// The law where it ends.
    pub(crate) end: SpringLaw<T>,
    /// Δ, the displacement of the face along the plane, m.
    pub(crate) displacement: [T; 2],
    /// The tangent of half the angle that the velocity turns by.
    pub(crate) half_turn: T,
}

/// What a segment makes of a spring.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Advanced<T> {
    /// G at its end, N.
    pub(crate) force: [T; 2],
    /// Whether it slips there.
    pub(crate) slips: bool,
    /// Energy lost by slip, J.
    pub(crate) slip: T,
    /// Energy lost with contacts that were released, J.
    pub(crate) release: f64,
}

/// Whether a stiffness is unchanged up to rounding. There the laws of a growing and of a falling stiffness agree in
/// value but not in slope; the mean of the slopes is taken, as a central difference finds it.
#[inline(always)]
fn is_level<T: Number>(before: T, after: T) -> bool {
    let (before, after) = (before.value(), after.value());
    (after - before).abs() <= ROUNDING * before && before > 0.0
}

#[inline(always)]
fn falls<T: Number>(before: T, after: T) -> bool {
    after.value() < before.value() * (1.0 - ROUNDING)
}

/// The law has jumped: G falls with K where K falls, then is cut to L. Returns G and the energy that it took, J.
#[inline(always)]
pub(crate) fn apply_jump<T: Number>(force: [T; 2], stiffness: T, law: &SpringLaw<T>) -> ([T; 2], f64) {
    let square = |g: [T; 2]| g[0] * g[0] + g[1] * g[1];
    let (k, limit) = (law.stiffness, law.limit);
    // G²/K, twice the energy of the spring, before and after.
    let before = square(force).value() / (stiffness.value() + TINY);
    let one = T::constant(1.0);
    // e stays where K falls, G where it grows.
    let share = k / (stiffness + T::constant(TINY));
    let kept = share.or(falls(stiffness, k), (share + one).times(0.5).or(is_level(stiffness, k), one));
    let force = force.map(|g| g * kept);
    // |G| ≤ L.
    let size = square(force);
    let cut = limit / (size + T::constant(TINY)).sqrt();
    let cut = cut.or(size.value() > limit.value() * limit.value(), T::constant(1.0));
    let force = force.map(|g| g * cut);
    let after = square(force).value() / (k.value() + TINY);
    let lost = 0.5 * (before - after);
    (force, if lost > 0.0 { lost } else { 0.0 })
}

/// The force on the ground of a spring with force `force` (N) and a damper beside it, which opposes the face's velocity v
/// (m/s): G + τ K v as far as the contact holds it, |T| ≤ L. The slider feels the spring alone, so that T is G where a
/// straight slip goes on. As the limit is a projection onto a disc, T v is never below G v: the damper only takes energy.
#[inline(always)]
pub(crate) fn damped<T: Number>(force: [T; 2], law: &SpringLaw<T>, velocity: [T; 2], damping: f64) -> [T; 2] {
    let viscous = law.stiffness.times(damping);
    let total = [force[0] + velocity[0] * viscous, force[1] + velocity[1] * viscous];
    let square = total[0] * total[0] + total[1] * total[1];
    let share = law.limit / (square + T::constant(TINY)).sqrt();
    let share = share.or(square.value() > law.limit.value() * law.limit.value(), T::constant(1.0));
    total.map(|t| t * share)
}

/// What the damper takes in a segment that begins with the spring's force `force` (N) and lasts `duration` (s), J, at the
/// mean stiffness and limit. Exact while the spring sticks: with z = e + τ v and the potential φ of the limited force, the
/// work of T is K (φ(z₁) - φ(z₀)), that of G K (|e₁|² - |e₀|²)/2. In slip nothing counts: a turn of its direction is left
/// out.
#[inline(always)]
pub(crate) fn damper_loss(force: [f64; 2], segment: &Segment<f64>, duration: f64, damping: f64) -> f64 {
    let middle = |f: fn(&SpringLaw<f64>) -> f64| 0.5 * (f(&segment.begin) + f(&segment.end));
    let (k, limit) = (middle(|law| law.stiffness), middle(|law| law.limit));
    let (d, radius) = (segment.displacement, limit / (k + TINY));
    let e = force.map(|g| g / (k + TINY));
    let stick = fraction_of_stick(e, d, radius, 0.0);
    let potential = |z: [f64; 2]| {
        let size = z[0].hypot(z[1]);
        if size > radius { radius * (size - 0.5 * radius) } else { 0.5 * size * size }
    };
    let moved = [e[0] + d[0] * stick, e[1] + d[1] * stick];
    let ahead = |e: [f64; 2]| [0, 1].map(|axis| e[axis] + damping * d[axis] / duration);
    let by_all = potential(ahead(moved)) - potential(ahead(e));
    let by_spring = 0.5 * (moved[0] * moved[0] + moved[1] * moved[1] - e[0] * e[0] - e[1] * e[1]);
    (k * (by_all - by_spring)).max(0.0)
}

/// The stiffnesses K with which a spring is elongated by its force, where a segment begins and where it ends.
#[derive(Clone, Copy)]
struct AppliedStiffness<T> {
    begin: T,
    end: T,
    /// The mean of both contacts' stiffnesses.
    middle: T,
    falls: bool,
}

impl<T: Number> AppliedStiffness<T> {
    /// That of the contact where it falls, the mean of both ends where it grows.
    #[inline(always)]
    fn new(begin: T, end: T) -> Self {
        let (falls, level) = (falls(begin, end), is_level(begin, end));
        let middle = (begin + end).times(0.5);
        let growing = |k: T| (k + middle).times(0.5).or(level, middle);
        Self { begin: begin.or(falls, growing(begin)), end: end.or(falls, growing(end)), middle, falls }
    }
}

/// The radius L/K, up to which a spring may be elongated, over a segment: it changes straight.
#[derive(Clone, Copy)]
struct Radius<T> {
    start: T,
    growth: T,
    end: T,
}

/// The part of a segment in which a spring slips, after a stick.
#[derive(Clone, Copy)]
struct Slip<T> {
    /// The fraction of the displacement after which it begins.
    begins: T,
    /// e where the segment ends, m.
    elongation: [T; 2],
    /// How far the face slides along G, ∫ s dt, m.
    distance: T,
}

/// Takes a spring with |G| ≤ L through a segment (docs/patch.md, "An element").
#[inline(always)]
pub(crate) fn advance<T: Number>(force: [T; 2], segment: &Segment<T>) -> Advanced<T> {
    let (tiny, one) = (T::constant(TINY), T::constant(1.0));
    let (begin, end) = (segment.begin, segment.end);
    let applied = AppliedStiffness::new(begin.stiffness, end.stiffness);
    let (k_a, k_b) = (applied.begin, applied.end);
    // e = G/K where the segment begins, and the radii L/K at both ends.
    let per = one / (k_a + tiny);
    let [dx, dy] = segment.displacement;
    let e = [force[0] * per, force[1] * per];
    let start = begin.limit * per;
    let last = (end.limit / (k_b + tiny)).or(k_b.value() > 0.0, start);
    let radius = Radius { start, growth: last - start, end: last };
    // If it sticks dG/dt = K v + min(dK/dt, 0)/K G: e grows by Δ, and G ends at G K_b/K_a + K_b Δ. The ratio is exactly 1
    // where the stiffness stays: a spring that stands is left alone.
    let share_kept = k_b / (k_a + tiny);
    let stuck = [force[0] * share_kept + k_b * dx, force[1] * share_kept + k_b * dy];
    let trial = [e[0] + dx, e[1] + dy];
    // It slips if it would be elongated beyond the radius.
    let slips = (trial[0] * trial[0] + trial[1] * trial[1]).value() > (last * last).value();
    let slip = slip(e, segment, &radius);
    let [x, y] = [slip.elongation[0].or(slips, trial[0]), slip.elongation[1].or(slips, trial[1])];
    // Without stiffness there is none, nor a slope: that of the elongation may be no number where limits are 0, too.
    let force = [(k_b * x).or(slips, stuck[0]), (k_b * y).or(slips, stuck[1])];
    let force = force.map(|force| force.or(k_b.value() > 0.0, T::constant(0.0)));

    // ∫ L s dt by the mean of the limits where the slip begins and where it ends.
    let limit = begin.limit + (end.limit - begin.limit) * slip.begins;
    let by_slip = (limit + end.limit).times(0.5) * slip.distance;
    let by_slip = by_slip.or(slips && by_slip.value() > 0.0, T::constant(0.0));
    let square = |e: [T; 2]| (e[0] * e[0] + e[1] * e[1]).value();
    Advanced { force, slips, slip: by_slip, release: released(&applied, segment, square(e), square([x, y])) }
}

/// ∫ ½ (|G|/K)² |dK| over a segment, J, from the squares of the applied elongations at its ends.
#[inline(always)]
fn released<T: Number>(applied: &AppliedStiffness<T>, segment: &Segment<T>, before: f64, after: f64) -> f64 {
    let [k_0, k_1] = [segment.begin.stiffness.value(), segment.end.stiffness.value()];
    let middle = applied.middle.value();
    // Where K falls by the trapezoidal rule of e². Where it grows e is G over the mean K_m: K_m/K times e² at each end gives
    // for a G that stays ½ G² (1/K_0 - 1/K_1), the integral. Finite where a stiffness begins at 0, times a force that does
    // too.
    let share = |k: f64| if applied.falls { 1.0 } else { (middle / (k + TINY)).min(f64::MAX) };
    let (share_0, share_1) = (share(k_0), share(k_1));
    0.25 * (k_1 - k_0).abs() * (before * share_0 + after * share_1)
}

/// A spring elongated by `e` (m) that sticks over a fraction of the displacement and slips over the rest.
#[inline(always)]
fn slip<T: Number>(e: [T; 2], segment: &Segment<T>, radius: &Radius<T>) -> Slip<T> {
    let (tiny, one) = (T::constant(TINY), T::constant(1.0));
    let [dx, dy] = segment.displacement;
    let square = dx * dx + dy * dy;
    // |e| reaches the radius after the fraction t; from there on λ is the displacement over the mean radius.
    let t = fraction_of_stick(e, [dx, dy], radius.start, radius.growth);
    let rest = one - t;
    let distance = square.sqrt() + tiny;
    let begins_at = radius.start + radius.growth * t;
    let mean = (begins_at + radius.end).times(0.5) + tiny;
    let travel = distance * rest;
    let lambda = travel / mean;
    let decay = (-lambda.smaller(T::constant(LONG))).exp();

    // The direction of the displacement, turned as the velocity turns meanwhile.
    let share = t.times(0.5) + rest * lag(lambda, decay);
    // A displacement that is nothing beside the radius has no direction: G is cut where it points.
    let least = STANDING * radius.end.value();
    let moves = square.value() > least * least;
    let per_distance = (one / distance).or(moves, T::constant(0.0));
    let [ux, uy] = turned([dx * per_distance, dy * per_distance], segment.half_turn * share);

    // α, from that direction to G where the slip begins.
    let (nx, ny) = (e[0] + dx * t, e[1] + dy * t);
    let size = one / (nx * nx + ny * ny + tiny).sqrt();
    let (nx, ny) = (nx * size, ny * size);
    let (cos, sin) = (nx * ux + ny * uy, ux * ny - uy * nx);
    // tan(α/2) falls as e^-λ: with w = tan²(α/2), whole/2 = (1 + w e^-2λ)/(1 + w), and cos α and sin α at the end follow.
    let decay_2 = decay * decay;
    let whole = (one + cos) + (one - cos) * decay_2 + tiny;
    let per_whole = one / whole;
    let (cos_1, sin_1) = (((one + cos) - (one - cos) * decay_2) * per_whole, (sin * decay).times(2.0) * per_whole);
    let elongation = [
        (radius.end * (cos_1 * ux - sin_1 * uy)).or(moves, radius.end * nx),
        (radius.end * (cos_1 * uy + sin_1 * ux)).or(moves, radius.end * ny),
    ];
    // ∫ cos α over the displacement, mean (λ + ln((1 + w e^-2λ)/(1 + w))), less what the elongation grows by.
    let along = travel + mean * whole.times(0.5).ln() - (radius.end - begins_at);
    Slip { begins: t, elongation, distance: along }
}

/// The fraction of a displacement after which |e| reaches the radius, which grows straight from `radius` by `growth`.
#[inline(always)]
fn fraction_of_stick<T: Number>(e: [T; 2], d: [T; 2], radius: T, growth: T) -> T {
    let (tiny, zero, one) = (T::constant(TINY), T::constant(0.0), T::constant(1.0));
    // |e + d t|² = (radius + growth t)²: a t² + 2 b t + c = 0, of which c ≤ 0.
    let a = d[0] * d[0] + d[1] * d[1] - growth * growth;
    let b = e[0] * d[0] + e[1] * d[1] - radius * growth;
    let c = (e[0] * e[0] + e[1] * e[1] - radius * radius).smaller(zero);
    // The root at which |e| comes up to the radius, without cancellation whatever the sign of b.
    let root = (b * b - a * c).larger(zero).sqrt();
    let outwards = b.value() > 0.0;
    let fraction = (-c).or(outwards, root - b) / ((b + root).or(outwards, a) + tiny);
    fraction.larger(zero).smaller(one)
}

/// The share of a turn during slip that the direction lags behind by: 1/(1 - e^-λ) - 1/λ - ½.
#[inline(always)]
fn lag<T: Number>(lambda: T, decay: T) -> T {
    let one = T::constant(1.0);
    let long = lambda.larger(T::constant(SHORT));
    let decay = decay.smaller(T::constant(1.0 - 0.5 * SHORT));
    // For short λ the first term of the series, λ/12.
    let exact = one / (one - decay) - one / long - T::constant(0.5);
    exact.or(lambda.value() > SHORT, lambda.times(1.0 / 12.0))
}

/// A direction turned by the angle whose half has this tangent.
#[inline(always)]
fn turned<T: Number>(direction: [T; 2], tangent: T) -> [T; 2] {
    let one = T::constant(1.0);
    let square = tangent * tangent;
    let per = one / (one + square);
    let (cos, sin) = ((one - square) * per, tangent.times(2.0) * per);
    let [x, y] = direction;
    [cos * x - sin * y, sin * x + cos * y]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(stiffness: f64, limit: f64) -> SpringLaw<f64> {
        SpringLaw { stiffness, limit }
    }

    fn advanced(force: [f64; 2], begin: SpringLaw<f64>, end: SpringLaw<f64>, displacement: [f64; 2]) -> Advanced<f64> {
        advance(force, &Segment { begin, end, displacement, half_turn: 0.0 })
    }

    /// At its limit, displaced by nothing or by next to nothing, a spring stays; where the limit falls it is cut.
    #[test]
    fn a_spring_at_its_limit_that_stands_keeps_its_direction() {
        for tiny in [0.0, 1e-320, 1e-200, 1e-30] {
            for over in [1.0 - 1e-15, 1.0, 1.0 + 1e-15] {
                let [x, y] = advanced([3.0 * over, 4.0 * over], law(1e6, 5.0), law(1e6, 5.0), [tiny, -tiny]).force;
                assert!((x - 3.0).abs() < 1e-12 && (y - 4.0).abs() < 1e-12, "{tiny:e} {over}: {x} {y}");
            }
            let cut = advanced([3.0, 4.0], law(1e6, 5.0), law(1e6, 2.5), [tiny, 0.0]);
            assert!((cut.force[0] - 1.5).abs() < 1e-12 && cut.slips && (cut.slip - 3.75 * 2.5e-6).abs() < 1e-12);
        }
    }

    /// ∫ (T - G) v dt by the midpoint rule: from rest into the limit, oblique, back from the limit, and in slip.
    #[test]
    fn dampers_take_the_work_of_what_they_add() {
        let (law, damping, duration, n) = (law(1e6, 5.0), 2e-3, 1e-3, 100_000);
        for (start, d) in [([0.0, 0.0], [8e-6, 0.0]), ([1.0, 4.0], [1.5e-6, 5e-6]), ([-5.0, 0.0], [7e-6, 0.0])] {
            let segment = |from: f64, to: f64| Segment {
                begin: law,
                end: law,
                displacement: d.map(|d| d * (to - from)),
                half_turn: 0.0,
            };
            let velocity = d.map(|d| d / duration);
            let (mut loss, mut g) = (0.0, start);
            for i in 0..n {
                let middle = advance(g, &segment(0.0, 0.5 / f64::from(n))).force;
                let total = damped(middle, &law, velocity, damping);
                let of_damper = (total[0] - middle[0]) * d[0] + (total[1] - middle[1]) * d[1];
                g = advance(g, &segment(f64::from(i) / f64::from(n), f64::from(i + 1) / f64::from(n))).force;
                loss += of_damper / f64::from(n);
            }
            let found = damper_loss(start, &segment(0.0, 1.0), duration, damping);
            // The midpoint rule, and the turn of an oblique slip, which is left out.
            assert!((found - loss).abs() < 2e-2 * loss && found > 0.0, "{start:?}: {found:e} {loss:e}");
        }
        assert!(
            damper_loss(
                [5.0, 0.0],
                &Segment { begin: law, end: law, displacement: [1e-6, 0.0], half_turn: 0.0 },
                1.0,
                1.0
            ) == 0.0
        );
    }

    /// In many segments, by steps of the differential equations.
    #[test]
    fn slip_turns_as_the_equations_say() {
        let (k, limit, n) = (1e6, 5.0, 200_000);
        let (mut g, d) = ([3.0_f64, 4.0_f64], [2e-5_f64, -1e-5_f64]);
        let found = advanced(g, law(k, limit), law(k, limit), d).force;
        for _ in 0..n {
            g = [0, 1].map(|i| g[i] + k * d[i] / f64::from(n));
            let size = g[0].hypot(g[1]);
            g = g.map(|g| g * (limit / size).min(1.0));
        }
        // Steps of 1e-10 m against L/K = 5e-6 m.
        assert!((found[0] - g[0]).abs() < 1e-4 && (found[1] - g[1]).abs() < 1e-4, "{found:?} {g:?}");
    }

    /// Without contact nothing is left, and nothing is no number.
    #[test]
    fn what_lifts_loses_all() {
        let lifted = advanced([3.0, 4.0], law(1e6, 5.0), law(0.0, 0.0), [1e-6, 0.0]);
        assert!(lifted.force == [0.0; 2] && lifted.release > 0.0 && lifted.slip.is_finite());
        // However stiff what touches is.
        let touches = advanced([0.0; 2], law(0.0, 0.0), law(1e20, 1e15), [1e-6, 0.0]);
        assert!(touches.force[0] > 0.0 && touches.release.is_finite());
        let free = advanced([0.0; 2], law(0.0, 0.0), law(0.0, 0.0), [1e30, 0.0]);
        assert!(free.force == [0.0; 2] && free.release == 0.0 && free.slip == 0.0);
    }
}
