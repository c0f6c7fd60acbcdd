//! The elements of a block at an instant, and the motion of their face through a step: where they are, how they move, and what the contact law makes of it.

use std::sync::atomic::{AtomicU64, Ordering};

use super::face::{BLOCK, Face, Lanes, TreadColumn, lanes_of};
use super::heat::StepHeat;
use super::motion::{BodyKinematics, PoseMotion, Substep, Substeps, TreadMotion, size};
use crate::element::{LawPlace, LawPoints, ResampledLaw, SpringLaw};
use crate::math::{Dual, Number};

/// The elements of a block at an instant: where they are, how they move, and the contact law there.
#[derive(Clone, Debug)]
pub(super) struct BlockContacts<T> {
    /// How many elements there are.
    pub(super) count: usize,
    /// Positions in the body's axes, m.
    pub(super) place: [Lanes<f64>; 3],
    /// Of a tread: the direction of the arc in x and z.
    pub(super) direction: [Lanes<f64>; 2],
    /// Of a tread: where on the arc the middle of an element is, m.
    pub(super) arc: Lanes<f64>,
    /// Areas, m².
    pub(super) area: Lanes<f64>,
    /// From the pose's point, in the ground's axes, m.
    pub(super) arm: [Lanes<T>; 3],
    /// Of a tread: the direction of the arc in the ground's axes.
    pub(super) along: [Lanes<T>; 3],
    /// How far the elements are below the plane z = 0, m.
    pub(super) approach: Lanes<T>,
    /// Along the plane, m/s.
    pub(super) velocity: [Lanes<T>; 2],
    /// ln v, v in m/s, limited to the speeds of the table.
    pub(super) log_speed: Lanes<T>,
    /// How much warmer than the temperature given the law is, K.
    pub(super) rise: Lanes<T>,
    /// Whether no element can be in contact: then the pressure, the limit and the stiffness are 0.
    pub(super) is_free: bool,
    /// Pressure, Pa.
    pub(super) pressure: Lanes<T>,
    /// Limit of the friction force, N.
    pub(super) limit: Lanes<T>,
    /// Tangential stiffness, N/m.
    pub(super) stiffness: Lanes<T>,
}

