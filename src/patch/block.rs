//! A block of elements that a step is done for together: in structure of arrays and, where possible, loops without branches.

use super::contact_times::{End, advance_in_segments, half_turn, size};
use super::face::{Column, Face};
use super::motion::{Instant, Parts, Path, Run};
use crate::element::{ResampledLaw, Segment, Spot, SpringLaw, advance, apply_jump};
use crate::math::Number;

/// Elements of a block.
pub(super) const BLOCK: usize = 64;

/// e^½: an element whose pressure changes by a larger factor in a part is cut for itself.
const MAX_RATIO: f64 = 1.648_721_270_700_128_2;

type Lanes<T> = [T; BLOCK];

/// A step of the whole patch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step<'a, T> {
    pub(super) face: &'a Face,
    pub(super) path: Path<T>,
    pub(super) run: Run,
    pub(super) parts: Parts,
    /// The velocity at which the tread runs, m/s.
    pub(super) tread_speed: f64,
}

/// What the blocks add up to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums<T> {
    /// Force (N) and moment (N m) on the body at the end, in the ground's axes about the pose's point.
    pub(super) wrench: [T; 6],
    /// Force on the tread, N.
    pub(super) transport: T,
    /// Lost in the step by slip and by release, J.
    pub(super) slip: f64,
    pub(super) release: f64,
    /// The first element found beyond the table.
    pub(super) beyond: Option<Beyond>,
}

/// An element beyond the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Beyond {
    /// As it is counted at that instant.
    pub(super) element: usize,
    /// Of the step.
    pub(super) share: f64,
    /// Pa.
    pub(super) pressure: f64,
    /// m/s.
    pub(super) speed: f64,
}

impl<T> Step<'_, T> {
    /// The index of the first element of the step as elements were counted before it, the number of elements, and by how
    /// much indices grow.
    pub(super) fn elements(&self) -> (isize, usize, isize) {
        match self.face {
            Face::Points(_) => (0, self.face.count(), 0),
            Face::Tread(tread) => {
                let (rows, (first, columns)) = (tread.rows.len(), tread.columns_of(self.run));
                let indices = |columns: f64| columns as isize * rows as isize;
                (indices(first), columns * rows, indices(self.run.entered()))
            }
        }
    }

    /// The index after a share of the step of an element as it is counted in the step.
    fn index_at(&self, element: usize, share: f64) -> usize {
        let Face::Tread(tread) = self.face else { return element };
        let columns = tread.columns_of(self.run).0 + self.run.at(share).floor();
        element.saturating_add_signed(columns as isize * tread.rows.len() as isize).min(self.face.count() - 1)
    }

    /// Whether some of the `count` elements from `start` on are on the face in a part.
    #[inline(always)]
    fn is_inside(&self, start: usize, count: usize, (from, to): (f64, f64)) -> bool {
        let Face::Tread(tread) = self.face else { return true };
        let (rows, first) = (tread.rows.len(), tread.columns_of(self.run).0);
        let [front, rear] = [start, start + count - 1].map(|element| first + (element / rows) as f64);
        let (least, most) = (self.run.at(from), self.run.at(to));
        // Column i is inside while it and the cells that have entered are between 0 and one more than the columns.
        rear + least.max(most) > 0.0 && front + least.min(most) < tread.columns as f64 + 1.0
    }
}

impl<T: Number> Sums<T> {
    pub(super) fn zero() -> Self {
        let zero = T::constant(0.0);
        Self { wrench: [zero; 6], transport: zero, slip: 0.0, release: 0.0, beyond: None }
    }

    /// Adds those of elements that follow.
    pub(super) fn add(&mut self, further: &Self) {
        for (sum, load) in self.wrench.iter_mut().zip(&further.wrench) {
            *sum = *sum + *load;
        }
        self.transport = self.transport + further.transport;
        self.slip += further.slip;
        self.release += further.release;
        if further.beyond.is_some_and(|theirs| self.beyond.is_none_or(|own| theirs.share < own.share)) {
            self.beyond = further.beyond;
        }
    }

    /// The same without derivatives.
    pub(super) fn plain(&self) -> Sums<f64> {
        let Self { wrench, transport, slip, release, beyond } = *self;
        Sums { wrench: wrench.map(T::value), transport: transport.value(), slip, release, beyond }
    }
}

