//! Where the elements of a patch sit on its face: fixed points, or the cells of a tread that runs through.
//!
//! Elements are in columns across the face: column i from the front, in it the elements from -y to y. A tread has one
//! column more than the face is divided into; the cells at both ends are partly inside.

use super::motion::TreadMotion;

/// Elements of a block.
pub(super) const BLOCK: usize = 64;

/// Values of the elements of a block.
pub(super) type Lanes<T> = [T; BLOCK];

/// The lanes that `count` elements take: up to whole vectors, which hold eight numbers at most; those with derivatives are
/// in none.
#[inline(always)]
pub(super) fn lanes_of<T>(count: usize) -> usize {
    if size_of::<T>() > size_of::<f64>() { count } else { count.next_multiple_of(8).min(BLOCK) }
}

/// The elements of a patch.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Face {
    Points(FixedPoints),
    Tread(Tread),
}

/// Elements that stay where they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct FixedPoints {
    /// Positions in the body's axes, axis by axis, m.
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
    pub(super) z: Vec<f64>,
    /// Areas, m².
    pub(super) area: Vec<f64>,
    /// The grid whose cells they are, its columns counted from 1; `None` where they are single points.
    pub(super) grid: Option<Tread>,
}

/// A grid of cells that moves along -x.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tread {
    pub(super) section: Section,
    /// The length of the contact along the arc, m.
    pub(super) length: f64,
    /// The length of a cell along the arc, m.
    pub(super) cell: f64,
    /// The number of cells that the length holds.
    pub(super) columns: usize,
    /// Positions of the rows, m.
    pub(super) rows: Vec<f64>,
    /// The area of a cell, m².
    pub(super) area: f64,
    /// The face's origin in the body's axes, m.
    pub(super) offset: [f64; 3],
}

/// The section of a face: flat, or an arc about an axis along y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Section {
    /// The radius of the arc, m; `None` where the face is flat.
    pub(super) radius: Option<f64>,
}

impl Section {
    /// x and z (m) at an arc length from the middle (m), and the direction of the arc there.
    #[inline(always)]
    pub(super) fn at(self, arc: f64) -> ([f64; 2], [f64; 2]) {
        match self.radius {
            None => ([arc, 0.0], [1.0, 0.0]),
            Some(radius) => {
                let (sin, cos) = (arc / radius).sin_cos();
                ([radius * sin, -radius * cos], [cos, sin])
            }
        }
    }
}

/// A column of a tread at an instant.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TreadColumn {
    /// Where on the arc the middle of what is inside is, m.
    pub(super) arc: f64,
    /// x and z of it in the body's axes, m.
    pub(super) place: [f64; 2],
    /// The direction of the arc there, in x and z.
    pub(super) direction: [f64; 2],
    /// The share of a cell's area that is inside.
    pub(super) share: f64,
}

impl Tread {
    /// Column `i`, counted from the front at the start of the step, once `entered` cells have entered since.
    #[inline(always)]
    pub(super) fn column(&self, i: f64, entered: f64) -> TreadColumn {
        let half = 0.5 * self.length;
        let rear = half - (entered + i) * self.cell;
        let (low, high) = (rear.clamp(-half, half), (rear + self.cell).clamp(-half, half));
        let arc = 0.5 * (low + high);
        let ([x, z], direction) = self.section.at(arc);
        TreadColumn { arc, place: [self.offset[0] + x, self.offset[2] + z], direction, share: (high - low) / self.cell }
    }

    /// How the arc length (m) of the middle of what is inside of a column and its share change as cells enter.
    pub(super) fn changes(&self, i: f64, entered: f64) -> (f64, f64) {
        let half = 0.5 * self.length;
        let rear = half - (entered + i) * self.cell;
        let moves = |edge: f64| if edge > -half && edge < half { 1.0 } else { 0.0 };
        let (low, high) = (moves(rear), moves(rear + self.cell));
        (-0.5 * (low + high) * self.cell, low - high)
    }

    /// The first column of a step, as counted at its start, and the number of columns that are inside at some time.
    pub(super) fn columns_of(&self, motion: TreadMotion) -> (f64, usize) {
        let entered = motion.whole_cells();
        (-entered.max(0.0), (self.columns + 1).saturating_add(entered.abs() as usize))
    }
}

impl Face {
    /// The number of elements.
    pub(super) fn count(&self) -> usize {
        match self {
            Self::Points(points) => points.x.len(),
            Self::Tread(tread) => (tread.columns + 1) * tread.rows.len(),
        }
    }

    /// The elements that are on it at some time of a step.
    pub(super) fn count_in(&self, motion: TreadMotion) -> usize {
        match self {
            Self::Points(_) => self.count(),
            Self::Tread(tread) => tread.columns_of(motion).1.saturating_mul(tread.rows.len()),
        }
    }

    /// z of its lowest point in the body's axes, m.
    pub(super) fn lowest(&self) -> f64 {
        match self {
            Self::Points(points) => points.z.iter().copied().fold(f64::INFINITY, f64::min),
            Self::Tread(tread) => tread.section.at(0.0).0[1] + tread.offset[2],
        }
    }
}
