//! A moment over the face of a patch: what its elements bear, gathered into as many tiles and arrows as can be told
//! apart, so that a picture of a million elements is no larger than one of some thousand.

use asperity::patch::{FaceElement, FaceLayout, PatchRun};

/// How much is drawn of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Detail {
    /// Most tiles along each axis.
    pub(super) tiles: usize,
    /// The distance of the arrows along each axis, m.
    pub(super) arrows: [f64; 2],
}

/// Arrows among single points are so much farther apart: they hide points sooner than cells.
const BETWEEN_POINTS: f64 = 1.6;

/// Elements that are drawn as one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tile {
    /// Their corners along the axes of the plan, m.
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
    /// The middle of their area, m.
    pub(super) place: [f64; 2],
    /// The sum of their areas, m².
    pub(super) area: f64,
    /// Their mean, Pa.
    pub(super) pressure: f64,
    pub(super) traction: [f64; 2],
    /// Whether most of the traction is on elements that stick.
    pub(super) sticks: bool,
}

/// What a face bears at a moment.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Moment {
    /// The time, s.
    pub(super) time: f64,
    /// Of the force on the body, N.
    pub(super) force: f64,
    /// The largest of all elements, Pa.
    pub(super) pressure: f64,
    /// Single elements where these are not too many, else neighbours together.
    pub(super) tiles: Vec<Tile>,
    /// Whether the tiles are single points.
    pub(super) are_points: bool,
    /// The places of the arrows.
    pub(super) arrows: Vec<Tile>,
}

impl Moment {
    pub(super) fn new(run: &mut PatchRun, plan: &FaceLayout, detail: Detail, force: f64) -> Self {
        let are_points = plan.rows().is_none() && plan.count <= detail.tiles * detail.tiles;
        let tiles = if are_points { Bins::cells(plan, 1, [1, 1]) } else { Bins::for_tiles(plan, detail.tiles) };
        let apart = if are_points { BETWEEN_POINTS } else { 1.0 };
        let arrows = Bins::for_arrows(plan, detail.arrows.map(|distance| distance * apart));
        let mut gathered = [&tiles, &arrows].map(|bins| vec![Gathered::default(); bins.count]);
        let (time, mut pressure) = (run.time(), 0.0_f64);
        for (i, element) in run.elements_on_face(plan).enumerate() {
            pressure = pressure.max(element.pressure);
            gathered[0][tiles.index(i, &element)].add(&element);
            gathered[1][arrows.index(i, &element)].add(&element);
        }
        let [tiles, arrows] = [tiles.tiles(&gathered[0]), arrows.tiles(&gathered[1])];
        Self { time, force, pressure, tiles, are_points, arrows }
    }
}

/// Which elements go together.
#[derive(Clone, Copy, Debug)]
struct Bins {
    count: usize,
    shape: BinShape,
}

#[derive(Clone, Copy, Debug)]
enum BinShape {
    /// Columns and rows of a grid with so many rows: so many of each together.
    Cells { rows: usize, together: [usize; 2] },
    /// Points in a rectangle, by the corner and the edges of the first one (m) and the number of them along the second
    /// axis.
    Rectangles { corner: [f64; 2], edges: [f64; 2], across: usize },
}

impl Bins {
    fn for_tiles(plan: &FaceLayout, most: usize) -> Self {
        match plan.rows() {
            Some(rows) => Self::cells(plan, rows, [plan.count / rows, rows].map(|count| count.div_ceil(most))),
            None => Self::rectangles(plan, [longest(plan) / most as f64; 2]),
        }
    }

    fn for_arrows(plan: &FaceLayout, distance: [f64; 2]) -> Self {
        let Some(rows) = plan.rows() else { return Self::rectangles(plan, distance) };
        let [along, across] = [plan.count / rows, rows];
        let together = [(0, along), (1, across)].map(|(axis, count)| {
            let cell = (plan.extents[axis].1 - plan.extents[axis].0) / count as f64;
            ((distance[axis] / cell).round() as usize).clamp(1, count)
        });
        Self::cells(plan, rows, together)
    }

    fn cells(plan: &FaceLayout, rows: usize, together: [usize; 2]) -> Self {
        let count = (plan.count / rows).div_ceil(together[0]) * rows.div_ceil(together[1]);
        Self { count, shape: BinShape::Cells { rows, together } }
    }