/// The elements at an instant: where they are and the law there.
#[derive(Clone, Debug)]
struct Side<T> {
    /// Positions in the body's axes, m.
    place: [Lanes<f64>; 3],
    /// Of a tread: the direction of the arc in x and z, and where on it the middle is, m.
    direction: [Lanes<f64>; 2],
    arc: Lanes<f64>,
    /// m².
    area: Lanes<f64>,
    /// From the pose's point, in the ground's axes, m.
    arm: [Lanes<T>; 3],
    /// Of a tread: the direction of the arc in the ground's axes.
    along: [Lanes<T>; 3],
    approach: Lanes<T>,
    velocity: [Lanes<T>; 2],
    log_speed: Lanes<T>,
    /// Whether no element can be in contact: then these are 0.
    is_free: bool,
    pressure: Lanes<T>,
    limit: Lanes<T>,
    stiffness: Lanes<T>,
}

/// The workspace of a block.
#[derive(Clone, Debug)]
pub(super) struct Block<T> {
    /// The first element as it is counted in the step, and how many there are.
    start: usize,
    count: usize,
    /// G, N.
    pub(super) force: [Lanes<T>; 2],
    /// K, N/m.
    pub(super) stiffness: Lanes<T>,
    /// 0 free, 1 slips, 2 sticks.
    pub(super) mode: Lanes<u8>,
    begin: Box<Side<T>>,
    end: Box<Side<T>>,
    /// 1 for those that slip, else 0.
    slips: Lanes<f64>,
    slip: Lanes<f64>,
    release: Lanes<f64>,
}

impl<T: Number> Side<T> {
    fn new() -> Self {
        let zero = [T::constant(0.0); BLOCK];
        Self {
            place: [[0.0; BLOCK]; 3],
            direction: [[0.0; BLOCK]; 2],
            arc: [0.0; BLOCK],
            area: [0.0; BLOCK],
            arm: [zero; 3],
            along: [zero; 3],
            approach: zero,
            velocity: [zero; 2],
            log_speed: zero,
            is_free: true,
            pressure: zero,
            limit: zero,
            stiffness: zero,
        }
    }

    /// Places the elements from `start` on when `entered` cells of a tread have entered since the start of the step.
    #[inline(always)]
    fn place(&mut self, step: &Step<'_, T>, start: usize, count: usize, entered: f64) {
        match step.face {
            Face::Points(points) => {
                let range = start..start + count;
                let [x, y, z] = &mut self.place;
                x[..count].copy_from_slice(&points.x[range.clone()]);
                y[..count].copy_from_slice(&points.y[range.clone()]);
                z[..count].copy_from_slice(&points.z[range.clone()]);
                self.area[..count].copy_from_slice(&points.area[range]);
                self.area[count..].fill(0.0);
            }
            Face::Tread(tread) => {
                let (rows, first) = (tread.rows.len(), tread.columns_of(step.run).0);
                let mut column = Column::default();
                self.area[count..].fill(0.0);
                for i in 0..count {
                    let row = (start + i) % rows;
                    if i == 0 || row == 0 {
                        column = tread.column(first + ((start + i) / rows) as f64, entered);
                    }
                    let Column { arc, place: [x, z], direction, share } = column;
                    (self.place[0][i], self.place[1][i], self.place[2][i]) = (x, tread.rows[row], z);
                    (self.direction[0][i], self.direction[1][i]) = (direction[0], direction[1]);
                    (self.arc[i], self.area[i]) = (arc, tread.area * share);
                }
            }
        }
    }

    /// Moves the elements to an instant.
    #[inline(always)]
    fn move_to(&mut self, now: &Instant<T>, tread: Option<f64>) {
        for i in 0..BLOCK {
            let arm = now.turned([self.place[0][i], self.place[1][i], self.place[2][i]]);
            let velocity = now.velocity(arm);
            self.approach[i] = -(now.height + arm[2]);
            (self.arm[0][i], self.arm[1][i], self.arm[2][i]) = (arm[0], arm[1], arm[2]);
            (self.velocity[0][i], self.velocity[1][i]) = (velocity[0], velocity[1]);
        }
        let Some(speed) = tread else { return };
        for i in 0..BLOCK {
            let along = now.turned([self.direction[0][i], 0.0, self.direction[1][i]]);
            (self.along[0][i], self.along[1][i], self.along[2][i]) = (along[0], along[1], along[2]);
            self.velocity[0][i] = self.velocity[0][i] - along[0].times(speed);
            self.velocity[1][i] = self.velocity[1][i] - along[1].times(speed);
        }
    }

