//! An element whose pressure changes much in a part of a step: its passage, cut where it touches or lifts, at the least
//! pressure of the table, and each stretch between into segments.

use crate::element::{Advanced, ResampledLaw, Segment, SpringLaw, advance, apply_jump};
use crate::math::Number;

/// Pieces of a stretch, at least.
const MIN_PIECES: f64 = 4.0;
/// Change of ln p over a segment, at most.
const MAX_CHANGE: f64 = 0.125;
/// Keeps quotients of numbers that vanish together finite.
const TINY: f64 = 1e-300;

/// An element at the beginning or the end of a part.
#[derive(Clone, Copy, Debug)]
pub(super) struct End<T> {
    /// m.
    pub(super) approach: T,
    /// m/s.
    pub(super) velocity: [T; 2],
    /// m².
    pub(super) area: f64,
}

/// An element between two ends, at the share `share` of the way.
struct Between<T> {
    share: T,
    velocity: [T; 2],
    pressure: f64,
    law: SpringLaw<T>,
}

/// Takes the spring of an element through a part with the displacement `displacement` (m).
pub(super) fn advance_in_segments<T: Number>(
    law: &mut ResampledLaw,
    force: [T; 2],
    (begin, end): (&End<T>, &End<T>),
    displacement: [T; 2],
) -> Advanced<T> {
    let stops = stops(law, begin, end);
    let mut here = between(law, begin, end, T::constant(0.0));
    let mut advanced = Advanced { force, slips: false, slip: 0.0, release: 0.0 };
    for stop in stops {
        if stop.value() <= here.share.value() {
            continue;
        }
        let (start, there) = (here.share, between(law, begin, end, stop));
        let segments = segments(here.pressure, there.pressure);
        for segment in 1..=segments as u32 {
            let share = start + (stop - start).times(f64::from(segment) / segments);
            let next = between(law, begin, end, share);
            let part = share - here.share;
            let (force, lost) = apply_jump(advanced.force, here.law.stiffness, &here.law);
            let this = Segment {
                begin: here.law,
                end: next.law,
                displacement: displacement.map(|d| d * part),
                half_turn: half_turn(here.velocity, next.velocity),
            };
            let further = advance(force, &this);
            advanced = Advanced {
                slip: advanced.slip + further.slip,
                release: advanced.release + further.release + lost,
                ..further
            };
            here = next;
        }
    }
    advanced
}

/// The shares of the part at which the element touches or lifts and at which it is at the least pressure of the table,
/// in their order, and 1.
fn stops<T: Number>(law: &mut ResampledLaw, begin: &End<T>, end: &End<T>) -> [T; 3] {
    let mut beginning = |end: &End<T>| {
        let speed = law.range().logarithm(size(end.velocity));
        let spot = law.spot(speed.value());
        let (touch, least) = law.beginning(&spot, speed);
        (end.approach - touch, end.approach - least)
    };
    let (before, after) = (beginning(begin), beginning(end));
    let crossing = |from: T, to: T| {
        let crosses = from.value() * to.value() < 0.0;
        (from / (from - to)).or(crosses, T::constant(0.0))
    };
    let (touch, least) = (crossing(before.0, after.0), crossing(before.1, after.1));
    [touch.smaller(least), touch.larger(least), T::constant(1.0)]
}

fn segments(before: f64, after: f64) -> f64 {
    let change = if before > 0.0 && after > 0.0 { (after / before).ln().abs() } else { 0.0 };
    (change / MAX_CHANGE).ceil().clamp(MIN_PIECES, 1e3)
}

fn between<T: Number>(law: &mut ResampledLaw, begin: &End<T>, end: &End<T>, share: T) -> Between<T> {
    let straight = |from: T, to: T| from + (to - from) * share;
    let velocity = [0, 1].map(|i| straight(begin.velocity[i], end.velocity[i]));
    let area = straight(T::constant(begin.area), T::constant(end.area));
    let speed = law.range().logarithm(size(velocity));
    let spot = law.spot(speed.value());
    let point = law.at(&spot, speed, straight(begin.approach, end.approach));
    let pressure = point.pressure();
    let law = SpringLaw { stiffness: area * point.stiffness, limit: area * pressure * point.friction };
    Between { share, velocity, pressure: pressure.value(), law }
}

/// The size of a vector.
#[inline(always)]
pub(super) fn size<T: Number>(v: [T; 2]) -> T {
    (v[0] * v[0] + v[1] * v[1]).sqrt()
}

/// The tangent of half the angle between two velocities, at most 1: where a motion turns by more than a right angle it passes
/// near a stop, and which way it points meanwhile is not known.
#[inline(always)]
pub(super) fn half_turn<T: Number>(from: [T; 2], to: [T; 2]) -> T {
    let cross = from[0] * to[1] - from[1] * to[0];
    let dot = from[0] * to[0] + from[1] * to[1];
    let square = |v: [T; 2]| v[0] * v[0] + v[1] * v[1];
    let sizes = (square(from) * square(to)).sqrt();
    let tangent = cross / (dot + sizes + T::constant(TINY));
    tangent.larger(T::constant(-1.0)).smaller(T::constant(1.0))
}
