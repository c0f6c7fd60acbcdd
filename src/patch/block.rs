//! A block of elements that a step is done for together: in structure of arrays and, where possible, loops without
//! branches.

use super::block_contacts::{BeyondTable, BlockContacts, Damping, FaceMotion, StepSums, TooWarm};
use super::block_springs::{BlockSprings, advance_all, apply_jumps};
use super::face::{BLOCK, Face, Lanes};
use super::heat::{self, BlockHeat, StepHeat};
use super::motion::{BodyKinematics, Substep, reverses};
use super::segments::SegmentLanes;
use crate::element::{ROUNDING, ResampledLaw, Segment, SpringLaw, damped, damper_loss};
use crate::math::Number;

/// What an element does; in states, as a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum ElementMode {
    Free = 0,
    Slipping = 1,
    Sticking = 2,
}

/// e^½: an element whose pressure changes by a larger factor in a substep is advanced in segments of its own.
const MAX_RATIO: f64 = 1.648_721_270_700_128_2;

/// The workspace of a block.
#[derive(Clone, Debug)]
pub(super) struct ElementBlock<T> {
    /// The first element as it is counted in the step.
    start: usize,
    /// How many elements there are.
    count: usize,
    pub(super) springs: BlockSprings<T>,
    /// By the numbers of [`ElementMode`].
    pub(super) mode: Lanes<u8>,
    /// At the beginning of the substep.
    begin: Box<BlockContacts<T>>,
    /// At the end of the substep, or at the instant last evaluated.
    end: Box<BlockContacts<T>>,
    /// Those whose pressures change much in the part.
    segments: Box<SegmentLanes<T>>,
    /// Where slip warms the elements: how warm they are.
    pub(super) heat: BlockHeat<T>,
    /// Energy lost in the part by slip, J.
    part_slip: Lanes<T>,
    /// How long the last part took, s; 0 before.
    part_duration: f64,
    /// What its elements have been through since it was counted last.
    work: u64,
}

impl<T: Number> ElementBlock<T> {
    pub(super) fn new() -> Self {
        Self {
            start: 0,
            count: 0,
            springs: BlockSprings::none(),
            mode: [0; BLOCK],
            begin: Box::new(BlockContacts::new()),
            end: Box::new(BlockContacts::new()),
            segments: Box::new(SegmentLanes::new()),
            heat: BlockHeat::new(),
            part_slip: [T::constant(0.0); BLOCK],
            part_duration: 0.0,
            work: 0,
        }
    }

    /// Makes it the block of the `count` elements from `start` on, as they are counted in the step, with no springs
    /// yet and cold.
    pub(super) fn reset(&mut self, start: usize, count: usize) {
        (self.start, self.count, self.part_duration) = (start, count, 0.0);
        self.springs = BlockSprings::none();
        self.heat.reset();
        // Both, since the law is not looked up in all lanes; and those behind the last element stand still.
        for contacts in [&mut self.begin, &mut self.end] {
            contacts.count = count;
            let BlockContacts { place, direction, arc, .. } = &mut **contacts;
            place.iter_mut().chain(direction).chain([arc]).for_each(|lanes| lanes[count..].fill(0.0));
            contacts.is_free = true;
            contacts.clear();
        }
    }

    /// Does the step for the block's elements and adds to the sums.
    #[inline(always)]
    pub(super) fn advance(&mut self, step: &FaceMotion<'_, T>, law: &mut ResampledLaw, sums: &mut StepSums<T>) {
        let mut now = step.body.at(0.0);
        // Whether `end` holds the elements at the begin of the substep.
        let mut is_evaluated = false;
        for substep in step.substeps.iter() {
            // Another block has found that the step is given up.
            if step.work.is_exceeded() {
                break;
            }
            // None is on the face: there is nothing to do, and `end` falls behind.
            if !step.is_inside(self.start, self.count, substep) {
                is_evaluated = false;
                continue;
            }
            // Else the end of the substep before is the begin of this one.
            if !is_evaluated {
                now = step.body.at(substep.begin);
                self.evaluate_at(step, law, &now, substep.begin);
                self.check_table(step, law, substep.begin, sums);
                is_evaluated = true;
            }
            now = match step.heat {
                Some(heat) => self.advance_warming(step, &heat, law, now, substep, sums),
                None => self.advance_part(step, law, &now, substep),
            };
            if step.work.add(std::mem::take(&mut self.work)) {
                break;
            }
            self.check_table(step, law, substep.end, sums);
        }
        self.add_up(step, sums);
    }