impl<T: Number> BlockContacts<T> {
    pub(super) fn new() -> Self {
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
    pub(super) fn set_positions(&mut self, step: &FaceMotion<'_, T>, start: usize, count: usize, entered: f64) {
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
    pub(super) fn set_motion(&mut self, now: &BodyKinematics<T>, tread_speed: Option<f64>) {
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
    pub(super) fn is_clear(&self, law: &ResampledLaw) -> bool {
        let touch = law.earliest_touch();
        self.approach.iter().fold(f64::NEG_INFINITY, |most, a| if a.value() > most { a.value() } else { most }) <= touch
    }

    /// Looks the law up, in whole vectors. The lanes behind the last element have no area; those behind the last vector
    /// keep the 0 that `reset` gave them.
    #[inline(always)]
    pub(super) fn look_up(&mut self, law: &mut ResampledLaw) {
        let (range, lanes) = (law.range(), lanes_of::<T>(self.count));
        for i in 0..lanes {
            self.log_speed[i] = range.logarithm(size([self.velocity[0][i], self.velocity[1][i]]));
        }
        let mut places = [LawPlace::first(); BLOCK];
        for i in 0..lanes {
            places[i] = law.place(self.log_speed[i], self.rise[i]);
        }
        let LawPoints { log_pressure, factor, friction, stiffness } = law.points(lanes, &places, &self.approach);
        for i in 0..lanes {
            let pressure = log_pressure[i].exp() * factor[i];
            self.pressure[i] = pressure;
            self.limit[i] = (pressure * friction[i]).times(self.area[i]);
            self.stiffness[i] = stiffness[i].times(self.area[i]);
        }
    }

    /// No element is in contact.
    pub(super) fn clear(&mut self) {
        let zero = [T::constant(0.0); BLOCK];
        (self.pressure, self.limit, self.stiffness) = (zero, zero, zero);
    }

    #[inline(always)]
    pub(super) fn law(&self, i: usize) -> SpringLaw<T> {
        SpringLaw { stiffness: self.stiffness[i], limit: self.limit[i] }
    }

    /// Along the plane, m/s.
    #[inline(always)]
    pub(super) fn velocity_of(&self, i: usize) -> [T; 2] {
        [self.velocity[0][i], self.velocity[1][i]]
    }
}

/// What the blocks add up to.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepSums<T> {
    /// Force (N) and moment (N m) on the body at the end, in the ground's axes about the pose's point.
    pub(super) wrench: [T; 6],
    /// Force on the tread, N.
    pub(super) transport: T,
    /// Energy lost in the step by slip, J.
    pub(super) slip: f64,
    /// Energy lost in the step with contacts that were released, J.
    pub(super) release: f64,
    /// Energy lost in the step by dampers, J.
    pub(super) damper: f64,
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

impl<T: Number> StepSums<T> {
    pub(super) fn zero() -> Self {
        let zero = T::constant(0.0);
        Self { wrench: [zero; 6], transport: zero, slip: 0.0, release: 0.0, damper: 0.0, beyond: None, too_warm: None }
    }

    /// Adds those of elements that follow.
    pub(super) fn add(&mut self, further: &Self) {
        for (sum, load) in self.wrench.iter_mut().zip(&further.wrench) {
            *sum = *sum + *load;
        }
        self.transport = self.transport + further.transport;
        self.slip += further.slip;
        self.release += further.release;
        self.damper += further.damper;
        if further.beyond.is_some_and(|theirs| self.beyond.is_none_or(|own| theirs.fraction < own.fraction)) {
            self.beyond = further.beyond;
        }
        if further.too_warm.is_some_and(|theirs| self.too_warm.is_none_or(|own| theirs.fraction < own.fraction)) {
            self.too_warm = further.too_warm;
        }
    }

    /// The sums without their derivatives.
    pub(super) fn values(&self) -> StepSums<f64> {
        let Self { wrench, transport, slip, release, damper, beyond, too_warm } = *self;
        StepSums { wrench: wrench.map(T::value), transport: transport.value(), slip, release, damper, beyond, too_warm }
    }
}

/// The dampers of the elements: τ of each, s; 0 where there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Damping {
    /// Beside the springs along the plane.
    pub(super) shear: f64,
    /// Beside the backing along the normal.
    pub(super) normal: f64,
}

/// The motion of the face and of its tread through a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct FaceMotion<'a, T> {
    pub(super) face: &'a Face,
    pub(super) body: PoseMotion<T>,
    pub(super) tread: TreadMotion,
    pub(super) substeps: Substeps,
    /// Where slip warms the elements.
    pub(super) heat: Option<StepHeat>,
    pub(super) damping: Damping,
    pub(super) work: &'a WorkCounter,
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

impl<'a> FaceMotion<'a, f64> {
    /// The same motion with derivatives by the changes of the body's coordinates.
    pub(super) fn with_tangents(&self) -> FaceMotion<'a, Dual<6>> {
        let Self { face, body, tread, substeps, heat, damping, work } = *self;
        let PoseMotion { start, change, duration } = body;
        let change = std::array::from_fn(|i| Dual::variable(change[i], i));
        FaceMotion { face, body: PoseMotion { start, change, duration }, tread, substeps, heat, damping, work }
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
    pub(super) fn index_at(&self, element: usize, fraction: f64) -> usize {
        let Face::Tread(tread) = self.face else { return element };
        let columns = tread.columns_of(self.tread).0 + self.tread.entered_at(fraction).floor();
        element.saturating_add_signed(columns as isize * tread.rows.len() as isize).min(self.face.count() - 1)
    }

    /// Whether some of the `count` elements from `start` on are on the face in a substep.
    #[inline(always)]
    pub(super) fn is_inside(&self, start: usize, count: usize, substep: Substep) -> bool {
        let Face::Tread(tread) = self.face else { return true };
        let (rows, first) = (tread.rows.len(), tread.columns_of(self.tread).0);
        let [front, rear] = [start, start + count - 1].map(|element| first + (element / rows) as f64);
        let (before, after) = (self.tread.entered_at(substep.begin), self.tread.entered_at(substep.end));
        // Column i is inside while it and the cells that have entered are between 0 and one more than the columns.
        rear + before.max(after) > 0.0 && front + before.min(after) < tread.columns as f64 + 1.0
    }
}

/// What the elements of a step have been through: parts of it and, where their pressures change much, segments.
///
/// A step within the limit always counts the same; one beyond it is given up, whoever of its threads finds that first.
#[derive(Debug)]
pub(super) struct WorkCounter {
    done: AtomicU64,
    most: u64,
}

impl WorkCounter {
    /// A counter of so much work at most.
    pub(super) fn new(most: f64) -> Self {
        Self { done: AtomicU64::new(0), most: most as u64 }
    }

    /// Adds work; returns whether there is too much.
    pub(super) fn add(&self, work: u64) -> bool {
        self.done.fetch_add(work, Ordering::Relaxed).saturating_add(work) > self.most
    }

    /// Whether there was too much.
    pub(super) fn is_exceeded(&self) -> bool {
        self.done.load(Ordering::Relaxed) > self.most
    }

    /// The work done.
    pub(super) fn done(&self) -> u64 {
        self.done.load(Ordering::Relaxed)
    }
}
