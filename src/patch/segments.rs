//! Elements whose pressures change much in a part, or which a tread drags to and fro: they are cut where they touch or
//! lift, where they are at the least pressure of the table and where they are slowest, and each piece between two cuts is
//! divided into segments. Those of a block go through theirs side by side.

use std::cmp::Reverse;

use super::block_contacts::BlockContacts;
use super::block_springs::{BlockSprings, advance_all, apply_jumps};
use super::face::{BLOCK, Lanes, lanes_of};
use super::motion::{TINY, reverses, size};
use crate::element::ResampledLaw;
use crate::math::Number;

/// Segments of a piece, at least.
const MIN_SEGMENTS: f64 = 3.0;
/// Change of ln p over a segment, at most.
const MAX_CHANGE: f64 = 0.5;

/// Cuts of a part at most, its end among them.
const CUTS: usize = 4;

/// How an element goes through a part.
#[derive(Clone, Copy, Debug)]
struct Course<T> {
    /// Its lane in the block.
    lane: usize,
    /// The fractions of the part at which its pieces begin, and 1.
    ends: [T; CUTS + 1],
    /// The segments of each piece; none where it is free.
    segments: [u32; CUTS],
}

impl<T: Number> Course<T> {
    /// That of the element in a lane, of a block that goes from `begin` to `end`.
    #[inline(always)]
    fn new(law: &mut ResampledLaw, (begin, end): (&BlockContacts<T>, &BlockContacts<T>), lane: usize) -> Self {
        let mut course = Self { lane, ends: [T::constant(0.0); CUTS + 1], segments: [0; CUTS] };
        let mut here = begin.pressure[lane].value();
        for (i, (cut, pressure)) in cuts(law, (begin, end), lane).into_iter().enumerate() {
            let start = course.ends[i];
            let is_ahead = cut.value() > start.value();
            course.ends[i + 1] = cut.or(is_ahead, start);
            if is_ahead {
                course.segments[i] = segment_count(here, pressure);
                here = pressure;
            }
        }
        course
    }

    fn count(&self) -> u32 {
        self.segments.iter().sum()
    }

    /// The fraction of the part after so many of its segments.
    #[inline(always)]
    fn after(&self, mut segment: u32) -> T {
        let mut end = self.ends[0];
        for (ends, &count) in self.ends.windows(2).zip(&self.segments) {
            if count > 0 {
                let done = segment.min(count);
                end = ends[0] + (ends[1] - ends[0]).times(f64::from(done) / f64::from(count));
                segment -= done;
                if segment == 0 {
                    break;
                }
            }
        }
        end
    }
}

/// The fractions of a part at which an element touches or lifts, at which it is at the least pressure of the table and at
/// which it is slowest, in their order, and 1; with the pressures there, Pa. What does not occur is at 0.
#[inline(always)]
fn cuts<T: Number>(
    law: &mut ResampledLaw,
    (begin, end): (&BlockContacts<T>, &BlockContacts<T>),
    lane: usize,
) -> [(T, f64); CUTS] {
    let least_pressure = law.least_pressure();
    let mut beginning = |contacts: &BlockContacts<T>| {
        let place = law.place(law.range().logarithm(size(contacts.velocity_of(lane))), contacts.rise[lane]);
        let (touch, least) = law.beginning(&place);
        (contacts.approach[lane] - touch, contacts.approach[lane] - least)
    };
    let (before, after) = (beginning(begin), beginning(end));
    let zero = T::constant(0.0);
    let crossing = |from: T, to: T| (from / (from - to)).or(from.value() * to.value() < 0.0, zero);
    let [from, to] = [begin.velocity_of(lane), end.velocity_of(lane)];
    let [dv_x, dv_y] = [to[0] - from[0], to[1] - from[1]];
    let slowest = -(from[0] * dv_x + from[1] * dv_y) / (dv_x * dv_x + dv_y * dv_y + T::constant(TINY));
    let mut pressure_at = |fraction: T| {
        let straight = |from: T, to: T| from + (to - from) * fraction;
        let velocity = [straight(from[0], to[0]), straight(from[1], to[1])];
        let place = law.place(law.range().logarithm(size(velocity)), straight(begin.rise[lane], end.rise[lane]));
        law.at_place(&place, straight(begin.approach[lane], end.approach[lane])).pressure.value()
    };
    let mut cuts = [
        (crossing(before.0, after.0), 0.0),
        (crossing(before.1, after.1), least_pressure),
        if reverses(from, to) { (slowest, pressure_at(slowest)) } else { (zero, 0.0) },
        (T::constant(1.0), end.pressure[lane].value()),
    ];
    cuts.sort_unstable_by(|a, b| a.0.value().total_cmp(&b.0.value()));
    cuts
}