    /// Whether no element can be in contact.
    #[inline(always)]
    fn is_clear(&self, law: &ResampledLaw) -> bool {
        let touch = law.earliest_touch();
        self.approach.iter().fold(f64::NEG_INFINITY, |most, a| if a.value() > most { a.value() } else { most }) <= touch
    }

    /// Looks the law up.
    #[inline(always)]
    fn look_up(&mut self, law: &mut ResampledLaw) {
        let range = law.range();
        for i in 0..BLOCK {
            self.log_speed[i] = range.logarithm(size([self.velocity[0][i], self.velocity[1][i]]));
        }
        let (mut spots, mut segments) = ([Spot::default(); BLOCK], [0; BLOCK]);
        for i in 0..BLOCK {
            spots[i] = law.spot(self.log_speed[i].value());
        }
        for i in 0..BLOCK {
            segments[i] = law.piece(&spots[i], self.log_speed[i].value(), self.approach[i].value());
        }
        let mut factor = [T::constant(0.0); BLOCK];
        let mut friction = factor;
        for i in 0..BLOCK {
            let point = law.at_piece(&spots[i], segments[i], self.log_speed[i], self.approach[i]);
            (self.pressure[i], factor[i]) = (point.log_pressure, point.factor);
            (friction[i], self.stiffness[i]) = (point.friction, point.stiffness);
        }
        for i in 0..BLOCK {
            let pressure = self.pressure[i].exp() * factor[i];
            self.pressure[i] = pressure;
            self.limit[i] = (pressure * friction[i]).times(self.area[i]);
            self.stiffness[i] = self.stiffness[i].times(self.area[i]);
        }
    }

    fn clear(&mut self) {
        let zero = [T::constant(0.0); BLOCK];
        (self.pressure, self.limit, self.stiffness) = (zero, zero, zero);
    }

    #[inline(always)]
    fn law(&self, i: usize) -> SpringLaw<T> {
        SpringLaw { stiffness: self.stiffness[i], limit: self.limit[i] }
    }

    fn end(&self, i: usize) -> End<T> {
        End { approach: self.approach[i], velocity: [self.velocity[0][i], self.velocity[1][i]], area: self.area[i] }
    }
}

impl<T: Number> Block<T> {
    pub(super) fn new() -> Self {
        let zero = [T::constant(0.0); BLOCK];
        Self {
            start: 0,
            count: 0,
            force: [zero; 2],
            stiffness: zero,
            mode: [0; BLOCK],
            begin: Box::new(Side::new()),
            end: Box::new(Side::new()),
            slips: [0.0; BLOCK],
            slip: [0.0; BLOCK],
            release: [0.0; BLOCK],
        }
    }

    /// Turns to the `count` elements from `start` on, as they are counted in the step; their springs are set afterwards.
    pub(super) fn turn_to(&mut self, start: usize, count: usize) {
        (self.start, self.count) = (start, count);
        let zero = [T::constant(0.0); BLOCK];
        (self.force, self.stiffness) = ([zero; 2], zero);
        self.slips = [0.0; BLOCK];
        (self.slip, self.release) = ([0.0; BLOCK], [0.0; BLOCK]);
        for side in [&mut self.begin, &mut self.end] {
            side.place.iter_mut().for_each(|lanes| lanes[count..].fill(0.0));
        }
        self.end.is_free = true;
        self.end.clear();
    }

    /// Does the step for the block's elements and adds to the sums.
    #[inline(always)]
    pub(super) fn advance(&mut self, step: &Step<'_, T>, law: &mut ResampledLaw, sums: &mut Sums<T>) {
        let mut now = step.path.at(0.0);
        let mut stands = false;
        for (from, to) in step.parts.iter() {
            if !step.is_inside(self.start, self.count, (from, to)) {
                stands = false;
                continue;
            }
            if !stands {
                now = step.path.at(from);
                self.evaluate_at(step, law, &now, from);
                self.check(step, law, from, sums);
                stands = true;
            }
            let next = step.path.at(to);
            std::mem::swap(&mut self.begin, &mut self.end);
            self.evaluate_at(step, law, &next, to);
            self.pass_part(step, law, (&now, &next), to - from);
            self.check(step, law, to, sums);
            now = next;
        }
        self.add_up(step, sums);
    }