    /// Takes the elements through a part, from the body as it is `now`; returns it at the end.
    #[inline(always)]
    fn advance_part(
        &mut self,
        step: &FaceMotion<'_, T>,
        law: &mut ResampledLaw,
        now: &BodyKinematics<T>,
        part: Substep,
    ) -> BodyKinematics<T> {
        let next = step.body.at(part.end);
        // `begin` is the law at the begin of the part, `end` that at its end; the springs follow from the one to the other.
        self.work += BLOCK as u64;
        std::mem::swap(&mut self.begin, &mut self.end);
        self.evaluate_at(step, law, &next, part.end);
        self.advance_springs(step, law, (now, &next), part);
        next
    }

    /// Takes the elements and their temperatures through a substep, in parts so short that these change by little.
    #[inline(always)]
    fn advance_warming(
        &mut self,
        step: &FaceMotion<'_, T>,
        heat: &StepHeat,
        law: &mut ResampledLaw,
        mut now: BodyKinematics<T>,
        substep: Substep,
        sums: &mut StepSums<T>,
    ) -> BodyKinematics<T> {
        let (mut begin, mut length) = (substep.begin, substep.length());
        while begin < substep.end {
            let end = if begin + length < substep.end { begin + length } else { substep.end };
            let part = Substep { begin, end };
            // The law follows the temperatures at which the part begins.
            let (springs, of_law) = (self.springs, self.heat.of_law);
            let rise = heat::total(&self.heat.parts);
            self.heat.of_law = rise;
            // By it the springs, and by what they lose ϑ at the end of the part.
            let next = self.advance_part(step, law, &now, part);
            if step.work.add(std::mem::take(&mut self.work)) {
                return next;
            }
            let warmed = self.warmed(heat, part.length() * step.body.duration);
            // Too long a part is done again, half as long.
            if self.warms_too_much(heat, &rise, &heat::total(&warmed)) && length > SHORTEST_PART * substep.length() {
                std::mem::swap(&mut self.begin, &mut self.end);
                (self.springs, self.heat.of_law) = (springs, of_law);
                length *= 0.5;
                continue;
            }
            self.heat.parts = warmed;
            self.check_temperatures(step, heat, end, sums);
            // The next part is tried twice as long.
            (now, begin) = (next, end);
            length *= 2.0;
        }
        now
    }

    /// The temperatures after the part just done, by their terms.
    #[inline(always)]
    fn warmed(&mut self, heat: &StepHeat, duration: f64) -> heat::Rises<T> {
        // Over the mean of the areas: cells of a tread are partly inside as they enter and leave.
        let mut area = self.begin.area;
        for i in 0..BLOCK {
            area[i] = 0.5 * (area[i] + self.end.area[i]);
        }
        self.heat.after(heat, duration, &self.part_slip, &area)
    }

    /// Whether the temperature of an element in contact changes too much for one part, within those of the table.
    #[inline(always)]
    fn warms_too_much(&self, heat: &StepHeat, before: &Lanes<T>, after: &Lanes<T>) -> bool {
        let (low, high) = heat.range;
        let within = |rise: T| rise.value().max(low).min(high);
        // Of all lanes, without branches: those behind the last element have no stiffness.
        let mut found = false;
        for i in 0..BLOCK {
            let bears = self.begin.stiffness[i].value() + self.end.stiffness[i].value() > 0.0;
            found |= bears & ((within(after[i]) - within(before[i])).abs() > heat::MAX_CHANGE);
        }
        found
    }