/// The number of segments of a piece with these pressures at its ends.
fn segment_count(before: f64, after: f64) -> u32 {
    let change = match (before > 0.0, after > 0.0) {
        (true, true) => (after / before).ln().abs(),
        (false, false) => return 0,
        _ => 0.0,
    };
    (change / MAX_CHANGE).ceil().clamp(MIN_SEGMENTS, 1e3) as u32
}

/// The elements of a block that go through a part in segments, those with the most of them first.
#[derive(Clone, Debug)]
pub(super) struct SegmentLanes<T> {
    courses: [Course<T>; BLOCK],
    springs: BlockSprings<T>,
    /// Energy lost in the part by slip, J.
    slip: Lanes<T>,
    /// The fractions of the part where a segment begins and where it ends.
    fractions: [Lanes<T>; 2],
    /// The elements there.
    here: Box<BlockContacts<T>>,
    next: Box<BlockContacts<T>>,
}

impl<T: Number> SegmentLanes<T> {
    pub(super) fn new() -> Self {
        let zero = [T::constant(0.0); BLOCK];
        Self {
            courses: [Course { lane: 0, ends: [T::constant(0.0); CUTS + 1], segments: [0; CUTS] }; BLOCK],
            springs: BlockSprings::none(),
            slip: zero,
            fractions: [zero; 2],
            here: Box::new(BlockContacts::new()),
            next: Box::new(BlockContacts::new()),
        }
    }

    /// Takes those springs of a block that are `in_segments` from `begin` to `end`, displaced by `displacement` (m), from
    /// their forces `before` (N); what they lose by slip goes to `part_slip` (J). Returns the number of segments.
    #[inline(always)]
    pub(super) fn advance(
        &mut self,
        law: &mut ResampledLaw,
        (springs, part_slip): (&mut BlockSprings<T>, &mut Lanes<T>),
        ends: (&BlockContacts<T>, &BlockContacts<T>),
        (before, displacement): (&[Lanes<T>; 2], &[Lanes<T>; 2]),
        in_segments: &Lanes<bool>,
    ) -> u32 {
        let mut active = 0;
        for lane in (0..ends.0.count).filter(|&lane| in_segments[lane]) {
            self.courses[active] = Course::new(law, ends, lane);
            active += 1;
        }
        self.courses[..active].sort_unstable_by_key(|course| (Reverse(course.count()), course.lane));
        self.begin(ends.0, before, active);
        self.go_to(0, ends, active);
        let total = self.courses[..active].iter().map(Course::count).sum();
        for segment in 1.. {
            // Those that are at their end leave.
            while active > 0 && self.courses[active - 1].count() < segment {
                active -= 1;
                self.leave(active, ends.1, springs, part_slip);
            }
            if active == 0 {
                break;
            }
            std::mem::swap(&mut self.here, &mut self.next);
            self.go_to(segment, ends, active);
            self.look_up(law, ends, active);
            self.advance_to_next(displacement, active);
        }
        total
    }