    /// Lets the springs, relaxed, take the stiffness of their contacts at the start of a step.
    pub(super) fn settle(&mut self, step: &Step<'_, T>, law: &mut ResampledLaw, sums: &mut Sums<T>) {
        self.evaluate_at(step, law, &step.path.at(0.0), 0.0);
        self.check(step, law, 0.0, sums);
        self.stiffness = self.end.stiffness;
        self.add_up(step, sums);
    }

    /// Puts the elements where they are after a share of the step: the side `end`.
    #[inline(always)]
    fn evaluate_at(&mut self, step: &Step<'_, T>, law: &mut ResampledLaw, now: &Instant<T>, share: f64) {
        let is_tread = matches!(step.face, Face::Tread(_));
        self.end.place(step, self.start, self.count, step.run.at(share));
        self.end.move_to(now, is_tread.then_some(step.tread_speed));
        self.end.is_free = self.end.is_clear(law);
        if self.end.is_free { self.end.clear() } else { self.end.look_up(law) }
    }

    /// Takes the springs through a part.
    #[inline(always)]
    fn pass_part(
        &mut self,
        step: &Step<'_, T>,
        law: &mut ResampledLaw,
        (now, next): (&Instant<T>, &Instant<T>),
        part: f64,
    ) {
        if self.begin.is_free && self.end.is_free && self.stiffness.iter().all(|k| k.value() == 0.0) {
            return;
        }
        let displacement = self.displacements(step, (now, next), part);
        let Self { force, stiffness, slips, slip, release, begin, end, count, .. } = self;
        leap_all(force, stiffness, release, begin);
        let before = *force;
        pass_all(force, slips, (slip, release), (begin, end), &displacement);
        for i in 0..*count {
            if is_cut(begin.pressure[i].value(), end.pressure[i].value()) {
                let displacement = [displacement[0][i], displacement[1][i]];
                let ends = (&begin.end(i), &end.end(i));
                let advanced = advance_in_segments(law, [before[0][i], before[1][i]], ends, displacement);
                (force[0][i], force[1][i]) = (advanced.force[0], advanced.force[1]);
                slips[i] = if advanced.slips { 1.0 } else { 0.0 };
                slip[i] += advanced.slip;
                release[i] += advanced.release;
            }
        }
        *stiffness = end.stiffness;
    }

    /// How far the face's material goes along the plane in a part, m.
    #[inline(always)]
    fn displacements(&self, step: &Step<'_, T>, (now, next): (&Instant<T>, &Instant<T>), part: f64) -> [Lanes<T>; 2] {
        let (begin, end) = (&*self.begin, &*self.end);
        let mut displacement = [[T::constant(0.0); BLOCK]; 2];
        for axis in 0..2 {
            let moved = next.moved[axis] - now.moved[axis];
            for i in 0..BLOCK {
                displacement[axis][i] = moved + (end.arm[axis][i] - begin.arm[axis][i]);
            }
        }
        if let Face::Tread(tread) = step.face {
            // Where a cell is partly inside, its middle does not go as far as its material.
            let run = step.run.by * part * tread.cell;
            for axis in 0..2 {
                for i in 0..BLOCK {
                    let rest = run + (end.arc[i] - begin.arc[i]);
                    let along = (begin.along[axis][i] + end.along[axis][i]).times(0.5 * rest);
                    displacement[axis][i] = displacement[axis][i] - along;
                }
            }
        }
        displacement
    }

