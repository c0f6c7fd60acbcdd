//! The elements of a run at its present instant: the contact of each, and sums over all.

use super::definition::{ElementSite, Patch};
use super::face::{Face, FixedPoints, Tread};
use super::motion::{BodyKinematics, PoseMotion, size};
use super::run::PatchRun;
use super::state::{PatchRestoreError, PatchState, Totals};
use crate::element::{ElementLaw, LawPlace, ROUNDING, SpringLaw, damped};
use crate::math::Number;

/// An element at an instant, and its law there.
#[derive(Clone, Copy, Debug)]
pub(super) struct ElementContact<T> {
    /// The area that is inside the contact, m².
    pub(super) area: f64,
    /// Along the plane, m/s.
    pub(super) velocity: [T; 2],
    /// How far it is below the plane z = 0, m.
    pub(super) approach: T,
    /// Where its speed and its temperature lie in the law.
    pub(super) place: LawPlace<T>,
    /// The law there, at its approach.
    pub(super) law: ElementLaw<T>,
    /// The pressure on it, Pa.
    pub(super) pressure: T,
}

/// Sums over all elements.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ElementSums {
    /// How many bear.
    pub(super) count: usize,
    /// How many stick.
    pub(super) sticking: usize,
    /// The area of those that bear, m².
    pub(super) nominal_area: f64,
    /// The real area of contact, m².
    pub(super) real_area: f64,
    /// The largest pressure, Pa.
    pub(super) pressure: f64,
    /// The normal force, N.
    pub(super) normal: f64,
    /// Of that, on elements outside the table, N.
    pub(super) outside: f64,
    /// Of the normal force, on elements below the least pressure of the table, N.
    pub(super) below: f64,
    /// Σ|G|, N.
    pub(super) tangential: f64,
    /// Σ|G|η with the share η of hysteresis in the friction coefficient, N.
    pub(super) hysteresis: f64,
    /// The energy stored in the tangential springs, J.
    pub(super) elastic: f64,
    /// By how much the warmest of those that bear is warmer than the temperature given, K.
    pub(super) warmest: f64,
    /// Of those that bear, Σ Aϑ with the rise ϑ of the temperature, m² K.
    pub(super) warmth: f64,
}

impl Totals {
    /// The body now, moving as at the end of the last step.
    pub(super) fn instant(&self) -> BodyKinematics<f64> {
        PoseMotion { start: self.pose.coordinates(), change: self.rates, duration: 1.0 }.at(0.0)
    }
}

impl PatchRun {
    /// Element `i` at an instant with the tread where `totals` say, its law warmer by `rise` (K).
    pub(super) fn element_contact<T: Number>(
        &mut self,
        i: usize,
        totals: &Totals,
        now: &BodyKinematics<T>,
        rise: f64,
    ) -> ElementContact<T> {
        let ElementSite { place, area, direction } = self.patch.element(i, totals.place);
        let arm = now.turned(place);
        let mut velocity = now.velocity(arm);
        if matches!(*self.patch.face, Face::Tread(_)) {
            let along = now.turned([direction[0], 0.0, direction[1]]);
            velocity = [0, 1].map(|axis| velocity[axis] - along[axis].times(totals.tread_speed));
        }
        let approach = -(now.height + arm[2]);
        let log_speed = self.law.range().logarithm(size(velocity));
        let place = self.law.place(log_speed, T::constant(rise));
        let law = self.law.at_place(&place, approach);
        ElementContact { area, velocity, approach, place, law, pressure: law.pressure }
    }

    /// Whether the pressure on an element is above the largest of the table.
    pub fn pressure_is_beyond(&mut self) -> bool {
        self.element_sums().pressure > self.law.limits().pressure
    }

    /// The share of the normal force that is borne below the least pressure of the table; 0 without contact.
    pub fn share_below_table(&mut self) -> f64 {
        let sums = self.element_sums();
        if sums.normal > 0.0 { sums.below / sums.normal } else { 0.0 }
    }

