//! A block of elements that a step is done for together: in structure of arrays and, where possible, loops without
//! branches.

use super::face::{Face, TreadColumn};
use super::heat::{self, BlockHeat, StepHeat};
use super::lanes::{BLOCK, Lanes, lanes_of};
use super::motion::{BodyKinematics, PoseMotion, Substep, Substeps, TreadMotion};
use super::segments::{Endpoint, advance_in_segments, half_turn, size};
use crate::element::{LawPoints, ROUNDING, ResampledLaw, Segment, SpeedCell, SpringLaw, advance, apply_jump};
use crate::math::{Dual, Number};

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

/// The motion of the face and of its tread through a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct FaceMotion<'a, T> {
    pub(super) face: &'a Face,
    pub(super) body: PoseMotion<T>,
    pub(super) tread: TreadMotion,
    pub(super) substeps: Substeps,
    /// The speed at which the tread runs, m/s.
    pub(super) tread_speed: f64,
    /// Where slip warms the elements.
    pub(super) heat: Option<StepHeat>,
}

/// The elements that a step takes in, by their indices before it.
#[derive(Clone, Copy, Debug)]
pub(super) struct ElementRange {
    /// The index of the first.
    pub(super) first: isize,
    /// How many there are.
    pub(super) count: usize,
    /// By how much indices grow over the step.
    pub(super) shift: isize,
}

/// What the blocks add up to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums<T> {
    /// Force (N) and moment (N m) on the body at the end, in the ground's axes about the pose's point.
    pub(super) wrench: [T; 6],
    /// Force on the tread, N.
    pub(super) transport: T,
    /// Energy lost in the step by slip, J.
    pub(super) slip: f64,
    /// Energy lost in the step with contacts that were released, J.
    pub(super) release: f64,
    /// The first element found beyond the table.
    pub(super) beyond: Option<BeyondTable>,
    /// The first element found warmer than the table.
    pub(super) too_warm: Option<TooWarm>,
}

/// An element that is warmer than the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TooWarm {
    /// Its index, as elements are counted at that instant.
    pub(super) element: usize,
    /// When: the fraction of the step.
    pub(super) fraction: f64,
    /// By how much it is warmer than the temperature given, K.
    pub(super) rise: f64,
}

/// An element beyond the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BeyondTable {
    /// Its index, as elements are counted at that instant.
    pub(super) element: usize,
    /// When: the fraction of the step.
    pub(super) fraction: f64,
    /// The pressure on it, Pa.
    pub(super) pressure: f64,
    /// Its speed along the plane, m/s.
    pub(super) speed: f64,
}

impl<'a> FaceMotion<'a, f64> {
    /// The same motion with derivatives by the changes of the body's coordinates.
    pub(super) fn with_tangents(&self) -> FaceMotion<'a, Dual<6>> {
        let Self { face, body, tread, substeps, tread_speed, heat } = *self;
        let PoseMotion { start, change, duration } = body;
        let change = std::array::from_fn(|i| Dual::variable(change[i], i));
        FaceMotion { face, body: PoseMotion { start, change, duration }, tread, substeps, tread_speed, heat }
    }
}

impl<T> FaceMotion<'_, T> {
    pub(super) fn elements(&self) -> ElementRange {
        match self.face {
            Face::Points(_) => ElementRange { first: 0, count: self.face.count(), shift: 0 },
            Face::Tread(tread) => {
                let (rows, (first, columns)) = (tread.rows.len(), tread.columns_of(self.tread));
                let indices = |columns: f64| columns as isize * rows as isize;
                let shift = indices(self.tread.whole_cells());
                ElementRange { first: indices(first), count: columns * rows, shift }
            }
        }
    }

    /// The index after a fraction of the step of an element as it is counted in the step.
    fn index_at(&self, element: usize, fraction: f64) -> usize {
        let Face::Tread(tread) = self.face else { return element };
        let columns = tread.columns_of(self.tread).0 + self.tread.entered_at(fraction).floor();
        element.saturating_add_signed(columns as isize * tread.rows.len() as isize).min(self.face.count() - 1)
    }

    /// Whether some of the `count` elements from `start` on are on the face in a substep.
    #[inline(always)]
    fn is_inside(&self, start: usize, count: usize, substep: Substep) -> bool {
        let Face::Tread(tread) = self.face else { return true };
        let (rows, first) = (tread.rows.len(), tread.columns_of(self.tread).0);
        let [front, rear] = [start, start + count - 1].map(|element| first + (element / rows) as f64);
        let (before, after) = (self.tread.entered_at(substep.begin), self.tread.entered_at(substep.end));
        // Column i is inside while it and the cells that have entered are between 0 and one more than the columns.
        rear + before.max(after) > 0.0 && front + before.min(after) < tread.columns as f64 + 1.0
    }
}