    /// Takes note of an element beyond the table.
    #[inline(always)]
    fn check(&self, step: &Step<'_, T>, law: &ResampledLaw, share: f64, sums: &mut Sums<T>) {
        if self.end.is_free {
            return;
        }
        let (pressure, speed) = (law.largest_pressure() * (1.0 + ROUNDING), law.largest_speed() * (1.0 + ROUNDING));
        let speed_of = |i: usize| {
            let [x, y] = [0, 1].map(|axis| self.end.velocity[axis][i].value());
            x * x + y * y
        };
        let mut found = false;
        for i in 0..BLOCK {
            let p = self.end.pressure[i].value();
            found |= (p > pressure) | ((p > 0.0) & (speed_of(i) > speed * speed));
        }
        if !found || sums.beyond.is_some_and(|beyond| beyond.share <= share) {
            return;
        }
        let beyond = |i: usize| {
            let (p, v) = (self.end.pressure[i].value(), speed_of(i).sqrt());
            let bears = p > 0.0 && self.end.area[i] > 0.0;
            let element = step.index_at(self.start + i, share);
            (bears && (p > pressure || v > speed)).then_some(Beyond { element, share, pressure: p, speed: v })
        };
        sums.beyond = (0..self.count).find_map(beyond).or(sums.beyond);
    }

    /// Adds to the wrench on the body and to the losses.
    #[inline(always)]
    fn add_up(&mut self, step: &Step<'_, T>, sums: &mut Sums<T>) {
        let end = &*self.end;
        sums.slip += total(&self.slip);
        sums.release += total(&self.release);
        if end.is_free {
            self.mode.fill(0);
            return;
        }
        let mut loads = [[T::constant(0.0); BLOCK]; 7];
        for i in 0..BLOCK {
            let (f_x, f_y) = (-self.force[0][i], -self.force[1][i]);
            let f_z = end.pressure[i].times(end.area[i]);
            let (x, y, z) = (end.arm[0][i], end.arm[1][i], end.arm[2][i]);
            (loads[0][i], loads[1][i], loads[2][i]) = (f_x, f_y, f_z);
            loads[3][i] = y * f_z - z * f_y;
            loads[4][i] = z * f_x - x * f_z;
            loads[5][i] = x * f_y - y * f_x;
        }
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
            let mode = if self.slips[i] > 0.0 { 1 } else { 2 };
            self.mode[i] = if end.stiffness[i].value() > 0.0 { mode } else { 0 };
        }
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

/// Lets all springs of a block follow a jump of the law to that of a side.
#[inline(always)]
fn leap_all<T: Number>(force: &mut [Lanes<T>; 2], stiffness: &Lanes<T>, release: &mut Lanes<f64>, side: &Side<T>) {
    for i in 0..BLOCK {
        let (jumped, lost) = apply_jump([force[0][i], force[1][i]], stiffness[i], &side.law(i));
        (force[0][i], force[1][i]) = (jumped[0], jumped[1]);
        release[i] += lost;
    }
}

/// Takes all springs of a block through a part; the losses of those that are cut for themselves are left out.
#[inline(always)]
fn pass_all<T: Number>(
    force: &mut [Lanes<T>; 2],
    slips: &mut Lanes<f64>,
    (slip, release): (&mut Lanes<f64>, &mut Lanes<f64>),
    (begin, end): (&Side<T>, &Side<T>),
    displacement: &[Lanes<T>; 2],
) {
    for i in 0..BLOCK {
        let before = [begin.velocity[0][i], begin.velocity[1][i]];
        let after = [end.velocity[0][i], end.velocity[1][i]];
        let segment = Segment {
            begin: begin.law(i),
            end: end.law(i),
            displacement: [displacement[0][i], displacement[1][i]],
            half_turn: half_turn(before, after),
        };
        let advanced = advance([force[0][i], force[1][i]], &segment);
        let kept = if is_cut(begin.pressure[i].value(), end.pressure[i].value()) { 0.0 } else { 1.0 };
        (force[0][i], force[1][i]) = (advanced.force[0], advanced.force[1]);
        slips[i] = if advanced.slips { 1.0 } else { 0.0 };
        slip[i] += kept * advanced.slip;
        release[i] += kept * advanced.release;
    }
}

/// Share of the table's speeds and pressures by which an element may exceed them: rounding.
const ROUNDING: f64 = 1e-9;

/// Whether an element is cut for itself in a part with these pressures at its ends.
#[inline(always)]
fn is_cut(before: f64, after: f64) -> bool {
    (before > MAX_RATIO * after) | (after > MAX_RATIO * before)
}