    /// Sets springs and laws where the part begins; what is free there has none where it touches.
    #[inline(always)]
    fn begin(&mut self, begin: &BlockContacts<T>, before: &[Lanes<T>; 2], count: usize) {
        let zero = T::constant(0.0);
        for j in 0..count {
            let lane = self.courses[j].lane;
            let touches = begin.pressure[lane].value() > 0.0;
            for axis in 0..2 {
                self.springs.force[axis][j] = before[axis][lane].or(touches, zero);
            }
            (self.springs.release[j], self.springs.slips[j], self.slip[j]) = (0.0, 0.0, zero);
            self.next.limit[j] = begin.limit[lane];
            self.next.stiffness[j] = begin.stiffness[lane];
        }
    }

    /// Places the elements where they are after so many segments.
    #[inline(always)]
    fn go_to(&mut self, segment: u32, (begin, end): (&BlockContacts<T>, &BlockContacts<T>), count: usize) {
        let next = &mut self.next;
        for j in 0..count {
            let (lane, fraction) = (self.courses[j].lane, self.courses[j].after(segment));
            let straight = |from: T, to: T| from + (to - from) * fraction;
            next.approach[j] = straight(begin.approach[lane], end.approach[lane]);
            next.rise[j] = straight(begin.rise[lane], end.rise[lane]);
            for axis in 0..2 {
                next.velocity[axis][j] = straight(begin.velocity[axis][lane], end.velocity[axis][lane]);
            }
            self.fractions[0][j] = self.fractions[1][j];
            self.fractions[1][j] = fraction;
        }
    }

    /// Looks their law up there.
    #[inline(always)]
    fn look_up(&mut self, law: &mut ResampledLaw, (begin, end): (&BlockContacts<T>, &BlockContacts<T>), count: usize) {
        // By area, which is not the same at both ends where a cell enters.
        let Self { next, courses, fractions, .. } = self;
        next.count = count;
        next.area[..lanes_of::<T>(count)].fill(1.0);
        next.look_up(law);
        for j in 0..count {
            let lane = courses[j].lane;
            let growth = end.area[lane] - begin.area[lane];
            let area = T::constant(begin.area[lane]) + fractions[1][j].times(growth);
            next.limit[j] = next.limit[j] * area;
            next.stiffness[j] = next.stiffness[j] * area;
        }
    }

    /// Takes the springs through a segment.
    #[inline(always)]
    fn advance_to_next(&mut self, displacement: &[Lanes<T>; 2], count: usize) {
        let Self { courses, springs, slip, fractions, here, next } = self;
        let mut of_segment = [[T::constant(0.0); BLOCK]; 2];
        for axis in 0..2 {
            for j in 0..count {
                of_segment[axis][j] = displacement[axis][courses[j].lane] * (fractions[1][j] - fractions[0][j]);
            }
        }
        // The spring follows the law, then the motion.
        here.count = count;
        springs.stiffness = here.stiffness;
        apply_jumps(springs, here);
        let mut slip_of_segment = [T::constant(0.0); BLOCK];
        advance_all(springs, &mut slip_of_segment, (here, next), &of_segment, &[false; BLOCK]);
        for j in 0..count {
            slip[j] = slip[j] + slip_of_segment[j];
        }
    }

    /// Gives a spring back to its block, where the part ends.
    #[inline(always)]
    fn leave(&self, j: usize, end: &BlockContacts<T>, springs: &mut BlockSprings<T>, part_slip: &mut Lanes<T>) {
        let lane = self.courses[j].lane;
        // What has lifted has lost all.
        let bears = end.stiffness[lane].value() > 0.0;
        for axis in 0..2 {
            springs.force[axis][lane] = self.springs.force[axis][j].or(bears, T::constant(0.0));
        }
        springs.slips[lane] = self.springs.slips[j];
        springs.release[lane] += self.springs.release[j];
        part_slip[lane] = self.slip[j];
    }
}