impl<T: Number> Sums<T> {
    pub(super) fn zero() -> Self {
        let zero = T::constant(0.0);
        Self { wrench: [zero; 6], transport: zero, slip: 0.0, release: 0.0, beyond: None, too_warm: None }
    }

    /// Adds those of elements that follow.
    pub(super) fn add(&mut self, further: &Self) {
        for (sum, load) in self.wrench.iter_mut().zip(&further.wrench) {
            *sum = *sum + *load;
        }
        self.transport = self.transport + further.transport;
        self.slip += further.slip;
        self.release += further.release;
        if further.beyond.is_some_and(|theirs| self.beyond.is_none_or(|own| theirs.fraction < own.fraction)) {
            self.beyond = further.beyond;
        }
        if further.too_warm.is_some_and(|theirs| self.too_warm.is_none_or(|own| theirs.fraction < own.fraction)) {
            self.too_warm = further.too_warm;
        }
    }

    /// The sums without their derivatives.
    pub(super) fn values(&self) -> Sums<f64> {
        let Self { wrench, transport, slip, release, beyond, too_warm } = *self;
        Sums { wrench: wrench.map(T::value), transport: transport.value(), slip, release, beyond, too_warm }
    }
}

/// The elements of a block at an instant: where they are, how they move, and the contact law there.
#[derive(Clone, Debug)]
struct BlockContacts<T> {
    /// How many elements there are.
    count: usize,
    /// Positions in the body's axes, m.
    place: [Lanes<f64>; 3],
    /// Of a tread: the direction of the arc in x and z.
    direction: [Lanes<f64>; 2],
    /// Of a tread: where on the arc the middle of an element is, m.
    arc: Lanes<f64>,
    /// Areas, m².
    area: Lanes<f64>,
    /// From the pose's point, in the ground's axes, m.
    arm: [Lanes<T>; 3],
    /// Of a tread: the direction of the arc in the ground's axes.
    along: [Lanes<T>; 3],
    /// How far the elements are below the plane z = 0, m.
    approach: Lanes<T>,
    /// Along the plane, m/s.
    velocity: [Lanes<T>; 2],
    /// ln v, v in m/s, limited to the speeds of the table.
    log_speed: Lanes<T>,
    /// How much warmer than the temperature given the law is, K.
    rise: Lanes<T>,
    /// Whether no element can be in contact: then the pressure, the limit and the stiffness are 0.
    is_free: bool,
    /// Pressure, Pa.
    pressure: Lanes<T>,
    /// Limit of the friction force, N.
    limit: Lanes<T>,
    /// Tangential stiffness, N/m.
    stiffness: Lanes<T>,
}

/// The workspace of a block.
#[derive(Clone, Debug)]
pub(super) struct Block<T> {
    /// The first element as it is counted in the step.
    start: usize,
    /// How many elements there are.
    count: usize,
    /// G, the forces of the springs on the ground, N.
    pub(super) force: [Lanes<T>; 2],
    /// K, the stiffnesses of the springs, N/m.
    pub(super) stiffness: Lanes<T>,
    /// By the numbers of [`ElementMode`].
    pub(super) mode: Lanes<u8>,
    /// At the beginning of the substep.
    begin: Box<BlockContacts<T>>,
    /// At the end of the substep, or at the instant last evaluated.
    end: Box<BlockContacts<T>>,
    /// Where slip warms the elements: how warm they are.
    pub(super) heat: BlockHeat<T>,
    /// Energy lost in the part by slip, J.
    part_slip: Lanes<T>,
    /// 1 for those that slip, else 0.
    slips: Lanes<f64>,
    /// Energy lost in the step by slip, J.
    slip: Lanes<f64>,
    /// Energy lost in the step with contacts that were released, J.
    release: Lanes<f64>,
}