    /// Sums over all elements now.
    pub(super) fn element_sums(&mut self) -> ElementSums {
        let (totals, now) = (self.totals, self.totals.instant());
        let (limits, least) = (self.law.limits(), self.law.least_pressure());
        let mut sums = ElementSums::default();
        for i in 0..self.patch.count() {
            let here = self.element_contact(i, &totals, &now, self.springs.rise_of_law(i));
            let normal = here.pressure * here.area;
            if normal <= 0.0 {
                continue;
            }
            let (hysteresis, ratio) = self.law.shares(&here.place, here.approach);
            let tangential = self.springs.x[i].hypot(self.springs.y[i]);
            let is_outside = limits.is_outside(here.pressure, here.velocity[0].hypot(here.velocity[1]));
            sums.count += 1;
            sums.sticking += usize::from(self.springs.sticks(i));
            sums.nominal_area += here.area;
            sums.real_area += here.area * ratio;
            sums.pressure = sums.pressure.max(here.pressure);
            sums.normal += normal;
            sums.outside += if is_outside { normal } else { 0.0 };
            sums.below += if here.pressure < least { normal } else { 0.0 };
            sums.tangential += tangential;
            sums.hysteresis += tangential * hysteresis;
            sums.elastic += 0.5 * tangential * tangential / self.springs.stiffness[i];
            sums.warmest = sums.warmest.max(self.springs.rise(i));
            sums.warmth += here.area * self.springs.rise(i);
        }
        sums
    }

    /// The energy stored in the normal springs of the elements and of their backing now, J: what it takes to press them at
    /// the speed and the temperature that they have.
    pub(super) fn normal_energy(&mut self) -> f64 {
        let (totals, now) = (self.totals, self.totals.instant());
        let mut energy = 0.0;
        for i in 0..self.patch.count() {
            let here = self.element_contact(i, &totals, &now, self.springs.rise_of_law(i));
            if here.pressure * here.area > 0.0 {
                energy += here.area * self.law.normal_energy(&here.place, here.approach);
            }
        }
        energy
    }

    /// The pressure on element `i` now, Pa.
    pub(super) fn pressure_on(&mut self, i: usize) -> f64 {
        let (totals, now) = (self.totals, self.totals.instant());
        let here = self.element_contact(i, &totals, &now, self.springs.rise_of_law(i));
        if here.area > 0.0 { here.pressure } else { 0.0 }
    }

    /// The traction of the ground on element `i` along x or y, Pa.
    pub(super) fn traction_on(&mut self, i: usize, axis: usize) -> f64 {
        let totals = self.totals;
        let area = self.patch.element(i, totals.place).area;
        let force = if self.patch.damping() > 0.0 {
            let here = self.element_contact(i, &totals, &totals.instant(), self.springs.rise_of_law(i));
            self.force_on_ground(i, &here)[axis]
        } else {
            [self.springs.x[i], self.springs.y[i]][axis]
        };
        if area > 0.0 { -force / area } else { 0.0 }
    }

    /// The force of an element on the ground along the plane, with its damper's part, N.
    fn force_on_ground(&self, i: usize, here: &ElementContact<f64>) -> [f64; 2] {
        let force = [self.springs.x[i], self.springs.y[i]];
        let law = SpringLaw {
            stiffness: here.law.stiffness * here.area,
            limit: here.pressure * here.law.friction * here.area,
        };
        let damping = self.patch.damping();
        if damping > 0.0 { damped(force, &law, here.velocity, damping) } else { force }
    }

    /// Refuses springs that no contact of a state can hold.
    pub(super) fn check_limits(&mut self, saved: &PatchState) -> Result<(), PatchRestoreError> {
        let now = saved.totals.instant();
        for i in 0..self.patch.count() {
            let here = self.element_contact(i, &saved.totals, &now, saved.springs.rise_of_law(i));
            let limit = here.area * here.pressure * here.law.friction;
            let force = saved.springs.x[i].hypot(saved.springs.y[i]);
            let is_held = force == 0.0 || saved.springs.stiffness[i] > 0.0;
            if force.is_nan() || force > limit * (1.0 + ROUNDING) || !is_held {
                return Err(PatchRestoreError::Invalid { what: "the force of a spring", value: force });
            }
        }
        Ok(())
    }
}

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
            Face::Points(FixedPoints { grid: Some(grid), .. }) => grid_layout(grid, grid.columns, 1.0),
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