    fn rectangles(plan: &FaceLayout, edges: [f64; 2]) -> Self {
        let number = |axis: usize| ((plan.extents[axis].1 - plan.extents[axis].0) / edges[axis]) as usize + 1;
        let (along, across) = (number(0), number(1));
        let corner = plan.extents.map(|(low, _)| low);
        Self { count: along * across, shape: BinShape::Rectangles { corner, edges, across } }
    }

    /// The tiles of those with elements in them; a rectangle is drawn whole.
    fn tiles(&self, gathered: &[Gathered]) -> Vec<Tile> {
        let drawn = |(index, gathered): (usize, &Gathered)| {
            let tile = gathered.tile()?;
            let BinShape::Rectangles { corner, edges, across } = self.shape else { return Some(tile) };
            let index = [index / across, index % across];
            let end = |more: usize| [0, 1].map(|axis| corner[axis] + edges[axis] * (index[axis] + more) as f64);
            Some(Tile { low: end(0), high: end(1), ..tile })
        };
        gathered.iter().enumerate().filter_map(drawn).collect()
    }

    fn index(&self, i: usize, element: &FaceElement) -> usize {
        match self.shape {
            BinShape::Cells { rows, together: [along, across] } => {
                (i / rows / along) * rows.div_ceil(across) + i % rows / across
            }
            BinShape::Rectangles { corner, edges, across } => {
                let [x, y] = [0, 1].map(|axis| ((element.place[axis] - corner[axis]) / edges[axis]) as usize);
                x * across + y
            }
        }
    }
}

/// The longer side of a face, m.
fn longest(plan: &FaceLayout) -> f64 {
    plan.extents.iter().map(|(low, high)| high - low).fold(0.0, f64::max)
}

/// Sums over elements.
#[derive(Clone, Copy, Debug, Default)]
struct Gathered {
    corners: Option<[[f64; 2]; 2]>,
    area: f64,
    /// Area times place.
    first_moment: [f64; 2],
    load: f64,
    tangential: [f64; 2],
    /// Of the absolute values, those that stick positive, others negative.
    sticking: f64,
}

impl Gathered {
    fn add(&mut self, element: &FaceElement) {
        let FaceElement { place, size, area, pressure, traction, sticks } = *element;
        if area <= 0.0 {
            return;
        }
        let [low, high] = [-0.5, 0.5].map(|half| [0, 1].map(|axis| place[axis] + half * size[axis]));
        let [first, last] = self.corners.unwrap_or([low, high]);
        self.corners =
            Some([[0, 1].map(|axis| low[axis].min(first[axis])), [0, 1].map(|axis| high[axis].max(last[axis]))]);
        self.area += area;
        self.load += area * pressure;
        for axis in 0..2 {
            self.first_moment[axis] += area * place[axis];
            self.tangential[axis] += area * traction[axis];
        }
        let size = area * traction[0].hypot(traction[1]);
        self.sticking += if sticks { size } else { -size };
    }

    fn tile(&self) -> Option<Tile> {
        let [low, high] = self.corners?;
        let mean = |sum: f64| sum / self.area;
        Some(Tile {
            low,
            high,
            place: self.first_moment.map(mean),
            area: self.area,
            pressure: mean(self.load),
            traction: self.tangential.map(mean),
            sticks: self.sticking > 0.0,
        })
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use asperity::patch::{Patch, PatchElement};

    use super::super::details;
    use super::*;

    /// Of a face 1 m long and 0.1 mm wide, which is drawn wider than it is, arrows are as far apart along it as across.
    #[test]
    fn a_slender_face_has_as_many_arrows_as_the_map_has_room_for() {
        let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("tests/reference/patch");
        let text = "name = 'p'\n[table]\npath = 'winkler.table.csv'\n[patch]\nshape = 'flat'\nlength = 1.0\n\
                    width = 1e-4\nnx = 1000\nny = 2\n";
        let grid = Patch::parse(text, &folder.join("p.toml")).unwrap();
        let in_line = |i: u32| PatchElement { index: 0, place: [f64::from(i) * 1e-3, 0.0, 0.0], area: 1e-12 };
        for (patch, expected) in [(&grid, 21 * 2), (&grid.with_elements((0..1000).map(in_line)), 21 * 5)] {
            let plan = patch.layout();
            // 620 by 124 pixels, 30 from arrow to arrow: 20.7 along, 4.1 across; of the grid 48 columns go together.
            let [large, _] = details(&plan);
            assert_eq!(Bins::for_arrows(&plan, large.arrows).count, expected);
        }
    }
}