    /// Records the first element in contact that is warmer than the table, after a fraction of the step.
    #[inline(always)]
    fn check_temperatures(&self, step: &FaceMotion<'_, T>, heat: &StepHeat, fraction: f64, sums: &mut StepSums<T>) {
        if self.end.is_free || sums.too_warm.is_some_and(|warm| warm.fraction <= fraction) {
            return;
        }
        let rises = heat::total(&self.heat.parts);
        // The first instant counts, and of it the first element.
        let most = heat.range.1 * (1.0 + ROUNDING);
        let too_warm = |i: usize| {
            let rise = rises[i].value();
            let element = step.index_at(self.start + i, fraction);
            (self.end.stiffness[i].value() > 0.0 && rise > most).then_some(TooWarm { element, fraction, rise })
        };
        sums.too_warm = (0..self.count).find_map(too_warm).or(sums.too_warm);
    }

    /// Gives the springs, relaxed, the stiffness of their contacts at the start of a step.
    pub(super) fn initialize(&mut self, step: &FaceMotion<'_, T>, law: &mut ResampledLaw, sums: &mut StepSums<T>) {
        self.evaluate_at(step, law, &step.body.at(0.0), 0.0);
        self.check_table(step, law, 0.0, sums);
        self.springs.stiffness = self.end.stiffness;
        self.add_up(step, sums);
    }

    /// Evaluates `end` after a fraction of the step, at which the body is as `now` says.
    #[inline(always)]
    fn evaluate_at(
        &mut self,
        step: &FaceMotion<'_, T>,
        law: &mut ResampledLaw,
        now: &BodyKinematics<T>,
        fraction: f64,
    ) {
        let is_tread = matches!(step.face, Face::Tread(_));
        self.end.set_positions(step, self.start, self.count, step.tread.entered_at(fraction));
        self.end.set_motion(now, is_tread.then(|| step.tread.speed_at(fraction)));
        // The law where the elements are now, at the temperatures that it was last set to.
        self.end.rise = self.heat.of_law;
        self.end.is_free = self.end.is_clear(law);
        if self.end.is_free { self.end.clear() } else { self.end.look_up(law) }
    }

    /// Takes the springs from `begin` to `end`, those of a part of the step.
    #[inline(always)]
    fn advance_springs(
        &mut self,
        step: &FaceMotion<'_, T>,
        law: &mut ResampledLaw,
        (now, next): (&BodyKinematics<T>, &BodyKinematics<T>),
        part: Substep,
    ) {
        self.part_slip = [T::constant(0.0); BLOCK];
        self.part_duration = part.length() * step.body.duration;
        if self.begin.is_free && self.end.is_free && self.springs.stiffness.iter().all(|k| k.value() == 0.0) {
            return;
        }
        // All elements as if their pressures changed in one segment.
        let displacement = self.displacements(step, (now, next), part);
        let Self { springs, part_slip, begin, end, segments, work, .. } = self;
        // The law may have jumped since the springs followed it last, where a step begins: the motion has a kink there, and
        // the temperature given may be another.
        apply_jumps(springs, begin);
        let before = springs.force;
        let in_segments = need_segments(begin, end, step.tread.speed_change != 0.0);
        advance_all(springs, part_slip, (begin, end), &displacement, &in_segments);
        // Those that need it once more, in segments.
        if in_segments.contains(&true) {
            let motion = (&before, &displacement);
            let done = segments.advance(law, (springs, part_slip), (begin, end), motion, &in_segments);
            *work += WORK_OF_SEGMENT * u64::from(done);
        }
        for i in 0..BLOCK {
            springs.slip[i] += part_slip[i].value();
        }
        springs.stiffness = end.stiffness;
        if step.damping.shear > 0.0 {
            self.add_damper_losses(step, &before, &displacement);
        }
    }