impl<T: Number> BlockContacts<T> {
    fn new() -> Self {
        let zero = [T::constant(0.0); BLOCK];
        Self {
            count: 0,
            place: [[0.0; BLOCK]; 3],
            direction: [[0.0; BLOCK]; 2],
            arc: [0.0; BLOCK],
            area: [0.0; BLOCK],
            arm: [zero; 3],
            along: [zero; 3],
            approach: zero,
            velocity: [zero; 2],
            log_speed: zero,
            rise: zero,
            is_free: true,
            pressure: zero,
            limit: zero,
            stiffness: zero,
        }
    }

    /// Places the elements from `start` on when `entered` cells of a tread have entered since the start of the step.
    #[inline(always)]
    fn set_positions(&mut self, step: &FaceMotion<'_, T>, start: usize, count: usize, entered: f64) {
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
                let (rows, first) = (tread.rows.len(), tread.columns_of(step.tread).0);
                let mut column = TreadColumn::default();
                self.area[count..].fill(0.0);
                for i in 0..count {
                    let row = (start + i) % rows;
                    if i == 0 || row == 0 {
                        column = tread.column(first + ((start + i) / rows) as f64, entered);
                    }
                    let TreadColumn { arc, place: [x, z], direction, share } = column;
                    (self.place[0][i], self.place[1][i], self.place[2][i]) = (x, tread.rows[row], z);
                    (self.direction[0][i], self.direction[1][i]) = (direction[0], direction[1]);
                    (self.arc[i], self.area[i]) = (arc, tread.area * share);
                }
            }
        }
    }

    /// Finds how the elements move with the body; a tread runs through the face at `tread_speed` (m/s).
    #[inline(always)]
    fn set_motion(&mut self, now: &BodyKinematics<T>, tread_speed: Option<f64>) {
        for i in 0..BLOCK {
            let arm = now.turned([self.place[0][i], self.place[1][i], self.place[2][i]]);
            let velocity = now.velocity(arm);
            self.approach[i] = -(now.height + arm[2]);
            (self.arm[0][i], self.arm[1][i], self.arm[2][i]) = (arm[0], arm[1], arm[2]);
            (self.velocity[0][i], self.velocity[1][i]) = (velocity[0], velocity[1]);
        }
        let Some(speed) = tread_speed else { return };
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

    /// Looks the law up, in whole vectors. The lanes behind the last element have no area; those behind the last vector
    /// keep the 0 that `reset` gave them.
    #[inline(always)]
    fn look_up(&mut self, law: &mut ResampledLaw) {
        let range = law.range();
        for i in 0..lanes_of(self.count) {
            self.log_speed[i] = range.logarithm(size([self.velocity[0][i], self.velocity[1][i]]));
        }
        if law.has_planes() {
            return self.look_up_between_planes(law);
        }
        let mut cells = [SpeedCell::default(); BLOCK];
        for i in 0..lanes_of(self.count) {
            cells[i] = law.speed_cell(self.log_speed[i].value());
        }
        self.look_up_in(law, &cells);
    }

    /// Looks the law up in these cells.
    #[inline(always)]
    fn look_up_in(&mut self, law: &ResampledLaw, cells: &[SpeedCell; BLOCK]) {
        let lanes = lanes_of(self.count);
        let LawPoints { log_pressure, factor, friction, stiffness } =
            law.points(lanes, cells, &self.log_speed, &self.approach);
        for i in 0..lanes {
            let pressure = log_pressure[i].exp() * factor[i];
            self.pressure[i] = pressure;
            self.limit[i] = (pressure * friction[i]).times(self.area[i]);
            self.stiffness[i] = stiffness[i].times(self.area[i]);
        }
    }

    /// Looks the law up where every element has its temperature: straight between the planes below and above it.
    #[inline(always)]
    fn look_up_between_planes(&mut self, law: &mut ResampledLaw) {
        let (mut below, mut above) = ([SpeedCell::default(); BLOCK], [SpeedCell::default(); BLOCK]);
        let mut fraction = [T::constant(0.0); BLOCK];
        for i in 0..lanes_of(self.count) {
            if let Some((cells, way)) = law.cells_between_planes(self.log_speed[i].value(), self.rise[i]) {
                (below[i], above[i], fraction[i]) = (cells[0], cells[1], way);
            }
        }
        self.look_up_in(law, &above);
        let (pressure, limit, stiffness) = (self.pressure, self.limit, self.stiffness);
        self.look_up_in(law, &below);
        for i in 0..lanes_of(self.count) {
            self.pressure[i] = self.pressure[i] + (pressure[i] - self.pressure[i]) * fraction[i];
            self.limit[i] = self.limit[i] + (limit[i] - self.limit[i]) * fraction[i];
            self.stiffness[i] = self.stiffness[i] + (stiffness[i] - self.stiffness[i]) * fraction[i];
        }
    }

    /// No element is in contact.
    fn clear(&mut self) {
        let zero = [T::constant(0.0); BLOCK];
        (self.pressure, self.limit, self.stiffness) = (zero, zero, zero);
    }

    #[inline(always)]
    fn law(&self, i: usize) -> SpringLaw<T> {
        SpringLaw { stiffness: self.stiffness[i], limit: self.limit[i] }
    }

    fn endpoint(&self, i: usize) -> Endpoint<T> {
        Endpoint {
            approach: self.approach[i],
            velocity: [self.velocity[0][i], self.velocity[1][i]],
            area: self.area[i],
            rise: self.rise[i],
        }
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
            begin: Box::new(BlockContacts::new()),
            end: Box::new(BlockContacts::new()),
            heat: BlockHeat::new(),
            part_slip: zero,
            slips: [0.0; BLOCK],
            slip: [0.0; BLOCK],
            release: [0.0; BLOCK],
        }
    }

    /// Makes it the block of the `count` elements from `start` on, as they are counted in the step, with no springs
    /// yet and cold.
    pub(super) fn reset(&mut self, start: usize, count: usize) {
        (self.start, self.count) = (start, count);
        let zero = [T::constant(0.0); BLOCK];
        (self.force, self.stiffness) = ([zero; 2], zero);
        self.heat.reset();
        self.slips = [0.0; BLOCK];
        (self.slip, self.release) = ([0.0; BLOCK], [0.0; BLOCK]);
        // Both, since the law is not looked up in all lanes.
        for contacts in [&mut self.begin, &mut self.end] {
            contacts.count = count;
            contacts.place.iter_mut().for_each(|lanes| lanes[count..].fill(0.0));
            contacts.is_free = true;
            contacts.clear();
        }
    }

    /// Does the step for the block's elements and adds to the sums.
    #[inline(always)]
    pub(super) fn advance(&mut self, step: &FaceMotion<'_, T>, law: &mut ResampledLaw, sums: &mut Sums<T>) {
        let mut now = step.body.at(0.0);
        // Whether `end` holds the elements at the begin of the substep.
        let mut is_evaluated = false;
        for substep in step.substeps.iter() {
            if !step.is_inside(self.start, self.count, substep) {
                is_evaluated = false;
                continue;
            }
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
        std::mem::swap(&mut self.begin, &mut self.end);
        self.evaluate_at(step, law, &next, part.end);
        self.advance_springs(step, law, (now, &next), part.length());
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
        sums: &mut Sums<T>,
    ) -> BodyKinematics<T> {
        let (mut begin, mut length) = (substep.begin, substep.length());
        while begin < substep.end {
            let end = if begin + length < substep.end { begin + length } else { substep.end };
            let part = Substep { begin, end };
            // The law follows the temperatures at which the part begins.
            let before = (self.force, self.stiffness, self.slips, self.slip, self.release, self.heat.of_law);
            let rise = heat::total(&self.heat.parts);
            self.heat.of_law = rise;
            let next = self.advance_part(step, law, &now, part);
            let warmed = self.warmed(heat, part.length() * step.body.duration);
            // Too long a part is done again, half as long.
            if self.warms_too_much(heat, &rise, &heat::total(&warmed)) && length > SHORTEST_PART * substep.length() {
                std::mem::swap(&mut self.begin, &mut self.end);
                (self.force, self.stiffness, self.slips, self.slip, self.release, self.heat.of_law) = before;
                length *= 0.5;
                continue;
            }
            self.heat.parts = warmed;
            self.check_temperatures(step, heat, end, sums);
            (now, begin) = (next, end);
            length *= 2.0;
        }
        now
    }

    /// The temperatures after the part just done, by their terms.
    #[inline(always)]
    fn warmed(&mut self, heat: &StepHeat, duration: f64) -> heat::Rises<T> {
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
        let mut found = false;
        for i in 0..BLOCK {
            let bears = self.begin.stiffness[i].value() + self.end.stiffness[i].value() > 0.0;
            found |= bears & ((within(after[i]) - within(before[i])).abs() > heat::MAX_CHANGE);
        }
        found
    }

    /// Records the first element in contact that is warmer than the table, after a fraction of the step.
    #[inline(always)]
    fn check_temperatures(&self, step: &FaceMotion<'_, T>, heat: &StepHeat, fraction: f64, sums: &mut Sums<T>) {
        if self.end.is_free || sums.too_warm.is_some_and(|warm| warm.fraction <= fraction) {
            return;
        }
        let rises = heat::total(&self.heat.parts);
        let most = heat.range.1 * (1.0 + ROUNDING);
        let too_warm = |i: usize| {
            let rise = rises[i].value();
            let element = step.index_at(self.start + i, fraction);
            (self.end.stiffness[i].value() > 0.0 && rise > most).then_some(TooWarm { element, fraction, rise })
        };
        sums.too_warm = (0..self.count).find_map(too_warm).or(sums.too_warm);
    }

    /// Gives the springs, relaxed, the stiffness of their contacts at the start of a step.
    pub(super) fn initialize(&mut self, step: &FaceMotion<'_, T>, law: &mut ResampledLaw, sums: &mut Sums<T>) {
        self.evaluate_at(step, law, &step.body.at(0.0), 0.0);
        self.check_table(step, law, 0.0, sums);
        self.stiffness = self.end.stiffness;
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
        self.end.set_motion(now, is_tread.then_some(step.tread_speed));
        self.end.rise = self.heat.of_law;
        self.end.is_free = self.end.is_clear(law);
        if self.end.is_free { self.end.clear() } else { self.end.look_up(law) }
    }

    /// Takes the springs from `begin` to `end`, a fraction `length` of the step later.
    #[inline(always)]
    fn advance_springs(
        &mut self,
        step: &FaceMotion<'_, T>,
        law: &mut ResampledLaw,
        (now, next): (&BodyKinematics<T>, &BodyKinematics<T>),
        length: f64,
    ) {
        self.part_slip = [T::constant(0.0); BLOCK];
        if self.begin.is_free && self.end.is_free && self.stiffness.iter().all(|k| k.value() == 0.0) {
            return;
        }
        // All elements as if their pressures changed in one segment.
        let displacement = self.displacements(step, (now, next), length);
        let Self { force, stiffness, slips, part_slip, slip, release, begin, end, count, .. } = self;
        apply_jumps(force, stiffness, release, begin);
        let before = *force;
        advance_all(force, slips, (part_slip, release), (begin, end), &displacement);
        // Those whose pressure changes by too large a factor once more, in segments.
        for i in 0..*count {
            if needs_segments(begin.pressure[i].value(), end.pressure[i].value()) {
                let displacement = [displacement[0][i], displacement[1][i]];
                let ends = (&begin.endpoint(i), &end.endpoint(i));
                let advanced = advance_in_segments(law, [before[0][i], before[1][i]], ends, displacement);
                (force[0][i], force[1][i]) = (advanced.force[0], advanced.force[1]);
                slips[i] = if advanced.slips { 1.0 } else { 0.0 };
                part_slip[i] = advanced.slip;
                release[i] += advanced.release;
            }
        }
        for i in 0..BLOCK {
            slip[i] += part_slip[i].value();
        }
        *stiffness = end.stiffness;
    }

    /// How far the face's material goes along the plane from `begin` to `end`, m.
    #[inline(always)]
    fn displacements(
        &self,
        step: &FaceMotion<'_, T>,
        (now, next): (&BodyKinematics<T>, &BodyKinematics<T>),
        length: f64,
    ) -> [Lanes<T>; 2] {
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
            let travel = step.tread.travel * length * tread.cell;
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
    fn check_table(&self, step: &FaceMotion<'_, T>, law: &ResampledLaw, fraction: f64, sums: &mut Sums<T>) {
        if self.end.is_free {
            return;
        }
        let limits = law.limits();
        let speed_of = |i: usize| {
            let [x, y] = [0, 1].map(|axis| self.end.velocity[axis][i].value());
            x * x + y * y
        };
        let mut found = false;
        for i in 0..BLOCK {
            let p = self.end.pressure[i].value();
            found |= (p > limits.pressure) | ((p > 0.0) & (speed_of(i) > limits.speed * limits.speed));
        }
        if !found || sums.beyond.is_some_and(|beyond| beyond.fraction <= fraction) {
            return;
        }
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
    fn add_up(&mut self, step: &FaceMotion<'_, T>, sums: &mut Sums<T>) {
        let end = &*self.end;
        sums.slip += total(&self.slip);
        sums.release += total(&self.release);
        if end.is_free {
            self.mode.fill(ElementMode::Free as u8);
            return;
        }
        // Forces on the body, their moments about the pose's point, and the force along the tread.
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
            let mode = if self.slips[i] > 0.0 { ElementMode::Slipping } else { ElementMode::Sticking };
            self.mode[i] = if end.stiffness[i].value() > 0.0 { mode as u8 } else { ElementMode::Free as u8 };
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

/// Lets all springs of a block follow a jump of their law to that of `contacts`.
#[inline(always)]
fn apply_jumps<T: Number>(
    force: &mut [Lanes<T>; 2],
    stiffness: &Lanes<T>,
    release: &mut Lanes<f64>,
    contacts: &BlockContacts<T>,
) {
    for i in 0..BLOCK {
        let (jumped, lost) = apply_jump([force[0][i], force[1][i]], stiffness[i], &contacts.law(i));
        (force[0][i], force[1][i]) = (jumped[0], jumped[1]);
        release[i] += lost;
    }
}

/// Takes all springs of a block from `begin` to `end` in one segment each; the losses of those that need segments of
/// their own are left out.
#[inline(always)]
fn advance_all<T: Number>(
    force: &mut [Lanes<T>; 2],
    slips: &mut Lanes<f64>,
    (slip, release): (&mut Lanes<T>, &mut Lanes<f64>),
    (begin, end): (&BlockContacts<T>, &BlockContacts<T>),
    displacement: &[Lanes<T>; 2],
) {
    for i in 0..lanes_of(end.count) {
        let before = [begin.velocity[0][i], begin.velocity[1][i]];
        let after = [end.velocity[0][i], end.velocity[1][i]];
        let segment = Segment {
            begin: begin.law(i),
            end: end.law(i),
            displacement: [displacement[0][i], displacement[1][i]],
            half_turn: half_turn(before, after),
        };
        let advanced = advance([force[0][i], force[1][i]], &segment);
        let kept = if needs_segments(begin.pressure[i].value(), end.pressure[i].value()) { 0.0 } else { 1.0 };
        (force[0][i], force[1][i]) = (advanced.force[0], advanced.force[1]);
        slips[i] = if advanced.slips { 1.0 } else { 0.0 };
        slip[i] = advanced.slip.times(kept);
        release[i] += kept * advanced.release;
    }
}

/// Share of a substep below which it is not cut further for heat.
const SHORTEST_PART: f64 = 1e-9;

/// Whether an element is advanced in segments of its own in a substep with these pressures at its beginning and end.
#[inline(always)]
fn needs_segments(before: f64, after: f64) -> bool {
    (before > MAX_RATIO * after) | (after > MAX_RATIO * before)
}
