//! The motion of a face through a step, as the blocks of its elements see it.

use super::face::Face;
use super::heat::StepHeat;
use super::motion::{PoseMotion, Substep, Substeps, TreadMotion};
use super::work::WorkCounter;
use crate::math::Dual;

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
        let Self { face, body, tread, substeps, tread_speed, heat, work } = *self;
        let PoseMotion { start, change, duration } = body;
        let change = std::array::from_fn(|i| Dual::variable(change[i], i));
        FaceMotion { face, body: PoseMotion { start, change, duration }, tread, substeps, tread_speed, heat, work }
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