    /// Adds what the dampers take in a part that the springs begin with the forces `before` (N).
    #[inline(never)]
    fn add_damper_losses(&mut self, step: &FaceMotion<'_, T>, before: &[Lanes<T>; 2], displacement: &[Lanes<T>; 2]) {
        let (begin, end, duration) = (&*self.begin, &*self.end, self.part_duration);
        let value = |law: SpringLaw<T>| SpringLaw { stiffness: law.stiffness.value(), limit: law.limit.value() };
        for i in 0..self.count {
            let segment = Segment {
                begin: value(begin.law(i)),
                end: value(end.law(i)),
                displacement: [displacement[0][i].value(), displacement[1][i].value()],
                half_turn: 0.0,
            };
            let force = [before[0][i].value(), before[1][i].value()];
            let mut loss = damper_loss(force, &segment, duration, step.damping.shear);
            // Along the normal by the mean pressure in the part.
            let pressures = [begin.pressure[i].value(), end.pressure[i].value()];
            let middle = 0.5 * (pressures[0] + pressures[1]);
            let rate = (pressures[1] - pressures[0]) / duration;
            let approach = (end.approach[i] - begin.approach[i]).value();
            let area = 0.5 * (begin.area[i] + end.area[i]);
            loss += (area * (step.damping.normal * rate).max(-middle) * approach).max(0.0);
            self.springs.damper[i] += loss;
        }
    }

    /// How far the face's material goes along the plane from `begin` to `end`, m.
    #[inline(always)]
    fn displacements(
        &self,
        step: &FaceMotion<'_, T>,
        (now, next): (&BodyKinematics<T>, &BodyKinematics<T>),
        part: Substep,
    ) -> [Lanes<T>; 2] {
        let (begin, end) = (&*self.begin, &*self.end);
        // ∫ v dt of the material under an element: of the pose's point, and of the arm from there as the body turns.
        let mut displacement = [[T::constant(0.0); BLOCK]; 2];
        for axis in 0..2 {
            let moved = next.moved[axis] - now.moved[axis];
            for i in 0..BLOCK {
                displacement[axis][i] = moved + (end.arm[axis][i] - begin.arm[axis][i]);
            }
        }
        if let Face::Tread(tread) = step.face {
            // The tread runs to the rear besides, along the mean of the directions of the arc at both ends. Where a cell is
            // partly inside, its middle does not go as far as its material.
            let travel = step.tread.travel_in(part) * tread.cell;
            for axis in 0..2 {
                for i in 0..BLOCK {
                    let rest = travel + (end.arc[i] - begin.arc[i]);
                    let along = (begin.along[axis][i] + end.along[axis][i]).times(0.5 * rest);
                    displacement[axis][i] = displacement[axis][i] - along;
                }
            }
        }
        displacement
    }

    /// Records the first element that is beyond the table, after a fraction of the step.
    #[inline(always)]
    fn check_table(&self, step: &FaceMotion<'_, T>, law: &ResampledLaw, fraction: f64, sums: &mut StepSums<T>) {
        if self.end.is_free {
            return;
        }
        let limits = law.limits();
        let speed_of = |i: usize| {
            let [x, y] = [0, 1].map(|axis| self.end.velocity[axis][i].value());
            x * x + y * y
        };
        // Whether there is any, without branches: nearly always there is none.
        let mut found = false;
        for i in 0..BLOCK {
            let p = self.end.pressure[i].value();
            found |= (p > limits.pressure) | ((p > 0.0) & (speed_of(i) > limits.speed * limits.speed));
        }
        if !found || sums.beyond.is_some_and(|beyond| beyond.fraction <= fraction) {
            return;
        }
        // The first that bears on an area: a cell of a tread may be about to enter.
        let beyond = |i: usize| {
            let (p, v) = (self.end.pressure[i].value(), speed_of(i).sqrt());
            let bears = p > 0.0 && self.end.area[i] > 0.0;
            let element = step.index_at(self.start + i, fraction);
            (bears && limits.is_beyond(p, v)).then_some(BeyondTable { element, fraction, pressure: p, speed: v })
        };
        sums.beyond = (0..self.count).find_map(beyond).or(sums.beyond);
    }

