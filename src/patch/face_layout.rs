//! The elements as they lie in the plane of their face, for pictures: place, pressure, traction.

use super::definition::Patch;
use super::face::{Face, Points, Tread};
use super::motion::BodyKinematics;
use super::run::PatchRun;
use super::state::Totals;

/// A face laid out in a plane: a grid along its arc and across it; of points the two axes of the body along which they
/// reach farthest.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceLayout {
    kind: LayoutKind,
    /// What is along the first and the second axis.
    pub axes: [&'static str; 2],
    /// From where to where the elements reach along them, m.
    pub extents: [(f64, f64); 2],
    /// The number of elements.
    pub count: usize,
}

#[derive(Clone, Debug, PartialEq)]
enum LayoutKind {
    /// The cells of a tread, or of a grid that stands, and the number of the first column.
    Grid(Tread, f64),
    /// The two axes.
    Points([usize; 2]),
}

/// An element at an instant, along the axes of a [`FaceLayout`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceElement {
    /// Its middle, m.
    pub place: [f64; 2],
    /// Length and width of what is inside of a cell, m; of a point the edges of a square of its area.
    pub size: [f64; 2],
    /// The area that is inside the contact, m².
    pub area: f64,
    /// The pressure on it, Pa.
    pub pressure: f64,
    /// The traction of the ground on the face, Pa.
    pub traction: [f64; 2],
    /// Whether it sticks.
    pub sticks: bool,
}

impl Patch {
    /// Its face, laid out.
    pub fn layout(&self) -> FaceLayout {
        match &*self.face {
            Face::Tread(tread) => grid_layout(tread, tread.columns + 1, 0.0),
            Face::Points(Points { grid: Some(grid), .. }) => grid_layout(grid, grid.columns, 1.0),
            Face::Points(points) => points_layout(points),
        }
    }
}

impl FaceLayout {
    /// The elements of a grid across its face; `None` for points.
    pub fn rows(&self) -> Option<usize> {
        match &self.kind {
            LayoutKind::Grid(tread, _) => Some(tread.rows.len()),
            LayoutKind::Points(_) => None,
        }
    }
}

fn grid_layout(grid: &Tread, columns: usize, first: f64) -> FaceLayout {
    let around = |middle: f64, length: f64| (middle - 0.5 * length, middle + 0.5 * length);
    let rows = grid.rows.len();
    let width = grid.area / grid.cell * rows as f64;
    FaceLayout {
        axes: [if grid.section.radius.is_some() { "x along the arc" } else { "x" }, "y"],
        extents: [around(grid.offset[0], grid.length), around(grid.offset[1], width)],
        count: columns * rows,
        kind: LayoutKind::Grid(grid.clone(), first),
    }
}

fn points_layout(points: &Points) -> FaceLayout {
    let all = [&points.x, &points.y, &points.z];
    let reach = |axis: usize| {
        // A square of the element's area is seen whole.
        let ends =
            all[axis].iter().zip(&points.area).map(|(at, area)| (at - 0.5 * area.sqrt(), at + 0.5 * area.sqrt()));
        ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (from, to)| (low.min(from), high.max(to)))
    };
    let extents = [0, 1, 2].map(reach);
    let length = |axis: usize| extents[axis].1 - extents[axis].0;
    // Of the three, the shortest is left out; z where they are the same.
    let left_out = [1, 0].into_iter().fold(2, |least, axis| if length(axis) < length(least) { axis } else { least });
    let axes = [[1, 2], [0, 2], [0, 1]][left_out];
    FaceLayout {
        axes: axes.map(|axis| ["x", "y", "z"][axis]),
        extents: axes.map(|axis| extents[axis]),
        count: points.x.len(),
        kind: LayoutKind::Points(axes),
    }
}

impl PatchRun {
    /// The elements at the present instant, in their order.
    pub fn elements_on_face<'a>(&'a mut self, layout: &'a FaceLayout) -> impl Iterator<Item = FaceElement> + 'a {
        let (totals, now) = (self.totals, self.totals.instant());
        (0..layout.count).map(move |i| self.element_on_face(layout, i, &totals, &now))
    }

    fn element_on_face(
        &mut self,
        layout: &FaceLayout,
        i: usize,
        totals: &Totals,
        now: &BodyKinematics<f64>,
    ) -> FaceElement {
        let here = self.element_contact(i, totals, now, self.springs.rise_of_law(i));
        let (place, size, directions) = self.laid_out(layout, i, totals, here.area);
        let force = if here.area > 0.0 { [self.springs.x[i], self.springs.y[i]] } else { [0.0; 2] };
        let traction = directions.map(|direction| {
            let [x, y, _] = now.turned(direction);
            -(force[0] * x + force[1] * y) / here.area.max(f64::MIN_POSITIVE)
        });
        let pressure = if here.area > 0.0 { here.pressure } else { 0.0 };
        FaceElement { place, size, area: here.area, pressure, traction, sticks: self.springs.sticks(i) }
    }

