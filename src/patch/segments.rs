//! An element whose pressure changes much in a substep, or which a tread drags to and fro: it is cut where the element
//! touches or lifts, where it is at the least pressure of the table and where it is slowest, and each piece between two
//! cuts is divided into segments.

use crate::element::{Advanced, ElementLaw, ResampledLaw, Segment, SpringLaw, advance, apply_jump};
use crate::math::Number;

/// Segments of a piece, at least.
const MIN_SEGMENTS: f64 = 4.0;
/// Change of ln p over a segment, at most.
const MAX_CHANGE: f64 = 0.125;
/// Keeps quotients of numbers that vanish together finite.
const TINY: f64 = 1e-300;

/// An element at the beginning or the end of a substep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Endpoint<T> {
    /// How far it is below the plane z = 0, m.
    pub(super) approach: T,
    /// Along the plane, m/s.
    pub(super) velocity: [T; 2],
    /// Its area, m².
    pub(super) area: f64,
    /// How much warmer than the temperature given its law is, K.
    pub(super) rise: T,
}

/// An element between two endpoints, after a fraction of the substep.
struct Between<T> {
    fraction: T,
    velocity: [T; 2],
    pressure: f64,
    law: SpringLaw<T>,
}

/// Takes the spring of an element from one endpoint to the other, displaced by `displacement` (m); also returns the number
/// of segments.
pub(super) fn advance_in_segments<T: Number>(
    law: &mut ResampledLaw,
    force: [T; 2],
    (begin, end): (&Endpoint<T>, &Endpoint<T>),
    displacement: [T; 2],
) -> (Advanced<T>, u32) {
    let cuts = cuts(law, begin, end);
    let mut count = 0;
    let mut here = between(law, begin, end, T::constant(0.0));
    let mut advanced = Advanced { force, slips: false, slip: T::constant(0.0), release: 0.0 };
    for cut in cuts {
        if cut.value() <= here.fraction.value() {
            continue;
        }
        // A piece up to the next cut.
        let (start, there) = (here.fraction, between(law, begin, end, cut));
        let segments = segment_count(here.pressure, there.pressure);
        count += segments as u32;
        for segment in 1..=segments as u32 {
            let fraction = start + (cut - start).times(f64::from(segment) / segments);
            let next = between(law, begin, end, fraction);
            let length = fraction - here.fraction;
            // The spring follows the law, then the motion.
            let (force, lost) = apply_jump(advanced.force, here.law.stiffness, &here.law);
            let motion = Segment {
                begin: here.law,
                end: next.law,
                displacement: displacement.map(|d| d * length),
                half_turn: half_turn(here.velocity, next.velocity),
            };
            let further = advance(force, &motion);
            advanced = Advanced {
                slip: advanced.slip + further.slip,
                release: advanced.release + further.release + lost,
                ..further
            };
            here = next;
        }
    }
    (advanced, count)
}

/// The fractions of the substep at which the element touches or lifts, at which it is at the least pressure of the table
/// and at which it is slowest, in their order, and 1.
fn cuts<T: Number>(law: &mut ResampledLaw, begin: &Endpoint<T>, end: &Endpoint<T>) -> [T; 4] {
    let mut beginning = |end: &Endpoint<T>| {
        let place = law.place(size(end.velocity), end.rise);
        let (touch, least) = law.beginning(&place);
        (end.approach - touch, end.approach - least)
    };
    let (before, after) = (beginning(begin), beginning(end));
    let crossing = |from: T, to: T| {
        let crosses = from.value() * to.value() < 0.0;
        (from / (from - to)).or(crosses, T::constant(0.0))
    };
    let (touch, least) = (crossing(before.0, after.0), crossing(before.1, after.1));
    let [v_x, v_y] = begin.velocity;
    let [dv_x, dv_y] = [end.velocity[0] - v_x, end.velocity[1] - v_y];
    let slowest = -(v_x * dv_x + v_y * dv_y) / (dv_x * dv_x + dv_y * dv_y + T::constant(TINY));
    let slowest = slowest.or(reverses(begin.velocity, end.velocity), T::constant(0.0));
    let mut cuts = [touch, least, slowest, T::constant(1.0)];
    cuts.sort_unstable_by(|a, b| a.value().total_cmp(&b.value()));
    cuts
}

/// Whether a velocity turns by more than a right angle: it has been at rest, or nearly, where friction may be another.
#[inline(always)]
pub(super) fn reverses<T: Number>(from: [T; 2], to: [T; 2]) -> bool {
    (from[0] * to[0] + from[1] * to[1]).value() < 0.0
}

/// The number of segments of a piece with these pressures at its ends.
fn segment_count(before: f64, after: f64) -> f64 {
    let change = if before > 0.0 && after > 0.0 { (after / before).ln().abs() } else { 0.0 };
    (change / MAX_CHANGE).ceil().clamp(MIN_SEGMENTS, 1e3)
}

fn between<T: Number>(law: &mut ResampledLaw, begin: &Endpoint<T>, end: &Endpoint<T>, fraction: T) -> Between<T> {
    let straight = |from: T, to: T| from + (to - from) * fraction;
    let velocity = [0, 1].map(|i| straight(begin.velocity[i], end.velocity[i]));
    let area = straight(T::constant(begin.area), T::constant(end.area));
    let place = law.place(size(velocity), straight(begin.rise, end.rise));
    let ElementLaw { pressure, friction, stiffness } = law.at_place(&place, straight(begin.approach, end.approach));
    let law = SpringLaw { stiffness: area * stiffness, limit: area * pressure * friction };
    Between { fraction, velocity, pressure: pressure.value(), law }
}

/// The size of a vector.
#[inline(always)]
pub(super) fn size<T: Number>(v: [T; 2]) -> T {
    (v[0] * v[0] + v[1] * v[1]).sqrt()
}

/// The tangent of half the angle between two velocities, at most 1: where a motion turns by more than a right angle it
/// passes near a stop, and which way it points meanwhile is not known.
#[inline(always)]
pub(super) fn half_turn<T: Number>(from: [T; 2], to: [T; 2]) -> T {
    let cross = from[0] * to[1] - from[1] * to[0];
    let dot = from[0] * to[0] + from[1] * to[1];
    let square = |v: [T; 2]| v[0] * v[0] + v[1] * v[1];
    let sizes = (square(from) * square(to)).sqrt();
    let tangent = cross / (dot + sizes + T::constant(TINY));
    tangent.larger(T::constant(-1.0)).smaller(T::constant(1.0))
}