    /// Adds to the wrench on the body and to the losses.
    #[inline(always)]
    fn add_up(&mut self, step: &FaceMotion<'_, T>, sums: &mut StepSums<T>) {
        let end = &*self.end;
        sums.slip += total(&self.springs.slip);
        sums.release += total(&self.springs.release);
        sums.damper += total(&self.springs.damper);
        if end.is_free {
            self.mode.fill(ElementMode::Free as u8);
            return;
        }
        let damped = (step.damping.shear > 0.0).then(|| self.damped_loads(step.damping));
        let (force, pressure) =
            damped.as_ref().map_or((&self.springs.force, &end.pressure), |(force, pressure)| (force, pressure));
        // Forces on the body, their moments about the pose's point, and the force along the tread.
        let mut loads = [[T::constant(0.0); BLOCK]; 7];
        for i in 0..BLOCK {
            // -G along the plane, N = pA along z, and r × F.
            let (f_x, f_y) = (-force[0][i], -force[1][i]);
            let f_z = pressure[i].times(end.area[i]);
            let (x, y, z) = (end.arm[0][i], end.arm[1][i], end.arm[2][i]);
            (loads[0][i], loads[1][i], loads[2][i]) = (f_x, f_y, f_z);
            loads[3][i] = y * f_z - z * f_y;
            loads[4][i] = z * f_x - x * f_z;
            loads[5][i] = x * f_y - y * f_x;
        }
        // Of these the force along the tread, which runs against the direction of the arc.
        if let Face::Tread(_) = step.face {
            for i in 0..BLOCK {
                let along = end.along[0][i] * loads[0][i] + end.along[1][i] * loads[1][i];
                loads[6][i] = -(along + end.along[2][i] * loads[2][i]);
            }
        }
        for (sum, load) in sums.wrench.iter_mut().zip(&loads) {
            *sum = *sum + total(load);
        }
        sums.transport = sums.transport + total(&loads[6]);
        for i in 0..BLOCK {
            let mode = if self.springs.slips[i] > 0.0 { ElementMode::Slipping } else { ElementMode::Sticking };
            self.mode[i] = if end.stiffness[i].value() > 0.0 { mode as u8 } else { ElementMode::Free as u8 };
        }
    }
}

impl<T: Number> ElementBlock<T> {
    /// The forces on the ground (N) and the pressures (Pa) with what the dampers add to them.
    #[inline(never)]
    fn damped_loads(&self, damping: Damping) -> ([Lanes<T>; 2], Lanes<T>) {
        let (begin, end) = (&*self.begin, &*self.end);
        let (mut force, mut pressure) = (self.springs.force, end.pressure);
        for i in 0..self.count {
            let (force_before, velocity) = ([force[0][i], force[1][i]], end.velocity_of(i));
            [force[0][i], force[1][i]] = damped(force_before, &end.law(i), velocity, damping.shear);
        }
        // The rate of the pressure is that over the last part; at a start there is none. Nothing pulls.
        if self.part_duration > 0.0 && damping.normal > 0.0 {
            let per_change = damping.normal / self.part_duration;
            for i in 0..self.count {
                let viscous = (end.pressure[i] - begin.pressure[i]).times(per_change);
                pressure[i] = (pressure[i] + viscous).larger(T::constant(0.0));
            }
        }
        (force, pressure)
    }
}

/// The sum over a block, by halves.
#[inline(always)]
fn total<T: Number>(lanes: &Lanes<T>) -> T {
    let mut sums = *lanes;
    let mut width = BLOCK / 2;
    while width > 0 {
        let (left, right) = sums.split_at_mut(width);
        left.iter_mut().zip(&right[..width]).for_each(|(sum, other)| *sum = *sum + *other);
        width /= 2;
    }
    sums[0]
}

/// A segment's work, as a number of parts of elements that vectors take together.
const WORK_OF_SEGMENT: u64 = 4;
/// Share of a substep below which it is not cut further for heat.
const SHORTEST_PART: f64 = 1e-9;

/// The elements that are advanced in segments of their own in a substep: those whose pressure changes by too large a
/// factor and, where the speed of a tread changes, those that go to and fro.
#[inline(always)]
fn need_segments<T: Number>(
    begin: &BlockContacts<T>,
    end: &BlockContacts<T>,
    tread_speed_changes: bool,
) -> Lanes<bool> {
    let mut found = [false; BLOCK];
    for i in 0..BLOCK {
        let (before, after) = (begin.pressure[i].value(), end.pressure[i].value());
        found[i] = (before > MAX_RATIO * after) | (after > MAX_RATIO * before);
    }
    if tread_speed_changes {
        for i in 0..BLOCK {
            found[i] |= reverses(begin.velocity_of(i), end.velocity_of(i));
        }
    }
    found
}