    /// An element's middle and size (m) along the axes of a layout, and their directions in the body's axes.
    fn laid_out(
        &self,
        layout: &FaceLayout,
        i: usize,
        totals: &Totals,
        area: f64,
    ) -> ([f64; 2], [f64; 2], [[f64; 3]; 2]) {
        match &layout.kind {
            LayoutKind::Grid(tread, first) => {
                let rows = tread.rows.len();
                let column = tread.column(first + (i / rows) as f64, totals.place);
                let place = [tread.offset[0] + column.arc, tread.rows[i % rows]];
                let along = [column.direction[0], 0.0, column.direction[1]];
                (place, [tread.cell * column.share, tread.area / tread.cell], [along, [0.0, 1.0, 0.0]])
            }
            LayoutKind::Points(axes) => {
                let place = self.patch.element(i, totals.place).place;
                let unit = |axis: usize| std::array::from_fn(|other| if other == axis { 1.0 } else { 0.0 });
                (axes.map(|axis| place[axis]), [area.sqrt(); 2], axes.map(unit))
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::patch::{PatchMotion, PatchStart, Pose};

    fn patch(shape: &str) -> Patch {
        let text = format!(
            "name = 'p'\n[table]\npath = 'winkler.table.csv'\n[patch]\n{shape}\noffset = [0.1, 0.2, 0.0]\n[fmu]\noutputs = ['forces']\n"
        );
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/patch");
        Patch::parse(&text, &folder.join("p.toml")).unwrap()
    }

    /// The forces of a run whose body stands obliquely are the sums over the layout, turned into the ground's axes.
    #[test]
    fn what_is_drawn_adds_up_to_the_wrench() {
        let shapes = [
            "shape = 'flat'\nlength = 0.02\nwidth = 0.01\nnx = 6\nny = 3",
            "shape = 'cylinder'\nradius = 0.3\nlength = 0.02\nwidth = 0.01\nnx = 6\nny = 3\ntransport = true",
        ];
        for shape in shapes {
            let patch = patch(shape);
            let bottom = if patch.has_tread() { 0.3 } else { 0.0 };
            let yaw = 0.7_f64;
            let pose = Pose { place: [0.0, 0.0, bottom - 3e-5], angles: [0.0, 0.0, yaw] };
            let speed = if patch.has_tread() { 0.33 } else { 0.0 };
            let start =
                PatchStart { pose, transport_speed: speed, temperature: patch.temperature(), ..PatchStart::default() };
            let mut run = PatchRun::new(&patch, &start).unwrap();
            let rates = [0.3, 0.2, 0.0, 0.0, 0.0, 0.0];
            let temperature = patch.temperature();
            run.advance(&PatchMotion { duration: 0.011, rates, transport_speed: speed, temperature }).unwrap();
            let layout = patch.layout();
            let elements: Vec<FaceElement> = run.elements_on_face(&layout).collect();
            let sum = |of: &dyn Fn(&FaceElement) -> f64| {
                elements.iter().map(|element| element.area * of(element)).sum::<f64>()
            };
            let [along, across] = [0, 1].map(|axis| sum(&|element| element.traction[axis]));
            let wrench = run.totals.wrench;
            let close =
                |found: f64, expected: f64| assert!((found - expected).abs() < 1e-3 * wrench[2], "{found} {expected}");
            // A cylinder's arc leaves the plane by at most 10 mm in 300 mm: half the square of that is lost.
            close(along * yaw.cos() - across * yaw.sin(), wrench[0]);
            close(along * yaw.sin() + across * yaw.cos(), wrench[1]);
            close(sum(&|element| element.pressure), wrench[2]);
            // The cells, partly entered ones too, cover the face.
            close(sum(&|_| wrench[2] / 2e-4), wrench[2]);
            let cells: f64 = elements.iter().map(|element| element.size[0] * element.size[1]).sum();
            assert!((cells - 2e-4).abs() < 1e-12, "{cells}");
            let [(left, right), (low, high)] = layout.extents;
            assert!([left - 0.09, right - 0.11, low - 0.195, high - 0.205].iter().all(|off| off.abs() < 1e-12));
        }
    }

    #[test]
    fn points_are_seen_along_the_axes_of_their_largest_extents() {
        let points = |places: [[f64; 3]; 2]| {
            let axis = |i: usize| places.iter().map(|place| place[i]).collect();
            points_layout(&Points { x: axis(0), y: axis(1), z: axis(2), area: vec![1e-6; 2], grid: None })
        };
        assert_eq!(points([[0.0; 3], [0.3, 0.2, 0.1]]).axes, ["x", "y"]);
        let standing = points([[0.0; 3], [0.0, 0.2, 0.4]]);
        assert_eq!(standing.axes, ["y", "z"]);
        assert!((standing.extents[1].1 - 0.4005).abs() < 1e-12);
        assert_eq!(points([[0.0; 3]; 2]).axes, ["x", "y"]);
    }
}