fn points_layout(points: &FixedPoints) -> FaceLayout {
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
        let force = if here.area > 0.0 { self.force_on_ground(i, &here) } else { [0.0; 2] };
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
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use super::super::definition::Patch;
    use super::super::variables::PatchOutput;

    use super::*;
    use crate::patch::{PatchMotion, PatchStart, Pose};

    /// The share outside the table and the warning follow one criterion: what exceeds the table by rounding is within.
    #[test]
    fn elements_count_as_beyond_the_table_where_it_is_said() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/patch");
        let text = "name = \"one\"\ntable = { path = \"winkler.table.csv\" }\n\
                    patch = { shape = \"flat\", length = 0.01, width = 0.01, nx = 1, ny = 1 }";
        let patch = Patch::parse(text, &folder.join("patch.toml")).unwrap();
        let at = |z: f64| {
            let pose = Pose { place: [0.0, 0.0, z], angles: [0.0; 3] };
            PatchRun::new(&patch, &PatchStart { pose, ..PatchStart::default() }).unwrap()
        };
        let largest = at(0.0).law.limits().pressure / (1.0 + ROUNDING);
        // At the low end there is no warning: whatever lifts passes it.
        let mut lifting = at(0.0);
        let sums = lifting.element_sums();
        assert!(sums.pressure < lifting.law.least_pressure() && sums.normal > 0.0);
        assert!(sums.outside == sums.normal && lifting.take_warnings().is_empty(), "{sums:?}");
        for (excess, is_beyond) in [(0.5, false), (2.0, true)] {
            let (mut low, mut high) = (-1e-2, 1e-2);
            for _ in 0..100 {
                let middle = 0.5 * (low + high);
                let is_above = at(middle).element_sums().pressure > largest * (1.0 + excess * ROUNDING);
                if is_above { low = middle } else { high = middle }
            }
            let mut run = at(low);
            let sums = run.element_sums();
            assert!(sums.pressure > largest && sums.normal > 0.0);
            assert_eq!((sums.outside > 0.0, !run.take_warnings().is_empty()), (is_beyond, is_beyond), "{excess}");
        }
    }

    /// Pressed on a backing, slid under the load and lifted: the work is what was lost and what is stored.
    #[test]
    fn work_is_what_is_dissipated_and_what_the_springs_store() {
        let damped = ", backing = { normal = 3e9, shear = 6e9 }, damping = 2e-5";
        for backing in ["", ", backing = { normal = 3e9, shear = 6e9 }", damped] {
            let shape = format!("shape = 'flat', length = 0.01, width = 0.01, nx = 2, ny = 2{backing}");
            let text = format!("name = 'b'\ntable = {{ path = 'winkler.table.csv' }}\npatch = {{ {shape} }}");
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/patch");
            let patch = Patch::parse(&text, &folder.join("b.toml")).unwrap();
            let start =
                PatchStart { pose: Pose { place: [0.0, 0.0, 1e-5], angles: [0.0; 3] }, ..PatchStart::default() };
            let mut run = PatchRun::new(&patch, &start).unwrap();
            let (mut work, mut stored) = (0.0, Vec::new());
            for rates in
                [[0.0, 0.0, -0.06, 0.0, 0.0, 0.0], [0.01, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.06, 0.0, 0.0, 0.0]]
            {
                for _ in 0..1000 {
                    let before = run.totals.wrench;
                    run.advance(&PatchMotion { duration: 1e-6, rates, transport_speed: 0.0, temperature: 0.0 })
                        .unwrap();
                    let mean = |axis: usize| 0.5 * (before[axis] + run.totals.wrench[axis]) * rates[axis] * 1e-6;
                    work -= (0..3).map(mean).sum::<f64>();
                }
                let variables = patch.all_variables();
                let elastic = variables.into_iter().find(|variable| variable.output == PatchOutput::ElasticEnergy);
                let mut energy = [0.0];
                run.evaluate(&[elastic.unwrap()], &mut energy);
                let lost = run.totals.slip_energy + run.totals.release_energy + run.totals.damper_energy;
                assert!((work - lost - energy[0]).abs() < 1e-3 * work, "{backing}: {work} {lost} {energy:?}");
                stored.push(energy[0]);
            }
            assert!(stored[0] > 1e-4 && stored[2] == 0.0, "{stored:?}");
        }
    }

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
            points_layout(&FixedPoints { x: axis(0), y: axis(1), z: axis(2), area: vec![1e-6; 2], grid: None })
        };
        assert_eq!(points([[0.0; 3], [0.3, 0.2, 0.1]]).axes, ["x", "y"]);
        let standing = points([[0.0; 3], [0.0, 0.2, 0.4]]);
        assert_eq!(standing.axes, ["y", "z"]);
        assert!((standing.extents[1].1 - 0.4005).abs() < 1e-12);
        assert_eq!(points([[0.0; 3]; 2]).axes, ["x", "y"]);
    }
}
